//! Rotated axes for the boxes of a tree.

use super::DVec3;

/// Three orthogonal right-handed vectors of length 1/2, all to within a rounding.
///
/// A point whose coordinates are at most 2 ([`Region::to_box`](super::Region::to_box)) has coordinates of at most √3
/// along them, so the bound of 2 remains valid. With u = 2⁻⁵³, a coordinate errs by 2u of each of three products, and
/// by 3u for their sum and for their inputs. A vector's coordinates add up to less than √3/2, so the error is less than
/// 5u times the point's largest coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    double: [DVec3; 3],
    single: [[f32; 3]; 3],
}

impl Axes {
    /// The length of the vectors, by which all lengths along them are scaled.
    pub const SCALE: f64 = 0.5;

    /// Axes with one along `along` and another in its plane with `beside`. None if the two span no plane, or are too
    /// long or too short.
    pub fn new(along: DVec3, beside: DVec3) -> Option<Self> {
        let first = along.try_normalize()?;
        // Twice, so that the remainder is orthogonal to within rounding of its own length, however short. A remainder
        // of mere rounding, which may be parallel, is rejected.
        let second = (beside - first * first.dot(beside)).try_normalize()?;
        let second = second - first * first.dot(second);
        if second.length_squared() < 0.5 {
            return None;
        }
        let second = second.normalize();
        let double = [first, second, first.cross(second)].map(|axis| axis * Self::SCALE);
        Some(Self { double, single: double.map(|axis| axis.as_vec3().to_array()) })
    }

    /// Transform a point or vector to the axes.
    #[inline(always)]
    pub fn to(&self, v: DVec3) -> DVec3 {
        let [x, y, z] = self.double;
        DVec3::new(x.dot(v), y.dot(v), z.dot(v))
    }

    /// Transform back, to within rounding.
    pub fn back(&self, along: DVec3) -> DVec3 {
        let [x, y, z] = self.double;
        (x * along.x + y * along.y + z * along.z) / (Self::SCALE * Self::SCALE)
    }

    /// The vectors in f32.
    #[inline(always)]
    pub fn single(&self) -> &[[f32; 3]; 3] {
        &self.single
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn axes_are_at_right_angles_and_half_as_long(
            along in vector(), other in vector(), long in -200i32..200, times in -3.0..3.0f64,
            aside in prop_oneof![Just(1.0), Just(1e-8), Just(1e-15), Just(1e-16), Just(0.0)],
        ) {
            prop_assume!(along.cross(other).length() > 1e-3);
            let beside = along * times + other * aside;
            let axes = Axes::new(along * 2f64.powi(long), beside * 2f64.powi(-long));
            prop_assert!(axes.is_some() || aside < 1e-14);
            let Some(axes) = axes else { return Ok(()) };
            let [x, y, z] = axes.double;
            for (a, b, product) in [(x, x, 0.25), (y, y, 0.25), (z, z, 0.25), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)] {
                prop_assert!((a.dot(b) - product).abs() < 4.0 * f64::EPSILON, "{:?}", axes);
            }
            prop_assert!(x.cross(y).dot(z) > 0.0);
            prop_assert!((axes.back(axes.to(along)) - along).length() < 1e-15);
            // The two defining vectors lie along the first axis and in the first plane.
            prop_assert!((axes.to(along) - DVec3::X * along.length() / 2.0).length() < 1e-15);
            prop_assert!(aside < 1.0 || axes.to(beside).z.abs() < 1e-12 && axes.to(beside).y > 0.0);
        }
    }

    #[test]
    fn what_says_no_plane_has_none() {
        for (along, beside) in [(DVec3::ZERO, DVec3::X), (DVec3::X, DVec3::ZERO), (DVec3::X, DVec3::X * 3.0)] {
            assert_eq!(Axes::new(along, beside), None);
        }
        assert_eq!(Axes::new(DVec3::NAN, DVec3::X), None);
        assert_eq!(Axes::new(DVec3::X, DVec3::INFINITY), None);
    }
}
