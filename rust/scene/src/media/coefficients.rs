//! Coefficients of participating media.

use raywright_optics::Rgb;

/// Coefficients of a medium, per unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Extinction coefficient: absorption plus scattering.
    pub extinction: Rgb,
    /// Scattering coefficient.
    pub scattering: Rgb,
    /// Emitted radiance per unit length, equal in all directions.
    pub emission: Rgb,
}

impl Coefficients {
    /// Coefficients of vacuum.
    pub const NONE: Self = Self { extinction: Rgb::ZERO, scattering: Rgb::ZERO, emission: Rgb::ZERO };

    /// Coefficients from absorption, scattering and emission.
    pub fn new(absorption: Rgb, scattering: Rgb, emission: Rgb) -> Self {
        Self { extinction: absorption + scattering, scattering, emission }
    }

    /// Scales the medium by a density per channel.
    #[inline]
    pub fn times(&self, density: Rgb) -> Self {
        Self {
            extinction: self.extinction * density,
            scattering: self.scattering * density,
            emission: self.emission * density,
        }
    }

    /// Transmittance over a distance by the Beer-Lambert law; the distance may be infinite.
    #[inline]
    pub fn left(&self, distance: f64) -> Rgb {
        left(self.extinction, distance)
    }

    /// Emitted radiance that arrives at one end of a segment: ∫ j e^(−σs) ds.
    #[inline]
    pub fn glow(&self, distance: f64) -> Rgb {
        let of = |channel: usize| {
            let (sigma, glow) = (self.extinction[channel], self.emission[channel]);
            match (glow, sigma) {
                (0.0, _) => 0.0,
                (_, 0.0) => glow * distance,
                // (1 − e^(−σd)) / σ without cancellation.
                _ => glow * -(-sigma * distance).exp_m1() / sigma,
            }
        };
        Rgb::new(of(0), of(1), of(2))
    }

    /// Returns whether all coefficients are finite and not negative.
    pub fn is_physical(&self) -> bool {
        [self.extinction, self.scattering, self.emission].into_iter().all(Rgb::is_radiance)
    }
}

/// Transmittance of an extinction over a distance, which may be infinite.
#[inline]
pub(super) fn left(extinction: Rgb, distance: f64) -> Rgb {
    // 0 times infinity is NaN; without extinction the transmittance is 1.
    extinction.map(|sigma| if sigma == 0.0 { 1.0 } else { (-sigma * distance).exp() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_dimmed_by_beers_and_lamberts_law_from_thin_to_thick() {
        let of = |depth: f64| Coefficients::new(Rgb::splat(0.25 * depth), Rgb::splat(0.75 * depth), Rgb::ZERO);
        for (depth, expected) in [
            (1e-6, 0.999_999_000_000_5),
            (1.0, 0.36787944117144233),
            (5.0, 0.006737946999085467),
            (10.0, 4.5399929762484854e-05),
            // e⁻¹⁰⁰⁰⁰ underflows.
            (1e4, 0.0),
        ] {
            assert!((of(depth).left(1.0) - expected).abs().max() <= 1e-15 * f64::max(expected, 1e-6), "{depth}");
        }
        assert_eq!(of(0.0).left(f64::INFINITY), Rgb::ONE);
        assert_eq!(of(1.0).left(f64::INFINITY), Rgb::ZERO);
    }

    #[test]
    fn glowing_gas_is_as_bright_as_its_source_where_it_is_deep() {
        // Source function 2, extinction 0.8, distance 3 and a wall of radiance 5 behind: 2 (1 − e^−2.4) + 5 e^−2.4.
        let gas = Coefficients::new(Rgb::splat(0.8), Rgb::ZERO, Rgb::splat(1.6));
        let seen = gas.glow(3.0) + gas.left(3.0) * 5.0;
        assert!((seen - 2.27215385986824).abs().max() < 1e-12);
        assert!((gas.glow(f64::INFINITY) - 2.0).abs().max() < 1e-15);
        let clear = Coefficients { extinction: Rgb::ZERO, ..gas };
        assert!((clear.glow(3.0) - 4.8).abs().max() < 1e-15);
        assert_eq!(Coefficients::NONE.glow(f64::INFINITY), Rgb::ZERO);
    }
}
