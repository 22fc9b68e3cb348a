//! Paths that merge: what light brings to about where a path from the camera has come to.

use super::eye::{EyePath, EyeVertex};
use crate::light_paths::{Arrived, Dimensions, Flying, Limits, Onward, Partial, Partials, Visitor, of_merged};
use crate::nesting::MediumStack;
use crate::photon_map::{Counted, HashedGrid, Kernel, Sending, Series, Spread, StoredPhoton, cover, flown};
use crate::{Job, is_matt};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, Encounter};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// How paths merge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merge {
    /// How far photons may lie in the first sample; `None` for as far as suits their number.
    pub radius: Option<f64>,
    /// Paths of light for each sample; `None` for as many as there are pixels, a million at most.
    pub photons: Option<u32>,
    /// How much of each radius counts, at most 1. Weights are those of the whole.
    pub scale: f64,
    /// Of how many samples all have the mean of the squared radii; `None` where they shrink.
    pub mean_of: Option<u32>,
}

impl Default for Merge {
    fn default() -> Self {
        Self { radius: None, photons: None, scale: 1.0, mean_of: None }
    }
}

/// What light brings in samples of a number: where it has come to matt surfaces, and what it knows there.
pub(super) struct MergeMap {
    photons: Vec<(StoredPhoton, Partial)>,
    places: HashedGrid,
}

impl Counted for MergeMap {
    fn count(&self) -> usize {
        self.photons.len()
    }
}

/// Those of all samples of a picture.
pub(super) struct Merging<'a> {
    job: Job<'a>,
    series: Series<'a, MergeMap>,
    photons: u32,
    scale: f64,
}

impl<'a> Merging<'a> {
    pub fn new(job: Job<'a>, merge: Merge, limits: Limits, emitters: &Emitters, cancel: &Cancel) -> Self {
        /// Paths that are kept at most unless more are asked for.
        const MOST: u32 = 1 << 20;
        /// So that each pixel of a small picture finds some.
        const LEAST: u32 = 1 << 10;
        /// The share of new photons that is kept from sample to sample: both noise and bias fall as fast as they can.
        const ALPHA: f64 = 2.0 / 3.0;
        let pixels = job.camera.width().saturating_mul(job.camera.height());
        let photons = merge.photons.unwrap_or(pixels.clamp(LEAST, MOST));
        let spread = Spread::Progressive { alpha: ALPHA, mean_of: merge.mean_of };
        let series = Series::new(job, Sending { paths: photons, limits, caustic: false, spread });
        let radius = merge.radius.unwrap_or_else(|| series.suitable(Some(emitters), cancel).disk);
        Self { job, series: series.with_radius(radius), photons, scale: merge.scale }
    }

    /// That of all samples of a number: the area that photons count from, times the number of paths that bring them.
    pub fn disk(&self, number: u32) -> f64 {
        let radius = self.series.radius_of(number).unwrap_or(0.0);
        f64::from(self.photons) * PI * radius * radius
    }

    pub fn at_once(&self) -> u32 {
        self.series.at_once()
    }

    pub fn time(&self, number: u32) -> Option<f64> {
        self.series.time(number)
    }

    /// The wavelengths of all paths of samples of a number; none for red, green and blue.
    pub fn waves(&self, number: u32) -> Option<Waves> {
        self.series.waves(number)
    }

    /// Makes maps ready for samples of these numbers.
    pub fn prepare(&self, numbers: Range<u32>, emitters: &Emitters, alone: bool, cancel: &Cancel) {
        let Job { scene, camera, .. } = self.job;
        self.series.prepare(numbers, cancel, |flight, radius| {
            let radius = radius?;
            let share = 1.0 / f64::from(flight.paths);
            let disk = self.disk(flight.number);
            let keeping = |paths| {
                let mut partials = Partials::new(emitters);
                partials.begin(std::iter::repeat_n(disk, paths));
                Keeping { share, partials, kept: Vec::new() }
            };
            let parts = flown(scene, emitters, camera, flight, (alone, cancel), keeping);
            let photons: Vec<_> = parts.into_iter().flat_map(|part| part.kept).collect();
            let places = HashedGrid::new(photons.iter().map(|(photon, _)| photon.position), radius);
            Some(MergeMap { photons, places })
        });
    }

    /// That of samples of a number.
    pub fn map(&self, number: u32) -> Option<Arc<MergeMap>> {
        self.series.of(number)
    }

    /// What a path from the camera finds in a map where it has come to, of light that has been scattered at so many
    /// surfaces at most; or what merges alone bring by photons of so many surfaces, in full.
    pub fn found(
        &self,
        map: &MergeMap,
        (at, path): (&EyeVertex, &EyePath),
        bounces: Option<u32>,
        alone: Option<u32>,
    ) -> Rgb {
        let here = &at.arrived.here;
        let squared_radius = (map.places.radius() * self.scale).powi(2);
        let mut sum = Rgb::ZERO;
        map.places.within(here.position(), |number, squared| {
            let (photon, light) = &map.photons[number as usize];
            let Some(squared) = photon.measured(here, squared, bounces) else { return };
            let share = Kernel::Box.weight(squared, squared_radius);
            if share == 0.0 || alone.is_some_and(|alone| photon.bounces != alone) {
                return;
            }
            let towards = -photon.direction.as_dvec3();
            let (scattered, back) = at.evaluate(towards);
            if scattered.is_black() {
                return;
            }
            let weight = match alone {
                Some(_) => 1.0,
                None => of_merged((light, back), (&path.partial, at.onward_pdf(towards)), path.disk),
            };
            sum += scattered * photon.power(path.gilded, path.single) * (share * weight / here.normal().dot(towards));
        });
        if sum.is_black() || !sum.is_radiance() {
            return Rgb::ZERO;
        }
        sum / cover(self.job.scene, here, squared_radius, Kernel::Box, at.arrived.ray.time)
    }
}

/// Keeps what comes to matt surfaces, but for what comes there straight from lights.
struct Keeping<'a> {
    share: f64,
    partials: Partials<'a>,
    kept: Vec<(StoredPhoton, Partial)>,
}

impl<'a> Visitor<'a> for Keeping<'a> {
    fn set_out(&mut self, path: &Flying, light: &EmissionSample) {
        self.partials.set_out(path, light);
    }

    fn meet(&mut self, arrived: &Arrived<'a>, path: &Flying, _: &MediumStack, _: (&mut Sampler, Dimensions)) {
        self.partials.arrive(path, arrived);
        if path.bounce > 1 && is_matt(arrived.here.bsdf()) {
            let power = (path.flux * self.share, path.single);
            let photon = StoredPhoton::arrived(arrived, power, path.bounce - 1, path.again);
            self.kept.push((photon, self.partials.end(path).partial()));
        }
    }

    fn go_on(&mut self, arrived: &Arrived<'a>, path: &Flying, next: &Onward) {
        self.partials.go_on(path, arrived, next);
    }
}
