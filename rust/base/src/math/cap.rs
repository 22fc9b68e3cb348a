//! Spherical caps: solid angles of cones and of their intersections.

use super::DVec3;

/// The directions within an angle of +z that is less than 90 degrees.
#[derive(Clone, Copy, Debug)]
pub struct Cap {
    sine: f64,
    cosine: f64,
}

/// The solid angle of a cone with the given half-angle in radians, in a form that keeps digits for small angles.
pub fn solid_angle(angle: f64) -> f64 {
    8.0 * std::f64::consts::FRAC_PI_2 * (0.5 * angle).sin().powi(2)
}

/// The solid angle of the intersection of two caps with half-angles `a` and `b`, whose centers are at an angle
/// `between`. All are in radians from 0 to π.
///
/// For overlapping caps it is two sectors minus the two triangles of their centers and an intersection. Half-angle
/// formulas give the triangles' angles, and L'Huilier's formula their area. They keep their digits for caps of any
/// size. With cosines (Tovchigrechko and Vakser, "How Common is the Funnel-Like Energy Landscape in Protein-Protein
/// Interactions?", 2001; Oat and Sander, "Ambient Aperture Lighting", 2007) a cap of a thousandth of a degree would
/// keep none.
pub fn shared(a: f64, b: f64, between: f64) -> f64 {
    let (small, large) = if a <= b { (a, b) } else { (b, a) };
    if between >= a + b {
        return 0.0;
    }
    // Differences of nearby numbers are exact, so they come first.
    let apart = between - large;
    if apart + small <= 0.0 {
        return solid_angle(small);
    }
    let around = 0.5 * (small + large + between);
    if around >= std::f64::consts::PI {
        // Together they cover the sphere.
        return solid_angle(a) + solid_angle(b) - 2.0 * std::f64::consts::TAU;
    }
    // The semiperimeter minus each of the sides: small, large, and between the centers.
    let [by_small, by_large, by_between] =
        [0.5 * ((large - small) + between), 0.5 * (small + apart), 0.5 * (small - apart)];
    let half_angle = |x: f64, y: f64, opposite: f64| {
        (x.sin() * y.sin()).max(0.0).sqrt().atan2((around.sin() * opposite.sin()).max(0.0).sqrt())
    };
    // The angle at the small cap's center, opposite the large side, and vice versa.
    let at_small = 2.0 * half_angle(by_small, by_between, by_large);
    let at_large = 2.0 * half_angle(by_large, by_between, by_small);
    let tangents = [around, by_small, by_large, by_between].map(|side| (0.5 * side).tan().max(0.0));
    let excess = 4.0 * tangents.iter().product::<f64>().sqrt().atan();
    let sector = |angle: f64, turn: f64| turn * solid_angle(angle) / std::f64::consts::PI;
    (sector(small, at_small) + sector(large, at_large) - 2.0 * excess).clamp(0.0, solid_angle(small))
}

impl Cap {
    /// The cap with the given sine and cosine of its half-angle.
    pub fn new(sine: f64, cosine: f64) -> Self {
        Self { sine, cosine }
    }

    /// 1 − cos of the half-angle.
    fn height(&self) -> f64 {
        self.sine * self.sine / (1.0 + self.cosine)
    }

    /// Its solid angle.
    pub fn solid_angle(&self) -> f64 {
        std::f64::consts::TAU * self.height()
    }

    /// The solid angle of its intersection with a convex polygon, whose corners are relative to the origin.
    ///
    /// It is the integral of 1 − cos θ over the azimuth φ along the outline (Green), with θ clamped to the half-angle.
    /// Along the part of a side inside the cap, it is the triangle with +z (Van Oosterom and Strackee, "The Solid Angle
    /// of a Plane Triangle", 1983). Elsewhere it is the height of the cap times the azimuth difference.
    pub fn shared_with(&self, corners: &[DVec3]) -> f64 {
        if corners.len() < 3 {
            return 0.0;
        }
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let sum: f64 = (0..corners.len()).map(|i| self.along(corners[i], next(i))).sum();
        // Around −z the azimuth decreases.
        let way = |i: usize| corners[i].cross(next(i)).z;
        let facing = corners[0].dot(corners[1].cross(corners[2]));
        let is_around_end = (0..corners.len()).all(|i| way(i) * facing < 0.0);
        let around_end = if is_around_end { self.solid_angle() } else { 0.0 };
        (sum * facing.signum() + around_end).clamp(0.0, self.solid_angle())
    }

