//! What fills the space that a path is in.

use crate::nesting::{Filling, MediumStack};
use raywright_base::math::{Hit, Ray};
use raywright_optics::Dispersive;
use raywright_scene::Scene;
use raywright_scene::media::Medium;

/// What fills a closed shape, or one copy of it: two of the same kind are two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Filled {
    priority: i32,
    ior: Option<f64>,
    dispersion: Dispersive,
    /// The primitive that stands for the shape, and of an instance the one in it.
    shape: (u32, u32),
}

impl Filling for Filled {
    const NONE: Self = Self { priority: i32::MIN, ior: None, dispersion: Dispersive::NONE, shape: (u32::MAX, 0) };

    fn of(scene: &Scene, hit: &Hit) -> Option<Self> {
        let material = scene.material_of(hit);
        let (priority, ior, dispersion) = match material.interior() {
            Some(interior) => (interior.priority, Some(interior.ior), interior.dispersion),
            None => (material.boundary()?, None, Dispersive::NONE),
        };
        Some(Self { priority, ior, dispersion, shape: scene.geometry().first_alike(hit.primitive, hit.inner) })
    }

    /// By priority; of equal ones, what refracts more; of those, what was described later.
    fn is_above(&self, other: &Self) -> bool {
        let order = |filled: &Self| (filled.priority, filled.ior.unwrap_or(0.0), filled.shape);
        order(self) > order(other)
    }

    fn ior(&self) -> Option<f64> {
        self.ior
    }

    fn dispersion(&self) -> Dispersive {
        self.dispersion
    }
}

impl Filled {
    /// What stands for the shape.
    pub fn shape(&self) -> (u32, u32) {
        self.shape
    }

    /// What stands for the shape that is around a point in some media, the same for all points in it.
    pub fn there(media: &MediumStack<Self>) -> (u32, u32) {
        media.top().unwrap_or(&Self::NONE).shape
    }
}

/// The medium that a ray is in, and the ray in the space in which that is described. None where space is clear.
pub(super) fn around<'a>(scene: &'a Scene, media: &MediumStack<Filled>, ray: &Ray) -> Option<(&'a dyn Medium, Ray)> {
    let Some(&Filled { shape: (primitive, inner), .. }) = media.top() else {
        return scene.surrounding().map(|medium| (medium, *ray));
    };
    let medium = scene.material_of(&Hit { primitive, inner, ..Hit::MISS }).medium()?;
    Some((&**medium, scene.geometry().entered(ray, primitive, inner)?))
}
