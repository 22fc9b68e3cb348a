//! Nodes of a wide tree: the boxes of the children by axis and side, so that each plane of all children is one vector.
//!
//! Quantized planes of one byte (Ylitie, Karras and Laine 2017) halve the size of a node, but nodes are only a fifth of
//! a tree. On 69 k to 832 k triangles incoherent rays took a tenth longer, because of decoding. On flat walls, where
//! rays start inside coarse boxes, they took two fifths longer. Planes of two bytes gain nothing.

use crate::NodeBox;
use raywright_base::math::{Aabb, Vec3};
use std::array::from_fn;

/// The boxes and references of up to `N` children. Children fill the lanes from the first: nodes, then leaves, each by
/// decreasing box.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct WideNode<const N: usize> {
    /// By axis and side (lower, upper). A missing child has an empty box, from ∞ to −∞, which no ray hits.
    pub planes: [[[f32; N]; 2]; 3],
    /// The bits of [`Packed`] children.
    pub children: [u32; N],
    /// The visiting orders by the ray's octant; see [`WideNode::order`].
    orders: [u32; N],
}

const _: () = assert!(size_of::<WideNode<4>>() == 128 && size_of::<WideNode<8>>() == 256);

/// A child of a node, unpacked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Child {
    /// No child.
    None,
    /// Another node.
    Node(u32),
    /// A leaf.
    Leaf {
        /// Its first triangle, in the order of the leaves.
        first: u32,
        /// The number of triangles, from 1 to 8.
        count: u32,
    },
}

/// A child in 32 bits: nodes have a clear top bit; leaves have 28 bits for their first triangle and 3 for count − 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packed(u32);

impl Packed {
    /// The root.
    pub const ROOT: Self = Self(0);
    /// No child.
    pub const NONE: Self = Self(u32::MAX);
    const LEAF: u32 = 1 << 31;

    /// Packs a child.
    pub fn new(child: Child) -> Self {
        match child {
            Child::None => Self::NONE,
            Child::Node(index) => {
                assert!(index < Self::LEAF, "fewer than 2^31 nodes");
                Self(index)
            }
            Child::Leaf { first, count } => {
                assert!(first < (1 << 28) - 1, "fewer than 2^28 triangles");
                assert!((1..=8).contains(&count));
                Self(Self::LEAF | first << 3 | (count - 1))
            }
        }
    }

    /// From the bits in [`WideNode::children`].
    #[inline(always)]
    pub fn of(bits: u32) -> Self {
        Self(bits)
    }

    /// The bits in [`WideNode::children`].
    #[inline(always)]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// 0 for a node, 1 for a leaf, 2 for no child.
    #[inline(always)]
    pub fn kind(self) -> usize {
        (self.0 >> 31) as usize + usize::from(self == Self::NONE)
    }

    /// 0 for a node, 1 for a leaf or no child.
    #[inline(always)]
    pub fn is_leaf(self) -> usize {
        (self.0 >> 31) as usize
    }

    /// The node's index.
    #[inline(always)]
    pub fn node(self) -> usize {
        self.0 as usize
    }

    /// The first triangle and the count of a leaf.
    #[inline(always)]
    pub fn leaf(self) -> (usize, u32) {
        ((self.0 >> 3 & ((1 << 28) - 1)) as usize, (self.0 & 7) + 1)
    }

    /// Unpack it.
    pub fn child(self) -> Child {
        match self.kind() {
            0 => Child::Node(self.0),
            1 => {
                let (first, count) = self.leaf();
                Child::Leaf { first: first as u32, count }
            }
            _ => Child::None,
        }
    }
}

impl<const N: usize> WideNode<N> {
    /// Create a node with at most `N` children, given with their boxes.
    pub fn new(children: &[(Aabb, Child)]) -> Self {
        // Occlusion rays visit leaves first, which may end them at once, and the smallest of each kind; their stack is
        // popped from the end. By area alone they take up to a sixth longer.
        let mut sorted = [(Aabb::EMPTY, Child::None); N];
        sorted[..children.len()].copy_from_slice(children);
        let children = &mut sorted[..children.len()];
        let is_leaf = |child: &Child| matches!(child, Child::Leaf { .. });
        children.sort_by(|(a, of_a), (b, of_b)| {
            is_leaf(of_a).cmp(&is_leaf(of_b)).then(b.half_area().total_cmp(&a.half_area()))
        });
        let plane = |axis: usize, side: usize, lane: usize| {
            let bounds = children.get(lane).map_or(Aabb::EMPTY, |c| c.0);
            if side == 0 { bounds.min[axis] } else { bounds.max[axis] }
        };
        let mut node = Self {
            planes: from_fn(|axis| from_fn(|side| from_fn(|lane| plane(axis, side, lane)))),
            children: from_fn(|lane| Packed::new(children.get(lane).map_or(Child::None, |c| c.1)).bits()),
            orders: [0; N],
        };
        node.sort(children.len());
        node
    }

