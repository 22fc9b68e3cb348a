//! Hits of few shapes against those of brute force and of each shape alone.

use super::*;
use crate::BruteForce;
use crate::fans::{Soup, fans};
use crate::{UserGeometry, Wanted};
use raywright_base::math::{DVec3, Hit, Vec3};
use raywright_base::sampling::philox4x32;
use raywright_shapes::{Bounds, Candidate, Shape};
use std::sync::Arc;

fn number(i: u32) -> f32 {
    philox4x32([i, 0, 0, 0], [3, 9])[0] as f32 / (1u32 << 31) as f32 - 1.0
}

/// A room with a box in it, of parallelograms, and some triangles, on a grid so that rays hit corners and edges.
fn room(scale: f32) -> Vec<[Vec3; 3]> {
    let mut all = Vec::new();
    for (low, high) in [([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]), ([-0.5, -1.0, -0.5], [0.25, 0.0, 0.25])] {
        for axis in 0..3 {
            for side in [low, high] {
                let corner = |u: bool, v: bool| {
                    let mut p = low;
                    p[axis] = side[axis];
                    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                    (p[a], p[b]) = (if u { high[a] } else { low[a] }, if v { high[b] } else { low[b] });
                    Vec3::from_array(p) * scale
                };
                let [a, b, c, d] =
                    [(false, false), (true, false), (true, true), (false, true)].map(|(u, v)| corner(u, v));
                all.extend([[a, b, c], [c, d, a]]);
            }
        }
    }
    for i in 0..20 {
        all.push([0, 1, 2].map(|k| Vec3::from_array([0, 1, 2].map(|x| scale * number(9 * i + 3 * k + x)))));
    }
    all
}

fn rays(scale: f32) -> PathRays {
    let of_fans = fans().into_iter().flatten().map(|ray| (ray.origin.as_vec3(), ray.direction.as_vec3()));
    // From grid points to grid points.
    let grid = |i: u32| Vec3::from_array([0, 1, 2].map(|x| (4.0 * number(3 * i + x)).round() / 4.0));
    let of_grid = (0..4000).map(|i| (grid(i), grid(i + 5000) - grid(i)));
    let all: Vec<_> = of_fans.chain(of_grid).filter(|(_, d)| d.length() > 0.0).collect();
    let mut rays = PathRays::with_room(all.len(), false);
    rays.len = all.len();
    for (i, (origin, direction)) in all.into_iter().enumerate() {
        let (origin, direction) = (origin * scale, direction.normalize());
        for axis in 0..3 {
            rays.origin[axis][i] = origin[axis].into();
            rays.direction[axis][i] = direction[axis];
        }
        rays.t_max[i] = if i % 3 == 0 { scale.into() } else { f64::INFINITY };
    }
    rays
}

#[test]
fn hits_are_those_of_brute_force() {
    // The last with a triangle far away, whose coordinates are no measure of errors in the room.
    for (scale, is_single, far) in [(1.0, true, 0), (1e-6, false, 0), (3.7e5, true, 0), (1.0, true, 1)] {
        let mut triangles = room(scale);
        triangles.extend((0..far).map(|_| [Vec3::X, Vec3::Y, Vec3::Z].map(|corner| 3e4 * Vec3::ONE + corner)));
        let soup = Soup { triangles, is_single };
        let rays = rays(scale);
        let few = FewShapes::new(&soup).expect("few triangles");
        assert_eq!(few.patches.len(), 32 + far, "parallelograms and triangles");
        let exact: Vec<_> = (0..rays.len).map(|i| rays.get(i)).collect();
        let mut wanted = vec![Hit::MISS; rays.len];
        BruteForce::over(&soup, Level::current().unwrap()).intersect(&exact, &mut wanted);
        let mut first = None;
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let mut hits = vec![0; rays.len + LANES];
            few.closest(level, &rays, &mut hits);
            let mut occluded = vec![false; rays.len + LANES];
            few.occluded(level, &rays, &mut occluded);
            for (i, wanted) in wanted.iter().enumerate() {
                assert_eq!(occluded[i], wanted.is_hit(), "{i} at {scale}: {:?} {wanted:?}", exact[i]);
                assert_eq!(hits[i] != NONE, wanted.is_hit(), "{i} at {scale}");
                if wanted.is_hit() {
                    // On the diagonal of a quadrilateral either triangle is correct.
                    let patch = |primitive: u32| few.shape_of[primitive as usize];
                    assert_eq!(patch(hits[i]), patch(wanted.primitive), "{i} at {scale}: {:?}", exact[i]);
                }
            }
            let bits = hits[..rays.len].to_vec();
            assert!(*first.get_or_insert(bits.clone()) == bits, "{level:?} at {scale}");
        }
    }
}

