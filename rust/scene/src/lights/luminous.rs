//! Emissive surfaces that transmit straight rays: alpha masks and medium boundaries.

use super::Emission;
use super::choice::{MOST, Strength};
use super::light::strength;
use crate::materials::Material;
use crate::textures::Needs;
use crate::{Geometry, LookupContext, SurfacePoint};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_shapes::{Point, Shape};

/// Emission of a surface, and its material if rays may pass straight through.
#[derive(Clone, Copy)]
pub(super) struct Luminous<'a> {
    pub emission: &'a Emission,
    pub open: Option<&'a dyn Material>,
}

/// Returns whether rays may pass straight through a material.
pub(super) fn is_open(material: &dyn Material) -> bool {
    !material.is_opaque() || material.boundary().is_some()
}

/// Lower bound on the transmission used for selecting a point on an emitter. A surface that hides a point from one
/// receiver need not hide it from another, so no point may have probability 0.
const LEAST: f64 = 1.0 / 16.0;

impl<'a> Luminous<'a> {
    pub fn new(emission: &'a Emission, material: &'a dyn Material) -> Self {
        Self { emission, open: is_open(material).then_some(material) }
    }

    /// A strength reduced by the mask's mean opacity.
    pub fn strength(&self, of: impl FnOnce(f64) -> Strength) -> Strength {
        let radiance = strength(self.emission.radiance.mean());
        of(self.open.map_or(radiance, |material| radiance * material.mean_opacity()))
    }

    /// The lookup data that evaluation needs.
    pub fn needs(&self) -> Needs {
        self.open.map_or(self.emission.needs(), |material| self.emission.needs() | material.needs())
    }

    /// Radiance back along a ray of unit direction: emission times opacity.
    #[inline]
    pub fn sent<G: Into<LookupContext>>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        hit: &Hit,
        surface: &SurfacePoint,
        gaze: impl FnOnce() -> G,
    ) -> Rgb {
        let sent = self.emission.sent(geometry, ray, hit, surface, gaze);
        match self.open {
            Some(material) if !sent.is_black() => sent * crate::opacity_at(material, geometry, ray, hit, surface),
            _ => sent,
        }
    }
}

/// Samples one of the points of a shape along a direction from a position, by a number in [0, 1), and returns it with
/// its probability. The probability is proportional to the point's radiance times the transmission of the points in
/// front. `sends` returns radiance and opacity of a point. Returns `None` if no point emits.
///
/// The density of the direction accounts for all of its points ([`Shape::sample_from`]).
pub(super) fn along(
    shape: &dyn Shape,
    (place, way): (DVec3, DVec3),
    mut u: f64,
    mut sends: impl FnMut(&Point) -> Option<(Rgb, f64)>,
) -> Option<(Point, f64)> {
    let ray = Ray { t_min: f64::MIN_POSITIVE, ..Ray::new(place, way) };
    let length = way.length();
    let (mut chosen, mut sum, mut through) = (None, 0.0, 1.0);
    shape.meet(&ray, &mut |met| {
        let point = shape.point(&ray, met.t, met.uv);
        // A position on the shape does not see itself, even if rounding has moved it off the surface.
        if met.t * length <= 4.0 * point.error {
            return false;
        }
        let Some((sent, opacity)) = sends(&point) else { return false };
        let brings = sent.mean().min(MOST) * through;
        through *= (1.0 - opacity).max(LEAST);
        if brings > 0.0 {
            // One-pass weighted reservoir sampling (Chao, 1982); the remaining random number is uniform.
            sum += brings;
            let share = brings / sum;
            if u < share {
                (chosen, u) = (Some((point, brings)), u / share);
            } else {
                u = (u - share) / (1.0 - share);
            }
        }
        false
    });
    chosen.map(|(point, brings)| (point, brings / sum))
}

/// A number in [0, 1) from the low digits of another, which barely affect its direction.
pub(super) fn fine_digits(u: f64) -> f64 {
    (u * f64::from(1 << 16)).fract()
}
