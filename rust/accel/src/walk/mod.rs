//! Structures traversed by one ray at a time, as in textbooks.
//!
//! A [`Structure`] knows boxes only. It returns leaves in the order along the ray, and the primitives in them are
//! tested here, by the same exact tests that all accelerators share. So a structure's file holds its algorithm only,
//! and [`walked`](super::walked()) runs every query on it.
//!
//! Rays are in box units, as prepared by [`SlabRay`]. The `t` of a plane is an interval padded at both ends. A
//! traversal that visits every cell that the ray may enter within these intervals misses nothing.

mod build_budget;
mod few_objects;
mod leaf_contents;
mod mailbox;
mod packet_traversal;
mod primitive_parts;

pub(super) use build_budget::BuildBudget;
pub(super) use few_objects::Few;
pub(super) use leaf_contents::Contents;
pub use mailbox::Mailbox;
pub(super) use mailbox::{Mailboxes, Marks};
pub(super) use packet_traversal::TogetherBatch;
pub use packet_traversal::{MOST_TOGETHER, Together};
pub(super) use primitive_parts::{PartPosition, PrimitivePart, SplitPlane};

use super::{Info, NodeBox, Primitives, SlabRay};
use raywright_base::math::{Aabb, Region};
use raywright_base::simd::Level;
use raywright_base::work::Work;

/// The input of a builder.
pub struct Input<'a> {
    /// The region of the primitives, which defines box units.
    pub region: Region,
    /// The box of each primitive in box units, rounded outward; empty for unbounded primitives and those that cannot be
    /// hit.
    pub boxes: Vec<Aabb>,
    /// The primitives themselves.
    pub primitives: &'a dyn Primitives,
    /// Progress of the build. A canceled build may return any structure, even an empty one.
    pub work: Work<'a>,
}

/// The primitives of each leaf. One may be in several leaves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lists {
    /// The number of primitives of each leaf.
    pub counts: Vec<u32>,
    /// The primitives' numbers, leaf by leaf.
    pub order: Vec<u32>,
}

impl Lists {
    /// From one list per leaf.
    pub fn of<'a>(leaves: impl IntoIterator<Item = &'a [u32]>) -> Self {
        let mut lists = Self::default();
        for leaf in leaves {
            lists.counts.push(leaf.len() as u32);
            lists.order.extend_from_slice(leaf);
        }
        lists
    }
}

/// The result of a builder: a structure and the content of its leaves.
pub type Built = (Box<dyn Structure>, Lists);

/// A builder.
pub type Build<'a> = dyn Fn(&Input) -> Built + 'a;

/// A spatial structure that rays traverse from leaf to leaf. It knows boxes, never the content of leaves.
pub trait Structure: Send + Sync {
    /// Create a walker, which counts nodes if `counted`. The variant without counting has no code for it.
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_>;

    /// Create a walker for occlusion queries, which may visit leaves in any order. Nodes need not be counted.
    fn any_walker(&self) -> Box<dyn Walker + '_> {
        self.walker(false)
    }

    /// Create a packet walker with the vectors of a SIMD level, if the structure supports it. It counts nodes if
    /// `counted`.
    fn together(&self, counted: bool, level: Level) -> Option<Box<dyn Together + '_>> {
        let _ = (counted, level);
        None
    }

    /// Its kind, nodes, leaves, depth, bytes and cost. The caller adds the rest.
    fn info(&self) -> Info;

    /// The boxes of all nodes, given the number of primitives of each numbered leaf; `None` for structures without
    /// boxes.
    fn boxes(&self, primitives: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        let _ = primitives;
        None
    }

    /// Check the invariants of traversal, given the primitives of each leaf.
    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String>;

    /// Refit the structure to moved primitives, which stay in the same leaves.
    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let _ = (input, primitives);
        Err(format!("a {} cannot be refitted: rebuild it", self.info().kind))
    }
}

/// Traverses a structure with one ray after another.
pub trait Walker {
    /// Start a ray.
    fn start(&mut self, ray: &SlabRay);

    /// Start a ray at a time in [0, 1]. Structures without motion bound moving primitives at all times.
    fn start_at(&mut self, ray: &SlabRay, time: f64) {
        let _ = time;
        self.start(ray);
    }

    /// Return the next nonempty leaf that the ray may hit at a `t` of at most `limit`, in box units. No leaf is
    /// returned twice. Nearer leaves come first as far as the structure can order them.
    fn next(&mut self, limit: f32) -> Option<u32>;

    /// Nodes visited since the start; 0 if not counted.
    fn nodes(&self) -> u32;
}
