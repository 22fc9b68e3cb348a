//! Nearest-point queries on a wide tree: branch and bound, nearest box first (Roussopoulos, Kelley and Vincent,
//! "Nearest neighbor queries", 1995). f32 bounds leave few triangles of the leaves; f64 decides among these at the end.

use super::node::Packed;
use super::{WideBvh, wave};
use crate::bvh::build::morton;
use crate::nearest::{Brackets, LeafBounds, Nearest, PrimitiveFilter, Search, of};
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

/// A child to visit and a lower bound of its squared distance.
#[derive(Clone, Copy)]
struct QueueEntry {
    square: f32,
    child: Packed,
}

/// Triangles of a leaf that may be the nearest.
#[derive(Clone, Copy)]
struct UndecidedLeaf<const N: usize> {
    leaf: Packed,
    lanes: u32,
    brackets: Brackets<N>,
}

/// Fewer points than this are processed in the given order.
const FEW: usize = 64;

/// Maximum number of leaves with undecided triangles.
const OPEN: usize = 8;

impl<const N: usize, L: Leaves<N>> Kernel<N> for Points<'_, N, L> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) {
        let Self { bvh, points, max_distances, counts, nearest } = self;
        let mut stack = vec![QueueEntry { square: 0.0, child: Packed::NONE }; bvh.stack + N];
        let mut walk = Walk {
            bvh,
            counts,
            open: [UndecidedLeaf { leaf: Packed::NONE, lanes: 0, brackets: Brackets::NONE }; OPEN],
        };
        // A point is as near to the next point's nearest triangle at most as the last point's nearest position.
        let mut last = None;
        let order = by_place(points);
        for at in 0..points.len() {
            let i = order.get(at).map_or(at, |&(_, i)| i as usize);
            nearest[i] = match Search::along(bvh.axes.as_ref(), points[i], of(max_distances, i), &bvh.region) {
                Some(mut search) => {
                    walk.run(simd, &mut search, last, &mut stack);
                    let found = search.finish();
                    if found.is_hit() {
                        last = Some(found.position);
                    }
                    found
                }
                None => Nearest::MISS,
            };
        }
    }
}

/// Return the points in order of their Morton codes, so that the nearest position of one is a good bound for the next;
/// empty for few points.
fn by_place(points: &[DVec3]) -> Vec<(u64, u32)> {
    if points.len() < FEW {
        return Vec::new();
    }
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for point in points.iter().filter(|point| point.is_finite()) {
        (min, max) = (min.min(*point), max.max(*point));
    }
    let places = 1u32 << 20;
    let scale = f64::from(places) / (max - min).max_element().max(f64::MIN_POSITIVE);
    // The conversion saturates, and NaN becomes 0.
    let code = |point: &DVec3| {
        let [x, y, z] = ((*point - min) * scale).to_array().map(|x| (x as u64).min(u64::from(places) - 1));
        morton::spread(x) << 2 | morton::spread(y) << 1 | morton::spread(z)
    };
    let mut order: Vec<_> = points.iter().enumerate().map(|(i, point)| (code(point), i as u32)).collect();
    order.sort_unstable();
    order
}

/// A traversal.
struct Walk<'a, const N: usize, L> {
    bvh: &'a WideBvh<N, L>,
    counts: PrimitiveFilter<'a>,
    open: [UndecidedLeaf<N>; OPEN],
}

impl<const N: usize, L: Leaves<N>> Walk<'_, N, L> {
    /// Search the tree, given a point of its surface.
    #[inline(always)]
    fn run<S: Simd<N>>(&mut self, simd: S, search: &mut Search, last: Option<DVec3>, stack: &mut [QueueEntry]) {
        let bvh = self.bvh;
        let mut bounds = LeafBounds::new(search, &bvh.region, !L::EDGES);
        if let Some(position) = last {
            bounds.toward(search, position);
        }
        let (mut top, mut open) = (0, 0);
        let mut child = if bvh.nodes.is_empty() { Packed::NONE } else { Packed::ROOT };
        loop {
            if child.is_leaf() == 0 {
                let node = &bvh.nodes[child.node()];
                let bottom = top;
                let squares = search.squares(simd, &node.planes);
                let mut near = simd.le(squares, simd.splat(bounds.box_limit));
                let mut lanes = [0.0; N];
                simd.store(squares, &mut lanes);
                while near != 0 {
                    let lane = near.trailing_zeros() as usize & (N - 1);
                    near &= near - 1;
                    let entry = QueueEntry { square: lanes[lane], child: Packed::of(node.children[lane]) };
                    let mut place = top;
                    while place > bottom && stack[place - 1].square < entry.square {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = entry;
                    top += 1;
                    wave::fetch(simd, bvh, entry.child);
                }
            } else if child != Packed::NONE {
                let (first, count) = child.leaf();
                let counted = self.counted(first, count);
                let to = &mut self.open[open & (OPEN - 1)];
                let lanes = bounds.visit(simd, bvh.leaves.nearly(simd, first, count), counted, &mut to.brackets);
                if lanes != 0 {
                    (to.leaf, to.lanes) = (child, lanes);
                    open += 1;
                    if open == OPEN {
                        open = self.decide(simd, search, &mut bounds, open);
                    }
                }
            }
            child = loop {
                if top == 0 {
                    self.decide(simd, search, &mut bounds, open);
                    return;
                }
                top -= 1;
                // An equally distant child may contain a lower primitive.
                if stack[top].square <= bounds.box_limit {
                    break stack[top].child;
                }
            };
        }
    }

    /// The lanes of a leaf with triangles that count.
    #[inline(always)]
    fn counted(&self, first: usize, count: u32) -> u32 {
        let all = (1 << count) - 1;
        let Some(counts) = self.counts else { return all };
        let counts = |lane: &u32| counts(self.bvh.leaves.primitive(first, count, *lane as usize));
        (0..count).filter(counts).fold(0, |lanes, lane| lanes | 1 << lane)
    }

    /// Offer the triangles of the first `open` leaves that may still be near enough to a search. Return 0, the number
    /// of leaves that remain.
    #[inline(always)]
    fn decide<S: Simd<N>>(&self, simd: S, search: &mut Search, bounds: &mut LeafBounds, open: usize) -> usize {
        for open in &self.open[..open] {
            let mut lanes = open.lanes & bounds.still_near(simd, &open.brackets);
            let (first, count) = open.leaf.leaf();
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize & (N - 1);
                lanes &= lanes - 1;
                let primitive = self.bvh.leaves.primitive(first, count, lane);
                search.offer(primitive, self.bvh.leaves.corners(first, count, lane));
            }
        }
        bounds.follow(search);
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_has_a_place_after_one_that_is_near() {
        let number = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
        let mut points: Vec<_> =
            (0..4096).map(|i| DVec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2))).collect();
        let length = |order: &[usize]| -> f64 { order.windows(2).map(|p| points[p[0]].distance(points[p[1]])).sum() };
        let order: Vec<_> = by_place(&points).into_iter().map(|(_, i)| i as usize).collect();
        let given: Vec<_> = (0..points.len()).collect();
        assert!(length(&order) < length(&given) / 5.0);
        for strange in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 1e-310] {
            points[7] = DVec3::new(strange, 0.5, strange);
            points[4000] = DVec3::splat(-strange);
            let mut order: Vec<_> = by_place(&points).into_iter().map(|(_, i)| i as usize).collect();
            order.sort_unstable();
            assert_eq!(order, given, "{strange}");
        }
        assert!(by_place(&points[..FEW - 1]).is_empty());
    }
}
