//! A balanced kd-tree for nearest-neighbor queries.

use raywright_base::math::DVec3;
use std::collections::BinaryHeap;

/// A balanced, pointerless kd-tree (Bentley, "Multidimensional Binary Search Trees", 1975; Jensen, "Realistic Image
/// Synthesis Using Photon Mapping", 2001). The median point of a range splits it along the longest side of its bounding
/// box.
#[derive(Debug)]
pub struct PointKdTree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    point: DVec3,
    number: u32,
    /// Split axis between the points before and after this one in its range.
    axis: u32,
}

/// A neighbor: its squared distance and its index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Squared distance as measured.
    pub squared: f64,
    /// Index of the point.
    pub number: u32,
}

impl Eq for Near {}

impl Ord for Near {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.squared.total_cmp(&other.squared).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Near {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PointKdTree {
    /// Build the tree. Points are numbered in their order.
    pub fn new(points: impl Iterator<Item = DVec3>) -> Self {
        let node = |(number, point)| Node { point, number, axis: 0 };
        let mut nodes: Vec<Node> = (0u32..).zip(points).map(node).collect();
        let mut ranges = Vec::new();
        ranges.push(0..nodes.len());
        while let Some(range) = ranges.pop() {
            if range.len() < 2 {
                continue;
            }
            let part = &mut nodes[range.clone()];
            let (min, max) = part
                .iter()
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), n| (min.min(n.point), max.max(n.point)));
            let axis = (max - min).max_position();
            let middle = part.len() / 2;
            // Ties are broken by index, so that the order is deterministic.
            part.select_nth_unstable_by(middle, |a, b| {
                a.point[axis].total_cmp(&b.point[axis]).then(a.number.cmp(&b.number))
            });
            part[middle].axis = axis as u32;
            let at = range.start + middle;
            ranges.extend([range.start..at, at + 1..range.end]);
        }
        Self { nodes }
    }

    /// Find the nearest points, at most `count`, with squared distances below `most`. `measure` maps the index and the
    /// squared distance of a point to the squared distance to use. It may only increase it, or reject the point with
    /// `None`. Points are returned by increasing distance.
    pub fn nearest(
        &self,
        place: DVec3,
        count: usize,
        most: f64,
        measure: impl Fn(u32, f64) -> Option<f64>,
        found: &mut Vec<Near>,
    ) {
        found.clear();
        if count == 0 {
            return;
        }
        let mut heap = BinaryHeap::from(std::mem::take(found));
        // Ranges to visit, with lower bounds of their squared distances.
        let mut ranges = vec![(0, self.nodes.len(), 0.0)];
        while let Some((start, end, least)) = ranges.pop() {
            let bound = |heap: &BinaryHeap<Near>| match heap.peek() {
                Some(farthest) if heap.len() == count => farthest.squared,
                _ => most,
            };
            if start == end || least > bound(&heap) {
                continue;
            }
            let at = start + (end - start) / 2;
            let node = &self.nodes[at];
            let squared = node.point.distance_squared(place);
            if squared < most
                && let Some(squared) = measure(node.number, squared).filter(|squared| *squared < most)
            {
                let near = Near { squared, number: node.number };
                if heap.len() < count {
                    heap.push(near);
                } else if heap.peek().is_some_and(|farthest| near < *farthest) {
                    heap.pop();
                    heap.push(near);
                }
            }
            let beyond = place[node.axis as usize] - node.point[node.axis as usize];
            let across = least.max(beyond * beyond);
            let (before, after) = ((start, at), (at + 1, end));
            let (near, far) = if beyond < 0.0 { (before, after) } else { (after, before) };
            // The stack's last entry is visited first.
            ranges.extend([(far.0, far.1, across), (near.0, near.1, least)]);
        }
        *found = heap.into_sorted_vec();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    fn points(count: u32) -> Vec<DVec3> {
        // Some points coincide, and many are collinear.
        let point = |i: u32| {
            let mut sampler = Sampler::new(2, i / 3 * 2, 0);
            let point = DVec3::new(sampler.one(0), sampler.one(1), sampler.one(2));
            if i.is_multiple_of(5) { DVec3::new(0.5, point.y, 0.5) } else { point }
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn the_nearest_are_found() {
        for count in [0, 1, 2, 3, 10, 1000] {
            let points = points(count);
            let tree = PointKdTree::new(points.iter().copied());
            let mut found = Vec::new();
            for place in points.iter().take(40).map(|p| *p + 0.01).chain([DVec3::splat(9.0), DVec3::splat(0.5)]) {
                for (wanted, most) in [(0, 9.0), (1, f64::INFINITY), (7, f64::INFINITY), (50, 0.02), (2000, 1e9)] {
                    let counts = |number: u32| !number.is_multiple_of(4);
                    let measure = |number, squared| counts(number).then_some(squared);
                    tree.nearest(place, wanted, most, measure, &mut found);
                    let near = |i| Near { squared: points[i as usize].distance_squared(place), number: i };
                    let mut all: Vec<Near> = (0..count).filter(|&i| counts(i)).map(near).collect();
                    all.retain(|near| near.squared < most);
                    all.sort_unstable();
                    all.truncate(wanted);
                    assert_eq!(found, all);
                }
            }
        }
    }
}
