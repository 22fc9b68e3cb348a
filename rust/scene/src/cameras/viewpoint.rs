//! Camera poses and their interpolation.

use super::{CameraError, unit};
use glam::{DMat3, DQuat};
use raywright_base::math::DVec3;

/// A position and three orthonormal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Position.
    pub position: DVec3,
    /// Viewing direction.
    pub forward: DVec3,
    /// Direction to the right in the picture.
    pub right: DVec3,
    /// Direction upwards in the picture.
    pub up: DVec3,
}

impl Viewpoint {
    /// Creates a viewpoint at `position` that looks at `target`, with `up` upwards in the picture.
    ///
    /// # Errors
    /// If a number is not finite, both points are the same, or `up` is zero or parallel to the view.
    pub fn look_at(position: DVec3, target: DVec3, up: DVec3) -> Result<Self, CameraError> {
        if !(position.is_finite() && target.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        // Halved, so that the difference of any two finite points is finite.
        Self::towards(position, 0.5 * target - 0.5 * position, up)
    }

    /// Creates a viewpoint at `position` that looks along `direction`, which may have any length.
    ///
    /// # Errors
    /// If a number is not finite, the direction is zero, or `up` is zero or parallel to it.
    pub fn towards(position: DVec3, direction: DVec3, up: DVec3) -> Result<Self, CameraError> {
        if !(position.is_finite() && direction.is_finite() && up.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        let forward = unit(direction).ok_or(CameraError::NoDirection)?;
        let up = unit(up).ok_or(CameraError::NoUp)?;
        // Within 10⁻⁸ radians of the view, rounding of the view would determine the up direction.
        let right = Some(forward.cross(up)).filter(|r| r.length() > 1e-8).ok_or(CameraError::NoUp)?.normalize();
        Ok(Self { position, forward, right, up: right.cross(forward) })
    }

    /// Direction with these components to the right, up and forward.
    #[inline(always)]
    pub fn direction(&self, right: f64, up: f64, forward: f64) -> DVec3 {
        self.right * right + self.up * up + self.forward * forward
    }
}

/// A path between two viewpoints at constant speed: linear in position, and a rotation about one axis (slerp; Shoemake,
/// "Animating Rotation with Quaternion Curves", 1985) by 180 degrees at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CameraMotion {
    start: Viewpoint,
    end: Viewpoint,
    axis: DVec3,
    /// Rotation angle about the axis from start to end, in radians.
    angle: f64,
}

impl CameraMotion {
    pub fn new(start: Viewpoint, end: Viewpoint) -> Self {
        let [from, to] = [start, end].map(|v| DMat3::from_cols(v.right, v.up, -v.forward));
        let turn = DQuat::from_mat3(&(to * from.transpose()));
        let (axis, half) = (turn.xyz(), turn.w);
        let sine = axis.length();
        // A quaternion and its negative are the same rotation; the one with positive real part takes the short way.
        let angle = 2.0 * sine.atan2(half.abs());
        let axis = if sine > 0.0 { axis * (1f64.copysign(half) / sine) } else { DVec3::X };
        Self { start, end, axis, angle }
    }

    /// Viewpoint at a time from 0 to 1; both ends are exact.
    pub fn at(&self, time: f64) -> Viewpoint {
        if time >= 1.0 {
            return self.end;
        }
        // NaN counts as 0.
        let has_begun = time > 0.0;
        if !has_begun {
            return self.start;
        }
        let turn = DQuat::from_axis_angle(self.axis, self.angle * time);
        let Viewpoint { position, forward, right, up } = self.start;
        Viewpoint {
            // Halved, so that the difference is finite.
            position: 2.0 * (0.5 * position + (0.5 * self.end.position - 0.5 * position) * time),
            forward: turn * forward,
            right: turn * right,
            up: turn * up,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-14
    }

    fn is_right_handed(v: &Viewpoint) -> bool {
        close(v.right.cross(v.up), -v.forward)
            && [v.right, v.up, v.forward].iter().all(|axis| (axis.length() - 1.0).abs() < 1e-14)
    }

    #[test]
    fn up_need_not_be_at_right_angles() {
        let position = DVec3::new(5.0, 2.0, 1.0);
        let a = Viewpoint::look_at(position, DVec3::ZERO, DVec3::Y).unwrap();
        let b = Viewpoint::look_at(position, DVec3::ZERO, DVec3::new(5.0, 12.0, 1.0)).unwrap();
        assert!(close(a.right, b.right) && close(a.up, b.up) && a.forward == b.forward);
        assert!(is_right_handed(&a));
    }

    #[test]
    fn lengths_do_not_matter() {
        let b = Viewpoint::look_at(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), DVec3::Y).unwrap();
        for scale in [1e-300, 1e-30, 1e300] {
            let a = Viewpoint::look_at(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0) * scale, DVec3::Y / scale).unwrap();
            assert!(close(a.right, b.right) && close(a.up, b.up) && close(a.forward, b.forward));
        }
        assert!(Viewpoint::look_at(DVec3::splat(f64::MAX), DVec3::splat(-f64::MAX), DVec3::Y).is_ok());
    }

