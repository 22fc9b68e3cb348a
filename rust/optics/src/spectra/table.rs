//! Tabulated spectra.

use super::{FIRST, LAST, white};

/// The physical quantity of a tabulated spectrum, which determines its extrapolation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A reflectance: 0 beyond the ends.
    Shares,
    /// The power of light: 0 beyond the ends.
    Power,
    /// A property such as an index of refraction: constant beyond the ends.
    Index,
}

/// A spectrum by values at wavelengths, linearly interpolated; that of light is relative to daylight.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// At equal steps in nm from [`FIRST`] on.
    step: f64,
    values: Vec<f64>,
}

impl Table {
    /// Creates a spectrum from increasing wavelengths in nm and their values. `None` if there are none, or their
    /// numbers differ.
    pub fn new(wavelengths: &[f64], values: &[f64], told: Told) -> Option<Self> {
        if wavelengths.is_empty() || wavelengths.len() != values.len() {
            return None;
        }
        let at = |nm: f64| {
            let after = wavelengths.partition_point(|&w| w <= nm);
            let (first, last) = (wavelengths[0], wavelengths[wavelengths.len() - 1]);
            if told != Told::Index && !(first..=last).contains(&nm) {
                return 0.0;
            }
            match (after.checked_sub(1), wavelengths.get(after)) {
                (Some(a), Some(&to)) => {
                    let from = wavelengths[a];
                    values[a] + (values[after] - values[a]) * ((nm - from) / (to - from))
                }
                (Some(a), None) => values[a],
                (None, _) => values[0],
            }
        };
        let count = ((LAST - FIRST) / Self::STEP) as usize + 1;
        let values = (0..count).map(|i| {
            let nm = FIRST + Self::STEP * i as f64;
            if told == Told::Power { at(nm) / white(nm) } else { at(nm) }
        });
        Some(Self { step: Self::STEP, values: values.collect() })
    }

    /// Step between stored values, nm.
    const STEP: f64 = 0.5;

    /// Value at a visible wavelength.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        let steps = (wavelength - FIRST) / self.step;
        let before = (steps as usize).min(self.values.len() - 2);
        let (a, b) = (self.values[before], self.values[before + 1]);
        a + (b - a) * (steps - before as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rgb;
    use crate::spectra::Spectrum;

    #[test]
    fn light_is_told_by_its_luminance_and_shares_by_daylight() {
        // Values of the 1 nm tables of CIE 015:2018.
        let even = Spectrum::Table(Table::new(&[360.0, 830.0], &[1.0; 2], Told::Power).unwrap()).seen();
        assert!((even - Rgb::new(1.205_07, 0.948_22, 0.908_98)).abs().max() < 1e-3, "{even}");
        let flat = Spectrum::Table(Table::new(&[500.0], &[0.4], Told::Index).unwrap());
        assert!((flat.seen() - 0.4).abs().max() < 1e-12);
        assert_eq!(flat.range(), [0.4; 2]);
        let slope = Table::new(&[400.0, 600.0], &[0.0, 1.0], Told::Index).unwrap();
        for (nm, value) in [(360.0, 0.0), (400.0, 0.0), (450.25, 0.25125), (600.0, 1.0), (830.0, 1.0)] {
            assert!((slope.at(nm) - value).abs() < 1e-12, "{nm}");
        }
        let share = Table::new(&[400.0, 600.0], &[0.5, 1.0], Told::Shares).unwrap();
        assert_eq!([399.5, 400.0, 600.0, 600.5].map(|nm| share.at(nm)), [0.0, 0.5, 1.0, 0.0]);
        assert!(Table::new(&[], &[], Told::Power).is_none() && Table::new(&[1.0], &[], Told::Power).is_none());
    }
}
