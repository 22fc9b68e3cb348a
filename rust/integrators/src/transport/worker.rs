//! A batch of paths on their way.

use super::Follow;
use super::Settings;
use super::arrivals::Arrivals;
use super::block::Block;
use super::carried::Carried;
use super::guided::{Arrival, arrive};
use super::known::MattLight;
use super::path_state::{PathState, Queue};
use crate::nesting::MediumStack;
use crate::shadows::Shadows;
use crate::skip_intersections::Passing;
use crate::{CameraSample, Guide, Job, LocalGuide, Worker, is_matt};
use raywright_base::math::{Hit, LANES};
use raywright_base::sampling::SamplerLanes;
use raywright_base::simd::Level;
use raywright_base::timing::{Part, timed};
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Footprint, Interaction, LightLanes, Plan, Scene, SurfaceInteraction};

/// What one thread works with, see [`Settings::begin`].
pub(super) struct TransportWorker<'a> {
    pub(super) settings: Settings,
    pub(super) scene: &'a Scene,
    pub(super) level: Level,
    /// That of a camera's ray.
    footprint: Footprint,
    /// Which surfaces are there for which rays.
    pub(super) passing: Passing,
    pub(super) widths: bool,
    /// Whether paths may be sorted by what scatters them.
    pub(super) in_columns: bool,
    /// What guides paths, if anything does.
    pub(super) guide: Option<&'a Guide>,
    /// What is known of the light at matt surfaces, if anything is.
    pub(super) known: Option<&'a dyn MattLight>,
    pub(super) now: Queue,
    pub(super) next: Queue,
    pub(super) hits: Vec<Hit>,
    pub(super) arrivals: Arrivals,
    /// The paths that are worked on; none before the first.
    block: Option<Box<Block<'a>>>,
    pub(super) shadows: Shadows,
    /// What is drawn of each of few lights.
    pub(super) each: Vec<LightLanes>,
    /// The wavelengths of samples; none where they find red, green and blue.
    pub(super) waves: Vec<Waves>,
}

impl<'a> TransportWorker<'a> {
    pub fn new(settings: Settings, job: &Job<'a>, guide: Option<&'a Guide>, known: Option<&'a dyn MattLight>) -> Self {
        let &Job { scene, footprint, .. } = job;
        let needs = scene.plan().needs();
        let level = Level::current().unwrap_or(Level::Scalar);
        let widths = needs.points.width;
        Self {
            settings,
            scene,
            level,
            footprint,
            passing: Passing::new(needs.masks, needs.nested),
            widths,
            in_columns: settings.are_plain(),
            guide,
            known,
            now: Queue::default(),
            next: Queue::default(),
            hits: Vec::new(),
            arrivals: Arrivals::default(),
            block: None,
            shadows: Shadows::default(),
            each: Vec::new(),
            waves: Vec::new(),
        }
    }

    /// Puts the camera's rays into the queue.
    fn start(&mut self, samples: &[CameraSample]) {
        self.now.clear();
        samples.iter().for_each(|sample| self.now.rays.push(&sample.ray));
        self.now.paths.extend((0u32..).zip(samples).map(|(sample, _)| PathState::of_camera(sample)));
        let start = Carried { footprint: self.footprint, ..Carried::default() };
        self.now.carried.resize(samples.len(), start);
        if self.passing.is_nested() {
            let mut media = Vec::new();
            MediumStack::at(self.scene, self.now.rays.rows(), &mut media);
            for (carried, media) in self.now.carried.iter_mut().zip(media) {
                carried.media = media;
            }
        }
    }

    /// Takes all paths from their rays' hits to their next rays.
    fn bounce(&mut self, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        self.shadows.clear();
        self.next.clear();
        timed(Part::Arriving, || self.arrive(samples, radiance));
        let mut block = self.block.take().unwrap_or_else(|| Box::new(Block::new(&samples[0])));
        // A worker may be given samples of another seed or kind each time.
        block.numbers = SamplerLanes::new(&samples[0].sampler);
        for kind in 0..Plan::KINDS {
            // To aim takes more than a color.
            block.is_diffuse = kind == Plan::DIFFUSE && self.guide.is_none();
            let which = std::mem::take(&mut self.arrivals.kinds[kind]);
            for (number, some) in which.chunks(LANES).enumerate() {
                let next = which.iter().skip((number + 1) * LANES).take(LANES);
                next.for_each(|&i| self.scene.geometry().expect(self.hits[i as usize].primitive, true));
                self.shade(&mut block, some, samples, radiance);
            }
            // Their memory is used again.
            self.arrivals.kinds[kind] = which;
        }
        self.block = Some(block);
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Where light comes from by way of what is sharp, at a point that a path has come to; and whether the path goes on
    /// there.
    pub(super) fn guided<S: Bsdf>(
        &self,
        path: &mut PathState,
        here: &SurfaceInteraction<S>,
        number: impl FnOnce() -> f64,
    ) -> (Option<LocalGuide<'a>>, Arrival) {
        let Some(guide) = self.guide else { return (None, Arrival::GoesOn) };
        if !is_matt(here.bsdf()) {
            return (None, Arrival::GoesOn);
        }
        let local = guide.at(here.position());
        let arrival = arrive(path, local.as_ref(), number);
        (local, arrival)
    }
}

impl TransportWorker<'_> {
    /// Follows the paths of these samples to their ends, and adds what they find.
    fn follow(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        self.draw_waves(samples);
        self.start(samples);
        while !self.now.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.now.rays.len(), Hit::MISS);
            timed(Part::Closest, || self.scene.intersect_queue(&mut self.now.rays, &mut self.hits));
            self.bounce(samples, radiance);
            timed(Part::Shadow, || {
                if !self.settings.shadows {
                    self.shadows.add_all(radiance);
                } else if self.passing.is_needed() {
                    self.shadows.add_through(self.scene, self.passing.is_nested(), radiance);
                } else {
                    self.shadows.add_unblocked(self.scene, radiance);
                }
            });
        }
        self.see_waves(radiance);
    }
}

impl Worker for TransportWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        radiance.fill(Rgb::ZERO);
        // Each sample is on its own, so that a batch of paths that split may be worked on in parts.
        let gathered = self.settings.gather.map_or(1, |gather| gather.rays.max(1));
        let splits = self.settings.splits.max(self.settings.light_samples).max(gathered) as usize;
        let together = if self.settings.follow == Follow::DeltaLobes { 512 } else { 4096 };
        let part = (together / splits).max(16);
        for (samples, radiance) in samples.chunks_mut(part).zip(radiance.chunks_mut(part)) {
            self.follow(samples, cancel, radiance);
        }
    }
}
