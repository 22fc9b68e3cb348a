//! Tiles that are worked on, and can be looked at meanwhile.

use super::{Film, FilmTile};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A film whose tiles are worked on, each by one thread at a time, which holds it for as long as it counts what it
/// wants or adds what it has, and not while it is taken. So whoever looks waits for no ray, and sees of each cell the
/// first of its samples and nothing else.
#[derive(Debug)]
pub(super) struct LentFilm {
    /// The same without tiles.
    film: Film,
    tiles: Vec<Mutex<FilmTile>>,
}

/// A tile, once nobody else holds it.
pub(super) fn held(tile: &Mutex<FilmTile>) -> MutexGuard<'_, FilmTile> {
    // Samples are added to one cell after the other: who panics leaves a tile with fewer, and nothing else.
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Tiles, to be worked on.
pub(super) fn lent(tiles: Vec<FilmTile>) -> Vec<Mutex<FilmTile>> {
    tiles.into_iter().map(Mutex::new).collect()
}

/// Tiles that nobody works on any more.
pub(super) fn given_back(tiles: Vec<Mutex<FilmTile>>) -> Vec<FilmTile> {
    tiles.into_iter().map(|tile| tile.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

impl LentFilm {
    /// The tiles of a film, which has none until they are given back.
    pub fn of(film: &mut Film) -> Self {
        let tiles = lent(film.take_tiles());
        Self { film: film.clone(), tiles }
    }

    /// Gives the tiles back.
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

    /// The film as it is now.
    pub fn copy(&self) -> Film {
        let mut film = self.film.clone();
        film.put_tiles(self.tiles.iter().map(|tile| held(tile).clone()).collect());
        film
    }

    /// Something of each pixel, row by row from the top, of which `of` gets a tile and the number of its pixel.
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

    /// The mean of each pixel; black without samples.
    pub fn means(&self) -> Vec<[f32; 3]> {
        self.pixels(|tile, pixel| tile.mean(pixel).to_array().map(|x| x as f32))
    }

    /// How many samples each pixel has.
    pub fn counts(&self) -> Vec<u32> {
        let cells = self.film.cells();
        self.pixels(|tile, pixel| tile.counts()[pixel * cells..][..cells].iter().sum())
    }

    /// Samples that were NaN, infinite or negative.
    pub fn dropped(&self) -> u64 {
        self.tiles.iter().map(|tile| held(tile).dropped()).sum()
    }

    /// How many samples were clamped.
    pub fn clamped(&self) -> u64 {
        self.tiles.iter().map(|tile| held(tile).clamped()).sum()
    }
}

/// A film on loan: its tiles come back to it when this is dropped, even if what works on them panics.
pub(super) struct Loan<'a> {
    film: &'a mut Film,
    /// There until it is dropped.
    lent: Option<Arc<LentFilm>>,
}

impl<'a> Loan<'a> {
    /// Lends the tiles of a film.
    pub fn of(film: &'a mut Film) -> Self {
        let lent = Some(Arc::new(LentFilm::of(film)));
        Self { film, lent }
    }

    /// The tiles.
    pub fn tiles(&self) -> &[Mutex<FilmTile>] {
        self.lent.as_ref().map_or(&[], |lent| lent.tiles())
    }

    /// What others may look at, as long as they let go of it before the loan ends.
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
