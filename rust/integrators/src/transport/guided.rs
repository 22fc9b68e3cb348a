//! Paths that are guided to where light comes from by way of mirrors and glass.

use super::path_state::PathState;
use crate::{LocalGuide, roulette};
use raywright_base::math::DVec3;
use raywright_base::simd::Level;

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
pub(super) fn density(level: Level, guide: &LocalGuide, pdf: f64, direction: DVec3) -> f64 {
    pdf + guide.share() * (guide.pdf(level, direction) - pdf)
}
