//! A surface of revolution as a shape: what its own file and its neighbours work out, as others ask for it.

use super::Revolution;
use crate::math::{Affine, Bounded, DVec3, Number, Ray, Triple};
use crate::shapes::line::Line;
use crate::shapes::meeting::tell;
use crate::shapes::solid::{Meets, Solid};
use crate::shapes::{Bounds, Candidate, Carried, Drawn, Point, Shape};

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

impl Shape for Revolution {
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
