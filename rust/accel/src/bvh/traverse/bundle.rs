//! Ranged traversal with packets of sixty-four rays. At a node, a packet is represented by the first and the last ray
//! that may hit the box; those between are not examined (Wald, Boulos and Shirley, "Ray Tracing Deformable Scenes using
//! Dynamic Bounding Volume Hierarchies", 2007; Overbeck, Ramamoorthi and Mark, "Large Ray Packets for Real-time Whitted
//! Ray Tracing", 2008). A box is tested in three steps:
//!
//! - If the first ray so far hits it, all continue. For coherent rays this is usually the only test.
//! - If the interval of all rays misses it, no ray hits it (Boulos et al., "Packet-based Whitted and Distribution Ray
//!   Tracing", 2007). The bound of `bvh/wide/packet.rs` holds here also for distant rays, since each has its own pad.
//! - Otherwise the first ray that hits it is searched, one after another.
//!
//! Vectors of rays take the place of single rays. The first ray decides which child comes first, by the axis along
//! which the children are farthest apart. A node is tested when it is popped, so that earlier hits shorten the rays.
//!
//! Incoherent rays have long and mostly empty ranges: the results are correct, but slow.

use super::numbered_leaves::Numbered;
use super::ray_columns::{Columns, NearPlane};
use crate::SlabRay;
use crate::bvh::Node;
use crate::walk::{MOST_TOGETHER, Together};
use raywright_base::math::robust::{greater, lesser};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd};

/// Rays in a packet.
const WIDTH: usize = MOST_TOGETHER;

/// Create a traversal with packets of sixty-four rays.
pub fn walk(tree: &Numbered, counted: bool, level: Level) -> Box<dyn Together + '_> {
    match (level.lanes(), counted) {
        (8.., false) => Box::new(BundleTraversal::<8, false>::new(tree, level)),
        (8.., true) => Box::new(BundleTraversal::<8, true>::new(tree, level)),
        (_, false) => Box::new(BundleTraversal::<4, false>::new(tree, level)),
        (_, true) => Box::new(BundleTraversal::<4, true>::new(tree, level)),
    }
}

/// Rays are in groups of `N`, the vector width.
struct BundleTraversal<'a, const N: usize, const COUNTED: bool> {
    tree: &'a Numbered,
    level: Level,
    rays: Columns<WIDTH>,
    around: Interval,
    /// The number of rays.
    count: usize,
    stack: Vec<BundleEntry>,
    nodes: [u32; WIDTH],
}

/// A node to test, and its groups of rays.
#[derive(Clone, Copy)]
struct BundleEntry {
    node: u32,
    groups: Range,
}

/// The groups `first..end`.
#[derive(Clone, Copy)]
struct Range {
    first: usize,
    end: usize,
}

impl<'a, const N: usize, const COUNTED: bool> BundleTraversal<'a, N, COUNTED> {
    fn new(tree: &'a Numbered, level: Level) -> Self {
        // A path leaves one sibling per level.
        let stack = Vec::with_capacity(tree.depth + 1);
        let (rays, around) = (Columns::NONE, Interval::EVERYWHERE);
        Self { tree, level, rays, around, count: 0, stack, nodes: [0; WIDTH] }
    }

    /// The rays of a group that hit a box.
    #[inline(always)]
    fn met<S: Simd<N>>(&mut self, simd: S, group: usize, node: &Node, limits: &[f32; WIDTH]) -> u32 {
        if COUNTED {
            for i in group * N..(group + 1) * N {
                self.nodes[i] += u32::from(limits[i] > f32::NEG_INFINITY);
            }
        }
        self.rays.meet::<N, S>(simd, group, node, limits).1
    }

    /// The range from the first to the last group with a ray that hits the box, and one such ray of the first. None if
    /// no ray does.
    #[inline(always)]
    fn narrowed<S: Simd<N>>(
        &mut self,
        simd: S,
        groups: Range,
        node: &Node,
        limits: &[f32; WIDTH],
        last: f32,
    ) -> Option<(Range, usize)> {
        let Range { mut first, mut end } = groups;
        let mut met = self.met(simd, first, node, limits);
        if met == 0 {
            if COUNTED {
                // The interval test is counted for the first ray.
                self.nodes[first * N] += 1;
            }
            if !self.around.may_meet(node, last) {
                return None;
            }
            while met == 0 {
                first += 1;
                if first == end {
                    return None;
                }
                met = self.met(simd, first, node, limits);
            }
        }
        while end > first + 1 && self.met(simd, end - 1, node, limits) == 0 {
            end -= 1;
        }
        Some((Range { first, end }, first * N + met.trailing_zeros() as usize))
    }

    /// The children of a node: the near one for a ray, then the far one.
    #[inline(always)]
    fn in_order(&self, node: &Node, ray: usize) -> [u32; 2] {
        let [a, b] = node.children().map(|child| &self.tree.nodes[child]);
        // The vector between the doubled centers.
        let apart = (b.min + b.max) - (a.min + a.max);
        let axis = apart.abs().max_position();
        let [a, b] = [node.index, node.index + 1];
        if (apart[axis] >= 0.0) == self.rays.goes_up(ray, axis) { [a, b] } else { [b, a] }
    }
}

