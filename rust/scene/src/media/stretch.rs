//! Segments of a ray in a medium.

use super::Coefficients;
use raywright_optics::Rgb;

/// A segment of a ray in a medium.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The `t` of its end; it begins at the end of the previous segment.
    pub end: f64,
    /// The medium in it.
    pub content: Content,
}

/// The medium in a segment.
#[derive(Clone, Copy, Debug)]
pub enum Content {
    /// Homogeneous.
    Even(Coefficients),
    /// Heterogeneous, with an extinction that is a cubic polynomial along the ray: trilinear interpolation within a
    /// cell.
    Cubic,
    /// Heterogeneous, with a lower and an upper bound on the extinction. In an emissive segment without extinction the
    /// upper bound is positive too, so that emission is sampled.
    Varies([Rgb; 2]),
}
