//! How points are looked at.

use raywright_optics::spectra::Waves;

/// How a point is looked at: what matters of it beside where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gaze {
    /// How wide the bundle of neighbouring rays is there; 0 if nobody asks.
    pub width: f64,
    /// At which wavelengths; none for red, green and blue.
    pub waves: Option<Waves>,
}

impl From<f64> for Gaze {
    fn from(width: f64) -> Self {
        Self { width, waves: None }
    }
}

impl From<Option<Waves>> for Gaze {
    fn from(waves: Option<Waves>) -> Self {
        Self { width: 0.0, waves }
    }
}
