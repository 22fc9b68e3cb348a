//! Encounters by lane.

use super::Interaction;
use crate::math::{Frame, LANES, VectorLanes};
use crate::scene::{Scatters, SurfaceLanes};

/// Encounters, a lane each, but for how they scatter.
#[derive(Clone, Debug)]
pub struct InteractionLanes {
    surface: SurfaceLanes,
    tangent: VectorLanes,
    bitangent: VectorLanes,
    /// The z of the shading frame.
    up: VectorLanes,
    wo: VectorLanes,
    side: [f64; LANES],
    is_flat: [bool; LANES],
    is_bent: [bool; LANES],
}

impl InteractionLanes {
    /// With nothing.
    pub const NONE: Self = Self {
        surface: SurfaceLanes::NONE,
        tangent: VectorLanes::ZERO,
        bitangent: VectorLanes::ZERO,
        up: VectorLanes::ZERO,
        wo: VectorLanes::ZERO,
        side: [0.0; LANES],
        is_flat: [false; LANES],
        is_bent: [false; LANES],
    };

    /// The encounter of a lane, with what scatters there.
    #[inline(always)]
    pub fn get<S: Scatters>(&self, lane: usize, scattering: S) -> Interaction<S> {
        Interaction {
            surface: self.surface.get(lane),
            frame: Frame {
                tangent: self.tangent.get(lane),
                bitangent: self.bitangent.get(lane),
                normal: self.up.get(lane),
            },
            scattering,
            wo: self.wo.get(lane),
            side: self.side[lane],
            is_flat: self.is_flat[lane],
            is_bent: self.is_bent[lane],
            curvature: 0.0,
        }
    }

    /// Sets the encounter of a lane.
    #[inline(always)]
    pub fn set<S: Scatters>(&mut self, lane: usize, here: &Interaction<S>) {
        self.surface.set(lane, &here.surface);
        self.tangent.set(lane, here.frame.tangent);
        self.bitangent.set(lane, here.frame.bitangent);
        self.up.set(lane, here.frame.normal);
        self.wo.set(lane, here.wo);
        self.side[lane] = here.side;
        self.is_flat[lane] = here.is_flat;
        self.is_bent[lane] = here.is_bent;
    }
}
