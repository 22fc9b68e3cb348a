//! How rough a surface is.

use super::checks::within;
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;

/// How rough a surface of small facets is, along u and along v: as an artist's number between 0 and 1, whose square is
/// the α of the facets' distribution (Burley, "Physically-Based Shading at Disney", 2012; glTF has it so too), or as α
/// itself.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// Along u and along v; the same value twice for what is alike in all directions.
    pub along: [Value<f64>; 2],
    /// Whether it is α itself.
    pub is_alpha: bool,
    /// Of which facets.
    pub facets: FacetKind,
}

/// Which facets a rough surface is made of, and what becomes of light that they throw on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FacetKind {
    /// GGX's, with all of the light.
    #[default]
    Ggx,
    /// Beckmann's, with all of the light.
    Beckmann,
    /// GGX's, with what is scattered once.
    GgxOnce,
    /// Beckmann's, with what is scattered once.
    BeckmannOnce,
}

impl Default for Roughness {
    /// Smooth.
    fn default() -> Self {
        0.0.into()
    }
}

impl From<f64> for Roughness {
    /// Alike in all directions.
    fn from(roughness: f64) -> Self {
        Value::<f64>::from(roughness).into()
    }
}

impl From<Value<f64>> for Roughness {
    fn from(roughness: Value<f64>) -> Self {
        Self { along: [roughness.clone(), roughness], is_alpha: false, facets: FacetKind::default() }
    }
}

impl Roughness {
    /// α along u and v at a point.
    #[inline]
    pub fn alpha(&self, point: &TexturePoint) -> [f64; 2] {
        let alpha = |value: &Value<f64>| {
            let r = value.at(point).clamp(0.0, 1.0);
            if self.is_alpha { r } else { r * r }
        };
        let first = alpha(&self.along[0]);
        if self.is_alike() { [first; 2] } else { [first, alpha(&self.along[1])] }
    }

    /// The least and the greatest α along u.
    pub fn alpha_range(&self) -> [f64; 2] {
        self.along[0].range().map(|r| {
            let r = r.clamp(0.0, 1.0);
            if self.is_alpha { r } else { r * r }
        })
    }

    /// Whether it is the same in all directions.
    #[inline]
    pub fn is_alike(&self) -> bool {
        self.along[0] == self.along[1]
    }

    /// Where u goes, if it makes a difference.
    #[inline]
    pub fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        (!self.is_alike()).then_some(at.dp[0])
    }

    /// What it must know of a point.
    pub fn needs(&self) -> Needs {
        let along = if self.is_alike() { Needs::NONE } else { Needs { uv: true, tangents: true, ..Needs::NONE } };
        self.along[0].needs() | self.along[1].needs() | along
    }

    /// Whether it lies between 0 and 1.
    ///
    /// # Errors
    /// If it does not.
    pub fn validate(&self) -> Result<(), String> {
        self.along.iter().try_for_each(|value| within(self.name(), value, 0.0, 1.0))
    }

    /// Whether it lies between 0 and 1, the same in all directions.
    ///
    /// # Errors
    /// If it does not.
    pub fn validate_alike(&self) -> Result<(), String> {
        self.validate()?;
        let alike = self.is_alike().then_some(());
        alike.ok_or_else(|| format!("{} must be the same in all directions here, got two", self.name()))
    }

    fn name(&self) -> &'static str {
        if self.is_alpha { "alpha" } else { "roughness" }
    }
}
