//! Bidirectional scattering distribution functions by lane: what is asked of sixteen at a time.

use super::{Bsdf, BsdfSampleLanes, RgbLanes};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::Level;
use std::fmt::Debug;

/// A kind of functions of which sixteen are asked at a time.
pub trait LaneBsdf: Bsdf {
    /// What is known of them.
    type Lanes: BsdfColumns<Self>;
}

/// What is known of functions of a kind, a lane each, and of a direction in the shading frame of each that light goes
/// to.
///
/// What it answers are the bits that each function gives by itself ([`Bsdf`]), whatever the level: that of loops over
/// lanes (`simd/loops.rs`). `each` gives the functions themselves, of which more may be asked than stands in
/// columns.
pub trait BsdfColumns<B: ?Sized>: Clone + Debug {
    /// Of nothing yet.
    const NONE: Self;

    /// Puts a function into a lane, and where light goes to.
    fn set(&mut self, lane: usize, of: &B, wo: DVec3);

    /// What [`Bsdf::evaluate`] gives for directions that they were put there with, and others, in the lanes that ask;
    /// 0 in the others.
    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a B> + Copy,
        asks: &[bool; LANES],
        directions: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        B: 'a;

    /// What [`Bsdf::sample`] gives for directions that they were put there with, by a choice and two numbers each, in
    /// the lanes that ask; nothing in the others.
    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a B> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        numbers: (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        B: 'a;
}
