//! A ray through a medium, stretch by stretch.

use super::Coefficients;
use super::grid::BlockWalk;
use crate::optics::Rgb;

/// A part of a ray in a medium.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The `t` where it ends; it begins where the one before ended.
    pub end: f64,
    /// What is there.
    pub content: Content,
}

/// What is on a stretch of a ray.
#[derive(Clone, Copy, Debug)]
pub enum Content {
    /// The same everywhere.
    Even(Coefficients),
    /// Something that must be asked for at each point, with an extinction that is nowhere above this. Where it glows
    /// without dimming light, this is above 0 too, so that points there are asked for.
    Varies(Rgb),
}

/// All stretches of a ray through a medium.
#[derive(Clone, Debug)]
pub struct Stretches<'m>(Kind<'m>);

#[derive(Clone, Debug)]
enum Kind<'m> {
    Whole(Option<Stretch>),
    Blocks(BlockWalk<'m>),
}

impl<'m> Stretches<'m> {
    /// One, from end to end.
    pub(super) fn whole(stretch: Stretch) -> Self {
        Self(Kind::Whole(Some(stretch)))
    }

    /// Those of blocks.
    pub(super) fn blocks(walk: BlockWalk<'m>) -> Self {
        Self(Kind::Blocks(walk))
    }
}

impl Iterator for Stretches<'_> {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        match &mut self.0 {
            Kind::Whole(stretch) => stretch.take(),
            Kind::Blocks(walk) => walk.next(),
        }
    }
}
