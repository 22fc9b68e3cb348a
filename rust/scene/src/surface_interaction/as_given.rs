//! Shading normals used as given: no fading at the geometric horizon, and no bending towards the viewer.

use super::SurfaceInteraction;
use crate::SurfacePoint;
use raywright_base::math::{DVec3, Frame, Ray};
use raywright_optics::Bsdf;

/// Shadowing of a shading normal that deviates from its surface's, by the cosine between the two and the light's cosine
/// to the latter. The deviating normal is treated as one facet of a microfacet surface of corresponding roughness,
/// whose facets shadow each other (Estevez, Lecocq and Stein, "A Microfacet-Based Shadowing Function to Solve the Bump
/// Terminator Problem", 2019).
fn shadowing(leaning: f64, light: f64) -> f64 {
    let tangent = |cosine: f64| (1.0 - cosine * cosine).max(0.0) / (cosine * cosine);
    let alpha = (0.125 * tangent(leaning)).min(1.0);
    2.0 / (1.0 + (1.0 + alpha * tangent(light)).sqrt())
}

impl<B: Bsdf> SurfaceInteraction<B> {
    /// [`SurfaceInteraction::with`] for a normal that is used as given.
    ///
    /// A given normal that faces away while the surface's own shading normal faces the ray, or the reverse, is
    /// reflected about the own one.
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
        // A perturbed normal may be visible from other sides for other directions.
        let is_bent = given != own;
        Self { surface, frame, bsdf, wo: frame.to_local(back), side, is_flat, is_bent, as_given: true, curvature: 0.0 }
    }

    /// Weight of a direction without fading. It is 0 if the sides by shading and geometric normal disagree on
    /// transmission, or if the two shading normals see the light on different sides.
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

    /// The same interaction for another outgoing direction; `None` if more than that would differ.
    pub(super) fn met_as_given(&self, direction: DVec3) -> Option<SurfaceInteraction<&B>> {
        let &Self { surface, frame, ref bsdf, side, is_flat, is_bent, as_given, .. } = self;
        let wo = frame.to_local(direction);
        let is_alike = !is_bent && wo.z * self.wo.z > 0.0 && surface.normal.dot(direction) * side > 0.0;
        let met = SurfaceInteraction { surface, frame, bsdf, wo, side, is_flat, is_bent, as_given, curvature: 0.0 };
        is_alike.then_some(met)
    }
}
