//! Builds a BVH over a mesh and traces a million rays at it.

use raywright_accel::math::{DVec3, Hit, Ray, Vec3};
use raywright_accel::{Primitives, bvh, simd::Level};

/// A mesh: a paraboloid over 500 by 500 squares, two triangles each.
struct Bowl(Vec<[Vec3; 3]>);

impl Primitives for Bowl {
    fn count(&self) -> usize {
        self.0.len()
    }
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0[primitive as usize].map(Vec3::as_dvec3)
    }
    fn is_single(&self) -> bool {
        true
    }
}

fn main() {
    let at = |i: u32, j: u32| {
        let (x, y) = (i as f32 / 250.0 - 1.0, j as f32 / 250.0 - 1.0);
        Vec3::new(x, y, x * x + y * y)
    };
    let square = |k: u32| (at(k / 500, k % 500), at(k / 500 + 1, k % 500 + 1), k / 500, k % 500);
    let halves = |(a, c, i, j): (Vec3, Vec3, u32, u32)| [[a, at(i + 1, j), c], [a, c, at(i, j + 1)]];
    let mesh = Bowl((0..250_000).map(square).flat_map(halves).collect());
    let tree = bvh::widest(&mesh, &bvh::Options::DEFAULT, Level::current().expect("a level of this processor"));

    let down = |k: u32| DVec3::new(f64::from(k / 1000) / 500.0 - 0.999, f64::from(k % 1000) / 500.0 - 0.999, 5.0);
    let rays: Vec<Ray> = (0..1_000_000).map(|k| Ray::new(down(k), -DVec3::Z)).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    let start = std::time::Instant::now();
    tree.intersect(&rays, &mut hits);
    println!(
        "{} of {} rays hit, in {:.3} s",
        hits.iter().filter(|h| h.is_hit()).count(),
        rays.len(),
        start.elapsed().as_secs_f64()
    );

    let off = |(ray, hit): (&Ray, &Hit)| (ray.at(hit.t).z - ray.origin.truncate().length_squared()).abs();
    println!("farthest from the paraboloid: {:.1e}", rays.iter().zip(&hits).map(off).fold(0.0, f64::max));
}
