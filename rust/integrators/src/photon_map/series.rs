//! The maps of a picture, one after the other.

use super::maps::{Flight, fly};
use super::radius::{Radii, first};
use super::store::{Counted, Key, MapStore, Suitable};
use crate::Job;
use crate::light_paths::Limits;
use raywright_base::math::DVec3;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_scene::Emitters;
use std::any::Any;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Which samples are by which maps.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spread {
    /// Each batch of samples, so many, has so many maps of its own, one for each of equal parts.
    Batches { size: u32, maps: u32 },
    /// Each sample has one, and a radius that shrinks, or is the mean of so many.
    Progressive { alpha: f64, mean_of: Option<u32> },
}

impl Spread {
    /// The map of a sample. No two batches share one.
    fn map(self, number: u32) -> u32 {
        match self {
            Self::Batches { size, maps } => {
                (number / size) * maps + (u64::from(number % size) * u64::from(maps) / u64::from(size)) as u32
            }
            Self::Progressive { .. } => number,
        }
    }
}

/// What all photons of a picture have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sending {
    /// Paths from lights for each map.
    pub paths: u32,
    pub limits: Limits,
    /// As [`Flight::caustic`].
    pub caustic: bool,
    pub spread: Spread,
}

/// The maps of a picture: those that samples are being taken by, and how each is made.
pub(crate) struct Series<'a, M> {
    job: Job<'a>,
    sending: Sending,
    /// How far light is gathered from in the first map; `None` where that is told by the nearest.
    radius: Option<f64>,
    /// The same among media.
    ball: Option<f64>,
    radii: Mutex<Radii>,
    store: Arc<MapStore<M>>,
    ready: RwLock<Vec<(u32, Arc<M>)>>,
}

/// A radius where there are hardly any photons: a fiftieth of the scene.
fn coarse(job: &Job) -> f64 {
    let region = job.scene.region();
    let size = (region.max - region.min).length() / 50.0;
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}

impl<'a, M: Counted + Any + Send + Sync> Series<'a, M> {
    pub fn new(job: Job<'a>, sending: Sending) -> Self {
        let alpha = if let Spread::Progressive { alpha, .. } = sending.spread { alpha } else { 1.0 };
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

    /// The same whose first map has a radius.
    pub fn with_radius(self, radius: f64) -> Self {
        Self { radius: Some(radius), ..self }
    }

    /// The same whose first map has a radius among media.
    pub fn with_ball(self, radius: f64) -> Self {
        Self { ball: Some(radius), ..self }
    }

    /// Radii that suit the first map, told by photons of no picture: by the scene and the number of photons alone.
    pub fn suitable(&self, emitters: Option<&Emitters>, cancel: &Cancel) -> Suitable {
        const SEED: u64 = 0x7069_6c6f_7400;
        /// They are told by no more photons, and others by the roots of their numbers.
        const MOST: u32 = 100_000;
        let all = self.sending.paths;
        let paths = all.min(MOST);
        let flight = Flight { seed: SEED, paths, waves: None, ..self.flight(u32::MAX) };
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

    /// How far light is gathered from in a map; `None` where that is told by the nearest.
    fn radius(&self, map: u32) -> Option<f64> {
        let mut radii = self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let squared = match self.sending.spread {
            Spread::Progressive { mean_of: Some(samples), .. } => radii.mean_square(samples),
            _ => radii.square(map),
        };
        self.radius.map(|radius| radius * squared.sqrt())
    }

    /// The same among media.
    pub fn ball(&self, map: u32) -> Option<f64> {
        let mut radii = self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let squared = match self.sending.spread {
            Spread::Progressive { mean_of: Some(samples), .. } => radii.mean_ball(samples),
            _ => radii.ball(map),
        };
        self.ball.map(|radius| radius * squared.sqrt())
    }

    /// How far light is gathered from in the map of a sample.
    pub fn radius_of(&self, number: u32) -> Option<f64> {
        self.radius(self.sending.spread.map(number))
    }

    /// A number in [0, 1) of a map, which a dimension has: evenly spread over the maps of a seed.
    fn spread(&self, map: u32, dimension: u32) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let start = Sampler::new(self.job.seed, u32::MAX, u32::MAX).one(dimension);
        (start + f64::from(map) * GOLDEN).fract()
    }

    /// When all of a map is on its way, while the shutter is open.
    fn time_of(&self, map: u32) -> f64 {
        self.spread(map, 0)
    }

    /// The wavelengths of all of a map, in a scene that needs them: light meets the paths of samples at these alone.
    fn waves_of(&self, map: u32) -> Option<Waves> {
        self.job.scene.plan().needs().waves.then(|| Waves::of(self.spread(map, 1)))
    }

    /// The same of the map of a sample.
    pub fn waves(&self, number: u32) -> Option<Waves> {
        self.waves_of(self.sending.spread.map(number))
    }

    fn moves(&self) -> bool {
        self.job.scene.geometry().moves() || self.job.camera.uses_time()
    }

    /// When samples of a number see the scene, while the shutter is open, if anything moves.
    pub fn time(&self, number: u32) -> Option<f64> {
        self.moves().then(|| self.time_of(self.sending.spread.map(number)))
    }

    /// The same as the scene counts time.
    pub fn scene_time(&self, number: u32) -> f64 {
        self.time(number).map_or(0.0, |time| self.job.camera.body().scene_time(time))
    }

    fn flight(&self, map: u32) -> Flight {
        let Sending { paths, limits, caustic, .. } = self.sending;
        let time = self.moves().then(|| self.time_of(map));
        Flight { paths, limits, caustic, seed: self.job.seed, number: map, time, waves: self.waves_of(map) }
    }

    fn key(&self, flight: &Flight, radii: [Option<f64>; 2]) -> Key {
        let Flight { paths, limits, caustic, seed, number, time, .. } = *flight;
        let Limits { max_depth, roulette_depth } = limits;
        let time = time.map(|time| self.job.camera.body().scene_time(time).to_bits());
        let [radius, ball] = radii.map(|radius| radius.map(f64::to_bits));
        Key { seed, number, paths, max_depth, roulette_depth, caustic, radius, ball, time }
    }

    /// How many samples of each pixel maps can be made ready for at a time.
    pub fn at_once(&self) -> u32 {
        let maps = (MapStore::<M>::MOST as u32 / self.sending.paths.max(1)).clamp(1, 16);
        match self.sending.spread {
            Spread::Batches { size, maps: each } => maps * (size / each).max(1),
            Spread::Progressive { .. } => maps,
        }
    }

    /// Makes the maps ready that samples of these numbers are taken by, as `make` makes that of a flight and a radius.
    pub fn prepare(&self, numbers: Range<u32>, cancel: &Cancel, make: impl Fn(&Flight, Option<f64>) -> Option<M>) {
        let lock = || self.ready.write().unwrap_or_else(PoisonError::into_inner);
        // One after the other, each by all threads: those that are not needed any longer first make place.
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

    /// The map of a sample, if it was made ready.
    pub fn of(&self, number: u32) -> Option<Arc<M>> {
        let number = self.sending.spread.map(number);
        let ready = self.ready.read().unwrap_or_else(PoisonError::into_inner);
        ready.iter().find(|(map, _)| *map == number).map(|(_, maps)| Arc::clone(maps))
    }
}
