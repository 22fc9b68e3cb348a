//! Spectral textures.

use super::{Needs, Texture, TexturePoint, Value};
use raywright_optics::Rgb;
use raywright_optics::spectra::{Role, Smooth, Spectrum};
use std::sync::Arc;

/// A constant spectrum.
#[derive(Clone, Debug)]
pub struct Spectral {
    spectrum: Arc<Spectrum>,
    range: [f64; 2],
    /// Its RGB color.
    colour: Rgb,
}

impl Spectral {
    /// Creates a texture from a spectrum.
    pub fn new(spectrum: Arc<Spectrum>) -> Self {
        Self { range: spectrum.range(), colour: spectrum.seen().at_least(Rgb::ZERO), spectrum }
    }

    /// The smooth spectrum of a color; a plain constant if the spectrum is flat, as for grays.
    pub fn of(colour: Rgb, role: Role) -> Value {
        match Smooth::of(colour, role) {
            smooth if smooth.is_flat() => colour.into(),
            smooth => {
                let spectrum = Arc::new(Spectrum::Smooth(smooth));
                Value::Texture(Arc::new(Self { range: [colour.min(), colour.max()], colour, spectrum }))
            }
        }
    }
}

impl Texture for Spectral {
    fn at(&self, point: &TexturePoint) -> Rgb {
        point.waves.as_ref().map_or(self.colour, |waves| self.spectrum.lanes(waves))
    }

    fn range(&self) -> [Rgb; 2] {
        self.range.map(Rgb::splat)
    }

    fn mean(&self) -> Rgb {
        self.colour
    }

    fn needs(&self) -> Needs {
        Needs { waves: true, ..Needs::NONE }
    }
}

/// A texture whose colors are upsampled to smooth spectra.
#[derive(Clone, Debug)]
pub struct Upsampled {
    /// The colors.
    pub colours: Arc<dyn Texture>,
    /// The physical quantity of the colors.
    pub role: Role,
}

impl Texture for Upsampled {
    fn at(&self, point: &TexturePoint) -> Rgb {
        let colour = self.colours.at(point);
        match &point.waves {
            Some(waves) => Smooth::looked_up(colour.at_least(Rgb::ZERO), self.role).lanes(waves),
            None => colour,
        }
    }

    fn range(&self) -> [Rgb; 2] {
        self.colours.range()
    }

    fn mean(&self) -> Rgb {
        self.colours.mean()
    }

    fn needs(&self) -> Needs {
        Needs { waves: true, ..self.colours.needs() }
    }
}
