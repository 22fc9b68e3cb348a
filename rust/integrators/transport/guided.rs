//! Paths that are guided to where light comes from by way of mirrors and glass.

use super::path_state::PathState;
use crate::integrators::{LocalGuide, roulette};
use crate::math::DVec3;
use crate::optics::BsdfSample;
use crate::scene::Encounter;

/// Plays roulette for a path that was aimed and comes to a matt surface, and tells whether that ended the path, was
/// survived, or is still to be played because the path was not aimed.
///
/// A path that was aimed and has come here has missed what it was aimed at, or has found what is brightly lit. Its
/// chance to go on goes by what it brings, counted for more where more light comes to this place than to others. Other
/// paths are left to the roulette that all paths play.
#[inline]
pub(super) fn arrive(path: &mut PathState, guide: Option<&LocalGuide>, number: impl FnOnce() -> f64) -> Arrival {
    let denser = std::mem::replace(&mut path.aimed, 1.0);
    if denser <= 1.0 {
        return Arrival::GoesOn;
    }
    let gain = guide.map_or(1.0, LocalGuide::gain);
    path.aimed = denser.min((gain * gain) as f32);
    let survival = roulette::survival(path.throughput, path.importance());
    if number() >= survival {
        return Arrival::Ends;
    }
    path.throughput /= survival;
    Arrival::Played
}

/// What becomes of a path that comes to a matt surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrival {
    /// Roulette is still to be played.
    GoesOn,
    /// Roulette was won.
    Played,
    /// Roulette was lost.
    Ends,
}

/// The density of a direction that a surface draws with `pdf`, where paths aim as well.
#[inline]
pub(super) fn density(guide: &LocalGuide, pdf: f64, direction: DVec3) -> f64 {
    pdf + guide.share() * (guide.pdf(direction) - pdf)
}

/// A direction drawn by a surface or by where light comes from, weighed by the density of both together (Veach and
/// Guibas, 1995: the one-sample model), and how much denser that is than the surface's.
pub(super) fn draw(here: &impl Encounter, guide: &LocalGuide, choice: f64, u: [f64; 2]) -> Option<(BsdfSample, f64)> {
    let share = guide.share();
    if choice < share {
        let direction = guide.sample(choice / share, u);
        let (value, pdf) = here.evaluate(direction);
        if value.is_black() || pdf <= 0.0 {
            return None;
        }
        let both = density(guide, pdf, direction);
        return Some((BsdfSample::new(direction, value / both, both), both / pdf));
    }
    // What is left of the choice is uniform again.
    let next = here.sample(|| ((choice - share) / (1.0 - share)).min(1f64.next_down()), u)?;
    if next.is_delta() {
        let denser = 1.0 - share;
        return Some((BsdfSample { weight: next.weight / denser, ..next }, denser));
    }
    let both = density(guide, next.pdf, next.wi);
    let denser = both / next.pdf;
    Some((BsdfSample { weight: next.weight / denser, pdf: both, ..next }, denser))
}
