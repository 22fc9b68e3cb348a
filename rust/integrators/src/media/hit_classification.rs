//! Classification of hits of rays in media.

use super::current_medium::Filled;
use crate::nesting::{Boundary, Filling, MediumStack, Vicinity, around};
use raywright_base::math::{Hit, Ray};
use raywright_scene::{Scene, SurfaceInteraction};

/// The classification of a hit.
pub(crate) enum ClassifiedHit {
    /// A medium boundary or nothing. The ray continues from this `t` in these media.
    Passed(f64, MediumStack<Filled>),
    /// A surface.
    Surface {
        /// Its hit.
        hit: Hit,
        /// Index of refraction outside a closed object, or around an open one.
        outside: f64,
        /// Media of a transmitted ray.
        through: MediumStack<Filled>,
        /// Start `t` of a ray that continues straight on.
        beyond: f64,
    },
}

/// Classify a hit of a ray in given media. A boundary that neither reflects nor refracts is no surface, unless an open
/// surface coincides with it, such as the floor under smoke.
pub(crate) fn meet(scene: &Scene, ray: &Ray, hit: &Hit, media: &MediumStack<Filled>) -> ClassifiedHit {
    let around = around::<Filled>(scene, ray, hit);
    let at = (hit, around.beyond(hit));
    match around {
        Vicinity::Open => {
            let outside = media.ior_around(scene, hit);
            ClassifiedHit::Surface { hit: *hit, outside, through: *media, beyond: at.1 }
        }
        Vicinity::Nothing(_) => classify(scene, ray, at, media, std::slice::from_ref(hit)),
        Vicinity::Window(window) => classify(scene, ray, at, media, &scene.crossings(&[window]).hits),
    }
}

/// Classify a hit of a closed surface, given all hits at its position and the `t` from which the ray continues.
pub(crate) fn classify(
    scene: &Scene,
    ray: &Ray,
    (hit, beyond): (&Hit, f64),
    media: &MediumStack<Filled>,
    crossed: &[Hit],
) -> ClassifiedHit {
    let through = match Boundary::new(scene, ray, media, crossed) {
        Boundary::None(media) => media,
        Boundary::Between { hit: owner, outside, through } => {
            let material = scene.material_of(&owner);
            let is_matched = material.is_clear() && material.interior().is_some_and(|inside| inside.ior == outside);
            if !is_matched && !material.is_passed() {
                let is_same = owner.primitive == hit.primitive && owner.inner == hit.inner;
                return ClassifiedHit::Surface { hit: if is_same { *hit } else { owner }, outside, through, beyond };
            }
            through
        }
    };
    let is_sheet = |hit: &&Hit| Filled::of(scene, hit).is_none() && scene.material_of(hit).is_opaque();
    match crossed.iter().find(is_sheet) {
        Some(sheet) => ClassifiedHit::Surface { hit: *sheet, outside: media.ior_around(scene, sheet), through, beyond },
        None => ClassifiedHit::Passed(beyond, through),
    }
}

/// Return the share of light that passes straight through a surface
/// ([`raywright_scene::materials::Material::straight`]).
pub(crate) fn straight(scene: &Scene, ray: &Ray, hit: &Hit, outside: f64) -> f64 {
    let material = scene.material_of(hit);
    if material.boundary().is_none() {
        return 0.0;
    }
    let surface = scene.geometry().surface(ray, hit);
    let here = SurfaceInteraction::new(scene, ray, hit, surface, None, outside);
    // Shadow ray directions have the length of the segment.
    material.straight((here.wo().z.abs() / ray.direction.length()).min(1.0), outside)
}
