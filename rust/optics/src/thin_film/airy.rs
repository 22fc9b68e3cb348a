//! Airy's formula for thin films.

use super::Complex;
use std::f64::consts::TAU;

/// Reflectance and transmittance of a film between two media at one wavelength, for light polarized perpendicular (s)
/// and parallel (p) to the plane of incidence: the sum over all reflections within the film (Airy, 1833; Born and Wolf,
/// "Principles of Optics", 7.6 and 1.6).
#[derive(Clone, Copy, Debug)]
pub struct Airy {
    /// Reflectances of s and p.
    pub reflectance: [f64; 2],
    /// Transmittances of s and p; the rest, unless the base absorbs.
    pub transmittance: [f64; 2],
}

impl Airy {
    /// Evaluates a film of index `film` and a `thickness` in the unit of the wavelength, on a `base` of index η + ik.
    /// Light with a `wavelength` in vacuum arrives through a medium of index `outside` at a `cosine` of incidence, 0 to
    /// 1.
    ///
    /// Beyond its critical angle, light decays in the film. Exponents are never positive, so nothing overflows.
    pub fn new(wavelength: f64, cosine: f64, thickness: f64, outside: f64, film: f64, base: Complex) -> Self {
        let along = outside * outside * (1.0 - cosine) * (1.0 + cosine);
        // n cos θ in each layer.
        let first = Complex::from(outside * cosine);
        let within = Complex::from((film - outside) * (film + outside) + first.re * first.re).sqrt();
        let beyond = (base * base - Complex::from(along)).sqrt();
        let once = within.scaled(TAU * thickness / wavelength).turned();
        let one = Complex::from(1.0);
        let sum = |[a, b, c]: [Complex; 3]| {
            if a.re == 0.0 {
                return [1.0, 0.0];
            }
            // Without a wave in the film nothing returns from its far face.
            let (near, far) = ((a - b) / (a + b), if (b + c).square() == 0.0 { one } else { (b - c) / (b + c) });
            let twice = once * once;
            let all = one + near * far * twice;
            let reflected = (near + far * twice) / all;
            let through = (one + near) * (one + far) * once / all;
            // Flux is proportional to the real part of the admittance.
            [reflected.square(), through.square() * c.re / a.re]
        };
        let over = |q: Complex, n: Complex| q / (n * n);
        let s = sum([first, within, beyond]);
        let p = sum([over(first, outside.into()), over(within, film.into()), over(beyond, base)]);
        Self { reflectance: [s[0], p[0]], transmittance: [s[1], p[1]] }
    }
}

