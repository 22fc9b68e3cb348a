//! Direct light from lamps, with soft shadows by cones.

use super::cone::ConeHit;
use crate::Job;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::Rgb;
use raywright_scene::{ConeFilter, Coverage, Interaction, LightSample};
use raywright_shapes::triangle::SolidCone;

/// An emissive primitive and its shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    primitive: u32,
    shape: u32,
}

/// Return all emissive primitives of a scene.
pub(super) fn lamps(job: &Job) -> Vec<Lamp> {
    let (geometry, lights) = (job.scene.geometry(), job.scene.lights());
    let shapes = (0..geometry.shapes() as u32).filter(|&shape| lights.shines(shape));
    shapes.flat_map(|shape| geometry.primitives_of(shape).map(move |primitive| Lamp { primitive, shape })).collect()
}

/// The solid angle of a lamp from a point.
struct LampCone {
    direction: DVec3,
    distance: f64,
    /// Half angle of the equivalent cone, in radians.
    angle: f64,
    /// Factor from radiance to irradiance on a surface that faces the lamp.
    solid_angle: f64,
}

impl Lamp {
    /// Return the lamp's cone from a point; `None` if it is not visible. A face is replaced by a cone about its center
    /// of the same solid angle.
    fn seen_from(&self, job: &Job, from: DVec3) -> Option<LampCone> {
        let geometry = job.scene.geometry();
        if let Some((center, radius)) = geometry.shape(self.primitive).and_then(|shape| shape.ball()) {
            let way = center - from;
            let distance = way.length();
            let sine = radius / distance;
            // For a sphere above the horizon, π sin² times the cosine to its center is exact.
            return (sine < 1.0).then(|| LampCone {
                direction: way / distance,
                distance,
                angle: sine.asin(),
                solid_angle: std::f64::consts::PI * sine * sine,
            });
        }
        let [a, b, c] = geometry.corners(self.primitive).map(|corner| corner - from);
        let way = (a + b + c) / 3.0;
        let distance = way.length();
        let [l, m, n] = [a, b, c].map(DVec3::length);
        let below = l * m * n + a.dot(b) * n + b.dot(c) * l + c.dot(a) * m;
        let solid_angle = 2.0 * a.dot(b.cross(c)).abs().atan2(below);
        let angle = 2.0 * (solid_angle / (4.0 * std::f64::consts::PI)).sqrt().asin();
        let is_seen = distance > 0.0 && angle > 0.0 && angle < std::f64::consts::FRAC_PI_2;
        is_seen.then(|| LampCone { direction: way / distance, distance, angle, solid_angle })
    }
}

/// Return the reflected light of all lamps and lights.
pub(super) fn light(job: &Job, coverage: &Coverage, lamps: &[Lamp], met: &ConeHit) -> Rgb {
    let mut light = Rgb::ZERO;
    let here = &met.here;
    let receiver = here.light_context();
    let origin = here.ray_origin();
    for lamp in job.scene.lights().others() {
        if let Some(drawn) = lamp.sample(&receiver, [0.5; 2]) {
            let arriving = here.evaluate(drawn.direction).0 * drawn.weight;
            if !arriving.is_black() && is_free(job, met, &drawn) {
                light += arriving;
            }
        }
    }
    for lamp in lamps {
        if lamp.primitive == met.hit.primitive {
            continue;
        }
        let from = origin.position();
        let Some(sight) = lamp.seen_from(job, from) else { continue };
        let scattered = here.evaluate(sight.direction).0;
        if scattered.is_black() {
            continue;
        }
        let Some(radiance) = met.shown(job, &Ray::new(from, sight.direction), lamp.primitive) else { continue };
        let apex = origin.ray(sight.direction).origin;
        let cone = SolidCone::new(apex, sight.direction, sight.angle.to_degrees(), sight.distance);
        let counted = ConeFilter { without: Some(lamp.shape), ..ConeFilter::default() };
        let free = cone.map_or(0.0, |cone| 1.0 - coverage.share(&cone, counted));
        light += scattered * radiance * (sight.solid_angle * free);
    }
    light
}

/// Return true if light from a single direction is unoccluded.
fn is_free(job: &Job, met: &ConeHit, drawn: &LightSample) -> bool {
    let origin = met.here.ray_origin();
    let ray = match &drawn.source {
        Some(source) => origin.segment(source),
        None => origin.ray(drawn.direction),
    };
    let mut occluded = [true];
    job.scene.occluded(&[ray], &mut occluded);
    !occluded[0]
}
