//! Normal mapping.

use super::bump::on_its_side;
use super::checks::{number, within};
use super::{BsdfMix, Interior, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use std::sync::Arc;

/// Normal mapping: red, green and blue from 0 to 1 are −1 to 1 along u, v and the normal, as in glTF.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// The base material.
    pub material: Arc<dyn Material>,
    /// The normals, in linear color.
    pub normals: Value,
    /// Factor on the components along u and v.
    pub scale: f64,
}

impl Material for NormalMap {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.material.bsdf(at)
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        self.material.kinds()
    }

    fn needs(&self) -> Needs {
        self.material.needs() | self.normals.needs() | Needs { uv: true, tangents: true, ..Needs::NONE }
    }

    fn validate(&self) -> Result<(), String> {
        within("normals", &self.normals, 0.0, 1.0)?;
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
        let [x, y, z] = (self.normals.at(&at.texture) * 2.0 - 1.0).to_array();
        let (x, y) = (x * self.scale, y * self.scale);
        if x == 0.0 && y == 0.0 {
            return own;
        }
        // The tangent is u without its normal component; the bitangent is perpendicular to both, on the side of v.
        let Some(u) = (at.dp[0] - normal * normal.dot(at.dp[0])).try_normalize() else { return own };
        let v = normal.cross(u);
        let v = if v.dot(at.dp[1]) < 0.0 { -v } else { v };
        let z = if at.as_given { z } else { z.max(0.0) };
        let Some(turned) = (u * x + v * y + normal * z).try_normalize() else { return own };
        Some(on_its_side(turned, at))
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
