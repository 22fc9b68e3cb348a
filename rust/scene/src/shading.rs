//! All that shading may want to know of a point.

use super::SurfacePoint;
use super::textures::TexturePoint;
use raywright_base::math::DVec3;

/// A point that is shaded, and how the surface lies there. What nobody needs is not computed
/// ([`Needs`](super::textures::Needs)).
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint {
    /// The point.
    pub point: SurfacePoint,
    /// Where textures are asked. Where texture coordinates are not needed, coordinates on the shape stand for them: of
    /// a triangle the weights of its second and third corner.
    pub texture: TexturePoint,
    /// How the point changes with the texture coordinates; zero where they do not tell points apart.
    pub dp: [DVec3; 2],
    /// How the unit shading normal does.
    pub dn: [DVec3; 2],
    /// How the point in the space of its shape does.
    pub object_dp: [DVec3; 2],
    /// By how much lengths there differ from those of the world, about.
    pub scale: f64,
    /// Whether it is seen from the side that the normal points to.
    pub is_front: bool,
    /// The index of refraction on the side of the normal.
    pub outside: f64,
    /// Whether normals are taken as they are given: none is kept on the side of the point's.
    pub as_given: bool,
}

/// How wide a bundle of neighbouring rays is: a cone around the ray (Akenine-Möller et al., "Texture Level of Detail
/// Strategies for Real-Time Ray Tracing", 2019).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// At the ray's origin.
    pub width: f64,
    /// By how much it widens per length; negative where rays come together.
    pub spread: f64,
}

impl Footprint {
    /// Further along.
    #[inline]
    pub fn at(self, distance: f64) -> Self {
        Self { width: (self.width + self.spread * distance).abs(), ..self }
    }
}

impl ShadingPoint {
    /// What is known of a point from the front without asking for more.
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
