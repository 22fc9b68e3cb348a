//! Measured metals.

mod curve;
mod filmed;
mod measured;
mod reflectance;

pub use curve::Curve;
pub use filmed::{FilmedCurve, FilmedMetal};
pub use measured::METALS;
pub use reflectance::Reflectance;

use super::spectra;
use std::fmt;
use std::sync::OnceLock;

/// A metal whose complex index of refraction η + ik was measured at wavelengths from below [`spectra::FIRST`] to beyond
/// [`spectra::LAST`].
pub struct Metal {
    /// Chemical symbol.
    pub symbol: &'static str,
    /// English name.
    pub name: &'static str,
    /// Wavelengths in nm, increasing, with η and k.
    pub index: &'static [[f64; 3]],
    curve: OnceLock<Curve>,
}

impl Metal {
    const fn new(symbol: &'static str, name: &'static str, index: &'static [[f64; 3]]) -> Self {
        Self { symbol, name, index, curve: OnceLock::new() }
    }

    /// η and k at a visible wavelength, linearly interpolated.
    ///
    /// # Panics
    /// For an invisible wavelength.
    pub fn index_at(&self, wavelength: f64) -> (f64, f64) {
        let [_, eta, k] = spectra::at(self.index, wavelength).expect("what is seen was measured");
        (eta, k)
    }

    /// RGB reflectance; computed on first use.
    pub fn curve(&self) -> &Curve {
        self.curve.get_or_init(|| Curve::new(|wavelength| self.index_at(wavelength)))
    }
}

/// Prints the symbol instead of the tables.
impl fmt::Debug for Metal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol)
    }
}

/// Finds a metal by chemical symbol or English name, case-insensitively.
pub fn metal(name: &str) -> Option<&'static Metal> {
    METALS.iter().find(|metal| name.eq_ignore_ascii_case(metal.symbol) || name.eq_ignore_ascii_case(metal.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metals_are_found_by_symbol_and_name() {
        assert_eq!(metal("au").unwrap().name, "gold");
        assert_eq!(metal("Gold").unwrap().symbol, "Au");
        assert_eq!(metal("Al").unwrap().name, "aluminium");
        assert!(metal("unobtainium").is_none());
        for (i, one) in METALS.iter().enumerate() {
            assert!(METALS[i + 1..].iter().all(|other| other.symbol > one.symbol && other.name != one.name));
        }
    }

    #[test]
    fn all_that_is_seen_was_measured() {
        for metal in &METALS {
            assert!(metal.index.is_sorted_by(|a, b| a[0] < b[0]), "{metal:?}");
            assert!(
                metal.index[0][0] <= spectra::FIRST && metal.index.last().unwrap()[0] >= spectra::LAST,
                "{metal:?}"
            );
            assert!(metal.index.iter().all(|[_, eta, k]| *eta > 0.0 && *k > 0.0), "{metal:?}");
            for wavelength in [spectra::FIRST, spectra::LAST] {
                assert!(metal.index_at(wavelength).0 > 0.0);
            }
        }
    }
}
