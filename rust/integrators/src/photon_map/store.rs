//! Maps that are kept with their scene.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// All that the photons of a map, and what finds them, depend on besides the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Key {
    pub seed: u64,
    pub number: u32,
    pub paths: u32,
    pub max_depth: Option<u32>,
    pub roulette_depth: u32,
    pub caustic: bool,
    /// Bits of the radius of grids, at surfaces and among media, and of the time in the scene.
    pub radius: Option<u64>,
    pub ball: Option<u64>,
    pub time: Option<u64>,
}

/// What has so many photons.
pub(crate) trait Counted {
    /// How many.
    fn count(&self) -> usize;
}

/// The maps that were made last: pieces of one picture that are rendered in one process one after the other, and
/// pictures by the same maps, find them here.
#[derive(Debug)]
pub(crate) struct MapStore<M> {
    maps: Mutex<VecDeque<(Key, Arc<M>)>>,
    /// Radii that suit, by the photons that tell them.
    radii: Mutex<Vec<(Key, Suitable<Option<f64>>)>>,
}

/// Radii that suit a map, at surfaces and among media; none where there are too few photons.
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

impl<M: Counted> MapStore<M> {
    /// Photons that are kept, besides a last map that has more: some 200 MB.
    pub const MOST: usize = 1 << 21;

    /// A map that was made before, or is made now and kept.
    pub fn map(&self, key: Key, make: impl FnOnce() -> Option<M>) -> Option<Arc<M>> {
        let lock = || self.maps.lock().unwrap_or_else(PoisonError::into_inner);
        let found = lock().iter().find(|(other, _)| *other == key).map(|(_, maps)| Arc::clone(maps));
        // Not within the lock: threads that wait for others take up work of theirs, which may come here too.
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

    /// Radii that were told before, or are told now and kept.
    pub fn radius(
        &self,
        key: Key,
        tell: impl FnOnce() -> Option<Suitable<Option<f64>>>,
    ) -> Option<Suitable<Option<f64>>> {
        let lock = || self.radii.lock().unwrap_or_else(PoisonError::into_inner);
        let found = lock().iter().find(|(other, _)| *other == key).map(|(_, radius)| *radius);
        // Nor here.
        found.or_else(|| {
            let told = tell()?;
            lock().push((key, told));
            Some(told)
        })
    }
}
