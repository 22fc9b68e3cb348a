use raywright::accel::{bvh::Options, trees};
use raywright::math::{DVec3, Ray};
use raywright::scene::{Scene, SceneDescription, Surface};
use raywright::shapes::{Bounds, Candidate, Contact, Drawn, Point, Shape};
use raywright::simd::Level;
use std::sync::Arc;

/// A square in the plane z = 0 about the origin.
#[derive(Debug)]
struct Plate {
    half: f64,
}

impl Plate {
    fn at(&self, uv: [f64; 2]) -> Point {
        let [x, y] = uv.map(|c| self.half * (2.0 * c - 1.0));
        Point {
            position: DVec3::new(x, y, 0.0),
            // Rays that leave start so far off the surface that rounding cannot bring them back.
            error: 4.0 * f64::EPSILON * self.half,
            normal: DVec3::Z,
            uv,
            dp: [DVec3::X * (2.0 * self.half), DVec3::Y * (2.0 * self.half)],
            dn: [DVec3::ZERO; 2],
        }
    }
}

impl Shape for Plate {
    fn bounds(&self) -> Bounds {
        let corner = DVec3::new(self.half, self.half, 0.0);
        Bounds { min: -corner, max: corner }
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        let t = -ray.origin.z / ray.direction.z;
        let at = ray.at(t);
        // Seen edge-on, t is infinite or NaN, and no comparison with it is true.
        let is_met = t >= ray.t_min && t <= ray.t_max && at.x.abs().max(at.y.abs()) <= self.half;
        let uv = [at.x, at.y].map(|c| 0.5 + 0.5 * c / self.half);
        is_met && met(Candidate { t, uv, contact: Contact::Inside, inner: 0 })
    }

    fn point(&self, _: &Ray, _: f64, uv: [f64; 2]) -> Point {
        self.at(uv)
    }

    fn area(&self) -> f64 {
        4.0 * self.half * self.half
    }

    // By area: so the plate can be a lamp.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        Some(Drawn { point: self.at(u), pdf: 1.0 / self.area() })
    }
}

#[test]
fn a_plate_is_met_within_its_sides() {
    let surface = Surface::Shape(Arc::new(Plate { half: 2.0 }));
    let shapes = vec![raywright::scene::Shape { surface, ..Default::default() }];
    let level = Level::current().unwrap();
    let described = SceneDescription { shapes, ..Default::default() };
    let scene = Scene::new(described, |primitives| trees::over(primitives, &Options::default(), level)).unwrap();
    let down = |x: f64| Ray::new(DVec3::new(x, 1.0, 3.0), DVec3::NEG_Z);
    let mut occluded = [false; 3];
    scene.occluded(&[down(0.0), down(1.999), down(2.001)], &mut occluded);
    assert_eq!(occluded, [true, true, false]);
}
