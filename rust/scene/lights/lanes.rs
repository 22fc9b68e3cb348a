//! Light drawn for sixteen receivers at a time.

use super::triangle::SeenTriangle;
use super::{LightContextLanes, LightLanes, Lights, Sides};
use crate::accel::Primitives;
use crate::math::{LANES, VectorLanes};
use crate::sampling::Pairs;
use crate::scene::geometry::error_among;
use crate::scene::textures::TexturePoint;
use crate::scene::{Geometry, RayOrigin};
use crate::simd::{Level, Loops};

/// Triangles that shine, a lane each, and how likely each was chosen.
struct Lamps {
    corners: [VectorLanes; 3],
    normal: VectorLanes,
    radiance: VectorLanes,
    /// Whether the front shines, and the back.
    sides: [[bool; LANES]; 2],
    probability: [f64; LANES],
}

/// What is drawn of them.
struct Draw<'a> {
    receivers: &'a LightContextLanes,
    lamps: &'a Lamps,
    u: &'a Pairs,
    lights: &'a mut LightLanes,
}

impl Loops for Draw<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        draw(self.receivers, self.lamps, self.u, self.lights);
    }
}

#[inline(always)]
fn draw(receivers: &LightContextLanes, lamps: &Lamps, u: &Pairs, lights: &mut LightLanes) {
    for i in 0..LANES {
        let shine = |cosine: f64| (lamps.sides[0][i] & (cosine > 0.0)) | (lamps.sides[1][i] & (cosine < 0.0));
        let corners = [lamps.corners[0].get(i), lamps.corners[1].get(i), lamps.corners[2].get(i)];
        let ([a, b, c], normal) = (corners, lamps.normal.get(i));
        let place = receivers.position.get(i);
        let seen = SeenTriangle::new(corners, place);
        let [v, w] = seen.sample([u[0][i], u[1][i]]);
        let position = a * (1.0 - v - w) + b * v + c * w;
        let way = position - place;
        let distance = way.length();
        let direction = way / distance;
        let pdf = seen.pdf(distance, direction.dot(normal));
        let cosine = -direction.dot(normal);
        // Also false where the distance is 0 and the direction NaN.
        let is_lit = shine(seen.height()) & shine(cosine) & (pdf > 0.0) & (pdf < f64::INFINITY);
        let from = RayOrigin::off(position, error_among(corners), normal);
        lights.direction.set(i, direction);
        lights.weight.set(i, lamps.radiance.get(i) / pdf / lamps.probability[i]);
        lights.pdf[i] = if is_lit { pdf * lamps.probability[i] } else { 0.0 };
        lights.position.set(i, from.position());
        lights.offset.set(i, from.offset());
        lights.is_within[i] = true;
    }
}

impl Lights {
    /// What [`Lights::sample`] gives, a lane each: `choice` and `u` are the numbers that it takes.
    pub fn sample_lanes(
        &self,
        level: Level,
        geometry: &Geometry,
        receivers: &LightContextLanes,
        choice: &[f64; LANES],
        u: &Pairs,
        lights: &mut LightLanes,
    ) {
        if let (None, [sky]) = (&self.choice, self.outside.lights()) {
            return sky.sample_lanes(level, receivers, u, lights);
        }
        let (true, Some(choices)) = (self.are_plain_triangles, &self.choice) else {
            for lane in 0..LANES {
                let u = [u[0][lane], u[1][lane]];
                lights.set(lane, self.sample(geometry, &receivers.get(lane), choice[lane], u));
            }
            return;
        };
        let mut lamps = Lamps {
            corners: [VectorLanes::ZERO; 3],
            normal: VectorLanes::ZERO,
            radiance: VectorLanes::ZERO,
            sides: [[false; LANES]; 2],
            probability: [0.0; LANES],
        };
        for (lane, &choice) in choice.iter().enumerate() {
            // A lane without a light has sides that do not shine.
            let Some((chosen, probability)) = choices.sample(&receivers.get(lane), choice) else { continue };
            let primitive = self.surfaces[chosen];
            let emission = self.emission(geometry.locate(primitive).0);
            for (corners, corner) in lamps.corners.iter_mut().zip(geometry.corners(primitive)) {
                corners.set(lane, corner);
            }
            lights.primitive[lane] = primitive;
            lamps.normal.set(lane, geometry.normal(primitive));
            lamps.radiance.set(lane, emission.radiance.at(&TexturePoint::NOWHERE));
            lamps.sides[0][lane] = emission.sides != Sides::Back;
            lamps.sides[1][lane] = emission.sides != Sides::Front;
            lamps.probability[lane] = probability;
        }
        level.compiled(Draw { receivers, lamps: &lamps, u, lights });
    }
}
