//! A bounding volume hierarchy in f64 for overlap and nearest-first queries.

use raywright_base::math::DVec3;
use raywright_shapes::Bounds;

/// Maximum number of boxes in a leaf.
const LEAF: usize = 4;

/// Numbered boxes, split at the median along the axis of largest extent. Unbounded boxes are kept beside the tree,
/// since no query can exclude them.
#[derive(Clone, Debug, Default)]
pub struct BoxTree {
    nodes: Vec<Node>,
    /// The numbers of the boxes in the leaves.
    order: Vec<u32>,
    endless: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// Of a leaf, its first entry in `order`. Of an inner node, which has a count of 0, the first child; the second one
    /// follows it.
    first: u32,
    count: u32,
}

impl BoxTree {
    /// Build the tree of numbered boxes.
    pub fn new(boxes: impl Iterator<Item = (u32, Bounds)>) -> Self {
        let (mut finite, mut tree) = (Vec::new(), Self::default());
        for (number, bounds) in boxes {
            if bounds.is_finite() {
                finite.push((number, bounds));
            } else {
                tree.endless.push(number);
            }
        }
        if !finite.is_empty() {
            tree.nodes.push(Node { bounds: around(&finite), first: 0, count: 0 });
            tree.split(0, &mut finite);
        }
        tree
    }

    fn split(&mut self, node: usize, boxes: &mut [(u32, Bounds)]) {
        if boxes.len() <= LEAF {
            (self.nodes[node].first, self.nodes[node].count) = (self.order.len() as u32, boxes.len() as u32);
            self.order.extend(boxes.iter().map(|&(number, _)| number));
            return;
        }
        // Halved, since sums may overflow.
        let middle = |bounds: &Bounds, axis: usize| 0.5 * bounds.min[axis] + 0.5 * bounds.max[axis];
        let spread = |axis: usize| {
            let ends = boxes.iter().map(|(_, b)| middle(b, axis));
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            high - low
        };
        let spreads = [0, 1, 2].map(spread);
        let axis = (0..3).fold(0, |best, k| if spreads[k] > spreads[best] { k } else { best });
        let half = boxes.len() / 2;
        // The number breaks ties, so that the tree does not depend on the order of the input.
        boxes
            .select_nth_unstable_by(half, |a, b| middle(&a.1, axis).total_cmp(&middle(&b.1, axis)).then(a.0.cmp(&b.0)));
        let (low, high) = boxes.split_at_mut(half);
        let first = self.nodes.len();
        for part in [&*low, &*high] {
            self.nodes.push(Node { bounds: around(part), first: 0, count: 0 });
        }
        self.nodes[node].first = first as u32;
        self.split(first, low);
        self.split(first + 1, high);
    }

    /// Visit the number of each box that satisfies `is_met`, all unbounded ones, and possibly some others.
    pub fn visit(&self, is_met: impl Fn(&Bounds) -> bool, mut visit: impl FnMut(u32)) {
        self.endless.iter().for_each(|&number| visit(number));
        let mut open = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(node) = open.pop() {
            let Node { bounds, first, count } = self.nodes[node];
            if !is_met(&bounds) {
                continue;
            }
            if count == 0 {
                open.extend([first as usize + 1, first as usize]);
            } else {
                self.order[first as usize..(first + count) as usize].iter().for_each(|&number| visit(number));
            }
        }
    }

    /// Return whether any number in boxes that satisfy `is_met`, or of an unbounded box, satisfies `holds`.
    pub fn any(&self, is_met: impl Fn(&Bounds) -> bool, holds: impl Fn(u32) -> bool) -> bool {
        fn within(
            tree: &BoxTree,
            node: usize,
            is_met: &impl Fn(&Bounds) -> bool,
            holds: &impl Fn(u32) -> bool,
        ) -> bool {
            let Node { bounds, first, count } = tree.nodes[node];
            let first = first as usize;
            is_met(&bounds)
                && if count == 0 {
                    within(tree, first, is_met, holds) || within(tree, first + 1, is_met, holds)
                } else {
                    tree.order[first..first + count as usize].iter().any(|&number| holds(number))
                }
        }
        self.endless.iter().any(|&number| holds(number)) || !self.nodes.is_empty() && within(self, 0, &is_met, &holds)
    }

