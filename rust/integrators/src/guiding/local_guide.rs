//! Guided sampling of directions at a place.

use super::cells::GuidingCell;
use raywright_base::math::{DVec3, LANES};
use raywright_base::simd::Level;

/// The distribution of guided directions at a place: a mixture of cones to spheres.
#[derive(Clone, Copy, Debug)]
pub struct LocalGuide<'a> {
    cell: GuidingCell<'a>,
    place: DVec3,
}

impl<'a> LocalGuide<'a> {
    /// Make the distribution at a place in a cell.
    #[inline]
    pub(super) fn new(cell: GuidingCell<'a>, place: DVec3) -> Self {
        Self { cell, place }
    }

    /// Return the optimal probability of guided sampling instead of BSDF sampling.
    #[inline]
    pub fn share(&self) -> f64 {
        self.cell.share
    }

    /// Return the brightness of the light through specular surfaces relative to direct light.
    #[inline]
    pub fn gain(&self) -> f64 {
        self.cell.gain
    }

    /// Return the variance of the light through specular surfaces with BSDF sampling alone, over the squared sum of
    /// that light and direct light.
    pub fn rarity(&self) -> f64 {
        self.cell.rarity
    }

    /// Sample a direction: `choice` selects a sphere and `u` a direction to it, all uniform in [0, 1).
    #[inline]
    pub fn sample(&self, mut choice: f64, u: [f64; 2]) -> DVec3 {
        let GuidingCell { lobes, count, .. } = self.cell;
        // Probabilities sum to 1 except for rounding.
        let last = count - 1;
        let mut chosen = last;
        for lobe in 0..last {
            let share = lobes[lobe / LANES].share(lobe % LANES);
            if choice < share {
                chosen = lobe;
                break;
            }
            choice -= share;
        }
        lobes[chosen / LANES].get(chosen % LANES).sample(self.place, u)
    }

    /// Return the density per solid angle of a unit direction in [`LocalGuide::sample`].
    #[inline]
    pub fn pdf(&self, level: Level, direction: DVec3) -> f64 {
        self.cell.lobes.iter().fold(0.0, |sum, lobes| lobes.add_pdf(level, self.place, direction, sum))
    }
}
