//! Roughness parameters of microfacet materials.

use super::checks::within;
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;

/// Roughness of a microfacet surface along u and v. It is either a perceptual number between 0 and 1, whose square is
/// the α of the facet distribution (Burley, "Physically-Based Shading at Disney", 2012; also glTF), or α itself.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// Along u and along v; equal for an isotropic surface.
    pub along: [Value<f64>; 2],
    /// True if the values are α.
    pub is_alpha: bool,
    /// Facet distribution.
    pub facets: FacetKind,
}

/// Facet distribution, and the treatment of interreflection between facets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FacetKind {
    /// GGX with multiple scattering.
    #[default]
    Ggx,
    /// Beckmann with multiple scattering.
    Beckmann,
    /// GGX with single scattering.
    GgxOnce,
    /// Beckmann with single scattering.
    BeckmannOnce,
}

impl Default for Roughness {
    /// Smooth.
    fn default() -> Self {
        0.0.into()
    }
}

impl From<f64> for Roughness {
    /// Isotropic.
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

    /// Minimum and maximum α along u.
    pub fn alpha_range(&self) -> [f64; 2] {
        self.along[0].range().map(|r| {
            let r = r.clamp(0.0, 1.0);
            if self.is_alpha { r } else { r * r }
        })
    }

    /// Returns whether it is isotropic.
    #[inline]
    pub fn is_alike(&self) -> bool {
        self.along[0] == self.along[1]
    }

    /// The u direction, if the surface is anisotropic.
    #[inline]
    pub fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        (!self.is_alike()).then_some(at.dp[0])
    }

    /// The lookup data that evaluation needs.
    pub fn needs(&self) -> Needs {
        let along = if self.is_alike() { Needs::NONE } else { Needs { uv: true, tangents: true, ..Needs::NONE } };
        self.along[0].needs() | self.along[1].needs() | along
    }

    /// Checks that the values are between 0 and 1.
    ///
    /// # Errors
    /// If they are not.
    pub fn validate(&self) -> Result<(), String> {
        self.along.iter().try_for_each(|value| within(self.name(), value, 0.0, 1.0))
    }

    /// Checks that the values are between 0 and 1 and isotropic.
    ///
    /// # Errors
    /// If they are not.
    pub fn validate_alike(&self) -> Result<(), String> {
        self.validate()?;
        let alike = self.is_alike().then_some(());
        alike.ok_or_else(|| format!("{} must be one number here, got two", self.name()))
    }

    fn name(&self) -> &'static str {
        if self.is_alpha { "alpha" } else { "roughness" }
    }
}
