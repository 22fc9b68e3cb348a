//! Continuations of sixteen paths: each has one or several.

use raywright_base::math::LANES;
use raywright_optics::{BsdfSample, BsdfSampleLanes};

/// One way, for some of sixteen paths.
#[derive(Clone)]
pub(super) struct Way {
    /// The samples that the paths become those of.
    pub sample: [u32; LANES],
    /// True if a direction is drawn.
    pub is_drawn: [bool; LANES],
    /// Delta lobes that paths follow as they are.
    pub lobe: [Option<BsdfSample>; LANES],
}

impl Way {
    /// Of paths of these samples that do not go on.
    pub fn of(sample: [u32; LANES]) -> Self {
        Self { sample, is_drawn: [false; LANES], lobe: [None; LANES] }
    }

    /// Replaces what was drawn by the lobes, and drops what is too thin to be followed.
    pub fn leave(&self, least_pdf: &[f64; LANES], drawn: &mut BsdfSampleLanes) {
        for lane in 0..LANES {
            match self.lobe[lane] {
                Some(lobe) => drawn.set(lane, Some(lobe)),
                None if drawn.pdf[lane] < least_pdf[lane] => drawn.pdf[lane] = 0.0,
                None => {}
            }
        }
    }
}
