//! Surfaces that scatter in any way, sixteen at a time. Their BSDFs are those of all other integrators, in f64.

use super::guided::GuidedBlock;
use super::queues::Flags;
use super::shading_frames::ShadingFrames;
use super::waves::WavesBlock;
use super::ways::Way;
use crate::Guide;
use crate::terminate_wavelengths::Parting;
use crate::widths::widened;
use raywright_base::math::single::mask;
use raywright_base::math::{DVec3, Hit, LANES, PathRays, Ray, SingleLanes, Vec3, VectorLanes, select};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use raywright_optics::{Bsdf, BsdfSample, BsdfSampleLanes, Null, Rgb, RgbLanes};
use raywright_scene::materials::{BsdfLanes, BsdfMix};
use raywright_scene::{Footprint, LightBlock, LookupContext, Scene, SurfaceBlock, SurfaceInteraction};
use std::borrow::Cow;

/// The BSDFs of sixteen surfaces.
pub(super) struct BsdfBlock<'a> {
    bsdf: BsdfLanes<'a>,
    drawn: BsdfSampleLanes,
    frames: ShadingFrames,
    /// BSDFs by shape and side and by the index of refraction around.
    surrounded: Vec<((u32, u32, f64), BsdfMix)>,
    /// The densities with which surfaces scatter into the directions of [`BsdfBlock::reflect`].
    pub pdf: [f64; LANES],
    /// Where light is asked for, and where each of few lights is.
    pub asks: [bool; LANES],
    pub asks_each: [bool; LANES],
    /// Minimum density of directions that are followed, and number of paths in these for each light sample.
    pub least_pdf: [f64; LANES],
    pub follows: [f64; LANES],
    /// Normals that light is drawn by: zero where a surface transmits.
    pub normal: SingleLanes,
    /// Of the paths, the ratio of radiance at their start to radiance here, and [`Flags`].
    pub scale: [f32; LANES],
    pub flags: [u32; LANES],
    /// Widths of the bundles of neighboring rays at the surfaces, 0 where none are known, and how much wider these get
    /// by length.
    pub width: [f32; LANES],
    pub spread: [f32; LANES],
    pub guided: GuidedBlock<'a>,
}

/// Where sixteen paths go on to.
pub(super) struct Scattered {
    pub origin: VectorLanes,
    pub direction: SingleLanes,
    pub throughput: SingleLanes,
    pub pdf: [f32; LANES],
    pub scale: [f32; LANES],
    pub flags: [u32; LANES],
    pub spread: [f32; LANES],
}

loops! {
    /// Light samples times throughput, BSDF and MIS weight. The product is in f64: next to a mirror, f32 does not hold
    /// its factors.
    fn weigh(
        throughput: &SingleLanes,
        lights: &LightBlock,
        scattered: &RgbLanes,
        pdf: &[f64; LANES],
        counts: &[f64; LANES],
        asks: &[bool; LANES],
        follows: &[f64; LANES],
        least_pdf: &[f64; LANES],
        share: f64,
        arriving: &mut RgbLanes,
    ) {
        for i in 0..LANES {
            let followed = if pdf[i] >= least_pdf[i] { follows[i] } else { 0.0 };
            let ratio = followed * pdf[i] / f64::from(lights.pdf[i]);
            let (t, light) = (throughput.get(i).as_dvec3(), lights.weight.get(i).as_dvec3());
            let factor = share * counts[i] / (1.0 + ratio * ratio);
            let all = scattered.get(i) * Rgb::from_array((t * light * factor).to_array());
            arriving.set(i, Rgb::select(asks[i] & (lights.pdf[i] > 0.0), all, Rgb::ZERO));
        }
    }
}

loops! {
    /// From BSDF samples to the paths that go on; those with directions that do not count end.
    fn leave(
        surfaces: &SurfaceBlock,
        throughput: &SingleLanes,
        drawn: &BsdfSampleLanes,
        counts: &[f64; LANES],
        next: &mut Scattered,
    ) {
        for i in 0..LANES {
            next.throughput.set(i, throughput.get(i) * (drawn.weight.get(i) * counts[i]).as_vec3());
            next.pdf[i] = if counts[i] > 0.0 { drawn.pdf[i] as f32 } else { 0.0 };
            next.scale[i] *= (drawn.eta[i] * drawn.eta[i]) as f32;
            let (front, behind) = (surfaces.origin.get(i), surfaces.origin_behind(i));
            next.origin.set(i, select(drawn.is_through[i], behind, front));
        }
    }
}

