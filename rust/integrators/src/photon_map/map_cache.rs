//! A cache of photon maps, kept with the scene.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// All inputs of a photon map and its lookup structure, besides the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Key {
    pub seed: u64,
    pub number: u32,
    pub paths: u32,
    pub max_depth: Option<u32>,
    pub roulette_depth: u32,
    pub caustic: bool,
    /// Bits of the grid radius at surfaces and in media, and of the scene time.
    pub radius: Option<u64>,
    pub ball: Option<u64>,
    pub time: Option<u64>,
}

/// Maps with a known number of photons.
pub(crate) trait PhotonCount {
    /// Return the number of photons.
    fn count(&self) -> usize;
}

/// The most recent maps. Pieces of one picture that are rendered in turn by one process share them, and so do pictures
/// with equal maps.
#[derive(Debug)]
pub(crate) struct MapStore<M> {
    maps: Mutex<VecDeque<(Key, Arc<M>)>>,
    /// Derived radii, by the key of the pilot photons.
    radii: Mutex<Vec<(Key, Suitable<Option<f64>>)>>,
}

/// Derived lookup radii at surfaces and in media; `None` with too few photons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Suitable<T = f64> {
    pub disk: T,
    pub ball: T,
}

impl<M> Default for MapStore<M> {
    fn default() -> Self {
        Self { maps: Mutex::default(), radii: Mutex::default() }
    }
}

impl<M: PhotonCount> MapStore<M> {
    /// Maximum number of cached photons, apart from a larger latest map: some 200 MB.
    pub const MOST: usize = 1 << 21;

    /// Return a cached map, or make and cache it.
    pub fn map(&self, key: Key, make: impl FnOnce() -> Option<M>) -> Option<Arc<M>> {
        let lock = || self.maps.lock().unwrap_or_else(PoisonError::into_inner);
        let found = lock().iter().find(|(other, _)| *other == key).map(|(_, maps)| Arc::clone(maps));
        // Made outside the lock: a thread that waits for others runs their tasks, which may call this function.
        found.or_else(|| {
            let made = Arc::new(make()?);
            let mut kept = lock();
            kept.push_back((key, Arc::clone(&made)));
            let mut all: usize = kept.iter().map(|(_, maps)| maps.count()).sum();
            while all > Self::MOST && kept.len() > 1 {
                all -= kept.pop_front().map_or(0, |(_, maps)| maps.count());
            }
            drop(kept);
            Some(made)
        })
    }

    /// Return cached radii, or derive and cache them.
    pub fn radius(
        &self,
        key: Key,
        tell: impl FnOnce() -> Option<Suitable<Option<f64>>>,
    ) -> Option<Suitable<Option<f64>>> {
        let lock = || self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let found = lock().iter().find(|(other, _)| *other == key).map(|(_, radius)| *radius);
        // Outside the lock for the same reason.
        found.or_else(|| {
            let told = tell()?;
            lock().push((key, told));
            Some(told)
        })
    }
}
