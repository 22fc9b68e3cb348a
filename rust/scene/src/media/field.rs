//! Numbers on a grid, for all colours alike or for each of its own.

use super::{Cubic, Values};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// Numbers on a grid over the unit cube, for all colours alike or for each of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// One for all colours.
    Grey(Values<1>),
    /// One for each.
    Coloured(Values<3>),
}

impl Field {
    /// Whether colours have numbers of their own.
    pub fn is_coloured(&self) -> bool {
        matches!(self, Self::Coloured(_))
    }

    /// How many numbers there are along each axis.
    pub fn size(&self) -> [usize; 3] {
        match self {
            Self::Grey(values) => values.size(),
            Self::Coloured(values) => values.size(),
        }
    }

    /// What is at a point of the unit cube, of which one outside counts as the nearest within.
    #[inline]
    pub fn at(&self, point: DVec3) -> Rgb {
        match self {
            Self::Grey(values) => Rgb::splat(values.value(point)[0]),
            Self::Coloured(values) => Rgb::from_array(values.value(point)),
        }
    }

    /// What is between two points of the unit cube that lie in one cell.
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

    /// The least and the greatest number of each colour in each of so many equal blocks of the unit cube, the last axis
    /// fastest.
    pub fn ranges(&self, blocks: [usize; 3]) -> Vec<[[f32; 3]; 2]> {
        match self {
            Self::Grey(values) => values.ranges(blocks).map(|range| range.map(|[one]| [one; 3])).collect(),
            Self::Coloured(values) => values.ranges(blocks).collect(),
        }
    }

    /// Steps of the grid along an axis as a linear function of a coordinate of the unit cube: its value at 0 and at 1.
    /// Cells end where it is a whole number, from 0 to that of the last number.
    pub fn steps(&self, axis: usize) -> [f64; 2] {
        match self {
            Self::Grey(values) => values.line(axis),
            Self::Coloured(values) => values.line(axis),
        }
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Grey(values) => values.bytes(),
            Self::Coloured(values) => values.bytes(),
        }
    }
}
