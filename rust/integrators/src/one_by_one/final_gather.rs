//! Paths at vertices with precomputed light: they end there, or continue with final gather rays.

use super::camera_paths::Walker;
use super::path_state::PathState;
use crate::is_matt;
use crate::known_light::Visit;
use crate::media::scattering::Scattering;
use raywright_optics::Rgb;
use raywright_scene::SurfaceInteraction;

/// Use of precomputed light at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Arrival {
    /// None: the path is scattered as usual.
    GoesOn,
    /// The path is scattered, but direct light was included in the lookup that its final gather ray started from.
    IsLit,
    /// The surface has precomputed light, and a number of final gather rays start there.
    IsKnown(u32),
}

impl Arrival {
    /// Return whether direct light is already included.
    pub fn is_lit(self) -> bool {
        self == Self::IsLit
    }

    /// Return whether all light but direct light is precomputed.
    pub fn is_known(self) -> bool {
        matches!(self, Self::IsKnown(_))
    }

    /// Return the number of paths that continue.
    pub fn splits(self) -> f64 {
        if let Self::IsKnown(rays) = self { f64::from(rays) } else { 1.0 }
    }
}

impl Walker<'_> {
    fn visit(&self, path: &PathState, number: u32, looks_about: bool) -> Visit {
        let bounces = self.settings.max_depth.map(|depth| depth.saturating_sub(path.bounce + 1));
        Visit { number, looks_about, has_gamut_excess: path.has_gamut_excess, single: path.single, bounces }
    }

    /// Return the precomputed in-scattered radiance at a scattering event, for a sample index.
    pub(super) fn known_among(&self, path: &PathState, here: &Scattering, number: u32) -> Rgb {
        if self.settings.max_depth.is_some_and(|most| path.bounce >= most) {
            return Rgb::ZERO;
        }
        let known = self.known.map(|known| {
            let visit = self.visit(path, number, false);
            known.among(here, &path.media, path.ray.time, visit)
        });
        path.weights.throughput() * known.unwrap_or(Rgb::ZERO)
    }

    /// Return whether emission at the end of a path was included in the lookup that its final gather ray started from.
    pub(super) fn is_shining_known(&self, path: &PathState) -> bool {
        self.settings.gather.is_some_and(|gather| gather.caustic) && path.is_sharp_since
    }

    /// Decide how a path continues from a surface, and add its precomputed light.
    pub(super) fn arrive(&self, path: &PathState, here: &SurfaceInteraction, number: u32, light: &mut Rgb) -> Arrival {
        let (Some(known), Some(gather)) = (self.known, self.settings.gather) else { return Arrival::GoesOn };
        if !is_matt(here.bsdf()) {
            return if gather.caustic && path.is_gathered { Arrival::IsLit } else { Arrival::GoesOn };
        }
        let rays = if path.is_gathered { 0 } else { gather.rays };
        *light += path.weights.throughput() * known.at_surface(&here.by_ref(), self.visit(path, number, rays > 0));
        Arrival::IsKnown(rays)
    }
}
