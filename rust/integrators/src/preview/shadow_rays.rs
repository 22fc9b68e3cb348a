//! Shadow rays and cosines of sixteen points.

use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::simd::loops;
use raywright_scene::RayOrigin;

/// What lights a preview.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PreviewLight {
    /// A light at the eye: it reaches all that is seen.
    Headlight,
    /// Parallel light from a direction, of any length but 0.
    Sun(DVec3),
    /// Light from a point.
    Point(DVec3),
}

loops! {
    /// Where shadow rays start that go towards the sun, the cosine between it and the normal on the side that is seen,
    /// and by how much that normal is the winding's: 1 or −1.
    pub(super) fn towards_sun(
        position: &VectorLanes,
        error: &[f64; LANES],
        normal: &VectorLanes,
        view: &VectorLanes,
        sun: DVec3,
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
        cosine: &mut [f64; LANES],
        front: &mut [f64; LANES],
    ) {
        let length = sun.length();
        for i in 0..LANES {
            let n = normal.get(i);
            let side = if view.get(i).dot(n) <= 0.0 { 1.0 } else { -1.0 };
            origin.set(i, RayOrigin::off(position.get(i), error[i], n).ray(sun).origin);
            direction.set(i, sun);
            cosine[i] = side * n.dot(sun) / length;
            front[i] = side;
        }
    }
}

loops! {
    /// The same towards a point, with the segments up to there.
    pub(super) fn towards_point(
        position: &VectorLanes,
        error: &[f64; LANES],
        normal: &VectorLanes,
        view: &VectorLanes,
        point: DVec3,
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
        cosine: &mut [f64; LANES],
        front: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let n = normal.get(i);
            let side = if view.get(i).dot(n) <= 0.0 { 1.0 } else { -1.0 };
            let way = point - position.get(i);
            let start = RayOrigin::off(position.get(i), error[i], n).ray(way).origin;
            origin.set(i, start);
            direction.set(i, point - start);
            cosine[i] = side * n.dot(way) / way.length();
            front[i] = side;
        }
    }
}

loops! {
    /// The cosine between the way back and the normal, and on which side of the winding's that is.
    pub(super) fn towards_eye(
        normal: &VectorLanes,
        view: &VectorLanes,
        cosine: &mut [f64; LANES],
        front: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let along = view.get(i).dot(normal.get(i));
            cosine[i] = along.abs();
            front[i] = if along <= 0.0 { 1.0 } else { -1.0 };
        }
    }
}
