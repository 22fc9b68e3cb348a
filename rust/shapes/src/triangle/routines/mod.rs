//! Ray-triangle tests from the literature, for one ray and one triangle, for study and comparison.
//!
//! Each file holds one test as published, except for three common conventions that make them comparable. Rays and
//! corners are given in f32, both sides of a triangle are hit, and a hit has a finite t ≥ 0. Terms that depend on the
//! ray or the triangle alone are precomputed where the author does so. [`Contest`] compares their speed. Only
//! [`edge_f64`] decides exactly; traversal uses that one, in blocks.

pub mod badouel;
mod contest;
pub mod edge_f32;
pub mod edge_f64;
pub mod moller_trumbore;
pub mod volumes;
pub mod woop;

pub use contest::{Contender, Contest};

use raywright_base::math::Vec3;

/// A ray-triangle intersection routine.
pub trait Routine {
    /// Its name: authors and year, or the method.
    const NAME: &'static str;
    /// The precomputed data of a triangle.
    type Triangle;
    /// The precomputed data of a ray.
    type Ray;

    /// Prepare a triangle, once for all rays.
    fn triangle(corners: [Vec3; 3]) -> Self::Triangle;

    /// Prepare a ray, once for all triangles in the bounding box of these `corners`.
    fn ray(ray: SingleRay, corners: [Vec3; 3]) -> Self::Ray;

    /// Intersect the ray with the triangle.
    fn meet(ray: &Self::Ray, triangle: &Self::Triangle) -> Option<TriangleHit>;
}

/// A half-line `origin + t · direction`, t ≥ 0, in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleRay {
    /// The origin.
    pub origin: Vec3,
    /// The direction.
    pub direction: Vec3,
}

/// An intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// The ray parameter, in lengths of the direction.
    pub t: f64,
    /// The weight of the second corner.
    pub u: f64,
    /// The weight of the third corner.
    pub v: f64,
}

impl TriangleHit {
    /// Convert from f32; None if `t` is out of range.
    #[inline(always)]
    fn new(t: f32, u: f32, v: f32) -> Option<Self> {
        (0.0..=f32::MAX).contains(&t).then(|| Self { t: t.into(), u: u.into(), v: v.into() })
    }
}

/// Corners relative to a ray's origin.
#[inline(always)]
fn relative(corners: &[Vec3; 3], origin: Vec3) -> [Vec3; 3] {
    [corners[0] - origin, corners[1] - origin, corners[2] - origin]
}

/// Return whether one number is negative and another positive: the ray passes the edges on different sides.
// No short circuit: a branch per comparison would be unpredictable and cost more than all else.
#[inline(always)]
fn signs_differ(u: f32, v: f32, w: f32) -> bool {
    ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0))
}
