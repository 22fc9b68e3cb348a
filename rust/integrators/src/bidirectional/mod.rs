//! Bidirectional path tracing and vertex merging.

mod camera_end;
mod camera_subpaths;
mod connections;
mod light_vertices;
#[cfg(test)]
mod tests;
mod vertex_merging;
mod worker;

pub use vertex_merging::Merge;

use super::light_paths::{Counting, LightPaths, emitters};
use super::wavefront::Limits;
use super::{Integrator, Job, LightWorker, Session, Worker};
use raywright_base::workers::Cancel;
use raywright_scene::{Emitters, Scene};
use std::ops::Range;
use vertex_merging::Merging;
use worker::BidirectionalWorker;

/// Bidirectional path tracing (Lafortune and Willems, "Bi-Directional Path Tracing", 1993; Veach and Guibas,
/// "Bidirectional Estimators for Light Transport", 1994). Each sample of each pixel traces a camera path and a light
/// path. Each camera vertex is connected to each light vertex and to the lights, and each light vertex to the camera.
/// The strategies are combined with the balance heuristic.
///
/// Vertices can also be merged (vertex connection and merging: Georgiev et al. 2012; Hachisuka et al. 2012). Each
/// sample of all pixels has its own photons, one per light path, and gathers them at matte surfaces within shrinking
/// radii. So path tracing, light tracing and progressive photon mapping are special cases.
///
/// The combination finds all light that path tracing or light tracing alone finds well. Connections find light that is
/// hard to reach from either end, such as behind a door ajar. Only specular-diffuse-specular paths from small lights
/// gain nothing unless vertices are merged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bidirectional {
    /// Maximum number of scattering events; 0 shows only emission. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts, on both subpaths.
    pub roulette_depth: u32,
    /// Vertex merging, if any.
    pub merge: Option<Merge>,
    /// The one strategy to show unweighted, if any.
    pub alone: Option<PathStrategy>,
}

/// A strategy of sampling paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathStrategy {
    /// Number of vertices from the light, and from the camera, which counts as the first.
    pub vertices: [u32; 2],
    /// True if the last vertices of both ends are merged.
    pub merges: bool,
}

impl Default for Bidirectional {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4, merge: None, alone: None }
    }
}

impl Integrator for Bidirectional {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let limits = Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth };
        // Aimed emission would add noise to merging, and to connections from matte surfaces to the camera
        // (`LightTraced`).
        let emitters = if self.merge.is_none() { emitters(job.scene) } else { job.scene.emitters() };
        // Merging requires light scattered at least once: photons start at the second surface.
        let merge = self.merge.filter(|_| self.max_depth.is_none_or(|depth| depth > 1));
        let merging = merge.zip(emitters.as_ref());
        let merging = merging.map(|(merge, emitters)| Merging::new(job, merge, limits, emitters, cancel));
        Box::new(Bidirection { limits, job, emitters, merging, alone: self.alone })
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        // Emission of media is found by camera paths alone.
        let is_taken = !adaptive && scene.not_drawn().is_none();
        if is_taken { None } else { super::LightTraced::default().objection(scene, adaptive) }
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }

    fn narrowed(&self, scale: f64, samples: u32) -> Option<Box<dyn Integrator>> {
        let merge = self.merge?;
        let merge = Some(Merge { scale: merge.scale * scale, mean_of: Some(samples), ..merge });
        Some(Box::new(Self { merge, ..*self }))
    }
}

/// Data shared by the workers of a picture.
struct Bidirection<'a> {
    limits: Limits,
    job: Job<'a>,
    /// `None` without lights.
    emitters: Option<Emitters<'a>>,
    merging: Option<Merging<'a>>,
    alone: Option<PathStrategy>,
}

impl Bidirection<'_> {
    /// Return the weighting of connections to the camera.
    fn counting(&self) -> Counting<'_> {
        match self.alone {
            Some(PathStrategy { vertices: [light, 1], merges: false }) => Counting::Alone(light),
            Some(_) => Counting::Nothing,
            None => {
                let paths = f64::from(self.job.camera.width()) * f64::from(self.job.camera.height());
                let disk =
                    |merging| Box::new(move |number| Merging::disk(merging, number)) as Box<dyn Fn(u32) -> f64 + Send>;
                Counting::Beside { paths, disk: self.merging.as_ref().map(disk) }
            }
        }
    }
}

impl Session for Bidirection<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(BidirectionalWorker::new(self))
    }

    fn at_once(&self) -> Option<u32> {
        self.merging.as_ref().map(Merging::at_once)
    }

    fn before_samples(&self, numbers: Range<u32>, alone: bool, cancel: &Cancel) {
        if let (Some(merging), Some(emitters)) = (&self.merging, &self.emitters) {
            merging.prepare(numbers, emitters, alone, cancel);
        }
    }

    fn time(&self, number: u32) -> Option<f64> {
        self.merging.as_ref().and_then(|merging| merging.time(number))
    }

    fn light_worker(&self) -> Option<Box<dyn LightWorker + '_>> {
        let emitters = self.emitters.as_ref().filter(|_| self.limits.max_depth != Some(0))?;
        Some(Box::new(LightPaths::new(self.job, emitters, self.limits, self.counting())))
    }
}