impl<const N: usize, const COUNTED: bool> Together for BundleTraversal<'_, N, COUNTED>
where
    Level: Dispatch<N>,
{
    fn width(&self) -> usize {
        WIDTH
    }

    fn start(&mut self, rays: &[SlabRay]) {
        self.rays.fill(rays);
        self.around = Interval::of(rays, &self.rays);
        self.count = rays.len();
        self.nodes = [0; WIDTH];
        self.stack.clear();
        if !self.tree.nodes.is_empty() {
            self.stack.push(BundleEntry { node: 0, groups: Range { first: 0, end: rays.len().div_ceil(N) } });
        }
    }

    fn next(&mut self, limits: &[f32; WIDTH]) -> Option<(u32, u64)> {
        self.level.dispatch(BundleStep { walk: self, limits })
    }

    fn nodes(&self, ray: usize) -> u32 {
        self.nodes[ray]
    }
}

/// Advance to the next leaf.
struct BundleStep<'w, 'a, const N: usize, const COUNTED: bool> {
    walk: &'w mut BundleTraversal<'a, N, COUNTED>,
    limits: &'w [f32; WIDTH],
}

impl<const N: usize, const COUNTED: bool> Kernel<N> for BundleStep<'_, '_, N, COUNTED> {
    type Output = Option<(u32, u64)>;

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) -> Option<(u32, u64)> {
        let Self { walk, limits } = self;
        let nodes = walk.tree.nodes.as_slice();
        let mut last = f32::NEG_INFINITY;
        for &limit in limits {
            last = greater(limit, last);
        }
        while let Some(BundleEntry { node: mut at, mut groups }) = walk.stack.pop() {
            loop {
                let node = &nodes[at as usize];
                let Some((met, ray)) = walk.narrowed(simd, groups, node, limits, last) else { break };
                if node.is_leaf() {
                    let mut rays = 0;
                    for group in met.first..met.end {
                        rays |= u64::from(walk.rays.meet::<N, S>(simd, group, node, limits).1) << (group * N);
                    }
                    return Some((node.index, rays));
                }
                let [near, far] = walk.in_order(node, ray);
                walk.stack.push(BundleEntry { node: far, groups: met });
                (at, groups) = (near, met);
            }
        }
        None
    }
}

/// Intervals that contain all rays of a packet.
struct Interval {
    /// By axis, the origin for which the near plane is hit last.
    near: [f32; 3],
    /// The origin for which the far plane is hit first.
    far: [f32; 3],
    /// The least and the greatest magnitude of the inverse directions.
    inverse: [[f32; 2]; 3],
    t_min: f32,
    /// An axis along which the rays' signs differ is ignored.
    first: [NearPlane; 3],
}

impl Interval {
    /// No information.
    const EVERYWHERE: Self = Self {
        near: [0.0; 3],
        far: [0.0; 3],
        inverse: [[1.0; 2]; 3],
        t_min: f32::NEG_INFINITY,
        first: [NearPlane::Mixed; 3],
    };

    fn of(rays: &[SlabRay], columns: &Columns<WIDTH>) -> Self {
        let mut around = Self { t_min: f32::INFINITY, ..Self::EVERYWHERE };
        for ray in rays {
            around.t_min = lesser(ray.t_min, around.t_min);
        }
        for axis in 0..3 {
            around.first[axis] = columns.first(axis);
            let towards = if around.first[axis] == NearPlane::All(1) { -1.0 } else { 1.0 };
            let (mut near, mut far) = (f32::NEG_INFINITY, f32::INFINITY);
            let (mut least, mut greatest) = (f32::INFINITY, 0.0);
            for ray in rays {
                let (origin, size) = (towards * ray.origin[axis], ray.inverse[axis].abs());
                near = greater(origin + ray.pad, near);
                far = lesser(origin - ray.pad, far);
                least = lesser(size, least);
                greatest = greater(size, greatest);
            }
            around.near[axis] = near * towards;
            around.far[axis] = far * towards;
            around.inverse[axis] = [least * towards, greatest * towards];
        }
        around
    }

    /// Return whether any ray may be inside a box before `last`.
    #[inline(always)]
    fn may_meet(&self, node: &Node, last: f32) -> bool {
        let planes = [node.min.to_array(), node.max.to_array()];
        let (mut enter, mut leave) = (self.t_min, last);
        for axis in 0..3 {
            let NearPlane::All(first) = self.first[axis] else { continue };
            let [least, greatest] = self.inverse[axis];
            let near = planes[first & 1][axis] - self.near[axis];
            let far = planes[first & 1 ^ 1][axis] - self.far[axis];
            enter = greater(enter, lesser(near * least, near * greatest));
            leave = lesser(leave, greater(far * least, far * greatest));
        }
        enter <= leave
    }
}