impl Scattered {
    /// Of no paths.
    pub const NONE: Self = Self {
        origin: VectorLanes::ZERO,
        direction: SingleLanes::ZERO,
        throughput: SingleLanes::ZERO,
        pdf: [0.0; LANES],
        scale: [1.0; LANES],
        flags: [0; LANES],
        spread: [0.0; LANES],
    };
}

impl<'a> BsdfBlock<'a> {
    /// With directions that are followed from a density on.
    pub fn new(are_flat: bool, guide: Option<&'a Guide>, least_pdf: f64) -> Self {
        Self {
            bsdf: BsdfLanes::default(),
            drawn: BsdfSampleLanes::NONE,
            frames: ShadingFrames::new(are_flat),
            surrounded: Vec::new(),
            pdf: [0.0; LANES],
            asks: [false; LANES],
            asks_each: [false; LANES],
            least_pdf: [least_pdf; LANES],
            follows: [1.0; LANES],
            normal: SingleLanes::ZERO,
            scale: [1.0; LANES],
            flags: [0; LANES],
            width: [0.0; LANES],
            spread: [0.0; LANES],
            guided: GuidedBlock::new(guide),
        }
    }

    /// Stage: materials are asked how surfaces scatter at the wavelengths of paths, in surroundings of these indices of
    /// refraction. `chance` is for the roulette of paths that were aimed.
    #[allow(clippy::too_many_arguments)]
    pub fn evaluate_materials(
        &mut self,
        level: Level,
        scene: &'a Scene,
        met: (&PathRays, &[Hit]),
        surfaces: &SurfaceBlock,
        (outside, spectral): (&[f64; LANES], &mut WavesBlock),
        chance: &[f64; LANES],
        throughput: &mut SingleLanes,
    ) {
        self.guided.clear();
        self.frames.meet(level, scene.geometry(), met, surfaces);
        self.bsdf.clear();
        (self.asks, self.asks_each) = ([false; LANES], [false; LANES]);
        for lane in 0..surfaces.count {
            let (plan, width) = (scene.plan(), f64::from(self.width[lane]));
            let (waves, is_front) = (spectral.waves[lane], surfaces.is_front[lane] != 0);
            let (outside, parting) = match &waves {
                Some(waves) => {
                    let material = match self.frames.surface(lane) {
                        Some(surface) => scene.material_at(&surface),
                        None => scene.material(surfaces.shape[lane]),
                    };
                    Parting::at(material, is_front, (outside[lane], spectral.around[lane]), waves)
                }
                None => (outside[lane], None),
            };
            let bsdf = match plan.constant(surfaces.shape[lane], is_front) {
                Some(bsdf) if width == 0.0 && outside == 1.0 => Cow::Borrowed(bsdf),
                Some(_) if width == 0.0 && waves.is_none() => {
                    Cow::Owned(self.surrounded(scene, (met, surfaces), lane, outside))
                }
                _ => {
                    let surface = self.frames.surface(lane).filter(|_| width == 0.0);
                    let by_waves = surface.zip(waves).and_then(|(surface, waves)| {
                        SurfaceInteraction::bsdf_by_waves(scene, surface, is_front, waves, outside)
                    });
                    let made = by_waves.or_else(|| {
                        self.frames.replace(lane, |ray, hit, surface| {
                            SurfaceInteraction::new(scene, ray, hit, surface, LookupContext { width, waves }, outside)
                        })
                    });
                    Cow::Owned(made.unwrap_or_else(|| Null.into()))
                }
            };
            self.bsdf.push(bsdf);
            self.bsdf.prepare(self.frames.wo.get(lane));
            let bsdf = self.bsdf.get(lane);
            spectral.parting[lane] = parting.filter(|parting| parting.waits(bsdf));
            spectral.ends[lane] = parting.is_some() && spectral.parting[lane].is_none();
            self.asks[lane] = !bsdf.is_delta();
            self.asks_each[lane] = plan.asks_each(|| bsdf.roughness());
            let normal = if bsdf.transmits() { DVec3::ZERO } else { self.frames.normal(surfaces, lane).0 };
            self.normal.set(lane, normal.as_vec3());
            let at = (surfaces.position.get(lane), bsdf);
            self.guided.arrive(lane, at, (self.scale[lane], chance[lane]), throughput);
            self.asks[lane] &= !self.guided.ends[lane];
        }
    }

