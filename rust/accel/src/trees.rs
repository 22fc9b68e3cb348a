//! Trees over whatever there is: triangles, and what is none.

use super::bvh::traverse::Traversal;
use super::bvh::{self, Options};
use super::flat;
use super::mixed::mixed;
use super::walk::Mailbox;
use super::walked::walked;
use super::{Accelerator, Primitives};
use raywright_base::simd::Level;

/// The default: a wide tree over triangles, and another over what is none; a binary one of moving boxes if anything of
/// that moves.
pub fn over(primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    of_width(level.lanes(), primitives, options, level)
}

/// The same with so many children a node, 4 or 8.
///
/// # Panics
/// If the level has fewer lanes, or there is no tree of that width.
pub fn of_width(width: usize, primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    let triangles = |triangles: &dyn Primitives| bvh::wide(width, triangles, options, level);
    mixed(primitives, level, &triangles, &|input| bvh::over_objects(input, options, level))
}

/// A binary tree over triangles and what is none, walked as textbooks have it.
pub fn binary(
    primitives: &dyn Primitives,
    options: &Options,
    traversal: Traversal,
    level: Level,
) -> Box<dyn Accelerator> {
    walked(primitives, level, Mailbox::Stamps, &|input| traversal.build(input, options))
}

/// The same as arrays without pointers.
pub fn flat(primitives: &dyn Primitives, options: &Options, way: flat::Way, level: Level) -> Box<dyn Accelerator> {
    walked(primitives, level, Mailbox::Stamps, &|input| flat::build(input, options, way))
}
