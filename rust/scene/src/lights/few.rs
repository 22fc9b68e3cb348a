//! Few lights, each of which is asked.

use super::choice::{MOST, Strength};
use super::{Light, LightSample, LightSampleContext, Lights};
use crate::Geometry;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;

/// The lights that are asked one by one, where there are few.
#[derive(Debug, Default)]
pub(super) struct Few {
    /// Those within the scene that can be drawn.
    within: Vec<Lamp>,
    /// How many there are, those outside included; 0 if it is one, or more than few.
    count: u32,
}

/// One within the scene.
#[derive(Clone, Copy, Debug)]
struct Lamp {
    /// Its number, or the numbers of the two triangles that make a mesh: one of these is drawn, so that a panel is
    /// asked once.
    numbers: [u32; 2],
    /// How often it is the first.
    share: f64,
}

impl Lamp {
    fn one(number: u32) -> Self {
        Self { numbers: [number; 2], share: 1.0 }
    }

    fn two(first: u32, strengths: &[Strength]) -> Self {
        let [a, b] = [0, 1].map(|i| strengths[first as usize + i].power.min(MOST));
        Self { numbers: [first, first + 1], share: 1.0 / (1.0 + b / a) }
    }

    /// Which it is by a number in [0, 1), how likely that is, and the number that is left.
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

    /// How often it is the one of this number.
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
    /// The most that are asked one by one: over metal of alpha 0.1, that halves error times time among 4, 8 and 12
    /// panels, and leaves 0.6 of it among 16. Among more, four candidates of one choice each were tried, of which one
    /// got the shadow ray: for half the error they took twice the time.
    const MOST: usize = 16;

    /// Of lights with these strengths within a scene, and so many outside. `pairs` are the numbers of those that are
    /// the first of the two triangles of a mesh.
    pub fn new(strengths: &[Strength], pairs: &[u32], outside: usize) -> Self {
        let mut within = Vec::new();
        let mut number = 0;
        while number < strengths.len() && within.len() <= Self::MOST {
            let first = number as u32;
            let shines = |number: usize| strengths[number].power > 0.0;
            if pairs.binary_search(&first).is_ok() && shines(number) && shines(number + 1) {
                within.push(Lamp::two(first, strengths));
                number += 2;
                continue;
            }
            if shines(number) {
                within.push(Lamp::one(first));
            }
            number += 1;
        }
        let count = within.len() + outside;
        if (2..=Self::MOST).contains(&count) { Self { within, count: count as u32 } } else { Self::default() }
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.within.as_slice())
    }
}

/// What is asked of lights one by one. Densities are each light's own, with no choice among lights in them.
impl Lights {
    /// How many lights [`Lights::sample_one`] knows, where a panel of two triangles counts as one. 0 where there is
    /// only one, which needs no choice, or where there are more than a few.
    #[inline]
    pub fn few(&self) -> u32 {
        self.few.count
    }

    /// Draws light of one of the few that reaches a receiver: `choice`, uniform in [0, 1), decides whether it is asked
    /// at all (only asked for where it is not always), `u` for the direction. `None` if the draw gives none.
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

    /// Whether one of the few is within the scene.
    #[inline]
    pub(super) fn is_within(&self, one: u32) -> bool {
        (one as usize) < self.few.within.len()
    }

    /// Of one that is, the number of the light that is drawn by a number in [0, 1), how likely that is, and the number
    /// that is left.
    #[inline]
    pub(super) fn one_within(&self, one: u32, x: f64) -> (usize, f64, f64) {
        self.few.within[one as usize].drawn(x)
    }

    /// The density with which [`Lights::sample_one`] draws, for a receiver, the direction of a ray from there, of the
    /// light that it meets: as [`Lights::surface_pdf`] has it, without the choice.
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

    /// Radiance that comes from outside along a unit direction to a receiver, that of each light there times a weight,
    /// by the density with which [`Lights::sample_one`] draws the direction.
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
