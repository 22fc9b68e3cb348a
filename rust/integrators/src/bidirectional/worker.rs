//! Batches of camera subpaths, each with a light subpath.

use super::Bidirection;
use super::camera_subpaths::CameraSubpaths;
use super::light_vertices::LightVertices;
use crate::dimensions::Dimensions;
use crate::light_paths::LightEnds;
use crate::wavefront::{Limits, SubpathEmission, SubpathWavefront, Times};
use crate::{CameraSample, Worker};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;

/// Per-thread state.
pub(super) struct BidirectionalWorker<'a> {
    shared: &'a Bidirection<'a>,
    /// Light subpaths, if any light can be sampled.
    light: Option<SubpathWavefront<'a>>,
    camera: SubpathWavefront<'a>,
    sink: CameraSubpaths<'a>,
    /// Wavelengths of samples; empty for RGB.
    waves: Vec<Waves>,
    samplers: Vec<Sampler>,
}

impl<'a> BidirectionalWorker<'a> {
    /// Samples per batch. Their light vertices are stored at half a kilobyte each.
    const TOGETHER: usize = 512;

    pub fn new(shared: &'a Bidirection<'a>) -> Self {
        let (job, limits) = (shared.job, shared.limits);
        // A connection counts as a scattering event, too.
        let within = Limits { max_depth: limits.max_depth.map(|depth| depth.saturating_sub(1)), ..limits };
        let emitters = shared.emitters.as_ref().filter(|_| limits.max_depth.is_none_or(|depth| depth > 1));
        Self {
            shared,
            light: emitters.map(|_| SubpathWavefront::of_lights(job.scene, within)),
            camera: SubpathWavefront::of_camera(&job, limits),
            sink: CameraSubpaths::new(shared, emitters.map(|emitters| LightVertices::new(LightEnds::new(emitters)))),
            waves: Vec::new(),
            samplers: Vec::new(),
        }
    }

    /// Trace the subpaths of samples to their ends and add their contributions.
    fn follow(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        self.draw_waves(samples);
        let (emitters, merging) = (self.shared.emitters.as_ref(), self.shared.merging.as_ref());
        if let (Some(light), Some(vertices), Some(emitters)) = (&mut self.light, &mut self.sink.vertices, emitters) {
            self.samplers.clear();
            self.samplers.extend(samples.iter().map(|sample| sample.sampler.paired()));
            let disks = merging.map(|merging| samples.iter().map(|sample| merging.disk(sample.sampler.number())));
            vertices.begin(samples.len(), disks.into_iter().flatten());
            let times = Times::Each(samples.iter().map(|sample| sample.ray.time).collect());
            let emission = SubpathEmission { emitters, camera: Some(self.shared.job.camera), times: &times };
            light.set_waves(self.waves.iter().copied());
            light.follow_light(&mut self.samplers, &emission, cancel, vertices);
        }
        self.sink.begin(samples);
        self.camera.set_waves(self.waves.iter().copied());
        self.camera.follow_camera(samples, cancel, &mut self.sink);
        radiance.copy_from_slice(&self.sink.radiance);
        for (light, waves) in radiance.iter_mut().zip(&self.waves) {
            *light = waves.seen(*light);
        }
    }

    /// Sample the wavelengths, common to both subpaths of a sample, in scenes that need them.
    fn draw_waves(&mut self, samples: &mut [CameraSample]) {
        if self.shared.job.scene.plan().needs().waves {
            self.waves.clear();
            let merging = self.shared.merging.as_ref();
            self.waves.extend(samples.iter_mut().map(|sample| {
                let of_merging = merging.and_then(|merging| merging.waves(sample.sampler.number()));
                of_merging.unwrap_or_else(|| Waves::of(sample.sampler.one(Dimensions::WAVES)))
            }));
        }
    }
}

impl Worker for BidirectionalWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        for (samples, radiance) in samples.chunks_mut(Self::TOGETHER).zip(radiance.chunks_mut(Self::TOGETHER)) {
            self.follow(samples, cancel, radiance);
        }
    }
}
