//! Any way to build a tree.

use super::numbers::one_of;
use arbitrary::{Result, Unstructured};
use raywright::accel::bvh::build::binned::MAX_BINS;
use raywright::accel::bvh::build::morton::Bits;
use raywright::accel::bvh::build::split_rules::SplitRule;
use raywright::accel::bvh::build::{Builder, ploc};
use raywright::accel::bvh::optimise::{Optimiser, Optimisers};

/// Any builder with valid options.
pub fn builder(u: &mut Unstructured) -> Result<Builder> {
    let bins = Some(u.int_in_range(2..=MAX_BINS)?);
    let all = [
        Builder::Binned { bins },
        Builder::Sweep,
        Builder::Spatial { bins, budget: one_of(u, &[0.0, 0.3, 1.0, 4.0])? },
        Builder::Morton(one_of(u, &[Bits::Thirty, Bits::SixtyThree])?),
        Builder::Ploc { radius: u.int_in_range(1..=ploc::MAX_RADIUS)? },
        Builder::Halves(one_of(u, &[SplitRule::Midpoint, SplitRule::Median, SplitRule::Mean])?),
    ];
    one_of(u, &all)
}

/// Any optimizers.
pub fn optimisers(u: &mut Unstructured) -> Result<Optimisers> {
    let mut some = vec![Optimiser::Reinsertion, Optimiser::Treelet];
    some.rotate_left(u.int_in_range(0..=1)?);
    some.truncate(u.int_in_range(0..=2)?);
    Ok(Optimisers::new(some).expect("each at most once"))
}
