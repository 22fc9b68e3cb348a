//! Rendering with a transparent background.

use super::first_seen::FirstSeen;
use super::{CameraSample, Integrator, Job, LightWorker, Session, Worker};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Scene;
use std::ops::Range;

/// An integrator whose camera rays see no background where they leave the scene without hitting a surface. The
/// background still lights the scene and appears in mirrors and through glass.
///
/// Each sample counts fully or not at all. So a pixel's color is premultiplied by its alpha, and both come from the
/// same samples.
pub struct Transparent<'i>(pub &'i dyn Integrator);

impl Integrator for Transparent<'_> {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        Box::new(TransparentSession { scene: job.scene, inner: self.0.begin(job, cancel) })
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        self.0.objection(scene, adaptive)
    }

    fn takes_media(&self) -> bool {
        self.0.takes_media()
    }

    fn takes_waves(&self) -> bool {
        self.0.takes_waves()
    }

    fn patch(&self, scene: &Scene) -> u32 {
        self.0.patch(scene)
    }

    fn runs_on_caller(&self) -> bool {
        self.0.runs_on_caller()
    }
}

struct TransparentSession<'a> {
    scene: &'a Scene,
    inner: Box<dyn Session + 'a>,
}

impl Session for TransparentSession<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(Showing { inner: self.inner.worker(), first: FirstSeen::new(self.scene), seen: Vec::new() })
    }

    fn before_pass(&self, done: u32, cancel: &Cancel) {
        self.inner.before_pass(done, cancel);
    }

    fn at_once(&self) -> Option<u32> {
        self.inner.at_once()
    }

    fn before_samples(&self, numbers: Range<u32>, alone: bool, cancel: &Cancel) {
        self.inner.before_samples(numbers, alone, cancel);
    }

    fn time(&self, number: u32) -> Option<f64> {
        self.inner.time(number)
    }

    fn light_worker(&self) -> Option<Box<dyn LightWorker + '_>> {
        self.inner.light_worker()
    }
}

struct Showing<'a> {
    inner: Box<dyn Worker + 'a>,
    first: FirstSeen<'a>,
    seen: Vec<Option<u32>>,
}

impl Showing<'_> {
    fn without_background(
        &mut self,
        samples: &mut [CameraSample],
        radiance: &mut [Rgb],
        work: impl FnOnce(&mut dyn Worker, &mut [CameraSample], &mut [Rgb]),
    ) {
        self.first.look(samples, &mut self.seen);
        work(&mut *self.inner, samples, radiance);
        for (light, _) in radiance.iter_mut().zip(&self.seen).filter(|(_, seen)| seen.is_none()) {
            *light = Rgb::ZERO;
        }
    }
}

impl Worker for Showing<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        self.without_background(samples, radiance, |inner, samples, radiance| {
            inner.radiance(samples, cancel, radiance)
        });
    }

    fn radiance_in_groups(
        &mut self,
        samples: &mut [CameraSample],
        groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.without_background(samples, radiance, |inner, samples, radiance| {
            inner.radiance_in_groups(samples, groups, cancel, radiance);
        });
    }
}
