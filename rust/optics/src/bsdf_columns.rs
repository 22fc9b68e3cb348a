//! Interface of BSDFs in batches of sixteen lanes.

use super::{Bsdf, BsdfSampleLanes, RgbLanes};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::Level;
use std::fmt::Debug;

/// A kind of BSDF that can be evaluated sixteen at a time.
pub trait LaneBsdf: Bsdf {
    /// Its structure-of-arrays form.
    type Lanes: BsdfColumns<Self>;
}

/// BSDFs of one kind in structure-of-arrays form, each with an outgoing direction in its shading frame.
///
/// Results are bit-identical to those of each [`Bsdf`], at every level of loops over lanes (`simd/loops.rs`). `each`
/// returns the BSDFs themselves, for data that is not stored in arrays.
pub trait BsdfColumns<B: ?Sized>: Clone + Debug {
    /// Sixteen empty lanes.
    const NONE: Self;

    /// Stores a BSDF and its outgoing direction in a lane.
    fn set(&mut self, lane: usize, of: &B, wo: DVec3);

    /// [`Bsdf::evaluate`] for the stored outgoing directions and given incident ones. Lanes whose flag is not set get
    /// 0.
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

    /// [`Bsdf::sample`] for the stored outgoing directions, by a choice and two random numbers each. Lanes whose flag
    /// is not set get no sample.
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
