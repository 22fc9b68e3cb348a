//! What rays cross on their way out: an odd number of times a closed surface if they start inside of it.
//!
//! All of it is decided exactly. Which triangles the ray crosses, [`Contact`] tells, through edges and corners too; and
//! where `t` is too small for its sign to be sure, the sign is that of the volume of the triangle and the ray's origin,
//! by expansions (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997).

use super::Primitives;
use super::query::{Query, Wanted};
use raywright_base::math::robust::{UNIT, normalising_scale};
use raywright_base::math::{DVec3, Ray, exact_edges};
use raywright_shapes::triangle::Along;
use raywright_shapes::{Candidate, Contact};
use std::cmp::Ordering;

/// Where a point lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The surface is crossed an even number of times on the way out.
    #[default]
    Outside,
    /// An odd number of times.
    Inside,
    /// The point is a point of the surface.
    Surface,
}

/// A surface that a ray crosses ahead of its origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Exit {
    /// The number of the ray.
    pub ray: u32,
    /// What is crossed.
    pub primitive: u32,
    /// Which primitive within that one.
    pub inner: u32,
    /// The bits of `t`, by which crossings of one primitive differ.
    t: u64,
}

/// All crossings of rays ahead of their origins, each once, by ray and primitive; and the origins on a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exits {
    /// What is crossed.
    pub crossed: Vec<Exit>,
    /// Whether the origin of each ray is a point of a surface.
    pub on_surface: Vec<bool>,
}

impl Exits {
    /// On which side of all surfaces in one the origins lie, by the even-odd rule.
    pub fn sides(&self) -> Vec<Side> {
        let mut sides = vec![Side::Outside; self.on_surface.len()];
        for exits in self.crossed.chunk_by(|a, b| a.ray == b.ray) {
            sides[exits[0].ray as usize] = if exits.len() % 2 == 1 { Side::Inside } else { Side::Outside };
        }
        for (side, on_surface) in sides.iter_mut().zip(&self.on_surface) {
            *side = if *on_surface { Side::Surface } else { *side };
        }
        sides
    }

    /// Those of two structures together.
    pub(crate) fn joined(mut self, other: Self) -> Self {
        self.crossed.extend(other.crossed);
        for (on_surface, other) in self.on_surface.iter_mut().zip(other.on_surface) {
            *on_surface |= other;
        }
        self.in_order()
    }

    /// By ray and primitive, and each once: a structure may tell the same crossing more than once.
    pub(crate) fn in_order(mut self) -> Self {
        self.crossed.sort_unstable();
        self.crossed.dedup();
        self
    }
}

/// Finds what rays cross on their way out.
pub struct WaysOut<'a> {
    /// What the accelerator holds.
    pub primitives: &'a dyn Primitives,
    /// Whether a primitive counts.
    pub counts: &'a (dyn Fn(u32) -> bool + Sync),
    /// Asked from a `t_min` of minus `doubt` on.
    pub rays: &'a [Ray],
    /// A `t` of no more than this, in lengths of the scaled direction, may have the wrong sign.
    pub doubt: f64,
    /// The answers, crossings in any order.
    pub exits: Exits,
}

impl Query for WaysOut<'_> {
    type State = (u32, bool);
    const WANTED: Wanted = Wanted::Side;

    #[inline(always)]
    fn start(&self, i: usize, _: f64) -> (u32, bool) {
        (i as u32, false)
    }
    #[inline(always)]
    fn limit(_: &(u32, bool)) -> f64 {
        f64::INFINITY
    }
    #[inline(always)]
    fn offer(&mut self, (ray, on_surface): &mut (u32, bool), primitive: u32, met: Candidate) -> bool {
        if !(self.counts)(primitive) {
            return false;
        }
        let Candidate { t, contact, inner, .. } = met;
        let ahead = if t.abs() > self.doubt {
            t.total_cmp(&0.0)
        } else {
            let (ray, corners) = (&self.rays[*ray as usize], self.primitives.corners(primitive));
            // What is no triangle has no corners, and tells `t` as well as can be.
            let is_triangle = corners[0].is_finite();
            if is_triangle { sign_of_t(ray.origin, ray.direction, corners) } else { (t + 0.0).total_cmp(&0.0) }
        };
        match ahead {
            Ordering::Equal => *on_surface = true,
            Ordering::Greater if contact != Contact::Touching => {
                self.exits.crossed.push(Exit { ray: *ray, primitive, inner, t: t.to_bits() });
            }
            _ => {}
        }
        ahead == Ordering::Equal
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (u32, bool))>) {
        self.exits.on_surface[i] = answer.is_some_and(|(_, (_, on_surface))| on_surface);
    }
}

/// The exact sign of `t` where a line meets a triangle, which it does.
///
/// It is that of the volume that the origin spans with the triangle, over that of how the line goes through.
#[cold]
#[inline(never)]
fn sign_of_t(origin: DVec3, direction: DVec3, corners: [DVec3; 3]) -> Ordering {
    let through: f64 = exact_edges(origin, direction, corners).into_iter().sum();
    let volume = sign_of_volume(origin, corners);
    if through > 0.0 { volume } else { volume.reverse() }
}

