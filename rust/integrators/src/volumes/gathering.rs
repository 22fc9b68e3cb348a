//! Paths where light is known: they end there, or look about once.

use super::path_state::PathState;
use super::scattering::Scattering;
use super::walker::Walker;
use crate::is_matt;
use crate::transport::Visit;
use raywright_optics::Rgb;
use raywright_scene::SurfaceInteraction;

/// What becomes of a path at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Arrival {
    /// It is scattered as any.
    GoesOn,
    /// The same, but what lights send there was known where the path looked about.
    IsLit,
    /// Light is known there, and so many paths look about.
    IsKnown(u32),
}

impl Arrival {
    /// Whether what lights send is known.
    pub fn is_lit(self) -> bool {
        self == Self::IsLit
    }

    /// Whether all light is, but what comes straight from lights.
    pub fn is_known(self) -> bool {
        matches!(self, Self::IsKnown(_))
    }

    /// Into how many paths that goes on.
    pub fn splits(self) -> f64 {
        if let Self::IsKnown(rays) = self { f64::from(rays) } else { 1.0 }
    }
}

impl<A> Walker<'_, A> {
    fn visit(&self, path: &PathState, number: u32, looks_about: bool) -> Visit {
        let bounces = self.settings.max_depth.map(|depth| depth.saturating_sub(path.bounce + 1));
        Visit { number, looks_about, gilded: path.gilded, single: path.single, bounces }
    }

    /// What is known of light where a medium scatters a path, of a sample of a number.
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

    /// Whether what shines at the end of a path was known where that looked about.
    pub(super) fn is_shining_known(&self, path: &PathState) -> bool {
        self.settings.gather.is_some_and(|gather| gather.caustic) && path.is_sharp_since
    }

    /// What becomes of a path at a surface; what is known of light there is added.
    pub(super) fn arrive(&self, path: &PathState, here: &SurfaceInteraction, number: u32, light: &mut Rgb) -> Arrival {
        let (Some(known), Some(gather)) = (self.known, self.settings.gather) else { return Arrival::GoesOn };
        if !is_matt(here.bsdf()) {
            return if gather.caustic && path.is_gathered { Arrival::IsLit } else { Arrival::GoesOn };
        }
        let rays = if path.is_gathered { 0 } else { gather.rays };
        *light += path.weights.throughput() * known.at_surface(here, self.visit(path, number, rays > 0));
        Arrival::IsKnown(rays)
    }
}