#[test]
fn a_ray_misses_what_it_leaves_and_what_it_goes_to() {
    let soup = Soup { triangles: room(1.0), is_single: true };
    let few = FewShapes::new(&soup).unwrap();
    let (mut rays, mut hits) = (PathRays::with_room(1, false), [0; 1 + LANES]);
    rays.len = 1;
    // From the floor of the room straight up, past the box.
    for (axis, (origin, direction)) in [(0.8, 0.0), (-1.0, 1.0), (0.8, 0.0)].into_iter().enumerate() {
        (rays.origin[axis][0], rays.direction[axis][0]) = (origin, direction);
    }
    let level = Level::current().unwrap();
    few.closest(level, &rays, &mut hits);
    let floor = hits[0];
    rays.misses[0][0] = floor;
    few.closest(level, &rays, &mut hits);
    let ceiling = hits[0];
    assert_eq!(soup.corners(floor).map(|corner| corner.y), [-1.0; 3]);
    assert_eq!(soup.corners(ceiling).map(|corner| corner.y), [1.0; 3]);
    let mut occluded = [false; 1 + LANES];
    few.occluded(level, &rays, &mut occluded);
    assert!(occluded[0]);
    rays.misses[0][1] = ceiling;
    few.occluded(level, &rays, &mut occluded);
    assert!(!occluded[0]);
}

/// A floor, and spheres beside, within and on each other.
struct Balls(Arc<Spheres>);

struct Spheres(Vec<raywright_shapes::Sphere>);

const FLOOR: u32 = 2;

impl UserGeometry for Spheres {
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        self.0.get((primitive.checked_sub(FLOOR)?) as usize).map(Shape::bounds)
    }
    fn ball(&self, primitive: u32) -> Option<(DVec3, f64)> {
        self.0.get((primitive.checked_sub(FLOOR)?) as usize)?.ball()
    }
    fn meet(&self, primitive: u32, _: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.0[(primitive - FLOOR) as usize].meet(ray, met)
    }
}

impl Primitives for Balls {
    fn count(&self) -> usize {
        FLOOR as usize + self.0.0.len()
    }
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        let corner = |x: f64, z: f64| DVec3::new(4.0 * x, -1.0, 4.0 * z);
        match primitive {
            0 => [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)],
            1 => [corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)],
            _ => [DVec3::NAN; 3],
        }
    }
    fn is_single(&self) -> bool {
        true
    }
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        let [a, b, c] = self.corners(primitive);
        if primitive < FLOOR {
            return Some(Bounds { min: a.min(b).min(c), max: a.max(b).max(c) });
        }
        UserGeometry::bounds(&*self.0, primitive)
    }
    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        Some(self.0.clone())
    }
}

