//! Solid cone queries: all primitives that each cone touches, nearest first, with conservative box tests.
//!
//! The bound. A box must be accepted whenever a triangle inside it is ([`SolidCone::nearest`]). In units in which the
//! largest coordinate of apex and region, P + 2 box units, lies in [1, 2), a triangle is accepted up to 2⁻⁴³·2 outside
//! a cone, and apex and box err by 4u each for their rounding. Boxes are rejected beyond 2⁻⁴¹, which is four times
//! that, and far less than the rounding of their f32 planes.
//!
//! Along a tree's own axes ([`Axes`]) all lengths are halved. For an apex whose largest coordinate there is P, the unit
//! is at least 2√3·P + 2: no smaller than otherwise, while half the distance outside suffices. Apex, axis and box err
//! by some 20u there.

use raywright_base::math::robust::{greater, normalising_scale};
use raywright_base::math::{Axes, DVec3, Region};
use raywright_shapes::triangle::SolidCone;

/// A primitive that a cone touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The distance from the apex to the primitive's nearest point inside the cone.
    pub distance: f64,
    /// The primitive.
    pub primitive: u32,
}

/// The touched primitives of a batch of cones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touches {
    /// Cone `i` has the touches from `splits[i]` to `splits[i + 1]`.
    pub splits: Vec<usize>,
    /// By cone, then distance, then primitive.
    pub touches: Vec<Touch>,
}

impl Touches {
    /// No cones.
    pub fn new() -> Self {
        Self { splits: vec![0], touches: Vec::new() }
    }

    /// Add the next cone with its touched primitives, in any order and possibly with duplicates.
    pub fn push(&mut self, mut touches: Vec<Touch>) {
        touches.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.primitive.cmp(&b.primitive)));
        touches.dedup();
        self.touches.append(&mut touches);
        self.splits.push(self.touches.len());
    }

    /// The touched primitives of one cone.
    pub fn of(&self, cone: usize) -> &[Touch] {
        &self.touches[self.splits[cone]..self.splits[cone + 1]]
    }

    /// Append the cones of another batch.
    pub fn append(&mut self, other: &Self) {
        let before = self.touches.len();
        self.splits.extend(other.splits[1..].iter().map(|split| split + before));
        self.touches.extend_from_slice(&other.touches);
    }
}

/// A cone prepared for box tests.
#[derive(Clone, Copy, Debug)]
pub struct ConeBoxTest {
    cone: SolidCone,
    apex: DVec3,
    /// The factor from box units to those of `apex`.
    scale: f64,
    /// The squared maximum distance.
    most: f64,
}

/// Distance from the cone beyond which a box is rejected, if the largest coordinate lies in [1, 2).
const PAD: f64 = 1.0 / (1u64 << 41) as f64;

impl ConeBoxTest {
    /// Prepare a cone for the boxes of a region, along a tree's own axes if given. None if its apex in box units
    /// overflows an f64; then no box can be rejected.
    pub fn new(axes: Option<&Axes>, cone: &SolidCone, region: &Region) -> Option<Self> {
        let apex = region.to_box_along(axes, cone.apex);
        let mut cone = *cone;
        let (mut largest, mut to_box) = (apex.abs().max_element() + 2.0, region.scale);
        if let Some(axes) = axes {
            cone.axis = axes.to(cone.axis) / Axes::SCALE;
            (largest, to_box) = (4.0 * largest, Axes::SCALE * to_box);
        }
        if !largest.is_finite() {
            return None;
        }
        let (scale, _) = normalising_scale(largest);
        let most = cone.most * to_box * scale + PAD;
        Some(Self { cone, apex: apex * scale, scale, most: most * most * (1.0 + PAD) })
    }

