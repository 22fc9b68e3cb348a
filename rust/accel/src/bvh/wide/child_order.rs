//! The order in which occlusion rays visit the children of a node.
//!
//! Suppose that each child blocks a ray with probability p, at an expected cost C. Visiting by decreasing p / C
//! minimizes the expected cost if the probabilities are independent. (Ogaki and Derouet-Jourdan, "An N-ary BVH Child
//! Node Sorting Technique for Occlusion Tests", 2016, sort by such estimates.) A random ray that hits a convex box of
//! surface area S, which contains triangles of area T, hits T / (S / 2) of them on average. This is Cauchy's formula:
//! projected areas are a quarter of a convex body's surface and half of a triangle's. So it hits at least one with a
//! probability of about 1 − e^(−2T / S).

use super::WideBvh;
use super::node::{Packed, WideNode};
use raywright_base::math::{Aabb, DVec3};
use raywright_base::parallel;
use raywright_shapes::triangle::Leaves;
use std::array::from_fn;

/// The expectation for a ray that hits a child's box.
#[derive(Clone, Copy)]
struct Prospect {
    /// The probability of a hit.
    chance: f32,
    /// The expected number of steps until a hit, or until all is visited.
    cost: f32,
}

impl Prospect {
    /// The probability of a hit per step.
    fn worth(self) -> f32 {
        self.chance / self.cost
    }
}

/// The data about a child that do not depend on its descendants.
struct ChildBounds {
    /// The probability that a ray through the node hits the child.
    met: f32,
    of_leaf: Option<Prospect>,
}

impl<const N: usize, L: Leaves<N>> WideBvh<N, L> {
    /// Move the children of all nodes to the lanes that suit occlusion rays.
    pub(super) fn arrange(&mut self) {
        let (region, axes) = (self.region, self.axes);
        arrange(&mut self.nodes, &self.leaves, |corner| region.to_box_along(axes.as_ref(), corner));
    }
}

/// The same for given nodes. Rays visit lanes from the last to the first, and children follow their parents. `to_box`
/// transforms corners to the space of the boxes.
fn arrange<const N: usize, L: Leaves<N>>(
    nodes: &mut [WideNode<N>],
    leaves: &L,
    to_box: impl Fn(DVec3) -> DVec3 + Sync,
) {
    // Local data in parallel; then a sequential bottom-up pass, which is little work; then the moves.
    let known: Vec<[ChildBounds; N]> = parallel::collect(nodes.len(), |i| {
        let node = &nodes[i];
        let whole = node.bounds().half_area().max(f32::MIN_POSITIVE);
        from_fn(|lane| {
            let (child, bounds) = (Packed::of(node.children[lane]), node.aabb(lane));
            let of_leaf = (child.kind() == 1).then(|| leaf(leaves, &to_box, child, &bounds));
            ChildBounds { met: (bounds.half_area() / whole).min(1.0), of_leaf }
        })
    });
    let mut of_nodes = vec![Prospect { chance: 0.0, cost: 1.0 }; nodes.len()];
    let mut orders = vec![[0; N]; nodes.len()];
    for (index, node) in nodes.iter().enumerate().rev() {
        let of = |lane: u8| {
            let of_leaf = known[index][usize::from(lane)].of_leaf;
            of_leaf.unwrap_or_else(|| of_nodes[node.children[usize::from(lane)] as usize])
        };
        let lanes = &mut orders[index];
        *lanes = from_fn(|lane| lane as u8);
        let lanes = &mut lanes[..node.count()];
        lanes.sort_by(|&a, &b| of(a).worth().total_cmp(&of(b).worth()));
        // The last one is visited first.
        let (mut still, mut cost) = (1.0, 1.0);
        for &lane in lanes.iter().rev() {
            let (of, met) = (of(lane), known[index][usize::from(lane)].met);
            cost += still * met * of.cost;
            still *= 1.0 - met * of.chance;
        }
        of_nodes[index] = Prospect { chance: 1.0 - still, cost };
    }
    parallel::each_chunk_mut(nodes, 512, &|first, nodes| {
        for (node, lanes) in nodes.iter_mut().zip(&orders[first..]) {
            node.permute(&lanes[..node.count()]);
        }
    });
}

/// The expectation for a leaf in a box.
fn leaf<const N: usize, L: Leaves<N>>(
    leaves: &L,
    to_box: &impl Fn(DVec3) -> DVec3,
    leaf: Packed,
    bounds: &Aabb,
) -> Prospect {
    let (first, count) = leaf.leaf();
    let twice: f64 = (0..count as usize)
        .map(|lane| {
            let [a, b, c] = leaves.corners(first, count, lane).map(to_box);
            (b - a).cross(c - a).length()
        })
        .sum();
    let shade = twice as f32 / 2.0 / bounds.half_area().max(f32::MIN_POSITIVE);
    Prospect { chance: 1.0 - (-shade).exp(), cost: 1.0 }
}

#[cfg(test)]
mod tests {
    use super::super::node::Child;
    use super::*;
    use raywright_base::math::{Region, Vec3};
    use raywright_shapes::triangle::SingleLeaves;

    #[test]
    fn what_hides_more_for_less_is_visited_first() {
        // Adjacent unit boxes: a wall, a splinter, and a node over two walls.
        let wall = |x: f64, size: f64| {
            let corner = DVec3::new(x, 0.0, 0.5);
            [corner, corner + DVec3::X * size, corner + DVec3::Y * size]
        };
        let triangles = [wall(0.0, 1.0), wall(1.0, 0.01), wall(2.0, 1.0), wall(2.0, 1.0)];
        let region = Region::around(triangles.iter().flatten().copied());
        let leaves = SingleLeaves::<8>::new(&region, &[0, 1, 2, 3], &[1, 1, 1, 1], |p| triangles[p as usize]);
        let unit =
            |x: f64| region.aabb([DVec3::new(x, 0.0, 0.0), DVec3::new(x + 1.0, 1.0, 1.0), DVec3::new(x, 0.0, 0.0)]);
        let leaf = |first: u32| Child::Leaf { first, count: 1 };
        let root = [(unit(0.0), leaf(0)), (unit(1.0), leaf(1)), (unit(2.0), Child::Node(1))];
        let half = |z: f32| {
            let whole = unit(2.0);
            let middle = (whole.min.z + whole.max.z) / 2.0;
            let min = Vec3::new(whole.min.x, whole.min.y, if z > 0.0 { middle } else { whole.min.z });
            Aabb { min, max: Vec3::new(whole.max.x, whole.max.y, if z > 0.0 { whole.max.z } else { middle }) }
        };
        let mut nodes = [WideNode::<8>::new(&root), WideNode::new(&[(half(0.0), leaf(2)), (half(1.0), leaf(3))])];
        arrange(&mut nodes, &leaves, |corner| region.to_box(corner));
        // The last one is visited first: a wall at once; walls after another step; almost nothing.
        let order: Vec<_> = nodes[0].children().map(|(_, child)| child).collect();
        assert_eq!(order, [leaf(1), Child::Node(1), leaf(0)]);
    }
}
