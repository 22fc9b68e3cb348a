//! Directions drawn, by lane.

use super::{BsdfSample, RgbLanes};
use raywright_base::math::{LANES, VectorLanes};

/// What was drawn from functions, a lane each, as [`BsdfSample`] has it but for the choices.
#[derive(Clone, Debug)]
pub struct BsdfSampleLanes {
    /// Where light comes from.
    pub wi: VectorLanes,
    /// What a throughput is multiplied by.
    pub weight: RgbLanes,
    /// The density; 0 where the draw scatters nothing.
    pub pdf: [f64; LANES],
    /// The index of refraction on the side of `wi` over that on the other.
    pub eta: [f64; LANES],
    /// Whether `wi` is on the other side of the surface.
    pub is_through: [bool; LANES],
}

impl BsdfSampleLanes {
    /// Nothing.
    pub const NONE: Self = Self {
        wi: VectorLanes::ZERO,
        weight: RgbLanes::ZERO,
        pdf: [0.0; LANES],
        eta: [1.0; LANES],
        is_through: [false; LANES],
    };

    /// That of a lane; none where nothing was drawn.
    #[inline]
    pub fn get(&self, lane: usize) -> Option<BsdfSample> {
        let drawn = BsdfSample::new(self.wi.get(lane), self.weight.get(lane), self.pdf[lane]);
        let drawn = BsdfSample { eta: self.eta[lane], is_through: self.is_through[lane], ..drawn };
        (drawn.pdf > 0.0).then_some(drawn)
    }

    /// Takes some lanes from another.
    #[inline]
    pub fn take(&mut self, lanes: &[bool; LANES], from: &Self) {
        for lane in (0..LANES).filter(|&lane| lanes[lane]) {
            self.wi.set(lane, from.wi.get(lane));
            self.weight.set(lane, from.weight.get(lane));
            (self.pdf[lane], self.eta[lane]) = (from.pdf[lane], from.eta[lane]);
            self.is_through[lane] = from.is_through[lane];
        }
    }

    /// Sets that of a lane.
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
