//! The loop that takes a batch of paths through the stages of a path tracer.

use super::branches::{self, Branches};
use super::bsdf_block::BsdfBlock;
use super::emission;
use super::flights::Flights;
use super::masks::Masks;
use super::matte::Reflectances;
use super::media::Media;
use super::path_block::Block;
use super::queues::{Extra, PathQueue, ShadowQueue, own};
use super::waves::{self, PathWaves};
use super::ways::Way;
use crate::known_light::KnownLight;
use crate::media::current_medium::Filled;
use crate::narrow_views::CameraStart;
use crate::nesting::MediumStack;
use crate::path_settings::{Follow, PathSettings};
use crate::path_sharing::PathSharing;
use crate::{CameraSample, CameraSamples, Guide, Job, Worker, roulette};
use raywright_accel::Primitives;
use raywright_base::math::{Hit, LANES, Ray};
use raywright_base::sampling::{SamplerColumns, SamplerLanes};
use raywright_base::simd::Level;
use raywright_base::timing::{Part, count, timed};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Footprint, LightBlock, Plan, Scene};
use std::ops::Range;

/// Paths that are taken together. 2,048 to 4,096 stay in the second cache, and fill every sixteen.
pub(super) const BATCH: usize = 4096;

/// Per-thread state.
pub(super) struct WavefrontWorker<'a> {
    pub(super) scene: &'a Scene,
    pub(super) level: Level,
    pub(super) seed: u64,
    /// That of a camera's ray.
    pub(super) footprint: Footprint,
    pub(super) settings: PathSettings,
    pub(super) camera_start: CameraStart,
    /// True if light is drawn in f64 ([`super::light_in_f64`]); and then the light of each shadow ray, which has 1.
    pub(super) takes_f64: bool,
    pub(super) in_f64: Vec<Rgb>,
    /// Where subpaths start whose vertices go to a sink; `None` for whole paths.
    pub(super) end: Option<End>,
    /// True if paths go on from surfaces; and true if matte surfaces need no more than their own stages.
    pub(super) follows: bool,
    pub(super) is_plain: bool,
    /// Known light at matte surfaces and in media, if any.
    pub(super) known: Option<&'a dyn KnownLight>,
    /// The branches of paths, if these may split; and the continuations of sixteen.
    pub(super) branches: Option<Branches>,
    pub(super) ways: Vec<Way>,
    /// State of path sharing, if paths share.
    pub(super) sharing: Option<PathSharing<'a>>,
    /// Radiances of samples, and then the radiances that they share.
    pub(super) found: Vec<Rgb>,
    pub(super) reflectances: Reflectances,
    /// Paths about to follow their rays, and those that go on.
    pub(super) paths: [PathQueue; 2],
    pub(super) shadows: ShadowQueue,
    pub(super) samplers: Option<SamplerColumns>,
    /// The primitive that each path hits first.
    pub(super) primitives: Vec<u32>,
    /// All of these hits, in scenes where the primitive does not tell the rest.
    pub(super) hits: Vec<Hit>,
    pub(super) is_occluded: Vec<bool>,
    /// The paths that have met a surface, by the kind of BSDF there, and those that have left the scene. Where all are
    /// matte there is one kind.
    pub(super) met: Vec<Vec<u32>>,
    pub(super) outside: Vec<u32>,
    /// The kind of each primitive's BSDF, where there are few.
    pub(super) kinds: Vec<u8>,
    pub(super) extra: Extra,
    pub(super) masks: Option<Masks>,
    pub(super) media: Option<Media<'a>>,
    pub(super) flights: Option<Flights<'a>>,
    /// Samples of shadow rays through media, and the light that arrives.
    pub(super) arriving: Vec<(u32, Rgb)>,
    /// By sample, in scenes that need wavelengths.
    pub(super) waves: Vec<PathWaves>,
    /// Samples of each of few lights.
    pub(super) each: Vec<LightBlock>,
    /// The densities with which surfaces scatter into directions to each of few lights.
    pub(super) each_pdf: Vec<[f64; LANES]>,
    pub(super) block: Box<Block<'a>>,
}

