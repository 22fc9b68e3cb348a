//! Settings of integrators that follow paths from the camera.

use super::Guiding;
use super::known_light::Gather;
use raywright_optics::Rgb;

/// Directions that are followed. Light from others is found by light sampling alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Follow {
    /// All.
    All,
    /// Those drawn with a density, in solid angle, above this.
    MinDensity(f64),
    /// Delta directions only, and of these every one: paths are split.
    DeltaLobes,
    /// None.
    Nothing,
}

/// Settings of a path tracer and of its ancestors.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathSettings {
    /// Maximum number of bounces.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
    /// True if media scatter light; else they only dim it.
    pub scatters: bool,
    /// Number of light samples at the first surface.
    pub light_samples: u32,
    /// Number of paths that go on from the first surface.
    pub splits: u32,
    /// Directions that are followed.
    pub follow: Follow,
    /// True if surfaces block light samples.
    pub shadows: bool,
    /// Uniform radiance in place of light that is not followed, where it is scattered diffusely.
    pub ambient: Rgb,
    /// Minimum contribution of a path in any color; others end.
    pub least: f64,
    /// True if paths of a group share radiance, in scenes where they can ([`super::path_sharing::can_share`]).
    pub shares: bool,
    /// Guiding of paths.
    pub guiding: Guiding,
    /// Use of known light; `None` without.
    pub gather: Option<Gather>,
}

impl PathSettings {
    /// Those of a path tracer.
    pub fn path(max_depth: Option<u32>, roulette_depth: u32) -> Self {
        Self {
            max_depth,
            roulette_depth,
            scatters: true,
            light_samples: 1,
            splits: 1,
            follow: Follow::All,
            shadows: true,
            ambient: Rgb::ZERO,
            least: 0.0,
            shares: false,
            guiding: Guiding::None,
            gather: None,
        }
    }

    /// Those of integrators whose light is scattered by surfaces alone: media only dim it. No roulette is played.
    pub fn dimmed(max_depth: u32) -> Self {
        Self { scatters: false, ..Self::path(Some(max_depth), u32::MAX) }
    }

    /// Return whether matte surfaces take their own, simpler stages.
    pub fn are_plain(&self) -> bool {
        self.light_samples == 1
            && self.ambient.is_black()
            && self.least == 0.0
            && !self.may_split()
            && matches!(self.follow, Follow::All | Follow::Nothing)
    }

    /// Return whether one path may go on as several.
    pub fn may_split(&self) -> bool {
        self.splits > 1 || self.follow == Follow::DeltaLobes || self.gather.is_some()
    }

    /// Return the minimum density of directions that are followed.
    pub fn least_pdf(&self) -> f64 {
        match self.follow {
            Follow::All => 0.0,
            Follow::MinDensity(than) => than.next_up(),
            Follow::DeltaLobes | Follow::Nothing => f64::INFINITY,
        }
    }
}

/// The choice of one of several light samples: each chooses in its own share of all.
#[inline]
pub(crate) fn stratum(choice: f64, (number, count): (u32, u32)) -> f64 {
    if count == 1 { choice } else { ((choice + f64::from(number)) / f64::from(count)).min(1f64.next_down()) }
}
