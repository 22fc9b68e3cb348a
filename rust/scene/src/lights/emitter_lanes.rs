//! Light sampling in batches of sixteen lanes.

use super::plain::Figure;
use super::triangle::SeenTriangle;
use super::{LightContextLanes, LightLanes, Lights};
use crate::geometry::error_among;
use crate::{Geometry, RayOrigin};
use raywright_base::math::{LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use raywright_optics::RgbLanes;
use raywright_shapes::{Seen, Sphere};
use std::array::from_fn;

/// Emitters, one per lane, with their selection probabilities.
struct Lamps {
    /// Normals of triangles.
    normal: VectorLanes,
    radiance: RgbLanes,
    /// One flag per lane and side: true if the front, or the back, emits.
    sides: [[bool; LANES]; 2],
    probability: [f64; LANES],
}

loops! {
    /// Samples triangles, one per lane.
    fn draw(
        receivers: &LightContextLanes,
        corners: &[VectorLanes; 3],
        lamps: &Lamps,
        u: &Pairs,
        lights: &mut LightLanes,
    ) {
        for i in 0..LANES {
            let shine = |cosine: f64| (lamps.sides[0][i] & (cosine > 0.0)) | (lamps.sides[1][i] & (cosine < 0.0));
            let corners = [corners[0].get(i), corners[1].get(i), corners[2].get(i)];
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
            // Also false if the distance is 0 and the direction NaN.
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
}

/// Emissive spheres, one per lane.
struct Balls {
    center: VectorLanes,
    radius: [f64; LANES],
}

loops! {
    /// Samples spheres, one per lane, from receivers outside them. `outside` is 1 in those lanes; other lanes are
    /// undefined.
    fn draw_balls(
        receivers: &LightContextLanes,
        balls: &Balls,
        lamps: &Lamps,
        u: &Pairs,
        direction: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
        position: &mut VectorLanes,
        offset: &mut VectorLanes,
        outside: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let shine = |cosine: f64| (lamps.sides[0][i] & (cosine > 0.0)) | (lamps.sides[1][i] & (cosine < 0.0));
            let (place, sphere) =
                (receivers.position.get(i), Sphere { center: balls.center.get(i), radius: balls.radius[i] });
            let (Seen { site, pdf: density }, is_outside) = sphere.sight_from_outside(place, [u[0][i], u[1][i]]);
            let way = site.position - place;
            let towards = way / way.length();
            // Also false if the distance is 0 and the direction NaN.
            let is_lit = shine(-towards.dot(site.normal)) & (density > 0.0) & (density < f64::INFINITY);
            let from = RayOrigin::off(site.position, site.error, site.normal);
            direction.set(i, towards);
            weight.set(i, lamps.radiance.get(i) / density / lamps.probability[i]);
            pdf[i] = if is_lit { density * lamps.probability[i] } else { 0.0 };
            position.set(i, from.position());
            offset.set(i, from.offset());
            outside[i] = if is_outside { 1.0 } else { 0.0 };
        }
    }
}

impl Lights {
    /// Samples light for sixteen receivers; each lane's result equals that of [`Lights::sample`] with its `choice` and
    /// `u`.
    pub fn sample_lanes(
        &self,
        level: Level,
        geometry: &Geometry,
        receivers: &LightContextLanes,
        choice: &[f64; LANES],
        u: &Pairs,
        lights: &mut LightLanes,
    ) {
        if let (None, [sky]) = (&self.choice, self.infinite.lights()) {
            return sky.sample_lanes(level, receivers, u, lights);
        }
        let (true, Some(choices)) = (self.infinite.is_dark(), &self.choice) else {
            for lane in 0..LANES {
                let u = [u[0][lane], u[1][lane]];
                lights.set(lane, self.sample(geometry, &receivers.get(lane), choice[lane], u));
            }
            return;
        };
        let mut chosen = [None; LANES];
        choices.sample_lanes(receivers, choice, &mut chosen);
        self.sample_chosen(level, geometry, receivers, &chosen, u, lights);
    }

    /// Samples one light for sixteen receivers; each lane's result equals that of [`Lights::sample_one`].
    #[allow(clippy::too_many_arguments)]
    pub fn sample_one_lanes(
        &self,
        one: u32,
        level: Level,
        geometry: &Geometry,
        receivers: &LightContextLanes,
        choice: &[f64; LANES],
        u: &Pairs,
        lights: &mut LightLanes,
    ) {
        if !self.is_within(one) {
            for lane in 0..LANES {
                let (receiver, u) = (receivers.get(lane), [u[0][lane], u[1][lane]]);
                lights.set(lane, self.sample_one(one, geometry, &receiver, &mut || choice[lane], u));
            }
            return;
        }
        let mut own = *u;
        let chosen = from_fn(|lane| {
            let (number, share, x) = self.one_within(one, u[0][lane]);
            own[0][lane] = x;
            Some((number, share))
        });
        self.sample_chosen(level, geometry, receivers, &chosen, &own, lights);
    }

    /// Samples lights within the scene, given by their numbers and selection probabilities.
    fn sample_chosen(
        &self,
        level: Level,
        geometry: &Geometry,
        receivers: &LightContextLanes,
        chosen: &[Option<(usize, f64)>; LANES],
        u: &Pairs,
        lights: &mut LightLanes,
    ) {
        // Separate arrays: zeroing a single value of more than 2048 bytes takes a path that is slow to start.
        let mut corners = [VectorLanes::ZERO; 3];
        let mut lamps = Lamps {
            normal: VectorLanes::ZERO,
            radiance: RgbLanes::ZERO,
            // Lanes without a light do not emit on either side.
            sides: [[false; LANES]; 2],
            probability: [0.0; LANES],
        };
        let mut balls = Balls { center: VectorLanes::ZERO, radius: [1.0; LANES] };
        let (mut triangles, mut spheres, mut others) = (0u32, 0u32, 0u32);
        for (lane, &chosen) in chosen.iter().enumerate() {
            let Some((number, probability)) = chosen else { continue };
            let Some(light) = self.plain(geometry, number) else {
                others |= 1 << lane;
                continue;
            };
            match light.figure {
                Figure::Ball { center, radius } => {
                    spheres |= 1 << lane;
                    balls.center.set(lane, center);
                    balls.radius[lane] = radius;
                }
                Figure::Triangle { corners: of_lane, normal } => {
                    triangles |= 1 << lane;
                    for (lanes, corner) in corners.iter_mut().zip(of_lane) {
                        lanes.set(lane, corner);
                    }
                    lamps.normal.set(lane, normal);
                }
            }
            lights.primitive[lane] = light.primitive;
            lamps.radiance.set(lane, light.radiance);
            [lamps.sides[0][lane], lamps.sides[1][lane]] = light.sides;
            lamps.probability[lane] = probability;
        }
        if spheres == 0 {
            draw(level, receivers, &corners, &lamps, u, lights);
        } else {
            let mut outside = [0.0; LANES];
            let mut of_spheres = LightLanes::NONE;
            let LightLanes { direction, weight, pdf, position, offset, .. } = &mut of_spheres;
            draw_balls(level, receivers, &balls, &lamps, u, direction, weight, pdf, position, offset, &mut outside);
            if triangles != 0 {
                draw(level, receivers, &corners, &lamps, u, lights);
            }
            for lane in (0..LANES).filter(|&lane| triangles >> lane & 1 == 0) {
                of_spheres.primitive[lane] = lights.primitive[lane];
                of_spheres.is_within[lane] = true;
                lights.copy(lane, &of_spheres);
                if spheres >> lane & 1 == 1 && outside[lane] == 0.0 {
                    others |= 1 << lane;
                }
            }
        }
        for lane in (0..LANES).filter(|&lane| others >> lane & 1 == 1) {
            let light = chosen[lane].and_then(|(number, probability)| {
                let u = [u[0][lane], u[1][lane]];
                Some(self.sample_within(number, geometry, &receivers.get(lane), u)?.chosen(probability))
            });
            lights.set(lane, light);
        }
    }
}
