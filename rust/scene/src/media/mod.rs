//! Participating media: one interface, and one file each.

mod block_walk;
mod blocks;
mod coefficients;
mod cubic;
mod field;
mod grid;
mod grid_emission;
mod homogeneous;
mod spectral_grid;
mod spectral_medium;
mod stretch;
mod values;

pub use blocks::{Blocks, Building};
pub use coefficients::Coefficients;
pub use cubic::Cubic;
pub use field::Field;
pub use grid::GridMedium;
pub use grid_emission::Glow;
pub use homogeneous::Homogeneous;
pub use spectral_grid::WavedGrid;
pub use spectral_medium::WavedMedium;
pub use stretch::{Content, Stretch};
pub use values::{At, Values};

use block_walk::BlockWalk;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::Waves;
use raywright_optics::{Phase, Rgb};
use std::fmt::Debug;

/// A participating medium.
///
/// Coefficients are per unit length in world space. Positions of a heterogeneous medium are in the space where its
/// shape is described, which for an instance is the prototype's.
pub trait Medium: Debug + Send + Sync {
    /// Phase function.
    fn phase(&self) -> Phase;

    /// Returns whether the medium scatters anywhere.
    fn scatters(&self) -> bool;

    /// Returns whether the medium emits anywhere.
    fn glows(&self) -> bool;

    /// Returns whether the medium is homogeneous.
    fn is_even(&self) -> bool {
        false
    }

    /// Consecutive segments of a ray between two `t`.
    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_>;

    /// Segments for RGB rendering; there may be more and shorter ones, with closed forms.
    fn closed_stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.stretches(ray, span)
    }

    /// Coefficients at a point.
    fn at(&self, point: DVec3) -> Coefficients;

    /// Extinction at a point.
    fn extinction(&self, point: DVec3) -> Rgb {
        self.at(point).extinction
    }

    /// Extinction between two points as a polynomial, where it is cubic.
    fn cubic(&self, [from, to]: [DVec3; 2]) -> Cubic {
        let at = |share: f64| self.extinction(from + (to - from) * share);
        Cubic::through([at(0.0), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0)])
    }

    /// Coefficients at a point at a path's wavelengths, if the medium is spectral.
    fn at_waves(&self, point: DVec3, waves: &Waves) -> Coefficients {
        self.by_waves(self.at(point), waves)
    }

    /// Converts coefficients at a point to a path's wavelengths, if the medium is spectral.
    fn by_waves(&self, here: Coefficients, _waves: &Waves) -> Coefficients {
        here
    }

    /// Converts the minimum extinction of a segment, or a lower bound.
    fn least_by_waves(&self, _least: Rgb, _waves: &Waves) -> Rgb {
        Rgb::ZERO
    }

    /// Converts the maximum extinction of a segment.
    fn most_by_waves(&self, most: Rgb, _waves: &Waves) -> Rgb {
        most
    }

    /// Returns whether the medium is spectral.
    fn has_waves(&self) -> bool {
        false
    }

    /// Memory in bytes.
    fn bytes(&self) -> usize;
}

/// Iterator over the segments of a ray through a medium.
#[derive(Clone, Debug)]
pub struct Stretches<'m>(MediumKind<'m>);

#[derive(Clone, Debug)]
enum MediumKind<'m> {
    Whole(Option<Stretch>),
    Blocks(BlockWalk<'m>),
}

impl<'m> Stretches<'m> {
    /// A single segment.
    pub fn whole(stretch: Stretch) -> Self {
        Self(MediumKind::Whole(Some(stretch)))
    }

    /// The segments of a block traversal.
    fn blocks(walk: BlockWalk<'m>) -> Self {
        Self(MediumKind::Blocks(walk))
    }
}

impl Iterator for Stretches<'_> {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        match &mut self.0 {
            MediumKind::Whole(stretch) => stretch.take(),
            MediumKind::Blocks(walk) => walk.next(),
        }
    }
}
