//! Shading normals that are taken as they are given: light does not fade at the geometric horizon, and no normal is
//! bent towards the viewer.

use super::SurfaceInteraction;
use crate::SurfacePoint;
use raywright_base::math::{DVec3, Frame, Ray};
use raywright_optics::Bsdf;

/// The share of light that arrives under a normal that leans from that of its surface, by the cosine between the two
/// and that between the surface's and the light. What leans so is taken for one of many facets, of a roughness that
/// would lean them as much, which stand in one another's light (Estevez, Lecocq and Stein, "A Microfacet-Based
/// Shadowing Function to Solve the Bump Terminator Problem", 2019).
fn shadowing(leaning: f64, light: f64) -> f64 {
    let tangent = |cosine: f64| (1.0 - cosine * cosine).max(0.0) / (cosine * cosine);
    let alpha = (0.125 * tangent(leaning)).min(1.0);
    2.0 / (1.0 + (1.0 + alpha * tangent(light)).sqrt())
}

impl<B: Bsdf> SurfaceInteraction<B> {
    /// As [`SurfaceInteraction::with`], by a normal that is taken as it is given.
    ///
    /// One that the ray would see from another side than the surface's own shading normal is turned half round that.
    pub fn as_given(ray: &Ray, surface: SurfacePoint, (given, tangent): (DVec3, Option<DVec3>), bsdf: B) -> Self {
        let back = -ray.direction;
        let (side, own) = (1f64.copysign(back.dot(surface.normal)), surface.shading_normal);
        let is_turned = own.dot(back) * given.dot(back) <= 0.0;
        let shading = if is_turned { own * (2.0 * own.dot(given)) - given } else { given };
        let frame = match tangent {
            Some(tangent) => Frame::along(shading, tangent),
            None => Frame::new(shading),
        };
        let is_flat = shading == surface.normal;
        // Others may see what a bump makes of it from other sides.
        let is_bent = given != own;
        Self { surface, frame, bsdf, wo: frame.to_local(back), side, is_flat, is_bent, as_given: true, curvature: 0.0 }
    }

    /// How much light from a direction counts: none of what would have to go through the surface to be reflected, or
    /// would not have to be let through, and none that is seen from other sides by two normals of the surface.
    pub(super) fn unfaded(&self, wi: DVec3, direction: DVec3) -> f64 {
        if (wi.z * self.wo.z < 0.0) != self.is_through(direction) {
            return 0.0;
        }
        let (own, shading) = (self.surface.shading_normal, self.frame.normal);
        if shading == own {
            return 1.0;
        }
        let light = own.dot(direction);
        if wi.z * light <= 0.0 { 0.0 } else { shadowing(own.dot(shading), light) }
    }

    /// The same as those see it whose rays come back along a direction; `None` where more than that would differ.
    pub(super) fn met_as_given(&self, direction: DVec3) -> Option<SurfaceInteraction<&B>> {
        let &Self { surface, frame, ref bsdf, side, is_flat, is_bent, as_given, .. } = self;
        let wo = frame.to_local(direction);
        let is_alike = !is_bent && wo.z * self.wo.z > 0.0 && surface.normal.dot(direction) * side > 0.0;
        let met = SurfaceInteraction { surface, frame, bsdf, wo, side, is_flat, is_bent, as_given, curvature: 0.0 };
        is_alike.then_some(met)
    }
}
