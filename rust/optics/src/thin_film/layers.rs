//! Interference colors of films.

use super::fringes::{FARTHEST, Fringes};
use super::{Complex, reflectance};
use crate::Rgb;
use crate::spectra::{Illuminant, Response};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Weights of daylight at every nm, and at every second.
static LINES: LazyLock<[Vec<(f64, Rgb)>; 2]> =
    LazyLock::new(|| [1, 2].map(|step| Response::new(Illuminant::Daylight, step).weights().collect()));

/// Maximum number of internal reflections summed by color; if more are needed, the sum is by wavelength.
const TERMS: i32 = 64;

/// Bound on the contribution of reflections that are left out.
const LEAST: f64 = 1e-7;

/// Color of a film's reflection of unpolarized daylight, in linear Rec. 709 with a perfect reflector at (1, 1, 1),
/// integrated over wavelengths. Out of gamut, a channel may be negative by some thousandths, or exceed 1. `thickness`
/// is in nm, and light arrives through a medium of index `from` at a `cosine` of incidence, 0 to 1. Indices do not
/// depend on the wavelength.
///
/// The transmittance at wavelength λ is T₀ / (1 + 2ρ cos δ + ρ²). Its phase is δ = 2π x / λ for a path difference x = 2
/// d n cos θ. It equals T₀ / (1 − ρ²) times 1 + 2 Σ (−ρ)ᵐ cos mδ. So the color is a sum over m of fringe colors, from
/// tables that all films share. Its error is below 1e-5 up to path differences of 16 µm. Beyond 48 µm fringes are
/// assumed invisible; for thicker films the error is below 0.0026 ρ.
pub fn on_dielectric(thickness: f64, [from, film, to]: [f64; 3], cosine: f64) -> Rgb {
    let first = from * cosine;
    let squared = |index: f64| (index - from) * (index + from) + first * first;
    let beyond = squared(to);
    if beyond <= 0.0 || first <= 0.0 {
        // Total reflection at the far side: whatever the film does, everything returns.
        return Rgb::ONE;
    }
    let within = squared(film);
    if within <= 0.0 {
        // Light decays within the film, smoothly over wavelengths.
        return by_wavelength(&LINES[1], |wavelength| {
            reflectance(wavelength, cosine, thickness, from, film, to.into())
        });
    }
    let (within, beyond) = (within.sqrt(), beyond.sqrt());
    // For each polarization, the reflection of near and far face, and the transmission of both.
    let faces = |[a, b, c]: [f64; 3]| {
        let (near, far) = (a + b, b + c);
        let through = [4.0 * (a / near) * (b / near), 4.0 * (b / far) * (c / far)];
        Faces { both: ((a - b) / near * ((b - c) / far)).into(), through }
    };
    let per = |q: f64, n: f64| q / (n * n);
    let all = [[first, within, beyond], [per(first, from), per(within, film), per(beyond, to)]].map(faces);
    let behind = 2.0 * thickness * within;
    if takes_many(&all, behind) {
        return by_wavelength(&LINES[0], reflected(&all, behind));
    }
    // Each polarization carries half of the light.
    let mut waves = all.map(|faces| 0.5 * faces.mean());
    let mut seen = Rgb::splat(1.0 - (waves[0] + waves[1]));
    let fringes = Fringes::get();
    for m in 1..=TERMS {
        waves = [0, 1].map(|side| waves[side] * -all[side].both.re);
        let way = f64::from(m) * behind;
        if way >= FARTHEST || waves[0].abs() + waves[1].abs() < 0.1 * LEAST {
            break;
        }
        seen -= fringes.cosine(way) * (2.0 * (waves[0] + waves[1]));
    }
    seen
}

