//! Context of a texture or light lookup.

use raywright_optics::spectra::Waves;

/// Context of a lookup besides the position: filter width and wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LookupContext {
    /// Width of the ray footprint there; 0 if it is not needed.
    pub width: f64,
    /// Wavelengths; `None` for red, green and blue.
    pub waves: Option<Waves>,
}

impl From<f64> for LookupContext {
    fn from(width: f64) -> Self {
        Self { width, waves: None }
    }
}

impl From<Option<Waves>> for LookupContext {
    fn from(waves: Option<Waves>) -> Self {
        Self { width: 0.0, waves }
    }
}
