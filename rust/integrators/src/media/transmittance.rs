//! Transmittance along ray segments.

use super::distance_sampling::MediumSegment;
use super::path_numbers::FurtherNumbers;
use super::spectral_mis::Weights;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::media::Content;

/// Roulette terminates light below this share of its initial value, with the probability 3/4.
const FAINT: f64 = 0.05;
const SURVIVAL: f64 = 0.25;
/// The optical depth of that share, −ln 0.05, and the one beyond which transmittance underflows in f64.
const FAINT_DEPTH: f64 = 2.995_732_273_553_991;
const LAST_DEPTH: f64 = 746.0;

impl MediumSegment<'_> {
    /// Attenuate light along the segment, and update the densities of sampling it by distance. `hero` is drawn when
    /// needed, unless given.
    ///
    /// Homogeneous media and cubic extinction have closed forms. Elsewhere, ratio tracking multiplies by the share of
    /// null collisions at points sampled with the majorant (Novák, Selle and Jarosz, "Residual Ratio Tracking for
    /// Estimating Attenuation in Participating Media", 2014, 3.2). If an end of the segment was sampled in a medium,
    /// roulette terminates faint light. Its error is far below that of the sampled point, and most such segments lead
    /// through a whole cloud.
    pub fn fade(&self, weights: &mut Weights, hero: &mut Option<usize>, numbers: &mut FurtherNumbers, cancel: &Cancel) {
        let scatters = self.scatters && self.medium.scatters();
        let mut start = self.span[0];
        // Optical depth of consecutive cells.
        let mut passed = Rgb::ZERO;
        for stretch in self.medium.stretches(&self.ray, self.span) {
            let span = [start, stretch.end];
            start = stretch.end;
            let content = self.content(&stretch);
            if let Content::Cubic = content {
                passed += self.cubic_depth(span);
                let is_faint = self.roulette && passed.min() > FAINT_DEPTH || passed.min() > LAST_DEPTH;
                if !is_faint {
                    continue;
                }
            }
            Self::fade_by(&mut passed, weights, scatters);
            match content {
                Content::Even(here) => {
                    let left = here.left((span[1] - span[0]) * self.length);
                    let drawn = if self.scatters && !here.scattering.is_black() { left } else { Rgb::ONE };
                    weights.times(left, drawn, Rgb::ONE);
                }
                Content::Cubic if self.roulette => survive(weights, numbers),
                Content::Cubic => {}
                Content::Varies(range) => {
                    let hero = *hero.get_or_insert_with(|| numbers.hero());
                    self.fade_between(range, span, scatters, weights, hero, numbers, cancel);
                }
            }
            if weights.carried.is_black() {
                return;
            }
        }
        Self::fade_by(&mut passed, weights, scatters);
    }

    /// Attenuate light by the optical depth of the passed cells.
    fn fade_by(passed: &mut Rgb, weights: &mut Weights, scatters: bool) {
        let passed = std::mem::replace(passed, Rgb::ZERO);
        if !passed.is_black() {
            let left = (passed * -1.0).map(f64::exp);
            weights.times(left, if scatters { left } else { Rgb::ONE }, Rgb::ONE);
        }
    }

    /// Attenuate light where the extinction lies between two bounds: analytically by the lower bound, and by ratio
    /// tracking for the rest.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn fade_between(
        &self,
        [least, most]: [Rgb; 2],
        [mut t, end]: [f64; 2],
        scatters: bool,
        weights: &mut Weights,
        hero: usize,
        numbers: &mut FurtherNumbers,
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
                survive(weights, numbers);
                if weights.carried.is_black() {
                    return;
                }
            }
        }
    }
}

/// Play one round of roulette.
fn survive(weights: &mut Weights, numbers: &mut FurtherNumbers) {
    if numbers.next() < SURVIVAL {
        weights.carried /= SURVIVAL;
    } else {
        weights.carried = Rgb::ZERO;
    }
}
