//! Parts of rays along which the extinction of a medium is a polynomial of the third degree, as in the cells of a grid.
//!
//! Optical depths are closed there: by the rule of Gauss and Legendre for two points, which is exact for such
//! polynomials.

use super::flight::{Collision, Flight};
use super::numbers::Numbers;
use super::weights::Weights;
use raywright_optics::Rgb;

/// Where the rule has its points, from −1 to 1: ± 1/√3.
const POINT: f64 = 0.577_350_269_189_625_8;

impl Flight<'_> {
    /// The optical depth between two `t` of such a part.
    #[inline]
    pub(super) fn cubic_depth(&self, [start, end]: [f64; 2]) -> Rgb {
        let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
        let sum = self.extinction(middle - POINT * half) + self.extinction(middle + POINT * half);
        sum * (half * self.length)
    }

    /// Draws how far it gets in such a part, as [`Flight::fly`] does.
    pub(super) fn fly_through_cell(
        &self,
        span: [f64; 2],
        weights: &mut Weights,
        (hero, depth): (usize, &mut f64),
        numbers: &mut Numbers,
        light: &mut Rgb,
    ) -> Option<Collision> {
        let [start, end] = span;
        if self.medium.glows() {
            // What glows at a point drawn evenly, dimmed on its way from the start.
            let t = start + (end - start) * numbers.next();
            let left = (self.cubic_depth([start, t]) * -1.0).map(f64::exp);
            *light += weights.throughput() * self.at(t).emission * left * ((end - start) * self.length);
        }
        let whole = self.cubic_depth(span);
        if !(self.scatters && self.medium.scatters()) {
            weights.carried *= (whole * -1.0).map(f64::exp);
            return None;
        }
        if whole[hero] > *depth {
            let t = self.reach(span, hero, *depth);
            let (here, left) = (self.at(t), (self.cubic_depth([start, t]) * -1.0).map(f64::exp));
            if here.extinction[hero] <= 0.0 {
                // Rounding has put it beside what it meets, into nothing.
                weights.carried = Rgb::ZERO;
                return None;
            }
            let by = left / (here.extinction[hero] * left[hero]);
            let came = weights.carried * by;
            weights.times(here.scattering * by, here.extinction * by, Rgb::ONE);
            return Some(Collision { t, density: None, here, came });
        }
        *depth -= whole[hero];
        let left = (whole * -1.0).map(f64::exp);
        let by = left / left[hero];
        weights.times(by, by, Rgb::splat(1.0 / left[hero]));
        None
    }

    /// Where an optical depth is reached that is less than that of all of such a part: by Newton's method, kept between
    /// bounds that close in on it.
    fn reach(&self, [start, end]: [f64; 2], hero: usize, depth: f64) -> f64 {
        /// Far more than are ever needed: from the 60th halving on nothing is left between the bounds.
        const MOST: u32 = 100;
        let (mut low, mut high) = (start, end);
        let mut t = 0.5 * (low + high);
        for _ in 0..MOST {
            let off = self.cubic_depth([start, t])[hero] - depth;
            if off < 0.0 {
                low = t;
            } else {
                high = t;
            }
            let slope = self.extinction(t)[hero] * self.length;
            let newton = t - off / slope;
            let next = if (low..=high).contains(&newton) { newton } else { 0.5 * (low + high) };
            let is_found = (next - t).abs() <= 1e-14 * (end - start);
            t = next;
            if is_found && self.extinction(t)[hero] > 0.0 {
                break;
            }
        }
        t
    }
}