    /// The BSDF of a material that is the same everywhere, in surroundings of an index of refraction.
    fn surrounded(
        &mut self,
        scene: &Scene,
        (met, surfaces): ((&PathRays, &[Hit]), &SurfaceBlock),
        lane: usize,
        outside: f64,
    ) -> BsdfMix {
        /// There are more than these in no scene that is worth it.
        const MOST: usize = 64;
        let of = (surfaces.shape[lane], surfaces.is_front[lane], outside);
        if let Some((_, bsdf)) = self.surrounded.iter().find(|(known, _)| *known == of) {
            return bsdf.clone();
        }
        let (ray, hit) = scene.geometry().hit_of_lane(met, surfaces, lane);
        let surface = scene.geometry().surface(&ray, &hit);
        let bsdf = SurfaceInteraction::new(scene, &ray, &hit, surface, LookupContext::default(), outside).into_bsdf();
        if self.surrounded.len() < MOST {
            self.surrounded.push((of, bsdf.clone()));
        }
        bsdf
    }

    /// The reflectance of the surface of a lane if that is matte, its shading normal, and whether that was bent towards
    /// the ray.
    pub fn matte(&self, surfaces: &SurfaceBlock, lane: usize) -> Option<(Rgb, Vec3, bool)> {
        let (normal, is_bent) = self.frames.normal(surfaces, lane);
        // A surface that one normal shows from above and the other from below scatters nothing.
        let is_seen = normal.dot(surfaces.direction.get(lane).as_dvec3()) < 0.0;
        let reflectance = self.bsdf.get(lane).diffuse().filter(|_| is_seen)?;
        Some((reflectance, normal.as_vec3(), is_bent))
    }

    /// The interaction of a lane with its ray and hit, where more is known than of its block.
    pub fn interaction(&self, lane: usize) -> Option<(&Ray, &Hit, SurfaceInteraction<&BsdfMix>)> {
        self.frames.interaction(lane, self.bsdf.get(lane))
    }

    /// The BSDF of a lane.
    pub fn get(&self, lane: usize) -> &BsdfMix {
        self.bsdf.get(lane)
    }

    /// Weighs light samples in some lanes, as a share of all samples there. `is_found` is true if paths may hit the
    /// light too.
    pub fn reflect(
        &mut self,
        level: Level,
        surfaces: &SurfaceBlock,
        lights: &LightBlock,
        throughput: &SingleLanes,
        (asks, is_found, share): (&[bool; LANES], bool, f64),
        arriving: &mut RgbLanes,
    ) {
        let (mut wi, mut scattered) = (VectorLanes::ZERO, RgbLanes::ZERO);
        let (mut pdf, mut counts) = ([0.0; LANES], [0.0; LANES]);
        self.frames.look(level, surfaces, &lights.direction, &mut wi, &mut counts);
        let follows = if is_found { &self.follows } else { &[0.0; LANES] };
        let asks = std::array::from_fn(|lane| asks[lane] && lights.pdf[lane] > 0.0 && counts[lane] > 0.0);
        self.bsdf.evaluate(level, &asks, &self.frames.wo, &wi, &mut scattered, &mut pdf);
        if self.guided.is_here() {
            for lane in (0..LANES).filter(|&lane| asks[lane]) {
                let direction = lights.direction.get(lane).as_dvec3();
                pdf[lane] = self.guided.density(level, lane, pdf[lane], direction);
            }
        }
        weigh(level, throughput, lights, &scattered, &pdf, &counts, &asks, follows, &self.least_pdf, share, arriving);
        self.pdf = pdf;
    }

    /// The density of following a direction, by its density of scattering, over that of its draw for light.
    pub fn ratio(&self, lane: usize, pdf: f64, drawn: f32) -> f32 {
        let is_followed = pdf >= self.least_pdf[lane] && drawn > 0.0;
        if is_followed { (self.follows[lane] * pdf / f64::from(drawn)) as f32 } else { 0.0 }
    }

