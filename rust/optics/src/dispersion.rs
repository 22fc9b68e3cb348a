//! Dispersion of the index of refraction.

use std::sync::OnceLock;

/// Index of refraction as a function of wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Dispersion {
    /// n = B + C / λ², with λ in micrometers (Cauchy, 1836).
    Cauchy([f64; 2]),
    /// n² = 1 + Σ B λ² / (λ² − C), with λ² and C in square micrometers (Sellmeier, 1871).
    Sellmeier(Vec<[f64; 2]>),
}

impl Dispersion {
    /// Index of refraction at a wavelength in nm.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        let square = wavelength * wavelength * 1e-6;
        match self {
            Self::Cauchy([b, c]) => b + c / square,
            Self::Sellmeier(terms) => {
                let sum: f64 = terms.iter().map(|[b, c]| b * square / (square - c)).sum();
                (1.0 + sum).sqrt()
            }
        }
    }

    /// Returns whether the index is finite and positive between two wavelengths in nm.
    pub fn is_physical(&self, first: f64, last: f64) -> bool {
        let steps = 1000;
        let at = |i: u32| self.at(first + (last - first) * f64::from(i) / f64::from(steps));
        (0..=steps).all(|i| at(i).is_finite() && at(i) > 0.0)
    }
}

/// A handle to a dispersion, so that materials stay small. Each dispersion is stored once and never freed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dispersive(Option<std::num::NonZeroU16>);

/// Maximum number of different dispersions.
const MOST: usize = 4096;

static KEPT: [OnceLock<Dispersion>; MOST] = [const { OnceLock::new() }; MOST];

impl Dispersive {
    /// No dispersion.
    pub const NONE: Self = Self(None);

    /// The handle of a dispersion; `None` if there are too many different ones.
    pub fn of(dispersion: Dispersion) -> Option<Self> {
        for (number, slot) in KEPT.iter().enumerate() {
            if *slot.get_or_init(|| dispersion.clone()) == dispersion {
                return Some(Self(std::num::NonZeroU16::new(number as u16 + 1)));
            }
        }
        None
    }

    /// Returns whether there is dispersion.
    #[inline]
    pub fn is_any(self) -> bool {
        self.0.is_some()
    }

    /// Index of refraction at a wavelength in nm; `None` without dispersion.
    #[inline]
    pub fn at(self, wavelength: f64) -> Option<f64> {
        let kept = KEPT.get(usize::from(self.0?.get()) - 1)?;
        Some(kept.get()?.at(wavelength))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_has_the_index_of_its_data_sheet() {
        let bk7 = Dispersion::Sellmeier(vec![
            [1.039_612_12, 0.006_000_698_67],
            [0.231_792_344, 0.020_017_914_4],
            [1.010_469_45, 103.560_653],
        ]);
        assert!((bk7.at(587.5618) - 1.5168).abs() < 1e-6);
        let kept = Dispersive::of(bk7.clone()).unwrap();
        assert_eq!(Dispersive::of(bk7.clone()), Some(kept));
        assert_eq!(kept.at(400.0), Some(bk7.at(400.0)));
        let other = Dispersive::of(Dispersion::Cauchy([1.5, 0.004])).unwrap();
        assert!(other != kept && other.at(500.0) == Some(1.5 + 0.016));
        assert!(!Dispersive::NONE.is_any() && Dispersive::NONE.at(500.0).is_none());
        assert!(bk7.is_physical(360.0, 830.0) && !Dispersion::Cauchy([1.0, -1.0]).is_physical(360.0, 830.0));
    }
}
