//! The ways to meet a triangle that the literature knows, one ray and one triangle at a time: to be read, and compared.
//!
//! Each file is one of them as it was published, but for three things that all share, so that they answer the same
//! question on the same numbers: rays and corners come in f32; both sides of a triangle are hit; and a hit has a
//! finite t ≥ 0. What depends on the ray alone, or on the triangle alone, is computed beforehand where the author does
//! so. [`Contest`] runs them side by side. Only [`edge_f64`] decides exactly; traversal uses that one, by the block.

pub mod badouel;
mod contest;
pub mod edge_f32;
pub mod edge_f64;
pub mod moller_trumbore;
pub mod volumes;
pub mod woop;

pub use contest::{Contender, Contest};

use raywright_base::math::Vec3;

/// A way to find where a ray meets a triangle.
pub trait Routine {
    /// What to call it: its authors and the year, or what it computes.
    const NAME: &'static str;
    /// What is kept of a triangle.
    type Triangle;
    /// What is kept of a ray.
    type Ray;

    /// Makes a triangle ready, once for all rays.
    fn triangle(corners: [Vec3; 3]) -> Self::Triangle;

    /// Makes a ray ready, once for all triangles that lie in the box around these `corners`.
    fn ray(ray: SingleRay, corners: [Vec3; 3]) -> Self::Ray;

    /// Where the ray meets the triangle.
    fn meet(ray: &Self::Ray, triangle: &Self::Triangle) -> Option<Meeting>;
}

/// A half-line `origin + t · direction`, t ≥ 0, in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleRay {
    /// Where the ray starts.
    pub origin: Vec3,
    /// Where it goes.
    pub direction: Vec3,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// In lengths of the ray's direction.
    pub t: f64,
    /// The weight of the second corner.
    pub u: f64,
    /// The weight of the third corner.
    pub v: f64,
}

impl Meeting {
    /// Of numbers in f32; none if `t` is not one that counts.
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

/// Whether some number is below zero and another above: the ray passes the edges on different sides.
// Each comparison by a branch of its own would cost more than all else, as no processor can guess them.
#[inline(always)]
fn signs_differ(u: f32, v: f32, w: f32) -> bool {
    ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0))
}