    /// The integral along a side.
    fn along(&self, from: DVec3, to: DVec3) -> f64 {
        let way = to - from;
        let (inside, outside) = (self.cosine * self.cosine, self.sine * self.sine);
        // How far a point from + t · way is outside the double cone, as a quadratic form.
        let product = |a: DVec3, b: DVec3| inside * a.truncate().dot(b.truncate()) - outside * a.z * b.z;
        let (a, b, c) = (product(way, way), product(from, way), product(from, from));
        let discriminant = b * b - a * c;
        let mut ends = [0.0, 1.0, 1.0, 1.0];
        if discriminant > 0.0 {
            let q = -(b + discriminant.sqrt().copysign(b));
            let [first, second] = [q / a, c / q].map(|t| if t > 0.0 && t < 1.0 { t } else { 1.0 });
            ends = [0.0, first.min(second), first.max(second), 1.0];
        }
        let mut sum = 0.0;
        for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
            let [p, q] = [pair[0], pair[1]].map(|t| if t == 1.0 { to } else { from + way * t });
            let middle = p + (q - p) * 0.5;
            let turn = p.truncate().perp_dot(q.truncate());
            // A side tangent to the cone is outside, regardless of rounding at its midpoint.
            sum += if discriminant > 0.0 && middle.z > 0.0 && product(middle, middle) < 0.0 {
                let (l, m) = (p.length(), q.length());
                2.0 * turn.atan2(l * m + p.z * m + q.z * l + p.dot(q))
            } else {
                self.height() * turn.atan2(p.truncate().dot(q.truncate()))
            };
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn cap(degrees: f64) -> Cap {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Cap::new(sine, cosine)
    }

    #[test]
    fn caps_share_what_a_quadrature_says() {
        // Half-angles and the angle between, in degrees; the solid angle, and its fraction of the first, to 11 digits.
        let known = [
            ([10.0, 5.0, 12.0], 0.005_188_130_044_004_39, 0.054_351_179_425_294_6),
            ([40.0, 60.0, 50.0], 0.893_351_850_795_718, 0.607_728_086_778_201),
            ([0.001, 30.0, 30.0002], 3.574_593_269_719_32e-10, 0.373_527_022_080_118),
        ];
        for (degrees, angle, share) in known {
            let [a, b, between] = degrees.map(f64::to_radians);
            let found = shared(a, b, between);
            assert!((found / angle - 1.0).abs() < 1e-8, "{degrees:?}: {found}");
            assert!((found / solid_angle(a) / share - 1.0).abs() < 1e-8, "{degrees:?}: {found}");
        }
    }

    #[test]
    fn caps_apart_within_each_other_or_all_around() {
        assert_eq!(shared(0.1, 0.2, 0.3), 0.0);
        assert_eq!(shared(0.1, 0.5, 0.4), solid_angle(0.1));
        assert_eq!(shared(0.5, 0.1, 0.0), solid_angle(0.1));
        assert!((shared(2.5, 2.0, 2.9) - (solid_angle(2.5) + solid_angle(2.0) - 4.0 * PI)).abs() < 1e-14);
    }

    proptest! {
        /// The textbook formula, where it keeps its digits.
        #[test]
        fn caps_that_cross_share_what_cosines_say(a in 0.2..1.5f64, b in 0.2..1.5f64, x in 0.01..0.99f64) {
            let between = (a - b).abs() + x * (a + b - (a - b).abs());
            let [p, q, r] = [a.cos(), b.cos(), between.cos()];
            let [s, t, u] = [a.sin(), b.sin(), between.sin()];
            let angles = [(r - p * q) / (s * t), (q - r * p) / (u * s), (p - r * q) / (u * t)].map(f64::acos);
            let expected = 2.0 * (PI - angles[0] - p * angles[1] - q * angles[2]);
            prop_assert!((shared(a, b, between) - expected).abs() < 1e-12);
        }

        /// A regular polygon with many sides approximates a cap, so its intersection with a cap approximates that of
        /// two caps. The circle's area exceeds that of the polygon with n corners by a fraction of at most 2 (π / n)².
        #[test]
        fn a_round_polygon_is_a_cap(a in 0.01..85.0f64, b in 0.01..80.0f64, between in 0.0..170.0f64) {
            const CORNERS: usize = 4096;
            let (tilt, angle) = (between.to_radians(), b.to_radians());
            let corner = |i: usize| {
                let turn = 2.0 * PI * i as f64 / CORNERS as f64;
                let at = DVec3::new(angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos());
                DVec3::new(at.x * tilt.cos() + at.z * tilt.sin(), at.y, at.z * tilt.cos() - at.x * tilt.sin())
            };
            let polygon: Vec<_> = (0..CORNERS).map(corner).collect();
            let reversed: Vec<_> = polygon.iter().rev().copied().collect();
            let expected = shared(a.to_radians(), angle, tilt);
            let room = 2.0 * (PI / CORNERS as f64).powi(2) * solid_angle(angle) + 1e-12;
            for corners in [&polygon, &reversed] {
                let found = cap(a).shared_with(corners);
                prop_assert!((found - expected).abs() < room, "{} {}", found, expected);
            }
        }

        /// All sides of a circumscribed polygon touch the cone: it contains the whole cap.
        #[test]
        fn a_polygon_whose_sides_touch_a_cap_has_all_of_it(a in 0.01..80.0f64, turn in 0.0..1.0f64, n in 3..12usize) {
            let corner = |i: usize| {
                let step = 2.0 * PI / n as f64;
                let (sine, cosine) = (turn + step * i as f64).sin_cos();
                let out = a.to_radians().tan() / (0.5 * step).cos();
                DVec3::new(out * cosine, out * sine, 1.0)
            };
            let polygon: Vec<_> = (0..n).map(corner).collect();
            let share = cap(a).shared_with(&polygon) / cap(a).solid_angle();
            prop_assert!((share - 1.0).abs() < 1e-6, "{}", share);
        }

        /// Triangles around a point add up to the cap.
        #[test]
        fn parts_of_the_sphere_add_up(a in 0.001..89.0f64, at in prop::array::uniform3(-1.0..1.0f64)) {
            let at = DVec3::from_array(at);
            let corners = [[1.0; 3], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(DVec3::from_array)
                .map(|corner| corner + 0.2 * at);
            let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].map(|face| face.map(|i: usize| corners[i]));
            let sum: f64 = faces.iter().map(|face| cap(a).shared_with(face)).sum();
            prop_assert!((sum / cap(a).solid_angle() - 1.0).abs() < 1e-9, "{}", sum / cap(a).solid_angle());
        }
    }
}
