//! The `Shape` and `Solid` implementations of surfaces of revolution.

use super::{BASE, ProfileCurve, Revolution, SIDE, TIP};
use crate::closest_on_revolution::Around;
use crate::closest_points::of_segment;
use crate::line::Line;
use crate::meeting::tell;
use crate::solid::{Meets, Solid};
use crate::{Bounds, Candidate, Carried, Closest, Drawn, Flat, Point, Shape};
use raywright_base::math::{Affine, Bounded, DVec3, Frame, Number, Ray, Triple};

impl Solid for Revolution {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        self.meets_from_foot(&line.from(self.base))
    }

    #[inline(always)]
    fn meets_roughly(&self, ray: &Carried<'_>) -> Option<Meets<Bounded>> {
        if matches!(ray, Carried::Ray(ray) if self.is_passed_by(ray)) {
            return Some(Meets::new(true));
        }
        self.meets(&ray.line())
    }

    #[inline(always)]
    fn surface<N: Number>(&self, surface: usize, point: &Triple<N>, unit: &N) -> N {
        self.zero_on(surface, point, unit)
    }

    fn coordinates(&self, part: usize, point: DVec3) -> [f64; 2] {
        self.coordinates(part, point)
    }

    fn reference(&self) -> DVec3 {
        self.base
    }
}

/// The closest point of the parabola from the origin to a rim, for a query point on its right.
///
/// At a fraction q of the rim's radius r, the height is h q². The closest q is the zero of `2 h² q³ + (r² − 2 h z) q −
/// r ρ`, which is negative below it and positive above, since at most one such q is positive.
fn of_parabola(rim: f64, height: f64, [across, up]: [f64; 2]) -> [f64; 2] {
    // In units of the larger, to avoid underflow of powers.
    let size = rim.max(height);
    let (r, h, rho, z) = (rim / size, height / size, across / size, up / size);
    let is_before = |q: f64| (2.0 * h * (h * q * q - z) + r * r) * q - r * rho <= 0.0;
    if is_before(1.0) {
        return [rim, height];
    }
    let (mut low, mut high) = (0.0, 1.0);
    // Enough bisections to exhaust all f64; usually 60 suffice.
    for _ in 0..1100 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if is_before(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    [rim * low, height * low * low]
}

impl Shape for Revolution {
    fn flats(&self) -> Vec<Flat> {
        let Frame { tangent, bitangent, .. } = self.frame().0;
        let [base, tip] = self.radii();
        // The base faces downward.
        let caps = [(self.base, bitangent * base, tangent * base), (self.tip, tangent * tip, bitangent * tip)];
        let caps = caps.into_iter().filter(|cap| self.capped && cap.1 != DVec3::ZERO);
        caps.map(|(center, a, b)| Flat::Ellipse { center, axes: [a, b], inner: 0.0 }).collect()
    }

    fn is_closed(&self) -> bool {
        self.capped
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        let (frame, height) = self.frame();
        let local = frame.to_local(place - self.base);
        let across = local.x.hypot(local.y);
        let [x, y] = if across > 0.0 { [local.x / across, local.y / across] } else { [1.0, 0.0] };
        // The closest point lies in the half-plane of the query point, which cuts the surface in its profile and caps.
        let from = [across, local.z];
        let [base, tip] = self.radii();
        let side = match self.profile {
            ProfileCurve::Straight { .. } => of_segment([base, 0.0], [tip, height], from),
            ProfileCurve::Parabola { tip } => of_parabola(tip, height, from),
        };
        let cap =
            |radius: f64, at: f64| (self.capped && radius > 0.0).then(|| of_segment([0.0, at], [radius, at], from));
        let parts = [(BASE, cap(base, 0.0)), (SIDE, Some(side)), (TIP, cap(tip, height))];
        let mut best: Option<(f64, usize, [f64; 2])> = None;
        for (part, at) in parts {
            let Some(at) = at else { continue };
            let distance = (at[0] - from[0]).hypot(at[1] - from[1]);
            if best.is_none_or(|(least, ..)| distance < least) {
                best = Some((distance, part, at));
            }
        }
        let (_, part, [radius, up]) = best?;
        let from_base = frame.to_world(DVec3::new(x * radius, y * radius, up));
        Some(Closest { position: self.base + from_base, uv: self.coordinates(part, from_base) })
    }

    fn closest_stretched(&self, to_world: &Affine, _: &Affine, place: DVec3) -> Option<Closest> {
        let (frame, height) = self.frame();
        let around = Around::new(to_world, &frame, self.base, place);
        let [base, tip] = self.radii();
        let widest = base.max(tip);
        let side = around.nearest(widest, |out| match self.profile {
            ProfileCurve::Straight { .. } => around.of_segment(out, [[base, 0.0], [tip, height]]),
            ProfileCurve::Parabola { tip } => around.of_parabola(out, [tip, height]),
        });
        let cap = |radius: f64, at: f64| {
            let ends = [[0.0, at], [radius, at]];
            (self.capped && radius > 0.0).then(|| around.nearest(radius, |out| around.of_segment(out, ends)))
        };
        let parts = [(BASE, cap(base, 0.0)), (SIDE, Some(side)), (TIP, cap(tip, height))];
        let found = parts.into_iter().filter_map(|(part, found)| Some((part, found?)));
        let (part, nearest) = found.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
        // From the nearer end of the axis, as in `at`.
        let from_base = frame.to_world(nearest.local);
        let DVec3 { x, y, z } = nearest.local;
        let own = if z <= 0.5 * height {
            self.base + from_base
        } else {
            self.tip + frame.to_world(DVec3::new(x, y, z - height))
        };
        Some(Closest { position: to_world.point(own), uv: self.coordinates(part, from_base) })
    }

    fn bounds(&self) -> Bounds {
        self.bounds()
    }

    fn support(&self, d: DVec3) -> f64 {
        self.support(d)
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet_carried(&Carried::Ray(ray), met)
    }

    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        tell(self, ray, met)
    }

    fn point(&self, _: &Ray, _: f64, uv: [f64; 2]) -> Point {
        self.at(uv)
    }

    fn area(&self) -> f64 {
        self.area()
    }

    fn area_under(&self, map: &Affine) -> f64 {
        self.area_under(map)
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        self.sample(u)
    }
}
