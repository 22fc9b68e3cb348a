//! How far a path gets in a medium.

use super::numbers::Numbers;
use super::weights::Weights;
use raywright_base::math::Ray;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::media::{Coefficients, Content, Medium, Stretch};

/// A part of a ray in a medium.
pub(super) struct Flight<'a> {
    pub medium: &'a dyn Medium,
    /// The ray in the space of the medium.
    pub ray: Ray,
    /// The `t` where it begins and ends; the end may be infinite.
    pub span: [f64; 2],
    /// The length of the ray's direction in the world.
    pub length: f64,
    /// Whether what is scattered counts; if not, it is lost.
    pub scatters: bool,
    /// Whether faint light is ended by roulette on its way through cells, too.
    pub roulette: bool,
    /// The wavelengths of what is on the way; none for red, green and blue.
    pub waves: Option<Waves>,
}

/// What a ray in a medium has come to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collision {
    /// Where.
    pub t: f64,
    /// The density, by length, with which such a place is drawn by all wavelengths together; none where that is not
    /// known.
    pub density: Option<f64>,
    /// What the medium does to light there.
    pub here: Coefficients,
    /// What the path carries for each unit of scattering there: what has come, over the density of the place.
    pub came: Rgb,
}

impl Flight<'_> {
    /// A length in the world, between two `t`.
    #[inline]
    pub(super) fn way(&self, from: f64, to: f64) -> f64 {
        (to - from) * self.length
    }

    /// What is at a `t` of the ray.
    #[inline]
    pub(super) fn at(&self, t: f64) -> Coefficients {
        let point = self.ray.at(t);
        match &self.waves {
            Some(waves) => self.medium.at_waves(point, waves),
            None => self.medium.at(point),
        }
    }

    /// The extinction there.
    #[inline]
    pub(super) fn extinction(&self, t: f64) -> Rgb {
        match &self.waves {
            Some(waves) => self.medium.at_waves(self.ray.at(t), waves).extinction,
            None => self.medium.extinction(self.ray.at(t)),
        }
    }

    /// What is in a stretch of it.
    #[inline]
    pub(super) fn content(&self, stretch: &Stretch) -> Content {
        match (stretch.content, &self.waves) {
            (Content::Even(here), Some(waves)) => Content::Even(self.medium.by_waves(here, waves)),
            (Content::Varies([least, most]), Some(waves)) if self.medium.has_waves() => {
                let least = self.medium.least_by_waves(least, waves);
                Content::Varies([least, self.medium.most_by_waves(most, waves).at_least(least)])
            }
            (content, _) => content,
        }
    }

    /// Draws how far it gets: where it is scattered, or none if it gets to its end. `depth` is the optical depth that
    /// it is still to get through before that, for its hero; `light` is added what it comes by that glows.
    ///
    /// Where the medium is even or its extinction is a cubic, that is closed; elsewhere it meets, as often as in the
    /// densest medium that it could be, things of which so many are nothing as the medium is thinner (Woodcock et al.,
    /// "Techniques Used in the GEM Code", 1965). Where nothing is scattered, it is not drawn, but dimmed.
    pub fn fly(
        &self,
        weights: &mut Weights,
        (hero, depth): (usize, &mut f64),
        numbers: &mut Numbers,
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
            // Of parts of what is not even, nobody asks.
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
        numbers: &mut Numbers,
        cancel: &Cancel,
        light: &mut Rgb,
    ) -> Option<Collision> {
        let scatters = self.scatters && self.medium.scatters();
        // What asking for light meets in its place ([`Flight::fade`]).
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
