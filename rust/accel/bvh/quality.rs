//! How a tree is made, step by step, and how much time that may take for the sake of the rays.

use super::BinaryBvh;
use super::build::{Builder, Leaves};
use super::optimise::{Optimiser, Optimisers, reinsertion, treelet};
use crate::math::Aabb;

/// A choice between a tree soon and a tree that rays walk fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// For few rays, or for geometry that changes all the time.
    FastBuild,
    /// For most scenes: what is long and thin is looked after, and a mesh of even triangles costs no more than that takes to
    /// be seen.
    #[default]
    Balanced,
    /// For many rays on one scene.
    FastRays,
}

impl Quality {
    /// All of them, from least to most time.
    pub const ALL: [Self; 3] = [Self::FastBuild, Self::Balanced, Self::FastRays];

    /// Bins an axis that suit it.
    pub const fn bins(self) -> usize {
        match self {
            Self::FastBuild => 8,
            Self::Balanced => 16,
            Self::FastRays => 32,
        }
    }

    /// How to build for leaves of blocks of so many triangles.
    pub const fn steps(self, block: usize) -> Steps {
        // Where time is short nothing is improved, unless that is asked for.
        let (optimisers, rounds, share, worthwhile) = match self {
            Self::FastBuild => (Optimisers::NONE, 6, 0.1, 2e-3),
            Self::Balanced => (Optimisers::REINSERTION, 6, 0.1, 2e-3),
            Self::FastRays => (Optimisers::REINSERTION, 30, 0.3, 1e-4),
        };
        Steps {
            builder: Builder::Binned { bins: Some(self.bins()) },
            leaves: Leaves::for_blocks(block),
            optimisers,
            reinsertion: reinsertion::Options { rounds, share, worthwhile, block },
            treelet: treelet::Options { rounds: 3, worthwhile, block },
        }
    }
}

/// What is done one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// How the tree is built.
    pub builder: Builder,
    /// When a builder makes a leaf.
    pub leaves: Leaves,
    /// What improves it then.
    pub optimisers: Optimisers,
    /// How much is reinserted, if anything is.
    pub reinsertion: reinsertion::Options,
    /// How many treelets are tried, if any are.
    pub treelet: treelet::Options,
}

impl Steps {
    /// Makes a tree over boxes, leaving out empty ones. `clip` is as [`Builder::build`] says.
    ///
    /// # Panics
    /// If an option is out of range.
    pub fn build(&self, boxes: &[Aabb], clip: impl Fn(u32, &Aabb) -> Aabb + Sync) -> BinaryBvh {
        let mut bvh = self.builder.build(boxes, clip, &self.leaves);
        for optimiser in self.optimisers.iter() {
            match optimiser {
                Optimiser::Reinsertion => reinsertion::optimise(&mut bvh, &self.reinsertion),
                Optimiser::Treelet => treelet::optimise(&mut bvh, &self.treelet),
            }
        }
        bvh
    }

    /// What they are, for people.
    pub fn name(&self) -> String {
        let names = self.optimisers.iter().map(Optimiser::name);
        [self.builder.name()].into_iter().chain(names).collect::<Vec<_>>().join(" and ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::sampling::philox4x32;

    #[test]
    fn more_time_makes_trees_of_less_area() {
        // A jumble of sticks.
        let boxes: Vec<_> = (0..20_000)
            .map(|i| {
                let [x, y, z, which] = philox4x32([i, 0, 0, 0], [0, 0]).map(|bits| bits as f32 / 2f32.powi(32));
                let mut size = Vec3::splat(0.002);
                size[(which * 3.0) as usize] = 0.2 * which.fract();
                Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + size }
            })
            .collect();
        let costs = Quality::ALL.map(|quality| {
            let bvh = quality.steps(8).build(&boxes, |p, to| boxes[p as usize].intersection(*to));
            bvh.validate(&boxes).unwrap();
            bvh.nodes.iter().filter(|n| !n.is_leaf()).map(|n| f64::from(n.aabb().half_area())).sum::<f64>()
        });
        assert!(costs[1] < costs[0] && costs[2] < costs[1], "{costs:?}");
    }
}
