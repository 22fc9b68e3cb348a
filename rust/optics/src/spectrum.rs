//! RGB colors.

use glam::{DVec3, Vec3};
use raywright_base::math::{InLanes, VectorLanes};
use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign};

/// Linear Rec. 709 red, green and blue: radiance, reflectance or throughput, by context.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Rgb(DVec3);

impl Rgb {
    /// Black.
    pub const ZERO: Self = Self::splat(0.0);
    /// White.
    pub const ONE: Self = Self::splat(1.0);

    /// Converts to an f32 vector.
    #[inline(always)]
    pub fn as_vec3(self) -> Vec3 {
        self.0.as_vec3()
    }

    /// Creates a color from its channels.
    #[inline(always)]
    pub const fn new(red: f64, green: f64, blue: f64) -> Self {
        Self(DVec3::new(red, green, blue))
    }

    /// Each channel with the sign of another's.
    #[inline(always)]
    pub fn copysign(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }

    /// The same value in all channels.
    #[inline(always)]
    pub const fn splat(value: f64) -> Self {
        Self(DVec3::splat(value))
    }

    /// Creates a color from its channels.
    #[inline(always)]
    pub const fn from_array(channels: [f64; 3]) -> Self {
        Self(DVec3::from_array(channels))
    }

    /// The channels.
    #[inline(always)]
    pub const fn to_array(self) -> [f64; 3] {
        self.0.to_array()
    }

    /// Branch-free selection.
    #[inline(always)]
    pub fn select(first: bool, a: Self, b: Self) -> Self {
        Self(raywright_base::math::select(first, a.0, b.0))
    }

    /// Mean of the channels.
    #[inline(always)]
    pub fn mean(self) -> f64 {
        self.0.element_sum() / 3.0
    }

    /// Sum of the channels.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        self.0.element_sum()
    }

    /// Dot product of the channels.
    #[inline(always)]
    pub fn dot(self, other: Self) -> f64 {
        self.0.dot(other.0)
    }

    /// Greatest channel.
    #[inline(always)]
    pub fn max(self) -> f64 {
        self.0.max_element()
    }

    /// Least channel.
    #[inline(always)]
    pub fn min(self) -> f64 {
        self.0.min_element()
    }

    /// Returns whether all channels are 0.
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self.0 == DVec3::ZERO
    }

    /// Returns whether no channel is NaN or infinite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Returns whether all channels are finite and not negative.
    #[inline(always)]
    pub fn is_radiance(self) -> bool {
        self.0.is_finite() && self.0.cmpge(DVec3::ZERO).all()
    }

    /// Maximum of both, per channel.
    #[inline(always)]
    pub fn at_least(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// Minimum of both, per channel.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// Clamps each channel.
    #[inline(always)]
    pub fn clamp(self, least: Self, most: Self) -> Self {
        Self(self.0.clamp(least.0, most.0))
    }

    /// Absolute value, per channel.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// Reciprocal, per channel.
    #[inline(always)]
    pub fn recip(self) -> Self {
        Self(self.0.recip())
    }

    /// Square root, per channel.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Maps a function over the channels.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(f(self.0.x), f(self.0.y), f(self.0.z))
    }

    /// CIE luminance.
    #[inline(always)]
    pub fn luminance(self) -> f64 {
        self.0.dot(DVec3::new(0.212_639, 0.715_169, 0.072_192))
    }
}

/// Colors, one per lane.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct RgbLanes(VectorLanes);

impl RgbLanes {
    /// Black in every lane.
    pub const ZERO: Self = Self(VectorLanes::ZERO);

    /// The color of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Rgb {
        Rgb(self.0.get(lane))
    }

    /// Sets the color of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, colour: Rgb) {
        self.0.set(lane, colour.0);
    }
}

impl InLanes for Rgb {
    type Lanes = RgbLanes;
    const EMPTY: RgbLanes = RgbLanes::ZERO;

    #[inline(always)]
    fn get(lanes: &RgbLanes, lane: usize) -> Self {
        lanes.get(lane)
    }

    #[inline(always)]
    fn put(&self, lanes: &mut RgbLanes, lane: usize) {
        lanes.set(lane, *self);
    }
}

impl Index<usize> for Rgb {
    type Output = f64;

    #[inline(always)]
    fn index(&self, channel: usize) -> &f64 {
        &self.0[channel]
    }
}

impl IndexMut<usize> for Rgb {
    #[inline(always)]
    fn index_mut(&mut self, channel: usize) -> &mut f64 {
        &mut self.0[channel]
    }
}

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Arithmetic, per channel.
macro_rules! arithmetic {
    ($($of:ident $by:ident $assign:ident $assigned:ident,)+) => {
        $(impl $of for Rgb {
            type Output = Self;

            #[inline(always)]
            fn $by(self, other: Self) -> Self {
                Self($of::$by(self.0, other.0))
            }
        }

        impl $of<f64> for Rgb {
            type Output = Self;

            #[inline(always)]
            fn $by(self, other: f64) -> Self {
                Self($of::$by(self.0, other))
            }
        }

        impl $of<Rgb> for f64 {
            type Output = Rgb;

            #[inline(always)]
            fn $by(self, other: Rgb) -> Rgb {
                Rgb($of::$by(self, other.0))
            }
        }

        impl $assign for Rgb {
            #[inline(always)]
            fn $assigned(&mut self, other: Self) {
                $assign::$assigned(&mut self.0, other.0);
            }
        }

        impl $assign<f64> for Rgb {
            #[inline(always)]
            fn $assigned(&mut self, other: f64) {
                $assign::$assigned(&mut self.0, other);
            }
        })+
    };
}

arithmetic! {
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign,
}

impl Neg for Rgb {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Sum for Rgb {
    #[inline]
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::ZERO, |sum, one| sum + one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_luminance_one() {
        assert!((Rgb::ONE.luminance() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn light_is_finite_and_not_negative() {
        assert!(Rgb::new(0.0, -0.0, f64::MAX).is_radiance());
        for bad in [f64::NAN, f64::INFINITY, -1e-300] {
            assert!(!Rgb::new(1.0, bad, 1.0).is_radiance());
        }
    }
}
