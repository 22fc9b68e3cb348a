//! What fills space: one interface over all media.

mod block_walk;
mod blocks;
mod coefficients;
mod cubic;
mod field;
mod glow;
mod grid;
mod homogeneous;
mod stretch;
mod values;
mod waved;
mod waved_grid;

pub use blocks::{Blocks, Building};
pub use coefficients::Coefficients;
pub use cubic::Cubic;
pub use field::Field;
pub use glow::Glow;
pub use grid::GridMedium;
pub use homogeneous::Homogeneous;
pub use stretch::{Content, Stretch};
pub use values::{At, Values};
pub use waved::WavedMedium;
pub use waved_grid::WavedGrid;

use block_walk::BlockWalk;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::Waves;
use raywright_optics::{Phase, Rgb};
use std::fmt::Debug;

/// What fills space, and dims and scatters light on its way.
///
/// Coefficients are per unit of length in the world. Where a medium differs from place to place, places are those of
/// the space that its shape is described in, which is not the world's in an instance.
pub trait Medium: Debug + Send + Sync {
    /// How it scatters.
    fn phase(&self) -> Phase;

    /// Whether it scatters anything anywhere.
    fn scatters(&self) -> bool;

    /// Whether it gives off light anywhere by itself.
    fn glows(&self) -> bool;

    /// Whether it is the same everywhere.
    fn is_even(&self) -> bool {
        false
    }

    /// What lies on a ray, one stretch after the other, between two `t` of it.
    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_>;

    /// The same in red, green and blue, where that may be in more and shorter stretches with closed forms.
    fn closed_stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.stretches(ray, span)
    }

    /// What there is at a point.
    fn at(&self, point: DVec3) -> Coefficients;

    /// The extinction at a point.
    fn extinction(&self, point: DVec3) -> Rgb {
        self.at(point).extinction
    }

    /// The extinction between two points where that is a polynomial of the third degree.
    fn cubic(&self, [from, to]: [DVec3; 2]) -> Cubic {
        let at = |share: f64| self.extinction(from + (to - from) * share);
        Cubic::through([at(0.0), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0)])
    }

    /// What there is at a point, at a path's wavelengths, where it is told by wavelength.
    fn at_waves(&self, point: DVec3, waves: &Waves) -> Coefficients {
        self.by_waves(self.at(point), waves)
    }

    /// What there is at a point is this, at a path's wavelengths, where it is told by wavelength.
    fn by_waves(&self, here: Coefficients, _waves: &Waves) -> Coefficients {
        here
    }

    /// The same of the least extinction in a stretch, or less.
    fn least_by_waves(&self, _least: Rgb, _waves: &Waves) -> Rgb {
        Rgb::ZERO
    }

    /// The same of the greatest extinction in a stretch.
    fn most_by_waves(&self, most: Rgb, _waves: &Waves) -> Rgb {
        most
    }

    /// Whether it is told by wavelength.
    fn has_waves(&self) -> bool {
        false
    }

    /// The memory held.
    fn bytes(&self) -> usize;
}

/// All stretches of a ray through a medium.
#[derive(Clone, Debug)]
pub struct Stretches<'m>(Kind<'m>);

#[derive(Clone, Debug)]
enum Kind<'m> {
    Whole(Option<Stretch>),
    Blocks(BlockWalk<'m>),
}

impl<'m> Stretches<'m> {
    /// One, from end to end.
    fn whole(stretch: Stretch) -> Self {
        Self(Kind::Whole(Some(stretch)))
    }

    /// Those of blocks.
    fn blocks(walk: BlockWalk<'m>) -> Self {
        Self(Kind::Blocks(walk))
    }
}

impl Iterator for Stretches<'_> {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        match &mut self.0 {
            Kind::Whole(stretch) => stretch.take(),
            Kind::Blocks(walk) => walk.next(),
        }
    }
}
