//! How an interface divides light between two ways.

use super::{Rgb, fresnel};
use raywright_base::math::{DVec3, InLanes, LANES, VectorLanes};
use raywright_base::simd::{Level, loops};
use std::fmt::Debug;
use std::ops::{Div, Mul};

/// What is reflected at an interface between two media that are clear; the rest goes through.
pub trait Split: Copy + Debug {
    /// Whether something lies between the media, so that they alone would reflect another share.
    const DIFFERS: bool = false;

    /// A number where all light is divided alike, a colour where it is not.
    type Share: Share;

    /// The share of light that is reflected at a `cosine` of incidence, 0 to 1: `eta` is the index of refraction beyond
    /// over that before, and light comes from above or from below the surface.
    fn reflectance(&self, cosine: f64, eta: f64, is_above: bool) -> Self::Share;

    /// The same by lane, in those that ask, of light that goes to `wo`, with the index below the surface over that
    /// above in `etas`.
    #[inline]
    fn reflectances<'a>(
        _level: Level,
        each: impl Fn(usize) -> Option<&'a Self>,
        asks: &[bool; LANES],
        (etas, wo): (&[f64; LANES], &VectorLanes),
        cosines: &[f64; LANES],
        shares: &mut <Self::Share as InLanes>::Lanes,
    ) where
        Self: 'a,
    {
        for lane in (0..LANES).filter(|&lane| asks[lane]) {
            let (wo, Some(split)) = (wo.get(lane), each(lane)) else { continue };
            split.reflectance(cosines[lane], beyond(etas[lane], wo), wo.z > 0.0).put(shares, lane);
        }
    }
}

/// The index beyond a surface over that on the side of `w`, for the index below over that above.
#[inline(always)]
pub(super) fn beyond(eta: f64, w: DVec3) -> f64 {
    if w.z > 0.0 { eta } else { 1.0 / eta }
}

/// A share of light, one for all of it or a colour.
pub trait Share: Copy + InLanes + Mul<f64, Output = Self> + Div<f64, Output = Self> {
    /// No light.
    const NONE: Self;

    /// What is left.
    fn rest(self) -> Self;

    /// How often it is drawn: 0 or 1 only where all or nothing of the rest is left.
    fn chance(self) -> f64;

    /// One of two, without a branch.
    fn select(first: bool, a: Self, b: Self) -> Self;

    /// With as much more in each channel.
    fn plus(self, more: f64) -> Self;

    /// As a colour.
    fn rgb(self) -> Rgb;
}

impl Share for f64 {
    const NONE: Self = 0.0;

    #[inline(always)]
    fn rest(self) -> Self {
        1.0 - self
    }

    #[inline(always)]
    fn chance(self) -> f64 {
        self
    }

    #[inline(always)]
    fn select(first: bool, a: Self, b: Self) -> Self {
        if first { a } else { b }
    }

    #[inline(always)]
    fn plus(self, more: f64) -> Self {
        self + more
    }

    #[inline(always)]
    fn rgb(self) -> Rgb {
        Rgb::splat(self)
    }
}

impl Share for Rgb {
    const NONE: Self = Self::ZERO;

    #[inline(always)]
    fn rest(self) -> Self {
        Self::ONE - self
    }

    #[inline(always)]
    fn chance(self) -> f64 {
        self.mean()
    }

    #[inline(always)]
    fn select(first: bool, a: Self, b: Self) -> Self {
        Self::select(first, a, b)
    }

    #[inline(always)]
    fn plus(self, more: f64) -> Self {
        self + Self::splat(more)
    }

    #[inline(always)]
    fn rgb(self) -> Rgb {
        self
    }
}

/// Nothing but the two media: Fresnel's reflectance.
#[derive(Clone, Copy, Debug)]
pub struct Bare;

impl Split for Bare {
    type Share = f64;

    #[inline(always)]
    fn reflectance(&self, cosine: f64, eta: f64, _is_above: bool) -> f64 {
        fresnel::dielectric(cosine, eta)
    }

    #[inline]
    fn reflectances<'a>(
        level: Level,
        _each: impl Fn(usize) -> Option<&'a Self>,
        _asks: &[bool; LANES],
        (etas, wo): (&[f64; LANES], &VectorLanes),
        cosines: &[f64; LANES],
        shares: &mut [f64; LANES],
    ) {
        reflect(level, etas, wo, cosines, shares);
    }
}

loops! {
    /// Fresnel's reflectance in every lane.
    fn reflect(etas: &[f64; LANES], wo: &VectorLanes, cosines: &[f64; LANES], shares: &mut [f64; LANES]) {
        for i in 0..LANES {
            shares[i] = fresnel::dielectric(cosines[i], beyond(etas[i], wo.get(i)));
        }
    }
}
