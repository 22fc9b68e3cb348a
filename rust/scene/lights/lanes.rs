//! Light drawn for sixteen receivers at a time.

use super::triangle::SeenTriangle;
use super::{LightSample, LightSampleContext, Lights, Sides};
use crate::accel::Primitives;
use crate::math::{DVec3, LANES, Ray, VectorLanes};
use crate::optics::Rgb;
use crate::sampling::Pairs;
use crate::scene::geometry::error_among;
use crate::scene::textures::TexturePoint;
use crate::scene::{Geometry, RayOrigin};
use crate::simd::{Level, Loops};

/// Receivers, a lane each.
#[derive(Clone, Debug)]
pub struct LightContextLanes {
    position: VectorLanes,
    normal: VectorLanes,
}

impl LightContextLanes {
    /// Nowhere.
    pub const NONE: Self = Self { position: VectorLanes::ZERO, normal: VectorLanes::ZERO };

    /// That of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> LightSampleContext {
        LightSampleContext { position: self.position.get(lane), normal: self.normal.get(lane) }
    }

    /// Sets that of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, receiver: &LightSampleContext) {
        self.position.set(lane, receiver.position);
        self.normal.set(lane, receiver.normal);
    }
}

/// Light on its way to receivers, a lane each.
#[derive(Clone, Debug)]
pub struct LightLanes {
    direction: VectorLanes,
    weight: VectorLanes,
    /// 0 where the draw gave none.
    pdf: [f64; LANES],
    /// Where it sets out, and the way off the surface there.
    position: VectorLanes,
    offset: VectorLanes,
    /// Whether that is within the scene.
    is_within: [bool; LANES],
    /// On which primitive that is, as [`LightSample`] has it.
    primitive: [u32; LANES],
}

impl LightLanes {
    /// No light.
    pub const NONE: Self = Self {
        direction: VectorLanes::ZERO,
        weight: VectorLanes::ZERO,
        pdf: [0.0; LANES],
        position: VectorLanes::ZERO,
        offset: VectorLanes::ZERO,
        is_within: [false; LANES],
        primitive: [Ray::NO_TRIANGLE; LANES],
    };

    /// The direction that a lane's light comes from, and its weight and density, as [`LightSample`] has them; the
    /// density is 0 where there is none.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> (DVec3, Rgb, f64) {
        (self.direction.get(lane), self.weight.get(lane), self.pdf[lane])
    }

    /// Where a lane's light sets out, and whether that is within the scene.
    #[inline(always)]
    pub fn source(&self, lane: usize) -> (RayOrigin, bool) {
        (RayOrigin::with(self.position.get(lane), self.offset.get(lane)), self.is_within[lane])
    }

    /// On which primitive a lane's light sets out, as [`LightSample`] has it.
    #[inline(always)]
    pub fn primitive(&self, lane: usize) -> u32 {
        self.primitive[lane]
    }

    /// The light of a lane; none where the draw gave none.
    pub fn sample(&self, lane: usize) -> Option<LightSample> {
        let ((direction, weight, pdf), (source, is_within)) = (self.get(lane), self.source(lane));
        let (source, primitive) = (is_within.then_some(source), self.primitive[lane]);
        (pdf > 0.0).then(|| LightSample { direction, weight, pdf, source, primitive })
    }

    /// Sets that of a lane.
    fn set(&mut self, lane: usize, sample: Option<LightSample>) {
        let Some(LightSample { direction, weight, pdf, source, primitive }) = sample else {
            self.pdf[lane] = 0.0;
            return;
        };
        let from = source.unwrap_or(RayOrigin::free(DVec3::ZERO));
        self.direction.set(lane, direction);
        self.weight.set(lane, weight);
        self.pdf[lane] = pdf;
        self.position.set(lane, from.position());
        self.offset.set(lane, from.offset());
        self.is_within[lane] = source.is_some();
        self.primitive[lane] = primitive;
    }
}

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
