//! Optimisers of the binary tree: what a builder, which looks at one node at a time, has left to gain. To them leaves
//! are opaque, so the tree of any builder will do.

pub mod reinsertion;
mod tree;
pub mod treelet;

/// What improves a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimiser {
    /// Moving subtrees to where they cost less: [`reinsertion`].
    Reinsertion,
    /// Putting treelets together anew: [`treelet`].
    Treelet,
}

impl Optimiser {
    /// Its name, for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reinsertion => "reinsertion",
            Self::Treelet => "treelets",
        }
    }
}

/// Optimisers one after the other, each at most once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Optimisers([Option<Optimiser>; 2]);

impl Optimisers {
    /// None at all.
    pub const NONE: Self = Self([None; 2]);

    /// Reinsertion alone.
    pub const REINSERTION: Self = Self([Some(Optimiser::Reinsertion), None]);

    /// Some in turn; none of them if one is named twice.
    pub fn new(some: impl IntoIterator<Item = Optimiser>) -> Option<Self> {
        let mut all = Self::NONE;
        for optimiser in some {
            if all.0.contains(&Some(optimiser)) {
                return None;
            }
            // As many places as there are kinds.
            let place = all.0.iter().position(Option::is_none)?;
            all.0[place] = Some(optimiser);
        }
        Some(all)
    }

    /// Each in turn.
    pub fn iter(self) -> impl Iterator<Item = Optimiser> {
        self.0.into_iter().flatten()
    }
}
