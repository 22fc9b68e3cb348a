//! Paths that are guided to where light comes from by way of mirrors and glass: what the stages of
//! [`super::bsdf_block`] add where there is a guide.

use crate::{Guide, LocalGuide, is_matt, roulette};
use raywright_base::math::{DVec3, LANES, SingleLanes};
use raywright_base::simd::Level;
use raywright_optics::{BsdfSampleLanes, Rgb};
use raywright_scene::materials::BsdfMix;
use std::array::from_fn;

/// Where light comes from at sixteen surfaces, and how their paths were aimed.
pub(super) struct GuidedBlock<'a> {
    guide: Option<&'a Guide>,
    locals: [Option<LocalGuide<'a>>; LANES],
    /// Ratio of the density of sampled directions to that of BSDF sampling, since the last matte surface.
    pub aimed: [f32; LANES],
    /// Where roulette was played already, and where it ended the path.
    pub has_played: [bool; LANES],
    pub ends: [bool; LANES],
}

/// So that it stays finite.
const MOST_AIMED: f32 = 1e30;

impl<'a> GuidedBlock<'a> {
    pub fn new(guide: Option<&'a Guide>) -> Self {
        let no = [false; LANES];
        Self { guide, locals: [None; LANES], aimed: [1.0; LANES], has_played: no, ends: no }
    }

    /// Forgets the surfaces.
    pub fn clear(&mut self) {
        (self.locals, self.has_played, self.ends) = ([None; LANES], [false; LANES], [false; LANES]);
    }

    /// A path comes to the surface of a lane.
    ///
    /// One that was aimed and has come to a matte surface has missed what it was aimed at, or has found what is
    /// brightly lit. Roulette continues it by its contribution, multiplied by a gain where more light arrives than
    /// elsewhere. Other paths are left to the roulette that all paths play.
    pub fn arrive(
        &mut self,
        lane: usize,
        (position, bsdf): (DVec3, &BsdfMix),
        (scale, chance): (f32, f64),
        throughput: &mut SingleLanes,
    ) {
        let Some(guide) = self.guide.filter(|_| is_matt(bsdf)) else { return };
        let local = guide.at(position);
        self.locals[lane] = local;
        let denser = std::mem::replace(&mut self.aimed[lane], 1.0);
        if denser <= 1.0 {
            return;
        }
        let gain = local.map_or(1.0, |local| local.gain());
        self.aimed[lane] = denser.min((gain * gain) as f32);
        let t = throughput.get(lane);
        let brings = Rgb::from_array(t.as_dvec3().to_array());
        let survival = roulette::survival(brings, f64::from(scale * self.aimed[lane]));
        self.has_played[lane] = true;
        self.ends[lane] = chance >= survival;
        throughput.set(lane, t / survival as f32);
    }

    /// The density of a direction that the surface of a lane draws with `pdf`, where paths aim as well.
    #[inline]
    pub fn density(&self, level: Level, lane: usize, pdf: f64, direction: DVec3) -> f64 {
        self.locals[lane].as_ref().map_or(pdf, |local| pdf + local.share() * (local.pdf(level, direction) - pdf))
    }

    /// Return whether any surface has a guide.
    #[inline]
    pub fn is_here(&self) -> bool {
        self.guide.is_some() && self.locals.iter().any(Option::is_some)
    }

    /// Return the lanes that aim, by their choices, which are rescaled to be uniform again.
    pub fn aims(&self, goes: &[bool; LANES], choice: &mut [f64; LANES]) -> [bool; LANES] {
        from_fn(|lane| {
            let Some(local) = self.locals[lane].as_ref().filter(|_| goes[lane]) else { return false };
            let (share, chosen) = (local.share(), choice[lane]);
            let aims = chosen < share;
            let left = if aims { chosen / share } else { (chosen - share) / (1.0 - share) };
            choice[lane] = left.min(1f64.next_down());
            aims
        })
    }

    /// A direction in the world, of a lane that aims.
    pub fn sample(&self, lane: usize, choice: f64, u: [f64; 2]) -> Option<DVec3> {
        self.locals[lane].as_ref().map(|local| local.sample(choice, u))
    }

    /// Gives a BSDF sample the density of aiming and scattering together (Veach and Guibas, 1995: the one-sample
    /// model); `direction` is in the world.
    pub fn mix(&mut self, level: Level, lane: usize, direction: DVec3, drawn: &mut BsdfSampleLanes) {
        let Some(local) = self.locals[lane] else { return };
        let pdf = drawn.pdf[lane];
        let denser = if pdf == f64::INFINITY {
            1.0 - local.share()
        } else {
            drawn.pdf[lane] = self.density(level, lane, pdf, direction);
            drawn.pdf[lane] / pdf
        };
        drawn.weight.set(lane, drawn.weight.get(lane) / denser);
        self.aim(lane, denser);
    }

    /// A path goes on along a direction that was drawn so much more densely than the surface scatters into it.
    #[inline]
    pub fn aim(&mut self, lane: usize, denser: f64) {
        self.aimed[lane] = (self.aimed[lane] * denser as f32).min(MOST_AIMED);
    }
}
