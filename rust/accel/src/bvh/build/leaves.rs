//! When a builder makes a leaf.

/// When a builder that goes from the top down makes a leaf, by the surface-area heuristic (Goldsmith and Salmon 1987).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaves {
    /// Up to so many primitives are not split, at least 1.
    pub whole: usize,
    /// More than so many always are, from `whole` to [`Leaves::MAX`]. In between, a leaf is made where no split lowers
    /// the cost.
    pub most: usize,
    /// So many primitives are tested at once, from 1 to [`Leaves::MAX_BLOCK`].
    pub block: usize,
    /// Cost of a step down.
    pub traversal_cost: f32,
    /// Cost of a test of a block of primitives.
    pub intersection_cost: f32,
}

impl Leaves {
    /// Most primitives in a leaf that may be asked for.
    pub const MAX: usize = 1024;

    /// Most primitives in a block that may be asked for.
    pub const MAX_BLOCK: usize = 16;

    /// For trees that are collapsed to ones with leaves of blocks of so many: down to a few primitives, without
    /// weighing costs. What shares a block is decided better then, where the cost of the wide nodes is known. Three
    /// eighths of a block are not split at all, since how they are hardly matters.
    pub const fn for_blocks(block: usize) -> Self {
        let whole = (3 * block).div_ceil(8);
        Self { whole, most: whole, block, traversal_cost: 1.0, intersection_cost: 1.0 }
    }

    /// For trees that are walked as they are, one primitive after the other: leaves of at most `most`, where they cost
    /// less.
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

    /// Whether a set becomes a leaf rather than two: how many primitives it has and half the surface around them, and
    /// the same of the two.
    #[inline(always)]
    pub(super) fn is_leaf(&self, whole: (usize, f32), [left, right]: [(usize, f32); 2]) -> bool {
        if whole.0 > self.most {
            return false;
        }
        let leaf = |(count, area): (usize, f32)| self.intersection_cost * area * count.div_ceil(self.block) as f32;
        leaf(whole) <= self.traversal_cost * whole.1 + leaf(left) + leaf(right)
    }
}
