//! Traversals of flat nodes: stackless in depth-first order, with an index as its only state; or with a stack, nearer
//! child first.

use super::nodes::{FlatNode, flatten, unflatten};
use crate::bvh::Options;
use crate::bvh::traverse::{Numbered, gathered, larger_first};
use crate::walk::{Built, Input, Structure, Walker};
use crate::{Info, NodeBox, SlabRay};

/// Traversal algorithms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlatTraversal {
    /// With a stack.
    Stack,
    /// Without one.
    Stackless,
}

struct FlatTree {
    nodes: Vec<FlatNode>,
    /// The other data of the tree, without its nodes.
    outline: Numbered,
    way: FlatTraversal,
    kind: String,
}

/// Build a tree with the given options and flatten it.
pub fn build(input: &Input, options: &Options, way: FlatTraversal) -> Built {
    let (mut bvh, name) = gathered(input, options, BLOCK);
    larger_first(&mut bvh);
    let (numbered, lists) = Numbered::new(bvh);
    let kind = match way {
        FlatTraversal::Stack => "flat, stack",
        FlatTraversal::Stackless => "flat, stackless",
    };
    (Box::new(FlatTree::of(numbered, way, format!("BVH, {name}, {kind}"))), lists)
}

/// Triangles per SIMD test that leaves are optimized for, available at any level.
const BLOCK: usize = 4;

impl FlatTree {
    fn of(mut outline: Numbered, way: FlatTraversal, kind: String) -> Self {
        let nodes = flatten(&std::mem::take(&mut outline.nodes));
        Self { nodes, outline, way, kind }
    }

    /// The tree with adjacent siblings.
    fn numbered(&self) -> Numbered {
        let mut numbered = self.outline.clone();
        numbered.nodes = unflatten(&self.nodes);
        numbered
    }

    fn along(&self, counted: bool, way: FlatTraversal) -> Box<dyn Walker + '_> {
        let (nodes, ray) = (self.nodes.as_slice(), SlabRay::EVERYWHERE);
        let stack = Vec::with_capacity(self.outline.depth + 1);
        match (way, counted) {
            (FlatTraversal::Stackless, true) => Box::new(Stackless::<true> { nodes, ray, at: nodes.len(), visited: 0 }),
            (FlatTraversal::Stackless, false) => {
                Box::new(Stackless::<false> { nodes, ray, at: nodes.len(), visited: 0 })
            }
            (FlatTraversal::Stack, true) => Box::new(Stacked::<true> { nodes, ray, stack, visited: 0 }),
            (FlatTraversal::Stack, false) => Box::new(Stacked::<false> { nodes, ray, stack, visited: 0 }),
        }
    }
}

impl Structure for FlatTree {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        self.along(counted, self.way)
    }

    fn any_walker(&self) -> Box<dyn Walker + '_> {
        // For occlusion, larger boxes come first in the given order, without sorting.
        self.along(false, FlatTraversal::Stackless)
    }

    fn info(&self) -> Info {
        self.numbered().info(&self.kind)
    }

    fn boxes(&self, _: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        Some(self.numbered().boxes())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        for (i, node) in self.nodes.iter().enumerate() {
            let end = node.after(i);
            if end <= i || end > self.nodes.len() {
                return Err(format!("node {i} of {} ends at {end}", self.nodes.len()));
            }
            if !node.is_leaf() {
                let second = self.nodes[i + 1].after(i + 1);
                if second >= end || self.nodes[second].after(second) != end {
                    return Err(format!("the children of node {i} do not end where it does"));
                }
            }
        }
        self.numbered().validate(input, primitives)
    }

    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let tree = self.numbered().refitted(input, primitives)?;
        Ok(Box::new(Self::of(tree, self.way, self.kind.clone())))
    }
}

struct Stackless<'a, const COUNTED: bool> {
    nodes: &'a [FlatNode],
    ray: SlabRay,
    at: usize,
    visited: u32,
}

impl<const COUNTED: bool> Walker for Stackless<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        (self.ray, self.at, self.visited) = (*ray, 0, 0);
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        while let Some(node) = self.nodes.get(self.at) {
            self.visited += u32::from(COUNTED);
            if self.ray.passes(&node.aabb(), limit).is_none() {
                self.at = node.after(self.at);
                continue;
            }
            self.at += 1;
            if node.is_leaf() {
                return Some(node.index);
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.visited
    }
}

struct Stacked<'a, const COUNTED: bool> {
    nodes: &'a [FlatNode],
    ray: SlabRay,
    /// Nodes to visit, and the `t` at which the ray enters them.
    stack: Vec<(u32, f32)>,
    visited: u32,
}

impl<const COUNTED: bool> Walker for Stacked<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        (self.ray, self.visited) = (*ray, 0);
        self.stack.clear();
        if let Some(root) = self.nodes.first() {
            self.visited += u32::from(COUNTED);
            self.stack.extend(ray.passes(&root.aabb(), f32::INFINITY).map(|(enter, _)| (0, enter)));
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        while let Some((at, enter)) = self.stack.pop() {
            if enter > limit {
                continue;
            }
            let mut at = at as usize;
            while !self.nodes[at].is_leaf() {
                let (a, b) = (at + 1, self.nodes[at + 1].after(at + 1));
                self.visited += 2 * u32::from(COUNTED);
                let enters = |i: usize| self.ray.passes(&self.nodes[i].aabb(), limit).map(|(enter, _)| enter);
                at = match (enters(a), enters(b)) {
                    (Some(near), Some(far)) if near <= far => {
                        self.stack.push((b as u32, far));
                        a
                    }
                    (Some(far), Some(_)) => {
                        self.stack.push((a as u32, far));
                        b
                    }
                    (Some(_), None) => a,
                    (None, Some(_)) => b,
                    (None, None) => break,
                };
            }
            if self.nodes[at].is_leaf() {
                return Some(self.nodes[at].index);
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.visited
    }
}
