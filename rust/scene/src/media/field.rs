//! Grids of gray or RGB numbers.

use super::{Cubic, Values};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// Numbers on a grid over the unit cube, gray or RGB.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// One number for all channels.
    Grey(Values<1>),
    /// One number per channel.
    Coloured(Values<3>),
}

impl Field {
    /// Returns whether it is RGB.
    pub fn is_coloured(&self) -> bool {
        matches!(self, Self::Coloured(_))
    }

    /// Number of values along each axis.
    pub fn size(&self) -> [usize; 3] {
        match self {
            Self::Grey(values) => values.size(),
            Self::Coloured(values) => values.size(),
        }
    }

    /// Interpolated value at a point of the unit cube; points outside are clamped to it.
    #[inline]
    pub fn at(&self, point: DVec3) -> Rgb {
        match self {
            Self::Grey(values) => Rgb::splat(values.value(point)[0]),
            Self::Coloured(values) => Rgb::from_array(values.value(point)),
        }
    }

    /// Interpolated values between two points in the same cell, as a polynomial.
    #[inline]
    pub fn cubic(&self, ends: [DVec3; 2]) -> Cubic {
        match self {
            Self::Grey(values) => {
                let [[a], [b], [c], [d]] = values.cubic(ends);
                Cubic([Rgb::splat(a), Rgb::splat(b), Rgb::splat(c), Rgb::splat(d)])
            }
            Self::Coloured(values) => {
                let [a, b, c, d] = values.cubic(ends);
                Cubic([Rgb::from_array(a), Rgb::from_array(b), Rgb::from_array(c), Rgb::from_array(d)])
            }
        }
    }

    /// Minimum and maximum of each channel in equal blocks of the unit cube, the last axis fastest.
    pub fn ranges(&self, blocks: [usize; 3]) -> Vec<[[f32; 3]; 2]> {
        match self {
            Self::Grey(values) => values.ranges(blocks).map(|range| range.map(|[one]| [one; 3])).collect(),
            Self::Coloured(values) => values.ranges(blocks).collect(),
        }
    }

    /// Grid coordinates along an axis as a linear function of the unit cube: their values at 0 and at 1. Cell borders
    /// are the integers from 0 to that of the last value.
    pub fn steps(&self, axis: usize) -> [f64; 2] {
        match self {
            Self::Grey(values) => values.line(axis),
            Self::Coloured(values) => values.line(axis),
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Grey(values) => values.bytes(),
            Self::Coloured(values) => values.bytes(),
        }
    }
}