/// Color of a film on a conductor with index of refraction η + ik per channel. Each channel is that of a conductor
/// with its index at all wavelengths. Light arrives through a medium of index `outside`.
pub fn on_conductor(thickness: f64, [outside, film]: [f64; 2], (eta, k): (Rgb, Rgb), cosine: f64) -> Rgb {
    let first = outside * cosine;
    let within = (film - outside) * (film + outside) + first * first;
    if first <= 0.0 {
        return Rgb::ONE;
    }
    let base = |channel: usize| Complex::new(eta[channel].min(HIGHEST), k[channel].min(HIGHEST));
    let channels = |of: &dyn Fn(usize) -> f64| Rgb::new(of(0), of(1), of(2));
    if within <= 0.0 {
        return channels(&|channel| {
            let of = |wavelength| reflectance(wavelength, cosine, thickness, outside, film, base(channel));
            by_wavelength(&LINES[1], of)[channel]
        });
    }
    let within = within.sqrt();
    let along = outside * outside * (1.0 - cosine) * (1.0 + cosine);
    let per = |q: f64, n: f64| q / (n * n);
    let behind = 2.0 * thickness * within;
    let fringes = Fringes::get();
    channels(&|channel| {
        let base = base(channel);
        let beyond = (base * base - Complex::from(along)).sqrt();
        // As for a dielectric, with an additional phase from the far face.
        let faces = |[a, b]: [f64; 2], c: Complex| {
            let (near, far) = (a + b, c + Complex::from(b));
            let far_face = (Complex::from(b) - c) / far;
            let through = [4.0 * (a / near) * (b / near), 4.0 * b * c.re / far.square()];
            Faces { both: far_face.scaled((a - b) / near), through }
        };
        let s = faces([first, within], beyond);
        let p = faces([per(first, outside), per(within, film)], beyond / (base * base));
        let all = [s, p];
        if takes_many(&all, behind) {
            return by_wavelength(&LINES[0], reflected(&all, behind))[channel];
        }
        let mut waves = all.map(|faces| Complex::from(0.5 * faces.mean()));
        let mut seen = 1.0 - (waves[0].re + waves[1].re);
        for m in 1..=TERMS {
            waves = [0, 1].map(|side| (waves[side] * all[side].both).scaled(-1.0));
            let (wave, way) = (waves[0] + waves[1], f64::from(m) * behind);
            if way >= FARTHEST || waves[0].square() + waves[1].square() < (0.1 * LEAST).powi(2) {
                break;
            }
            let [cosine, sine] = fringes.both(way);
            seen -= 2.0 * (cosine[channel] * wave.re - sine[channel] * wave.im);
        }
        seen
    })
}

/// An index of refraction beyond which everything is a mirror, and powers do not overflow.
const HIGHEST: f64 = 1e40;

/// The faces of a film, for one polarization.
#[derive(Clone, Copy)]
struct Faces {
    /// Product of both reflection coefficients: ρ with a phase.
    both: Complex,
    /// Transmittances of near and far face.
    through: [f64; 2],
}

impl Faces {
    /// 1 − ρ², without cancellation.
    fn less(&self) -> f64 {
        let [near, far] = self.through;
        near + far - near * far
    }

    /// Transmittance averaged over all phases, T₀ / (1 − ρ²).
    fn mean(&self) -> f64 {
        over(self.through[0] * self.through[1], self.less())
    }
}

/// Reflectance at a wavelength, for a path difference `behind`. The form (1 − ρ)² + 4ρ cos² δ/2 of the denominator
/// avoids cancellation.
fn reflected(all: &[Faces; 2], behind: f64) -> impl Fn(f64) -> f64 {
    let ready = all.map(|faces| {
        let size = faces.both.square().sqrt();
        let gap = faces.less() / (1.0 + size);
        let half = 0.5 * faces.both.im.atan2(faces.both.re);
        (faces.through[0] * faces.through[1], gap * gap, 4.0 * size, half)
    });
    move |wavelength| {
        let half_way = PI * (behind / wavelength);
        let through = |(part, gap, size, half): (f64, f64, f64, f64)| {
            let cos = (half_way + half).cos();
            over(part, gap + size * (cos * cos))
        };
        1.0 - 0.5 * (through(ready[0]) + through(ready[1]))
    }
}

/// A quotient where 0 / 0 is 0.
fn over(part: f64, whole: f64) -> f64 {
    if part > 0.0 { part / whole } else { 0.0 }
}

/// Returns whether more internal reflections are needed than are summed by color. Each is smaller than the previous
/// one by the product of both reflection coefficients, and has an additional path difference `behind`.
fn takes_many(all: &[Faces; 2], behind: f64) -> bool {
    let greatest = all.map(|faces| faces.both.square()).into_iter().fold(0.0, f64::max).sqrt();
    if f64::from(TERMS) * behind < FARTHEST {
        return greatest.powi(TERMS) > LEAST * (1.0 - greatest);
    }
    // The visibility of what is left out decreases with its path difference.
    behind < FARTHEST / 3.0 && greatest.powi((FARTHEST / behind) as i32) > 5e-3
}