/// An end of paths that subpaths start from.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    Light,
    Camera,
}

impl<'a> WavefrontWorker<'a> {
    pub fn new(
        job: &Job<'a>,
        settings: PathSettings,
        known: (Option<&'a Guide>, Option<&'a dyn KnownLight>),
        takes_f64: bool,
    ) -> Self {
        Self::with(job.scene, Some(job), (None, takes_f64), settings, known)
    }

    /// For light subpaths.
    pub fn of_lights(scene: &'a Scene, settings: PathSettings) -> Self {
        Self::with(scene, None, (Some(End::Light), false), settings, (None, None))
    }

    /// For camera subpaths.
    pub fn of_camera(job: &Job<'a>, settings: PathSettings) -> Self {
        Self::with(job.scene, Some(job), (Some(End::Camera), false), settings, (None, None))
    }

    fn with(
        scene: &'a Scene,
        job: Option<&Job<'a>>,
        (end, takes_f64): (Option<End>, bool),
        settings: PathSettings,
        (guide, known): (Option<&'a Guide>, Option<&'a dyn KnownLight>),
    ) -> Self {
        let PathSettings { shares, scatters, .. } = settings;
        let is_plain = settings.are_plain() && !takes_f64;
        let (is_whole, level) = (end.is_none(), Level::current().unwrap_or(Level::Scalar));
        let is_light = matches!(end, Some(End::Light));
        let needs = scene.plan().needs();
        let vary = needs.smooth || needs.instances || needs.points.width || needs.nested && needs.waves;
        let are_flat = scene.plan().is_constant() && !vary && is_plain;
        let has_kinds = needs.scattering || guide.is_some() || !are_flat;
        let normal = is_whole && scene.lights().ask_for_normals();
        // A ray that passes a mask may come to the same shape again.
        let media = needs.media || needs.nested;
        let passes = needs.masks && needs.shapes && !media;
        let hits = needs.instances || needs.motion || passes || scene.geometry().is_extreme();
        let (aimed, width, time) = (guide.is_some(), !is_light && needs.points.width, needs.motion);
        let state = has_kinds || media || needs.waves;
        let extra = Extra { normal, state, aimed, width, time, hits, media };
        let kinds = if has_kinds { Plan::KINDS } else { 1 };
        let count = scene.geometry().count();
        let few = if has_kinds && count <= BATCH { count as u32 } else { 0 };
        Self {
            scene,
            level,
            seed: job.map_or(0, |job| job.seed),
            footprint: job.map_or_else(Footprint::default, |job| job.footprint),
            camera_start: job.map_or(CameraStart::AtCamera, CameraStart::of),
            takes_f64,
            in_f64: Vec::new(),
            settings: PathSettings { roulette_depth: settings.roulette_depth.min(roulette::AT_LATEST), ..settings },
            end,
            follows: settings.follow != Follow::Nothing,
            is_plain,
            known,
            branches: settings.may_split().then(Branches::default),
            ways: Vec::new(),
            sharing: (shares && !media).then(|| PathSharing::new(level, guide)),
            found: Vec::new(),
            reflectances: Reflectances::new(scene),
            paths: [PathQueue::with_room(BATCH, extra), PathQueue::with_room(BATCH, extra)],
            shadows: ShadowQueue::with_room(BATCH, extra),
            samplers: None,
            primitives: vec![0; BATCH + LANES],
            hits: vec![Hit::MISS; if extra.hits { BATCH } else { 0 }],
            is_occluded: vec![false; BATCH + LANES],
            met: vec![Vec::new(); kinds],
            outside: Vec::with_capacity(BATCH),
            kinds: (0..few).map(|primitive| kind_of(scene, primitive) as u8).collect(),
            extra,
            masks: Masks::of(scene),
            media: Media::of(scene, shares, scatters && known.is_none() && is_whole, extra),
            flights: media.then(|| Flights::new(scene, scatters, extra)),
            arriving: Vec::new(),
            waves: Vec::new(),
            each: Vec::new(),
            each_pdf: Vec::new(),
            block: Box::new(Block::new(BsdfBlock::new(are_flat, guide, settings.least_pdf()))),
        }
    }

