//! The medium at a point of a path.

use crate::nesting::{Filling, MediumStack};
use raywright_base::math::{Hit, Ray};
use raywright_optics::Dispersive;
use raywright_scene::Scene;
use raywright_scene::media::Medium;

/// The interior of a closed shape or of one instance. Two instances of a kind are distinct.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Filled {
    priority: i32,
    /// Index of refraction; 0 if it is that of the surroundings.
    ior: f64,
    dispersion: Dispersive,
    /// Primitive that identifies the shape, and the primitive inside an instance.
    shape: (u32, u32),
}

impl Filling for Filled {
    const NONE: Self = Self { priority: i32::MIN, ior: 0.0, dispersion: Dispersive::NONE, shape: (u32::MAX, 0) };

    fn of(scene: &Scene, hit: &Hit) -> Option<Self> {
        let material = scene.material_of(hit);
        let (priority, ior, dispersion) = match material.interior() {
            Some(interior) => (interior.priority, interior.ior, interior.dispersion),
            None => (material.boundary()?, 0.0, Dispersive::NONE),
        };
        Some(Self { priority, ior, dispersion, shape: scene.geometry().first_alike(hit.primitive, hit.inner) })
    }

    /// Compare by priority, then by higher index of refraction, then by later description.
    fn is_above(&self, other: &Self) -> bool {
        let order = |filled: &Self| (filled.priority, filled.ior, filled.shape);
        order(self) > order(other)
    }

    fn ior(&self) -> Option<f64> {
        (self.ior > 0.0).then_some(self.ior)
    }

    fn dispersion(&self) -> Dispersive {
        self.dispersion
    }
}

impl Filled {
    /// Return the shape's identifier.
    pub fn shape(&self) -> (u32, u32) {
        self.shape
    }

    /// Return the identifier of the shape around a point, the same for all its interior points.
    pub fn there(media: &MediumStack<Self>) -> (u32, u32) {
        media.top().unwrap_or(&Self::NONE).shape
    }
}

/// Return the current medium of a ray, and the ray in medium space; `None` in empty space.
pub(crate) fn around<'a>(scene: &'a Scene, media: &MediumStack<Filled>, ray: &Ray) -> Option<(&'a dyn Medium, Ray)> {
    let Some(&Filled { shape: (primitive, inner), .. }) = media.top() else {
        return scene.surrounding().map(|medium| (medium, *ray));
    };
    let medium = scene.material_of(&Hit { primitive, inner, ..Hit::MISS }).medium()?;
    Some((&**medium, scene.geometry().entered(ray, primitive, inner)?))
}
