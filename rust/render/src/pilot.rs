//! Pilot renders that compare integrator variants on a few parts of a picture.

use super::denominators::FLOOR;
use super::pass_tiles::{Exposure, Goal, Stop};
use super::settings::Settings;
use super::shared_film::{given_back, lent};
use super::tile::FilmTile;
use super::{Film, Progress, RenderError};
use raywright_base::math::Hit;
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind};
use raywright_base::workers::watched;
use raywright_integrators::{Guide, Guiding, Integrator, Path, is_matt};
use raywright_optics::Rgb;
use raywright_scene::{Camera, Scene, SurfaceInteraction};

/// Side of the sampled parts in pixels, and their maximum number.
const SIDE: u32 = 16;
const PARTS: u32 = 8;

/// Samples of each pixel, in two batches.
const SAMPLES: u32 = 8;
const BATCH: u32 = SAMPLES / 2;

/// Maximum number of samples of a pilot per variant.
pub const PILOT: u32 = PARTS * SIDE * SIDE * SAMPLES;

/// Approximate relMSE of each variant with 8 samples per pixel, estimated on a few parts of the picture.
///
/// All variants are measured on the same pixels, relative to the same picture: the mean over all variants. Paths
/// without guiding rarely find the light that [`Path::guiding`] handles, and most likely not in so few samples. So the
/// guide estimates the error of such paths ([`raywright_integrators::LocalGuide::rarity`]), which is added to unguided
/// variants. Light that is learned is found once for all paths that share it.
///
/// The result depends only on the scene, the camera and the filter, not on seeds, time or threads. Other `settings` are
/// ignored.
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
        let guiding = ways.iter().map(|way| way.guiding_in(scene)).max().unwrap_or_default();
        let guide = guiding.guide(scene, camera, &stop.cancel);
        let seen = parallel::map(ways.len(), |i| expose(scene, camera, &ways[i], &settings, &stop));
        PilotMoments { ways: seen, guiding, rare: guide.map(|guide| rarity(scene, camera, &guide)) }
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

/// Results on the parts.
struct PilotMoments {
    /// Tiles of each variant.
    ways: Vec<Vec<FilmTile>>,
    /// The most of their guiding.
    guiding: Guiding,
    /// Rarity of the light that it guides to, per pixel, if there is any.
    rare: Option<Vec<Vec<f64>>>,
}

impl PilotMoments {
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
                    if let Some(rare) = self.rare.as_ref().filter(|_| way.guiding == Guiding::None) {
                        let paths = if self.guiding == Guiding::Learned { way.reuse * way.reuse } else { 1 };
                        *sum += squared.dot(over) * rare[part][pixel] / f64::from(SAMPLES * paths);
                    }
                }
            }
        }
        sums.iter().map(|sum| if count > 0.0 { sum / count } else { 0.0 }).collect()
    }
}

/// Positions of the parts: tiles of an empty film, spread uniformly over the picture (the R2 sequence of Roberts,
/// 2018).
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

/// For each part and pixel, [`raywright_integrators::LocalGuide::rarity`] at the point seen through the pixel's center;
/// 0 if that point is not diffuse or has no photons.
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

/// Variance of a pixel's mean, from its two batches.
fn variance(tile: &FilmTile, pixel: usize) -> Rgb {
    let cell = tile.cell(pixel);
    let (sums, batches) = (cell.sum, f64::from(SAMPLES / BATCH));
    let spread = (cell.squares - sums * sums / batches).at_least(Rgb::ZERO);
    spread / (batches * (batches - 1.0) * f64::from(BATCH).powi(2))
}

/// Mean of a pixel and its neighbors within the part.
fn around(means: &[Rgb], [width, height]: [u32; 2], pixel: usize) -> Rgb {
    let (x, y) = (pixel as u32 % width, pixel as u32 / width);
    let span = |at: u32, size: u32| at.saturating_sub(1)..(at + 2).min(size);
    let all = span(y, height).flat_map(|y| span(x, width).map(move |x| (y * width + x) as usize));
    let (sum, count) = all.fold((Rgb::ZERO, 0.0), |(sum, count), i| (sum + means[i], count + 1.0));
    sum / count
}
