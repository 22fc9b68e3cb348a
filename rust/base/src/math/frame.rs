//! An orthonormal frame around a direction.

use glam::DVec3;

/// Three unit axes at right angles, right-handed: `tangent × bitangent = normal`.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The local x.
    pub tangent: DVec3,
    /// The local y.
    pub bitangent: DVec3,
    /// The local z.
    pub normal: DVec3,
}

impl Frame {
    /// A frame whose z is the unit vector `normal`, without branches or singular directions (Duff et al., "Building an
    /// Orthonormal Basis, Revisited", 2017).
    #[inline(always)]
    pub fn new(normal: DVec3) -> Self {
        let sign = 1f64.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: DVec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// A frame whose z is the unit vector `normal`, and whose x is as close as possible to another vector. Any frame if
    /// that vector is zero or parallel to the normal.
    pub fn along(normal: DVec3, x: DVec3) -> Self {
        // Scaled by its largest coordinate to avoid underflow of squares. A remainder of unit vectors this short is
        // mere rounding.
        let flat = (x / x.abs().max_element())
            .try_normalize()
            .map(|x| x - normal * normal.dot(x))
            .filter(|flat| flat.length_squared() > 1e-24);
        match flat.and_then(DVec3::try_normalize) {
            Some(tangent) => Self { tangent, bitangent: normal.cross(tangent), normal },
            None => Self::new(normal),
        }
    }

    /// Transform local to world coordinates.
    #[inline(always)]
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        self.tangent * v.x + self.bitangent * v.y + self.normal * v.z
    }

    /// Transform world to local coordinates.
    #[inline(always)]
    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.tangent.dot(v), self.bitangent.dot(v), self.normal.dot(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn axes_are_orthonormal_and_right_handed(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
            prop_assume!(x * x + y * y + z * z > 1e-12);
            let f = Frame::new(DVec3::new(x, y, z).normalize());
            for (a, b) in [(f.tangent, f.bitangent), (f.bitangent, f.normal), (f.normal, f.tangent)] {
                prop_assert!(a.dot(b).abs() < 1e-14);
                prop_assert!((a.length() - 1.0).abs() < 1e-14);
            }
            prop_assert!((f.tangent.cross(f.bitangent) - f.normal).length() < 1e-14);
            let v = DVec3::new(0.3, -0.7, 1.9);
            prop_assert!((f.to_local(f.to_world(v)) - v).length() < 1e-14);
        }
    }

    #[test]
    fn x_lies_along_what_is_asked() {
        let normal = DVec3::new(0.6, 0.0, 0.8);
        let f = Frame::along(normal, DVec3::new(1e-200, 3e-200, 2e-200));
        assert!((f.tangent.cross(f.bitangent) - normal).length() < 1e-15);
        assert!(f.tangent.dot(normal).abs() < 1e-15 && f.bitangent.dot(DVec3::new(1.0, 3.0, 2.0)).abs() < 4e-15);
        for nowhere in [DVec3::ZERO, normal * 5.0, DVec3::NAN] {
            assert_eq!(Frame::along(normal, nowhere).tangent, Frame::new(normal).tangent);
        }
    }

    #[test]
    fn poles_have_a_frame() {
        for z in [1.0, -1.0] {
            let f = Frame::new(DVec3::new(0.0, 0.0, z));
            assert!(f.tangent.is_finite() && f.bitangent.is_finite());
            assert_eq!(f.tangent.cross(f.bitangent), f.normal);
        }
    }
}
