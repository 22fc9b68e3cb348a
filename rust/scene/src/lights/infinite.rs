//! Infinite lights: environments, suns and distant lights.

use super::{Light, LightSample, LightSampleContext};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::sync::Arc;

/// All infinite lights.
#[derive(Debug, Default)]
pub(super) struct InfiniteLights {
    lights: Vec<Arc<dyn Light>>,
    /// Conditional selection probability of each.
    probabilities: Vec<f64>,
    /// Probability of selecting an infinite light.
    share: f64,
    /// See [`InfiniteLights::own_share`].
    own_shares: Vec<f64>,
}

/// Selection probability of a constant sky if there are lights inside. In a studio with a lamp and such a sky,
/// probabilities of 0.1, 0.25, 0.5 and 0.7 gave relMSE of 1.4, 2.0, 3.9 and 7.7 thousandths.
///
/// The power of an environment grows with the scene's extent and mostly reaches distant ground. Selection by power
/// would leave next to no samples for a lamp. A small fixed share is enough, because BSDF sampling already finds a
/// smooth sky well.
const SHARE: f64 = 0.1;

/// Selection probability of light from a delta direction, which BSDF sampling never finds.
const SHARP_SHARE: f64 = 0.5;

impl InfiniteLights {
    /// Builds the list from lights with their flux and spread ([`super::Reach::Infinite`]); `others` tells whether
    /// there are lights inside.
    pub fn new(lights: Vec<(Arc<dyn Light>, f64, f64)>, others: bool) -> Self {
        let most = lights.iter().map(|(_, flux, _)| *flux).fold(0.0, f64::max);
        // Odds relative to all lights inside. Among each other they are weighted by flux.
        let odds = |share: f64| share / (1.0 - share);
        let odds = |spread: f64| odds(SHARP_SHARE) + (odds(SHARE) - odds(SHARP_SHARE)) * spread.clamp(0.0, 1.0);
        let weight = |(_, flux, spread): &(_, f64, f64)| if most > 0.0 { odds(*spread) * (flux / most) } else { 0.0 };
        let weights: Vec<f64> = lights.iter().map(weight).collect();
        let sum: f64 = weights.iter().sum();
        if sum == 0.0 {
            return Self::default();
        }
        let probabilities = weights.iter().map(|w| w / sum).collect();
        let share = if others { sum / (1.0 + sum) } else { 1.0 };
        let own = |spread: f64| if others { 1.0 - (1.0 - SHARE) * spread.clamp(0.0, 1.0) } else { 1.0 };
        let own_shares = lights.iter().map(|(_, _, spread)| own(*spread)).collect();
        let lights = lights.into_iter().map(|(light, ..)| light).collect();
        Self { lights, probabilities, share, own_shares }
    }

    /// Returns whether there is none.
    pub fn is_dark(&self) -> bool {
        self.lights.is_empty()
    }

    /// The lights.
    #[inline]
    pub fn lights(&self) -> &[Arc<dyn Light>] {
        &self.lights
    }

    /// Probability of sampling this light when all lights are sampled one by one. A light that BSDF sampling finds well
    /// needs few shadow rays.
    #[inline]
    pub fn own_share(&self, one: usize) -> f64 {
        self.own_shares[one]
    }

    /// Probability of selecting an infinite light rather than a light inside.
    #[inline]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Sum of all radiance along a direction.
    #[inline]
    pub fn radiance(&self, direction: DVec3, waves: Option<&Waves>) -> Rgb {
        self.lights.iter().map(|light| light.infinite_radiance_at(direction, waves)).sum()
    }

    /// The density of [`InfiniteLights::sample`].
    #[inline]
    pub fn pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        let each = self.lights.iter().zip(&self.probabilities);
        each.map(|(light, probability)| probability * light.infinite_pdf(receiver, direction)).sum()
    }

    /// Selects a light by a number in [0, 1).
    #[inline]
    pub fn choose(&self, mut choice: f64) -> usize {
        let mut chosen = 0;
        while chosen + 1 < self.lights.len() && choice >= self.probabilities[chosen] {
            choice -= self.probabilities[chosen];
            chosen += 1;
        }
        chosen
    }

    /// Conditional selection probability of a light.
    #[inline]
    pub fn probability(&self, one: usize) -> f64 {
        self.probabilities[one]
    }

    /// Samples one of the lights. Other lights may emit along the same direction, so density and radiance are those of
    /// all.
    #[inline]
    pub fn sample(&self, receiver: &LightSampleContext, choice: f64, u: [f64; 2]) -> Option<LightSample> {
        self.sample_of(self.choose(choice), receiver, u)
    }

    /// Samples a given light.
    #[inline]
    pub fn sample_of(&self, chosen: usize, receiver: &LightSampleContext, u: [f64; 2]) -> Option<LightSample> {
        let probability = self.probabilities[chosen];
        if probability == 0.0 {
            return None;
        }
        let sample = self.lights[chosen].sample(receiver, u)?;
        if self.lights.len() == 1 || sample.pdf == f64::INFINITY {
            return Some(sample.chosen(probability));
        }
        let pdf = self.pdf(receiver, sample.direction);
        (pdf > 0.0).then(|| LightSample {
            weight: self.radiance(sample.direction, receiver.waves.as_ref()) / pdf,
            pdf,
            ..sample
        })
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.probabilities.as_slice())
            + size_of_val(self.own_shares.as_slice())
            + self.lights.iter().map(|light| light.bytes()).sum::<usize>()
    }
}