/// The sign of `(a − o) · ((b − o) × (c − o))`: exact for coordinates that are zero, or not less than 2⁻²⁸⁰ of the
/// greatest.
fn sign_of_volume(origin: DVec3, corners: [DVec3; 3]) -> Ordering {
    let [a, b, c] = corners.map(|x| x - origin);
    let size = |u: f64, v: f64, w: f64| u.abs() * (v.abs() + w.abs());
    let parts = |v: DVec3, w: DVec3| (v.y * w.z, v.z * w.y, v.z * w.x, v.x * w.z, v.x * w.y, v.y * w.x);
    let (p, q, r, s, t, u) = parts(b, c);
    let volume = a.x * (p - q) + a.y * (r - s) + a.z * (t - u);
    // Shewchuk's bound for the determinant of three differences is (7 + 56 u) u of this; what underflows is less than
    // the constant.
    let bound = 8.0 * UNIT * (size(a.x, p, q) + size(a.y, r, s) + size(a.z, t, u)) + 1e-290;
    if volume.abs() > bound && volume.is_finite() {
        return volume.total_cmp(&0.0);
    }
    let [o, a, b, c] = [origin, corners[0], corners[1], corners[2]];
    let largest = [o, a, b, c].into_iter().fold(0.0, |m: f64, x| m.max(x.abs().max_element()));
    if !largest.is_normal() {
        return Ordering::Equal;
    }
    let (scale, _) = normalising_scale(largest);
    let [o, a, b, c] = [o, a, b, c].map(|x| x * scale);
    // With two origins in it a determinant vanishes: four are left of eight.
    let mut sum = Expansion::default();
    for [x, y, z] in [[a, b, c], [b, a, o], [c, b, o], [a, c, o]] {
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            sum.add_product(x[i], y[j], z[k]);
            sum.add_product(-x[i], y[k], z[j]);
        }
    }
    sum.sign()
}

/// A sum without rounding: of components whose bits do not overlap, from the least to the greatest.
#[derive(Default)]
struct Expansion(Vec<f64>);

impl Expansion {
    fn add(&mut self, mut x: f64) {
        let mut kept = 0;
        for i in 0..self.0.len() {
            // Knuth's two-sum.
            let y = self.0[i];
            let sum = x + y;
            let of_y = sum - x;
            let error = (x - (sum - of_y)) + (y - of_y);
            if error != 0.0 {
                self.0[kept] = error;
                kept += 1;
            }
            x = sum;
        }
        self.0.truncate(kept);
        if x != 0.0 {
            self.0.push(x);
        }
    }

    fn add_product(&mut self, x: f64, y: f64, z: f64) {
        let high = x * y;
        for part in [high, x.mul_add(y, -high)] {
            let product = part * z;
            self.add(part.mul_add(z, -product));
            self.add(product);
        }
    }

    fn sign(&self) -> Ordering {
        self.0.last().map_or(Ordering::Equal, |x| x.total_cmp(&0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::{BigInt, Sign};
    use proptest::prelude::*;

    /// `x · 2^300`, which is an integer for the numbers below.
    fn integer(x: f64) -> BigInt {
        if x == 0.0 {
            return BigInt::ZERO;
        }
        let bits = x.to_bits();
        let exponent = (bits >> 52) as i32 & 0x7ff;
        let m = BigInt::from(bits & ((1 << 52) - 1) | 1 << 52) << (exponent - 1075 + 300) as usize;
        if x < 0.0 { -m } else { m }
    }

    fn oracle(o: DVec3, corners: [DVec3; 3]) -> Ordering {
        let o = o.to_array().map(integer);
        let [a, b, c] = corners.map(|x| {
            let x = x.to_array().map(integer);
            [0, 1, 2].map(|i| &x[i] - &o[i])
        });
        let volume: BigInt =
            (0..3).map(|i| &a[i] * (&b[(i + 1) % 3] * &c[(i + 2) % 3] - &b[(i + 2) % 3] * &c[(i + 1) % 3])).sum();
        match volume.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    fn point() -> impl Strategy<Value = DVec3> {
        let coordinate = prop_oneof![(-4i32..=4).prop_map(f64::from), -1.0..1.0f64, -1e-12..1e-12f64, -1e9..1e9f64];
        prop::array::uniform3(coordinate).prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2048))]
        #[test]
        fn volumes_have_the_sign_of_big_integers(
            o in point(), a in point(), b in point(), c in point(), u in 0.0..1.0f64,
        ) {
            prop_assert_eq!(sign_of_volume(o, [a, b, c]), oracle(o, [a, b, c]));
            // Within rounding of the plane.
            let near = a + (b - a) * u + (c - a) * (1.0 - u);
            prop_assert_eq!(sign_of_volume(near, [a, b, c]), oracle(near, [a, b, c]));
            prop_assert_eq!(sign_of_volume(a, [a, b, c]), Ordering::Equal);
        }
    }
}
