//! Receivers and light samples in structure-of-arrays form.

use super::{LightSample, LightSampleContext};
use crate::RayOrigin;
use raywright_base::math::{DVec3, LANES, Ray, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_optics::spectra::Waves;
use raywright_optics::{Rgb, RgbLanes};

/// Receivers, one per lane.
#[derive(Clone, Debug)]
pub struct LightContextLanes {
    pub(super) position: VectorLanes,
    pub(super) normal: VectorLanes,
    waves: [Option<Waves>; LANES],
}

impl LightContextLanes {
    /// Sixteen receivers without position.
    pub const NONE: Self = Self { position: VectorLanes::ZERO, normal: VectorLanes::ZERO, waves: [None; LANES] };

    /// The receiver in a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> LightSampleContext {
        let (position, normal) = (self.position.get(lane), self.normal.get(lane));
        LightSampleContext { position, normal, waves: self.waves[lane] }
    }

    /// Sets the wavelengths of a lane.
    #[inline]
    pub fn set_waves(&mut self, lane: usize, waves: Option<Waves>) {
        self.waves[lane] = waves;
    }

    /// Sets the receiver of a lane, except its wavelengths.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, receiver: &LightSampleContext) {
        self.position.set(lane, receiver.position);
        self.normal.set(lane, receiver.normal);
    }
}

/// Light samples, one per lane.
#[derive(Clone, Debug)]
pub struct LightLanes {
    pub(super) direction: VectorLanes,
    pub(super) weight: RgbLanes,
    /// 0 if the sample carries no light.
    pub(super) pdf: [f64; LANES],
    /// Position on the light, and the ray offset from its surface.
    pub(super) position: VectorLanes,
    pub(super) offset: VectorLanes,
    /// True if the light is within the scene.
    pub(super) is_within: [bool; LANES],
    /// Primitive of the light, as in [`LightSample`].
    pub(super) primitive: [u32; LANES],
}

impl LightLanes {
    /// Sixteen empty samples.
    pub const NONE: Self = Self {
        direction: VectorLanes::ZERO,
        weight: RgbLanes::ZERO,
        pdf: [0.0; LANES],
        position: VectorLanes::ZERO,
        offset: VectorLanes::ZERO,
        is_within: [false; LANES],
        primitive: [Ray::NO_TRIANGLE; LANES],
    };

    /// Direction to a lane's light, weight and density, as in [`LightSample`]; the density of an empty sample is 0.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> (DVec3, Rgb, f64) {
        (self.direction.get(lane), self.weight.get(lane), self.pdf[lane])
    }

    /// Ray origin on a lane's light, and whether the light is within the scene.
    #[inline(always)]
    pub fn source(&self, lane: usize) -> (RayOrigin, bool) {
        (RayOrigin::with(self.position.get(lane), self.offset.get(lane)), self.is_within[lane])
    }

    /// Primitive of a lane's light, as in [`LightSample`].
    #[inline(always)]
    pub fn primitive(&self, lane: usize) -> u32 {
        self.primitive[lane]
    }

    /// The sample of a lane; `None` if it carries no light.
    pub fn sample(&self, lane: usize) -> Option<LightSample> {
        let ((direction, weight, pdf), (source, is_within)) = (self.get(lane), self.source(lane));
        let (source, primitive) = (is_within.then_some(source), self.primitive[lane]);
        (pdf > 0.0).then_some(LightSample { direction, weight, pdf, source, primitive })
    }

    /// Samples each lane by a scalar function.
    pub(super) fn draw_each(
        &mut self,
        receivers: &LightContextLanes,
        u: &Pairs,
        sample: impl Fn(&LightSampleContext, [f64; 2]) -> Option<LightSample>,
    ) {
        for lane in 0..LANES {
            self.set(lane, sample(&receivers.get(lane), [u[0][lane], u[1][lane]]));
        }
    }

    /// Copies the sample of a lane.
    pub fn copy(&mut self, lane: usize, others: &Self) {
        self.direction.set(lane, others.direction.get(lane));
        self.weight.set(lane, others.weight.get(lane));
        self.pdf[lane] = others.pdf[lane];
        self.position.set(lane, others.position.get(lane));
        self.offset.set(lane, others.offset.get(lane));
        (self.is_within[lane], self.primitive[lane]) = (others.is_within[lane], others.primitive[lane]);
    }

    /// Sets the sample of a lane.
    pub(super) fn set(&mut self, lane: usize, sample: Option<LightSample>) {
        let Some(LightSample { direction, weight, pdf, source, primitive }) = sample else {
            self.pdf[lane] = 0.0;
            return;
        };
        let from = source.unwrap_or(RayOrigin::free(DVec3::ZERO));
        self.direction.set(lane, direction);
        self.weight.set(lane, weight);
        self.pdf[lane] = pdf;
        self.position.set(lane, from.position());
        self.offset.set(lane, from.offset());
        self.is_within[lane] = source.is_some();
        self.primitive[lane] = primitive;
    }
}
