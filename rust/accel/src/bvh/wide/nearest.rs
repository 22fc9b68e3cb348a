//! Nearest-point queries on a wide tree: branch and bound, nearest box first (Roussopoulos, Kelley and Vincent,
//! "Nearest neighbor queries", 1995).

use super::WideBvh;
use super::node::Child;
use crate::nearest::PrimitiveFilter;
use crate::nearest::{LeafTest, Nearest, Search, of};
use raywright_base::math::DVec3;
use raywright_base::simd::{Kernel, Simd};
use raywright_shapes::triangle::Leaves;

/// A batch of nearest-point queries.
pub struct Points<'a, const N: usize, L> {
    pub bvh: &'a WideBvh<N, L>,
    pub points: &'a [DVec3],
    pub max_distances: &'a [f64],
    pub counts: PrimitiveFilter<'a>,
    pub nearest: &'a mut [Nearest],
}

/// A child to visit and its squared distance.
#[derive(Clone, Copy)]
struct QueueEntry {
    square: f64,
    child: Child,
}

impl<const N: usize, L: Leaves<N>> Kernel<N> for Points<'_, N, L> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) {
        let Self { bvh, points, max_distances, counts, nearest } = self;
        let mut stack = vec![QueueEntry { square: 0.0, child: Child::None }; bvh.stack];
        // The last point's nearest triangle is a good start for the next point: neighbours then cull most of the tree.
        let mut last = None;
        for (i, (&point, nearest)) in points.iter().zip(nearest).enumerate() {
            *nearest = match Search::along(bvh.axes.as_ref(), point, of(max_distances, i), &bvh.region) {
                Some(mut search) => {
                    if let Some((first, count, lane)) = last {
                        offer(bvh, counts, &mut search, (first, count, lane));
                    }
                    walk(simd, bvh, counts, &mut search, &mut last, &mut stack);
                    search.finish()
                }
                None => Nearest::MISS,
            };
        }
    }
}

/// Visit everything that may be nearer than the current result; `last` becomes the block and lane of the result.
#[inline(always)]
fn walk<const N: usize, L: Leaves<N>, S: Simd<N>>(
    simd: S,
    bvh: &WideBvh<N, L>,
    counts: PrimitiveFilter<'_>,
    search: &mut Search,
    last: &mut Option<(usize, u32, usize)>,
    stack: &mut [QueueEntry],
) {
    let test = LeafTest::new(search, &bvh.region, !L::EDGES);
    let (mut limit, mut leaf_limit) = (search.limit(), test.limit(search));
    let mut top = 0;
    let mut child = if bvh.nodes.is_empty() { Child::None } else { Child::Node(0) };
    loop {
        match child {
            Child::None => {}
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let bottom = top;
                let squares = search.squares(&node.planes);
                for (lane, &square) in squares.iter().enumerate() {
                    if square > limit {
                        continue;
                    }
                    let entry = QueueEntry { square, child: node.child(lane) };
                    let mut place = top;
                    while place > bottom && stack[place - 1].square < square {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = entry;
                    top += 1;
                }
            }
            Child::Leaf { first, count } => {
                let first = first as usize;
                let corners = bvh.leaves.nearly(simd, first, count);
                let mut left = test.not_rejected(simd, corners, leaf_limit) & ((1 << count) - 1);
                while left != 0 {
                    let lane = left.trailing_zeros() as usize & (N - 1);
                    left &= left - 1;
                    if offer(bvh, counts, search, (first, count, lane)) {
                        *last = Some((first, count, lane));
                        (limit, leaf_limit) = (search.limit(), test.limit(search));
                    }
                }
            }
        }
        child = loop {
            if top == 0 {
                return;
            }
            top -= 1;
            // An equally distant child may contain a lower primitive.
            if stack[top].square <= limit {
                break stack[top].child;
            }
        };
    }
}

/// Offer the triangle in a lane of a leaf to a search, if it counts. Return true if it is nearer than the current
/// result.
#[inline(always)]
fn offer<const N: usize, L: Leaves<N>>(
    bvh: &WideBvh<N, L>,
    counts: PrimitiveFilter<'_>,
    search: &mut Search,
    (first, count, lane): (usize, u32, usize),
) -> bool {
    let primitive = bvh.leaves.primitive(first, count, lane);
    counts.is_none_or(|counts| counts(primitive)) && search.offer(primitive, bvh.leaves.corners(first, count, lane))
}
