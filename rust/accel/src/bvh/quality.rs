//! The steps of a BVH build for each build quality.

use super::BinaryBvh;
use super::build::presplit::{self, Pieces, Remedy};
use super::build::spatial::{BUDGET, MAX_BUDGET};
use super::build::{Builder, Leaves, Shapes};
use super::optimise::{Optimiser, Optimisers, reinsertion, treelet};
use raywright_base::math::{Aabb, Vec3};
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;

/// The trade-off between build time and traversal time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// For few rays, or geometry that changes frequently.
    FastBuild,
    /// For most scenes. Long diagonal geometry is handled by spatial splits if there is little of it, and by splits
    /// before the build if there is much. A regular mesh pays only for detecting that it has none.
    #[default]
    Balanced,
    /// For many rays in a static scene: primitives may be split by planes.
    FastRays,
}

impl Quality {
    /// All qualities, by increasing build time.
    pub const ALL: [Self; 3] = [Self::FastBuild, Self::Balanced, Self::FastRays];

    /// The number of bins per axis.
    pub const fn bins(self) -> usize {
        match self {
            Self::FastBuild => 8,
            Self::Balanced => 16,
            Self::FastRays => 32,
        }
    }

    /// The build steps for leaves of blocks with the given number of triangles.
    pub const fn steps(self, block: usize) -> Steps {
        // FastBuild runs no optimizer unless requested.
        let (optimisers, rounds, share, worthwhile) = match self {
            Self::FastBuild => (Optimisers::NONE, 6, 0.1, 2e-3),
            Self::Balanced => (Optimisers::REINSERTION, 6, 0.1, 2e-3),
            Self::FastRays => (Optimisers::REINSERTION, 30, 0.3, 1e-4),
        };
        let builder = Builder::Binned { bins: Some(self.bins()) };
        let cuts = match self {
            Self::FastBuild => None,
            // A tree over pieces cannot be refitted, so it has to halve the number of boxes per ray at least. More
            // pieces would reduce that number further, but cache misses would cost more.
            Self::Balanced => {
                let planes = Builder::Spatial { bins: Some(self.bins()), budget: BUDGET };
                Some(Cuts { options: presplit::Options { budget: 4.0, worthwhile: 0.5 }, builder, planes })
            }
            Self::FastRays => Some(Cuts::and_splits(Some(self.bins()), MAX_BUDGET)),
        };
        Steps {
            cuts,
            may_turn: cuts.is_some(),
            builder,
            leaves: Leaves::for_blocks(block),
            optimisers,
            reinsertion: reinsertion::Options { rounds, share, worthwhile, block },
            treelet: treelet::Options { rounds: 3, worthwhile, block },
        }
    }
}

/// How primitives that fill little of their box are split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuts {
    /// Options of splitting before the build, if there are many of them.
    pub options: presplit::Options,
    /// The builder over their pieces.
    pub builder: Builder,
    /// The builder if there are few, without splitting before.
    pub planes: Builder,
}

impl Cuts {
    /// The same with the given number of bins.
    pub fn with_bins(self, bins: usize) -> Self {
        let [builder, planes] = [self.builder, self.planes].map(|builder| builder.with_bins(bins));
        Self { builder, planes, ..self }
    }

    /// Spatial splits, and splits before the build. Together they add at most `budget` references per primitive.
    pub const fn and_splits(bins: Option<usize>, budget: f32) -> Self {
        let builder = Builder::Spatial { bins, budget };
        Self { options: presplit::Options { budget, worthwhile: 0.125 }, builder, planes: builder }
    }
}

/// The steps of a build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// Splitting, where it pays.
    pub cuts: Option<Cuts>,
    /// True if boxes may be along rotated axes, where that pays.
    pub may_turn: bool,
    /// The builder if nothing is split.
    pub builder: Builder,
    /// When a builder makes a leaf.
    pub leaves: Leaves,
    /// The optimizers that run after the build.
    pub optimisers: Optimisers,
    /// Options of reinsertion.
    pub reinsertion: reinsertion::Options,
    /// Options of treelet restructuring.
    pub treelet: treelet::Options,
}

impl Steps {
    /// Build a tree over unsplit boxes, skipping empty ones, and describe the method.
    pub fn whole(self, boxes: &[Aabb], work: Work) -> Result<(BinaryBvh, String), Stopped> {
        let fill = |p: u32, to: &Aabb| boxes[p as usize].intersection(*to);
        Self { cuts: None, ..self }.build(boxes, fill, work)
    }

