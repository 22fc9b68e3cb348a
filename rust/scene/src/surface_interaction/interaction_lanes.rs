//! Surface interactions in structure-of-arrays form.

use super::SurfaceInteraction;
use crate::{SurfaceLanes, SurfacePoint};
use raywright_base::math::{Frame, LANES, VectorLanes};
use raywright_optics::Bsdf;

/// Surface interactions without their BSDFs, one per lane.
#[derive(Clone, Debug)]
pub struct SurfaceInteractionLanes {
    surface: SurfaceLanes,
    tangent: VectorLanes,
    bitangent: VectorLanes,
    /// z axis of the shading frame.
    up: VectorLanes,
    wo: VectorLanes,
    side: [f64; LANES],
    curvature: [f64; LANES],
    // Flags as wide as the other elements of a lane.
    is_flat: [u64; LANES],
    is_bent: [u64; LANES],
    as_given: [u64; LANES],
}

impl SurfaceInteractionLanes {
    /// Interactions at these points; all other fields must be set.
    pub fn at(surface: &SurfaceLanes) -> Self {
        let nothing = VectorLanes::ZERO;
        Self {
            surface: surface.clone(),
            tangent: nothing,
            bitangent: nothing,
            up: nothing,
            wo: nothing,
            side: [0.0; LANES],
            curvature: [0.0; LANES],
            is_flat: [0; LANES],
            is_bent: [0; LANES],
            as_given: [0; LANES],
        }
    }

    /// Replaces the points; all other fields must be set.
    pub fn set_surfaces(&mut self, surface: &SurfaceLanes) {
        self.surface.clone_from(surface);
    }

    /// The interaction in a lane, with its BSDF.
    #[inline(always)]
    pub fn get<B: Bsdf>(&self, lane: usize, bsdf: B) -> SurfaceInteraction<B> {
        SurfaceInteraction { as_given: self.is_as_given(lane), ..self.faded(lane, bsdf) }
    }

    /// Returns whether the shading normal of a lane is used as given.
    #[inline(always)]
    pub fn is_as_given(&self, lane: usize) -> bool {
        self.as_given[lane] != 0
    }

    /// The interaction in a lane, treated as if its normal were not used as given. Lane loops have no code for the few
    /// that are; these are corrected afterwards.
    #[inline(always)]
    pub fn faded<B: Bsdf>(&self, lane: usize, bsdf: B) -> SurfaceInteraction<B> {
        SurfaceInteraction {
            surface: self.surface.get(lane),
            frame: Frame {
                tangent: self.tangent.get(lane),
                bitangent: self.bitangent.get(lane),
                normal: self.up.get(lane),
            },
            bsdf,
            wo: self.wo.get(lane),
            side: self.side[lane],
            is_flat: self.is_flat[lane] != 0,
            is_bent: self.is_bent[lane] != 0,
            as_given: false,
            curvature: self.curvature[lane],
        }
    }

    /// The surface point of a lane.
    #[inline(always)]
    pub fn surface(&self, lane: usize) -> SurfacePoint {
        self.surface.get(lane)
    }

    /// Directions back along the rays of all lanes, in the shading frames.
    #[inline(always)]
    pub fn wo_lanes(&self) -> &VectorLanes {
        &self.wo
    }

    /// Mean curvature of a lane; see [`SurfaceInteraction::curvature`].
    #[inline(always)]
    pub fn curvature(&self, lane: usize) -> f64 {
        self.curvature[lane]
    }

    /// Sets the interaction of a lane, except its point.
    #[inline(always)]
    pub fn set<B: Bsdf>(&mut self, lane: usize, here: &SurfaceInteraction<B>) {
        self.tangent.set(lane, here.frame.tangent);
        self.bitangent.set(lane, here.frame.bitangent);
        self.up.set(lane, here.frame.normal);
        self.wo.set(lane, here.wo);
        self.side[lane] = here.side;
        self.curvature[lane] = here.curvature;
        self.is_flat[lane] = here.is_flat.into();
        self.is_bent[lane] = here.is_bent.into();
        self.as_given[lane] = here.as_given.into();
    }
}
