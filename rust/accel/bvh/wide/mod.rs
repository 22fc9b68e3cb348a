//! Wide trees: `N` children a node, tested at once, and blocks of `N` triangles for leaves. They are what rays walk.

mod batch;
mod collapse;
mod nearest;
mod node;
mod packet;
mod refit;
mod single;
mod step;
mod wave;

use super::Quality;
use crate::accel::query::{Answers, Query};
use crate::accel::{Info, Nearest, Primitives};
use crate::math::{Aabb, DVec3, Ray, Region};
use crate::shapes::triangle::Leaves;
use crate::simd::{Dispatch, Level};
use batch::Batch;
use node::{Child, WideNode};
use rayon::prelude::*;
use std::time::Instant;

/// How to build a wide tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How much time the build may take.
    pub quality: Quality,
    /// Bins an axis of the surface-area builder, from 2 to [`MAX_BINS`](super::build::binned::MAX_BINS); as many as suit the quality if none.
    pub bins: Option<usize>,
    /// Cost of testing a node's boxes.
    pub traversal_cost: f32,
    /// Cost of testing a leaf of triangles.
    pub intersection_cost: f32,
}

impl Options {
    /// Good for most scenes.
    pub const DEFAULT: Self =
        Self { quality: Quality::Balanced, bins: None, traversal_cost: 1.0, intersection_cost: 1.0 };
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A tree of nodes with up to `N` children over leaves of up to `N` triangles.
#[derive(Debug)]
pub struct WideBvh<const N: usize, L> {
    /// Empty only if there are no primitives.
    nodes: Vec<WideNode<N>>,
    leaves: L,
    /// Where the triangles lie; boxes are kept in its units.
    region: Region,
    /// Entries that a stack can need.
    stack: usize,
    level: Level,
    options: Options,
    info: Info,
}

impl<const N: usize, L: Leaves<N>> WideBvh<N, L> {
    /// Builds a tree over triangles.
    ///
    /// # Panics
    /// If the level has fewer than `N` lanes.
    pub fn new(primitives: &dyn Primitives, options: &Options, level: Level) -> Self {
        assert!(level.lanes() >= N, "{N} lanes at {}", level.name());
        let start = Instant::now();
        let region = primitives.region();
        let boxes: Vec<Aabb> =
            (0..primitives.count() as u32).into_par_iter().map(|p| aabb(primitives, &region, p)).collect();
        let mut steps = options.quality.steps(N);
        steps.binned.bins = options.bins.unwrap_or(steps.binned.bins);
        let binary = steps.build(&boxes);
        drop(boxes);
        let mut bvh = Self::collapse(&binary, primitives, &region, options);
        bvh.level = level;
        let improved = if steps.reinsertion.rounds > 0 { " and reinsertion" } else { "" };
        bvh.info.kind = format!("BVH, {N} wide, binned SAH{improved}, {}", L::PRECISION);
        bvh.info.bytes = size_of_val(bvh.nodes.as_slice()) + bvh.leaves.bytes();
        bvh.info.build_seconds = start.elapsed().as_secs_f64();
        bvh
    }
}

/// The box around a primitive in a region's units; empty if nothing can hit it.
fn aabb(primitives: &dyn Primitives, region: &Region, primitive: u32) -> Aabb {
    let corners = primitives.corners(primitive);
    if corners.iter().all(|c| c.is_finite()) { region.aabb(corners) } else { Aabb::EMPTY }
}

impl<const N: usize, L: Leaves<N>> Answers for WideBvh<N, L>
where
    Level: Dispatch<N>,
{
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q) {
        self.level.dispatch(Batch { bvh: self, rays, query });
    }

    fn nearest(&self, points: &[DVec3], max_distances: &[f64], nearest: &mut [Nearest]) {
        self.level.dispatch(nearest::Points { bvh: self, points, max_distances, nearest });
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        self.refit(primitives)
    }

    /// Boxes hold what is below them, every primitive that can be hit stands in one
    /// block, once, with its corners, and the tree is no deeper than recorded.
    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        let mut met = vec![0u32; primitives.count()];
        let mut deepest = 0;
        let mut stack: Vec<(u32, usize)> = self.nodes.first().map(|_| (0, 0)).into_iter().collect();
        let mut visited = 0;
        while let Some((index, depth)) = stack.pop() {
            visited += 1;
            let node = self.nodes.get(index as usize).ok_or_else(|| format!("node {index} does not exist"))?;
            for (outer, child) in node.children() {
                deepest = deepest.max(depth + 1);
                match child {
                    Child::None => return Err(format!("node {index} has a box but no child in it")),
                    Child::Node(below) => {
                        if below <= index {
                            return Err(format!("node {index} has child {below}"));
                        }
                        stack.push((below, depth + 1));
                        let inner = self.nodes.get(below as usize).map_or(Aabb::EMPTY, WideNode::bounds);
                        if inner.is_empty() || !outer.contains(&inner) {
                            return Err(format!("node {index} does not hold its child {below}"));
                        }
                    }
                    Child::Leaf { first, count } => {
                        for (lane, p) in self.leaves.primitives(first as usize, count).enumerate() {
                            met[p as usize] += 1;
                            if self.leaves.corners(first as usize, count, lane) != primitives.corners(p) {
                                return Err(format!("primitive {p} has other corners in its leaf"));
                            }
                            if !outer.contains(&aabb(primitives, &self.region, p)) {
                                return Err(format!("node {index} does not hold primitive {p}"));
                            }
                        }
                    }
                }
            }
        }
        if visited != self.nodes.len() {
            return Err(format!("{visited} of {} nodes are reached", self.nodes.len()));
        }
        if deepest != self.info.depth {
            return Err(format!("depth is {deepest}, not {}", self.info.depth));
        }
        match (0..met.len()).find(|&p| met[p] != u32::from(primitives.is_finite(p as u32))) {
            Some(p) => Err(format!("primitive {p} stands in {} leaves", met[p])),
            None => Ok(()),
        }
    }

    fn info(&self) -> &Info {
        &self.info
    }
}
