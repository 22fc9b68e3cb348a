//! What comes from outside a scene: environments, suns, distant lights.

use super::{Light, LightSample, LightSampleContext};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::sync::Arc;

/// All lights that shine from outside.
#[derive(Debug, Default)]
pub(super) struct InfiniteLights {
    lights: Vec<Arc<dyn Light>>,
    /// With which probability each is chosen, given that one is.
    probabilities: Vec<f64>,
    /// With which one is.
    share: f64,
    /// See [`InfiniteLights::own_share`].
    own_shares: Vec<f64>,
}

/// How often the sky is chosen where there are lights inside, if it is the same everywhere. In a studio with a lamp and
/// such a sky, shares of 0.1, 0.25, 0.5 and 0.7 gave relMSE of 1.4, 2.0, 3.9 and 7.7 thousandths.
///
/// What an environment sends into a scene grows with the scene's extent, and falls mostly on floors far away: chosen by
/// its power, it would leave next to nothing for a lamp. It needs no more than a fixed share, since scattering finds it
/// well by itself.
const SHARE: f64 = 0.1;

/// The share of light that comes from a single direction, which scattering never finds.
const SHARP_SHARE: f64 = 0.5;

impl InfiniteLights {
    /// Lights with their flux and spread ([`super::Reach::Infinite`]), where there are others inside or not.
    pub fn new(lights: Vec<(Arc<dyn Light>, f64, f64)>, others: bool) -> Self {
        let most = lights.iter().map(|(_, flux, _)| *flux).fold(0.0, f64::max);
        // Odds beside all that is inside. Among each other they go by their flux.
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

    /// Whether there is none.
    pub fn is_dark(&self) -> bool {
        self.lights.is_empty()
    }

    /// Each of them.
    #[inline]
    pub fn lights(&self) -> &[Arc<dyn Light>] {
        &self.lights
    }

    /// How often one is asked where each of all lights is. What is found well by scattering need not be, and would take
    /// the shadow ray from what is not.
    #[inline]
    pub fn own_share(&self, one: usize) -> f64 {
        self.own_shares[one]
    }

    /// How often one of them is to be chosen rather than a light inside.
    #[inline]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The sum of all radiance along a direction.
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

    /// Which of them is chosen by a number in [0, 1).
    #[inline]
    pub fn choose(&self, mut choice: f64) -> usize {
        let mut chosen = 0;
        while chosen + 1 < self.lights.len() && choice >= self.probabilities[chosen] {
            choice -= self.probabilities[chosen];
            chosen += 1;
        }
        chosen
    }

    /// The probability of one, given that one is chosen.
    #[inline]
    pub fn probability(&self, one: usize) -> f64 {
        self.probabilities[one]
    }

    /// Draws light from one of them. Where several may have been the one, the density is that of all, and so is the
    /// radiance.
    #[inline]
    pub fn sample(&self, receiver: &LightSampleContext, choice: f64, u: [f64; 2]) -> Option<LightSample> {
        self.sample_of(self.choose(choice), receiver, u)
    }

    /// The same from the one that was chosen.
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

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.probabilities.as_slice())
            + size_of_val(self.own_shares.as_slice())
            + self.lights.iter().map(|light| light.bytes()).sum::<usize>()
    }
}
