//! Occlusion traversal without sorting or distances. Of two hit children, the one with more surface area goes first,
//! since a ray that hits both is more likely to be blocked there. That order is the same for all rays, so it is stored
//! in the tree.

use super::node_volumes::NodeVolumes;
use super::numbered_leaves::Numbered;
use crate::SlabRay;
use crate::bvh::BinaryBvh;
use crate::walk::Walker;

/// Swap siblings so that the one with more surface area comes first.
pub fn larger_first(bvh: &mut BinaryBvh) {
    for i in 0..bvh.nodes.len() {
        if bvh.nodes[i].is_leaf() {
            continue;
        }
        let [a, b] = bvh.nodes[i].children();
        if bvh.nodes[a].aabb().half_area() < bvh.nodes[b].aabb().half_area() {
            bvh.nodes.swap(a, b);
        }
    }
}

/// A traversal with a stack, in the order of storage.
pub struct Unordered<'a, V: NodeVolumes> {
    tree: &'a Numbered,
    volumes: &'a V,
    ray: SlabRay,
    ready: V::Ready,
    /// Nodes to visit.
    stack: Vec<u32>,
}

impl<'a, V: NodeVolumes> Unordered<'a, V> {
    /// Create a traversal.
    pub fn new(tree: &'a Numbered, volumes: &'a V) -> Self {
        let ray = SlabRay::EVERYWHERE;
        Self { tree, volumes, ray, ready: V::ready(&ray), stack: Vec::with_capacity(tree.depth + 1) }
    }
}

impl<V: NodeVolumes> Walker for Unordered<'_, V> {
    fn start(&mut self, ray: &SlabRay) {
        self.ray = *ray;
        self.ready = V::ready(ray);
        self.stack.clear();
        if let Some(root) = self.tree.nodes.first()
            && ray.passes(&root.aabb(), f32::INFINITY).is_some()
        {
            self.stack.push(0);
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.nodes.as_slice();
        while let Some(mut at) = self.stack.pop() {
            loop {
                let node = &nodes[at as usize];
                if node.is_leaf() {
                    return Some(node.index);
                }
                let [a, b] = [node.index, node.index + 1];
                let meets = |i: u32| {
                    let within = self.ray.passes(&nodes[i as usize].aabb(), limit);
                    within.is_some_and(|within| self.volumes.narrowed(i, &self.ready, within).is_some())
                };
                at = match (meets(a), meets(b)) {
                    (true, true) => {
                        self.stack.push(b);
                        a
                    }
                    (true, false) => a,
                    (false, true) => b,
                    (false, false) => break,
                };
            }
        }
        None
    }

    /// Not counted: costs are measured for closest hits.
    fn nodes(&self) -> u32 {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Quality;
    use raywright_base::math::{Aabb, Vec3};
    use raywright_base::sampling::philox4x32;
    use raywright_base::work::Work;

    #[test]
    fn the_larger_child_comes_first_and_the_tree_stays_valid() {
        let boxes: Vec<_> = (0..300)
            .map(|i| {
                let [x, y, z, size] = philox4x32([i, 0, 0, 0], [3, 3]).map(|bits| bits as f32 / 2f32.powi(32));
                Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + 0.1 * size }
            })
            .collect();
        let (mut bvh, _) = Quality::Balanced.steps(1).whole(&boxes, Work::UNWATCHED).unwrap();
        larger_first(&mut bvh);
        bvh.validate(&boxes).unwrap();
        for node in bvh.nodes.iter().filter(|n| !n.is_leaf()) {
            let [a, b] = node.children().map(|child| bvh.nodes[child].aabb().half_area());
            assert!(a >= b);
        }
    }
}
