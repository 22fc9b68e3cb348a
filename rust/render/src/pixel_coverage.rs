//! Coverage of pixels by shapes.

use super::camera_sampler::{CameraSampler, PixelSample};
use super::tile::FilmTile;
use super::{Film, Settings};
use raywright_base::parallel;
use raywright_base::workers::Cancel;
use raywright_integrators::{CameraSamples, FirstSeen, Integrator};
use raywright_scene::{Camera, Scene};

/// Samples processed together.
const BATCH: usize = 4096;

/// Shares of a pixel covered by shapes, with shape numbers, in descending order; equal shares are ordered by number.
/// Filters with negative lobes may give negative shares, or shares above 1.
pub type Cover = Vec<(u32, f64)>;

/// Coverage of each pixel of a film, row by row from the top. It uses the very samples of the film with their weights,
/// so it does not depend on the process that took them or on counts per pixel. With `each`, it uses this number of
/// samples per cell instead. Returns soon after `cancel` is raised, with an invalid result.
pub fn cover(
    film: &Film,
    each: Option<u32>,
    (scene, camera): (&Scene, &dyn Camera),
    integrator: &dyn Integrator,
    settings: &Settings,
    cancel: &Cancel,
) -> Vec<Cover> {
    // The session may change when samples see the scene.
    let session = integrator.begin(settings.job(scene, camera), cancel);
    let sampler = CameraSampler::new(scene, camera, &*session, settings);
    let of_tile = |tile: &FilmTile| -> Vec<((u32, u32), Cover)> {
        let mut first = FirstSeen::new(scene);
        let cells = film.cells();
        let sums = of_cells(tile, each, &sampler, &mut first, cancel);
        tile.pixels().zip(sums.chunks(cells)).map(|(position, cells)| (position, of_pixel(cells))).collect()
    };
    let tiles = parallel::map(film.tiles().len(), |i| of_tile(&film.tiles()[i]));
    let mut all = vec![Cover::new(); film.pixel_count()];
    for ((x, y), cover) in tiles.into_iter().flatten() {
        all[y as usize * film.width() as usize + x as usize] = cover;
    }
    all
}

/// Number of samples of each cell of a tile, and sums of their weights by shape.
fn of_cells(
    tile: &FilmTile,
    each: Option<u32>,
    sampler: &CameraSampler,
    first: &mut FirstSeen,
    cancel: &Cancel,
) -> Vec<(u32, Cover)> {
    let counts = || tile.counts().iter().map(|&count| each.unwrap_or(count));
    let mut cells: Vec<(u32, Cover)> = counts().map(|count| (count, Cover::new())).collect();
    let (mut wanted, mut of) = (Vec::new(), Vec::new());
    let (mut samples, mut rows) = (CameraSamples::default(), Vec::new());
    let (mut weights, mut seen) = (Vec::new(), Vec::new());
    let mut all = counts().enumerate().flat_map(|(cell, count)| (0..count).map(move |nth| (cell, nth))).peekable();
    while let Some((cell, nth)) = all.next() {
        wanted.push(PixelSample { position: tile.position(cell), number: tile.number(cell, nth) });
        of.push(cell);
        if wanted.len() < BATCH && all.peek().is_some() {
            continue;
        }
        if cancel.is_raised() {
            break;
        }
        samples.clear();
        weights.clear();
        sampler.take(&wanted, &mut samples, &mut weights);
        samples.rows(&mut rows);
        first.look(&mut rows, &mut seen);
        let mut found = seen.iter();
        for (&cell, &weight) in of.iter().zip(&weights).filter(|(_, weight)| **weight != 0.0) {
            if let Some(&Some(shape)) = found.next() {
                add(&mut cells[cell].1, shape, weight);
            }
        }
        wanted.clear();
        of.clear();
    }
    cells
}

fn add(cover: &mut Cover, shape: u32, share: f64) {
    match cover.iter_mut().find(|(other, _)| *other == shape) {
        Some((_, sum)) => *sum += share,
        None => cover.push((shape, share)),
    }
}