    /// Build a tree over boxes, skipping empty ones, and describe the method in words.
    ///
    /// # Panics
    ///
    /// If an option is out of range.
    pub fn build<'a>(
        &self,
        boxes: impl Into<Cow<'a, [Aabb]>>,
        shapes: impl Shapes,
        work: Work,
    ) -> Result<(BinaryBvh, String), Stopped> {
        let boxes = boxes.into();
        let shapes = StoppableShapes { shapes, work };
        let [look, make] = work.parts([if self.cuts.is_some() { 1.0 } else { 0.0 }, 24.0]);
        let remedy = self.cuts.map(|cuts| (cuts, Remedy::of(&boxes, &shapes, &cuts.options)));
        work.goes_on()?;
        look.done();
        // Relative durations: spatial splits take some five times as long as object splits, and presplitting longer
        // than a tree of its pieces.
        let (cutting, growing) = match remedy {
            Some((_, Remedy::Pieces)) => (12.0, 5.0),
            Some((_, Remedy::Planes)) => (0.0, 24.0),
            _ => (0.0, 8.0),
        };
        let improving = 2.0 * self.optimisers.iter().count() as f32;
        let [cut, grow, improve] = make.parts([cutting, growing, improving]);
        let pieces = match remedy {
            Some((cuts, Remedy::Pieces)) => Pieces::cut(&boxes, &shapes, &cuts.options).map(|pieces| (cuts, pieces)),
            _ => None,
        };
        work.goes_on()?;
        cut.done();
        let (mut bvh, mut name) = if let Some((cuts, mut pieces)) = pieces {
            let builder = cuts.builder.over_pieces(boxes.len(), pieces.boxes.len());
            drop(boxes);
            let boxes = std::mem::take(&mut pieces.boxes);
            let mut bvh = builder.build(boxes, pieces.shapes(&shapes), &self.leaves, grow)?;
            pieces.put_together(&mut bvh);
            (bvh, format!("{} of pieces", builder.name()))
        } else {
            let builder = match remedy {
                Some((cuts, Remedy::Planes)) => cuts.planes,
                _ => self.builder,
            };
            (builder.build(boxes, shapes, &self.leaves, grow)?, builder.name().into())
        };
        let second = self.optimisers.iter().skip(1).count() as f32;
        for (optimiser, work) in self.optimisers.iter().zip(improve.parts([1.0, second])) {
            match optimiser {
                Optimiser::Reinsertion => reinsertion::optimise(&mut bvh, &self.reinsertion, work)?,
                Optimiser::Treelet => treelet::optimise(&mut bvh, &self.treelet, work)?,
            }
            name = format!("{name} and {}", optimiser.name());
        }
        // An optimizer without further gain ends early.
        improve.done();
        Ok((bvh, name))
    }
}

/// Shapes that clip to nothing once the build is canceled, which ends splitting.
struct StoppableShapes<'a, S> {
    shapes: S,
    work: Work<'a>,
}

