//! Generation of camera samples, sixteen at a time.

use super::Settings;
use super::filter::{FilmCropping, Filter};
use raywright_base::math::LANES;
use raywright_base::sampling::{SamplerKind, SamplerLanes};
use raywright_base::simd::Level;
use raywright_integrators::{CameraSamples, Session};
use raywright_scene::{Camera, CameraRayLanes, Scene};
use std::array::from_fn;

/// A requested sample: its pixel, and its number within the pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelSample {
    pub position: (u32, u32),
    pub number: u32,
}

/// Generates camera samples: film positions by the filter, times while the shutter is open if anything moves, and lens
/// positions if there is a lens.
pub(super) struct CameraSampler<'a> {
    camera: &'a dyn Camera,
    session: &'a dyn Session,
    filter: &'a dyn Filter,
    /// Cropping of the filter at the film's edges.
    edges: Option<FilmCropping>,
    kind: SamplerKind,
    seed: u64,
    /// True if samples are distributed over the shutter's opening time.
    moves: bool,
    /// True if samples are distributed over the lens.
    uses_lens: bool,
    level: Level,
}

impl<'a> CameraSampler<'a> {
    pub fn new(scene: &Scene, camera: &'a dyn Camera, session: &'a dyn Session, settings: &'a Settings) -> Self {
        Self {
            camera,
            session,
            filter: settings.filter.as_ref(),
            edges: FilmCropping::new(settings.filter.as_ref(), [camera.width(), camera.height()]),
            kind: settings.sampler,
            seed: settings.seed,
            moves: scene.geometry().moves() || camera.uses_time(),
            uses_lens: camera.uses_lens(),
            level: Level::current().unwrap_or(Level::Scalar),
        }
    }

    /// Takes samples, and says of each how much it counts, by the filter and the camera: also of those for which the
    /// camera has no ray, and which are not among the samples.
    pub fn take(&self, wanted: &[PixelSample], samples: &mut CameraSamples, weights: &mut Vec<f64>) {
        let (mut u, mut offsets, mut counts) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2], [0.0; LANES]);
        let (mut lens, mut time, mut rays) = ([[0.5; LANES]; 2], [0.0; LANES], CameraRayLanes::NONE);
        for wanted in wanted.chunks(LANES) {
            // The last sample fills the remaining lanes.
            let of: [PixelSample; LANES] = from_fn(|lane| wanted[lane.min(wanted.len() - 1)]);
            let pixels = of.map(|PixelSample { position: (x, y), .. }| y * self.camera.width() + x);
            let numbers = of.map(|wanted| wanted.number);
            let samplers = SamplerLanes::of(self.kind, self.level, self.seed, &pixels, &numbers);
            samplers.two(self.level, &[0; LANES], &mut u);
            let mut factors = [1.0; LANES];
            if let Some(edges) = &self.edges {
                for (lane, &PixelSample { position: (x, y), .. }) in of.iter().enumerate() {
                    let point;
                    (point, factors[lane]) = edges.on_film([x, y], [u[0][lane], u[1][lane]]);
                    [u[0][lane], u[1][lane]] = point;
                }
            }
            self.filter.sample_lanes(&u, &mut offsets, &mut counts);
            if self.uses_lens {
                samplers.two(self.level, &[1; LANES], &mut lens);
            }
            if self.moves {
                samplers.one(self.level, &[3; LANES], &mut time);
                for (time, &number) in time.iter_mut().zip(&numbers) {
                    *time = self.session.time(number).unwrap_or(*time);
                }
            }
            let [right, down] = offsets;
            // Offsets from the center are added to the half first, so that those of the pixel's own square are exact.
            let film = [
                from_fn(|lane| f64::from(of[lane].position.0) + (0.5 + right[lane])),
                from_fn(|lane| f64::from(of[lane].position.1) + (0.5 + down[lane])),
            ];
            self.camera.rays(self.level, &film, &lens, &time, &mut rays);
            let weight: [f64; LANES] = from_fn(|lane| counts[lane] * factors[lane] * rays.weight()[lane]);
            weights.extend_from_slice(&weight[..wanted.len()]);
            let is_seen = |lane: usize| u32::from(lane < wanted.len() && weight[lane] != 0.0) << lane;
            samples.push(self.level, (0..LANES).map(is_seen).sum(), &rays, &samplers, &numbers);
        }
    }
}
