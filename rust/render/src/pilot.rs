//! What ways to render a picture are worth, as a few samples of a few parts of it tell.

use super::denominators::FLOOR;
use super::lent::{given_back, lent};
use super::settings::Settings;
use super::tile::FilmTile;
use super::tiles::{Exposure, Goal, Stop};
use super::{Film, Progress, RenderError};
use raywright_base::math::Hit;
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind};
use raywright_base::workers::watched;
use raywright_integrators::{Guide, Integrator, Path, is_matt};
use raywright_optics::Rgb;
use raywright_scene::{Camera, Scene, SurfaceInteraction};

/// Pixels on the side of the parts that are looked at, and how many parts there are at most.
const SIDE: u32 = 16;
const PARTS: u32 = 8;

/// Samples of each pixel, in batches of half as many.
const SAMPLES: u32 = 8;
const BATCH: u32 = SAMPLES / 2;

/// Samples that a pilot of a way takes at most.
pub const PILOT: u32 = PARTS * SIDE * SIDE * SAMPLES;

/// About the relMSE that each of these ways leaves with 8 samples of each pixel, told from a few parts of the picture.
///
/// All ways are measured by the same pixels, and against the same picture: the mean of what all of them find. What
/// [`Path::caustics`] is there for is met by few of the paths that do not aim, and by none of so few most likely; so it
/// is told by photons what such paths would have to find ([`raywright_integrators::LocalGuide::rarity`]), and that is
/// added to the ways that do not.
///
/// It depends on the scene, the camera and the filter alone: not on seeds, times or threads. `settings` that are about
/// other things are of no account.
pub fn pilot(
    scene: &Scene,
    camera: &dyn Camera,
    ways: &[Path],
    settings: &Settings,
    progress: &mut dyn Progress,
) -> Result<Vec<f64>, RenderError> {
    let sampler = BatchSize::new(BATCH).map_or(SamplerKind::Independent, SamplerKind::Sobol);
    let settings = Settings { sampler, seed: 0, ..settings.clone() };
    let stop = Stop::default();
    let work = || {
        let guide = if ways.iter().any(|way| way.caustics) { Guide::of(scene, &stop.cancel) } else { None };
        let seen = parallel::map(ways.len(), |i| expose(scene, camera, &ways[i], &settings, &stop));
        Seen { ways: seen, rare: guide.map(|guide| rarity(scene, camera, &guide)) }
    };
    let mut ended = false;
    let watch = || {
        ended = progress.poll().is_break();
        if ended {
            stop.cancel.raise();
        }
        !ended
    };
    let seen = watched(settings.threads, |_| work(), watch).map_err(RenderError::Threads)?;
    if ended {
        return Err(RenderError::Interrupted);
    }
    Ok(seen.errors(ways))
}

/// What was seen of the parts.
struct Seen {
    /// By each of the ways.
    ways: Vec<Vec<FilmTile>>,
    /// How rare the light is that comes by way of what is sharp, pixel by pixel, if any way aims at it.
    rare: Option<Vec<Vec<f64>>>,
}

impl Seen {
    fn errors(&self, ways: &[Path]) -> Vec<f64> {
        let mut sums = vec![0.0; ways.len()];
        let mut count = 0.0;
        for part in 0..self.ways.first().map_or(0, Vec::len) {
            let tiles = || self.ways.iter().map(|way| &way[part]);
            let size = self.ways[0][part].size();
            let means: Vec<Rgb> = (0..(size[0] * size[1]) as usize)
                .map(|pixel| tiles().map(|tile| mean(tile, pixel)).sum::<Rgb>() / ways.len() as f64)
                .collect();
            for pixel in 0..means.len() {
                let about = around(&means, size, pixel);
                let squared = about * about;
                let over = (squared + FLOOR).recip();
                count += 3.0;
                for (sum, (way, tile)) in sums.iter_mut().zip(ways.iter().zip(tiles())) {
                    *sum += variance(tile, pixel).dot(over);
                    if let Some(rare) = self.rare.as_ref().filter(|_| !way.caustics) {
                        *sum += squared.dot(over) * rare[part][pixel] / f64::from(SAMPLES);
                    }
                }
            }
        }
        sums.iter().map(|sum| if count > 0.0 { sum / count } else { 0.0 }).collect()
    }
}

