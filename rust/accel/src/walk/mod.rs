//! Structures that are walked by one ray at a time, as textbooks have them.
//!
//! A [`Structure`] knows boxes and gives leaves, in the order in which a ray comes to them; what stands in the leaves,
//! triangles or anything else, is tested here, by the same decision that all accelerators share. So its file holds its
//! idea and nothing else, and every question can be asked of it, by way of [`walked`](super::walked()).
//!
//! Rays are walked in box units as [`SlabRay`] makes them ready: where it says at which `t` a plane is met, both ends
//! of that are padded, and a walk that takes an interval for what it may be at most, and goes where it may be, misses
//! nothing.

mod contents;
mod few;
mod mailbox;
mod parts;
mod room;
mod together;

pub(super) use contents::Contents;
pub(super) use few::Few;
pub use mailbox::Mailbox;
pub(super) use mailbox::{Mailboxes, Marks};
pub(super) use parts::{Halves, Part, Plane};
pub(super) use room::Room;
pub(super) use together::TogetherBatch;
pub use together::{MOST_TOGETHER, Together};

use super::{Info, NodeBox, Primitives, SlabRay};
use raywright_base::math::{Aabb, Region};
use raywright_base::simd::Level;
use raywright_base::work::Work;

/// What a structure is built from.
pub struct Input<'a> {
    /// Where the primitives lie; its units are those of boxes.
    pub region: Region,
    /// The box of each primitive in box units, rounded outwards; empty for what can not be hit, and what has no end.
    pub boxes: Vec<Aabb>,
    /// The primitives themselves.
    pub primitives: &'a dyn Primitives,
    /// The build as it is watched. One that is stopped may make a structure over anything, nothing included.
    pub work: Work<'a>,
}

/// Which primitives stand in which leaf. One may stand in several.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lists {
    /// How many each leaf has.
    pub counts: Vec<u32>,
    /// Their numbers, leaf by leaf.
    pub order: Vec<u32>,
}

impl Lists {
    /// From one list a leaf.
    pub fn of<'a>(leaves: impl IntoIterator<Item = &'a [u32]>) -> Self {
        let mut lists = Self::default();
        for leaf in leaves {
            lists.counts.push(leaf.len() as u32);
            lists.order.extend_from_slice(leaf);
        }
        lists
    }
}

/// A structure, and which primitives stand in its leaves: what a builder makes.
pub type Built = (Box<dyn Structure>, Lists);

/// Makes a structure of what there is.
pub type Build<'a> = dyn Fn(&Input) -> Built + 'a;

/// What rays walk through, from leaf to leaf. It knows boxes, never what is in them.
pub trait Structure: Send + Sync {
    /// Ready to walk, counting nodes if `counted`. Whoever counts none should have no code for it.
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_>;

    /// Ready to walk for rays of which nothing has to be known but whether they hit: leaves may come in any order.
    /// Nodes need not be counted.
    fn any_walker(&self) -> Box<dyn Walker + '_> {
        self.walker(false)
    }

    /// Ready to walk with some rays together, by the vectors of a level, if that is how it should be; counting nodes if
    /// `counted`.
    fn together(&self, counted: bool, level: Level) -> Option<Box<dyn Together + '_>> {
        let _ = (counted, level);
        None
    }

    /// Its kind, nodes, leaves, depth, bytes and cost. The rest is for others to say.
    fn info(&self) -> Info;

    /// The boxes of all nodes, told how many primitives stand in each leaf that has a number; `None` of what has none.
    fn boxes(&self, primitives: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        let _ = primitives;
        None
    }

    /// Checks what walks rely on, given the primitives of each leaf.
    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String>;

    /// The same structure over primitives that have moved, which stand in the same leaves.
    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let _ = (input, primitives);
        Err(format!("a {} is built for where things are: build it anew", self.info().kind))
    }
}

/// Takes one ray after the other through a structure.
pub trait Walker {
    /// Begins with a ray.
    fn start(&mut self, ray: &SlabRay);

    /// The same for a ray that is asked at a time, from 0 to 1. Structures that know no motion hold whatever moves at
    /// any time.
    fn start_at(&mut self, ray: &SlabRay, time: f64) {
        let _ = time;
        self.start(ray);
    }

    /// The next leaf with anything in it that the ray may meet at a `t` of no more than `limit`, in box units. No leaf
    /// is given twice, and leaves that may be met sooner come first as far as the structure can tell.
    fn next(&mut self, limit: f32) -> Option<u32>;

    /// Nodes visited since the start; 0 if none are counted.
    fn nodes(&self) -> u32;
}
