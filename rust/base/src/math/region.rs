//! The extent of a scene, to which error bounds refer, and the units of boxes.

use super::robust::normalising_scale;
use super::{Aabb, Axes, DVec3, Vec3};

/// The bounding box of a scene in f64, with a center and a scale.
///
/// Computations in f32 use *box units*: relative to the center, and scaled by a power of two so that no coordinate
/// exceeds 2. So a small scene far from the origin loses no precision, and nothing overflows for any size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The min corner.
    pub min: DVec3,
    /// The max corner.
    pub max: DVec3,
    /// The approximate center.
    pub centre: DVec3,
    /// Bound on every coordinate relative to the center.
    pub radius: f64,
    /// Bound on every coordinate.
    pub extent: f64,
    /// The factor from the scene's units to box units.
    pub scale: f64,
}

impl Region {
    /// The region between two corners; empty if they are reversed.
    pub fn new(min: DVec3, max: DVec3) -> Self {
        if min.cmpgt(max).any() {
            return Self { min, max, centre: DVec3::ZERO, radius: 0.0, extent: 0.0, scale: 1.0 };
        }
        // Halved first, since the sum may overflow.
        let centre = min / 2.0 + max / 2.0;
        let radius = (max - centre).max(centre - min).max_element() * (1.0 + 4.0 * f64::EPSILON);
        let radius = radius.min(f64::MAX);
        let extent = min.abs().max(max.abs()).max_element();
        // A subnormal radius has no normal inverse.
        let (scale, _) = normalising_scale(if radius > 0.0 { radius.max(f64::MIN_POSITIVE) } else { 0.0 });
        Self { min, max, centre, radius, extent, scale }
    }

    /// The region of points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let (min, max) =
            points.into_iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        Self::new(min, max)
    }

    /// Return whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// A point in box units.
    #[inline(always)]
    pub fn to_box(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// A point in box units, along a tree's own axes if given.
    #[inline(always)]
    pub fn to_box_along(&self, axes: Option<&Axes>, point: DVec3) -> DVec3 {
        let point = self.to_box(point);
        axes.map_or(point, |axes| axes.to(point))
    }

    /// The bounding box of points in box units, rounded outward. It errs by half an ulp of the coordinates, from
    /// [`Region::to_box`] in f64.
    #[inline]
    pub fn aabb(&self, points: [DVec3; 3]) -> Aabb {
        self.aabb_along(None, points)
    }

    /// The same along a tree's own axes, if given; then it errs by up to 2⁻⁵⁰.
    #[inline]
    pub fn aabb_along(&self, axes: Option<&Axes>, points: [DVec3; 3]) -> Aabb {
        let [a, b, c] = points.map(|p| self.to_box_along(axes, p));
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        Aabb { min: Vec3::new(down(min.x), down(min.y), down(min.z)), max: Vec3::new(up(max.x), up(max.y), up(max.z)) }
    }
}

/// Round down to f32.
#[inline]
fn down(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) > x { y.next_down() } else { y }
}

/// Round up to f32.
#[inline]
fn up(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn anywhere() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(prop_oneof![-1e3..1e3f64, prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL])
            .prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn boxes_hold_their_points_in_box_units(points in prop::array::uniform3(anywhere()), other in anywhere()) {
            let region = Region::around(points.into_iter().chain([other]));
            let bounds = region.aabb(points);
            for p in points {
                let p = region.to_box(p);
                prop_assert!(p.abs().max_element() <= 2.0 + 1e-12, "{} of {:?}", p, region);
                prop_assert!(bounds.min.as_dvec3().cmple(p).all() && bounds.max.as_dvec3().cmpge(p).all());
            }
            for p in [region.min, region.max] {
                prop_assert!((p - region.centre).abs().max_element() <= region.radius);
            }
        }
    }

    #[test]
    fn a_region_of_nothing_and_of_one_point() {
        assert!(Region::around([]).is_empty());
        let point = Region::around([DVec3::splat(1e7)]);
        assert_eq!((point.centre, point.radius, point.scale), (DVec3::splat(1e7), 0.0, 1.0));
    }
}
