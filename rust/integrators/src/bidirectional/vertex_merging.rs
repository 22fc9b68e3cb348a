//! Vertex merging of camera paths with photons.

use super::camera_end::CameraEnd;
use crate::Job;
use crate::light_paths::{LightEnds, Partial, of_merged};
use crate::path_vertices::{Arrived, Onward, Vertex};
use crate::photon_map::{HashedGrid, Kernel, MapSchedule, PhotonCount, Sending, Series, StoredPhoton, cover, flown};
use crate::wavefront::{Arrival, Limits, Subpath, SubpathSink, VertexContext};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, Interaction};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// Parameters of vertex merging.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merge {
    /// Lookup radius of the first sample; `None` derives it from the number of photons.
    pub radius: Option<f64>,
    /// Light paths per sample; `None` for one per pixel, at most a million.
    pub photons: Option<u32>,
    /// Factor on each lookup radius, at most 1. MIS weights use the full radius.
    pub scale: f64,
    /// Number of samples whose mean squared radius all samples use; `None` for shrinking radii.
    pub mean_of: Option<u32>,
}

impl Default for Merge {
    fn default() -> Self {
        Self { radius: None, photons: None, scale: 1.0, mean_of: None }
    }
}

/// Photons for all samples with an index, with their MIS partials.
pub(super) struct MergeMap {
    photons: Vec<(StoredPhoton, Partial)>,
    places: HashedGrid,
}

impl PhotonCount for MergeMap {
    fn count(&self) -> usize {
        self.photons.len()
    }
}

/// Photon maps of all samples of a picture.
pub(super) struct Merging<'a> {
    job: Job<'a>,
    series: Series<'a, MergeMap>,
    photons: u32,
    scale: f64,
}

impl<'a> Merging<'a> {
    pub fn new(job: Job<'a>, merge: Merge, limits: Limits, emitters: &Emitters, cancel: &Cancel) -> Self {
        /// Default maximum of light paths per sample.
        const MOST: u32 = 1 << 20;
        /// Minimum, so that pixels of a small picture find some photons.
        const LEAST: u32 = 1 << 10;
        /// Share of new photons kept from sample to sample: the optimum for the convergence of noise and bias together.
        const ALPHA: f64 = 2.0 / 3.0;
        let pixels = job.camera.width().saturating_mul(job.camera.height());
        let photons = merge.photons.unwrap_or(pixels.clamp(LEAST, MOST));
        let spread = MapSchedule::Progressive { alpha: ALPHA, mean_of: merge.mean_of };
        let series = Series::new(job, Sending { paths: photons, limits, caustic: false, spread });
        let radius = merge.radius.unwrap_or_else(|| series.suitable(Some(emitters), cancel).disk);
        Self { job, series: series.with_radius(radius), photons, scale: merge.scale }
    }

    /// Return the merging disk of a sample index: the lookup disk's area times the number of light paths.
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

    /// Return the wavelengths of all paths of a sample index; `None` for RGB.
    pub fn waves(&self, number: u32) -> Option<Waves> {
        self.series.waves(number)
    }

    /// Make the maps for a range of samples.
    pub fn prepare(&self, numbers: Range<u32>, emitters: &Emitters, alone: bool, cancel: &Cancel) {
        let Job { scene, camera, .. } = self.job;
        self.series.prepare(numbers, cancel, |flight, radius| {
            let radius = radius?;
            let share = 1.0 / f64::from(flight.paths);
            let disk = self.disk(flight.number);
            let keeping = |paths| {
                let mut ends = LightEnds::new(emitters);
                ends.begin(std::iter::repeat_n(disk, paths));
                Keeping { share, ends, kept: Vec::new() }
            };
            let parts = flown(scene, emitters, camera, flight, (alone, cancel), keeping);
            let photons: Vec<_> = parts.into_iter().flat_map(|part| part.kept).collect();
            let places = HashedGrid::new(photons.iter().map(|(photon, _)| photon.position), radius);
            Some(MergeMap { photons, places })
        });
    }

    /// Return the map of a sample index.
    pub fn map(&self, number: u32) -> Option<Arc<MergeMap>> {
        self.series.of(number)
    }

    /// Return the light merged at a camera vertex, from photons with at most `most` bounces. If merging alone is shown,
    /// use only photons with a given number of bounces, unweighted.
    pub fn found(
        &self,
        map: &MergeMap,
        (at, arrived): (&Vertex, &Arrived),
        (path, end): (&Subpath, &CameraEnd),
        bounces: Option<u32>,
        alone: Option<u32>,
    ) -> Rgb {
        let here = &arrived.here;
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
                None => of_merged((light, back), (&end.partial, at.light_back_pdf(towards)), end.disk),
            };
            sum += scattered
                * photon.power(path.has_gamut_excess, path.single)
                * (share * weight / here.normal().dot(towards));
        });
        if sum.is_black() || !sum.is_radiance() {
            return Rgb::ZERO;
        }
        sum / cover(self.job.scene, here, squared_radius, Kernel::Box, arrived.ray.time)
    }
}

/// A sink that stores indirect photons at matte surfaces.
struct Keeping<'a> {
    share: f64,
    ends: LightEnds<'a>,
    kept: Vec<(StoredPhoton, Partial)>,
}

impl<'a> SubpathSink<'a> for Keeping<'a> {
    fn set_out(&mut self, path: &Subpath, light: &EmissionSample) {
        self.ends.set_out(path.number, light);
    }

    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, _: &mut VertexContext<'_>) {
        let at = at.vertex();
        self.ends.arrive(path.number, at);
        if let (Some(arrived), true) = (at.matte(), path.bounce > 1) {
            let power = (path.beta * self.share, path.single);
            let photon = StoredPhoton::arrived(arrived, power, path.bounce - 1, path.again);
            self.kept.push((photon, self.ends.end(path.number).partial()));
        }
    }

    fn go_on(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, next: &Onward) {
        self.ends.go_on(path.number, at.vertex(), next);
    }
}
