//! Directions towards where light comes from.

use super::cells::Cell;
use raywright_base::math::{DVec3, LANES};
use raywright_base::simd::Level;

/// Directions from a place towards where light comes from: those to one of several balls.
#[derive(Clone, Copy, Debug)]
pub struct LocalGuide<'a> {
    cell: Cell<'a>,
    place: DVec3,
}

impl<'a> LocalGuide<'a> {
    /// Those from a place in a cell.
    #[inline]
    pub(super) fn new(cell: Cell<'a>, place: DVec3) -> Self {
        Self { cell, place }
    }

    /// How often it is worth while to aim, rather than to leave it to the surface.
    #[inline]
    pub fn share(&self) -> f64 {
        self.cell.share
    }

    /// How much brighter than others the place is, for the light that comes to it by way of what is sharp.
    #[inline]
    pub fn gain(&self) -> f64 {
        self.cell.gain
    }

    /// How much the light that comes by way of what is sharp varies among samples of surfaces that do not aim, over the
    /// square of what comes straight and so together.
    pub fn rarity(&self) -> f64 {
        self.cell.rarity
    }

    /// Draws a direction: `choice` among the balls, `u` of those to one, all uniform in [0, 1).
    #[inline]
    pub fn sample(&self, mut choice: f64, u: [f64; 2]) -> DVec3 {
        let Cell { lobes, count, .. } = self.cell;
        // Shares add up to 1 but for roundings.
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

    /// The density in solid angle with which [`LocalGuide::sample`] draws a unit direction.
    #[inline]
    pub fn pdf(&self, level: Level, direction: DVec3) -> f64 {
        self.cell.lobes.iter().fold(0.0, |sum, lobes| lobes.add_pdf(level, self.place, direction, sum))
    }
}
