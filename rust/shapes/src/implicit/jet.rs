//! Automatic differentiation: a number with its first and second derivative along a line (Taylor arithmetic; Moore
//! 1966, Griewank and Walther 2008).
//!
//! For intervals, the derivatives enclose every slope of the function, including those on either side of a kink
//! (Clarke's generalized gradient). So if the slope excludes zero, the function is monotone.

use super::functions::{Binary, Unary};
use super::number::{Number, Scalar};

/// A value and its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Jet<N> {
    /// The value.
    pub value: N,
    /// The first derivative.
    pub slope: N,
    /// The second derivative.
    pub bend: N,
}

fn add<N: Number>(a: N, b: N) -> N {
    a.binary(Binary::Add, b)
}

fn sub<N: Number>(a: N, b: N) -> N {
    a.binary(Binary::Subtract, b)
}

fn mul<N: Number>(a: N, b: N) -> N {
    a.binary(Binary::Multiply, b)
}

fn div<N: Number>(a: N, b: N) -> N {
    a.binary(Binary::Divide, b)
}

fn times<N: Number>(k: f64, a: N) -> N {
    mul(N::constant(k), a)
}

impl<N: Scalar> Jet<N> {
    /// A linear function along the line.
    pub fn new(value: N, slope: N) -> Self {
        Self { value, slope, bend: N::constant(0.0) }
    }

    /// The chain rule, given the outer function's value and derivatives.
    fn chain(self, value: N, first: N, second: N) -> Self {
        let bend = add(mul(second, self.slope.power(2)), mul(first, self.bend));
        Self { value, slope: mul(first, self.slope), bend }
    }

    fn multiply(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self {
            value: mul(a.value, b.value),
            slope: add(mul(a.slope, b.value), mul(a.value, b.slope)),
            bend: add(add(mul(a.bend, b.value), times(2.0, mul(a.slope, b.slope))), mul(a.value, b.bend)),
        }
    }

    fn divide(self, other: Self) -> Self {
        let value = div(self.value, other.value);
        let slope = div(sub(self.slope, mul(value, other.slope)), other.value);
        let bend = sub(sub(self.bend, times(2.0, mul(slope, other.slope))), mul(value, other.bend));
        Self { value, slope, bend: div(bend, other.value) }
    }

    /// `a ** b = exp(b · log a)`, by the derivatives of the exponent.
    fn raise(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let (log, rate) = (a.value.unary(Unary::Log), div(a.slope, a.value));
        let value = a.value.binary(Binary::Raise, b.value);
        let first = add(mul(b.slope, log), mul(b.value, rate));
        let inner = sub(div(a.bend, a.value), rate.power(2));
        let second = add(add(mul(b.bend, log), times(2.0, mul(b.slope, rate))), mul(b.value, inner));
        Self { value, slope: mul(value, first), bend: mul(value, add(second, first.power(2))) }
    }

    fn atan2(self, other: Self) -> Self {
        let (y, x) = (self, other);
        let square = add(x.value.power(2), y.value.power(2));
        let turn = |dx: N, dy: N| sub(mul(x.value, dy), mul(y.value, dx));
        let moved = turn(x.slope, y.slope);
        let slope = div(moved, square);
        let outwards = add(mul(x.value, x.slope), mul(y.value, y.slope));
        let bend = sub(turn(x.bend, y.bend), times(2.0, mul(slope, outwards)));
        Self { value: y.value.binary(Binary::Atan2, x.value), slope, bend: div(bend, square) }
    }

    /// The minimum or maximum. Its slope is the hull of both slopes if either may be chosen.
    fn choose(self, other: Self, function: Binary) -> Self {
        let value = self.value.binary(function, other.value);
        match self.value.is_less(other.value) {
            Some(less) if less == (function == Binary::Min) => Self { value, ..self },
            Some(_) => Self { value, ..other },
            None => {
                let kink = sub(self.value, other.value).kink();
                Self { value, slope: self.slope.either(other.slope), bend: kink }
            }
        }
    }
}

impl<N: Scalar> Number for Jet<N> {
    fn constant(x: f64) -> Self {
        Self::new(N::constant(x), N::constant(0.0))
    }

    fn unary(self, function: Unary) -> Self {
        let x = self.value;
        let value = x.unary(function);
        let one = N::constant(1.0);
        // 1 / sqrt(1 − x²), the derivative of the arc sine.
        let arc = || div(one, sub(one, x.power(2)).unary(Unary::Sqrt));
        let (first, second) = match function {
            Unary::Negative => (N::constant(-1.0), N::constant(0.0)),
            Unary::Abs => (x.slope_of_abs(), x.kink()),
            Unary::Sqrt => {
                let first = div(N::constant(0.5), value);
                (first, times(-0.5, div(first, x)))
            }
            Unary::Exp => (value, value),
            Unary::Log => {
                let first = div(one, x);
                (first, times(-1.0, first.power(2)))
            }
            Unary::Sin => (x.unary(Unary::Cos), value.unary(Unary::Negative)),
            Unary::Cos => (x.unary(Unary::Sin).unary(Unary::Negative), value.unary(Unary::Negative)),
            Unary::Tan => {
                let first = add(one, value.power(2));
                (first, times(2.0, mul(value, first)))
            }
            Unary::Asin => (arc(), mul(x, arc().power(3))),
            Unary::Acos => (times(-1.0, arc()), times(-1.0, mul(x, arc().power(3)))),
            Unary::Atan => {
                let first = div(one, add(one, x.power(2)));
                (first, times(-2.0, mul(x, first.power(2))))
            }
            Unary::Sinh => (x.unary(Unary::Cosh), value),
            Unary::Cosh => (x.unary(Unary::Sinh), value),
            Unary::Tanh => {
                let first = sub(one, value.power(2));
                (first, times(-2.0, mul(value, first)))
            }
        };
        self.chain(value, first, second)
    }

