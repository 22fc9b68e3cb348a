//! The cone and the truncated cone.

use super::line::Line;
use super::meeting::{Meets, Solid, tell};
use super::revolution::{Profile, Revolution};
use super::{Bounds, Candidate, Carried, Drawn, Point, Shape};
use crate::math::{Affine, Bounded, DVec3, Number, Ray, Triple};

/// What a straight line draws when it is turned about a segment, from its one end's plane to the other's; closed by disks or open.
///
/// Its coordinates are the angle about the axis, in turns, and the way along the profile: of an open one from the base to the tip,
/// of a closed one from the middle of the base cap over its rim and up the side to the middle of the tip cap, by length.
#[derive(Clone, Debug, PartialEq)]
pub struct Cone {
    surface: Revolution,
}

impl Cone {
    /// The cone about the segment from `base` to `tip`, which differ, with a radius at either end: one may be 0, and neither is less.
    pub fn new(base: DVec3, tip: DVec3, radii: [f64; 2], capped: bool) -> Self {
        let profile = Profile::Straight { base: radii[0], tip: radii[1] };
        Self { surface: Revolution { base, tip, profile, capped } }
    }
}

impl Solid for Cone {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        self.surface.meets(&line.from(self.surface.base))
    }

    #[inline(always)]
    fn meets_roughly(&self, ray: &Carried<'_>) -> Option<Meets<Bounded>> {
        if matches!(ray, Carried::Ray(ray) if self.surface.is_passed_by(ray)) {
            return Some(Meets::new(true));
        }
        self.meets(&ray.line())
    }

    #[inline(always)]
    fn surface<N: Number>(&self, surface: usize, point: &Triple<N>, unit: &N) -> N {
        self.surface.zero_on(surface, point, unit)
    }

    fn coordinates(&self, part: usize, point: DVec3) -> [f64; 2] {
        self.surface.coordinates(part, point)
    }

    fn reference(&self) -> DVec3 {
        self.surface.base
    }
}

impl Shape for Cone {
    fn bounds(&self) -> Bounds {
        self.surface.bounds()
    }

    fn support(&self, d: DVec3) -> f64 {
        self.surface.support(d)
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet_carried(&Carried::Ray(ray), met)
    }

    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        tell(self, ray, met)
    }

    fn point(&self, _: &Ray, _: f64, uv: [f64; 2]) -> Point {
        self.surface.at(uv)
    }

    fn area(&self) -> f64 {
        self.surface.area()
    }

    fn area_under(&self, map: &Affine) -> f64 {
        self.surface.area_under(map)
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        self.surface.sample(u)
    }
}