/// Where the parts lie: tiles of an empty film, spread evenly over the picture (the R2 sequence of Roberts, 2018).
fn parts(camera: &dyn Camera, clamp: Option<f64>) -> Vec<FilmTile> {
    let (width, height) = (camera.width(), camera.height());
    let film = Film::without_tiles(width, height, SIDE, BATCH, false, clamp);
    let [columns, rows] = [width, height].map(|pixels| f64::from(pixels.div_ceil(SIDE)));
    let at = |i: u32, step: f64, count: f64| ((0.5 + f64::from(i) * step).fract() * count) as usize;
    let tile = |i| at(i, 0.569_840_290_998_053_3, rows) * columns as usize + at(i, 0.754_877_666_246_692_8, columns);
    let mut numbers: Vec<usize> = (0..PARTS).map(tile).filter(|&number| number < film.tile_count()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers.into_iter().map(|number| film.empty_tile(number)).collect()
}

fn expose(scene: &Scene, camera: &dyn Camera, way: &Path, settings: &Settings, stop: &Stop) -> Vec<FilmTile> {
    let tiles = lent(parts(camera, settings.clamp));
    let session = way.begin(settings.job(scene, camera), &stop.cancel);
    let exposure = Exposure::new(scene, camera, way, &*session, settings);
    exposure.expose(&tiles, 0, Goal::Even { before: 0, samples: SAMPLES }, stop);
    given_back(tiles)
}

/// For each part and pixel, [`raywright_integrators::LocalGuide::rarity`] at the point behind the pixel's center; 0
/// where that is not matt or has no photons.
fn rarity(scene: &Scene, camera: &dyn Camera, guide: &Guide) -> Vec<Vec<f64>> {
    let tell = |position: (u32, u32)| {
        let at = [f64::from(position.0) + 0.5, f64::from(position.1) + 0.5];
        let seen = camera.ray(at, [0.5; 2], 0.0);
        let mut hit = [Hit::MISS];
        scene.intersect(&[seen.ray], &mut hit);
        let [hit] = hit;
        if seen.weight == 0.0 || !hit.is_hit() {
            return None;
        }
        let surface = scene.geometry().surface(&seen.ray, &hit);
        let place = surface.position;
        let here = SurfaceInteraction::new(scene, &seen.ray, &hit, surface, 0.0, 1.0);
        if !is_matt(here.bsdf()) {
            return None;
        }
        guide.at(place).map(|local| local.rarity())
    };
    let part = |tile: &FilmTile| tile.pixels().map(|at| tell(at).unwrap_or(0.0)).collect();
    let parts = parts(camera, None);
    parallel::map(parts.len(), |i| part(&parts[i]))
}

fn mean(tile: &FilmTile, pixel: usize) -> Rgb {
    let cell = tile.cell(pixel);
    cell.sum / f64::from(cell.count.max(1))
}

/// The variance of a pixel's mean, as its two batches tell it.
fn variance(tile: &FilmTile, pixel: usize) -> Rgb {
    let cell = tile.cell(pixel);
    let (sums, batches) = (cell.sum, f64::from(SAMPLES / BATCH));
    let spread = (cell.squares - sums * sums / batches).at_least(Rgb::ZERO);
    spread / (batches * (batches - 1.0) * f64::from(BATCH).powi(2))
}

/// The mean of a pixel and those beside it in its part.
fn around(means: &[Rgb], [width, height]: [u32; 2], pixel: usize) -> Rgb {
    let (x, y) = (pixel as u32 % width, pixel as u32 / width);
    let span = |at: u32, size: u32| at.saturating_sub(1)..(at + 2).min(size);
    let all = span(y, height).flat_map(|y| span(x, width).map(move |x| (y * width + x) as usize));
    let (sum, count) = all.fold((Rgb::ZERO, 0.0), |(sum, count), i| (sum + means[i], count + 1.0));
    sum / count
}