    /// Stage: paths are scattered, some into delta lobes that are given.
    pub fn sample(
        &mut self,
        level: Level,
        surfaces: &SurfaceBlock,
        throughput: &SingleLanes,
        (choice, u): (&mut [f64; LANES], &Pairs),
        way: Option<&Way>,
        next: &mut Scattered,
    ) {
        let goes = std::array::from_fn(|lane| {
            lane < surfaces.count && !self.guided.ends[lane] && way.is_none_or(|way| way.is_drawn[lane])
        });
        if self.guided.is_here() {
            self.sample_guided(level, surfaces, &goes, (choice, u));
        } else {
            self.bsdf.sample(level, &goes, &self.frames.wo, (choice, u), &mut self.drawn);
        }
        if let Some(way) = way {
            way.leave(&self.least_pdf, &mut self.drawn);
        }
        (next.scale, next.flags) = (self.scale, self.flags);
        let (drawn, mut counts) = (&self.drawn, [0.0; LANES]);
        self.frames.leave(level, surfaces, (&drawn.wi, &drawn.pdf), &mut next.direction, &mut counts);
        leave(level, surfaces, throughput, drawn, &counts, next);
        if self.width.iter().any(|&width| width > 0.0) {
            for lane in 0..surfaces.count {
                let Some(drawn) = drawn.get(lane) else { continue };
                let before = Footprint { width: self.width[lane].into(), spread: self.spread[lane].into() };
                let after = widened(&before, before.width, self.frames.curvature(lane), &drawn);
                next.spread[lane] = after.spread as f32;
            }
        }
        for (flags, &each) in next.flags.iter_mut().zip(&self.asks_each) {
            *flags = *flags & !Flags::ASKED_EACH | Flags::ASKED_EACH & mask(each);
        }
    }

    /// The direction back along the ray of a lane, in its shading frame.
    pub fn wo(&self, lane: usize) -> DVec3 {
        self.frames.wo.get(lane)
    }

    /// Return whether the path of a lane has met a surface with a reflectance above 1 in a channel.
    pub fn has_gamut_excess(&self, lane: usize) -> bool {
        self.flags[lane] & Flags::HAS_GAMUT_EXCESS != 0
    }

    /// Return whether shading and geometric normal of a lane are equal.
    pub fn is_flat(&self, lane: usize) -> bool {
        self.frames.is_flat(lane)
    }

    /// Return the sample of a lane.
    pub fn drawn(&self, lane: usize) -> Option<BsdfSample> {
        self.drawn.get(lane)
    }

    /// Replace the sample of a lane.
    pub fn set_drawn(&mut self, lane: usize, drawn: Option<BsdfSample>) {
        self.drawn.set(lane, drawn);
    }

    /// Return whether a direction was drawn in a lane.
    pub fn goes_on(&self, lane: usize) -> bool {
        self.drawn.pdf[lane] > 0.0
    }

    /// Return whether the path of a lane follows a delta lobe.
    pub fn is_single(&self, lane: usize) -> bool {
        self.drawn.pdf[lane] == f64::INFINITY
    }

    /// Return whether the path of a lane is transmitted.
    pub fn is_through(&self, lane: usize) -> bool {
        self.goes_on(lane) && self.drawn.is_through[lane]
    }

    /// The same where surfaces have guides: some paths aim, the others are scattered.
    fn sample_guided(
        &mut self,
        level: Level,
        surfaces: &SurfaceBlock,
        goes: &[bool; LANES],
        (choice, u): (&mut [f64; LANES], &Pairs),
    ) {
        let aims = self.guided.aims(goes, choice);
        let scatters = std::array::from_fn(|lane| goes[lane] && !aims[lane]);
        self.bsdf.sample(level, &scatters, &self.frames.wo, (choice, u), &mut self.drawn);
        for lane in (0..LANES).filter(|&lane| scatters[lane]) {
            if self.drawn.pdf[lane] <= 0.0 {
                continue;
            }
            let direction = self.frames.to_world(surfaces, lane, self.drawn.wi.get(lane));
            self.guided.mix(level, lane, direction, &mut self.drawn);
        }
        if !aims.contains(&true) {
            return;
        }
        let (mut towards, mut wi, mut counts) = (VectorLanes::ZERO, VectorLanes::ZERO, [0.0; LANES]);
        for lane in (0..LANES).filter(|&lane| aims[lane]) {
            if let Some(direction) = self.guided.sample(lane, choice[lane], [u[0][lane], u[1][lane]]) {
                towards.set(lane, direction);
                let (local, count) = self.frames.to_local(surfaces, lane, direction);
                wi.set(lane, local);
                counts[lane] = count;
            }
        }
        let (mut value, mut pdf) = (RgbLanes::ZERO, [0.0; LANES]);
        self.bsdf.evaluate(level, &aims, &self.frames.wo, &wi, &mut value, &mut pdf);
        for lane in (0..LANES).filter(|&lane| aims[lane]) {
            let scattered = value.get(lane);
            if scattered.is_black() || pdf[lane] <= 0.0 || counts[lane] <= 0.0 {
                self.drawn.set(lane, None);
                continue;
            }
            let both = self.guided.density(level, lane, pdf[lane], towards.get(lane));
            self.drawn.set(lane, Some(BsdfSample::new(wi.get(lane), scattered / both, both)));
            self.guided.aim(lane, both / pdf[lane]);
        }
    }
}
