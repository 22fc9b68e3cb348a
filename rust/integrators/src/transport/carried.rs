//! What a path carries that few scenes need.

use crate::nesting::MediumStack;
use raywright_scene::Footprint;

/// What a path carries that few scenes need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    /// How wide the bundle of neighboring rays is at the ray's origin.
    pub footprint: Footprint,
    /// What the ray starts in.
    pub media: MediumStack,
    /// A uniform number that decides which masks the ray passes; negative until it is asked for. Given what it has
    /// decided, the rest of it is uniform again.
    pub chance: f64,
    /// Which of the branches that its sample has split into, so that each has numbers of its own.
    pub branch: u32,
    /// Whether it has been scattered at a matt surface whose light is known, and at something sharp since.
    pub is_gathered: bool,
    pub is_sharp_since: bool,
}

impl Carried {
    /// That of paths which carry none.
    pub const NONE: Self = Self {
        footprint: Footprint { width: 0.0, spread: 0.0 },
        media: MediumStack::NONE,
        chance: -1.0,
        branch: 0,
        is_gathered: false,
        is_sharp_since: false,
    };
}

impl Default for Carried {
    fn default() -> Self {
        Self::NONE
    }
}
