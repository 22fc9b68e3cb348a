//! Bounding volume hierarchies over triangles and other primitives.

use super::bvh::traverse::Traversal;
use super::bvh::{self, Options};
use super::flat;
use super::mixed::mixed;
use super::walk::Mailbox;
use super::walked::walked;
use super::{Accelerator, Primitives};
use raywright_base::simd::Level;

/// The default: a wide BVH over triangles, and another one over objects. If any object moves, the latter is a binary
/// tree of moving boxes.
pub fn over(primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    of_width(level.lanes(), primitives, options, level)
}

/// The same with the given number of children per node, 4 or 8.
///
/// # Panics
///
/// If the level has fewer lanes, or there is no tree of that width.
pub fn of_width(width: usize, primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    let triangles = |triangles: &dyn Primitives| bvh::wide(width, triangles, options, level);
    mixed(primitives, level, &triangles, &|input| bvh::over_objects(input, options, level))
}

/// A binary BVH over all primitives with a textbook traversal.
pub fn binary(
    primitives: &dyn Primitives,
    options: &Options,
    traversal: Traversal,
    level: Level,
) -> Box<dyn Accelerator> {
    walked(primitives, level, Mailbox::Stamps, &|input| traversal.build(input, options))
}

/// The same as flat arrays without pointers.
pub fn flat(
    primitives: &dyn Primitives,
    options: &Options,
    way: flat::FlatTraversal,
    level: Level,
) -> Box<dyn Accelerator> {
    walked(primitives, level, Mailbox::Stamps, &|input| flat::build(input, options, way))
}
