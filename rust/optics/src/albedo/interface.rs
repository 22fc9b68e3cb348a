//! Single-scattering energy loss of facets between two dielectrics.

use super::cubic::Cubic;
use super::tables::{INTERFACE_AVERAGE, THIN};
use super::variables::{DENSEST, of_alpha, of_index};
use super::{Rough, Tables, Tabulated};
use crate::fresnel;
use glam::DVec3;

/// A rough interface between two dielectrics: the energy lost per single scattering from either side, and a
/// compensation lobe that is reciprocal and conserves energy.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    tables: &'static Tables,
    rough: Rough,
    alpha: Cubic,
    index: Cubic,
    /// Above and below the surface.
    sides: [InterfaceSide; 2],
}

/// Data of one side.
#[derive(Clone, Copy, Debug)]
struct InterfaceSide {
    dense: bool,
    /// Cosine-weighted average of the loss.
    average: f64,
    /// Share of the lost energy that the compensation transmits.
    crosses: f64,
}

impl Interface {
    /// Looks up isotropic facets; `eta` is the index of refraction below over that above.
    pub fn new<F: Tabulated>(facets: F, eta: f64) -> Self {
        Self::with(F::TABLES, facets.alpha()[0], eta)
    }

    /// Looks up a roughness in these tables.
    pub(super) fn with(tables: &'static Tables, alpha: f64, eta: f64) -> Self {
        let dense = eta.max(1.0 / eta).min(DENSEST);
        let (rough, a, i) = (Rough::new(alpha, dense), of_alpha(alpha), of_index(alpha, dense));
        let [rows, columns] = INTERFACE_AVERAGE;
        let (row, column) = (Cubic::new(a, rows), Cubic::new(i, columns));
        let average = |dense: bool| {
            let table = if dense { &tables.dense_average } else { &tables.thin_average };
            table.at(&row, &column).exp() * rough.unit()
        };
        let averages = [average(eta < 1.0), average(eta > 1.0)];
        // A share t of a loss L̄ that crosses from side a to b is reciprocal if na² ta L̄a = nb² tb L̄b (Kulla and
        // Conty, "Revisiting Physically Based Shading at Imageworks", 2017). A smooth interface transmits 1 − F̄, with
        // na² (1 − F̄a) = nb² (1 − F̄b). So t = (1 − F̄) / L̄ times a factor that keeps both at most 1 − F̄.
        let least = averages[0].min(averages[1]);
        let side = |below: bool| {
            let (own, average) = (if below { 1.0 / eta } else { eta }, averages[usize::from(below)]);
            let through = 1.0 - fresnel::dielectric_average(own);
            InterfaceSide {
                dense: own < 1.0,
                average,
                crosses: if average > 0.0 { through * least / average } else { 0.0 },
            }
        };
        let (alpha, index) = (Cubic::new(a, THIN[0]), Cubic::new(i, THIN[2]));
        Self { tables, rough, alpha, index, sides: [side(false), side(true)] }
    }

    #[inline]
    fn side(&self, w: DVec3) -> &InterfaceSide {
        &self.sides[usize::from(w.z < 0.0)]
    }

    /// Energy from direction `w` that single scattering neither reflects nor refracts away.
    #[inline]
    pub fn loss(&self, w: DVec3) -> f64 {
        let dense = self.side(w).dense;
        let (cosine, most) = if dense { self.rough.dense(w) } else { self.rough.thin(w) };
        let table = if dense { &self.tables.dense } else { &self.tables.thin };
        (most * table.at(&self.alpha, &Cubic::new(cosine, table.sizes[1]), &self.index)).clamp(0.0, 1.0)
    }

    /// Share of the energy lost on the side of `w` that the compensation transmits.
    #[inline]
    pub fn crossing(&self, w: DVec3) -> f64 {
        self.side(w).crosses
    }

    /// Cosine scale of the loss on the side of `w`.
    #[inline]
    pub fn scale(&self, w: DVec3) -> f64 {
        if self.side(w).dense { (self.rough.alpha * self.rough.bent).max(1e-8) } else { self.rough.alpha }
    }

    /// Compensation towards `wo` from `wi`, per solid angle, including the cosine of `wi` but not the 1 / η² of
    /// radiance. `loss` is that of `wo`.
    #[inline]
    pub fn given_back(&self, loss: f64, wo: DVec3, wi: DVec3) -> f64 {
        loss * self.given_back_density(wo, wi)
    }

    /// Density of the compensation lobe over the sphere.
    #[inline]
    pub fn given_back_density(&self, wo: DVec3, wi: DVec3) -> f64 {
        let (from, to) = (self.side(wo), self.side(wi));
        let share = if wo.z * wi.z > 0.0 { 1.0 - from.crosses } else { from.crosses };
        if to.average > 0.0 { share * self.loss(wi) * wi.z.abs() / (std::f64::consts::PI * to.average) } else { 0.0 }
    }
}
