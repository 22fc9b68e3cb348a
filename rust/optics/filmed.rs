//! Films on what is clear.

use super::split::Split;
use super::{Rgb, thin_film};

/// A film between two clear media. Each channel reflects what the integral over wavelengths says, as far as that lies
/// between 0 and 1, and lets through the rest: nothing is lost, and no light is negative. What is cut off is at most
/// some thousandths, where a colour is too pure for a screen.
#[derive(Clone, Copy, Debug)]
pub struct Filmed {
    /// How thick it is, in nm.
    thickness: f64,
    /// The indices of refraction above it, in it and below it.
    indices: [f64; 3],
}

impl Filmed {
    /// Of a thickness in nm, and the indices of refraction above it, in it and below it.
    pub fn new(thickness: f64, indices: [f64; 3]) -> Self {
        Self { thickness, indices }
    }

    /// The share of light that is reflected at a `cosine` of incidence from above or from below.
    pub fn reflectance(&self, cosine: f64, is_above: bool) -> Rgb {
        let [above, film, below] = self.indices;
        let indices = if is_above { [above, film, below] } else { [below, film, above] };
        thin_film::on_dielectric(self.thickness, indices, cosine.min(1.0)).clamp(Rgb::ZERO, Rgb::ONE)
    }
}

impl Split for Filmed {
    type Share = Rgb;

    #[inline]
    fn reflectance(&self, cosine: f64, _eta: f64, is_above: bool) -> Rgb {
        self.reflectance(cosine, is_above)
    }
}
