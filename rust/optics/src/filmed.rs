//! Thin films on dielectrics.

use super::Rgb;
use super::interface_split::Split;
use super::spectra::Waves;
use super::thin_film::{self, Complex};

/// A film between two dielectrics. Each channel reflects the integral over wavelengths, clamped to [0, 1], and
/// transmits the rest. So energy is conserved and no channel is negative. Clamping changes a channel by some
/// thousandths at most, where a color is out of gamut.
#[derive(Clone, Copy, Debug)]
pub struct Filmed {
    /// Thickness in nm.
    thickness: f64,
    /// Indices of refraction above, in and below the film.
    indices: [f64; 3],
    /// Wavelengths, one per channel; `None` for red, green and blue.
    waves: Option<Waves>,
}

impl Filmed {
    /// Creates a film with a thickness in nm, and the indices of refraction above, in and below it.
    pub fn new(thickness: f64, indices: [f64; 3]) -> Self {
        Self { thickness, indices, waves: None }
    }

    /// Sets the wavelengths, or red, green and blue.
    pub fn at(self, waves: Option<Waves>) -> Self {
        Self { waves, ..self }
    }

    /// Reflectance at a `cosine` of incidence from above or below.
    pub fn reflectance(&self, cosine: f64, is_above: bool) -> Rgb {
        let [above, film, below] = self.indices;
        let indices = if is_above { [above, film, below] } else { [below, film, above] };
        let cosine = cosine.min(1.0);
        match &self.waves {
            Some(waves) => {
                let [from, film, to] = indices;
                waves.lanes(|nm| thin_film::reflectance(nm, cosine, self.thickness, from, film, Complex::from(to)))
            }
            None => thin_film::on_dielectric(self.thickness, indices, cosine).clamp(Rgb::ZERO, Rgb::ONE),
        }
    }
}

impl Split for Filmed {
    const DIFFERS: bool = true;

    type Share = Rgb;

    #[inline]
    fn reflectance(&self, cosine: f64, _eta: f64, is_above: bool) -> Rgb {
        self.reflectance(cosine, is_above)
    }
}
