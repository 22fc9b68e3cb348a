//! Boundaries of media. Light passes straight through them.

use raywright_base::math::Ray;
use raywright_optics::AnyBsdf;
use raywright_scene::Scene;
use raywright_scene::materials::BsdfMix;

/// Return whether a surface is a mere boundary of media.
pub(super) fn is_boundary(bsdf: &BsdfMix) -> bool {
    matches!(bsdf, BsdfMix::One(AnyBsdf::Null(_)))
}

/// Return which rays are blocked by more than boundaries of media.
pub(super) fn blocked(scene: &Scene, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    scene.occluded(rays, &mut blocked);
    let has_boundaries = (0..scene.geometry().shapes() as u32).any(|shape| scene.material(shape).is_passed());
    if has_boundaries {
        let which: Vec<usize> = (0..rays.len()).filter(|&i| blocked[i]).collect();
        let some: Vec<Ray> = which.iter().map(|&i| rays[i]).collect();
        let crossings = scene.crossings(&some);
        for (ray, i) in (0..).zip(which) {
            blocked[i] = crossings.of_ray(ray).iter().any(|hit| !scene.material_of(hit).is_passed());
        }
    }
    blocked
}
