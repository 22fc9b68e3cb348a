//! Floor 4: what turns rays into radiance.

mod ambient_occlusion;
mod aov;
mod beam_traced;
mod begin_paths;
mod bidirectional;
mod boundary_queries;
mod camera_samples;
mod common_numbers;
mod cone_traced;
mod dimensions;
mod direct;
mod distributed;
mod first_seen;
mod guiding;
mod known_light;
mod light_paths;
mod light_traced;
mod media;
mod mis_weight;
mod narrow_views;
mod nesting;
mod path;
mod path_settings;
mod path_sharing;
mod path_vertices;
mod photon_map;
mod photons;
mod preview;
mod radiosity;
mod ray_cast;
mod resampling;
mod roulette;
mod shadows;
mod terminate_wavelengths;
#[cfg(test)]
mod tests;
mod transparent;
mod wavefront;
mod whitted;
mod widths;

pub use ambient_occlusion::AmbientOcclusion;
pub use aov::{Channel, aovs};
pub use beam_traced::BeamTraced;
pub use bidirectional::{Bidirectional, Merge, PathStrategy};
pub use boundary_queries::indices_outside;
pub use camera_samples::{CameraSample, CameraSamples};
pub use cone_traced::ConeTraced;
pub use direct::Direct;
pub use distributed::Distributed;
pub use first_seen::FirstSeen;
pub use guiding::{Guide, Guiding, LocalGuide, is_matt};
pub use light_traced::LightTraced;
pub use media::optical_depth::optical_depths;
pub use path::Path;
pub use photon_map::{Kernel, PhotonMap, ProgressivePhotonMap};
pub use photons::{Photon, Photons, photons};
pub use preview::{Pixel, Preview, PreviewLight};
pub use radiosity::Radiosity;
pub use ray_cast::RayCast;
pub use transparent::Transparent;
pub use whitted::Whitted;

use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Camera, Footprint, Scene};
use std::ops::Range;

/// A picture to be rendered.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What looks.
    pub camera: &'a dyn Camera,
    /// That of the camera's rays, for the filtering of textures.
    pub footprint: Footprint,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of samples of a pixel, from its first on, in a batch; the spread between batches tells the error.
    pub batch: u32,
}

impl<'a> Job<'a> {
    /// A picture of a scene by a camera, of a seed, whose samples come in batches of so many.
    pub fn new(scene: &'a Scene, camera: &'a dyn Camera, seed: u64, batch: u32) -> Self {
        let spread = camera.spread();
        let footprint = Footprint { width: spread.width, spread: spread.angle };
        Self { scene, camera, footprint, seed, batch }
    }
}

/// A way to turn rays into radiance.
pub trait Integrator: Send + Sync {
    /// Begins to work on a picture: makes all that its workers share. That may take long, on the current pool of
    /// threads; it returns soon after `cancel` is raised, with a session of no use.
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a>;

    /// Return an objection to a scene, or to adaptive sampling of it, and what to do instead, if it cannot render that.
    fn objection(&self, _scene: &Scene, _adaptive: bool) -> Option<String> {
        None
    }

    /// Return whether it supports media.
    fn takes_media(&self) -> bool {
        false
    }

    /// Return whether it supports wavelengths, or shows nothing that depends on these.
    fn takes_waves(&self) -> bool {
        false
    }

    /// Why it cannot take a picture by a camera, or by a filter of this radius, in pixels, if that is so.
    fn view_objection(&self, _camera: &dyn Camera, _filter_radius: f64) -> Option<String> {
        None
    }

    /// The side of the square patches of pixels whose samples of the same number work together; 1 where each sample is
    /// on its own.
    fn patch(&self, _scene: &Scene) -> u32 {
        1
    }

    /// The same, all of whose estimates gather light from so many times as far (at most 1), at the mean of the squared
    /// radii that so many samples have; `None` of an integrator that is not biased by how far it gathers light from.
    fn narrowed(&self, _scale: f64, _samples: u32) -> Option<Box<dyn Integrator>> {
        None
    }

    /// Return whether workers must run on the calling thread, as Python code must. They are then handed batches of tens
    /// of thousands of samples, and may raise the cancel themselves to end the render.
    fn runs_on_caller(&self) -> bool {
        false
    }
}

/// An integrator at work on a picture: the data shared by its threads.
pub trait Session: Send + Sync {
    /// Return the state of one thread.
    fn worker(&self) -> Box<dyn Worker + '_>;

    /// Called before each pass, when so many samples of each pixel are done, and again if it has to be begun anew. What
    /// changes from pass to pass must depend on that number alone. Returns soon after `cancel` is raised.
    fn before_pass(&self, _done: u32, _cancel: &Cancel) {}

    /// How many samples of each pixel it can be made ready for at a time; `None` where it need not be.
    fn at_once(&self) -> Option<u32> {
        None
    }

    /// Makes it ready for samples of these numbers, at most [`Session::at_once`], before they are taken: with all
    /// threads of the current pool, or `alone`. What is made depends on their numbers, and not on which were asked for
    /// before. Returns soon after `cancel` is raised, with what is of no use.
    fn before_samples(&self, _numbers: Range<u32>, _alone: bool, _cancel: &Cancel) {}

    /// When samples of a number see the scene, from 0 to 1 while the shutter is open; `None` where each pixel's does at
    /// a time of its own.
    fn time(&self, _number: u32) -> Option<f64> {
        None
    }

    /// Return the state of one thread for paths from lights; `None` if the integrator has none.
    fn light_worker(&self) -> Option<Box<dyn LightWorker + '_>> {
        None
    }
}

/// Light that has come to the camera by itself, not along a ray that was sent for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Where on the film, in pixels as [`Camera`] counts them: beyond the picture too.
    pub film: [f64; 2],
    /// Radiance times pixels: over the number of paths, its sum over those in a pixel is, on average, the part of that
    /// pixel's radiance that they find.
    pub light: Rgb,
}

/// An integrator at work on paths that start at lights.
pub trait LightWorker: Send {
    /// Follows a path for each of these numbers, and adds what it brings to the film. What is added, and in which
    /// order, depends on these paths alone. Returns soon after `cancel` is raised, with what is of no use.
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>);
}

/// An integrator at work on batches of camera samples. It advances all paths of a batch together, one bounce at a
/// time, so that every ray goes through the accelerator in large groups.
pub trait Worker: Send {
    /// Writes the radiance that arrives along each ray. Each depends on its own sample only, not on the batch that it
    /// is in. Returns early, with nothing of use python_integrator, soon after `cancel` is raised.
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]);

    /// As [`Worker::radiance`], or, if there are any groups, as [`Worker::radiance_in_groups`], of samples by columns.
    /// `rows` is memory that may be used.
    fn radiance_of_columns(
        &mut self,
        samples: &CameraSamples,
        groups: &[u32],
        rows: &mut Vec<CameraSample>,
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        samples.rows(rows);
        if groups.is_empty() {
            self.radiance(rows, cancel, radiance);
        } else {
            self.radiance_in_groups(rows, groups, cancel, radiance);
        }
    }

    /// As [`Worker::radiance`], of samples that stand in groups one after the other, of so many each. What arrives
    /// along a ray may depend on all samples of its group, but on no others, and its mean not even on these.
    fn radiance_in_groups(
        &mut self,
        samples: &mut [CameraSample],
        _groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.radiance(samples, cancel, radiance);
    }
}