/// Reflectance of unpolarized light, with the arguments of [`Airy::new`].
pub fn reflectance(wavelength: f64, cosine: f64, thickness: f64, outside: f64, film: f64, base: Complex) -> f64 {
    let [s, p] = Airy::new(wavelength, cosine, thickness, outside, film, base).reflectance;
    (0.5 * (s + p)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rgb, fresnel};

    /// Wavelength and thickness in nm, the indices, degrees, and Rs, Rp, Ts, Tp by characteristic matrices with 50
    /// digits.
    type Row = (f64, f64, [f64; 2], [f64; 2], f64, [f64; 4]);

    const ROWS: [Row; 13] = [
        (550.0, 100.0, [1.0, 1.33], [1.0, 0.0], 0.0, same(0.0769246216957839, 0.923075378304216)),
        (550.0, 250.0, [1.0, 1.33], [1.0, 0.0], 0.0, same(0.0302157434839881, 0.969784256516012)),
        (
            550.0,
            250.0,
            [1.0, 1.33],
            [1.0, 0.0],
            75.0,
            [0.403205639795743, 0.125301433406343, 0.596794360204257, 0.874698566593657],
        ),
        (
            550.0,
            500.0,
            [1.0, 1.33],
            [1.0, 0.0],
            45.0,
            [0.00525127712530951, 0.000249296644272971, 0.994748722874691, 0.999750703355727],
        ),
        (550.0, 1000.0, [1.0, 1.33], [1.0, 0.0], 0.0, same(0.0198037779838477, 0.980196222016152)),
        (550.0, 10.0, [1.0, 1.33], [1.0, 0.0], 0.0, same(0.00191046488257522, 0.998089535117425)),
        (
            550.0,
            10.0,
            [1.0, 1.33],
            [1.0, 0.0],
            89.0,
            [0.863233816802076, 0.6681898992359, 0.136766183197924, 0.3318101007641],
        ),
        // Magnesium fluoride on glass, a quarter wave at 550 nm.
        (450.0, 99.6376811594203, [1.0, 1.38], [1.52, 0.0], 0.0, same(0.0162043016042977, 0.983795698395702)),
        (650.0, 99.6376811594203, [1.0, 1.38], [1.52, 0.0], 0.0, same(0.0143683515898393, 0.985631648410161)),
        // Half a wave, of any index: it has no effect.
        (600.0, 130.434782608696, [1.0, 2.3], [1.5, 0.0], 0.0, same(0.04, 0.96)),
        // Oil on water.
        (
            500.0,
            300.0,
            [1.0, 1.47],
            [1.33, 0.0],
            30.0,
            [0.0692964437139319, 0.0311437219536463, 0.930703556286068, 0.968856278046354],
        ),
        // An air gap in glass, beyond the critical angle.
        (550.0, 5000.0, [1.5, 1.0], [1.5, 0.0], 60.0, [1.0, 1.0, 2.88536188280328e-41, 1.39631879394639e-41]),
        // Silica on silicon.
        (
            550.0,
            100.0,
            [1.0, 1.46],
            [4.08, 0.028],
            45.0,
            [0.0820896977680009, 0.128025086164491, 0.917910302231999, 0.871974913835509],
        ),
    ];

    const fn same(reflectance: f64, transmittance: f64) -> [f64; 4] {
        [reflectance, reflectance, transmittance, transmittance]
    }

    fn base([eta, k]: [f64; 2]) -> Complex {
        Complex::new(eta, k)
    }

    #[test]
    fn films_reflect_as_in_born_and_wolf() {
        for (wavelength, thickness, [outside, film], below, degrees, [rs, rp, ts, tp]) in ROWS {
            let cosine = f64::to_radians(degrees).cos();
            let found = Airy::new(wavelength, cosine, thickness, outside, film, base(below));
            for (found, truth) in found.reflectance.into_iter().zip([rs, rp]) {
                assert!((found - truth).abs() < 1e-10, "{thickness} {degrees} {found} {truth}");
            }
            for (found, truth) in found.transmittance.into_iter().zip([ts, tp]) {
                assert!((found / truth - 1.0).abs() < 1e-10, "{thickness} {degrees} {found} {truth}");
            }
            let mean = reflectance(wavelength, cosine, thickness, outside, film, base(below));
            assert!((mean - 0.5 * (rs + rp)).abs() < 1e-10);
        }
    }

    #[test]
    fn a_soap_film_of_300_nm_has_its_fringes() {
        for (wavelength, truth) in
            [(400.0, 2.0614e-05), (500.0, 0.070790295), (600.0, 0.058295763), (700.0, 0.014921631)]
        {
            let found = reflectance(wavelength, 1.0, 300.0, 1.0, 1.33, 1.0.into());
            assert!((found - truth).abs() < 6e-10, "{wavelength} {found}");
        }
        let cosine = f64::to_radians(45.0).cos();
        let [s, p] = Airy::new(500.0, cosine, 300.0, 1.0, 1.33, 1.0.into()).reflectance;
        for (found, truth) in [(s, 0.156811922), (p, 0.008708218), (0.5 * (s + p), 0.08276007)] {
            assert!((found - truth).abs() < 6e-10, "{found} {truth}");
        }
    }

    #[test]
    fn over_all_phases_a_film_is_a_thick_plate() {
        // 2r / (1 + r) and (1 − r) / (1 + r): means over equal steps of a period are exact except for high powers of r.
        let period = 550.0 / (2.0 * 1.33);
        let (mut reflected, mut through) = (0.0, 0.0);
        for i in 0..64 {
            let film = Airy::new(550.0, 1.0, period * f64::from(i) / 64.0, 1.0, 1.33, 1.0.into());
            reflected += film.reflectance[0] / 64.0;
            through += film.transmittance[1] / 64.0;
        }
        assert!((reflected - 0.0393296977138936).abs() < 1e-12 && (through - 0.960670302286106).abs() < 1e-12);
    }

    #[test]
    fn without_absorption_all_light_is_reflected_or_goes_through() {
        for [outside, film, below] in [[1.0, 1.33, 1.0], [1.0, 1.47, 1.33], [1.5, 1.0, 1.5], [1.33, 2.4, 1.0]] {
            for thickness in [0.0, 1e-3, 80.0, 730.0, 2e4] {
                for i in 1..=40 {
                    let airy = Airy::new(510.0, f64::from(i) / 40.0, thickness, outside, film, below.into());
                    for side in 0..2 {
                        let all = airy.reflectance[side] + airy.transmittance[side];
                        assert!((all - 1.0).abs() < 1e-12, "{outside} {film} {below} {thickness} {i} {all}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_film_of_no_thickness_is_no_film() {
        let silver = Complex::new(0.05, 3.4);
        for i in 1..=50 {
            let cosine = f64::from(i) / 50.0;
            for film in [0.7, 1.0, 1.33, 2.4] {
                let glass = reflectance(550.0, cosine, 0.0, 1.0, film, 1.5.into());
                assert!((glass - fresnel::dielectric(cosine, 1.5)).abs() < 1e-13, "{cosine} {film}");
                let metal = reflectance(550.0, cosine, 0.0, 1.0, film, silver);
                let truth = fresnel::conductor(cosine, Rgb::splat(silver.re), Rgb::splat(silver.im))[0];
                assert!((metal - truth).abs() < 1e-13, "{cosine} {film} {metal} {truth}");
                assert!(reflectance(550.0, cosine, 0.0, 1.0, film, 1.0.into()) < 1e-13);
            }
        }
    }

    #[test]
    fn both_ways_reflect_alike() {
        // Stokes, 1849: equal from the other side at the refracted angle, and both lossless.
        for [outside, film, below] in [[1.0f64, 1.33, 1.0], [1.0, 1.47, 1.33], [1.0, 1.2, 1.5], [1.33, 2.4, 1.5]] {
            for i in 1..=30 {
                let cosine: f64 = f64::from(i) / 30.0;
                let there = (1.0 - (outside / below).powi(2) * (1.0 - cosine * cosine)).sqrt();
                let one = reflectance(480.0, cosine, 350.0, outside, film, below.into());
                let two = reflectance(480.0, there, 350.0, below, film, outside.into());
                assert!((one - two).abs() < 1e-13, "{one} {two}");
            }
        }
    }

    #[test]
    fn ends_are_numbers() {
        for cosine in [0.0, 1e-300, 1e-12, 1.0] {
            for thickness in [0.0, 1e-300, 1e9, 1e300] {
                for film in [1e-3, 1.0, 1e3] {
                    for below in [Complex::from(1.0), Complex::from(1e-3), Complex::new(1e-9, 1e40)] {
                        let found = reflectance(400.0, cosine, thickness, 1.0, film, below);
                        assert!((0.0..=1.0).contains(&found), "{cosine} {thickness} {film} {below:?} {found}");
                    }
                }
            }
        }
    }
}