    fn binary(self, function: Binary, other: Self) -> Self {
        match function {
            Binary::Add => Self {
                value: add(self.value, other.value),
                slope: add(self.slope, other.slope),
                bend: add(self.bend, other.bend),
            },
            Binary::Subtract => Self {
                value: sub(self.value, other.value),
                slope: sub(self.slope, other.slope),
                bend: sub(self.bend, other.bend),
            },
            Binary::Multiply => self.multiply(other),
            Binary::Divide => self.divide(other),
            Binary::Raise => self.raise(other),
            Binary::Atan2 => self.atan2(other),
            Binary::Min | Binary::Max => self.choose(other, function),
        }
    }

    fn power(self, n: i32) -> Self {
        let k = f64::from(n);
        let first = if n == 0 { N::constant(0.0) } else { times(k, self.value.power(n - 1)) };
        let second = if n == 0 || n == 1 { N::constant(0.0) } else { times(k * (k - 1.0), self.value.power(n - 2)) };
        self.chain(self.value.power(n), first, second)
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::Interval;

    const EXPRESSIONS: [&str; 12] = [
        "x*y - z**3 + 2",
        "(x + 2) / (y*y + 1) - x**-2",
        "sqrt(x*x + y*y + 1) - exp(-z)",
        "log(x*x + 0.5) + abs(y - z)",
        "sin(x) * cos(y) + tan(z/2)",
        "asin(x/2) - acos(y/3) + atan(z)",
        "sinh(x) + cosh(y) * tanh(z)",
        "min(x, y) + max(y*y, z)",
        "atan2(y + 2, x + 2.5)",
        "(x*x + 1)**(y + 0.5)",
        "(x*x + y*y)**0.25 - z",
        "(x*x + y*y + z*z + 3)**2 - 16*(x*x + y*y)",
    ];

    /// Along p + s·d.
    fn line<N: Scalar>(p: [N; 3], d: [f64; 3]) -> [Jet<N>; 3] {
        std::array::from_fn(|i| Jet::new(p[i], N::constant(d[i])))
    }

    proptest! {
        #[test]
        fn derivatives_are_those_of_differences(
            p in prop::array::uniform3(-1.4..1.4f64), d in prop::array::uniform3(-1.0..1.0f64),
        ) {
            for text in EXPRESSIONS {
                let tape = parse(text).unwrap();
                let at = |s: f64| {
                    let moved: [f64; 3] = std::array::from_fn(|i| p[i] + s * d[i]);
                    tape.value(&line(moved, d), &mut Vec::new())
                };
                let (here, h) = (at(0.0), 1e-5);
                let (a, b) = (at(-h), at(h));
                // Away from poles and from kinks, where differences do not approximate derivatives.
                let smooth = (a.slope - b.slope).abs() < 1e-2 && (a.bend - b.bend).abs() < 1e-1;
                prop_assume!(smooth && here.bend.abs() < 1e3);
                let (slope, bend) = ((b.value - a.value) / (2.0 * h), (b.slope - a.slope) / (2.0 * h));
                prop_assert!((slope - here.slope).abs() < 1e-5 * (1.0 + here.bend.abs()), "{text}");
                prop_assert!((bend - here.bend).abs() < 1e-4 * (1.0 + here.bend.abs()), "{text}");
            }
        }

        #[test]
        fn intervals_hold_values_and_derivatives(
            p in prop::array::uniform3(-1.4..1.4f64), half in prop::array::uniform3(0.0..0.5f64),
            part in prop::array::uniform3(-1.0..1.0f64), d in prop::array::uniform3(-1.0..1.0f64),
        ) {
            for text in EXPRESSIONS {
                let tape = parse(text).unwrap();
                let boxed: [Interval; 3] = std::array::from_fn(|i| Interval::new(p[i] - half[i], p[i] + half[i]));
                let at = |i: usize| (p[i] + half[i] * part[i]).clamp(boxed[i].low, boxed[i].high);
                let inside: [f64; 3] = std::array::from_fn(at);
                let held = tape.value(&line(boxed, d), &mut Vec::new());
                let exact = tape.value(&line(inside.map(Interval::point), d), &mut Vec::new());
                let rough = tape.value(&line(inside, d), &mut Vec::new());
                for (held, exact, rough) in [
                    (held.value, exact.value, rough.value),
                    (held.slope, exact.slope, rough.slope),
                    (held.bend, exact.bend, rough.bend),
                ] {
                    if exact.is_empty() || rough.is_nan() {
                        continue;
                    }
                    prop_assert!(held.low <= exact.high && exact.low <= held.high, "{text}: {held:?} {exact:?}");
                    let room = 1e-9 * (1.0 + rough.abs());
                    prop_assert!(held.low - room <= rough && rough <= held.high + room, "{text}: {held:?} {rough}");
                }
            }
        }
    }
}
