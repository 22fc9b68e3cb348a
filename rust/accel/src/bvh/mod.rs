//! Bounding volume hierarchies: binary trees for builders, and wide trees for traversal.

mod box_coverage;
pub mod build;
mod node;
pub mod optimise;
mod quality;
mod rotated_axes;
mod split_geometry;
pub mod traverse;
mod wide;

pub use node::{BinaryBvh, Node};
pub use quality::{Cuts, Quality, Steps};
pub use wide::Options;
use wide::WideBvh;

use super::walk::{Built, Input};
use super::{Accelerator, Primitives};
use raywright_base::simd::{Dispatch, Level};
use raywright_shapes::triangle::{DoubleLeaves, Leaves, SingleLeaves};

/// A tree over primitives tested one by one: a wide one, or a binary one of moving boxes if anything moves.
pub(super) fn over_objects(input: &Input, options: &Options, level: Level) -> Built {
    if input.primitives.objects().is_some_and(|objects| objects.moves()) {
        let built = options.quality.steps(1).whole(&input.boxes, input.work);
        let (tree, name) = built.unwrap_or_default();
        traverse::Moving::over(tree, input, &name)
    } else {
        wide::over_objects(input, options, level)
    }
}

/// A wide tree with as many children per node as SIMD lanes, 8 from AVX2 on and 4 below, with coordinates in the given
/// precision.
pub fn widest(primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    wide(level.lanes(), primitives, options, level)
}

/// A tree with the given number of children per node, 4 or 8.
///
/// It is not generic, since its kernels are much code, which would be compiled again in every crate that instantiates
/// them.
///
/// # Panics
///
/// If the level has fewer lanes, or there is no tree of that width.
pub fn wide(width: usize, primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    match (width, primitives.is_single()) {
        (8, true) => Box::new(WideBvh::<8, SingleLeaves<8>>::new(primitives, options, level)),
        (8, false) => Box::new(WideBvh::<8, DoubleLeaves<8>>::new(primitives, options, level)),
        (4, true) => Box::new(WideBvh::<4, SingleLeaves<4>>::new(primitives, options, level)),
        (4, false) => Box::new(WideBvh::<4, DoubleLeaves<4>>::new(primitives, options, level)),
        _ => panic!("a tree of {width} children a node"),
    }
}

/// A tree with another type of leaves, for benchmarks.
#[doc(hidden)]
pub fn with_leaves<const N: usize, L: Leaves<N>>(
    primitives: &dyn Primitives,
    options: &Options,
    level: Level,
) -> Box<dyn Accelerator>
where
    Level: Dispatch<N>,
{
    Box::new(WideBvh::<N, L>::new(primitives, options, level))
}
