//! What facets throw on facets, and what materials make of it.

use super::albedo::{Interface, MirrorLoss, Tabulated};
use super::{Facets, Once};
use raywright_base::math::DVec3;
use std::fmt::Debug;

/// Facets, and what they lose in one scattering, which materials give back.
pub trait Lossy: Facets {
    /// What mirrors lose.
    type Mirror: Lost;
    /// What an interface between dielectrics loses.
    type Interface: LostBetween;

    /// What they lose as perfect mirrors.
    fn mirror(self) -> Self::Mirror;

    /// What they lose between dielectrics, alike in all directions, with `eta` the index below over that above.
    fn interface(self, eta: f64) -> Self::Interface;
}

/// The share of white light that mirrors lose.
pub trait Lost: Copy + Debug {
    /// Of light from `w`.
    fn of(&self, w: DVec3) -> f64;

    /// Of even light.
    fn average(&self) -> f64;
}

/// The share of light that an interface loses, and how it is given back: see [`Interface`].
pub trait LostBetween: Copy + Debug {
    /// Whether anything is given back.
    const GIVES_BACK: bool = true;

    /// The share of light from `w` that is neither reflected nor refracted away by one facet.
    fn loss(&self, w: DVec3) -> f64;

    /// The share of what is lost on the side of `w` that is given back on the other side.
    fn crossing(&self, w: DVec3) -> f64;

    /// The cosine on the side of `w` about which light is lost.
    fn scale(&self, w: DVec3) -> f64;

    /// What is given back to `wo`, which loses `loss`, of light from `wi`, per solid angle, with the cosine of `wi` in
    /// it and without the 1 / η² of radiance.
    fn given_back(&self, loss: f64, wo: DVec3, wi: DVec3) -> f64;
}

impl<F: Tabulated> Lossy for F {
    type Mirror = MirrorLoss;
    type Interface = Interface;

    #[inline(always)]
    fn mirror(self) -> MirrorLoss {
        MirrorLoss::new(self)
    }

    #[inline(always)]
    fn interface(self, eta: f64) -> Interface {
        Interface::new(self, eta)
    }
}

impl Lost for MirrorLoss {
    #[inline(always)]
    fn of(&self, w: DVec3) -> f64 {
        Self::of(self, w)
    }

    #[inline(always)]
    fn average(&self) -> f64 {
        Self::average(self)
    }
}

impl LostBetween for Interface {
    #[inline(always)]
    fn loss(&self, w: DVec3) -> f64 {
        Self::loss(self, w)
    }

    #[inline(always)]
    fn crossing(&self, w: DVec3) -> f64 {
        Self::crossing(self, w)
    }

    #[inline(always)]
    fn scale(&self, w: DVec3) -> f64 {
        Self::scale(self, w)
    }

    #[inline(always)]
    fn given_back(&self, loss: f64, wo: DVec3, wi: DVec3) -> f64 {
        Self::given_back(self, loss, wo, wi)
    }
}

/// Nothing is given back, as if nothing were lost.
#[derive(Clone, Copy, Debug)]
pub struct Nothing;

impl<F: Facets> Lossy for Once<F> {
    type Mirror = Nothing;
    type Interface = Nothing;

    #[inline(always)]
    fn mirror(self) -> Nothing {
        Nothing
    }

    #[inline(always)]
    fn interface(self, _eta: f64) -> Nothing {
        Nothing
    }
}

impl Lost for Nothing {
    #[inline(always)]
    fn of(&self, _w: DVec3) -> f64 {
        0.0
    }

    #[inline(always)]
    fn average(&self) -> f64 {
        0.0
    }
}

impl LostBetween for Nothing {
    const GIVES_BACK: bool = false;

    #[inline(always)]
    fn loss(&self, _w: DVec3) -> f64 {
        0.0
    }

    #[inline(always)]
    fn crossing(&self, _w: DVec3) -> f64 {
        0.0
    }

    #[inline(always)]
    fn scale(&self, _w: DVec3) -> f64 {
        1.0
    }

    #[inline(always)]
    fn given_back(&self, _loss: f64, _wo: DVec3, _wi: DVec3) -> f64 {
        0.0
    }
}
