//! Ray segments with cubic extinction, as in grid cells.
//!
//! Their optical depth has a closed form.

use super::distance_sampling::{Collision, MediumSegment};
use super::path_numbers::FurtherNumbers;
use super::spectral_mis::Weights;
use raywright_optics::Rgb;
use raywright_scene::media::Cubic;

impl MediumSegment<'_> {
    /// Return the extinction between two `t` of a segment.
    #[inline]
    fn cubic(&self, [start, end]: [f64; 2]) -> Cubic {
        match &self.waves {
            None => self.medium.cubic([self.ray.at(start), self.ray.at(end)]),
            Some(_) => {
                let at = |share: f64| self.extinction(start + (end - start) * share);
                Cubic::through([at(0.0), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0)])
            }
        }
    }

    /// Return the optical depth between two `t` of a segment.
    #[inline]
    pub(crate) fn cubic_depth(&self, [start, end]: [f64; 2]) -> Rgb {
        self.cubic([start, end]).mean() * self.way(start, end)
    }

    /// Sample a collision in a segment as [`MediumSegment::fly`] does. `passed` accumulates the optical depth of
    /// consecutive segments, which the weights do not include yet.
    pub(crate) fn fly_through_cell(
        &self,
        span: [f64; 2],
        passed: &mut Rgb,
        weights: &mut Weights,
        (hero, depth): (usize, &mut f64),
        numbers: &mut FurtherNumbers,
        light: &mut Rgb,
    ) -> Option<Collision> {
        let [start, end] = span;
        let (cubic, way) = (self.cubic(span), self.way(start, end));
        if self.medium.glows() {
            // Emission is sampled at a uniform point and attenuated from the start.
            self.leave_cells(passed, weights, hero);
            let share = numbers.next();
            let left = (cubic.up_to(share) * -way).map(f64::exp);
            *light += weights.throughput() * self.at(start + (end - start) * share).emission * left * way;
        }
        let whole = cubic.mean() * way;
        if !(self.scatters && self.medium.scatters()) {
            *passed += whole;
            return None;
        }
        if whole[hero] > *depth {
            self.leave_cells(passed, weights, hero);
            let share = cubic.reach(hero, *depth / way);
            let t = (start + (end - start) * share).min(end);
            let (here, left) = (self.at(t), (cubic.up_to(share) * -way).map(f64::exp));
            if here.extinction[hero] <= 0.0 {
                // Rounding has placed it next to the collision, where extinction is zero.
                weights.carried = Rgb::ZERO;
                return None;
            }
            let by = left / (here.extinction[hero] * left[hero]);
            let came = weights.carried * by;
            weights.times(here.scattering * by, here.extinction * by, Rgb::ONE);
            return Some(Collision { t, density: None, here, came });
        }
        *depth -= whole[hero];
        *passed += whole;
        None
    }

    /// Apply the accumulated optical depth to the weights.
    pub(crate) fn leave_cells(&self, passed: &mut Rgb, weights: &mut Weights, hero: usize) {
        let passed = std::mem::replace(passed, Rgb::ZERO);
        if passed.is_black() {
            return;
        }
        let left = (passed * -1.0).map(f64::exp);
        if self.scatters && self.medium.scatters() {
            let by = left / left[hero];
            weights.times(by, by, Rgb::splat(1.0 / left[hero]));
        } else {
            weights.carried *= left;
        }
    }
}
