//! Any ray and any triangle: hits, their places and weights agree with big integers.

use super::integers::{Exact, SHIFT, cross, exact, integer, is_met, minus, sign, weights};
use super::numbers::{Range, double, double_point, one_of};
use arbitrary::{Result, Unstructured};
use num_bigint::BigInt;
use raywright::math::robust::UNIT;
use raywright::math::{DVec3, Ray, Region, exact_edges, exact_turn};
use raywright::shapes::Contact;
use raywright::shapes::triangle::EdgeRay;

/// Panics if a sign is wrong, or a number is less accurate than documented.
pub fn check(data: &[u8]) {
    let _ = Case::new(&mut Unstructured::new(data)).map(|case| case.check());
}

#[derive(Debug)]
struct Case {
    origin: DVec3,
    direction: DVec3,
    corners: [DVec3; 3],
    /// Another point, which enlarges the region.
    other: DVec3,
}

impl Case {
    fn new(u: &mut Unstructured) -> Result<Self> {
        let range = one_of(u, &[Range::Any, Range::Moderate])?;
        let corners = [double_point(u, range)?, double_point(u, range)?, double_point(u, range)?];
        let [a, b, c] = corners;
        let (origin, other) = (double_point(u, range)?, double_point(u, range)?);
        let direction = if u.ratio(1, 3)? {
            double_point(u, range)?
        } else {
            // To an edge, or as near to it as f64 allows.
            let along = a + (b - a) * (f64::from(u.int_in_range(-2..=18)?) / 16.0);
            let off = one_of(u, &[0.0, 0.0, f64::EPSILON, -f64::EPSILON, 1e-14, -1e-14, 0.25])?;
            (along + (c - along) * off - origin) * if u.arbitrary()? { double(u, range)? } else { 1.0 }
        };
        Ok(Self { origin, direction, corners, other })
    }

    fn check(&self) {
        let all = [&self.corners[..], &[self.origin, self.direction, self.other]].concat();
        if all.iter().any(|p| !p.is_finite()) {
            return;
        }
        let origin = exact(self.origin);
        let direction = exact(self.direction);
        let relative = self.corners.map(|c| minus(&exact(c), &origin));
        let weights = weights(&direction, &relative);
        self.check_edges(&weights);
        self.check_turns(&direction);
        self.check_meeting(&direction, &relative, &weights);
    }

    /// Signs are right, and values to one rounding unless they vanish beside the largest.
    fn check_edges(&self, wanted: &[BigInt; 3]) {
        let found = exact_edges(self.origin, self.direction, self.corners);
        let largest = wanted.iter().map(BigInt::bits).max().unwrap_or(0);
        for (found, wanted) in found.iter().zip(wanted) {
            assert_eq!(found.total_cmp(&0.0) as i32, sign(wanted), "{self:?}");
            if wanted.bits() + 900 > largest && sign(wanted) != 0 {
                let scaled = integer(*found) << largest;
                let wanted = wanted << SHIFT;
                assert!((scaled - &wanted).magnitude() << 52usize <= *wanted.magnitude(), "{self:?}: {found}");
            }
        }
    }

    fn check_turns(&self, direction: &Exact) {
        let [a, b, c] = self.corners;
        for (v, w) in [(a, b), (b, c), (c, a)] {
            let turn = cross(direction, &minus(&exact(w), &exact(v)));
            let wanted = turn.iter().map(sign).find(|&s| s != 0).unwrap_or(0);
            assert_eq!(exact_turn(self.direction, v, w), wanted, "{self:?}");
            assert_eq!(exact_turn(self.direction, w, v), -wanted, "{self:?}");
        }
    }

    fn check_meeting(&self, direction: &Exact, relative: &[Exact; 3], weights: &[BigInt; 3]) {
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(self.origin, self.direction) };
        let region = Region::around(self.corners.into_iter().chain([self.other]));
        let Some(edges) = EdgeRay::new(&ray, &region) else {
            assert!(self.direction.abs().max_element() < f64::MIN_POSITIVE, "{self:?}");
            return;
        };
        let is_met = is_met(weights);
        let Some(found) = edges.meet(self.corners) else {
            // A hit so far along a short direction that t overflows an f64.
            let sizes = self.corners.iter().chain([&self.origin]).map(|p| p.abs().max_element());
            let far = sizes.fold(0.0, f64::max) / self.direction.abs().max_element() * 8.0;
            assert!(!is_met || !far.is_finite(), "{self:?} is missed");
            return;
        };
        assert!(is_met, "{self:?} is met: {found:?}");
        let on_edge = weights.iter().any(|w| sign(w) == 0);
        assert_eq!(found.contact != Contact::Inside, on_edge, "{self:?}: {found:?}");

        // t is (Σ weight · depth) / (Σ weight · direction) along the largest axis of the scaled direction, which is
        // exact.
        let axis = (0..3).max_by(|&i, &j| direction[i].magnitude().cmp(direction[j].magnitude())).expect("three axes");
        let depth: BigInt = weights.iter().zip(relative).map(|(w, p)| w * &p[axis]).sum();
        let divisor = weights.iter().sum::<BigInt>() * integer(edges.direction[axis]);
        // Slack of box tests, rounding of depths, and underflow.
        let error = EdgeRay::T_ERROR * edges.reach + 16.0 * UNIT * edges.largest + f64::MIN_POSITIVE;
        if error.is_finite() {
            let off = integer(found.t) * &divisor - (depth << SHIFT);
            let room = integer(error) * divisor;
            assert!(off.magnitude() <= room.magnitude(), "{self:?}: t is {}, more than {error:e} off", found.t);
        }
    }
}
