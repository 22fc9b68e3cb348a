//! BSDF samples in structure-of-arrays form.

use super::{BsdfSample, RgbLanes};
use raywright_base::math::{LANES, VectorLanes};

/// BSDF samples, one per lane; [`BsdfSample`] without choice numbers.
#[derive(Clone, Debug)]
pub struct BsdfSampleLanes {
    /// Incident directions.
    pub wi: VectorLanes,
    /// Throughput factors.
    pub weight: RgbLanes,
    /// Densities; 0 if the sample scatters nothing.
    pub pdf: [f64; LANES],
    /// Index of refraction on the side of `wi` over that on the opposite side.
    pub eta: [f64; LANES],
    /// True if `wi` is on the opposite side of the surface.
    pub is_through: [bool; LANES],
}

impl BsdfSampleLanes {
    /// Sixteen empty samples.
    pub const NONE: Self = Self {
        wi: VectorLanes::ZERO,
        weight: RgbLanes::ZERO,
        pdf: [0.0; LANES],
        eta: [1.0; LANES],
        is_through: [false; LANES],
    };

    /// The sample of a lane; `None` if it is empty.
    #[inline]
    pub fn get(&self, lane: usize) -> Option<BsdfSample> {
        let drawn = BsdfSample::new(self.wi.get(lane), self.weight.get(lane), self.pdf[lane]);
        let drawn = BsdfSample { eta: self.eta[lane], is_through: self.is_through[lane], ..drawn };
        (drawn.pdf > 0.0).then_some(drawn)
    }

    /// Copies some lanes.
    #[inline]
    pub fn take(&mut self, lanes: &[bool; LANES], from: &Self) {
        for lane in (0..LANES).filter(|&lane| lanes[lane]) {
            self.wi.set(lane, from.wi.get(lane));
            self.weight.set(lane, from.weight.get(lane));
            (self.pdf[lane], self.eta[lane]) = (from.pdf[lane], from.eta[lane]);
            self.is_through[lane] = from.is_through[lane];
        }
    }

    /// Sets the sample of a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, drawn: Option<BsdfSample>) {
        let Some(BsdfSample { wi, weight, pdf, eta, is_through, .. }) = drawn else {
            self.pdf[lane] = 0.0;
            return;
        };
        self.wi.set(lane, wi);
        self.weight.set(lane, weight);
        (self.pdf[lane], self.eta[lane], self.is_through[lane]) = (pdf, eta, is_through);
    }
}
