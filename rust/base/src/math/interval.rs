//! Interval arithmetic in f64 with outward rounding: a result contains the exact value for all numbers in the operands
//! (Moore, "Interval Analysis", 1966; the decoration after IEEE 1788-2015).
//!
//! Sums, products, quotients and roots are rounded by the sign of their error, so exact results stay exact. Functions
//! of the platform's mathematical library are trusted to within [`LIBRARY_ULPS`] ulps.

use super::double_double::two_sum;

/// Maximum error of the mathematical library in ulps.
pub const LIBRARY_ULPS: u32 = 4;

/// All numbers from `low` to `high`, both included, possibly infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower bound.
    pub low: f64,
    /// The upper bound.
    pub high: f64,
    /// True if the computed function is defined and continuous on all operands (IEEE 1788 decoration).
    pub whole: bool,
}

fn up(x: f64) -> f64 {
    if x == f64::NEG_INFINITY { -f64::MAX } else { x.next_up() }
}

/// An upper bound of `a + b`, tight if exact.
fn sum_up(a: f64, b: f64) -> f64 {
    let (sum, error) = two_sum(a, b);
    if sum.is_infinite() {
        // The exact sum of finite numbers may lie just below.
        return if sum < 0.0 && a.is_finite() && b.is_finite() { -f64::MAX } else { sum };
    }
    // The error overflows only for the largest numbers.
    if error <= 0.0 { sum } else { up(sum) }
}

/// An upper bound of `a · b`, with zero times infinity equal to zero.
fn product_up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 {
        return 0.0;
    }
    let product = a * b;
    if product.is_infinite() {
        return if product < 0.0 && a.is_finite() && b.is_finite() { -f64::MAX } else { product };
    }
    // The error term may underflow below this.
    if product.abs() > 1e-280 && a.mul_add(b, -product) <= 0.0 { product } else { up(product) }
}

/// An upper bound of `a / b` for nonzero b; infinity over infinity is ignored by returning the least number.
fn quotient_up(a: f64, b: f64) -> f64 {
    let quotient = a / b;
    if quotient.is_nan() {
        return f64::NEG_INFINITY;
    }
    if a == 0.0 || b.is_infinite() || quotient.is_infinite() {
        return if quotient == f64::NEG_INFINITY && a.is_finite() && b != 0.0 { -f64::MAX } else { quotient };
    }
    let rest = (-quotient).mul_add(b, a);
    let exact = quotient.abs() > 1e-280 && a.abs() > 1e-280 && a.abs() < 1e300;
    if exact && (rest == 0.0 || (rest < 0.0) == (b > 0.0)) { quotient } else { up(quotient) }
}

/// An upper bound, given the library's `x`.
fn library_up(x: f64) -> f64 {
    (0..LIBRARY_ULPS).fold(x, |x, _| up(x))
}

