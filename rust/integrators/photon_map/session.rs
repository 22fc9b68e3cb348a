//! Pictures by photon maps.

use super::estimate::Estimate;
use super::kernel::Kernel;
use super::maps::{Flight, Maps, PhotonIndex, fly};
use super::radius::{NEIGHBOURS, Radii, first};
use super::store::{Key, MapStore};
use crate::integrators::light_paths::Limits;
use crate::integrators::transport::{Gather, MattLight, Settings, Visit};
use crate::integrators::{Job, Session, Worker};
use crate::optics::Rgb;
use crate::sampling::Sampler;
use crate::scene::materials::BsdfMix;
use crate::scene::{Emitters, SurfaceInteraction};
use crate::workers::Cancel;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, RwLock};

/// How a picture is made of photons.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub paths: u32,
    pub limits: Limits,
    pub nearest: Option<u32>,
    pub caustic: bool,
    pub gather: u32,
    pub kernel: Kernel,
    pub scale: f64,
    pub spread: Spread,
}

/// Which samples are by which maps.
#[derive(Clone, Copy, Debug)]
pub(super) enum Spread {
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

/// Maps that samples are being taken by.
struct Known {
    recipe: Recipe,
    /// The square of how far nearest photons may lie, once that is known.
    most: OnceLock<f64>,
    maps: RwLock<Vec<(u32, Arc<Maps>)>>,
}

impl MattLight for Known {
    fn radiance(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb {
        let Recipe { nearest, kernel, scale, .. } = self.recipe;
        let number = self.recipe.spread.map(visit.number);
        let maps = self.maps.read().unwrap_or_else(PoisonError::into_inner);
        let Some((_, maps)) = maps.iter().find(|(map, _)| *map == number) else { return Rgb::ZERO };
        let estimate = Estimate { nearest, most: *self.most.get().unwrap_or(&f64::INFINITY), kernel, scale };
        let mut light = estimate.radiance(&maps.caustic, here, visit.bounces);
        if !visit.looks_about {
            light += estimate.radiance(&maps.global, here, visit.bounces);
        }
        light
    }
}

/// How many times as far nearest photons are looked for as they lie where most are. Where there are hardly any, the
/// whole map would be looked through at each place, and light is too dark there to need as many.
const FARTHEST: f64 = 8.0;

/// A radius where there are hardly any photons: a fiftieth of the scene.
fn coarse(job: &Job) -> f64 {
    let region = job.scene.region();
    let size = (region.max - region.min).length() / 50.0;
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}

/// What workers on a picture share.
pub(super) struct Mapped<'a> {
    job: Job<'a>,
    recipe: Recipe,
    /// Of all photons, in the first map, where it is not told by the nearest.
    radius: Option<f64>,
    radii: Mutex<Radii>,
    /// None where nothing shines, or no photon would be kept.
    emitters: Option<Emitters<'a>>,
    store: Arc<MapStore>,
    known: Arc<Known>,
    seen: Box<dyn Session + 'a>,
}

impl<'a> Mapped<'a> {
    pub fn new(job: Job<'a>, recipe: Recipe, radius: Option<f64>, cancel: &Cancel) -> Self {
        let Limits { max_depth, roulette_depth } = recipe.limits;
        let emitters = job.scene.emitters().filter(|_| max_depth.is_none_or(|depth| depth > 1));
        let most = radius.map(|radius| radius * radius).map_or_else(OnceLock::new, OnceLock::from);
        let known = Arc::new(Known { recipe, most, maps: RwLock::default() });
        let gather = Some(Gather { rays: recipe.gather, caustic: recipe.caustic });
        let settings = Settings { gather, ..Settings::path(max_depth, roulette_depth) };
        let seen = settings.begin_with(job, Arc::clone(&known) as Arc<dyn MattLight>);
        let store = job.scene.kept(|| Some(MapStore::default())).unwrap_or_default();
        let alpha = if let Spread::Progressive { alpha, .. } = recipe.spread { alpha } else { 1.0 };
        let radii = Mutex::new(Radii::new(alpha));
        let mut this = Self { job, recipe, radius, radii, emitters, store, known, seen };
        if radius.is_none() {
            let suitable = this.suitable(cancel).unwrap_or_else(|| coarse(&job));
            match recipe.nearest {
                None => this.radius = Some(suitable),
                Some(count) => {
                    let most = FARTHEST * suitable * (f64::from(count) / NEIGHBOURS as f64).sqrt();
                    let _ = this.known.most.set(most * most);
                }
            }
        }
        this
    }

