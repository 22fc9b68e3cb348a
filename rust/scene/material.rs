//! What surfaces are made of.

use crate::optics::{Bsdf, Diffuse, Rgb, is_radiance};

/// What a surface is made of: gives the [`Bsdf`] at each of its points.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Scatters by Lambert's law, on both sides.
    Diffuse {
        /// The share of the light that is reflected, 0 to 1 in each channel.
        reflectance: Rgb,
    },
}

impl Material {
    /// How it scatters at a point.
    #[inline]
    pub fn bsdf(&self) -> Bsdf {
        match *self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse { reflectance }),
        }
    }

    /// Whether it can be: it reflects no more light than comes in.
    pub fn is_physical(&self) -> bool {
        match *self {
            Self::Diffuse { reflectance } => is_radiance(reflectance) && reflectance.max_element() <= 1.0,
        }
    }
}

impl Default for Material {
    /// Half grey.
    fn default() -> Self {
        Self::Diffuse { reflectance: Rgb::splat(0.5) }
    }
}
