//! Input of material evaluation at a surface point.

use super::SurfacePoint;
use super::textures::TexturePoint;
use raywright_base::math::DVec3;

/// A shaded point and its local geometry. Data that no material needs is not computed
/// ([`Needs`](super::textures::Needs)).
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint {
    /// The surface point.
    pub point: SurfacePoint,
    /// Texture lookup data. If texture coordinates are not needed, surface coordinates replace them; for a triangle
    /// these are barycentric.
    pub texture: TexturePoint,
    /// Derivatives of the position by the texture coordinates; zero if these are degenerate.
    pub dp: [DVec3; 2],
    /// Derivatives of the unit shading normal by the texture coordinates.
    pub dn: [DVec3; 2],
    /// Derivatives of the position in its shape's space.
    pub object_dp: [DVec3; 2],
    /// Approximate ratio of lengths there to those in the world.
    pub scale: f64,
    /// True if the point is seen from the side of its normal.
    pub is_front: bool,
    /// Index of refraction on the side of the normal.
    pub outside: f64,
    /// True if normals are used as given, on either side of the geometric normal.
    pub as_given: bool,
}

/// Footprint of a ray: a cone around it (Akenine-Möller et al., "Texture Level of Detail Strategies for Real-Time Ray
/// Tracing", 2019).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// Width at the ray's origin.
    pub width: f64,
    /// Growth of the width per length; negative if rays converge.
    pub spread: f64,
}

impl Footprint {
    /// The footprint at a distance.
    #[inline]
    pub fn at(self, distance: f64) -> Self {
        Self { width: (self.width + self.spread * distance).abs(), ..self }
    }
}

impl ShadingPoint {
    /// Shading data without derivatives, seen from the front.
    #[inline]
    pub fn plain(point: SurfacePoint) -> Self {
        Self {
            texture: TexturePoint { position: point.position, ..TexturePoint::default() },
            point,
            dp: [DVec3::ZERO; 2],
            dn: [DVec3::ZERO; 2],
            object_dp: [DVec3::ZERO; 2],
            scale: 1.0,
            is_front: true,
            outside: 1.0,
            as_given: false,
        }
    }
}
