//! What a loop over paths is compiled with.

use super::nesting::Inside;
use crate::scene::Footprint;
use std::marker::PhantomData;

/// What a loop over paths is compiled with: a type for each [`crate::scene::Kernel`].
pub(super) trait Features: Send + Sync + 'static {
    /// Each shape scatters by one diffuse colour and shines by one number.
    const PLAIN: bool;
    /// Paths carry [`Baggage`]: the scene may have masks, nested media or filtered textures, and paths may be split.
    const BAGGAGE: bool;
    /// Paths of a group share what they find from their second surface on ([`super::reuse::Reuse`]).
    const SHARES: bool = false;
}

/// See [`crate::scene::Kernel::Plain`].
pub(super) struct Plain;
/// See [`crate::scene::Kernel::Open`].
pub(super) struct Open;
/// See [`crate::scene::Kernel::General`].
pub(super) struct General;

impl Features for Plain {
    const PLAIN: bool = true;
    const BAGGAGE: bool = false;
}

impl Features for Open {
    const PLAIN: bool = false;
    const BAGGAGE: bool = false;
}

impl Features for General {
    const PLAIN: bool = false;
    const BAGGAGE: bool = true;
}

/// The same, with paths that share.
pub(super) struct Sharing<N>(PhantomData<N>);

impl<N: Features> Features for Sharing<N> {
    const PLAIN: bool = N::PLAIN;
    const BAGGAGE: bool = N::BAGGAGE;
    const SHARES: bool = true;
}

/// What a path carries that few scenes need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Baggage {
    /// How wide the bundle of neighbouring rays is at the ray's origin.
    pub footprint: Footprint,
    /// What the ray starts in.
    pub inside: Inside,
    /// A uniform number that decides which masks the ray passes; negative until it is asked for. Given what it has
    /// decided, the rest of it is uniform again.
    pub chance: f64,
    /// Which of the branches that its sample has split into, so that each has numbers of its own.
    pub branch: u32,
}

impl Baggage {
    /// That of paths which carry none.
    pub const NONE: Self =
        Self { footprint: Footprint { width: 0.0, spread: 0.0 }, inside: Inside::NONE, chance: -1.0, branch: 0 };
}

impl Default for Baggage {
    fn default() -> Self {
        Self::NONE
    }
}