    /// Visit boxes nearest first. `gap` is a lower bound on the distance to a box's content. `visit` is given a number
    /// and the current maximum distance, and returns the new one.
    pub fn nearest(&self, most: f64, gap: impl Fn(&Bounds) -> f64, mut visit: impl FnMut(u32, f64) -> f64) {
        /// Allowance for the roundings of gaps and distances.
        const ROOM: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;
        let mut most = most;
        for &number in &self.endless {
            most = visit(number, most);
        }
        let mut waiting: Vec<(f64, u32)> = self.nodes.first().map(|root| (gap(&root.bounds), 0)).into_iter().collect();
        while let Some((near, number)) = waiting.pop() {
            if near > most * ROOM {
                continue;
            }
            let node = &self.nodes[number as usize];
            if node.count > 0 {
                for &item in &self.order[node.first as usize..][..node.count as usize] {
                    most = visit(item, most);
                }
                continue;
            }
            let children = [node.first, node.first + 1].map(|child| (gap(&self.nodes[child as usize].bounds), child));
            let [a, b] = children;
            waiting.extend(if a.0 <= b.0 { [b, a] } else { [a, b] });
        }
    }

    /// Memory use in bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + (self.order.capacity() + self.endless.capacity()) * size_of::<u32>()
    }
}

/// The union of boxes.
fn around(boxes: &[(u32, Bounds)]) -> Bounds {
    let none = Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
    boxes.iter().fold(none, |all, (_, b)| Bounds { min: all.min.min(b.min), max: all.max.max(b.max) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    fn place(i: u32) -> DVec3 {
        let [x, y] = Sampler::new(5, i, 0).two(0);
        DVec3::new(x, y, Sampler::new(5, i, 1).one(0)) * 10.0
    }

    #[test]
    fn the_nearest_of_many_is_found_and_few_are_looked_at() {
        // Also a thousand boxes at one place, and one unbounded box.
        for same in [false, true] {
            let at = |i: u32| if same { DVec3::ONE } else { place(i) };
            let boxes = (0..1000).map(|i| (i, Bounds { min: at(i), max: at(i) + 0.01 }));
            let endless = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
            let tree = BoxTree::new(boxes.chain([(1000, endless)]));
            let mut visited = 0;
            for i in 0..200 {
                let from = place(10_000 + i);
                let away = |b: &Bounds| (b.min - from).max(from - b.max).max(DVec3::ZERO).length();
                let own = |n: u32| if n < 1000 { away(&Bounds { min: at(n), max: at(n) + 0.01 }) } else { 1e9 };
                let mut best = (f64::INFINITY, u32::MAX);
                tree.nearest(f64::INFINITY, away, |n, most| {
                    visited += 1;
                    if (own(n), n) < best {
                        best = (own(n), n);
                    }
                    most.min(best.0)
                });
                let least =
                    (0..1001).map(|n| (own(n), n)).fold((f64::INFINITY, u32::MAX), |a, b| if b < a { b } else { a });
                assert_eq!(best, least);
            }
            assert!(same || visited < 200 * 60, "{visited}");
        }
        BoxTree::new(std::iter::empty()).nearest(1.0, |_| 0.0, |_, _| unreachable!());
    }

    #[test]
    fn any_of_the_boxes_around_a_point_is_found() {
        let size = |i: u32| place(i + 50_000) * 0.2;
        let boxes: Vec<_> = (0..300).map(|i| Bounds { min: place(i), max: place(i) + size(i) }).collect();
        let tree = BoxTree::new((0..).zip(boxes.iter().copied()));
        let mut inside = 0;
        for i in 0..2000 {
            let point = place(10_000 + i);
            let is_in = |b: &Bounds| point.cmpge(b.min).all() && point.cmple(b.max).all();
            let found = tree.any(is_in, |number| is_in(&boxes[number as usize]));
            assert_eq!(found, boxes.iter().any(is_in));
            inside += u32::from(found);
        }
        assert!((200..1800).contains(&inside), "{inside}");
        assert!(!BoxTree::new(std::iter::empty()).any(|_| true, |_| true));
        let endless = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        assert!(BoxTree::new([(3, endless)].into_iter()).any(|_| false, |number| number == 3));
    }
}
