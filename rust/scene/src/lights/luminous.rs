//! Surfaces that shine and let rays go on through them: masks, and what light passes straight.

use super::Emission;
use super::choice::{MOST, Strength};
use super::light::strength;
use crate::materials::Material;
use crate::textures::Needs;
use crate::{Gaze, Geometry, SurfacePoint};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_shapes::{Point, Shape};

/// How a surface shines, and the material of one that rays may go on through.
#[derive(Clone, Copy)]
pub(super) struct Luminous<'a> {
    pub emission: &'a Emission,
    pub open: Option<&'a dyn Material>,
}

/// Whether rays that meet a material may go on through it as if it were not there.
pub(super) fn is_open(material: &dyn Material) -> bool {
    !material.is_opaque() || material.boundary().is_some()
}

/// The least share of light that is taken to get through a surface to the next one. What a surface hides from one
/// receiver it need not hide from another, so that no point may be left out.
const LEAST: f64 = 1.0 / 16.0;

impl<'a> Luminous<'a> {
    pub fn new(emission: &'a Emission, material: &'a dyn Material) -> Self {
        Self { emission, open: is_open(material).then_some(material) }
    }

    /// A strength as seen through its mask: the mean opacity of it.
    pub fn strength(&self, of: impl FnOnce(f64) -> Strength) -> Strength {
        let radiance = strength(self.emission.radiance.mean());
        of(self.open.map_or(radiance, |material| radiance * material.mean_opacity()))
    }

    /// What must be known of a point.
    pub fn needs(&self) -> Needs {
        self.open.map_or(self.emission.needs(), |material| self.emission.needs() | material.needs())
    }

    /// The radiance that the surface sends back along a ray of unit direction: that of its emission times its opacity.
    #[inline]
    pub fn sent<G: Into<Gaze>>(
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

/// Chooses one of all points of a shape that lie along a direction from a place, by a number in [0, 1), and returns it
/// with its probability: in proportion to what is sent from there, dimmed by the points before. `sends` returns both,
/// and the opacity of the point. None where nothing is sent.
///
/// The density of the direction counts all of its points ([`Shape::sample_from`]).
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
        // A place on the shape is not seen from itself, though rounding may have moved it off the surface.
        if met.t * length <= 4.0 * point.error {
            return false;
        }
        let Some((sent, opacity)) = sends(&point) else { return false };
        let brings = sent.mean().min(MOST) * through;
        through *= (1.0 - opacity).max(LEAST);
        if brings > 0.0 {
            // One pass keeps each with its share of the sum so far (Chao, 1982); what is left of the number is uniform.
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

/// A number in [0, 1) from the digits of another that directions hardly depend on.
pub(super) fn fine_digits(u: f64) -> f64 {
    (u * f64::from(1 << 16)).fract()
}
