//! What a loop over paths is compiled with.

use crate::nesting::MediumStack;
use raywright_scene::Footprint;
use std::marker::PhantomData;

/// What a loop over paths is compiled with: a type for each [`raywright_scene::ShadingVariant`].
pub(super) trait Features: Send + Sync + 'static {
    /// Each shape scatters by one diffuse colour and shines by one number.
    const PLAIN: bool;
    /// Paths carry [`Carried`]: the scene may have masks, nested media or filtered textures, and paths may be split.
    const GENERAL: bool;
    /// Paths of a group share what they find from their second surface on ([`crate::path_sharing`]).
    const SHARES: bool = false;
}

/// See [`raywright_scene::ShadingVariant::Plain`].
pub(super) struct Plain;
/// See [`raywright_scene::ShadingVariant::Open`].
pub(super) struct Open;
/// See [`raywright_scene::ShadingVariant::General`].
pub(super) struct General;

impl Features for Plain {
    const PLAIN: bool = true;
    const GENERAL: bool = false;
}

impl Features for Open {
    const PLAIN: bool = false;
    const GENERAL: bool = false;
}

impl Features for General {
    const PLAIN: bool = false;
    const GENERAL: bool = true;
}

/// The same, with paths that share.
pub(super) struct Sharing<N>(PhantomData<N>);

impl<N: Features> Features for Sharing<N> {
    const PLAIN: bool = N::PLAIN;
    const GENERAL: bool = N::GENERAL;
    const SHARES: bool = true;
}

/// What a path carries that few scenes need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    /// How wide the bundle of neighbouring rays is at the ray's origin.
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