/// Rays between points of spheres, that leave on both sides and graze others, and rays from free points.
fn rays_among(spheres: &[raywright_shapes::Sphere], count: u32) -> PathRays {
    let mut rays = PathRays::with_room(count as usize, false);
    rays.len = count as usize;
    let unit = |i: u32| DVec3::new(number(3 * i).into(), number(3 * i + 1).into(), number(3 * i + 2).into());
    for i in 0..count {
        let from = &spheres[i as usize % spheres.len()];
        let to = &spheres[(i / 7) as usize % spheres.len()];
        let site = from.center + from.radius * unit(4 * i).normalize();
        let outward = (site - from.center) / from.radius;
        // Towards the other's rim, its middle, or anywhere.
        let across = (to.center - site).cross(unit(4 * i + 1)).normalize_or_zero() * to.radius;
        let rim = [1.0, 1.0 + 1e-7, 0.5, 0.0, 2.0][i as usize % 5];
        let aim = if i % 11 == 0 { unit(4 * i + 2) } else { to.center + rim * across - site };
        let direction = aim.normalize().as_vec3();
        let side = 1f64.copysign(direction.as_dvec3().dot(outward));
        let error = 2f64.powi(-53) * (site.abs().max_element() + 5.0 * from.radius);
        let origin = if i % 3 == 0 { 3.0 * unit(4 * i + 3) } else { site + outward * (8.0 * error * side) };
        for axis in 0..3 {
            (rays.origin[axis][i as usize], rays.direction[axis][i as usize]) = (origin[axis], direction[axis]);
        }
        let own = FLOOR + i % spheres.len() as u32;
        rays.misses[i as usize] = [if i % 3 == 0 { NONE } else { own }, NONE];
        rays.t_max[i as usize] = if i % 4 == 0 { (to.center - origin).length() } else { f64::INFINITY };
    }
    rays
}

#[test]
fn hits_of_spheres_are_those_of_each_alone() {
    let sphere = |x: f64, y: f64, z: f64, radius: f64| raywright_shapes::Sphere { center: DVec3::new(x, y, z), radius };
    let spheres = vec![
        sphere(0.0, 0.0, 0.0, 1.0),
        sphere(0.0, 0.0, 0.0, 0.5),
        sphere(2.0, 0.0, 0.0, 1.0),
        sphere(-1.5, 1.0, 0.3, 0.001),
        sphere(0.0, 0.0, 0.0, 40.0),
        sphere(1.0, 0.7, 2.0, 0.2),
    ];
    let rays = rays_among(&spheres, 20_000);
    let soup = Balls(Arc::new(Spheres(spheres)));
    let few = FewShapes::new(&soup).expect("few shapes");
    assert_eq!((few.patches.len(), few.spheres.len()), (1, 6));
    let (mut first, mut differ) = (None, 0);
    for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
        let (mut hits, mut occluded) = (vec![0; rays.len + LANES], vec![false; rays.len + LANES]);
        few.closest(level, &rays, &mut hits);
        few.occluded(level, &rays, &mut occluded);
        for i in 0..rays.len {
            let ray = rays.get(i);
            let exact = |sphere: u32| {
                let mut first = None;
                soup.0.meet(FLOOR + sphere, Wanted::Closest, &ray, &mut |met| {
                    first = Some((met.t, FLOOR + sphere));
                    true
                });
                first
            };
            let all = (0..6).filter_map(exact).chain(few.meet(0, &ray));
            let wanted = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            assert_eq!(occluded[i], wanted.is_some(), "{level:?} {i}: {ray:?} {wanted:?}");
            let shape = |primitive: u32| few.shape_of[primitive as usize];
            assert_eq!(hits[i] != NONE, wanted.is_some(), "{level:?} {i}: {ray:?} {wanted:?}");
            if let Some((_, primitive)) = wanted {
                assert_eq!(shape(hits[i]), shape(primitive), "{level:?} {i}: {ray:?} {wanted:?}");
                differ += usize::from(primitive >= FLOOR);
            }
        }
        let bits = hits[..rays.len].to_vec();
        assert!(*first.get_or_insert(bits.clone()) == bits, "{level:?}");
    }
    assert!(differ > 10_000, "few rays hit spheres: {differ}");
}