    /// The number of children.
    pub fn count(&self) -> usize {
        self.children.iter().take_while(|&&child| child != Packed::NONE.bits()).count()
    }

    /// Move the children to new lanes: lane i gets the child of `lanes[i]`.
    pub fn permute(&mut self, lanes: &[u8]) {
        let before = self.clone();
        for (to, &from) in lanes.iter().enumerate() {
            let from = usize::from(from);
            for (axis, planes) in self.planes.iter_mut().enumerate() {
                for (side, plane) in planes.iter_mut().enumerate() {
                    plane[to] = before.planes[axis][side][from];
                }
            }
            self.children[to] = before.children[from];
        }
        // The same visiting orders, in terms of the new lanes.
        let mut now: [usize; N] = from_fn(|lane| lane);
        for (to, &from) in lanes.iter().enumerate() {
            now[usize::from(from)] = to;
        }
        self.orders = [0; N];
        for octant in 0..8 {
            let order = before.order(octant);
            let lane = |i: usize| now[(order >> (3 * i)) as usize & (N - 1)] as u32;
            let order = (0..N).fold(0, |bits, i| bits | lane(i) << (3 * i));
            self.orders[octant % N] |= order << (16 * (octant / N) as u32);
        }
    }

    /// Compute the visiting order for each octant, by the boxes' centers along the octant's diagonal.
    fn sort(&mut self, count: usize) {
        for octant in 0..8 {
            let middle = |lane: usize| -> f32 {
                (0..3)
                    .map(|axis| {
                        let twice = self.planes[axis][0][lane] + self.planes[axis][1][lane];
                        if octant >> axis & 1 == 0 { twice } else { -twice }
                    })
                    .sum()
            };
            let mut lanes: [usize; N] = from_fn(|lane| lane);
            lanes[..count].sort_by(|&a, &b| middle(b).total_cmp(&middle(a)));
            let order = lanes.iter().enumerate().fold(0, |bits, (i, &lane)| bits | (lane as u32) << (3 * i));
            self.orders[octant % N] |= order << (16 * (octant / N) as u32);
        }
    }

    /// The lanes from the farthest to the nearest for rays of an octant (bit i is set if the direction is negative
    /// along axis i), three bits each from the lowest. Empty lanes follow.
    #[inline(always)]
    pub fn order(&self, octant: usize) -> u32 {
        self.orders[octant & (N - 1)] >> (16 * ((octant & 7) / N))
    }

    /// The child in a lane.
    pub fn child(&self, lane: usize) -> Child {
        Packed::of(self.children[lane]).child()
    }

    /// The children with their boxes.
    pub fn children(&self) -> impl Iterator<Item = (Aabb, Child)> {
        (0..N).map(|lane| (self.aabb(lane), self.child(lane))).take_while(|(_, child)| *child != Child::None)
    }

    /// The box in a lane, possibly empty.
    pub fn aabb(&self, lane: usize) -> Aabb {
        let corner = |side: usize| Vec3::from_array(from_fn(|axis| self.planes[axis][side][lane]));
        Aabb { min: corner(0), max: corner(1) }
    }

    /// The bounding box of all children.
    pub fn bounds(&self) -> Aabb {
        self.children().fold(Aabb::EMPTY, |b, (child, _)| b.union(child))
    }
}