    /// Make room for the hits of so many paths.
    fn make_room(&mut self, most: usize) {
        if self.primitives.len() < most + LANES {
            self.primitives.resize(most + LANES, 0);
            self.hits.resize(if self.extra.hits { most } else { 0 }, Hit::MISS);
        }
    }

    /// Stage: what each path hits first is found.
    fn find_closest(&mut self) {
        let rays = &self.paths[0].rays;
        if !self.extra.hits {
            return self.scene.first_primitives(self.level, rays, &mut self.primitives);
        }
        self.scene.first_hits(rays, &mut self.hits);
        for (primitive, hit) in self.primitives.iter_mut().zip(&self.hits[..rays.len]) {
            *primitive = if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
        }
    }

    /// Stage: sorts paths by the BSDFs at their hits.
    fn classify(&mut self) {
        let count = self.paths[0].rays.len;
        let (first, rest) = self.met.split_at_mut(1);
        first[0].resize(count, 0);
        self.outside.resize(count, 0);
        // Both are written, and one grows.
        let (mut met, mut outside) = (0, 0);
        for (i, &primitive) in (0u32..).zip(&self.primitives[..count]) {
            (first[0][met], self.outside[outside]) = (i, i);
            let is_met = usize::from(primitive != Ray::NO_TRIANGLE);
            (met, outside) = (met + is_met, outside + 1 - is_met);
        }
        first[0].truncate(met);
        self.outside.truncate(outside);
        if let Some(media) = &self.media {
            self.outside.retain(|&i| !media.is_within[i as usize]);
        }
        if !rest.is_empty() {
            rest.iter_mut().for_each(Vec::clear);
            let mut matte = 0;
            for k in 0..met {
                let i = first[0][k];
                let primitive = self.primitives[i as usize];
                let kind = match self.kinds.get(primitive as usize) {
                    Some(&kind) => kind.into(),
                    None => kind_of(self.scene, primitive),
                };
                first[0][matte] = i;
                if kind == Plan::DIFFUSE {
                    matte += 1;
                } else {
                    rest[kind - 1].push(i);
                }
            }
            first[0].truncate(matte);
        }
    }

    /// Stage: gathers sixteen paths at surfaces.
    pub(super) fn meet_surfaces(&mut self, which: &[u32]) {
        let (queue, block) = (&self.paths[0], &mut *self.block);
        let met = (&self.primitives[..], &self.hits[..]);
        self.scene.geometry().meet_block(self.level, &queue.rays, met, which, &mut block.surfaces);
        block.gather(queue, self.extra);
    }

    /// Stage: adds the emission of sixteen surfaces.
    fn add_emission(&self, radiance: &mut [Rgb]) {
        let queue = (&self.paths[0], &self.hits[..], &self.waves[..]);
        emission::add_emitted(self.scene, queue, &self.block.surfaces, &self.block.bsdf.width, radiance);
    }

    /// Stage: gathers the random numbers of sixteen paths.
    pub(super) fn gather_numbers(&self, samples: u32, numbers: &mut SamplerLanes) {
        if let Some(columns) = &self.samplers {
            columns.gather(&self.block.sample.map(|sample| own(sample, samples)), numbers);
        }
    }

    /// Return whether flux is followed, from lights.
    pub(super) fn is_light(&self) -> bool {
        matches!(self.end, Some(End::Light))
    }

    /// Return where the light of a shadow ray is added: by sample, or by ray if a sink receives it.
    pub(super) fn receiver(&self, ray: usize) -> usize {
        if self.end.is_some() { ray } else { self.shadows.sample[ray] as usize }
    }

