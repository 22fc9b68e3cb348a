//! Wide BVHs for traversal: `N` children per node, tested at once, and leaves with blocks of `N` triangles.

mod batch;
mod best;
mod bests;
mod child_order;
mod collapse;
mod few_leaves;
mod first;
mod hit_sink;
mod leaf_visitor;
mod looking;
mod nearest;
mod node;
mod objects;
mod packet;
mod ray_setup;
mod refine_hits;
mod refit;
mod single;
mod sixteen;
mod step;
mod touched;
mod wave;

use super::box_coverage::cover;
use super::build::presplit::Total;
use super::build::{Builder, Leaves as LeafRule};
use super::optimise::Optimisers;
use super::rotated_axes;
use super::split_geometry::Contents;
use super::{Cuts, Quality, Steps};
use crate::query::{Answers, Query};
use crate::{Boxes, ByColumns, Info, Nearest, PrimitiveFilter, Primitives, Touches};
use batch::{All, Firsts};
use collapse::Outline;
use hit_sink::Closest;
use node::{Child, WideNode};
pub use objects::over as over_objects;
use raywright_base::math::{Aabb, Axes, DVec3, Hit, HitColumns, PlacedHits, Ray, RayBatch, RayColumns, Region};
use raywright_base::parallel::{self, CHUNK};
use raywright_base::simd::{Dispatch, Level};
use raywright_base::work::{Stopped, Work};
use raywright_shapes::triangle::{Leaves, SolidCone, clipped};
use std::ops::Range;
use std::time::Instant;

/// Options of a wide BVH.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The build quality. It determines everything that is not given: the number of bins and, for the default builder,
    /// splitting before the build and the optimizers.
    pub quality: Quality,
    /// The builder of the binary tree.
    pub builder: Builder,
    /// The optimizers that run after the build. If None, they and presplitting follow the quality for
    /// [`Builder::Binned`]; other builders use none.
    pub optimisers: Option<Optimisers>,
    /// Cost of testing a node's boxes.
    pub traversal_cost: f32,
    /// Cost of testing a leaf of triangles.
    pub intersection_cost: f32,
}

impl Options {
    /// A good choice for most scenes.
    pub const DEFAULT: Self = Self {
        quality: Quality::Balanced,
        builder: Builder::Binned { bins: None },
        optimisers: None,
        traversal_cost: 1.0,
        intersection_cost: 1.0,
    };

