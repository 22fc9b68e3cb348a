//! The binary BVH of all builders, with 32-byte nodes.

use super::box_coverage::cover;
use raywright_base::math::{Aabb, Vec3};

/// A node of a binary tree: half a cache line, so that siblings share one.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Node {
    /// The min corner of the box.
    pub min: Vec3,
    /// The first of two adjacent children of an inner node; the first entry of a leaf in [`BinaryBvh::order`].
    pub index: u32,
    /// The max corner of the box.
    pub max: Vec3,
    /// The number of primitives of a leaf; 0 for an inner node.
    pub count: u32,
}

const _: () = assert!(size_of::<Node>() == 32);

impl Node {
    /// A leaf with `count` primitives from `index`.
    pub fn leaf(bounds: Aabb, index: u32, count: u32) -> Self {
        Self { min: bounds.min, index, max: bounds.max, count }
    }

    /// An inner node whose children are `index` and `index + 1`.
    pub fn inner(bounds: Aabb, index: u32) -> Self {
        Self { min: bounds.min, index, max: bounds.max, count: 0 }
    }

    /// Return whether it is a leaf.
    pub fn is_leaf(&self) -> bool {
        self.count > 0
    }

    /// The two children of an inner node.
    pub fn children(&self) -> [usize; 2] {
        [self.index as usize, self.index as usize + 1]
    }

    /// The box.
    pub fn aabb(&self) -> Aabb {
        Aabb { min: self.min, max: self.max }
    }
}

/// A binary tree over boxes. Node 0 is the root, and children follow their parent. Without primitives there are no
/// nodes.
#[derive(Clone, Debug, Default)]
pub struct BinaryBvh {
    /// The nodes.
    pub nodes: Vec<Node>,
    /// The primitives' numbers in the order of the leaves.
    pub order: Vec<u32>,
}

impl BinaryBvh {
    /// The bounding box of the tree.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, Node::aabb)
    }

    /// The depth of the tree.
    pub fn depth(&self) -> usize {
        let mut depth = vec![0usize; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().filter(|(_, n)| !n.is_leaf()) {
            for child in node.children() {
                depth[child] = depth[i] + 1;
            }
        }
        depth.into_iter().max().unwrap_or(0)
    }

    /// Check the invariants of traversal. Boxes contain those of their children and primitives, every nonempty
    /// primitive is in exactly one leaf, and children follow their parent.
    pub fn validate(&self, boxes: &[Aabb]) -> Result<(), String> {
        let mut met = vec![0u32; boxes.len()];
        self.check(|i, node, primitives| {
            for &p in primitives {
                met[p as usize] += 1;
                if !node.aabb().contains(&boxes[p as usize]) {
                    return Err(format!("leaf {i} does not contain primitive {p}"));
                }
            }
            Ok(())
        })?;
        match met.iter().zip(boxes).position(|(&n, b)| n != u32::from(!b.is_empty())) {
            Some(p) => Err(format!("primitive {p} is in {} leaves; its box is {:?}", met[p], boxes[p])),
            None => Ok(()),
        }
    }

    /// The same for trees that split primitives. Boxes contain those of their children, and children follow their
    /// parent. Every nonempty primitive is in some leaf, at most once per leaf, and the boxes of its leaves together
    /// cover it. Gaps of less than 2⁻²⁰ of the primitive's largest coordinate are not detected, nor gaps hidden by the
    /// bounds of `clip`; see [`Builder::build`](super::build::Builder::build).
    pub fn validate_parts(&self, boxes: &[Aabb], clip: impl Fn(u32, &Aabb) -> Aabb) -> Result<(), String> {
        let mut parts = vec![Vec::new(); boxes.len()];
        self.check(|i, node, primitives| {
            for (k, &p) in primitives.iter().enumerate() {
                parts[p as usize].push(node.aabb());
                if primitives[..k].contains(&p) {
                    return Err(format!("leaf {i} has primitive {p} twice"));
                }
            }
            Ok(())
        })?;
        for (p, (parts, whole)) in parts.iter().zip(boxes).enumerate() {
            if whole.is_empty() != parts.is_empty() {
                return Err(format!("primitive {p} is in {} leaves; its box is {whole:?}", parts.len()));
            }
            if !cover(parts, whole, |to| clip(p as u32, to)) {
                return Err(format!("{} leaves together do not contain primitive {p}", parts.len()));
            }
        }
        Ok(())
    }

    /// Check that children follow their parents, whose boxes contain theirs, and run another check on each leaf and its
    /// primitives.
    fn check(&self, mut leaf: impl FnMut(usize, &Node, &[u32]) -> Result<(), String>) -> Result<(), String> {
        let mut parents = vec![0u32; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            if node.is_leaf() {
                let range = node.index as usize..node.index as usize + node.count as usize;
                let Some(primitives) = self.order.get(range.clone()) else {
                    return Err(format!("leaf {i} has primitives {range:?} of {}", self.order.len()));
                };
                leaf(i, node, primitives)?;
            } else {
                for child in node.children() {
                    if child <= i || child >= self.nodes.len() {
                        return Err(format!("node {i} of {} has child {child}", self.nodes.len()));
                    }
                    parents[child] += 1;
                    if !node.aabb().contains(&self.nodes[child].aabb()) {
                        return Err(format!("node {i} does not contain its child {child}"));
                    }
                }
            }
        }
        match parents.iter().skip(1).position(|&n| n != 1) {
            Some(i) => Err(format!("node {} has {} parents", i + 1, parents[i + 1])),
            None => Ok(()),
        }
    }
}
