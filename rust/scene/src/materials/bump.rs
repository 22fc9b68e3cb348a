//! Bump mapping.

use super::checks::{number, within};
use super::{BsdfMix, Interior, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use std::sync::Arc;

/// Bump mapping: perturbs the shading normal by a height field (Blinn, "Simulation of Wrinkled Surfaces", 1978). The
/// geometry that rays hit is unchanged.
#[derive(Clone, Debug)]
pub struct BumpMap {
    /// The base material.
    pub material: Arc<dyn Material>,
    /// Height along the normal.
    pub height: Value<f64>,
    /// Factor from heights to the scene's unit; negative for depths.
    pub scale: f64,
}

/// Minimum cosine between a perturbed normal and the geometric one.
const GRAZING: f64 = 1e-3;

/// Bends a normal to the side of the geometric normal, unless normals are used as given.
pub(super) fn on_its_side(normal: DVec3, at: &ShadingPoint) -> DVec3 {
    let geometric = at.point.normal;
    let cosine = normal.dot(geometric);
    if at.as_given || cosine >= GRAZING { normal } else { (normal + geometric * (GRAZING - cosine)).normalize() }
}

impl BumpMap {
    /// Finite-difference step in texture coordinates if the footprint is unknown; the error of the slope is quadratic
    /// in it.
    const STEP: f64 = 5e-4;

    /// Minimum step, so that heights differ in enough digits.
    const LEAST: f64 = 1e-6;

    fn height(&self, point: &TexturePoint) -> f64 {
        self.scale * self.height.at(point)
    }

    /// Finite-difference step in texture coordinates.
    fn step(&self, at: &ShadingPoint) -> f64 {
        if at.texture.width > 0.0 {
            return (0.5 * at.texture.width).max(Self::LEAST);
        }
        // A height field that depends only on position needs a step in world space, because texture coordinates depend
        // on the triangle.
        let needs = self.height.needs();
        let longest = at.object_dp[0].length().max(at.object_dp[1].length());
        if needs.uv || longest == 0.0 { Self::STEP } else { Self::STEP / longest }
    }
}

impl Material for BumpMap {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.material.bsdf(at)
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        self.material.kinds()
    }

    fn needs(&self) -> Needs {
        self.material.needs() | self.height.needs() | Needs { tangents: true, ..Needs::NONE }
    }

    fn validate(&self) -> Result<(), String> {
        within("height", &self.height, f64::MIN, f64::MAX)?;
        number("scale", self.scale, f64::MIN, f64::MAX)?;
        self.material.validate()
    }

    fn opacity(&self, at: &TexturePoint) -> f64 {
        self.material.opacity(at)
    }

    fn mean_opacity(&self) -> f64 {
        self.material.mean_opacity()
    }

    fn is_opaque(&self) -> bool {
        self.material.is_opaque()
    }

    fn minds_outside(&self) -> bool {
        self.material.minds_outside()
    }

    fn transmits(&self) -> bool {
        self.material.transmits()
    }

    fn normal(&self, at: &ShadingPoint) -> Option<DVec3> {
        let own = self.material.normal(at);
        let normal = own.unwrap_or(at.point.shading_normal);
        // Degenerate texture coordinates define no slope.
        if at.dp[0].cross(at.dp[1]) == DVec3::ZERO {
            return own;
        }
        let step = self.step(at);
        let beside = |k: usize, by: f64| {
            let mut point = at.texture;
            point.uv[k] += by;
            point.position += at.object_dp[k] * by;
            self.height(&point)
        };
        let (mut slopes, mut mean) = ([0.0; 2], 0.0);
        for k in 0..2 {
            let (before, after) = (beside(k, -step), beside(k, step));
            slopes[k] = (after - before) / (2.0 * step);
            mean += 0.25 * (before + after);
        }
        // Tangents of the displaced surface (Blinn, 1978; Pharr, Jakob and Humphreys, 2023, 10.5.3). With normals as
        // given, the absolute height is ignored and only slopes count.
        let mean = if at.as_given { 0.0 } else { mean };
        let [du, dv] = [0, 1].map(|k| at.dp[k] + normal * slopes[k] + at.dn[k] * mean);
        let Some(raised) = du.cross(dv).try_normalize() else { return own };
        Some(on_its_side(if raised.dot(normal) < 0.0 { -raised } else { raised }, at))
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.material.tangent(at)
    }

    fn interior(&self) -> Option<Interior> {
        self.material.interior()
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.material.medium()
    }

    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.material.ambient(at)
    }
}
