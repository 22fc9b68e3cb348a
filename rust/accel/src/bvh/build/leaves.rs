//! The leaf criterion of builders.

/// When a top-down builder makes a leaf, by the surface area heuristic (Goldsmith and Salmon 1987).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaves {
    /// Sets of up to this many primitives are not split, at least 1.
    pub whole: usize,
    /// Larger sets than this are always split, from `whole` to [`Leaves::MAX`]. In between, a leaf is made if no split
    /// lowers the cost.
    pub most: usize,
    /// Primitives per SIMD test, from 1 to [`Leaves::MAX_BLOCK`].
    pub block: usize,
    /// Cost of a traversal step.
    pub traversal_cost: f32,
    /// Cost of testing a block of primitives.
    pub intersection_cost: f32,
}

impl Leaves {
    /// Maximum number of primitives in a leaf.
    pub const MAX: usize = 1024;

    /// Maximum number of primitives in a block.
    pub const MAX_BLOCK: usize = 16;

    /// For trees that will be collapsed to leaves of blocks: split down to a few primitives, without a cost model. The
    /// collapse decides better which primitives share a block, since it knows the cost of wide nodes. Up to three
    /// eighths of a block are not split, since such splits hardly matter.
    pub const fn for_blocks(block: usize) -> Self {
        let whole = (3 * block).div_ceil(8);
        Self { whole, most: whole, block, traversal_cost: 1.0, intersection_cost: 1.0 }
    }

    /// For trees traversed as they are, one primitive after another: leaves of at most `most`, where that is cheaper.
    pub const fn by_cost(most: usize, traversal_cost: f32, intersection_cost: f32) -> Self {
        Self { whole: 1, most, block: 1, traversal_cost, intersection_cost }
    }

    /// # Panics
    /// If an option is out of range.
    pub(super) fn check(&self) {
        let Self { whole, most, block, .. } = *self;
        assert!((1..=Self::MAX_BLOCK).contains(&block), "block is {block}, not from 1 to {}", Self::MAX_BLOCK);
        assert!(1 <= whole && whole <= most && most <= Self::MAX, "leaves from {whole} to {most}");
    }

    /// Return whether a set becomes a leaf rather than two sets, each given by its number of primitives and half its
    /// surface area.
    #[inline(always)]
    pub(super) fn is_leaf(&self, whole: (usize, f32), [left, right]: [(usize, f32); 2]) -> bool {
        if whole.0 > self.most {
            return false;
        }
        let leaf = |(count, area): (usize, f32)| self.intersection_cost * area * count.div_ceil(self.block) as f32;
        leaf(whole) <= self.traversal_cost * whole.1 + leaf(left) + leaf(right)
    }
}