impl<S: Shapes> Shapes for StoppableShapes<'_, S> {
    fn clip(&self, primitive: u32, to: &Aabb) -> Aabb {
        if self.work.is_stopped() { Aabb::EMPTY } else { self.shapes.clip(primitive, to) }
    }

    fn corners(&self, primitive: u32) -> Option<[Vec3; 3]> {
        self.shapes.corners(primitive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Node;
    use raywright_base::math::DVec3;
    use raywright_base::sampling::philox4x32;
    use raywright_base::work::Watch;
    use raywright_shapes::triangle::clipped;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    fn built(quality: Quality, boxes: &[Aabb], shapes: impl Shapes) -> (BinaryBvh, String) {
        quality.steps(8).build(boxes, shapes, Work::UNWATCHED).unwrap()
    }

    #[test]
    fn more_time_makes_trees_of_less_area() {
        // Randomly placed sticks.
        let boxes: Vec<_> = (0..20_000)
            .map(|i| {
                let [x, y, z, which] = philox4x32([i, 0, 0, 0], [0, 0]).map(|bits| bits as f32 / 2f32.powi(32));
                let mut size = Vec3::splat(0.002);
                size[(which * 3.0) as usize] = 0.2 * which.fract();
                Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + size }
            })
            .collect();
        let costs = Quality::ALL.map(|quality| {
            let (bvh, _) = built(quality, &boxes, |p: u32, to: &Aabb| boxes[p as usize].intersection(*to));
            bvh.validate(&boxes).unwrap();
            bvh.nodes.iter().filter(|n| !n.is_leaf()).map(|n| f64::from(n.aabb().half_area())).sum::<f64>()
        });
        assert!(costs[1] < costs[0] && costs[2] < costs[1], "{costs:?}");
    }

    /// Triangles whose parts are estimated from their corners.
    struct Triangles(Vec<[DVec3; 3]>);

    impl Shapes for Triangles {
        fn clip(&self, primitive: u32, to: &Aabb) -> Aabb {
            clipped(self.0[primitive as usize], to)
        }

        fn corners(&self, primitive: u32) -> Option<[Vec3; 3]> {
            Some(self.0[primitive as usize].map(|c| c.as_vec3()))
        }
    }

    /// Triangles along a diagonal, one in `long_one_in` of them long, and their boxes.
    fn triangles(long_one_in: u32) -> (Triangles, Vec<Aabb>) {
        let triangle = |i: u32| {
            let [x, y, z, _] = philox4x32([i, 0, 0, 0], [0, 0]).map(|bits| f64::from(bits) / 2f64.powi(32));
            let size = if i.is_multiple_of(long_one_in) { 0.8 } else { 0.004 };
            let (from, along) = (DVec3::new(x, y, z), size * DVec3::new(1.0, 0.9, 0.8));
            [from, from + along, from + along + DVec3::new(0.004, 0.0, 0.0)]
        };
        let triangles = Triangles((0..30_000).map(triangle).collect());
        let everywhere = Aabb { min: Vec3::splat(-4.0), max: Vec3::splat(4.0) };
        let boxes: Vec<_> = (0..30_000).map(|p| triangles.clip(p, &everywhere)).collect();
        (triangles, boxes)
    }

    #[test]
    fn planes_part_a_few_long_ones_among_many() {
        let (triangles, boxes) = triangles(50);
        let build = |quality: Quality, threads| {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            pool.install(|| built(quality, &boxes, |p: u32, to: &Aabb| triangles.clip(p, to)))
        };
        let estimated = |quality: Quality, threads| {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            let shapes = Triangles(triangles.0.clone());
            pool.install(|| built(quality, &boxes, shapes))
        };
        // The areas of inner nodes and leaves, relative to the root's.
        let cost = |bvh: &BinaryBvh| {
            let area = |n: &Node| f64::from(n.aabb().half_area()) * f64::from(n.count.max(1));
            bvh.nodes.iter().map(area).sum::<f64>() / f64::from(bvh.nodes[0].aabb().half_area())
        };
        let (whole, _) = build(Quality::FastBuild, 2);
        let (clipped, _) = build(Quality::Balanced, 2);
        let (one, name) = estimated(Quality::Balanced, 1);
        let (three, _) = estimated(Quality::Balanced, 3);
        assert_eq!(name, "SAH with spatial splits and reinsertion");
        one.validate_parts(&boxes, |p, to| triangles.clip(p, to)).unwrap();
        assert!(cost(&one) < 0.6 * cost(&whole), "{} from {}", cost(&one), cost(&whole));
        // Planes found by estimates are as good as those found by clipping.
        assert!(cost(&one) < 1.02 * cost(&clipped), "{}, not {}", cost(&one), cost(&clipped));
        assert!(one.order.len() < 45_000, "{}", one.order.len());
        let nodes = |bvh: &BinaryBvh| -> Vec<_> {
            bvh.nodes.iter().map(|n| (n.min.to_array(), n.index, n.max.to_array(), n.count)).collect()
        };
        assert!(one.order == three.order && nodes(&one) == nodes(&three));
    }

    #[test]
    fn planes_and_cuts_tell_all_that_they_do_and_end_when_they_are_stopped() {
        /// Cancels the work after a number of clips.
        struct Stopping<'a> {
            triangles: &'a Triangles,
            watch: &'a Watch,
            clips: AtomicUsize,
            most: usize,
        }

        impl Shapes for &Stopping<'_> {
            fn clip(&self, primitive: u32, to: &Aabb) -> Aabb {
                if self.clips.fetch_add(1, Relaxed) + 1 == self.most {
                    self.watch.stop();
                }
                self.triangles.clip(primitive, to)
            }

            fn corners(&self, primitive: u32) -> Option<[Vec3; 3]> {
                self.triangles.corners(primitive)
            }
        }

        for (long_one_in, made) in [(50, "SAH with spatial splits and"), (1, "binned SAH of pieces and")] {
            let (triangles, boxes) = triangles(long_one_in);
            let build = |most: usize| {
                let watch = Watch::default();
                let shapes = Stopping { triangles: &triangles, watch: &watch, clips: AtomicUsize::new(0), most };
                let built = Quality::Balanced.steps(8).build(&boxes, &shapes, Work::of(&watch));
                (built.map(|built| built.1), shapes.clips.into_inner(), watch.share())
            };
            let (name, clips, share) = build(usize::MAX);
            assert!(name.as_ref().is_ok_and(|name| name.starts_with(made)), "{name:?}");
            assert_eq!(share, 1.0);
            // At any time of canceling, almost nothing is clipped afterwards.
            for most in [1, clips / 10, clips / 2, 9 * clips / 10] {
                let (stopped, after, share) = build(most);
                assert_eq!(stopped, Err(Stopped), "at {most} of {clips}");
                assert!(after < most + 1000 && share < 1.0, "{after} after {most} of {clips}, {share}");
            }
        }
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
        // Each lower by a factor.
        let leaves = |bvh: &BinaryBvh| {
            let area = |n: &Node| f64::from(n.aabb().half_area()) * f64::from(n.count);
            bvh.nodes.iter().map(area).sum::<f64>()
        };
        let [fast, balanced, best] = [leaves(&fast.0), leaves(&balanced.0), leaves(&best.0)];
        assert!(best < balanced && balanced < 0.4 * fast, "{best}, {balanced}, {fast}");
    }
}
