//! A test oracle that intersects a line with a quadric between two planes to more than 60 digits.
//!
//! It knows the surface only as a polynomial, independently of the shapes' formulas. Three values give the coefficients
//! along the line, and the textbook formula in integers of arbitrary length gives the roots.

use num_bigint::BigInt;
use raywright_base::math::{DVec3, Ray};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// An integer times a power of two.
#[derive(Clone, Debug)]
pub(crate) struct Exact(BigInt, i64);

/// Bits of inexact results: quotients and roots.
const BITS: i64 = 400;

impl Exact {
    pub fn new(x: f64) -> Self {
        assert!(x.is_finite());
        let bits = x.to_bits();
        let (fraction, biased) = (bits & ((1 << 52) - 1), (bits >> 52 & 0x7ff) as i64);
        let (m, e) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        Self(if x < 0.0 { -BigInt::from(m) } else { BigInt::from(m) }, e)
    }

    fn at(&self, exponent: i64) -> BigInt {
        assert!(exponent <= self.1);
        &self.0 << (self.1 - exponent) as u64
    }

    pub fn sign(&self) -> Ordering {
        self.0.cmp(&BigInt::ZERO)
    }

    pub fn abs(&self) -> Self {
        if self.sign() == Ordering::Less { -self } else { self.clone() }
    }

    pub fn less(&self, other: &Self) -> bool {
        (self - other).sign() == Ordering::Less
    }

    pub fn over(&self, other: &Self) -> Self {
        let shift = (BITS + other.0.bits() as i64 - self.0.bits() as i64).max(0);
        Self((&self.0 << shift as u64) / &other.0, self.1 - other.1 - shift)
    }

    fn sqrt(&self) -> Self {
        let mut shift = 2 * BITS;
        if (self.1 - shift) % 2 != 0 {
            shift += 1;
        }
        Self((&self.0 << shift as u64).sqrt(), (self.1 - shift) / 2)
    }

    /// The distance to an f64 in ulps of that f64.
    pub fn ulps_to(&self, x: f64) -> f64 {
        let ulp = Self::new(x.abs().next_up() - x.abs());
        let Self(m, e) = (&Self::new(x) - self).abs().over(&ulp);
        // Only the magnitude matters.
        if m == BigInt::ZERO { 0.0 } else { 2f64.powf((m.bits() as i64 + e) as f64) }
    }
}

impl Add for &Exact {
    type Output = Exact;
    fn add(self, other: Self) -> Exact {
        let e = self.1.min(other.1);
        Exact(self.at(e) + other.at(e), e)
    }
}

impl Neg for &Exact {
    type Output = Exact;
    fn neg(self) -> Exact {
        Exact(-&self.0, self.1)
    }
}

impl Sub for &Exact {
    type Output = Exact;
    fn sub(self, other: Self) -> Exact {
        self + &-other
    }
}

impl Mul for &Exact {
    type Output = Exact;
    fn mul(self, other: Self) -> Exact {
        Exact(&self.0 * &other.0, self.1 + other.1)
    }
}

pub(crate) type Vector = [Exact; 3];

pub(crate) fn vector(v: DVec3) -> Vector {
    v.to_array().map(Exact::new)
}

pub(crate) fn minus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> Exact {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| &(&a[j] * &b[k]) - &(&a[k] * &b[j]))
}

fn along(ray: &Ray, t: &Exact) -> Vector {
    let (o, d) = (vector(ray.origin), vector(ray.direction));
    [0, 1, 2].map(|i| &o[i] + &(&d[i] * t))
}

/// A surface f = 0 with the inside f ≤ 0, of degree 2 at most. It is clipped to where all the linear functions `planes`
/// are nonnegative; with `caps` the clip planes are closed.
pub(crate) struct Oracle<'a> {
    pub surface: &'a dyn Fn(&Vector) -> Exact,
    pub planes: Vec<&'a dyn Fn(&Vector) -> Exact>,
    pub caps: bool,
}

impl Oracle<'_> {
    /// All intersections by increasing t, and whether the only one is a tangent.
    pub fn meets(&self, ray: &Ray) -> (Vec<Exact>, bool) {
        let half = Exact::new(0.5);
        let at = |t: f64| (self.surface)(&along(ray, &Exact::new(t)));
        let (c, plus, less) = (at(0.0), at(1.0), at(-1.0));
        let a = &(&(&plus + &less) * &half) - &c;
        let b = &(&plus - &less) * &Exact::new(0.25);
        let mut found = Vec::new();
        let mut tangent = false;
        if a.sign() != Ordering::Equal {
            let discriminant = &(&b * &b) - &(&a * &c);
            if discriminant.sign() == Ordering::Equal {
                tangent = true;
                found.push((-&b).over(&a));
            } else if discriminant.sign() == Ordering::Greater {
                let root = discriminant.sqrt();
                found.push((&(-&b) - &root).over(&a));
                found.push((&(-&b) + &root).over(&a));
            }
        } else if b.sign() != Ordering::Equal {
            found.push((-&c).over(&(&b + &b)));
        }
        // Points within rounding of a plane count as lying on it.
        let tiny = |size: &Exact| Exact(size.0.clone(), size.1 - BITS / 2);
        let within = |t: &Exact| {
            self.planes.iter().all(|plane| {
                let (from, slope) = plane_along(plane, ray);
                let value = &from + &(&slope * t);
                value.sign() != Ordering::Less || value.abs().less(&tiny(&from.abs()))
            })
        };
        found.retain(within);
        if self.caps {
            for plane in &self.planes {
                let (from, slope) = plane_along(plane, ray);
                if slope.sign() == Ordering::Equal {
                    continue;
                }
                let t = (-&from).over(&slope);
                let (p, q) = (-&from, slope);
                let value = &(&(&a * &(&p * &p)) + &(&(&b + &b) * &(&p * &q))) + &(&c * &(&q * &q));
                if value.sign() != Ordering::Greater {
                    found.push(t);
                }
            }
        }
        found.sort_by(|x, y| (x - y).sign());
        if self.caps && found.len() > 1 {
            found = vec![found[0].clone(), found[found.len() - 1].clone()];
        }
        let same = found.len() == 2 && {
            let gap = &found[1] - &found[0];
            gap.sign() == Ordering::Equal || gap.less(&tiny(&found[0].abs()))
        };
        if same {
            found.truncate(1);
        }
        (found, tangent || same)
    }
}

/// A plane's function along a line: its value at t = 0 and its slope.
fn plane_along(plane: &dyn Fn(&Vector) -> Exact, ray: &Ray) -> (Exact, Exact) {
    let from = plane(&along(ray, &Exact::new(0.0)));
    let slope = &plane(&along(ray, &Exact::new(1.0))) - &from;
    (from, slope)
}
