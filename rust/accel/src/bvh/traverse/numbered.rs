//! The tree that all these ways share: leaves are known by numbers of their own, and what is in them is for others to
//! keep.

use super::{contents, sah_cost};
use crate::bvh::build::Shapes;
use crate::bvh::{BinaryBvh, Node};
use crate::walk::{Input, Lists};
use crate::{Info, NodeBox};
use raywright_base::math::Aabb;

/// A binary tree whose leaves have their own number for `index`: they are numbered as their nodes are.
#[derive(Clone)]
pub struct Numbered {
    /// The nodes; children come after their parents.
    pub nodes: Vec<Node>,
    /// The longest way from the root to a leaf.
    pub depth: usize,
    /// Whether a primitive may stand in several leaves, each of which holds a part of it.
    in_parts: bool,
    sah_cost: f64,
}

impl Numbered {
    /// Numbers the leaves, and tells what stands in them.
    pub fn new(bvh: BinaryBvh) -> (Self, Lists) {
        let of = |node: &Node| &bvh.order[node.index as usize..(node.index + node.count) as usize];
        let lists = Lists::of(bvh.nodes.iter().filter(|n| n.is_leaf()).map(of));
        let mut met = vec![false; lists.order.iter().max().map_or(0, |&last| last as usize + 1)];
        let in_parts = lists.order.iter().any(|&p| std::mem::replace(&mut met[p as usize], true));
        let (depth, sah_cost) = (bvh.depth(), sah_cost(&bvh));
        let mut nodes = bvh.nodes;
        for (leaf, node) in nodes.iter_mut().filter(|n| n.is_leaf()).enumerate() {
            node.index = leaf as u32;
        }
        (Self { nodes, depth, in_parts, sah_cost }, lists)
    }

    /// What it looks like.
    pub fn info(&self, kind: &str) -> Info {
        let leaves = self.nodes.iter().filter(|n| n.is_leaf()).count();
        Info {
            kind: kind.to_string(),
            nodes: self.nodes.len() - leaves,
            leaves,
            depth: self.depth,
            bytes: size_of_val(self.nodes.as_slice()),
            sah_cost: self.sah_cost,
            ..Info::default()
        }
    }

    /// The boxes of all nodes.
    pub fn boxes(&self) -> Vec<NodeBox> {
        let mut depths = vec![0; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
            for child in node.children() {
                depths[child] = depths[i] + 1;
            }
        }
        let primitives = |node: &Node| node.is_leaf().then_some(node.count as usize);
        let nodes = self.nodes.iter().zip(depths);
        nodes.map(|(node, depth)| NodeBox { aabb: node.aabb(), depth, primitives: primitives(node) }).collect()
    }

    /// The tree as builders make it, given the primitives of each leaf.
    fn whole(&self, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<BinaryBvh, String> {
        let mut whole = BinaryBvh { nodes: self.nodes.clone(), order: Vec::new() };
        for node in whole.nodes.iter_mut().filter(|n| n.is_leaf()) {
            let mine = primitives(node.index);
            if mine.len() != node.count as usize {
                return Err(format!("leaf {} has {} primitives, not {}", node.index, mine.len(), node.count));
            }
            node.index = whole.order.len() as u32;
            whole.order.extend(mine);
        }
        Ok(whole)
    }

    /// Checks what walks rely on, given the primitives of each leaf.
    pub fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let whole = self.whole(primitives)?;
        match whole.depth() {
            depth if depth != self.depth => Err(format!("depth is {depth}, not {}", self.depth)),
            _ if self.in_parts => whole.validate_parts(&input.boxes, |p, to| contents(input).clip(p, to)),
            _ => whole.validate(&input.boxes),
        }
    }

    /// The same tree around primitives that have moved.
    pub fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Self, String> {
        if self.in_parts {
            return Err("spatial splits are made for where things are: build the tree again".into());
        }
        let mut nodes = self.nodes.clone();
        // Children come after their parents.
        for i in (0..nodes.len()).rev() {
            let node = &nodes[i];
            let around = if node.is_leaf() {
                primitives(node.index).into_iter().fold(Aabb::EMPTY, |b, p| b.union(input.boxes[p as usize]))
            } else {
                let [a, b] = node.children();
                nodes[a].aabb().union(nodes[b].aabb())
            };
            (nodes[i].min, nodes[i].max) = (around.min, around.max);
        }
        let moved = BinaryBvh { nodes, order: Vec::new() };
        Ok(Self { sah_cost: sah_cost(&moved), nodes: moved.nodes, ..*self })
    }
}