    /// Return the light of a shadow ray, relative to its column.
    pub(super) fn light_of(&self, ray: usize) -> Rgb {
        self.in_f64.get(ray).copied().unwrap_or(Rgb::ONE)
    }

    /// Return the media of a number; none in scenes without.
    pub(super) fn stack(&self, number: u32) -> MediumStack<Filled> {
        self.flights.as_ref().map_or(MediumStack::NONE, |flights| flights.stacks.get(number).media)
    }

    /// Stage: gathers the media of sixteen paths.
    pub(super) fn gather_media(&mut self, samples: u32) {
        let Some(media) = &self.media else { return };
        let Block { sample, media: block, .. } = &mut *self.block;
        for lane in 0..LANES {
            let path = &media.paths[own(sample[lane], samples) as usize];
            (block.here[lane], block.through[lane], block.outside[lane]) = (path.media, path.through, path.outside);
        }
    }

    /// Return whether roulette is played after so many bounces. The density with which a path comes to the second point
    /// that it shares must be known.
    pub(super) fn plays(&self, bounce: u32) -> bool {
        bounce + 1 >= self.settings.roulette_depth && (bounce > 0 || self.sharing.is_none())
    }

    /// Stage: traces shadow rays, and adds the light of those that nothing blocks.
    pub(super) fn follow_shadows(&mut self, samples: u32, cancel: &Cancel, radiance: &mut [Rgb]) {
        self.meet_masked_lamps();
        if self.media.is_some() && self.settings.shadows {
            return self.follow_shadows_through_media(samples, cancel, radiance);
        }
        let queue = &self.shadows;
        if self.is_occluded.len() < queue.rays.len + LANES {
            self.is_occluded.resize(queue.rays.len + LANES, false);
        }
        if self.settings.shadows {
            self.scene.are_occluded(self.level, &queue.rays, &mut self.is_occluded);
        }
        let [r, g, b] = &queue.arriving;
        for (i, &is_occluded) in self.is_occluded[..queue.rays.len].iter().enumerate() {
            if !is_occluded {
                radiance[self.receiver(i)] += Rgb::new(r[i].into(), g[i].into(), b[i].into()) * self.light_of(i);
            }
        }
        self.dim_by_masks(radiance);
    }

    /// Follows the paths of these samples, in groups if these share, to their ends, and adds what they find.
    pub(super) fn follow(
        &mut self,
        samples: &CameraSamples,
        some: Range<usize>,
        groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        let count = some.len();
        self.start(samples, some.clone());
        if self.scene.plan().needs().waves {
            waves::draw(samples, some.clone(), (groups, self.seed), self.known, &mut self.waves);
        }
        self.start_in_media(count);
        let Some(mut numbers) = self.samplers.as_ref().map(SamplerColumns::lanes) else { return };
        let Some(branches) = &mut self.branches else {
            for bounce in 0.. {
                if self.paths[0].rays.len == 0 || cancel.is_raised() {
                    break;
                }
                self.bounce(&mut numbers, bounce, count as u32, cancel, radiance);
            }
            // Shared radiance is converted after it has been shared.
            if !self.shares() {
                waves::see(&self.waves, radiance);
            }
            return;
        };
        branches.begin(count);
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        for bounce in 0.. {
            found.resize(self.branches.as_ref().map_or(count, Branches::len), Rgb::ZERO);
            if self.paths[0].rays.len == 0 || cancel.is_raised() {
                break;
            }
            self.bounce(&mut numbers, bounce, branches::MOST, cancel, &mut found);
        }
        waves::see(&self.waves, &mut found);
        if let Some(branches) = &self.branches {
            branches.gather(&found, radiance);
        }
        self.found = found;
    }