/// Color of a spectrum.
#[cold]
fn by_wavelength(lines: &[(f64, Rgb)], spectrum: impl Fn(f64) -> f64) -> Rgb {
    lines.iter().map(|&(wavelength, weight)| weight * spectrum(wavelength)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel;

    /// The reference integral.
    fn integral(thickness: f64, [outside, film]: [f64; 2], base: Complex, cosine: f64) -> Rgb {
        by_wavelength(&LINES[0], |wavelength| reflectance(wavelength, cosine, thickness, outside, film, base))
    }

    /// Denser towards grazing incidence.
    fn cosines(count: u32) -> impl Iterator<Item = f64> {
        (1..=count).map(move |i| (f64::from(i) / f64::from(count)).powi(2))
    }

    const THICK: [f64; 8] = [0.0, 0.5, 10.0, 95.0, 310.0, 777.0, 1500.0, 3000.0];

    #[test]
    fn clear_films_have_the_colour_of_the_integral() {
        for indices in [[1.0, 1.33, 1.0], [1.0, 1.47, 1.33], [1.0, 1.38, 1.52], [1.33, 1.47, 1.0], [1.5, 1.0, 1.5]] {
            let [from, film, to] = indices;
            for thickness in THICK {
                for cosine in cosines(30) {
                    let found = on_dielectric(thickness, indices, cosine);
                    let truth = integral(thickness, [from, film], to.into(), cosine);
                    let off = (found - truth).abs().max();
                    assert!(off < 1e-5, "{indices:?} {thickness} {cosine} {off:e} {found} {truth}");
                }
            }
        }
    }

    #[test]
    fn films_on_conductors_have_the_colour_of_the_integral() {
        let (eta, k) = (Rgb::new(0.05, 0.6, 4.0), Rgb::new(4.2, 2.0, 0.03));
        for layers in [[1.0, 1.33], [1.0, 2.4], [1.33, 1.0]] {
            for thickness in THICK {
                for cosine in cosines(16) {
                    let found = on_conductor(thickness, layers, (eta, k), cosine);
                    for channel in 0..3 {
                        let base = Complex::new(eta[channel], k[channel]);
                        let truth = integral(thickness, layers, base, cosine)[channel];
                        let off = (found[channel] - truth).abs();
                        assert!(off < 1e-5, "{layers:?} {thickness} {cosine} {channel} {off:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn three_wavelengths_are_no_colour() {
        // Results of single wavelengths at 650, 550 and 450 nm, which differ from the integral at each thickness.
        for (thickness, wrong) in [
            (300.0, [0.0346943504289, 0.0754302029968, 0.0344459899013]),
            (600.0, [0.0757214932735, 0.00764170047672, 0.0755913619499]),
            (1000.0, [0.00678557323838, 0.0198037779838, 0.00630818341082]),
            (5000.0, [0.0760774300265, 0.0238404751589, 0.0749616447492]),
        ] {
            let shortcut = [650.0, 550.0, 450.0].map(|nm| reflectance(nm, 1.0, thickness, 1.0, 1.33, 1.0.into()));
            for channel in 0..3 {
                assert!((shortcut[channel] - wrong[channel]).abs() < 1e-9);
            }
            let seen = on_dielectric(thickness, [1.0, 1.33, 1.0], 1.0);
            assert!((seen - Rgb::from_array(wrong)).abs().max() > 5e-3, "{thickness} {seen}");
        }
    }

    #[test]
    fn films_of_no_thickness_are_none_and_thin_ones_are_black() {
        for cosine in cosines(40) {
            let soap = on_dielectric(0.0, [1.0, 1.33, 1.0], cosine);
            assert!(soap.abs().max() < 1e-6, "{cosine} {soap}");
            let glass = on_dielectric(0.0, [1.0, 1.38, 1.5], cosine);
            assert!((glass - Rgb::splat(fresnel::dielectric(cosine, 1.5))).abs().max() < 1e-6);
            let (eta, k) = (Rgb::new(0.05, 0.6, 4.0), Rgb::new(4.2, 2.0, 0.03));
            let metal = on_conductor(0.0, [1.0, 1.38], (eta, k), cosine);
            assert!((metal - fresnel::conductor(cosine, eta, k)).abs().max() < 1e-6);
        }
        assert!(on_dielectric(5.0, [1.0, 1.33, 1.0], 1.0).max() < 1e-3);
        // A thick film is a plate without colors, 2r / (1 + r).
        let plate = Rgb::splat(0.0393296977138936);
        assert!((on_dielectric(1e9, [1.0, 1.33, 1.0], 1.0) - plate).abs().max() < 1e-9);
    }

    #[test]
    fn ends_are_numbers() {
        for cosine in [0.0, 1e-300, 1e-9, 1.0] {
            for thickness in [0.0, 1e-300, 1e300] {
                for [film, below] in [[1e-3, 1.0], [1.0, 1e-3], [1e3, 1.5], [1.0, 1.0], [1.33, 1.0]] {
                    assert!(on_dielectric(thickness, [1.0, film, below], cosine).is_finite());
                    let index = (Rgb::splat(below), Rgb::new(0.0, 1.0, f64::MAX));
                    assert!(on_conductor(thickness, [1.0, film], index, cosine).is_finite());
                }
            }
        }
    }
}