/// Mean over the cells with samples, like a film's colors.
fn of_pixel(cells: &[(u32, Cover)]) -> Cover {
    let counted = cells.iter().filter(|(count, _)| *count > 0).count().max(1) as f64;
    let mut cover = Cover::new();
    for (count, sums) in cells.iter().filter(|(count, _)| *count > 0) {
        for &(shape, sum) in sums {
            add(&mut cover, shape, sum / f64::from(*count) / counted);
        }
    }
    cover.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    cover
}

#[cfg(test)]
mod tests {
    use super::super::{Quiet, Rendering, Until, filter, render};
    use super::*;
    use raywright_base::math::DVec3;
    use raywright_base::sampling::{BatchSize, SamplerKind};
    use raywright_integrators::{Path, Transparent};
    use raywright_optics::Rgb;
    use raywright_scene::fixtures::{rectangle, scene, shape};
    use raywright_scene::{ConstantEnvironment, Light, Perspective, SceneDescription};
    use std::sync::Arc;

    /// Two emissive walls, one partly in front of the other, under a bright sky.
    fn walls() -> (Scene, Perspective) {
        let back = rectangle([-9.0, -9.0, -4.0], [9.3, 0.0, 0.0], [0.0, 18.0, 0.0]);
        let front = rectangle([-0.31, -0.72, -2.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.0]);
        let shapes = vec![shape(back, [0.0; 3], 1.0), shape(front, [0.0; 3], 1.0)];
        let sky: Arc<dyn Light> = Arc::new(ConstantEnvironment { radiance: Rgb::splat(1e6) });
        let scene = scene(SceneDescription { shapes, lights: vec![sky] });
        (scene, Perspective::looking_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 60.0, 13, 9).unwrap())
    }

    fn rendered(scene: &Scene, camera: &Perspective, settings: &Settings) -> Rendering {
        render(scene, camera, &Transparent(&Path::default()), settings, &mut Quiet).unwrap()
    }

    #[test]
    fn surfaces_of_radiance_one_are_as_bright_as_they_cover() {
        let (scene, camera) = walls();
        let until = Until { samples: Some(48), ..Until::default() };
        let batch = |samples| BatchSize::new(samples).unwrap();
        let gaussian = filter::Separable::new(filter::Gaussian::new(1.5, 0.5).unwrap());
        let mitchell = filter::Separable::new(filter::Mitchell::new(2.0, 1.0 / 3.0, 1.0 / 3.0).unwrap());
        let kinds: [(SamplerKind, bool, Arc<dyn filter::Filter>); 3] = [
            (SamplerKind::default(), false, Arc::new(filter::Box::default())),
            (SamplerKind::Lattice(batch(16)), false, Arc::new(gaussian)),
            (SamplerKind::Sobol(batch(8)), true, Arc::new(mitchell)),
        ];
        for (sampler, adaptive, filter) in kinds {
            let settings = Settings { until, adaptive, sampler, filter, threads: Some(2), ..Settings::default() };
            let rendering = rendered(&scene, &camera, &settings);
            let cover =
                cover(&rendering.film, None, (&scene, &camera), &Path::default(), &settings, &Cancel::default());
            let means = rendering.film.means();
            assert_eq!(cover.len(), means.len());
            for (cover, mean) in cover.iter().zip(means) {
                let alpha: f64 = cover.iter().map(|(_, share)| share).sum();
                // The same numbers are added in another order.
                assert!((Rgb::splat(alpha) - mean).abs().max() < 1e-13, "{alpha} {mean:?}");
                assert!(cover.is_sorted_by(|a, b| a.1 >= b.1));
            }
            let shares = |shape| cover.iter().flatten().filter(|c| c.0 == shape).map(|c| c.1).sum::<f64>();
            assert!(shares(0) > 30.0 && shares(1) > 5.0);
            assert!(cover.iter().any(|cover| cover.is_empty()));
            if !adaptive {
                let empty = settings.film(&camera, 2, 1);
                assert!(
                    super::cover(&empty, Some(48), (&scene, &camera), &Path::default(), &settings, &Cancel::default())
                        == cover
                );
            }
        }
    }
}