    /// Takes all paths to their next vertices, and sorts them by the BSDFs there.
    pub(super) fn find_vertices(
        &mut self,
        numbers: &mut SamplerLanes,
        bounce: u32,
        samples: u32,
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.make_room(self.paths[0].rays.len);
        self.shadows.rays.len = 0;
        self.in_f64.clear();
        if self.media.is_some() {
            timed(Part::Closest, || self.fly(numbers, bounce, samples, cancel, radiance));
        } else {
            timed(Part::Closest, || {
                self.find_closest();
                self.pass_masks(numbers, bounce, samples);
            });
        }
        self.classify();
        self.paths[1].rays.len = 0;
    }

    /// Takes all paths to their next vertices, and scatters them there.
    fn bounce(&mut self, numbers: &mut SamplerLanes, bounce: u32, samples: u32, cancel: &Cancel, radiance: &mut [Rgb]) {
        self.find_vertices(numbers, bounce, samples, cancel, radiance);
        timed(Part::Arriving, || {
            emission::add_outside(self.scene, (&self.paths[0], &self.waves), &self.outside, radiance);
        });
        let goes_on = self.settings.max_depth.is_none_or(|depth| bounce < depth);
        for kind in 0..self.met.len() {
            let met = std::mem::take(&mut self.met[kind]);
            count(met.len());
            for some in met.chunks(LANES) {
                timed(Part::Surface, || {
                    self.meet_surfaces(some);
                    self.add_emission(radiance);
                });
                if !goes_on {
                    continue;
                }
                self.gather_media(samples);
                self.gather_waves();
                timed(Part::Numbers, || self.gather_numbers(samples, numbers));
                if kind == Plan::DIFFUSE && self.is_plain && !(self.extra.aimed || self.extra.width) {
                    self.leave_matte(numbers, bounce, samples);
                } else {
                    self.leave_any(numbers, bounce, samples, radiance);
                }
            }
            // Its memory is used again.
            self.met[kind] = met;
        }
        if goes_on {
            self.leave_media(numbers, bounce, samples, radiance);
        }
        timed(Part::Shadow, || self.follow_shadows(samples, cancel, radiance));
        self.paths.swap(0, 1);
    }
}

/// The kind of the BSDF of a primitive. A matte surface reflects one color everywhere, by its own normal.
fn kind_of(scene: &Scene, primitive: u32) -> usize {
    let (plan, geometry) = (scene.plan(), scene.geometry());
    let shape = geometry.locate(primitive).0;
    let kind = plan.kind_of_shape(shape);
    let is_matte = || plan.diffuse(shape).is_some() && !geometry.has_normal_at(primitive);
    if kind == Plan::DIFFUSE && !is_matte() { Plan::MIXED } else { kind }
}

impl Worker for WavefrontWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        let columns = CameraSamples::of(samples);
        self.radiance_of_columns(&columns, &[], &mut Vec::new(), cancel, radiance);
    }

    fn radiance_in_groups(
        &mut self,
        samples: &mut [CameraSample],
        groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.radiance_of_columns(&CameraSamples::of(samples), groups, &mut Vec::new(), cancel, radiance);
    }

    fn radiance_of_columns(
        &mut self,
        samples: &CameraSamples,
        groups: &[u32],
        _: &mut Vec<CameraSample>,
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        assert_eq!(samples.len, radiance.len());
        radiance.fill(Rgb::ZERO);
        if self.shares() {
            let each = vec![1; if groups.is_empty() { samples.len } else { 0 }];
            return self.follow_groups(samples, if groups.is_empty() { &each } else { groups }, cancel, radiance);
        }
        // Each sample is on its own, so that paths that split may be taken in smaller batches.
        let PathSettings { splits, light_samples, gather, follow, .. } = self.settings;
        let batch = if follow == Follow::DeltaLobes { BATCH / 8 } else { BATCH };
        let ways = splits.max(light_samples).max(gather.map_or(1, |gather| gather.rays));
        let batch = (batch / ways as usize).max(LANES);
        for start in (0..samples.len).step_by(batch) {
            let end = samples.len.min(start + batch);
            self.follow(samples, start..end, &[], cancel, &mut radiance[start..end]);
        }
    }
}
