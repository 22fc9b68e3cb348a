//! Sampling of every light separately, for scenes with few lights.

use super::choice::{MOST, Strength};
use super::{Light, LightSample, LightSampleContext, Lights};
use crate::Geometry;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;

/// The lights that are sampled one by one.
#[derive(Debug, Default)]
pub(super) struct Few {
    /// Lights within the scene that can be sampled.
    within: Vec<SeparateLight>,
    /// Number of lights, including infinite ones; 0 if there is one, or too many.
    count: u32,
}

/// A light within the scene.
#[derive(Clone, Copy, Debug)]
struct SeparateLight {
    /// Its number, or the numbers of the two triangles of a mesh. One of them is selected, so that a panel takes one
    /// sample.
    numbers: [u32; 2],
    /// Probability of the first number.
    share: f64,
}

impl SeparateLight {
    fn one(number: u32) -> Self {
        Self { numbers: [number; 2], share: 1.0 }
    }

    fn two(first: u32, strengths: &[Strength]) -> Self {
        let [a, b] = [0, 1].map(|i| strengths[first as usize + i].power.min(MOST));
        Self { numbers: [first, first + 1], share: 1.0 / (1.0 + b / a) }
    }

    /// Selects a light number by a number in [0, 1); returns it with its probability and the remaining random number.
    #[inline]
    fn drawn(&self, x: f64) -> (usize, f64, f64) {
        let ([first, second], share) = (self.numbers, self.share);
        if share == 1.0 {
            (first as usize, 1.0, x)
        } else if x < share {
            (first as usize, share, x / share)
        } else {
            let rest = 1.0 - share;
            (second as usize, rest, ((x - share) / rest).min(1f64.next_down()))
        }
    }

    /// Probability of a light number.
    #[inline]
    fn share_of(&self, number: u32) -> f64 {
        if number == self.numbers[0] {
            self.share
        } else if number == self.numbers[1] {
            1.0 - self.share
        } else {
            0.0
        }
    }
}

impl Few {
    /// Maximum number of lights sampled one by one. On metal of alpha 0.1 that halves error times time with 4, 8 and 12
    /// panels, and reduces it to 0.6 with 16. For more lights, resampling one shadow ray out of four candidates was
    /// tried: it halved the error at twice the time.
    const MOST: usize = 16;

    /// Builds the list from the strengths of lights within the scene and the number of infinite lights. `pairs` are the
    /// first numbers of meshes of two triangles.
    pub fn new(strengths: &[Strength], pairs: &[u32], outside: usize) -> Self {
        let mut within = Vec::new();
        let mut number = 0;
        while number < strengths.len() && within.len() <= Self::MOST {
            let first = number as u32;
            let shines = |number: usize| strengths[number].power > 0.0;
            if pairs.binary_search(&first).is_ok() && shines(number) && shines(number + 1) {
                within.push(SeparateLight::two(first, strengths));
                number += 2;
                continue;
            }
            if shines(number) {
                within.push(SeparateLight::one(first));
            }
            number += 1;
        }
        let count = within.len() + outside;
        if (2..=Self::MOST).contains(&count) { Self { within, count: count as u32 } } else { Self::default() }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.within.as_slice())
    }
}

/// Sampling of lights one by one. Densities are per light, without a selection probability.
impl Lights {
    /// Number of lights for [`Lights::sample_one`], where a panel of two triangles counts as one. 0 if there is a
    /// single light, which needs no selection, or too many.
    #[inline]
    pub fn few(&self) -> u32 {
        self.few.count
    }

    /// Samples one light for a receiver. `choice`, uniform in [0, 1), decides whether the light is sampled at all and
    /// is called only if needed; `u` selects the direction. Returns `None` if the sample carries no light.
    #[inline]
    pub fn sample_one(
        &self,
        one: u32,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        choice: &mut dyn FnMut() -> f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let Some(lamp) = self.few.within.get(one as usize) else {
            let one = one as usize - self.few.within.len();
            let share = self.infinite.own_share(one);
            if share < 1.0 && choice() >= share {
                return None;
            }
            return Some(self.infinite.lights()[one].sample(receiver, u)?.chosen(share));
        };
        let (number, share, x) = lamp.drawn(u[0]);
        Some(self.sample_within(number, geometry, receiver, [x, u[1]])?.chosen(share))
    }

    /// Returns whether a light of the list is within the scene.
    #[inline]
    pub(super) fn is_within(&self, one: u32) -> bool {
        (one as usize) < self.few.within.len()
    }

    /// Selects a light number of a list entry within the scene, by a number in [0, 1). Returns it with its probability
    /// and the remaining random number.
    #[inline]
    pub(super) fn one_within(&self, one: u32, x: f64) -> (usize, f64, f64) {
        self.few.within[one as usize].drawn(x)
    }

    /// Density with which [`Lights::sample_one`] samples the direction of a ray at a receiver, for the light that the
    /// ray hits: [`Lights::surface_pdf`] without the selection probability.
    #[inline]
    pub fn own_pdf(
        &self,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        ray: &Ray,
        hit: &Hit,
        cosine: f64,
    ) -> f64 {
        let Some(number) = self.number_of(geometry, hit) else { return 0.0 };
        let share = self.few.within.iter().map(|lamp| lamp.share_of(number as u32)).find(|share| *share > 0.0);
        share.map_or(0.0, |share| share * self.pdf_within(number, geometry, receiver, (ray, hit), cosine))
    }

    /// Radiance of infinite lights along a unit direction at a receiver. Each light is multiplied by a weight, which is
    /// a function of its [`Lights::sample_one`] density.
    #[inline]
    pub fn outside_weighed(&self, receiver: &LightSampleContext, direction: DVec3, weight: impl Fn(f64) -> f64) -> Rgb {
        let each = self
            .infinite
            .lights()
            .iter()
            .enumerate()
            .map(|(one, light)| (one, light, light.infinite_radiance_at(direction, receiver.waves.as_ref())));
        let seen = each.filter(|(.., radiance)| !radiance.is_black());
        let drawn =
            |one: usize, light: &dyn Light| self.infinite.own_share(one) * light.infinite_pdf(receiver, direction);
        seen.map(|(one, light, radiance)| radiance * weight(drawn(one, light.as_ref()))).sum()
    }
}
