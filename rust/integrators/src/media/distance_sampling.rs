//! Distance sampling in a medium.

use super::path_numbers::FurtherNumbers;
use super::spectral_mis::Weights;
use raywright_base::math::Ray;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::media::{Coefficients, Content, Medium, Stretch};

/// A segment of a ray in a medium.
pub(crate) struct MediumSegment<'a> {
    pub medium: &'a dyn Medium,
    /// The ray in medium space.
    pub ray: Ray,
    /// Start and end `t`; the end may be infinite.
    pub span: [f64; 2],
    /// Length of the ray's direction in world space.
    pub length: f64,
    /// False if scattered light is lost.
    pub scatters: bool,
    /// True if roulette also terminates faint light within cells.
    pub roulette: bool,
    /// Wavelengths of the light; `None` for RGB.
    pub waves: Option<Waves>,
}

/// A sampled collision in a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collision {
    /// Ray parameter.
    pub t: f64,
    /// Density per length of this distance over all wavelengths together; `None` if unknown.
    pub density: Option<f64>,
    /// Coefficients of the medium there.
    pub here: Coefficients,
    /// Path weight per unit of scattering there: the arriving weight over the density of the distance.
    pub came: Rgb,
}

impl Collision {
    /// Multiply the path weight.
    pub fn times(self, by: f64) -> Self {
        Self { came: self.came * by, ..self }
    }
}

