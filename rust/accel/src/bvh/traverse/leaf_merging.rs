//! Merging of leaves to the cheapest size, for trees that are traversed as they are. Bottom-up builders make a leaf per
//! primitive, and optimizers leave leaves unchanged.

use crate::bvh::{BinaryBvh, Node};

/// The costs of traversal and intersection.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Cost of a traversal step.
    pub traversal: f32,
    /// Cost of testing a block.
    pub intersection: f32,
    /// Primitives per SIMD test.
    pub block: usize,
}

/// Maximum number of primitives in a merged leaf.
const MOST: usize = 32;

/// Turn a subtree into a leaf wherever that costs no more by the surface area heuristic (Goldsmith and Salmon 1987).
/// Several parts of a primitive in a subtree become one reference. The result is in depth-first order.
pub fn gather(bvh: &BinaryBvh, costs: Costs) -> BinaryBvh {
    let whole = is_whole(bvh, costs);
    let mut gathered = BinaryBvh { nodes: Vec::with_capacity(bvh.nodes.len()), order: Vec::new() };
    gathered.nodes.extend(bvh.nodes.first());
    let mut open: Vec<_> = bvh.nodes.first().map(|_| (0, 0)).into_iter().collect();
    while let Some((from, to)) = open.pop() {
        let bounds = bvh.nodes[from].aabb();
        gathered.nodes[to] = if whole[from] {
            let first = gathered.order.len();
            below(bvh, from, |p| {
                if !gathered.order[first..].contains(&p) {
                    gathered.order.push(p);
                }
            });
            Node::leaf(bounds, first as u32, (gathered.order.len() - first) as u32)
        } else {
            let at = gathered.nodes.len();
            let [a, b] = bvh.nodes[from].children();
            gathered.nodes.extend([bvh.nodes[a], bvh.nodes[b]]);
            open.extend([(b, at + 1), (a, at)]);
            Node::inner(bounds, at as u32)
        };
    }
    gathered
}

/// Return whether each node becomes a leaf.
fn is_whole(bvh: &BinaryBvh, costs: Costs) -> Vec<bool> {
    let mut whole: Vec<bool> = bvh.nodes.iter().map(Node::is_leaf).collect();
    // The number of primitives below each node, and their cost.
    let mut known = vec![(0, 0.0); bvh.nodes.len()];
    for (i, node) in bvh.nodes.iter().enumerate().rev() {
        let area = f64::from(node.aabb().half_area());
        let leaf = |count: usize| f64::from(costs.intersection) * area * count.div_ceil(costs.block) as f64;
        known[i] = if node.is_leaf() {
            (node.count as usize, leaf(node.count as usize))
        } else {
            let [(a, left), (b, right)] = node.children().map(|child| known[child]);
            let apart = f64::from(costs.traversal) * area + left + right;
            whole[i] = a + b <= MOST && leaf(a + b) <= apart;
            (a + b, if whole[i] { leaf(a + b) } else { apart })
        };
    }
    whole
}

/// Report every primitive below a node, from left to right.
fn below(bvh: &BinaryBvh, from: usize, mut tell: impl FnMut(u32)) {
    let mut open = vec![from];
    while let Some(i) = open.pop() {
        let node = &bvh.nodes[i];
        if node.is_leaf() {
            bvh.order[node.index as usize..(node.index + node.count) as usize].iter().for_each(|&p| tell(p));
        } else {
            let [a, b] = node.children();
            open.extend([b, a]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::morton::Bits;
    use crate::bvh::build::{Builder, Leaves, assert_depth_first};
    use raywright_base::math::{Aabb, Vec3};
    use raywright_base::sampling::philox4x32;
    use raywright_base::work::Work;

    fn tree(count: u32) -> (Vec<Aabb>, BinaryBvh) {
        let boxes: Vec<_> = (0..count)
            .map(|i| {
                let [x, y, z, size] = philox4x32([i, 0, 0, 0], [5, 5]).map(|bits| bits as f32 / 2f32.powi(32));
                Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + 0.1 * size }
            })
            .collect();
        let clip = |p: u32, to: &Aabb| boxes[p as usize].intersection(*to);
        let builder = Builder::Morton(Bits::default());
        let bvh = builder.build(&boxes, clip, &Leaves::for_blocks(1), Work::UNWATCHED).unwrap();
        (boxes, bvh)
    }

    fn cost(bvh: &BinaryBvh, costs: Costs) -> f64 {
        let of = |node: &Node| {
            let tests = match node.count as usize {
                0 => costs.traversal,
                count => costs.intersection * count.div_ceil(costs.block) as f32,
            };
            f64::from(node.aabb().half_area() * tests)
        };
        bvh.nodes.iter().map(of).sum()
    }

    #[test]
    fn gathered_trees_are_valid_and_cost_less() {
        for count in [0, 1, 2, 3, 7, 500] {
            let (boxes, bvh) = tree(count);
            for (intersection, block) in [(1.0, 4), (1.0, 1), (0.01, 1), (100.0, 4)] {
                let costs = Costs { traversal: 1.0, intersection, block };
                let gathered = gather(&bvh, costs);
                gathered.validate(&boxes).unwrap();
                assert_depth_first(&gathered);
                assert!(gathered.nodes.iter().all(|n| n.count as usize <= MOST));
                assert!(cost(&gathered, costs) <= cost(&bvh, costs));
            }
        }
    }

    #[test]
    fn where_tests_are_dear_nothing_is_gathered() {
        let (_, bvh) = tree(500);
        let nodes = |intersection| gather(&bvh, Costs { traversal: 1.0, intersection, block: 1 }).nodes.len();
        assert_eq!(nodes(1e6), bvh.nodes.len());
        assert!(nodes(1e-6) * MOST < 4 * bvh.nodes.len());
    }

    #[test]
    fn parts_of_one_primitive_are_one_in_a_leaf() {
        let half = |x: f32| Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 1.0, 1.0, 1.0) };
        let nodes =
            vec![Node::inner(half(0.0).union(half(1.0)), 1), Node::leaf(half(0.0), 0, 1), Node::leaf(half(1.0), 1, 1)];
        let bvh = BinaryBvh { nodes, order: vec![7, 7] };
        let gathered = gather(&bvh, Costs { traversal: 1.0, intersection: 1.0, block: 4 });
        assert_eq!((gathered.nodes.len(), gathered.order), (1, vec![7]));
    }
}
