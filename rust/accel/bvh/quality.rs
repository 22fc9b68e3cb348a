//! How a tree is made, step by step, and how much time that may take for the sake of the rays.

use super::BinaryBvh;
use super::build::presplit::{self, Pieces};
use super::build::spatial::MAX_BUDGET;
use super::build::{Builder, Leaves};
use super::optimise::{Optimiser, Optimisers, reinsertion, treelet};
use crate::math::Aabb;
use crate::work::{Stopped, Work};
use std::borrow::Cow;

/// A choice between a tree soon and a tree that rays walk fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// For few rays, or for geometry that changes all the time.
    FastBuild,
    /// For most scenes: what is long and thin is taken care of, and a mesh of even triangles takes no more time than it
    /// takes to see that nothing in it is.
    #[default]
    Balanced,
    /// For many rays on one scene, which does not move: what straddles a plane may be parted by it.
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
        let builder = Builder::Binned { bins: Some(self.bins()) };
        let cuts = match self {
            Self::FastBuild => None,
            // A tree over pieces cannot be refitted, so a ray must meet less than half as many boxes. With more pieces
            // it would meet fewer still, but be slower for want of cache.
            Self::Balanced => Some(Cuts { options: presplit::Options { budget: 4.0, worthwhile: 0.5 }, builder }),
            Self::FastRays => Some(Cuts::and_splits(Some(self.bins()), MAX_BUDGET)),
        };
        Steps {
            cuts,
            builder,
            leaves: Leaves::for_blocks(block),
            optimisers,
            reinsertion: reinsertion::Options { rounds, share, worthwhile, block },
            treelet: treelet::Options { rounds: 3, worthwhile, block },
        }
    }
}

/// What is cut before a build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuts {
    /// How much.
    pub options: presplit::Options,
    /// How the tree is built then.
    pub builder: Builder,
}

impl Cuts {
    /// The same with so many bins.
    pub fn with_bins(self, bins: usize) -> Self {
        let builder = match self.builder {
            Builder::Binned { .. } => Builder::Binned { bins: Some(bins) },
            Builder::Spatial { budget, .. } => Builder::Spatial { bins: Some(bins), budget },
            other => other,
        };
        Self { builder, ..self }
    }

    /// Spatial splits, and the cuts that they need before. Together they add at most `budget` references for each
    /// primitive.
    pub const fn and_splits(bins: Option<usize>, budget: f32) -> Self {
        Self { options: presplit::Options { budget, worthwhile: 0.125 }, builder: Builder::Spatial { bins, budget } }
    }
}