    /// The build steps of a binary tree for leaves of blocks of the given size.
    pub fn steps(&self, block: usize) -> Steps {
        let Self { quality, builder, optimisers, traversal_cost, intersection_cost } = *self;
        let by_quality = quality.steps(block);
        let builder = builder.or_bins(quality.bins());
        // Explicit options are not overridden.
        let (default, cuts, may_turn) = match builder {
            Builder::Binned { bins } if optimisers.is_none() => {
                let cuts = by_quality.cuts.map(|cuts| cuts.with_bins(bins.unwrap_or(quality.bins())));
                (by_quality.optimisers, cuts, by_quality.may_turn)
            }
            Builder::Spatial { bins, budget } => (Optimisers::NONE, Some(Cuts::and_splits(bins, budget)), false),
            _ => (Optimisers::NONE, None, false),
        };
        Steps {
            cuts,
            may_turn,
            builder,
            leaves: LeafRule { traversal_cost, intersection_cost, ..by_quality.leaves },
            optimisers: optimisers.unwrap_or(default),
            ..by_quality
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A tree of nodes with up to `N` children and leaves of up to `N` triangles.
#[derive(Debug)]
pub struct WideBvh<const N: usize, L> {
    /// Empty only without primitives.
    nodes: Vec<WideNode<N>>,
    leaves: L,
    /// The region of the triangles, which defines box units.
    region: Region,
    /// The tree's own axes, if they differ from the scene's.
    axes: Option<Axes>,
    /// Maximum number of stack entries.
    stack: usize,
    level: Level,
    options: Options,
    /// True if triangles may be split among several leaves.
    in_parts: bool,
    info: Info,
}

impl<const N: usize, L: Leaves<N>> WideBvh<N, L> {
    /// Build a tree over triangles.
    ///
    /// # Panics
    ///
    /// If the level has fewer than `N` lanes.
    pub fn new(primitives: &dyn Primitives, options: &Options, level: Level) -> Self {
        assert!(level.lanes() >= N, "{N} lanes at {}", level.name());
        let start = Instant::now();
        let nowhere = Region::new(DVec3::INFINITY, DVec3::NEG_INFINITY);
        let nothing = || Self::with(Vec::new(), &Outline::NOTHING, primitives, &nowhere, options);
        let mut bvh = Self::build(primitives, options).unwrap_or_else(|Stopped| nothing());
        bvh.level = level;
        bvh.info.precision = L::PRECISION;
        bvh.info.bytes = size_of_val(bvh.nodes.as_slice()) + bvh.leaves.bytes();
        bvh.info.build_seconds = start.elapsed().as_secs_f64();
        bvh
    }

    fn build(primitives: &dyn Primitives, options: &Options) -> Result<Self, Stopped> {
        let region = primitives.region();
        let steps = options.steps(N);
        let [surround, turn, grow, collapse] = primitives.work().parts([3.0, 1.0, 14.0, 5.0]);
        let boxes = surround.collect(primitives.count(), |p| aabb(primitives, &region, None, p as u32))?;
        let count = |some: Range<usize>| boxes[some].iter().filter(|b| !b.is_empty()).count();
        let count: usize = parallel::map_chunks(boxes.len(), CHUNK, count).into_iter().sum();
        let turned = if steps.may_turn { turned(primitives, &region, &boxes, turn)? } else { None };
        turn.done();
        let (axes, boxes) = turned.map_or((None, boxes), |(axes, boxes)| (Some(axes), boxes));
        // Other primitives are ignored here.
        let contents = Contents { primitives, region: &region, axes: axes.as_ref(), boxes: &[] };
        let (binary, name) = steps.build(boxes, contents, grow)?;
        let mut bvh = Self::collapse(binary, primitives, &region, options, collapse)?;
        bvh.axes = axes;
        bvh.arrange();
        bvh.in_parts = bvh.info.primitives > count;
        bvh.info.primitives = count;
        let turned = if axes.is_some() { ", turned" } else { "" };
        bvh.info.kind = format!("BVH, {N} wide, {name}{turned}, {}", L::PRECISION);
        Ok(bvh)
    }
}

/// Rotated axes and the boxes along them, if that pays; `boxes` are those along the scene's axes.
fn turned(
    primitives: &dyn Primitives,
    region: &Region,
    boxes: &[Aabb],
    work: Work,
) -> Result<Option<(Axes, Vec<Aabb>)>, Stopped> {
    let Some(axes) = rotated_axes::find(boxes, |p| primitives.corners(p).map(|c| region.to_box(c))) else {
        return Ok(None);
    };
    let along = work.collect(boxes.len(), |p| aabb(primitives, region, Some(&axes), p as u32))?;
    // The sample misses primitives with a small box along the scene's axes and a large one along others.
    let area = |boxes: &[Aabb]| Total::of(boxes).area;
    let is_worthwhile = area(&along) <= rotated_axes::WORTHWHILE * Axes::SCALE * Axes::SCALE * area(boxes);
    Ok(is_worthwhile.then_some((axes, along)))
}

/// The bounding box of a primitive in a region's units, along the tree's own axes if given; empty if it cannot be hit.
fn aabb(primitives: &dyn Primitives, region: &Region, axes: Option<&Axes>, primitive: u32) -> Aabb {
    let corners = primitives.corners(primitive);
    if corners.iter().all(|c| c.is_finite()) { region.aabb_along(axes, corners) } else { Aabb::EMPTY }
}

/// The bounding box of a primitive's part inside another box, in a region's units, along the tree's own axes if given.
fn clip(primitives: &dyn Primitives, region: &Region, axes: Option<&Axes>, primitive: u32, to: &Aabb) -> Aabb {
    clipped(primitives.corners(primitive).map(|c| region.to_box_along(axes, c)), to)
}

impl<const N: usize, L: Leaves<N>> ByColumns for WideBvh<N, L>
where
    Level: Dispatch<N>,
{
    fn intersect(&self, rays: &RayColumns<'_>, hits: HitColumns<'_>) {
        assert_eq!(rays.len(), hits.len(), "a hit for each ray");
        let answer = Closest::Columns(hits);
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Columns(*rays), answer });
    }

    fn intersect_placed(&self, rays: &RayColumns<'_>, hits: PlacedHits<'_>) {
        assert_eq!(rays.len(), hits.places.len() * PlacedHits::RUN, "a place for each four rays");
        let answer = Closest::Placed(hits);
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Columns(*rays), answer });
    }

    fn first_hits(&self, rays: &RayColumns<'_>, hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "a hit for each ray");
        let answer = Closest::Rows(hits);
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Columns(*rays), answer });
    }

    fn first_primitives(&self, rays: &RayColumns<'_>, primitives: &mut [u32]) {
        assert_eq!(rays.len(), primitives.len(), "a primitive for each ray");
        let answer = Closest::Primitives(primitives);
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Columns(*rays), answer });
    }

    fn occluded(&self, rays: &RayColumns<'_>, occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "an answer for each ray");
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Columns(*rays), answer: occluded });
    }

    fn extent(&self) -> Option<f64> {
        (self.info.primitives > few_leaves::TRIANGLES).then_some(self.region.radius)
    }
}

