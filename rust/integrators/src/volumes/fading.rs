//! How much light gets through a medium on a straight way.

use super::flight::Flight;
use super::numbers::Numbers;
use super::weights::Weights;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::media::Content;

/// What carries less than this share of what it did is ended by roulette, three times of four.
const FAINT: f64 = 0.05;
const SURVIVAL: f64 = 0.25;

impl Flight<'_> {
    /// Dims light on its way, and tells with which densities a path would have come along it; `hero` is drawn where it
    /// is needed, unless it is there.
    ///
    /// Where the medium is even or its extinction is a cubic, that is closed; elsewhere it is estimated from the shares
    /// of nothing in what light meets at random, as often as in the densest medium that it could be (Novák, Selle and
    /// Jarosz, "Residual Ratio Tracking for Estimating Attenuation in Participating Media", 2014, 3.2).
    pub fn fade(&self, weights: &mut Weights, hero: &mut Option<usize>, numbers: &mut Numbers, cancel: &Cancel) {
        let scatters = self.scatters && self.medium.scatters();
        let mut start = self.span[0];
        for stretch in self.medium.stretches(&self.ray, self.span) {
            match self.content(&stretch) {
                Content::Even(here) => {
                    let left = here.left((stretch.end - start) * self.length);
                    let drawn = if self.scatters && !here.scattering.is_black() { left } else { Rgb::ONE };
                    weights.times(left, drawn, Rgb::ONE);
                }
                Content::Cubic => {
                    let left = (self.cubic_depth([start, stretch.end]) * -1.0).map(f64::exp);
                    weights.times(left, if scatters { left } else { Rgb::ONE }, Rgb::ONE);
                }
                Content::Varies(range) => {
                    let hero = *hero.get_or_insert_with(|| numbers.hero());
                    self.fade_between(range, [start, stretch.end], scatters, weights, hero, numbers, cancel);
                }
            }
            if weights.carried.is_black() {
                return;
            }
            start = stretch.end;
        }
    }

    /// Dims light on a part of its way where the extinction lies between two: by what is there at least, and by chance
    /// by what there is beside.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn fade_between(
        &self,
        [least, most]: [Rgb; 2],
        [mut t, end]: [f64; 2],
        scatters: bool,
        weights: &mut Weights,
        hero: usize,
        numbers: &mut Numbers,
        cancel: &Cancel,
    ) {
        let left = (least * (-(end - t) * self.length)).map(f64::exp);
        weights.times(left, if scatters { left } else { Rgb::ONE }, Rgb::ONE);
        let before = weights.carried.max();
        let spread = (most - least).at_least(Rgb::ZERO);
        while !cancel.is_raised() {
            let (rest, depth) = ((end - t) * self.length, numbers.depth());
            if spread[hero] * rest <= depth {
                let left = (spread * -rest).map(f64::exp);
                let by = left / left[hero];
                return weights.times(by, by, by);
            }
            let way = depth / spread[hero];
            t = (t + way / self.length).min(end);
            let left = (spread * -way).map(f64::exp);
            let met = left / (spread[hero] * left[hero]);
            let nothing = (most - self.extinction(t)).at_least(Rgb::ZERO);
            weights.times(nothing * met, if scatters { nothing * met } else { spread * met }, spread * met);
            if weights.carried.max() < FAINT * before {
                if numbers.next() >= SURVIVAL {
                    weights.carried = Rgb::ZERO;
                    return;
                }
                weights.carried /= SURVIVAL;
            }
        }
    }
}
