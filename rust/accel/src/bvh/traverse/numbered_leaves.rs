//! The tree that these traversals share: leaves have numbers, and their content is stored elsewhere.

use super::{contents, sah_cost};
use crate::bvh::build::Shapes;
use crate::bvh::{BinaryBvh, Node};
use crate::walk::{Input, Lists};
use crate::{Info, NodeBox};
use raywright_base::math::Aabb;

/// A binary tree whose leaves have their number as `index`, in the order of the nodes.
#[derive(Clone)]
pub struct Numbered {
    /// The nodes; children follow their parents.
    pub nodes: Vec<Node>,
    /// The depth of the tree.
    pub depth: usize,
    /// True if primitives may be split among several leaves.
    in_parts: bool,
    sah_cost: f64,
}

impl Numbered {
    /// Number the leaves, and return their content.
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

    /// Its statistics.
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

    /// The original tree, given the primitives of each leaf.
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

    /// Check the invariants of traversal, given the primitives of each leaf.
    pub fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let whole = self.whole(primitives)?;
        match whole.depth() {
            depth if depth != self.depth => Err(format!("depth is {depth}, not {}", self.depth)),
            _ if self.in_parts => whole.validate_parts(&input.boxes, |p, to| contents(input).clip(p, to)),
            _ => whole.validate(&input.boxes),
        }
    }

    /// The same tree with boxes refitted to moved primitives.
    pub fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Self, String> {
        if self.in_parts {
            return Err("a tree with spatial splits cannot be refitted: rebuild it".into());
        }
        let mut nodes = self.nodes.clone();
        // Children follow their parents.
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
