//! A part of a ray in a medium.

use super::Coefficients;
use raywright_optics::Rgb;

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
    /// Something that must be asked for at each point, with an extinction that is a polynomial of the third degree
    /// along the ray, as numbers are that are interpolated along each axis of a cell.
    Cubic,
    /// Something that must be asked for at each point, with an extinction that is nowhere below the first of these and
    /// nowhere above the second. Where it glows without dimming light, the second is above 0 too, so that points there
    /// are asked for.
    Varies([Rgb; 2]),
}
