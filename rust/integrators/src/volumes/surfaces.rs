//! What a ray among media comes to.

use super::asking::{Alone, Asks, at_once};
use super::filled::Filled;
use crate::nesting::{Boundary, Filling, MediumStack, around};
use raywright_base::math::{Hit, Ray};
use raywright_scene::{Scene, SurfaceInteraction};

/// What a ray has come to.
pub(crate) enum Met {
    /// Nothing: another medium begins there, or not even that. The ray goes on from this `t` in these media.
    Passed(f64, MediumStack<Filled>),
    /// A surface.
    Surface {
        /// Which hit has it.
        hit: Hit,
        /// The index of refraction on the other side of what it encloses, or around what encloses nothing.
        outside: f64,
        /// What a ray that goes through is in.
        through: MediumStack<Filled>,
        /// The `t` from which a ray goes on that passes straight.
        beyond: f64,
    },
}

/// What it is that a ray in some media has hit. Where neither light is reflected nor bent, there is no surface, unless
/// one that encloses nothing stands at the same place, as the floor that smoke lies on.
pub(super) async fn come_to(
    (scene, asks): (&Scene, impl Asks),
    ray: &Ray,
    hit: &Hit,
    media: &MediumStack<Filled>,
) -> Met {
    let Some(window) = around::<Filled>(scene, ray, hit) else {
        let outside = media.ior_around(scene, hit);
        return Met::Surface { hit: *hit, outside, through: *media, beyond: hit.t.next_up() };
    };
    let beyond = window.t_max.next_up();
    asks.crossed(&window, |crossed| meet_at(scene, ray, (hit, beyond), media, crossed)).await
}

/// As [`come_to`], of a ray by itself.
pub(crate) fn meet(scene: &Scene, ray: &Ray, hit: &Hit, media: &MediumStack<Filled>) -> Met {
    at_once(come_to((scene, Alone(scene)), ray, hit, media))
}

/// The same by all that is crossed about the hit, beyond which the ray goes on from a `t`.
fn meet_at(scene: &Scene, ray: &Ray, (hit, beyond): (&Hit, f64), media: &MediumStack<Filled>, crossed: &[Hit]) -> Met {
    let through = match Boundary::new(scene, ray, media, crossed) {
        Boundary::None(media) => media,
        Boundary::Between { hit: owner, outside, through } => {
            let material = scene.material_of(&owner);
            let is_matched = material.is_clear() && material.interior().is_some_and(|inside| inside.ior == outside);
            if !is_matched && !material.is_passed() {
                let is_same = owner.primitive == hit.primitive && owner.inner == hit.inner;
                return Met::Surface { hit: if is_same { *hit } else { owner }, outside, through, beyond };
            }
            through
        }
    };
    let is_sheet = |hit: &&Hit| Filled::of(scene, hit).is_none() && scene.material_of(hit).is_opaque();
    match crossed.iter().find(is_sheet) {
        Some(sheet) => Met::Surface { hit: *sheet, outside: media.ior_around(scene, sheet), through, beyond },
        None => Met::Passed(beyond, through),
    }
}

/// The share of a ray that goes straight on through a surface ([`raywright_scene::materials::Material::straight`]).
pub(super) fn straight(scene: &Scene, ray: &Ray, hit: &Hit, outside: f64) -> f64 {
    let material = scene.material_of(hit);
    if material.boundary().is_none() {
        return 0.0;
    }
    let surface = scene.geometry().surface(ray, hit);
    let here = SurfaceInteraction::new(scene, ray, hit, surface, None, outside);
    // Rays to lights are as long as the way there.
    material.straight((here.wo().z.abs() / ray.direction.length()).min(1.0), outside)
}