/// What is done one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// What is cut before, where that is worthwhile.
    pub cuts: Option<Cuts>,
    /// How the tree is built where nothing is.
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
    /// Makes a tree over boxes none of which is cut, leaving out empty ones, and says how.
    pub fn whole(self, boxes: &[Aabb], work: Work) -> Result<(BinaryBvh, String), Stopped> {
        Self { cuts: None, ..self }.build(boxes, |p, to| boxes[p as usize].intersection(*to), work)
    }

    /// Makes a tree over boxes, leaving out empty ones, and tells how it was made, for people. `clip` is as
    /// [`Builder::build`] says.
    ///
    /// # Panics
    /// If an option is out of range.
    pub fn build<'a>(
        &self,
        boxes: impl Into<Cow<'a, [Aabb]>>,
        clip: impl Fn(u32, &Aabb) -> Aabb + Sync,
        work: Work,
    ) -> Result<(BinaryBvh, String), Stopped> {
        let boxes = boxes.into();
        let cutting = if self.cuts.is_some() { 4.0 } else { 0.0 };
        let improving = 2.0 * self.optimisers.iter().count() as f32;
        let [cut_first, grow, improve] = work.parts([cutting, 8.0, improving]);
        // What is not wanted any more is cut no further.
        let clip = |p: u32, to: &Aabb| if work.is_stopped() { Aabb::EMPTY } else { clip(p, to) };
        let cut = self.cuts.and_then(|cuts| Some((cuts.builder, Pieces::cut(&boxes, clip, &cuts.options)?)));
        cut_first.done();
        work.goes_on()?;
        let (mut bvh, mut name) = if let Some((builder, pieces)) = cut {
            let builder = builder.over_pieces(boxes.len(), pieces.boxes.len());
            drop(boxes);
            let clip_piece = |piece: u32, to: &Aabb| clip(pieces.primitives[piece as usize], to);
            let mut bvh = builder.build(&pieces.boxes, clip_piece, &self.leaves, grow)?;
            pieces.put_together(&mut bvh);
            (bvh, format!("{} of pieces", builder.name()))
        } else {
            (self.builder.build(boxes, clip, &self.leaves, grow)?, self.builder.name().into())
        };
        let second = self.optimisers.iter().skip(1).count() as f32;
        for (optimiser, work) in self.optimisers.iter().zip(improve.parts([1.0, second])) {
            match optimiser {
                Optimiser::Reinsertion => reinsertion::optimise(&mut bvh, &self.reinsertion, work)?,
                Optimiser::Treelet => treelet::optimise(&mut bvh, &self.treelet, work)?,
            }
            name = format!("{name} and {}", optimiser.name());
        }
        Ok((bvh, name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::Node;
    use crate::math::{DVec3, Vec3};
    use crate::sampling::philox4x32;
    use crate::shapes::triangle::clipped;

    fn built(quality: Quality, boxes: &[Aabb], clip: impl Fn(u32, &Aabb) -> Aabb + Sync) -> (BinaryBvh, String) {
        quality.steps(8).build(boxes, clip, Work::UNWATCHED).unwrap()
    }

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
            let (bvh, _) = built(quality, &boxes, |p, to| boxes[p as usize].intersection(*to));
            bvh.validate(&boxes).unwrap();
            bvh.nodes.iter().filter(|n| !n.is_leaf()).map(|n| f64::from(n.aabb().half_area())).sum::<f64>()
        });
        assert!(costs[1] < costs[0] && costs[2] < costs[1], "{costs:?}");
    }
    #[test]
    fn diagonals_are_cut_where_that_is_worthwhile() {
        let triangle = |i| {
            let [x, y, z, _] = philox4x32([i, 0, 0, 0], [0, 0]).map(|bits| f64::from(bits) / 2f64.powi(32));
            let (from, along) = (DVec3::new(x, y, z), DVec3::new(0.5, 0.4, 0.5));
            [from, from + along, from + along + DVec3::new(1e-3, 0.0, 0.0)]
        };
        let triangles: Vec<_> = (0..3000).map(triangle).collect();
        let clip = |p: u32, to: &Aabb| clipped(triangles[p as usize], to);
        let boxes: Vec<_> =
            (0..3000).map(|p| clip(p, &Aabb { min: Vec3::splat(-4.0), max: Vec3::splat(4.0) })).collect();
        let [fast, balanced, best] = Quality::ALL.map(|quality| built(quality, &boxes, clip));
        fast.0.validate(&boxes).unwrap();
        for (bvh, name) in [&balanced, &best] {
            bvh.validate_parts(&boxes, clip).unwrap();
            assert!(bvh.order.len() > 9000 && name.ends_with(" of pieces and reinsertion"), "{name}");
        }
        // Less by a factor, at least.
        let leaves = |bvh: &BinaryBvh| {
            let area = |n: &Node| f64::from(n.aabb().half_area()) * f64::from(n.count);
            bvh.nodes.iter().map(area).sum::<f64>()
        };
        let [fast, balanced, best] = [leaves(&fast.0), leaves(&balanced.0), leaves(&best.0)];
        assert!(best < balanced && balanced < 0.4 * fast, "{best}, {balanced}, {fast}");
    }
}
