//! The stack: the nearer child first, the other put away with the distance at which its box begins, and left out when something nearer
//! was found meanwhile.

use super::{leaves, sah_cost};
use crate::accel::bvh::BinaryBvh;
use crate::accel::walk::{Built, Input, Structure, Walker};
use crate::accel::{Info, SlabRay};
use crate::math::Aabb;

/// A binary tree walked with a stack.
pub struct Ordered {
    /// Its leaves have their own number for `index`.
    bvh: BinaryBvh,
    depth: usize,
    kind: String,
}

impl Ordered {
    /// Walks a tree; `kind` says how it was built.
    pub fn over(mut bvh: BinaryBvh, kind: &str) -> Built {
        let (numbers, lists) = leaves(&bvh);
        for (leaf, &node) in numbers.iter().enumerate() {
            bvh.nodes[node as usize].index = leaf as u32;
        }
        bvh.order = Vec::new();
        let kind = format!("BVH, {kind}, stack");
        (Box::new(Self { depth: bvh.depth(), bvh, kind }), lists)
    }
}

impl Structure for Ordered {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        // A path puts one child away a level.
        let stack = Vec::with_capacity(self.depth + 1);
        if counted {
            Box::new(Walk::<true> { tree: self, ray: SlabRay::EVERYWHERE, stack, nodes: 0 })
        } else {
            Box::new(Walk::<false> { tree: self, ray: SlabRay::EVERYWHERE, stack, nodes: 0 })
        }
    }

    fn info(&self) -> Info {
        let leaves = self.bvh.nodes.iter().filter(|n| n.is_leaf()).count();
        Info {
            kind: self.kind.clone(),
            nodes: self.bvh.nodes.len() - leaves,
            leaves,
            depth: self.depth,
            bytes: size_of_val(self.bvh.nodes.as_slice()),
            sah_cost: sah_cost(&self.bvh),
            ..Info::default()
        }
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let mut whole = self.bvh.clone();
        for node in whole.nodes.iter_mut().filter(|n| n.is_leaf()) {
            let mine = primitives(node.index);
            if mine.len() != node.count as usize {
                return Err(format!("leaf {} has {} primitives, not {}", node.index, mine.len(), node.count));
            }
            node.index = whole.order.len() as u32;
            whole.order.extend(mine);
        }
        match whole.depth() {
            depth if depth == self.depth => whole.validate(&input.boxes),
            depth => Err(format!("depth is {depth}, not {}", self.depth)),
        }
    }

    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let mut bvh = self.bvh.clone();
        // Children come after their parents.
        for i in (0..bvh.nodes.len()).rev() {
            let node = &bvh.nodes[i];
            let around = if node.is_leaf() {
                primitives(node.index).into_iter().fold(Aabb::EMPTY, |b, p| b.union(input.boxes[p as usize]))
            } else {
                let [a, b] = node.children();
                bvh.nodes[a].aabb().union(bvh.nodes[b].aabb())
            };
            (bvh.nodes[i].min, bvh.nodes[i].max) = (around.min, around.max);
        }
        Ok(Box::new(Self { bvh, depth: self.depth, kind: self.kind.clone() }))
    }
}

struct Walk<'a, const COUNTED: bool> {
    tree: &'a Ordered,
    ray: SlabRay,
    /// Nodes that are met, and from where on.
    stack: Vec<(u32, f32)>,
    nodes: u32,
}

impl<const COUNTED: bool> Walker for Walk<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.ray = *ray;
        self.nodes = 0;
        self.stack.clear();
        if let Some(root) = self.tree.bvh.nodes.first() {
            self.nodes += u32::from(COUNTED);
            self.stack.extend(ray.passes(&root.aabb(), f32::INFINITY).map(|(enter, _)| (0, enter)));
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.bvh.nodes.as_slice();
        while let Some((mut at, enter)) = self.stack.pop() {
            if enter > limit {
                continue;
            }
            loop {
                let node = &nodes[at as usize];
                if node.is_leaf() {
                    return Some(node.index);
                }
                if COUNTED {
                    self.nodes += 2;
                }
                let [a, b] = [node.index, node.index + 1];
                let passes = |i: u32| self.ray.passes(&nodes[i as usize].aabb(), limit);
                at = match (passes(a), passes(b)) {
                    (Some((enter, _)), Some((other, _))) if enter <= other => {
                        self.stack.push((b, other));
                        a
                    }
                    (Some((enter, _)), Some(_)) => {
                        self.stack.push((a, enter));
                        b
                    }
                    (Some(_), None) => a,
                    (None, Some(_)) => b,
                    (None, None) => break,
                };
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}