    #[test]
    fn refuses_what_is_no_viewpoint() {
        let (o, z, y) = (DVec3::ZERO, DVec3::Z, DVec3::Y);
        for (position, target, up, why) in [
            (z, z, y, CameraError::NoDirection),
            (o, z, z, CameraError::NoUp),
            (o, z, -2.0 * z, CameraError::NoUp),
            (o, z, o, CameraError::NoUp),
            (o, z * f64::NAN, y, CameraError::NotFinite),
            (o / 0.0, z, y, CameraError::NotFinite),
            (o, z, y / 0.0, CameraError::NotFinite),
        ] {
            assert_eq!(Viewpoint::look_at(position, target, up), Err(why));
        }
        assert_eq!(Viewpoint::towards(z, o, y), Err(CameraError::NoDirection));
    }

    #[test]
    fn a_quarter_turn_is_halfway_an_eighth() {
        let start = Viewpoint::towards(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y).unwrap();
        let end = Viewpoint::towards(DVec3::new(2.0, 0.0, 0.0), DVec3::X, DVec3::Y).unwrap();
        let way = CameraMotion::new(start, end);
        let (sin, cos) = (0.25 * std::f64::consts::PI).sin_cos();
        let half = way.at(0.5);
        assert_eq!(half.position, DVec3::X);
        assert!(close(half.forward, DVec3::new(sin, 0.0, -cos)) && close(half.up, DVec3::Y));
        assert_eq!((way.at(0.0), way.at(1.0), way.at(f64::NAN)), (start, end, start));
        // Equal viewpoints: no rotation.
        let still = CameraMotion::new(start, start);
        assert_eq!(still.at(0.3), start);
    }

    proptest! {
        #[test]
        fn turns_are_even(
            ways in prop::array::uniform4(prop::array::uniform3(-1.0..1.0f64)), time in 0.0..1.0f64,
            small in prop_oneof![Just(1.0), Just(1e-6)],
        ) {
            let [a, up, b, other] = ways.map(DVec3::from_array);
            let Ok(start) = Viewpoint::towards(a, a, up) else { return Ok(()) };
            let Ok(end) = Viewpoint::towards(b, a + (b - a) * small, up + (other - up) * small) else { return Ok(()) };
            let way = CameraMotion::new(start, end);
            let here = way.at(time);
            prop_assert!(is_right_handed(&here));
            // The rotation from the start is that share of the whole, about the same axis: each camera axis keeps its
            // angle to the axis of rotation.
            let axes = |v: &Viewpoint| [v.right, v.up, v.forward];
            for ((from, now), to) in axes(&start).into_iter().zip(axes(&here)).zip(axes(&end)) {
                prop_assert!((from.dot(way.axis) - now.dot(way.axis)).abs() < 1e-13);
                let angle = |v: DVec3, w: DVec3| {
                    let [v, w] = [v, w].map(|v| v - way.axis * v.dot(way.axis));
                    way.axis.dot(v.cross(w)).atan2(v.dot(w))
                };
                if from.cross(way.axis).length() > 1e-3 {
                    let off = |angle: f64| (angle + 3.0).rem_euclid(std::f64::consts::TAU) - 3.0;
                    prop_assert!(off(angle(from, now) - way.angle * time).abs() < 1e-9);
                    prop_assert!(off(angle(from, to) - way.angle).abs() < 1e-9);
                }
            }
        }
    }
}