impl MediumSegment<'_> {
    /// Return the world length between two `t`.
    #[inline]
    pub(crate) fn way(&self, from: f64, to: f64) -> f64 {
        (to - from) * self.length
    }

    /// Return the coefficients at a `t`.
    #[inline]
    pub(crate) fn at(&self, t: f64) -> Coefficients {
        let point = self.ray.at(t);
        match &self.waves {
            Some(waves) => self.medium.at_waves(point, waves),
            None => self.medium.at(point),
        }
    }

    /// Return the extinction at a `t`.
    #[inline]
    pub(crate) fn extinction(&self, t: f64) -> Rgb {
        match &self.waves {
            Some(waves) => self.medium.at_waves(self.ray.at(t), waves).extinction,
            None => self.medium.extinction(self.ray.at(t)),
        }
    }

    /// Return the contents of a stretch.
    #[inline]
    pub(crate) fn content(&self, stretch: &Stretch) -> Content {
        match (stretch.content, &self.waves) {
            (Content::Even(here), Some(waves)) => Content::Even(self.medium.by_waves(here, waves)),
            (Content::Varies([least, most]), Some(waves)) if self.medium.has_waves() => {
                let least = self.medium.least_by_waves(least, waves);
                Content::Varies([least, self.medium.most_by_waves(most, waves).at_least(least)])
            }
            (content, _) => content,
        }
    }

    /// Sample a collision; return `None` if the path passes through. `depth` is the remaining optical depth of its hero
    /// before a collision. Emission along the way is added to `light`.
    ///
    /// Homogeneous media and cubic extinction are sampled in closed form. Elsewhere, delta tracking samples tentative
    /// collisions at the majorant extinction, and rejects null collisions (Woodcock et al., "Techniques Used in the GEM
    /// Code", 1965). A medium without scattering only attenuates.
    pub fn fly(
        &self,
        weights: &mut Weights,
        (hero, depth): (usize, &mut f64),
        numbers: &mut FurtherNumbers,
        cancel: &Cancel,
        light: &mut Rgb,
    ) -> Option<Collision> {
        let mut start = self.span[0];
        let mut passed = Rgb::ZERO;
        for stretch in self.medium.stretches(&self.ray, self.span) {
            let span = [start, stretch.end];
            start = stretch.end;
            let content = self.content(&stretch);
            if !matches!(content, Content::Cubic) {
                self.leave_cells(&mut passed, weights, hero);
            }
            let found = match content {
                Content::Even(here) => self.fly_evenly(&here, span, weights, (hero, depth), light),
                Content::Cubic => self.fly_through_cell(span, &mut passed, weights, (hero, depth), numbers, light),
                Content::Varies(range) if !(self.scatters && self.medium.scatters() || self.medium.glows()) => {
                    self.fade_between(range, span, false, weights, hero, numbers, cancel);
                    None
                }
                Content::Varies(range) => self.track(range, span, weights, (hero, depth), numbers, cancel, light),
            };
            if found.is_some() || weights.carried.is_black() {
                return found;
            }
        }
        self.leave_cells(&mut passed, weights, hero);
        None
    }

    fn fly_evenly(
        &self,
        here: &Coefficients,
        [start, end]: [f64; 2],
        weights: &mut Weights,
        (hero, depth): (usize, &mut f64),
        light: &mut Rgb,
    ) -> Option<Collision> {
        let way = self.way(start, end);
        if !here.emission.is_black() {
            *light += weights.throughput() * here.glow(way);
        }
        if !self.scatters || here.scattering.is_black() {
            weights.carried *= here.left(way);
            return None;
        }
        let extinction = here.extinction[hero];
        if extinction > 0.0 && extinction * way > *depth {
            let way = *depth / extinction;
            let left = here.left(way);
            let density = || (weights.drawn * here.extinction * left).mean() / weights.drawn.mean();
            // Density is not needed in heterogeneous media.
            let density = self.medium.is_even().then(density);
            let by = left / (extinction * left[hero]);
            let came = weights.carried * by;
            weights.times(here.scattering * by, here.extinction * by, Rgb::ONE);
            let t = (start + way / self.length).min(end);
            return Some(Collision { t, density, here: *here, came });
        }
        if extinction > 0.0 {
            *depth -= extinction * way;
        }
        let left = here.left(way);
        let by = left / left[hero];
        weights.times(by, by, Rgb::splat(1.0 / left[hero]));
        None
    }

    #[allow(clippy::too_many_arguments)]
    fn track(
        &self,
        [least, most]: [Rgb; 2],
        [mut t, end]: [f64; 2],
        weights: &mut Weights,
        (hero, depth): (usize, &mut f64),
        numbers: &mut FurtherNumbers,
        cancel: &Cancel,
        light: &mut Rgb,
    ) -> Option<Collision> {
        let scatters = self.scatters && self.medium.scatters();
        // These are the null collisions of shadow rays ([`MediumSegment::fade`]).
        let spread = (most - least).at_least(Rgb::ZERO);
        while !cancel.is_raised() {
            let rest = self.way(t, end);
            if most[hero] * rest <= *depth {
                *depth -= most[hero] * rest;
                let left = (most * -rest).map(f64::exp);
                let by = left / left[hero];
                let asked = if scatters { (spread * -rest).map(f64::exp) / left[hero] } else { by };
                weights.times(by, by, asked);
                return None;
            }
            let way = *depth / most[hero];
            *depth = numbers.depth();
            t = (t + way / self.length).min(end);
            let left = (most * -way).map(f64::exp);
            let here = self.at(t);
            let met = left / (most[hero] * left[hero]);
            if !here.emission.is_black() {
                *light += weights.carried * here.emission * met / (weights.drawn * most * met).mean();
            }
            let nothing = (most - here.extinction).at_least(Rgb::ZERO);
            if !scatters {
                weights.times(nothing * met, most * met, most * met);
            } else if numbers.next() * most[hero] < here.extinction[hero] {
                let by = left / (here.extinction[hero] * left[hero]);
                let came = weights.carried * by;
                weights.times(here.scattering * by, here.extinction * by, Rgb::ONE);
                return Some(Collision { t, density: None, here, came });
            } else {
                let by = left / (nothing[hero] * left[hero]);
                let asked = (spread * -way).map(f64::exp) / (nothing[hero] * left[hero]);
                weights.times(nothing * by, nothing * by, spread * asked);
            }
            if weights.carried.is_black() {
                return None;
            }
        }
        None
    }
}
