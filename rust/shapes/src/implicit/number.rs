//! The number types in which expressions are evaluated: f64, intervals, and jets of either.

use super::functions::{Binary, Unary};
use raywright_base::math::Interval;

/// A number type with the functions of the expression language.
pub trait Number: Copy {
    /// A constant.
    fn constant(x: f64) -> Self;
    /// Apply a unary function.
    fn unary(self, function: Unary) -> Self;
    /// Apply a binary function.
    fn binary(self, function: Binary, other: Self) -> Self;
    /// Raise to an integer power.
    fn power(self, n: i32) -> Self;
}

/// A number type that supports derivatives.
pub trait Scalar: Number {
    /// The derivative of the absolute value: the sign, or [−1, 1] if it is open.
    fn slope_of_abs(self) -> Self;
    /// The second derivative at a kink: zero if the kink is certainly avoided.
    fn kink(self) -> Self;
    /// Return whether it is less than another; None if open.
    fn is_less(self, other: Self) -> Option<bool>;
    /// The hull of both.
    fn either(self, other: Self) -> Self;
}

impl Number for f64 {
    fn constant(x: f64) -> Self {
        x
    }

    fn unary(self, function: Unary) -> Self {
        match function {
            Unary::Negative => -self,
            Unary::Abs => self.abs(),
            Unary::Sqrt => self.sqrt(),
            Unary::Exp => self.exp(),
            Unary::Log => self.ln(),
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Tan => self.tan(),
            Unary::Asin => self.asin(),
            Unary::Acos => self.acos(),
            Unary::Atan => self.atan(),
            Unary::Sinh => self.sinh(),
            Unary::Cosh => self.cosh(),
            Unary::Tanh => self.tanh(),
        }
    }

    fn binary(self, function: Binary, other: Self) -> Self {
        match function {
            Binary::Add => self + other,
            Binary::Subtract => self - other,
            Binary::Multiply => self * other,
            Binary::Divide => self / other,
            Binary::Raise if self < 0.0 => f64::NAN,
            Binary::Raise => self.powf(other),
            // Adding zero turns −0 into +0: the negative x axis is at π.
            Binary::Atan2 => (self + 0.0).atan2(other + 0.0),
            Binary::Min => self.min(other),
            Binary::Max => self.max(other),
        }
    }

    fn power(self, n: i32) -> Self {
        self.powi(n)
    }
}

impl Scalar for f64 {
    fn slope_of_abs(self) -> Self {
        if self == 0.0 { 0.0 } else { self.signum() }
    }

    fn kink(self) -> Self {
        0.0
    }

    fn is_less(self, other: Self) -> Option<bool> {
        Some(self < other)
    }

    fn either(self, _other: Self) -> Self {
        self
    }
}

impl Number for Interval {
    fn constant(x: f64) -> Self {
        Self::point(x)
    }

    fn unary(self, function: Unary) -> Self {
        match function {
            Unary::Negative => self.negated(),
            Unary::Abs => self.abs(),
            Unary::Sqrt => self.sqrt(),
            Unary::Exp => self.exp(),
            Unary::Log => self.ln(),
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Tan => self.tan(),
            Unary::Asin => self.asin(),
            Unary::Acos => self.acos(),
            Unary::Atan => self.atan(),
            Unary::Sinh => self.sinh(),
            Unary::Cosh => self.cosh(),
            Unary::Tanh => self.tanh(),
        }
    }

    fn binary(self, function: Binary, other: Self) -> Self {
        match function {
            Binary::Add => self.plus(other),
            Binary::Subtract => self.minus(other),
            Binary::Multiply => self.times(other),
            Binary::Divide => self.over(other),
            Binary::Raise => self.raised(other),
            Binary::Atan2 => self.atan2(other),
            Binary::Min => self.least(other),
            Binary::Max => self.greatest(other),
        }
    }

    fn power(self, n: i32) -> Self {
        Interval::power(self, n)
    }
}

impl Scalar for Interval {
    fn slope_of_abs(self) -> Self {
        match self.sign() {
            0 => Self::new(-1.0, 1.0),
            sign => Self::point(f64::from(sign)),
        }
    }

    fn kink(self) -> Self {
        if self.sign() == 0 { Self::ANYTHING } else { Self::point(0.0) }
    }

    fn is_less(self, other: Self) -> Option<bool> {
        if self.high < other.low {
            Some(true)
        } else if other.high < self.low {
            Some(false)
        } else {
            None
        }
    }

    fn either(self, other: Self) -> Self {
        self.hull(other)
    }
}