/// The boxes of all nodes of a tree, root first, and of its leaves.
pub fn boxes<const N: usize>(nodes: &[WideNode<N>], primitives: impl Fn(u32, u32) -> usize) -> Vec<NodeBox> {
    let mut all = Vec::with_capacity(nodes.len());
    let root = nodes.first().map(|root| (root.bounds(), Child::Node(0), 0));
    let mut open: Vec<_> = root.into_iter().collect();
    while let Some((aabb, child, depth)) = open.pop() {
        let primitives = match child {
            Child::None => continue,
            Child::Node(index) => {
                open.extend(nodes[index as usize].children().map(|(aabb, child)| (aabb, child, depth + 1)));
                None
            }
            Child::Leaf { first, count } => Some(primitives(first, count)),
        };
        all.push(NodeBox { aabb, depth, primitives });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn children_unpack_as_they_were_packed() {
        for child in [
            Child::None,
            Child::Node(0),
            Child::Node((1 << 31) - 1),
            Child::Leaf { first: 0, count: 1 },
            Child::Leaf { first: (1 << 28) - 2, count: 8 },
        ] {
            assert_eq!(Packed::new(child).child(), child);
            let kind = Packed::new(child).kind();
            assert_eq!(
                kind,
                match child {
                    Child::Node(_) => 0,
                    Child::Leaf { .. } => 1,
                    Child::None => 2,
                }
            );
        }
    }

    #[test]
    fn leaves_come_last_and_the_smallest_of_each_kind() {
        let cube = |size: f32| Aabb { min: Vec3::ZERO, max: Vec3::splat(size) };
        let leaf = |first: u32| Child::Leaf { first, count: 1 };
        let children = [
            (cube(1.0), leaf(0)),
            (cube(0.5), Child::Node(1)),
            (cube(4.0), leaf(1)),
            (cube(2.0), Child::Node(2)),
            (cube(3.0), leaf(2)),
        ];
        let node = WideNode::<8>::new(&children);
        let order: Vec<_> = node.children().map(|(_, child)| child).collect();
        assert_eq!(order, [Child::Node(2), Child::Node(1), leaf(1), leaf(2), leaf(0)]);
    }

    #[test]
    fn children_that_change_places_are_still_visited_in_the_same_order() {
        let cube = |at: f32| Aabb { min: Vec3::splat(at), max: Vec3::new(at + 1.0, 1.0 - at, at * at) };
        let children: Vec<_> = (0..6).map(|i| (cube(i as f32), Child::Node(i))).collect();
        fn of<const N: usize>(children: &[(Aabb, Child)], lanes: &[u8]) {
            let before = WideNode::<N>::new(children);
            let mut after = before.clone();
            after.permute(lanes);
            for (to, &from) in lanes.iter().enumerate() {
                let from = usize::from(from);
                assert_eq!((after.child(to), after.aabb(to)), (before.child(from), before.aabb(from)));
            }
            for octant in 0..8 {
                let visited = |node: &WideNode<N>| -> Vec<_> {
                    (0..N).map(|i| node.child((node.order(octant) >> (3 * i)) as usize & (N - 1))).collect()
                };
                assert_eq!(visited(&after), visited(&before));
            }
        }
        of::<8>(&children, &[5, 3, 0, 1, 4, 2]);
        of::<4>(&children[..4], &[2, 0, 3, 1]);
        of::<4>(&children[..3], &[2, 0, 1]);
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        (-2f32..2.0, 0i32..40).prop_map(|(x, e)| x * 2f32.powi(-e))
    }

    proptest! {
        #[test]
        fn children_keep_their_boxes_and_are_visited_by_octant(
            corners in prop::collection::vec(
                (prop::array::uniform3(coordinate()), prop::array::uniform3(coordinate())), 1..=8,
            )
        ) {
            let children: Vec<_> = corners
                .iter()
                .enumerate()
                .map(|(i, (a, b))| (Aabb::around([Vec3::from_array(*a), Vec3::from_array(*b)]), Child::Node(i as u32)))
                .collect();
            let node = WideNode::<8>::new(&children);
            prop_assert_eq!(node.children().count(), children.len());
            for (bounds, child) in node.children() {
                let Child::Node(i) = child else { panic!("{child:?}") };
                let given = children[i as usize].0;
                prop_assert_eq!(bounds, given);
            }
            for octant in 0..8 {
                let towards = Vec3::from_array(from_fn(|axis| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 }));
                let lanes: Vec<_> = (0..8).map(|i| node.order(octant) >> (3 * i) & 7).collect();
                let middles: Vec<_> = lanes[..children.len()]
                    .iter()
                    .map(|&lane| { let b = node.aabb(lane as usize); (b.min + b.max).dot(towards) })
                    .collect();
                prop_assert!(middles.windows(2).all(|w| w[0] >= w[1] - 1e-4), "{:?}", middles);
                let mut sorted = lanes.clone();
                sorted.sort_unstable();
                prop_assert_eq!(sorted, (0..8).collect::<Vec<_>>());
            }
        }
    }
}
