//! Bounding volume hierarchies: a binary tree that builders make, and wide trees that rays walk.

mod axes;
pub mod build;
mod contents;
mod node;
pub mod optimise;
mod parts;
mod quality;
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

/// A tree over what is tested one by one: a wide one, or a binary one of moving boxes if anything moves.
pub(super) fn over_objects(input: &Input, options: &Options, level: Level) -> Built {
    if input.primitives.objects().is_some_and(|objects| objects.moves()) {
        let built = options.quality.steps(1).whole(&input.boxes, input.work);
        let (tree, name) = built.unwrap_or_default();
        traverse::Moving::over(tree, input, &name)
    } else {
        wide::over_objects(input, options, level)
    }
}

/// A wide tree as wide as the level's registers, 8 from AVX2 on and 4 below, that keeps numbers as precisely as they
/// are.
pub fn widest(primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    wide(level.lanes(), primitives, options, level)
}

/// A tree of so many children a node, 4 or 8.
///
/// Not generic: a tree with all its kernels is much code, and whoever made one of a type of their own would compile it
/// again.
///
/// # Panics
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

/// A tree over leaves of another type, by which a bench compares these with others.
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
