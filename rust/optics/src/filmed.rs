//! Films on what is clear.

use super::Rgb;
use super::spectra::Waves;
use super::split::Split;
use super::thin_film::{self, Complex};

/// A film between two clear media. Each channel reflects what the integral over wavelengths says, as far as that lies
/// between 0 and 1, and lets through the rest: nothing is lost, and no light is negative. What is cut off is at most
/// some thousandths, where a colour is too pure for a screen.
#[derive(Clone, Copy, Debug)]
pub struct Filmed {
    /// How thick it is, in nm.
    thickness: f64,
    /// The indices of refraction above it, in it and below it.
    indices: [f64; 3],
    /// The wavelengths that are asked for, a channel each; none for red, green and blue.
    waves: Option<Waves>,
}

impl Filmed {
    /// Of a thickness in nm, and the indices of refraction above it, in it and below it.
    pub fn new(thickness: f64, indices: [f64; 3]) -> Self {
        Self { thickness, indices, waves: None }
    }

    /// The same at some wavelengths, or for red, green and blue.
    pub fn at(self, waves: Option<Waves>) -> Self {
        Self { waves, ..self }
    }

    /// The share of light that is reflected at a `cosine` of incidence from above or from below.
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
