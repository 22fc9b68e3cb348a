//! Complex numbers.

use std::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex {
    /// The real part.
    pub re: f64,
    /// The imaginary part.
    pub im: f64,
}

impl Complex {
    /// Creates a number from its parts.
    #[inline]
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// |z|².
    #[inline]
    pub fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// Times a real number.
    #[inline]
    pub fn scaled(self, by: f64) -> Self {
        Self::new(self.re * by, self.im * by)
    }

    /// Square root with non-negative imaginary part: a wave with this wave number decays along its path.
    #[inline]
    pub fn sqrt(self) -> Self {
        let length = self.re.hypot(self.im);
        // The greater part first; the other is a quotient, so nothing cancels.
        let greater = (0.5 * (length + self.re.abs())).sqrt();
        if greater == 0.0 {
            return Self::new(0.0, 0.0);
        }
        let lesser = 0.5 * self.im.abs() / greater;
        let (re, im) = if self.re >= 0.0 { (greater, lesser) } else { (lesser, greater) };
        Self::new(if self.im < 0.0 { -re } else { re }, im)
    }

    /// e to the power of i times it.
    #[inline]
    pub fn turned(self) -> Self {
        let (sin, cos) = self.re.sin_cos();
        Self::new(cos, sin).scaled((-self.im).exp())
    }
}

impl From<f64> for Complex {
    #[inline]
    fn from(re: f64) -> Self {
        Self::new(re, 0.0)
    }
}

impl Add for Complex {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Mul for Complex {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}

impl Div for Complex {
    type Output = Self;

    #[inline]
    fn div(self, by: Self) -> Self {
        let square = by.square();
        Self::new((self.re * by.re + self.im * by.im) / square, (self.im * by.re - self.re * by.im) / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_square_to_what_they_are_of_and_decay() {
        for z in [[4.0, 0.0], [-4.0, 0.0], [3.0, 4.0], [-3.0, 4.0], [3.0, -4.0], [-3.0, -4.0], [0.0, 2.0], [1e-9, 1.0]]
        {
            let z = Complex::new(z[0], z[1]);
            let root = z.sqrt();
            let off = root * root - z;
            assert!(off.square().sqrt() < 1e-15 * z.square().sqrt() && root.im >= 0.0, "{z:?} {root:?}");
        }
        assert_eq!(Complex::from(-9.0).sqrt(), Complex::new(0.0, 3.0));
        assert_eq!(Complex::from(0.0).sqrt(), Complex::from(0.0));
    }

    #[test]
    fn quotients_and_powers_are_as_in_any_table() {
        let (a, b) = (Complex::new(1.0, 2.0), Complex::new(3.0, -4.0));
        assert!((a / b - Complex::new(-0.2, 0.4)).square() < 1e-32);
        assert!((Complex::new(std::f64::consts::PI, 0.0).turned() + Complex::from(1.0)).square() < 1e-30);
        assert_eq!(Complex::new(0.0, 1e4).turned(), Complex::from(0.0));
    }
}