impl Interval {
    /// The empty interval.
    pub const EMPTY: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, whole: false };

    /// All numbers, for a possibly undefined result.
    pub const ANYTHING: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY, whole: false };

    /// The interval between two ordered numbers.
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low, high, whole: true }
    }

    /// A single number.
    pub const fn point(x: f64) -> Self {
        Self::new(x, x)
    }

    /// Return whether it is empty.
    pub fn is_empty(self) -> bool {
        self.low.partial_cmp(&self.high).is_none_or(std::cmp::Ordering::is_gt)
    }

    /// Return whether it contains a number.
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// 1 if all numbers are positive, −1 if all are negative, else 0.
    pub fn sign(self) -> i32 {
        i32::from(self.low > 0.0 && !self.is_empty()) - i32::from(self.high < 0.0 && !self.is_empty())
    }

    /// The greatest absolute value.
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// The intersection, with the first one's decoration.
    pub fn intersection(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high), whole: self.whole }
    }

    /// The convex hull.
    pub fn hull(self, other: Self) -> Self {
        let whole = self.whole && other.whole;
        Self { low: self.low.min(other.low), high: self.high.max(other.high), whole }
    }

    /// The interval between `bounds`, or empty if this one is; whole only if this one and `whole` are.
    fn built(self, whole: bool, bounds: impl FnOnce() -> (f64, f64)) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let (low, high) = bounds();
        Self { low, high, whole: self.whole && whole }
    }

    /// Apply a nondecreasing library function with values from `floor` to `ceiling`, on the part of the interval from
    /// `least` to `most`.
    fn rising(self, f: impl Fn(f64) -> f64, [least, most]: [f64; 2], [floor, ceiling]: [f64; 2]) -> Self {
        let part = Self { low: self.low.max(least), high: self.high.min(most), whole: self.whole };
        part.built(part == self, || ((-library_up(-f(part.low))).max(floor), library_up(f(part.high)).min(ceiling)))
    }

    /// Its negative.
    pub fn negated(self) -> Self {
        Self { low: -self.high, high: -self.low, whole: self.whole }
    }

    /// Sum.
    #[inline]
    pub fn plus(self, other: Self) -> Self {
        if other.is_empty() {
            return Self::EMPTY;
        }
        self.built(other.whole, || (-sum_up(-self.low, -other.low), sum_up(self.high, other.high)))
    }

    /// Difference.
    #[inline]
    pub fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    /// Product.
    #[inline]
    pub fn times(self, other: Self) -> Self {
        if other.is_empty() {
            return Self::EMPTY;
        }
        self.built(other.whole, || {
            if self.low >= 0.0 && other.low >= 0.0 {
                return (-product_up(-self.low, other.low), product_up(self.high, other.high));
            }
            let pairs =
                [(self.low, other.low), (self.low, other.high), (self.high, other.low), (self.high, other.high)];
            let least = pairs.map(|(a, b)| product_up(-a, b)).into_iter().fold(f64::NEG_INFINITY, f64::max);
            (-least, pairs.map(|(a, b)| product_up(a, b)).into_iter().fold(f64::NEG_INFINITY, f64::max))
        })
    }

    /// Quotient. It is not whole if the divisor contains zero, and empty if the divisor is zero.
    pub fn over(self, other: Self) -> Self {
        if other.is_empty() || (other.low == 0.0 && other.high == 0.0) {
            return Self::EMPTY;
        }
        if other.contains(0.0) {
            let sign = self.sign();
            return self.built(false, || match (sign, other.low == 0.0, other.high == 0.0) {
                (1, true, _) => (-quotient_up(-self.low, other.high), f64::INFINITY),
                (1, _, true) => (f64::NEG_INFINITY, quotient_up(self.low, other.low)),
                (-1, true, _) => (f64::NEG_INFINITY, quotient_up(self.high, other.high)),
                (-1, _, true) => (-quotient_up(-self.high, other.low), f64::INFINITY),
                _ => (f64::NEG_INFINITY, f64::INFINITY),
            });
        }
        self.built(other.whole, || {
            let pairs =
                [(self.low, other.low), (self.low, other.high), (self.high, other.low), (self.high, other.high)];
            let least = pairs.map(|(a, b)| quotient_up(-a, b)).into_iter().fold(f64::NEG_INFINITY, f64::max);
            (-least, pairs.map(|(a, b)| quotient_up(a, b)).into_iter().fold(f64::NEG_INFINITY, f64::max))
        })
    }

    /// Absolute value.
    pub fn abs(self) -> Self {
        let least = if self.contains(0.0) { 0.0 } else { self.low.abs().min(self.high.abs()) };
        self.built(true, || (least, self.magnitude()))
    }

    /// The minimum of two.
    pub fn least(self, other: Self) -> Self {
        if other.is_empty() {
            return Self::EMPTY;
        }
        self.built(other.whole, || (self.low.min(other.low), self.high.min(other.high)))
    }

    /// The maximum of two.
    pub fn greatest(self, other: Self) -> Self {
        self.negated().least(other.negated()).negated()
    }

    /// Square root of the nonnegative part.
    pub fn sqrt(self) -> Self {
        let part = Self { low: self.low.max(0.0), ..self };
        let root_up = |x: f64| {
            let root = x.sqrt();
            if x > 1e-280 && root.is_finite() && root.mul_add(root, -x) >= 0.0 || x == 0.0 { root } else { up(root) }
        };
        let root_down = |x: f64| {
            let root = x.sqrt();
            let below = x > 1e-280 && root.is_finite() && root.mul_add(root, -x) <= 0.0 || x == 0.0;
            if below { root } else { (-up(-root)).max(0.0) }
        };
        part.built(part == self, || (root_down(part.low), root_up(part.high)))
    }

    /// An integer power.
    pub fn power(self, n: i32) -> Self {
        if n == 0 {
            return self.built(true, || (1.0, 1.0));
        }
        if n < 0 {
            return Self { whole: self.whole, ..Self::point(1.0) }.over(self.power(n.saturating_neg()));
        }
        let base = if n % 2 == 0 { self.abs() } else { self };
        base.built(true, || (Self::of_power(base.low, n).low, Self::of_power(base.high, n).high))
    }

    fn of_power(x: f64, n: i32) -> Self {
        if n > 64 {
            let value = x.powf(f64::from(n));
            return Self::new(-library_up(-value), library_up(value));
        }
        let (mut result, mut square, mut left) = (Self::point(1.0), Self::point(x), n);
        while left > 0 {
            if left % 2 == 1 {
                result = result.times(square);
            }
            left /= 2;
            if left > 0 {
                square = square.times(square);
            }
        }
        result
    }

    /// A real power of the nonnegative part; undefined for zero to a nonpositive power.
    pub fn raised(self, other: Self) -> Self {
        let part = Self { low: self.low.max(0.0), ..self };
        if other.is_empty() {
            return Self::EMPTY;
        }
        let defined = part == self && !(part.low == 0.0 && other.low <= 0.0);
        // It is monotone in each argument.
        part.built(other.whole && defined, || {
            let corners =
                [(part.low, other.low), (part.low, other.high), (part.high, other.low), (part.high, other.high)];
            let values = corners.map(|(a, b)| a.powf(b));
            let least = values.into_iter().fold(f64::INFINITY, f64::min);
            ((-library_up(-least)).max(0.0), library_up(values.into_iter().fold(0.0, f64::max)))
        })
    }

    /// The exponential function.
    pub fn exp(self) -> Self {
        self.rising(f64::exp, [f64::NEG_INFINITY, f64::INFINITY], [0.0, f64::INFINITY])
    }

    /// Natural logarithm of the positive part.
    pub fn ln(self) -> Self {
        if self.high <= 0.0 {
            return Self::EMPTY;
        }
        let all = self.rising(f64::ln, [0.0, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]);
        Self { whole: all.whole && self.low > 0.0, ..all }
    }

    /// Return whether it contains `shift + k · period` for an integer `k`, to within rounding.
    fn reaches(self, shift: f64, period: f64) -> bool {
        let [low, high] = [self.low, self.high].map(|x| (x - shift) / period);
        let doubt = 1e-15 * (2.0 + low.abs().max(high.abs()));
        (high + doubt).floor() >= (low - doubt).ceil()
    }

    /// Cosine.
    pub fn cos(self) -> Self {
        use std::f64::consts::{PI, TAU};
        self.built(true, || {
            // Beyond this, adjacent f64 are too far apart.
            if self.magnitude() > 1e13 {
                return (-1.0, 1.0);
            }
            let (a, b) = (self.low.cos(), self.high.cos());
            let low = if self.reaches(PI, TAU) { -1.0 } else { (-library_up(-a.min(b))).max(-1.0) };
            let high = if self.reaches(0.0, TAU) { 1.0 } else { library_up(a.max(b)).min(1.0) };
            (low, high)
        })
    }

    /// Sine.
    pub fn sin(self) -> Self {
        use std::f64::consts::{FRAC_PI_2, TAU};
        self.built(true, || {
            if self.magnitude() > 1e13 {
                return (-1.0, 1.0);
            }
            let (a, b) = (self.low.sin(), self.high.sin());
            let low = if self.reaches(-FRAC_PI_2, TAU) { -1.0 } else { (-library_up(-a.min(b))).max(-1.0) };
            let high = if self.reaches(FRAC_PI_2, TAU) { 1.0 } else { library_up(a.max(b)).min(1.0) };
            (low, high)
        })
    }

    /// Tangent.
    pub fn tan(self) -> Self {
        use std::f64::consts::{FRAC_PI_2, PI};
        if self.is_empty() {
            return Self::EMPTY;
        }
        if self.magnitude() > 1e13 || self.reaches(FRAC_PI_2, PI) {
            return Self::ANYTHING;
        }
        self.rising(f64::tan, [f64::NEG_INFINITY, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// Arc sine of the part in [−1, 1].
    pub fn asin(self) -> Self {
        self.rising(f64::asin, [-1.0, 1.0], [-1.6, 1.6])
    }

    /// Arc cosine of the part in [−1, 1].
    pub fn acos(self) -> Self {
        self.negated().rising(|x| (-x).acos(), [-1.0, 1.0], [0.0, 3.2])
    }

    /// Arc tangent.
    pub fn atan(self) -> Self {
        self.rising(f64::atan, [f64::NEG_INFINITY, f64::INFINITY], [-1.6, 1.6])
    }

    /// The angle of the point (`x`, this) from the x axis, from −π to π; not whole across the negative x axis and at
    /// the origin.
    pub fn atan2(self, x: Self) -> Self {
        use std::f64::consts::PI;
        if x.is_empty() {
            return Self::EMPTY;
        }
        let cut = x.low < 0.0 && self.low < 0.0 && self.high >= 0.0;
        let origin = x.contains(0.0) && self.contains(0.0);
        self.built(x.whole && !cut && !origin, || {
            if cut || origin && x.low < 0.0 {
                return (if cut { -library_up(PI) } else { 0.0 }, library_up(PI));
            }
            // Adding zero turns −0 into +0.
            let angles = [(self.low, x.low), (self.low, x.high), (self.high, x.low), (self.high, x.high)]
                .map(|(y, x)| (y + 0.0).atan2(x + 0.0));
            let (low, high) = angles.into_iter().fold((PI, -PI), |(a, b), c| (a.min(c), b.max(c)));
            (-library_up(-low), library_up(high))
        })
    }

    /// Hyperbolic sine.
    pub fn sinh(self) -> Self {
        self.rising(f64::sinh, [f64::NEG_INFINITY, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// Hyperbolic cosine.
    pub fn cosh(self) -> Self {
        self.abs().rising(f64::cosh, [0.0, f64::INFINITY], [1.0, f64::INFINITY])
    }

    /// Hyperbolic tangent.
    pub fn tanh(self) -> Self {
        self.rising(f64::tanh, [f64::NEG_INFINITY, f64::INFINITY], [-1.0, 1.0])
    }
}

#[cfg(test)]
mod tests;
