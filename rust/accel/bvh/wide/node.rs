//! A node of a wide tree: the boxes of its children by axis and side, so that each is one vector.

use crate::math::{Aabb, Vec3};
use std::array::from_fn;

/// Boxes of `N` children, and what they are.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct WideNode<const N: usize> {
    /// By axis and side (lower, upper). A missing child has an empty box: from ∞ to −∞.
    pub bounds: [[[f32; N]; 2]; 3],
    children: [u32; N],
}

const _: () = assert!(size_of::<WideNode<4>>() == 128 && size_of::<WideNode<8>>() == 256);

/// What stands below a node, unpacked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Child {
    /// Nothing.
    None,
    /// Another node.
    Node(u32),
    /// A block of triangles with the number of its lanes in use.
    Block {
        /// Which block.
        index: u32,
        /// From 1 to 8.
        count: u32,
    },
}

/// A child in 32 bits: nodes have a clear top bit, blocks 28 bits of index and 3 of count − 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packed(u32);

impl Packed {
    /// The root.
    pub const ROOT: Self = Self(0);
    const BLOCK: u32 = 1 << 31;
    const NONE: u32 = u32::MAX;

    /// The node's index, or none for a block.
    #[inline(always)]
    pub fn node(self) -> Option<usize> {
        (self.0 & Self::BLOCK == 0).then_some(self.0 as usize)
    }

    /// Of a block, its index and count.
    #[inline(always)]
    pub fn block(self) -> (usize, u32) {
        ((self.0 >> 3 & ((1 << 28) - 1)) as usize, (self.0 & 7) + 1)
    }
}

impl<const N: usize> WideNode<N> {
    /// A node with no children.
    pub const EMPTY: Self =
        Self { bounds: [[[f32::INFINITY; N], [f32::NEG_INFINITY; N]]; 3], children: [Packed::NONE; N] };

    /// Puts a child into a lane.
    pub fn set(&mut self, lane: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][0][lane] = bounds.min[axis];
            self.bounds[axis][1][lane] = bounds.max[axis];
        }
        self.children[lane] = match child {
            Child::None => Packed::NONE,
            Child::Node(index) => {
                assert!(index < Packed::BLOCK, "fewer than 2^31 nodes");
                index
            }
            Child::Block { index, count } => {
                assert!(index < 1 << 28, "fewer than 2^28 blocks of triangles");
                assert!((1..=N as u32).contains(&count));
                Packed::BLOCK | index << 3 | (count - 1)
            }
        };
    }

    /// What stands in a lane, packed.
    #[inline(always)]
    pub fn packed(&self, lane: usize) -> Packed {
        Packed(self.children[lane])
    }

    /// What stands in a lane.
    pub fn child(&self, lane: usize) -> Child {
        let packed = self.packed(lane);
        if packed.0 == Packed::NONE {
            return Child::None;
        }
        match packed.node() {
            Some(node) => Child::Node(node as u32),
            None => {
                let (index, count) = packed.block();
                Child::Block { index: index as u32, count }
            }
        }
    }

    /// The box in a lane.
    pub fn aabb(&self, lane: usize) -> Aabb {
        let side = |s: usize| Vec3::from_array(from_fn(|axis| self.bounds[axis][s][lane]));
        Aabb { min: side(0), max: side(1) }
    }

    /// The box around all children.
    pub fn bounds(&self) -> Aabb {
        (0..N).fold(Aabb::EMPTY, |b, lane| b.union(self.aabb(lane)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_unpack_as_they_were_packed() {
        let mut node = WideNode::<8>::EMPTY;
        assert_eq!(node.child(7), Child::None);
        assert!(node.bounds().is_empty());
        for child in [
            Child::Node(0),
            Child::Node((1 << 31) - 1),
            Child::Block { index: 0, count: 1 },
            Child::Block { index: (1 << 28) - 2, count: 8 },
        ] {
            node.set(3, &Aabb::around([Vec3::ONE]), child);
            assert_eq!(node.child(3), child);
        }
    }
}
