//! Numbers on a grid, for all colours alike or for each of its own.

use super::Values;
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

    /// The greatest number of each colour in each of so many equal blocks of the unit cube, the last axis fastest.
    pub fn greatest(&self, blocks: [usize; 3]) -> Vec<[f32; 3]> {
        match self {
            Self::Grey(values) => values.greatest(blocks).into_iter().map(|[most]| [most; 3]).collect(),
            Self::Coloured(values) => values.greatest(blocks),
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
