//! What nodes may have beside their boxes: something that fits diagonal geometry closer, and that a ray which meets the
//! box still has to meet. All are made of planes across some directions.
//!
//! The bound, with v = 2⁻²⁴ and R the reach of `accel/slab.rs`, which bounds what is in a box, the origin, and the way
//! between in every coordinate. Of a direction n with coordinates of at most 1, a point of the node on the ray has the
//! height n·p = n·o + t (n·d). Per coordinate the origin errs by vR and the ray's way by 3vR, since d is taken from its
//! inverse: 12vR for three. Computing n·o errs by 6vR, and n·d by as much times t. So with the numbers computed, the
//! height is off by 24vR at most. Dividing by n·d errs by v of heights of at most 3R four times, and sums and products
//! by 9vR: 45vR in all, in units of the inverse. Eight pads of the slab test are 64vR; what is left covers the error of
//! a hit's own `t`, and heights that are rounded in f64.

use crate::SlabRay;
use crate::bvh::traverse::numbered::Numbered;
use crate::walk::{Input, Lists};
use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{DVec3, Vec3};

/// Volumes of all nodes of a tree.
pub trait Volumes: Sized + Send + Sync + 'static {
    /// What they are, for people; nothing where there is nothing.
    const NAME: &'static str;

    /// A ray, ready for all of them.
    type Ready: Copy;

    /// Around the primitives below each node, given what stands in the leaves.
    fn around(tree: &Numbered, points: &Points) -> Self;

    /// Makes a ray ready.
    fn ready(ray: &SlabRay) -> Self::Ready;

    /// Of the part of a ray that is in a node's box, the part that may be in its volume. None if no part can.
    fn narrowed(&self, node: u32, ray: &Self::Ready, within: (f32, f32)) -> Option<(f32, f32)>;

    /// Whether a point in box units is in a node's volume.
    fn holds(&self, node: usize, point: DVec3) -> bool;

    /// Memory held.
    fn bytes(&self) -> usize;
}

/// Boxes alone.
pub struct Alone;

impl Volumes for Alone {
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

/// What stands in leaves, as points whose hull holds it.
pub struct Points<'a> {
    input: &'a Input<'a>,
    lists: &'a Lists,
    /// Where the primitives of each leaf begin, and where the last end.
    ends: Vec<usize>,
}

impl<'a> Points<'a> {
    /// Of the primitives of all leaves.
    pub fn new(input: &'a Input<'a>, lists: &'a Lists) -> Self {
        let mut ends = vec![0];
        ends.extend(lists.counts.iter().scan(0, |end, &count| {
            *end += count as usize;
            Some(*end)
        }));
        Self { input, lists, ends }
    }

    /// Those of a leaf, in box units.
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

    /// Those of all leaves below a node.
    pub fn below(&self, tree: &Numbered, node: usize) -> Vec<DVec3> {
        let (mut points, mut open) = (Vec::new(), vec![node]);
        while let Some(i) = open.pop() {
            let node = &tree.nodes[i];
            if node.is_leaf() { points.extend(self.of(node.index)) } else { open.extend(node.children()) }
        }
        points
    }
}

/// Heights from `low` to `high`.
pub type Span = [f32; 2];

/// Grows heights by another, rounded outwards.
pub fn grow([low, high]: Span, height: f64) -> Span {
    let near = height as f32;
    let down = if f64::from(near) > height { near.next_down() } else { near };
    let up = if f64::from(near) < height { near.next_up() } else { near };
    [low.min(down), high.max(up)]
}

/// No heights.
pub const NOWHERE: Span = [f32::INFINITY, f32::NEG_INFINITY];

/// A ray as directions other than the axes see it.
#[derive(Clone, Copy)]
pub struct Line {
    origin: Vec3,
    direction: Vec3,
    pad: f32,
}

/// Below this the change of height counts as this: over the way through a scene, that is nothing beside the pad.
const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;

impl Line {
    /// From a ray made ready for boxes.
    #[inline(always)]
    pub fn new(ray: &SlabRay) -> Self {
        let [x, y, z] = ray.inverse;
        Self { origin: Vec3::from(ray.origin), direction: Vec3::new(1.0 / x, 1.0 / y, 1.0 / z), pad: 8.0 * ray.pad }
    }

    /// How it goes along a direction.
    #[inline(always)]
    pub fn across(&self, normal: Vec3) -> Across {
        let rise = normal.dot(self.direction);
        let rise = if rise.abs() < SMALLEST { SMALLEST.copysign(rise) } else { rise };
        let inverse = 1.0 / rise;
        let (shift, room) = (-normal.dot(self.origin) * inverse, self.pad * inverse.abs());
        Across { inverse, near: shift - room, far: shift + room }
    }
}

/// A ray's way between planes across a direction.
#[derive(Clone, Copy)]
pub struct Across {
    inverse: f32,
    near: f32,
    far: f32,
}

impl Across {
    /// Of a part of the ray, what may be between two heights; enters after it leaves if nothing can.
    #[inline(always)]
    pub fn narrowed(&self, [low, high]: Span, (enter, leave): (f32, f32)) -> (f32, f32) {
        let (a, b) = (low * self.inverse, high * self.inverse);
        (greater(enter, lesser(a, b) + self.near), lesser(leave, greater(a, b) + self.far))
    }
}
