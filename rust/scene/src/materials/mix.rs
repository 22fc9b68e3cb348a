//! Mixtures of two materials.

use super::checks::within;
use super::{BsdfMix, Interior, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use std::sync::Arc;

/// A linear mixture of two materials.
///
/// Its interior is that of the first material that has one. If the materials perturb normals, these are mixed too.
#[derive(Clone, Debug)]
pub struct MixMaterial {
    /// The first material.
    pub a: Arc<dyn Material>,
    /// The second material.
    pub b: Arc<dyn Material>,
    /// The share of `b`, 0 to 1.
    pub amount: Value<f64>,
}

impl MixMaterial {
    /// Shares of both materials, among the opaque part if not all is opaque.
    fn shares(&self, point: &TexturePoint) -> [f64; 2] {
        let amount = self.amount.at(point).clamp(0.0, 1.0);
        let shares = [1.0 - amount, amount];
        if self.is_opaque() {
            return shares;
        }
        let [a, b] = [(1.0 - amount) * self.a.opacity(point), amount * self.b.opacity(point)];
        if a + b > 0.0 { [a / (a + b), b / (a + b)] } else { shares }
    }
}

impl Material for MixMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        let [a, b] = self.shares(&at.texture);
        // A material with share 0 is not evaluated.
        if b == 0.0 {
            return self.a.bsdf(at);
        }
        if a == 0.0 {
            return self.b.bsdf(at);
        }
        BsdfMix::mixed((Rgb::splat(a), self.a.bsdf(at)), (Rgb::splat(b), self.b.bsdf(at)))
    }

    fn needs(&self) -> Needs {
        self.a.needs() | self.b.needs() | self.amount.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("amount", &self.amount, 0.0, 1.0)?;
        self.a.validate().map_err(|why| format!("in a: {why}"))?;
        self.b.validate().map_err(|why| format!("in b: {why}"))
    }

    fn opacity(&self, at: &TexturePoint) -> f64 {
        let amount = self.amount.at(at).clamp(0.0, 1.0);
        (1.0 - amount) * self.a.opacity(at) + amount * self.b.opacity(at)
    }

    fn mean_opacity(&self) -> f64 {
        let [_, most] = self.amount.range();
        let amount = self.amount.mean().clamp(1e-3 * most.clamp(0.0, 1.0), 1.0);
        (1.0 - amount) * self.a.mean_opacity() + amount * self.b.mean_opacity()
    }

    fn is_opaque(&self) -> bool {
        self.a.is_opaque() && self.b.is_opaque()
    }

    fn minds_outside(&self) -> bool {
        self.a.minds_outside() || self.b.minds_outside()
    }

    fn transmits(&self) -> bool {
        self.a.transmits() || self.b.transmits()
    }

    fn normal(&self, at: &ShadingPoint) -> Option<DVec3> {
        let normals = [self.a.normal(at), self.b.normal(at)];
        if normals == [None, None] {
            return None;
        }
        let [a, b] = normals.map(|normal| normal.unwrap_or(at.point.shading_normal));
        let [of_a, of_b] = self.shares(&at.texture);
        // Two normals on the same side of a plane are never opposite.
        (a * of_a + b * of_b).try_normalize()
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.a.tangent(at).or_else(|| self.b.tangent(at))
    }

    fn interior(&self) -> Option<Interior> {
        self.a.interior().or_else(|| self.b.interior())
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.a.medium().or_else(|| self.b.medium())
    }

    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        let [a, b] = self.shares(&at.texture);
        self.a.ambient(at) * a + self.b.ambient(at) * b
    }
}
