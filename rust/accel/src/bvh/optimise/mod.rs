//! Optimizers of binary trees, which improve on the local decisions of builders. They treat leaves as opaque, so they
//! work on the tree of any builder.

mod linked_tree;
pub mod reinsertion;
pub mod treelet;

/// An optimizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimiser {
    /// Moves subtrees to cheaper places: [`reinsertion`].
    Reinsertion,
    /// Restructures treelets: [`treelet`].
    Treelet,
}

impl Optimiser {
    /// Its display name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reinsertion => "reinsertion",
            Self::Treelet => "treelets",
        }
    }
}

/// A sequence of optimizers, each at most once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Optimisers([Option<Optimiser>; 2]);

impl Optimisers {
    /// No optimizers.
    pub const NONE: Self = Self([None; 2]);

    /// Reinsertion alone.
    pub const REINSERTION: Self = Self([Some(Optimiser::Reinsertion), None]);

    /// A sequence of optimizers; None if one is repeated.
    pub fn new(some: impl IntoIterator<Item = Optimiser>) -> Option<Self> {
        let mut all = Self::NONE;
        for optimiser in some {
            if all.0.contains(&Some(optimiser)) {
                return None;
            }
            // There are as many slots as kinds.
            let place = all.0.iter().position(Option::is_none)?;
            all.0[place] = Some(optimiser);
        }
        Some(all)
    }

    /// The optimizers in order.
    pub fn iter(self) -> impl Iterator<Item = Optimiser> {
        self.0.into_iter().flatten()
    }
}
