//! What an expression can be evaluated with: numbers, intervals, and either with its derivatives along a line.

use super::functions::{Binary, Unary};
use raywright_base::math::Interval;

/// What knows the functions of an expression.
pub trait Number: Copy {
    /// A constant.
    fn constant(x: f64) -> Self;
    /// A function of one.
    fn unary(self, function: Unary) -> Self;
    /// A function of two.
    fn binary(self, function: Binary, other: Self) -> Self;
    /// To a whole power.
    fn power(self, n: i32) -> Self;
}

/// What derivatives can be made of.
pub trait Scalar: Number {
    /// All that the derivative of the magnitude may be: the sign, or all from −1 to 1 where that is open.
    fn slope_of_abs(self) -> Self;
    /// All that the derivative of something with a kink may be there: zero where the kink is certainly missed.
    fn kink(self) -> Self;
    /// Whether it is less than another: none where that is open.
    fn is_less(self, other: Self) -> Option<bool>;
    /// What holds both.
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
            // Adding zero takes the sign from a zero: the negative x axis is at π.
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
