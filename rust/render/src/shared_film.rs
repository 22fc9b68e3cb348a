//! A film shared between threads that render and threads that look.

use super::{Film, FilmTile};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A film whose tiles are rendered, each by one thread at a time. A thread holds the lock of its tile while it counts
/// samples to take or adds results, not while it traces rays. So an observer never waits for rays, and sees the first
/// samples of each cell and nothing else.
#[derive(Debug)]
pub(super) struct LentFilm {
    /// The film without tiles.
    film: Film,
    tiles: Vec<Mutex<FilmTile>>,
}

/// Locks a tile.
pub(super) fn held(tile: &Mutex<FilmTile>) -> MutexGuard<'_, FilmTile> {
    // Samples are added to one cell after another, so a panic leaves a tile with fewer samples but consistent.
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Wraps tiles in locks.
pub(super) fn lent(tiles: Vec<FilmTile>) -> Vec<Mutex<FilmTile>> {
    tiles.into_iter().map(Mutex::new).collect()
}

/// Unwraps tiles when no thread holds them.
pub(super) fn given_back(tiles: Vec<Mutex<FilmTile>>) -> Vec<FilmTile> {
    tiles.into_iter().map(|tile| tile.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

impl LentFilm {
    /// Takes the tiles out of a film until they are returned.
    pub fn of(film: &mut Film) -> Self {
        let tiles = lent(film.take_tiles());
        Self { film: film.clone(), tiles }
    }

    /// Returns the tiles.
    pub fn give_back(self, film: &mut Film) {
        film.put_tiles(given_back(self.tiles));
    }

    /// The tiles.
    pub fn tiles(&self) -> &[Mutex<FilmTile>] {
        &self.tiles
    }

    /// The film without tiles.
    pub fn without_tiles(&self) -> Film {
        self.film.clone()
    }

    /// A copy of the film in its current state.
    pub fn copy(&self) -> Film {
        let mut film = self.film.clone();
        film.put_tiles(self.tiles.iter().map(|tile| held(tile).clone()).collect());
        film
    }

    /// Maps a function of tile and pixel index over all pixels, row by row from the top.
    fn pixels<T: Clone + Default>(&self, of: impl Fn(&FilmTile, usize) -> T) -> Vec<T> {
        let mut all = vec![T::default(); self.film.pixel_count()];
        for tile in &self.tiles {
            let tile = held(tile);
            for (i, (x, y)) in tile.pixels().enumerate() {
                all[y as usize * self.film.width() as usize + x as usize] = of(&tile, i);
            }
        }
        all
    }

    /// Mean of each pixel; black without samples.
    pub fn means(&self) -> Vec<[f32; 3]> {
        self.pixels(|tile, pixel| tile.mean(pixel).to_array().map(|x| x as f32))
    }

    /// Number of samples of each pixel.
    pub fn counts(&self) -> Vec<u32> {
        let cells = self.film.cells();
        self.pixels(|tile, pixel| tile.counts()[pixel * cells..][..cells].iter().sum())
    }

    /// Number of samples that were NaN, infinite or negative.
    pub fn dropped(&self) -> u64 {
        self.tiles.iter().map(|tile| held(tile).dropped()).sum()
    }

    /// Number of clamped samples.
    pub fn clamped(&self) -> u64 {
        self.tiles.iter().map(|tile| held(tile).clamped()).sum()
    }
}

/// A loan of a film: its tiles return when this is dropped, even after a panic.
pub(super) struct Loan<'a> {
    film: &'a mut Film,
    /// Present until dropped.
    lent: Option<Arc<LentFilm>>,
}

impl<'a> Loan<'a> {
    /// Borrows the tiles of a film.
    pub fn of(film: &'a mut Film) -> Self {
        let lent = Some(Arc::new(LentFilm::of(film)));
        Self { film, lent }
    }

    /// The tiles.
    pub fn tiles(&self) -> &[Mutex<FilmTile>] {
        self.lent.as_ref().map_or(&[], |lent| lent.tiles())
    }

    /// A shared view for observers, who must release it before the loan ends.
    pub fn shared(&self) -> Option<Arc<LentFilm>> {
        self.lent.clone()
    }
}

impl Drop for Loan<'_> {
    fn drop(&mut self) {
        if let Some(lent) = self.lent.take().and_then(Arc::into_inner) {
            lent.give_back(self.film);
        }
    }
}
