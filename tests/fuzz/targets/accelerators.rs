//! Every accelerator there is, at every level of the processor.

use super::triangles::Triangles;
use raywright::accel::bvh::{self, Options};
use raywright::accel::{Accelerator, BruteForce, Primitives};
use raywright::math::DVec3;
use raywright::simd::Level;

/// Triangles that are stored as f64 even if f32 is exact.
struct Doubles<'a>(&'a Triangles);

impl Primitives for Doubles<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0.corners(primitive)
    }

    fn is_single(&self) -> bool {
        false
    }
}

/// Trees at every precision that loses nothing, and brute force, at every level, by name. They are valid.
pub fn all(triangles: &Triangles, options: &Options) -> Vec<(String, Box<dyn Accelerator>)> {
    let doubles = Doubles(triangles);
    let mut kept: Vec<&dyn Primitives> = vec![&doubles];
    if triangles.is_single() {
        kept.push(triangles);
    }
    let mut all = Vec::new();
    for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
        for primitives in &kept {
            // As wide as the level's vectors: narrower trees have the code of a lower level.
            all.push((level, bvh::widest(*primitives, options, level)));
        }
        // At its default precision only: it is slow, and the same at either.
        all.push((level, BruteForce::over(triangles, level)));
    }
    let name = |(level, a): (Level, Box<dyn Accelerator>)| (format!("{}, {}", a.info().kind, level.name()), a);
    let all: Vec<_> = all.into_iter().map(name).collect();
    for (name, accelerator) in &all {
        accelerator.validate(triangles).unwrap_or_else(|e| panic!("{name}: {e}, of {triangles:?}"));
    }
    all
}
