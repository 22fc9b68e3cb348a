//! Energy lost by single scattering, and its compensation by materials.

use super::albedo::{Interface, MirrorLoss, Tabulated};
use super::{Facets, Once};
use raywright_base::math::DVec3;
use std::fmt::Debug;

/// Facets with their single-scattering energy loss, which materials compensate.
pub trait Lossy: Facets {
    /// Loss of perfectly reflecting facets.
    type Mirror: Lost;
    /// Loss of an interface between dielectrics.
    type Interface: LostBetween;

    /// Looks up the loss of perfectly reflecting facets.
    fn mirror(self) -> Self::Mirror;

    /// Looks up the loss of an interface between dielectrics with isotropic facets; `eta` is the index of refraction
    /// below over that above.
    fn interface(self, eta: f64) -> Self::Interface;
}

/// Energy loss of perfectly reflecting facets for white light.
pub trait Lost: Copy + Debug {
    /// Loss for direction `w`.
    fn of(&self, w: DVec3) -> f64;

    /// Cosine-weighted average of the loss.
    fn average(&self) -> f64;
}

/// Energy loss of an interface, and its compensation; see [`Interface`].
pub trait LostBetween: Copy + Debug {
    /// True if losses are compensated.
    const GIVES_BACK: bool = true;

    /// Energy from direction `w` that single scattering neither reflects nor refracts away.
    fn loss(&self, w: DVec3) -> f64;

    /// Share of the energy lost on the side of `w` that the compensation transmits.
    fn crossing(&self, w: DVec3) -> f64;

    /// Cosine scale of the loss on the side of `w`.
    fn scale(&self, w: DVec3) -> f64;

    /// Compensation towards `wo`, whose loss is `loss`, from `wi`, per solid angle, including the cosine of `wi` but
    /// not the 1 / η² of radiance.
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

/// No compensation, as if there were no loss.
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