impl<const N: usize, L: Leaves<N>> Answers for WideBvh<N, L>
where
    Level: Dispatch<N>,
{
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q) {
        self.level.dispatch(All { bvh: self, rays: RayBatch::Rows(rays), query });
    }

    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Rows(rays), answer: Closest::Rows(hits) });
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.level.dispatch(Firsts { bvh: self, rays: RayBatch::Rows(rays), answer: occluded });
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    fn nearest(&self, points: &[DVec3], max_distances: &[f64], counts: PrimitiveFilter<'_>, nearest: &mut [Nearest]) {
        self.level.dispatch(nearest::Points { bvh: self, points, max_distances, counts, nearest });
    }

    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches {
        self.level.dispatch(touched::Cones { bvh: self, cones })
    }

    fn boxes(&self) -> Option<Boxes> {
        let nodes = node::boxes(&self.nodes, |_, count| count as usize);
        Some(Boxes { nodes, region: self.region, axes: self.axes })
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        self.refit(primitives)
    }

    /// Check that boxes contain their subtrees, that every primitive is in exactly one block with its corners, and that
    /// the tree is no deeper than recorded. If primitives are split among several blocks, the boxes of these together
    /// cover it, as far as [`cover`] detects.
    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        let mut met = vec![0u32; primitives.count()];
        let mut parts = Vec::new();
        let mut deepest = 0;
        let mut stack: Vec<(u32, usize)> = self.nodes.first().map(|_| (0, 0)).into_iter().collect();
        let mut visited = 0;
        while let Some((index, depth)) = stack.pop() {
            visited += 1;
            let node = self.nodes.get(index as usize).ok_or_else(|| format!("node {index} does not exist"))?;
            for (outer, child) in node.children() {
                deepest = deepest.max(depth + 1);
                match child {
                    Child::None => return Err(format!("node {index} has a box without a child")),
                    Child::Node(below) => {
                        if below <= index {
                            return Err(format!("node {index} has child {below}"));
                        }
                        stack.push((below, depth + 1));
                        let inner = self.nodes.get(below as usize).map_or(Aabb::EMPTY, WideNode::bounds);
                        if inner.is_empty() || !outer.contains(&inner) {
                            return Err(format!("node {index} does not contain its child {below}"));
                        }
                    }
                    Child::Leaf { first, count } => {
                        for (lane, p) in self.leaves.primitives(first as usize, count).enumerate() {
                            met[p as usize] += 1;
                            if self.leaves.corners(first as usize, count, lane) != primitives.corners(p) {
                                return Err(format!("primitive {p} has other corners in its leaf"));
                            }
                            if self.in_parts {
                                parts.push((p, outer));
                            } else if !outer.contains(&aabb(primitives, &self.region, self.axes.as_ref(), p)) {
                                return Err(format!("node {index} does not contain primitive {p}"));
                            }
                        }
                    }
                }
            }
        }
        if visited != self.nodes.len() {
            return Err(format!("{visited} of {} nodes are reachable", self.nodes.len()));
        }
        if deepest != self.info.depth {
            return Err(format!("depth is {deepest}, not {}", self.info.depth));
        }
        parts.sort_unstable_by_key(|part| part.0);
        for of_one in parts.chunk_by(|a, b| a.0 == b.0) {
            let p = of_one[0].0;
            let boxes: Vec<Aabb> = of_one.iter().map(|part| part.1).collect();
            let whole = aabb(primitives, &self.region, self.axes.as_ref(), p);
            if !cover(&boxes, &whole, |to| clip(primitives, &self.region, self.axes.as_ref(), p, to)) {
                return Err(format!("{} leaves together do not contain primitive {p}", boxes.len()));
            }
            // Several parts count as one.
            met[p as usize] = 1;
        }
        match (0..met.len()).find(|&p| met[p] != u32::from(primitives.is_finite(p as u32))) {
            Some(p) => Err(format!("primitive {p} is in {} leaves", met[p])),
            None => Ok(()),
        }
    }

    fn info(&self) -> &Info {
        &self.info
    }
}
