//! The sequence of photon maps of one picture.

use super::map_cache::{Key, MapStore, PhotonCount, Suitable};
use super::photon_tracing::{PhotonPass, fly};
use super::radius::{Radii, first};
use crate::Job;
use crate::common_numbers::{COMMON_TIME, COMMON_WAVES, spread};
use crate::wavefront::Limits;
use raywright_base::math::DVec3;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_scene::Emitters;
use std::any::Any;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Assignment of samples to maps.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MapSchedule {
    /// Each batch of `size` samples has `maps` maps of its own, one for each of equal parts.
    Batches { size: u32, maps: u32 },
    /// Each sample has a map of its own. Radii shrink, or all equal the root mean square of `mean_of` radii.
    Progressive { alpha: f64, mean_of: Option<u32> },
}

impl MapSchedule {
    /// Return the index of a sample's map. Batches never share a map.
    fn map(self, number: u32) -> u32 {
        match self {
            Self::Batches { size, maps } => {
                (number / size) * maps + (u64::from(number % size) * u64::from(maps) / u64::from(size)) as u32
            }
            Self::Progressive { .. } => number,
        }
    }
}

/// Photon tracing parameters common to all maps of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sending {
    /// Light paths per map.
    pub paths: u32,
    pub limits: Limits,
    /// As [`PhotonPass::caustic`].
    pub caustic: bool,
    pub spread: MapSchedule,
}

/// The maps of a picture: those now in use, and how to make each.
pub(crate) struct Series<'a, M> {
    job: Job<'a>,
    sending: Sending,
    /// Lookup radius of the first map; `None` for nearest-neighbor lookups.
    radius: Option<f64>,
    /// The same in media.
    ball: Option<f64>,
    radii: Mutex<Radii>,
    store: Arc<MapStore<M>>,
    ready: RwLock<Vec<(u32, Arc<M>)>>,
}

/// Return a radius for maps with hardly any photons: a fiftieth of the scene.
fn coarse(job: &Job) -> f64 {
    let region = job.scene.region();
    let size = (region.max - region.min).length() / 50.0;
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}

impl<'a, M: PhotonCount + Any + Send + Sync> Series<'a, M> {
    pub fn new(job: Job<'a>, sending: Sending) -> Self {
        let alpha = if let MapSchedule::Progressive { alpha, .. } = sending.spread { alpha } else { 1.0 };
        Self {
            job,
            sending,
            radius: None,
            ball: None,
            radii: Mutex::new(Radii::new(alpha)),
            store: job.scene.kept(|| Some(MapStore::default())).unwrap_or_default(),
            ready: RwLock::default(),
        }
    }

    /// Set the radius of the first map.
    pub fn with_radius(self, radius: f64) -> Self {
        Self { radius: Some(radius), ..self }
    }

    /// Set the radius of the first map in media.
    pub fn with_ball(self, radius: f64) -> Self {
        Self { ball: Some(radius), ..self }
    }

    /// Derive radii for the first map from pilot photons. They depend on the scene and the number of photons alone.
    pub fn suitable(&self, emitters: Option<&Emitters>, cancel: &Cancel) -> Suitable {
        const SEED: u64 = 0x7069_6c6f_7400;
        /// Maximum number of pilot photons. Radii for more photons are scaled by the square or cube root of the ratio.
        const MOST: u32 = 100_000;
        let all = self.sending.paths;
        let paths = all.min(MOST);
        let flight = PhotonPass { seed: SEED, paths, waves: None, ..self.flight(u32::MAX) };
        let told = self.store.radius(self.key(&flight, [None; 2]), || {
            let all = fly(self.job.scene, emitters?, self.job.camera, &flight, false, cancel);
            let disks: Vec<DVec3> = all.surfaces.iter().flatten().map(|photon| photon.position).collect();
            let balls: Vec<DVec3> = all.among.iter().map(|photon| photon.position).collect();
            let told = Suitable { disk: first(&disks), ball: first(&balls) };
            (!cancel.is_raised()).then_some(told)
        });
        let fewer = f64::from(paths) / f64::from(all);
        let of = |radius: fn(&Suitable<Option<f64>>) -> Option<f64>, by: f64| {
            told.as_ref().and_then(radius).map_or_else(|| coarse(&self.job), |radius| radius * by)
        };
        Suitable { disk: of(|told| told.disk, fewer.sqrt()), ball: of(|told| told.ball, fewer.cbrt()) }
    }

    /// Return the lookup radius of a map; `None` for nearest-neighbor lookups.
    fn radius(&self, map: u32) -> Option<f64> {
        let mut radii = self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let squared = match self.sending.spread {
            MapSchedule::Progressive { mean_of: Some(samples), .. } => radii.mean_square(samples),
            _ => radii.square(map),
        };
        self.radius.map(|radius| radius * squared.sqrt())
    }

