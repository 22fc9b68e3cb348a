//! The paraboloid of revolution.

use super::line::Line;
use super::meeting::{Meets, Solid, tell};
use super::revolution::{Profile, Revolution};
use super::{Bounds, Candidate, Carried, Drawn, Point, Shape};
use crate::math::{Affine, Bounded, DVec3, Number, Ray, Triple};

/// What a parabola draws when it is turned about its axis, from the apex to a rim; closed by a disk there or open. With a radius r at
/// a height h it is z = h ρ² / r², and its focus lies r² / 4h above the apex.
///
/// Its coordinates are the angle about the axis, in turns, and the distance from it, as a share of the rim's; of a closed one that is
/// the first half, and the second goes on from the rim to the middle of the cap.
#[derive(Clone, Debug, PartialEq)]
pub struct Paraboloid {
    surface: Revolution,
}

impl Paraboloid {
    /// The paraboloid from `apex` to the plane of the rim, whose middle is `tip`, which differ, and whose radius is above 0.
    pub fn new(apex: DVec3, tip: DVec3, radius: f64, capped: bool) -> Self {
        let profile = Profile::Parabola { tip: radius };
        Self { surface: Revolution { base: apex, tip, profile, capped } }
    }
}

impl Solid for Paraboloid {
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

impl Shape for Paraboloid {
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
