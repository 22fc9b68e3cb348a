//! Parts of a pass that are rendered by other processes or machines.
//!
//! Requests and answers are bytes. Samples that fill whole blocks are requested without the existing sums, and appended
//! ([`FilmTile::append`]). Otherwise tiles are sent with their sums and come back with more. In both cases the bits of
//! a picture do not depend on where its samples were taken.

use super::bytes::{Malformed, Reader, Writer, check};
use super::pass_tiles::{Exposure, Goal, Stop};
use super::render_loop::{self, begin};
use super::sample_allocation::Epoch;
use super::shared_film::{given_back, lent};
use super::tile::FilmTile;
use super::{Film, Progress, RenderError, Rendering, Settings};
use raywright_base::workers::{pool, watched};
use raywright_integrators::Integrator;
use raywright_scene::{Camera, Scene};
use std::ops::Range;

/// A request for samples of some tiles of a film.
#[derive(Debug)]
pub struct Request {
    first: u32,
    tiles: Vec<FilmTile>,
    wanted: Wanted,
}

#[derive(Debug)]
enum Wanted {
    /// Samples between two numbers, of cells that are empty here.
    Alone(u32, u32),
    /// Equal counts per cell, including existing samples, in a pass that begins at `done`.
    Even { done: u32, samples: u32 },
    /// Counts by an epoch for `samples` on average, when all pixels have `done` on average.
    Planned { epoch: Epoch, done: u32, samples: u32 },
}

/// Kinds of requests, as a byte.
const ALONE: u8 = 0;
const EVEN: u8 = 1;
const PLANNED: u8 = 2;

impl Rendering {
    /// Requests the samples that take some tiles to `samples`. With `before`, they follow that many others, which need
    /// not exist yet. Blocks before must be whole, and the film must support appending ([`Film::appends`]).
    ///
    /// # Panics
    /// If the film has no such tiles, or does not support appending.
    pub fn request(&self, tiles: Range<usize>, before: Option<u32>, samples: u32) -> Vec<u8> {
        let (film, mut to) = (&self.film, Writer::default());
        for size in [film.width(), film.height(), film.side(), film.batch()] {
            to.word(size);
        }
        to.byte(u8::from(!film.appends()));
        to.byte(u8::from(film.is_apart()));
        to.byte(u8::from(film.clamp().is_some()));
        to.float(film.clamp().unwrap_or(0.0));
        to.word(tiles.start as u32);
        to.word(tiles.len() as u32);
        to.byte(match self.epoch() {
            _ if before.is_some() => ALONE,
            None => EVEN,
            Some(_) => PLANNED,
        });
        if let Some(before) = before {
            assert!(film.appends() && before.is_multiple_of(film.block()), "whole blocks");
            to.word(before);
            to.word(samples);
            return to.0;
        }
        film.tiles()[tiles.clone()].iter().for_each(|tile| tile.write(&mut to));
        if let Some(epoch) = self.epoch() {
            to.word(epoch.patch);
            epoch.write(tiles, &mut to);
        }
        to.word(film.samples());
        to.word(samples);
        to.0
    }

    /// Adds the samples of an answered [`Request`].
    pub fn take(&mut self, answer: &[u8]) -> Result<(), Malformed> {
        let mut from = Reader(answer);
        let (first, count) = (from.word::<u32>()? as usize, from.word::<u32>()? as usize);
        let before = if from.flag()? { Some(from.word::<u32>()?) } else { None };
        let all = self.film.tile_count();
        check(first <= all && count <= all - first, "the tiles are out of range")?;
        let mut tiles = Vec::new();
        for number in first..first + count {
            let mut tile = self.film.empty_tile(number);
            tile.read(&mut from)?;
            let mut pairs = self.film.tiles()[number].counts().iter().zip(tile.counts());
            let follows = match before {
                Some(before) => pairs.all(|(&here, &more)| here == before && more <= self.film.block()),
                None => pairs.all(|(here, there)| here <= there),
            };
            check(follows && (before.is_none() || self.film.appends()), "they do not continue the samples here")?;
            tiles.push(tile);
        }
        from.end()?;
        for (here, tile) in self.film.tiles_mut()[first..].iter_mut().zip(tiles) {
            match before {
                Some(_) => here.append(&tile),
                None => *here = tile,
            }
        }
        Ok(())
    }
}

