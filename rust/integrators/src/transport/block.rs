//! Sixteen encounters at a time.

use super::guided::Arrival;
use super::path_state::PathState;
use crate::dimensions::Dimensions;
use crate::terminate_wavelengths::Parting;
use crate::{CameraSample, LocalGuide};
use raywright_base::math::{Hit, LANES, Ray, RayLanes, VectorLanes};
use raywright_base::sampling::SamplerLanes;
use raywright_optics::RgbLanes;
use raywright_scene::materials::{BsdfLanes, BsdfMix};
use raywright_scene::{LightContextLanes, SurfaceInteraction, SurfaceInteractionLanes, SurfaceLanes};

/// Paths that have come to surfaces, at most sixteen, a lane each. The last stands in the lanes that are left.
pub(super) struct Block<'a> {
    pub count: usize,
    /// Where each stands in the queue.
    pub index: [u32; LANES],
    pub rays: [Ray; LANES],
    pub hits: [Hit; LANES],
    pub paths: [PathState; LANES],
    /// Whether they go on from there.
    pub goes_on: [bool; LANES],
    pub dimensions: [Dimensions; LANES],
    pub numbers: SamplerLanes,
    pub surfaces: SurfaceLanes,
    pub encounters: SurfaceInteractionLanes,
    pub receivers: LightContextLanes,
    pub throughput: RgbLanes,
    /// Whether all of them are with what scatters by one diffuse color.
    pub is_diffuse: bool,
    /// Those colors.
    pub reflectance: RgbLanes,
    /// Otherwise how each scatters, how wide its ray is, where light comes from by way of what is sharp, and whether
    /// roulette has been played.
    pub bsdf: BsdfLanes<'a>,
    pub width: [f64; LANES],
    /// What parts the wavelengths of their paths that are to go on.
    pub parting: [Option<Parting>; LANES],
    pub guides: [Option<LocalGuide<'a>>; LANES],
    pub arrivals: [Arrival; LANES],
}

impl Block<'_> {
    /// Without any path.
    pub fn new(sample: &CameraSample) -> Self {
        let surfaces = SurfaceLanes::NONE;
        Self {
            count: 0,
            index: [0; LANES],
            rays: [sample.ray; LANES],
            hits: [Hit::MISS; LANES],
            paths: [PathState::of_camera(0); LANES],
            goes_on: [false; LANES],
            dimensions: [Dimensions::of(0, 0); LANES],
            numbers: SamplerLanes::new(&sample.sampler),
            encounters: SurfaceInteractionLanes::at(&surfaces),
            surfaces,
            receivers: LightContextLanes::NONE,
            throughput: RgbLanes::ZERO,
            is_diffuse: false,
            reflectance: RgbLanes::ZERO,
            bsdf: BsdfLanes::default(),
            width: [0.0; LANES],
            parting: [None; LANES],
            guides: [None; LANES],
            arrivals: [Arrival::GoesOn; LANES],
        }
    }

    /// A ray that leaves the surface of a lane, at the time of the path that came there.
    #[inline(always)]
    pub fn leaving(&self, lane: usize, ray: Ray) -> Ray {
        Ray { time: self.rays[lane].time, misses: [self.hits[lane].primitive, Ray::NO_TRIANGLE], ..ray }
    }

    /// Rays that leave the surfaces of all lanes, at the times of the paths that came there.
    #[inline(always)]
    pub fn all_leaving(&self, origin: VectorLanes, direction: VectorLanes, t_max: [f64; LANES]) -> RayLanes {
        let (mut time, mut misses) = ([0.0; LANES], [[Ray::NO_TRIANGLE; 2]; LANES]);
        for lane in 0..LANES {
            time[lane] = self.rays[lane].time;
            misses[lane][0] = self.hits[lane].primitive;
        }
        RayLanes { origin, direction, t_max, time, misses }
    }

    /// The encounter of a lane with any other.
    #[inline(always)]
    pub fn other(&self, lane: usize) -> SurfaceInteraction<&BsdfMix> {
        self.encounters.get(lane, self.bsdf.get(lane))
    }
}
