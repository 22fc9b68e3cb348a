//! Additional bounding volumes of nodes, which fit diagonal geometry tighter: a ray that hits the box must also hit the
//! volume. All consist of planes normal to some directions.
//!
//! The bound, with v = 2⁻²⁴ and R the reach of `accel/slab.rs`, which bounds the content of a box, the origin, and the
//! vector between them in every coordinate. For a direction n with coordinates of at most 1, a point of the node on the
//! ray has the height n·p = n·o + t (n·d). Per coordinate the origin errs by vR and the ray's displacement by 3vR,
//! since d is computed from its inverse: 12vR for three. Computing n·o errs by 6vR, and n·d by as much times t. So with
//! the computed numbers, the height is off by 24vR at most. Dividing by n·d errs by v of heights of at most 3R four
//! times, and sums and products by 9vR: 45vR in all, in units of the inverse. Eight pads of the slab test are 64vR;
//! what remains covers the error of a hit's own `t`, and heights rounded in f64.

use crate::SlabRay;
use crate::bvh::traverse::numbered_leaves::Numbered;
use crate::walk::{Input, Lists};
use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{DVec3, Vec3};

/// The volumes of all nodes of a tree.
pub trait NodeVolumes: Sized + Send + Sync + 'static {
    /// Their display name; empty without volumes.
    const NAME: &'static str;

    /// A ray prepared for them.
    type Ready: Copy;

    /// Compute the volume of each node, given the content of the leaves.
    fn around(tree: &Numbered, points: &Points) -> Self;

    /// Prepare a ray.
    fn ready(ray: &SlabRay) -> Self::Ready;

    /// Narrow the interval of a ray inside a node's box to its volume. None if it misses.
    fn narrowed(&self, node: u32, ray: &Self::Ready, within: (f32, f32)) -> Option<(f32, f32)>;

    /// Return whether a point in box units is in a node's volume.
    fn holds(&self, node: usize, point: DVec3) -> bool;

    /// Memory use in bytes.
    fn bytes(&self) -> usize;
}

/// Boxes alone.
pub struct NoVolumes;

impl NodeVolumes for NoVolumes {
    const NAME: &'static str = "";
    type Ready = ();

    fn around(_: &Numbered, _: &Points) -> Self {
        Self
    }
    #[inline(always)]
    fn ready(_: &SlabRay) {}
    #[inline(always)]
    fn narrowed(&self, _: u32, (): &(), within: (f32, f32)) -> Option<(f32, f32)> {
        Some(within)
    }
    fn holds(&self, _: usize, _: DVec3) -> bool {
        true
    }
    fn bytes(&self) -> usize {
        0
    }
}

/// The content of leaves as points whose convex hull contains it.
pub struct Points<'a> {
    input: &'a Input<'a>,
    lists: &'a Lists,
    /// The start of each leaf's primitives, and the end of the last one's.
    ends: Vec<usize>,
}

impl<'a> Points<'a> {
    /// The points of all leaves.
    pub fn new(input: &'a Input<'a>, lists: &'a Lists) -> Self {
        let mut ends = vec![0];
        ends.extend(lists.counts.iter().scan(0, |end, &count| {
            *end += count as usize;
            Some(*end)
        }));
        Self { input, lists, ends }
    }

    /// The points of a leaf, in box units.
    pub fn of(&self, leaf: u32) -> impl Iterator<Item = DVec3> {
        let mine = &self.lists.order[self.ends[leaf as usize]..self.ends[leaf as usize + 1]];
        mine.iter().flat_map(|&p| {
            let corners = self.input.primitives.corners(p);
            if corners.iter().all(|c| c.is_finite()) {
                return corners.map(|c| self.input.region.to_box(c)).to_vec();
            }
            let aabb = &self.input.boxes[p as usize];
            let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
            let corner = |i: u32| {
                let up = |bit: u32| i >> bit & 1 == 1;
                DVec3::new(
                    if up(0) { max.x } else { min.x },
                    if up(1) { max.y } else { min.y },
                    if up(2) { max.z } else { min.z },
                )
            };
            (0..8).map(corner).collect()
        })
    }

    /// The points of all leaves below a node.
    pub fn below(&self, tree: &Numbered, node: usize) -> Vec<DVec3> {
        let (mut points, mut open) = (Vec::new(), vec![node]);
        while let Some(i) = open.pop() {
            let node = &tree.nodes[i];
            if node.is_leaf() { points.extend(self.of(node.index)) } else { open.extend(node.children()) }
        }
        points
    }
}

/// The heights from `low` to `high`.
pub type Span = [f32; 2];

/// Extend an interval to a height, rounded outward.
pub fn grow([low, high]: Span, height: f64) -> Span {
    let near = height as f32;
    let down = if f64::from(near) > height { near.next_down() } else { near };
    let up = if f64::from(near) < height { near.next_up() } else { near };
    [low.min(down), high.max(up)]
}

/// The empty interval.
pub const NOWHERE: Span = [f32::INFINITY, f32::NEG_INFINITY];

/// A ray prepared for directions other than the axes.
#[derive(Clone, Copy)]
pub struct ObliqueRay {
    origin: Vec3,
    direction: Vec3,
    pad: f32,
}

/// Minimum rate of change of the height: across a scene, its effect is negligible relative to the pad.
const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;

impl ObliqueRay {
    /// Convert from a ray prepared for boxes.
    #[inline(always)]
    pub fn new(ray: &SlabRay) -> Self {
        let [x, y, z] = ray.inverse;
        Self { origin: Vec3::from(ray.origin), direction: Vec3::new(1.0 / x, 1.0 / y, 1.0 / z), pad: 8.0 * ray.pad }
    }

    /// The ray relative to planes normal to a direction.
    #[inline(always)]
    pub fn across(&self, normal: Vec3) -> Across {
        let rise = normal.dot(self.direction);
        let rise = if rise.abs() < SMALLEST { SMALLEST.copysign(rise) } else { rise };
        let inverse = 1.0 / rise;
        let (shift, room) = (-normal.dot(self.origin) * inverse, self.pad * inverse.abs());
        Across { inverse, near: shift - room, far: shift + room }
    }
}

/// A ray's intervals between planes normal to a direction.
#[derive(Clone, Copy)]
pub struct Across {
    inverse: f32,
    near: f32,
    far: f32,
}

impl Across {
    /// Narrow an interval to that between two heights; the result is reversed if empty.
    #[inline(always)]
    pub fn narrowed(&self, [low, high]: Span, (enter, leave): (f32, f32)) -> (f32, f32) {
        let (a, b) = (low * self.inverse, high * self.inverse);
        (greater(enter, lesser(a, b) + self.near), lesser(leave, greater(a, b) + self.far))
    }
}
