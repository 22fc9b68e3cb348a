//! Division of light into reflection and transmission at an interface.

use super::{Rgb, fresnel};
use raywright_base::math::{DVec3, InLanes, LANES, VectorLanes};
use raywright_base::simd::{Level, loops};
use std::fmt::Debug;
use std::ops::{Div, Mul};

/// Reflectance of an interface between two clear media; the rest is transmitted.
pub trait Split: Copy + Debug {
    /// True if something lies between the media, so that their own reflectance differs.
    const DIFFERS: bool = false;

    /// A number if all channels are equal, otherwise a color.
    type Share: Share;

    /// Reflectance at a `cosine` of incidence, 0 to 1. `eta` is the index of refraction beyond over that before the
    /// interface; `is_above` tells whether light comes from above.
    fn reflectance(&self, cosine: f64, eta: f64, is_above: bool) -> Self::Share;

    /// Reflectances for outgoing directions `wo`, in lanes with a set flag; `etas` are indices below over above the
    /// surface.
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

/// Index of refraction beyond a surface over that on the side of `w`, from the index below over that above.
#[inline(always)]
pub(super) fn beyond(eta: f64, w: DVec3) -> f64 {
    if w.z > 0.0 { eta } else { 1.0 / eta }
}

/// A share of light, gray or colored.
pub trait Share: Copy + InLanes + Mul<f64, Output = Self> + Div<f64, Output = Self> {
    /// Zero.
    const NONE: Self;

    /// 1 minus the share.
    fn rest(self) -> Self;

    /// Sampling probability: 0 or 1 only if the share is entirely 0 or 1.
    fn chance(self) -> f64;

    /// Branch-free selection.
    fn select(first: bool, a: Self, b: Self) -> Self;

    /// Adds a number to each channel.
    fn plus(self, more: f64) -> Self;

    /// Converts to a color.
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

/// A bare interface: Fresnel's reflectance.
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
