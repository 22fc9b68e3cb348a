//! Daylight against published values.

use super::Perez;
use super::sun::{black_body, from_xyz, observer, radiance, solid_angle, transmittance};
use raywright_optics::Rgb;
use std::f64::consts::PI;

#[test]
fn a_black_body_obeys_stefan_and_boltzmann() {
    // ∫ B dλ = σ T⁴ / π, by Simpson's rule in the logarithm of the wavelength.
    let (low, high, steps) = (10f64.ln(), 1e7f64.ln(), 20_000);
    let sum: f64 = (0..=steps)
        .map(|i| {
            let x = low + (high - low) * f64::from(i) / f64::from(steps);
            let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            weight * black_body(x.exp(), 5778.0) * x.exp()
        })
        .sum::<f64>()
        * (high - low)
        / f64::from(3 * steps);
    let expected = 5.670_374_419e-8 * 5778f64.powi(4) / PI;
    assert!((sum / expected - 1.0).abs() < 1e-6, "{sum} {expected}");
}

#[test]
fn the_suns_light_above_the_air_is_the_solar_constant() {
    // The solar constant is 1361 W·m⁻² (Kopp and Lean, 2011). The model's diameter of 0.53° instead of 0.5332° makes it
    // one percent less.
    let outside = 5.670_374_419e-8 * 5778f64.powi(4) / PI * solid_angle();
    assert!((outside / 1361.0 - 1.0).abs() < 0.015, "{outside}");
}

#[test]
fn the_observer_is_the_cies() {
    // Values of 1931 at some wavelengths, which the fit meets to within 0.03, and the integral of ȳ, 106.857.
    for (wavelength, expected) in
        [(450.0, [0.3362, 0.038, 1.7721]), (555.0, [0.5121, 1.0, 0.0057]), (600.0, [1.0622, 0.631, 0.0008])]
    {
        for (x, y) in observer(wavelength).iter().zip(expected) {
            assert!((x - y).abs() < 0.03, "{wavelength}: {x} {y}");
        }
    }
    let sum: f64 = (360..=830).map(|w| observer(f64::from(w))[1]).sum();
    assert!((sum / 106.857 - 1.0).abs() < 0.01, "{sum}");
    // The white point of Rec. 709 is D65.
    let white = from_xyz([0.950_456, 1.0, 1.089_058]);
    assert!((white - Rgb::ONE).abs().max() < 1e-4, "{white}");
}

#[test]
fn air_takes_more_the_more_there_is_and_blue_before_red() {
    for turbidity in [2.0, 3.0, 6.0, 10.0] {
        let through = |wavelength, height| transmittance(wavelength, height, turbidity);
        for height in [0.0, 0.1, 0.5, 1.0] {
            assert!(through(450.0, height) < through(650.0, height));
            assert!(through(550.0, height) > 0.0 && through(550.0, height) < 1.0);
        }
        assert!(through(550.0, 0.2) < through(550.0, 0.3));
        assert!(through(550.0, 0.5) > transmittance(550.0, 0.5, turbidity + 1.0));
    }
    // Zenith transmittance at turbidity 2, by hand: molecules 0.1001, aerosols 0.0463 · 0.55^−1.3, ozone 0.085 · 0.35.
    let depth: f64 = 0.008735 * 0.55f64.powf(-4.08) + 0.0463 * 0.55f64.powf(-1.3) + 0.085 * 0.35;
    let mass = 1.0 / (1.0 + 0.15 * 93.885f64.powf(-1.253));
    assert!((transmittance(550.0, 1.0, 2.0) / (-depth * mass).exp() - 1.0).abs() < 1e-12);
}

#[test]
fn a_high_sun_is_as_bright_as_meters_say() {
    // Direct sunlight on a perpendicular surface is around 100 klx.
    let sun = radiance(1.0, 2.5).luminance() * solid_angle() * 683.0;
    assert!((70e3..120e3).contains(&sun), "{sun}");
}

#[test]
fn the_zenith_is_what_the_paper_has_and_skies_are_blue() {
    // Preetham et al., appendix A.2, by hand for a turbidity of 3 and a sun 45° high.
    let (t, theta) = (3.0, PI / 4.0);
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
    let luminance_there = ((4.0453 * t - 4.9710) * f64::tan(chi) - 0.2155 * t + 2.4192) * 1000.0 / 683.0;
    let zenith = Perez::new(theta.cos(), t).radiance(1.0, theta.cos());
    assert!((zenith.luminance() / luminance_there - 1.0).abs() < 1e-4, "{zenith} {luminance_there}");
    for t in [2.0, 3.0, 5.0] {
        let zenith = Perez::new(0.7, t).radiance(1.0, 0.7);
        assert!(zenith[2] > zenith[1] && zenith[1] > zenith[0], "{zenith}");
    }
    // The radiance is positive and finite in all directions at all hours.
    for t in [2.0, 4.0, 10.0] {
        for height in [0.0, 0.01, 0.3, 1.0] {
            let sky = Perez::new(height, t);
            for z in [0.0, 1e-9, 0.01, 0.5, 1.0] {
                for towards in [-1.0, 0.0, 0.9, 1.0, 1.0 + 1e-16] {
                    let radiance = sky.radiance(z, towards);
                    assert!(radiance.is_finite() && radiance.min() >= 0.0, "{t} {height} {z}: {radiance}");
                }
            }
        }
    }
}