impl Request {
    /// Reads the bytes of [`Rendering::request`] for a picture of this size.
    pub fn from_bytes(bytes: &[u8], width: u32, height: u32) -> Result<Self, Malformed> {
        let mut from = Reader(bytes);
        let size: [u32; 2] = [from.word()?, from.word()?];
        check(size == [width, height], "they belong to a picture of another size")?;
        let (side, batch): (u32, u32) = (from.word()?, from.word()?);
        check((1..=64).contains(&side), "the tile size is not from 1 to 64")?;
        check(batch.is_power_of_two() && batch <= 1 << 16, "the batch size is not a power of two")?;
        let (halves, apart, clamps, clamp) = (from.flag()?, from.flag()?, from.flag()?, from.float()?);
        let film = Film::without_tiles(width, height, side, batch, halves, clamps.then_some(clamp)).kept_apart(apart);
        let (first, count): (u32, u32) = (from.word()?, from.word()?);
        let all = film.tile_count();
        check(first as usize <= all && count as usize <= all - first as usize, "the tiles are out of range")?;
        let numbers = first as usize..first as usize + count as usize;
        let kind = from.byte()?;
        let mut tiles: Vec<FilmTile> = numbers.map(|number| film.empty_tile(number)).collect();
        if kind == ALONE {
            let (before, samples): (u32, u32) = (from.word()?, from.word()?);
            let blocks = film.appends() && before.is_multiple_of(film.block());
            check(blocks && before <= samples && samples - before <= film.block(), "the samples are not one block")?;
            from.end()?;
            return Ok(Self { first, tiles, wanted: Wanted::Alone(before, samples) });
        }
        check(kind <= PLANNED && (kind == PLANNED) == halves, "the kind of request is unknown")?;
        tiles.iter_mut().try_for_each(|tile| tile.read(&mut from))?;
        let planned = if kind == PLANNED {
            let patch = from.word()?;
            check((1..=64).contains(&patch), "the patch size is not from 1 to 64")?;
            Some(Epoch::read(tiles.iter(), patch, &mut from)?)
        } else {
            None
        };
        let (done, samples) = (from.word()?, from.word()?);
        from.end()?;
        check(done <= samples && samples <= FilmTile::MOST, "a cell requests too many samples")?;
        let wanted = match planned {
            None => Wanted::Even { done, samples },
            Some(epoch) => {
                check(epoch.from <= done && samples <= epoch.to, "they belong to another epoch")?;
                Wanted::Planned { epoch, done, samples }
            }
        };
        Ok(Self { first, tiles, wanted })
    }

