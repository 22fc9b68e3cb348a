//! Nodes of 32 bytes in depth-first order.
//!
//! A node needs only one link. An inner node is followed by its first child, and links to the node after its subtree.
//! Traversal continues there after a miss (Smits, "Efficiency Issues for Ray Tracing", 1998), and the link of a first
//! child is its sibling. The same array serves traversals with and without a stack.

use crate::bvh::Node;
use raywright_base::math::{Aabb, Vec3};

/// A node.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FlatNode {
    /// The min corner of the box, in box units.
    pub min: [f32; 3],
    /// The node after the subtree of an inner node; the first primitive of a leaf.
    pub index: u32,
    /// The max corner.
    pub max: [f32; 3],
    /// The number of primitives of a leaf; 0 for an inner node.
    pub count: u32,
}

const _: () = assert!(size_of::<FlatNode>() == 32);

impl FlatNode {
    /// Return whether it is a leaf.
    #[inline(always)]
    pub fn is_leaf(&self) -> bool {
        self.count > 0
    }

    /// The box.
    #[inline(always)]
    pub fn aabb(&self) -> Aabb {
        Aabb { min: Vec3::from_array(self.min), max: Vec3::from_array(self.max) }
    }

    /// The node after the subtree, given the node's own index.
    #[inline(always)]
    pub fn after(&self, own: usize) -> usize {
        if self.is_leaf() { own + 1 } else { self.index as usize }
    }
}

/// Arrange the nodes of a tree in depth-first order; leaves keep their `index`.
pub fn flatten(nodes: &[Node]) -> Vec<FlatNode> {
    let mut flat: Vec<FlatNode> = Vec::with_capacity(nodes.len());
    // The next node to enter, or a finished subtree.
    enum Step {
        Enter(usize),
        Leave(usize),
    }
    let mut open: Vec<_> = nodes.first().map(|_| Step::Enter(0)).into_iter().collect();
    while let Some(step) = open.pop() {
        match step {
            Step::Enter(i) => {
                let node = &nodes[i];
                let at = flat.len();
                let (min, max) = (node.min.to_array(), node.max.to_array());
                flat.push(FlatNode { min, index: node.index, max, count: node.count });
                if !node.is_leaf() {
                    let [a, b] = node.children();
                    open.extend([Step::Leave(at), Step::Enter(b), Step::Enter(a)]);
                }
            }
            Step::Leave(at) => flat[at].index = flat.len() as u32,
        }
    }
    flat
}

/// Restore the tree with adjacent siblings; leaves keep their `index`.
pub fn unflatten(flat: &[FlatNode]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(flat.len());
    nodes.extend(flat.first().map(|root| Node::leaf(root.aabb(), 0, 1)));
    let mut open: Vec<_> = flat.first().map(|_| (0, 0)).into_iter().collect();
    while let Some((from, to)) = open.pop() {
        let node: &FlatNode = &flat[from];
        nodes[to] = if node.is_leaf() {
            Node::leaf(node.aabb(), node.index, node.count)
        } else {
            let at = nodes.len();
            let (first, second) = (from + 1, flat[from + 1].after(from + 1));
            nodes.extend([first, second].map(|i| Node::leaf(flat[i].aabb(), 0, 1)));
            open.extend([(second, at + 1), (first, at)]);
            Node::inner(node.aabb(), at as u32)
        };
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(x: f32) -> Aabb {
        Aabb { min: Vec3::splat(x), max: Vec3::splat(x + 1.0) }
    }

    #[test]
    fn trees_are_flattened_and_back() {
        // ((a b) (c (d e))), with adjacent siblings, so not in depth-first order.
        let tree = [
            Node::inner(of(0.0), 1),
            Node::inner(of(1.0), 3),
            Node::inner(of(2.0), 5),
            Node::leaf(of(3.0), 10, 1),
            Node::leaf(of(4.0), 11, 2),
            Node::leaf(of(5.0), 12, 1),
            Node::inner(of(6.0), 7),
            Node::leaf(of(7.0), 13, 1),
            Node::leaf(of(8.0), 14, 3),
        ];
        let flat = flatten(&tree);
        let told: Vec<_> = flat.iter().map(|n| (n.min[0] as u32, n.index, n.count)).collect();
        let expected =
            [(0, 9, 0), (1, 4, 0), (3, 10, 1), (4, 11, 2), (2, 9, 0), (5, 12, 1), (6, 9, 0), (7, 13, 1), (8, 14, 3)];
        assert_eq!(told, expected);
        let back = unflatten(&flat);
        assert_eq!(flatten(&back), flat);
        assert_eq!(back.len(), tree.len());
        assert!(flatten(&[]).is_empty() && unflatten(&[]).is_empty());
        assert_eq!(unflatten(&flatten(&tree[3..4])).len(), 1);
    }
}