    /// Mask of the boxes, given by axis and side, that may contain a touched primitive, and possibly of some empty
    /// ones.
    #[inline(always)]
    pub fn may_touch<const N: usize>(&self, planes: &[[[f32; N]; 2]; 3]) -> u32 {
        let mut left = 0;
        for lane in 0..N {
            let (mut middle, mut half, mut square) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            for axis in 0..3 {
                let lower = f64::from(planes[axis][0][lane]) * self.scale - self.apex[axis];
                let upper = f64::from(planes[axis][1][lane]) * self.scale - self.apex[axis];
                middle[axis] = 0.5 * (lower + upper);
                half[axis] = 0.5 * (upper - lower);
                let gap = greater(greater(lower, -upper), 0.0);
                square += gap * gap;
            }
            let is_beyond = |way: DVec3| way.dot(middle) - way.abs().dot(half) > PAD;
            let is_apart =
                square > self.most || is_beyond(-self.cone.axis) || self.cone.away(middle).is_some_and(is_beyond);
            left |= u32::from(!is_apart) << lane;
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-2.0..2.0f64).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn no_box_with_a_point_in_the_cone_is_passed_by(
            apex in point(), away in prop_oneof![Just(1.0), Just(1e3), Just(1e12), Just(1e-9)], way in point(),
            angle in prop_oneof![Just(0.0), 0.0..90.0f64],
            t in 0.0..4.0f64, around in 0.0..6.3f64, part in 0.0..1.0f64, low in point(), high in point(),
        ) {
            prop_assume!(way.length() > 1e-3);
            let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0));
            let apex = apex * away;
            let cone = SolidCone::new(apex, way, angle, f64::INFINITY).unwrap();
            // A point in the cone, and a box that contains it.
            let side = cone.axis.any_orthonormal_vector();
            let side = side * around.cos() + cone.axis.cross(side) * around.sin();
            let turned = (angle * part).to_radians();
            let p = apex + (cone.axis * turned.cos() + side * turned.sin()) * t * away;
            let bounds = region.aabb([p, p + low.min(DVec3::ZERO), p + high.max(DVec3::ZERO)]);
            let planes = std::array::from_fn(|axis| [[bounds.min[axis]; 1], [bounds.max[axis]; 1]]);
            prop_assert_eq!(ConeBoxTest::new(None, &cone, &region).unwrap().may_touch(&planes), 1);
            // The box is also accepted within the distance of the point.
            let mut near = cone;
            near.most = (p - apex).length();
            prop_assert_eq!(ConeBoxTest::new(None, &near, &region).unwrap().may_touch(&planes), 1);
        }
    }

    #[test]
    fn boxes_beside_behind_and_beyond_are_passed_by() {
        let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0));
        let cone = SolidCone::new(DVec3::new(-1.0, 0.0, 0.0), DVec3::X, 45.0, 1.0).unwrap();
        // From x and y, a tenth wide.
        let boxes = [[-0.5f32, 0.0], [-0.5, 0.45], [-0.5, 0.61], [-0.4, -0.85], [-1.11, 0.0], [0.0, 0.0], [0.1, 0.0]];
        let of = |axis: usize, side: usize| {
            std::array::from_fn(|lane| {
                let at = if axis == 2 { -0.05 } else { boxes[lane][axis] };
                at + 0.1 * side as f32
            })
        };
        let planes: [[[f32; 7]; 2]; 3] = std::array::from_fn(|axis| std::array::from_fn(|side| of(axis, side)));
        assert_eq!(ConeBoxTest::new(None, &cone, &region).unwrap().may_touch(&planes), 0b010_0011);
    }

    #[test]
    fn touches_are_told_once_and_in_order() {
        let touch = |distance, primitive| Touch { distance, primitive };
        let mut all = Touches::new();
        all.push(vec![touch(2.0, 0), touch(1.0, 7), touch(1.0, 3), touch(2.0, 0)]);
        all.push(vec![]);
        let mut more = Touches::new();
        more.push(vec![touch(5.0, 1)]);
        all.append(&more);
        assert_eq!(all.splits, [0, 3, 3, 4]);
        assert_eq!(all.of(0), [touch(1.0, 3), touch(1.0, 7), touch(2.0, 0)]);
        assert_eq!(all.of(2), [touch(5.0, 1)]);
    }
}
