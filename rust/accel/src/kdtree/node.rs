//! The 8-byte kd-tree node.

/// A splitting plane or a leaf. It has no box: its cell follows from the planes above it.
///
/// The lowest two bits of `bits` are the axis, or 3 for a leaf. The others are the index of the first child of an inner
/// node, or the number of primitives in a leaf. The two children are adjacent, the lower one first. `word` is the
/// plane's position as the bits of an f32, or the leaf's index. (After Pharr, Jakob and Humphreys, "Physically Based
/// Rendering", where one child needs no index. Adjacent children share a cache line and are selected without a branch.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Node {
    word: u32,
    bits: u32,
}

const _: () = assert!(size_of::<Node>() == 8);

/// The axis value of leaves.
const LEAF: u32 = 3;

/// Limit of child indices and of primitives in a leaf.
const MOST: usize = 1 << 30;

impl Node {
    /// An empty leaf, which has no index.
    pub const EMPTY: Self = Self { word: u32::MAX, bits: LEAF };

    /// An axis-aligned splitting plane with two children, starting at `children`.
    ///
    /// # Panics
    ///
    /// If there are too many nodes.
    pub fn inner(axis: usize, plane: f32, children: usize) -> Self {
        assert!(axis < 3 && children < MOST, "a kd-tree has fewer than {MOST} nodes, got {children}");
        Self { word: plane.to_bits(), bits: (children as u32) << 2 | axis as u32 }
    }

    /// A leaf with the given number of primitives.
    ///
    /// # Panics
    ///
    /// If there are too many primitives.
    pub fn leaf(number: u32, count: usize) -> Self {
        assert!(count < MOST, "a leaf of a kd-tree has fewer than {MOST} primitives, got {count}");
        Self { word: number, bits: (count as u32) << 2 | LEAF }
    }

    /// Return whether it is a leaf.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.bits & LEAF == LEAF
    }

    /// The number of primitives of a leaf.
    #[inline(always)]
    pub fn count(self) -> u32 {
        self.bits >> 2
    }

    /// The index of a nonempty leaf.
    #[inline(always)]
    pub fn number(self) -> u32 {
        self.word
    }

    /// The axis of an inner node; 3 for a leaf.
    #[inline(always)]
    pub fn axis(self) -> usize {
        (self.bits & LEAF) as usize
    }

    /// The position of an inner node's plane.
    #[inline(always)]
    pub fn plane(self) -> f32 {
        f32::from_bits(self.word)
    }

    /// The lower child of an inner node; the upper one follows it.
    #[inline(always)]
    pub fn children(self) -> u32 {
        self.bits >> 2
    }

    /// The same node after shifting all node and leaf indices.
    pub fn moved(self, nodes: usize, leaves: usize) -> Self {
        if !self.is_leaf() {
            Self::inner(self.axis(), self.plane(), self.children() as usize + nodes)
        } else if self.count() == 0 {
            self
        } else {
            Self { word: self.word + leaves as u32, ..self }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_goes_in_comes_out(
            axis in 0usize..3, plane in any::<f32>(), children in 0..MOST, number in 0..1u32 << 31, count in 1..MOST,
        ) {
            let inner = Node::inner(axis, plane, children);
            prop_assert!(!inner.is_leaf());
            prop_assert_eq!((inner.axis(), inner.plane().to_bits()), (axis, plane.to_bits()));
            prop_assert_eq!(inner.children(), children as u32);
            let leaf = Node::leaf(number, count);
            prop_assert!(leaf.is_leaf());
            prop_assert_eq!((leaf.number(), leaf.count()), (number, count as u32));
            prop_assert_eq!(leaf.moved(5, 7), Node::leaf(number + 7, count));
        }
    }

    #[test]
    fn a_leaf_with_nothing_in_it_stays_what_it_is() {
        assert!(Node::EMPTY.is_leaf() && Node::EMPTY.count() == 0);
        assert_eq!(Node::EMPTY.moved(2, 3), Node::EMPTY);
    }
}
