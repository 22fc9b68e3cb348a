//! What facets between two dielectrics lose.

use super::tables::interface_dense::{DENSE, DENSE_AVERAGE};
use super::tables::interface_thin::{THIN, THIN_AVERAGE};
use super::{averages, of_alpha_power, of_x, volume, x_of};
use crate::optics::{Facets, Ggx, fresnel};
use glam::DVec3;

/// Sizes of the tables from either side, grazing by α by index, and of the averages by α by index.
pub(super) const THIN_SIZES: [usize; 3] = [22, 32, 14];
/// An entry stands at 0.7, where light that hardly rough facets reflect totally ends ([`of_dense`]).
pub(super) const DENSE_SIZES: [usize; 3] = [41, 16, 40];
pub(super) const AVERAGE_SIZES: [usize; 2] = [24, 40];

/// A variable from 0 to 1 for an index of refraction ≥ 1 at a roughness. The cosine at which reflection sets in towards
/// grazing is about w = √(η² − 1), and it matters on the scale of α.
#[inline]
pub(super) fn of_index(alpha: f64, eta: f64) -> f64 {
    1.0 - (1.0 + scale(alpha, eta)).cbrt().recip()
}

/// w / α.
#[inline]
pub(super) fn scale(alpha: f64, eta: f64) -> f64 {
    ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / alpha
}

/// The part of x = z / s(ω) in which light from the denser side is bent so far that it leaves the surface again, up to
/// 1.
#[inline]
pub(super) fn bent(scale: f64) -> f64 {
    let square = scale * scale;
    square / (2.0 + square)
}

/// A variable from 0 to 1 for a cosine from the denser side and its x: dense where light is bent away, and about the
/// critical angle, where what gets through grazes the surface and other facets stop it.
#[inline]
pub(super) fn of_dense(alpha: f64, eta: f64, bent: f64, x: f64, cosine: f64) -> f64 {
    let critical = ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / eta;
    let near = |c: f64| (c - critical) / (c - critical).hypot(alpha);
    let (low, high) = (near(0.0), near(1.0));
    // What is bent away falls off slowly, as a root.
    let away = |x: f64| 1.0 - (1.0 + x / bent).sqrt().recip();
    0.25 * of_x(x) + 0.45 * away(x) / away(1.0) + 0.3 * (near(cosine) - low) / (high - low)
}

/// A rough interface between two dielectrics: what it loses of light from either side in one scattering, and how that
/// light is given back so that nothing is lost and nothing depends on which way the light goes.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    ggx: Ggx,
    alpha: f64,
    /// How much of an index of refraction ≥ 1 there is at this roughness.
    index: f64,
    bent: f64,
    /// The denser index over the thinner.
    eta: f64,
    /// Above and below the surface.
    sides: [Side; 2],
}

/// What holds on one side.
#[derive(Clone, Copy, Debug)]
struct Side {
    dense: bool,
    /// Mean loss over even light.
    average: f64,
    /// The share of what is lost that is given back on the other side.
    crosses: f64,
}

impl Interface {
    /// Of isotropic facets of roughness `alpha`, with `eta` the index below over that above.
    pub fn new(alpha: f64, eta: f64) -> Self {
        let ggx = Ggx::new([alpha; 2]);
        let dense = eta.max(1.0 / eta);
        let (index, bent) = (of_index(alpha, dense), bent(scale(alpha, dense)));
        let average = |dense: bool| {
            let table = if dense { &DENSE_AVERAGE } else { &THIN_AVERAGE };
            averages(table, AVERAGE_SIZES, [alpha.cbrt(), index.sqrt()]).exp() * alpha * alpha
        };
        let averages = [average(eta < 1.0), average(eta > 1.0)];
        // A share t of a loss L̄ that crosses from side a to b is reciprocal if na² ta L̄a = nb² tb L̄b (Kulla and
        // Conty, "Revisiting Physically Based Shading at Imageworks", 2017). A smooth interface lets through 1 − F̄,
        // for which na² (1 − F̄a) = nb² (1 − F̄b): so t = (1 − F̄) / L̄ times what keeps both at most 1 − F̄.
        let least = averages[0].min(averages[1]);
        let side = |below: bool| {
            let (own, average) = (if below { 1.0 / eta } else { eta }, averages[usize::from(below)]);
            let through = 1.0 - fresnel::dielectric_average(own);
            Side { dense: own < 1.0, average, crosses: if average > 0.0 { through * least / average } else { 0.0 } }
        };
        Self { ggx, alpha, index, bent, eta: dense, sides: [side(false), side(true)] }
    }

    #[inline]
    fn side(&self, w: DVec3) -> &Side {
        &self.sides[usize::from(w.z < 0.0)]
    }

    /// The share of light from `w` that is neither reflected nor refracted away by one facet. Within 0.005 of the
    /// integral, but for directions that graze the surface: there within 0.007 from the thinner side where it is hardly
    /// rough and of an index above 2, and within 0.009 from the denser where the index is 1 to a thousandth.
    #[inline]
    pub fn loss(&self, w: DVec3) -> f64 {
        let x = x_of(&self.ggx, w);
        let (a, index) = (of_alpha_power(self.alpha), self.index);
        if self.side(w).dense {
            let grazing = of_dense(self.alpha, self.eta, self.bent, x, w.z.abs());
            volume(&DENSE, DENSE_SIZES, [grazing, a, index])
        } else {
            volume(&THIN, THIN_SIZES, [of_x(x), a, index])
        }
    }

    /// The share of what is lost on the side of `w` that is given back on the other side.
    #[inline]
    pub fn crossing(&self, w: DVec3) -> f64 {
        self.side(w).crosses
    }

    /// The cosine on the side of `w` about which light is lost.
    #[inline]
    pub fn scale(&self, w: DVec3) -> f64 {
        if self.side(w).dense { (self.alpha * self.bent).max(1e-8) } else { self.alpha }
    }

    /// What is given back to `wo` of light from `wi`, per solid angle, with the cosine of `wi` in it and without the 1
    /// / η² of radiance. `loss` is that of `wo`.
    #[inline]
    pub fn given_back(&self, loss: f64, wo: DVec3, wi: DVec3) -> f64 {
        loss * self.given_back_density(wo, wi)
    }

    /// The density over the sphere with which lost light is given back.
    #[inline]
    pub fn given_back_density(&self, wo: DVec3, wi: DVec3) -> f64 {
        let (from, to) = (self.side(wo), self.side(wi));
        let share = if wo.z * wi.z > 0.0 { 1.0 - from.crosses } else { from.crosses };
        if to.average > 0.0 { share * self.loss(wi) * wi.z.abs() / (std::f64::consts::PI * to.average) } else { 0.0 }
    }
}