    /// A radius that suits the first map, told by photons of no picture: by the scene and the number of photons alone.
    fn suitable(&self, cancel: &Cancel) -> Option<f64> {
        const SEED: u64 = 0x7069_6c6f_7400;
        /// One is told by no more photons, and others by the square root of their numbers.
        const MOST: u32 = 100_000;
        let paths = self.recipe.paths.min(MOST);
        let key = Key { seed: SEED, paths, radius: None, ..self.key(u32::MAX, None) };
        let told = self.store.radius(key, || {
            let flight = Flight { seed: SEED, paths, ..self.flight(u32::MAX) };
            let all = fly(self.job.scene, self.emitters.as_ref()?, self.job.camera, &flight, false, cancel);
            first(&all.concat()).filter(|_| !cancel.is_raised())
        })?;
        Some(told * (f64::from(paths) / f64::from(self.recipe.paths)).sqrt())
    }

    /// A map that was made before, or is made now and kept.
    fn stored(&self, key: Key, cancel: &Cancel, make: impl FnOnce(&Self) -> Option<Maps>) -> Option<Arc<Maps>> {
        if let Some(maps) = self.store.get(&key) {
            return Some(maps);
        }
        let maps = Arc::new(make(self)?);
        if cancel.is_raised() {
            return None;
        }
        self.store.put(key, Arc::clone(&maps));
        Some(maps)
    }

    /// How far light is gathered from in a map; `None` where that is told by the nearest.
    fn radius(&self, map: u32) -> Option<f64> {
        let mut radii = self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let squared = match self.recipe.spread {
            Spread::Progressive { mean_of: Some(samples), .. } => radii.mean_square(samples),
            _ => radii.square(map),
        };
        self.radius.filter(|_| self.recipe.nearest.is_none()).map(|radius| radius * squared.sqrt())
    }

    /// When all of a map is on its way, while the shutter is open: evenly spread over the maps of a seed.
    fn time_of(&self, map: u32) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let start = Sampler::new(self.job.seed, u32::MAX, u32::MAX).one(0);
        (start + f64::from(map) * GOLDEN).fract()
    }

    fn moves(&self) -> bool {
        self.job.scene.geometry().moves() || self.job.camera.uses_time()
    }

    fn flight(&self, number: u32) -> Flight {
        let Recipe { paths, limits, caustic, .. } = self.recipe;
        let time = self.moves().then(|| self.time_of(number));
        Flight { paths, limits, caustic, seed: self.job.seed, number, time }
    }

    fn key(&self, number: u32, radius: Option<f64>) -> Key {
        let Flight { paths, limits, caustic, seed, time, .. } = self.flight(number);
        let Limits { max_depth, roulette_depth } = limits;
        let time = time.map(|time| self.job.camera.body().scene_time(time).to_bits());
        Key { seed, number, paths, max_depth, roulette_depth, caustic, radius: radius.map(f64::to_bits), time }
    }

    /// A map of a number.
    fn made(&self, number: u32, alone: bool, cancel: &Cancel) -> Option<Arc<Maps>> {
        let radius = self.radius(number);
        self.stored(self.key(number, radius), cancel, |this| {
            let (scene, camera) = (this.job.scene, this.job.camera);
            let flight = this.flight(number);
            let [caustic, global] = fly(scene, this.emitters.as_ref()?, camera, &flight, alone, cancel);
            let index = |photons| PhotonIndex::new(photons, radius);
            Some(Maps { caustic: index(caustic), global: index(global) })
        })
    }
}

impl Session for Mapped<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        self.seen.worker()
    }

    fn at_once(&self) -> Option<u32> {
        let maps = (MapStore::MOST as u32 / self.recipe.paths.max(1)).clamp(1, 16);
        Some(match self.recipe.spread {
            Spread::Batches { size, maps: each } => maps * (size / each).max(1),
            Spread::Progressive { .. } => maps,
        })
    }

    fn before_samples(&self, numbers: Range<u32>, alone: bool, cancel: &Cancel) {
        // One after the other, each by all threads: those that are not needed any longer first make place.
        let mut wanted: Vec<u32> = numbers.map(|number| self.recipe.spread.map(number)).collect();
        wanted.dedup();
        let mut maps = std::mem::take(&mut *self.known.maps.write().unwrap_or_else(PoisonError::into_inner));
        maps.retain(|(map, _)| wanted.contains(map));
        for map in wanted {
            if !maps.iter().any(|(kept, _)| *kept == map) {
                maps.extend(self.made(map, alone, cancel).map(|made| (map, made)));
            }
        }
        *self.known.maps.write().unwrap_or_else(PoisonError::into_inner) = maps;
    }

    fn time(&self, number: u32) -> Option<f64> {
        self.moves().then(|| self.time_of(self.recipe.spread.map(number)))
    }
}