    /// Takes the samples, and returns the bytes for [`Rendering::take`]. With one thread the calling thread is used, so
    /// that parallel calls do not wait for each other. Limits in `settings` are ignored.
    pub fn expose(
        mut self,
        scene: &Scene,
        camera: &dyn Camera,
        integrator: &dyn Integrator,
        settings: &Settings,
        progress: &mut dyn Progress,
    ) -> Result<Vec<u8>, RenderError> {
        render_loop::check(integrator, (scene, camera), settings, matches!(self.wanted, Wanted::Planned { .. }))?;
        let stop = Stop::default();
        let (done, goal) = match self.wanted {
            Wanted::Alone(before, samples) => (before, Goal::Even { before, samples }),
            Wanted::Even { done, samples } => (done, Goal::Even { before: 0, samples }),
            Wanted::Planned { ref epoch, done, samples } => (done, Goal::Planned { epoch, done, samples }),
        };
        let lent = lent(std::mem::take(&mut self.tiles));
        let tiles = &lent[..];
        let pool = pool(settings.threads).map_err(RenderError::Threads)?;
        let job = settings.job(scene, camera);
        let session = if pool.threads() == 1 {
            pool.install(|| integrator.begin(job, &stop.cancel))
        } else {
            begin(integrator, job, settings.threads, progress)?
        };
        let exposure = Exposure::new(scene, camera, integrator, &*session, settings);
        let reached = if exposure.stays || pool.threads() == 1 {
            exposure.expose_here(tiles, done, goal, &stop, || {
                if progress.poll().is_break() {
                    stop.cancel.raise();
                }
            })
        } else {
            let watch = || {
                let goes_on = progress.poll().is_continue();
                if !goes_on {
                    stop.cancel.raise();
                }
                goes_on
            };
            watched(settings.threads, |_| exposure.expose(tiles, done, goal, &stop), watch)
                .map_err(RenderError::Threads)?
        };
        if !reached {
            return Err(RenderError::Interrupted);
        }
        self.tiles = given_back(lent);
        let mut to = Writer::default();
        to.word(self.first);
        to.word(self.tiles.len() as u32);
        let before = if let Wanted::Alone(before, _) = self.wanted { Some(before) } else { None };
        to.byte(u8::from(before.is_some()));
        if let Some(before) = before {
            to.word(before);
        }
        self.tiles.iter().for_each(|tile| tile.write(&mut to));
        Ok(to.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Quiet, Until, render};
    use super::*;
    use proptest::prelude::*;
    use raywright_integrators::Path;
    use raywright_scene::fixtures::cornell;

    const SIZE: [u32; 2] = [21, 13];

    fn settings(adaptive: bool) -> Settings {
        let until = Until { samples: Some(72), ..Until::default() };
        Settings { until, threads: Some(2), adaptive, apart: true, clamp: Some(1.0), seed: 4, ..Settings::default() }
    }

    fn answer(request: &[u8], threads: usize) -> Vec<u8> {
        let (scene, camera) = cornell(SIZE[0], SIZE[1]);
        let settings = Settings { threads: Some(threads), ..settings(false) };
        let request = Request::from_bytes(request, SIZE[0], SIZE[1]).unwrap();
        request.expose(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap()
    }

    #[test]
    fn parts_make_the_picture_bit_for_bit() {
        let (scene, camera) = cornell(SIZE[0], SIZE[1]);
        for adaptive in [false, true] {
            let settings = settings(adaptive);
            let whole = render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap();
            let mut rendering = Rendering::new(settings.film(&camera, 2, 1));
            loop {
                let done = rendering.film.samples();
                let aim = rendering.next_aim(&settings.until, done, 0.0, 0.0);
                if aim == done {
                    break;
                }
                rendering.begin(aim);
                let tiles = rendering.film.tile_count();
                let alone = rendering.film.appends() && done.is_multiple_of(rendering.film.block());
                let requests: Vec<_> = (0..tiles)
                    .step_by(3)
                    .map(|first| rendering.request(first..tiles.min(first + 3), alone.then_some(done), aim))
                    .collect();
                // In any order, on any number of threads.
                for (i, request) in requests.iter().enumerate().rev() {
                    rendering.take(&answer(request, 1 + i % 2)).unwrap();
                }
                rendering.end(0.0);
            }
            assert_eq!((&rendering.film, rendering.error), (&whole.film, whole.error));
        }
    }

    #[test]
    fn samples_are_not_taken_twice() {
        let (_, camera) = cornell(SIZE[0], SIZE[1]);
        let mut rendering = Rendering::new(settings(false).film(&camera, 2, 1));
        rendering.begin(16);
        let (first, second) = (rendering.request(0..5, Some(0), 16), rendering.request(0..5, Some(16), 32));
        let (first, second) = (answer(&first, 1), answer(&second, 1));
        assert_eq!(rendering.take(&second), Err(Malformed("they do not continue the samples here")));
        rendering.take(&first).unwrap();
        assert_eq!(rendering.take(&first), Err(Malformed("they do not continue the samples here")));
        rendering.take(&second).unwrap();
        assert!(rendering.film.tiles()[..5].iter().all(|tile| tile.counts().iter().all(|&n| n == 32)));
    }

    proptest! {
        #[test]
        fn any_request_is_refused_or_answered(
            adaptive: bool,
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
            end in any::<prop::sample::Index>(),
            cut: bool,
        ) {
            let (_, camera) = cornell(SIZE[0], SIZE[1]);
            let mut rendering = Rendering::new(settings(adaptive).film(&camera, 2, 1));
            rendering.begin(4);
            let mut request = rendering.request(2..4, (!adaptive).then_some(0), 4);
            let change = |bytes: &mut Vec<u8>| {
                for (at, value) in &changes {
                    let at = at.index(bytes.len());
                    bytes[at] = *value;
                }
                if cut {
                    bytes.truncate(end.index(bytes.len()));
                }
            };
            let mut good = answer(&request, 1);
            change(&mut request);
            let _ = Request::from_bytes(&request, SIZE[0], SIZE[1]);
            change(&mut good);
            let _ = rendering.take(&good);
        }
    }
}
