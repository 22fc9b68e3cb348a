//! Axes of its own that a tree may keep its boxes along.

use super::DVec3;

/// Three vectors at right angles to each other, right-handed and each half as long as 1, all to within a rounding.
///
/// A point whose coordinates do not exceed 2 ([`Region::to_box`](super::Region::to_box)) has none greater than √3 along
/// them, so what counts on 2 may count on it here as well. A coordinate along them errs by 2u of each of three products
/// for it, and by 3u for how these are added up and what they were before, with u = 2⁻⁵³ and a vector's coordinates
/// adding up to less than √3/2: by less than 5u times the point's largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    double: [DVec3; 3],
    single: [[f32; 3]; 3],
}

impl Axes {
    /// How long the vectors are: by so much all is shorter along them.
    pub const SCALE: f64 = 0.5;

    /// The axes of which one goes along a vector and another one lies in its plane with a second vector. None if the
    /// two say no plane, or are too long or too short to tell.
    pub fn new(along: DVec3, beside: DVec3) -> Option<Self> {
        let first = along.try_normalize()?;
        // Twice, so that what is left is at right angles to within rounding of its own length, however little it is:
        // unless it was nothing but rounding, which may go along the first.
        let second = (beside - first * first.dot(beside)).try_normalize()?;
        let second = second - first * first.dot(second);
        if second.length_squared() < 0.5 {
            return None;
        }
        let second = second.normalize();
        let double = [first, second, first.cross(second)].map(|axis| axis * Self::SCALE);
        Some(Self { double, single: double.map(|axis| axis.as_vec3().to_array()) })
    }

    /// A point or a vector along the axes.
    #[inline(always)]
    pub fn to(&self, v: DVec3) -> DVec3 {
        let [x, y, z] = self.double;
        DVec3::new(x.dot(v), y.dot(v), z.dot(v))
    }

    /// What has these coordinates along the axes, to within rounding.
    pub fn back(&self, along: DVec3) -> DVec3 {
        let [x, y, z] = self.double;
        (x * along.x + y * along.y + z * along.z) / (Self::SCALE * Self::SCALE)
    }

    /// The vectors, rounded to f32.
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
            // What goes along the first and the second does so there.
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