    /// Return the lookup radius of a map in media; `None` for nearest-neighbor lookups.
    pub fn ball(&self, map: u32) -> Option<f64> {
        let mut radii = self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let squared = match self.sending.spread {
            MapSchedule::Progressive { mean_of: Some(samples), .. } => radii.mean_ball(samples),
            _ => radii.ball(map),
        };
        self.ball.map(|radius| radius * squared.sqrt())
    }

    /// Return the lookup radius of a sample's map.
    pub fn radius_of(&self, number: u32) -> Option<f64> {
        self.radius(self.sending.spread.map(number))
    }

    /// Return the time within the shutter interval of a map's photons.
    fn time_of(&self, map: u32) -> f64 {
        spread(self.job.seed, map, COMMON_TIME)
    }

    /// Return the wavelengths of a map's photons, in scenes that need them. Photons and camera paths must have equal
    /// wavelengths.
    fn waves_of(&self, map: u32) -> Option<Waves> {
        self.job.scene.plan().needs().waves.then(|| Waves::of(spread(self.job.seed, map, COMMON_WAVES)))
    }

    /// Return the wavelengths of a sample's map.
    pub fn waves(&self, number: u32) -> Option<Waves> {
        self.waves_of(self.sending.spread.map(number))
    }

    fn moves(&self) -> bool {
        self.job.scene.geometry().moves() || self.job.camera.uses_time()
    }

    /// Return the time within the shutter interval of the samples with an index, if anything moves.
    pub fn time(&self, number: u32) -> Option<f64> {
        self.moves().then(|| self.time_of(self.sending.spread.map(number)))
    }

    /// Return the same as scene time.
    pub fn scene_time(&self, number: u32) -> f64 {
        self.time(number).map_or(0.0, |time| self.job.camera.body().scene_time(time))
    }

    fn flight(&self, map: u32) -> PhotonPass {
        let Sending { paths, limits, caustic, .. } = self.sending;
        let time = self.moves().then(|| self.time_of(map));
        PhotonPass { paths, limits, caustic, seed: self.job.seed, number: map, time, waves: self.waves_of(map) }
    }

    fn key(&self, flight: &PhotonPass, radii: [Option<f64>; 2]) -> Key {
        let PhotonPass { paths, limits, caustic, seed, number, time, .. } = *flight;
        let Limits { max_depth, roulette_depth } = limits;
        let time = time.map(|time| self.job.camera.body().scene_time(time).to_bits());
        let [radius, ball] = radii.map(|radius| radius.map(f64::to_bits));
        Key { seed, number, paths, max_depth, roulette_depth, caustic, radius, ball, time }
    }

    /// Return the number of samples per pixel whose maps fit in memory together.
    pub fn at_once(&self) -> u32 {
        let maps = (MapStore::<M>::MOST as u32 / self.sending.paths.max(1)).clamp(1, 16);
        match self.sending.spread {
            MapSchedule::Batches { size, maps: each } => maps * (size / each).max(1),
            MapSchedule::Progressive { .. } => maps,
        }
    }

    /// Make the maps for a range of samples; `make` makes a map from its flight and radius.
    pub fn prepare(&self, numbers: Range<u32>, cancel: &Cancel, make: impl Fn(&PhotonPass, Option<f64>) -> Option<M>) {
        let lock = || self.ready.write().unwrap_or_else(PoisonError::into_inner);
        // Maps are made in turn, each on all threads. Maps no longer needed are dropped first.
        let mut wanted: Vec<u32> = numbers.map(|number| self.sending.spread.map(number)).collect();
        wanted.dedup();
        let mut maps = std::mem::take(&mut *lock());
        maps.retain(|(map, _)| wanted.contains(map));
        for map in wanted {
            if !maps.iter().any(|(kept, _)| *kept == map) {
                let (flight, radius) = (self.flight(map), self.radius(map));
                let made = || make(&flight, radius).filter(|_| !cancel.is_raised());
                maps.extend(self.store.map(self.key(&flight, [radius, self.ball(map)]), made).map(|made| (map, made)));
            }
        }
        *lock() = maps;
    }

    /// Return the map of a sample, if it was prepared.
    pub fn of(&self, number: u32) -> Option<Arc<M>> {
        let number = self.sending.spread.map(number);
        let ready = self.ready.read().unwrap_or_else(PoisonError::into_inner);
        ready.iter().find(|(map, _)| *map == number).map(|(_, maps)| Arc::clone(maps))
    }
}
