//! A scene as it is described, before it is compiled.

use super::textures::Needs;
use super::{DiffuseMaterial, Emission, Light, Material, Surface};
use std::fmt;
use std::sync::Arc;

/// One surface, what it is made of, and how it shines.
#[derive(Clone, Debug)]
pub struct Shape {
    /// What rays hit.
    pub surface: Surface,
    /// What it is made of.
    pub material: Arc<dyn Material>,
    /// How it shines.
    pub emission: Emission,
}

impl Default for Shape {
    /// Nothing, of half grey.
    fn default() -> Self {
        let material = Arc::new(DiffuseMaterial::default());
        Self { surface: Surface::default(), material, emission: Emission::default() }
    }
}

impl Shape {
    /// What must be known of a point of it to shade it.
    pub fn needs(&self) -> Needs {
        // What is dark is not asked how it shines.
        let emission = if self.emission.is_dark() { Needs::NONE } else { self.emission.needs() };
        self.material.needs() | emission
    }
}

/// All that is in a scene.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// Surfaces; the index of one is its shape number.
    pub shapes: Vec<Shape>,
    /// Lights that are no surfaces.
    pub lights: Vec<Arc<dyn Light>>,
}

/// Why a description cannot be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DescriptionError {
    /// The material of this shape cannot be, and why.
    Material(usize, String),
    /// This shape emits less than nothing, or NaN, or infinitely much.
    Emission(usize),
    /// This light that is no surface cannot be, and why.
    Light(usize, String),
    /// A group has so many primitives, all copies in it counted.
    TooMany(u64),
}

impl fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material(i, why) => write!(f, "material of shape {i}: {why}"),
            Self::Emission(i) => write!(f, "emission of shape {i} must be finite and not negative"),
            Self::Light(i, why) => write!(f, "light {i}: {why}"),
            Self::TooMany(n) => write!(
                f,
                "an instance holds {n} primitives, all copies in it counted; fewer than 2^31 can be told apart"
            ),
        }
    }
}

impl std::error::Error for DescriptionError {}

impl SceneDescription {
    /// Whether it can be.
    pub fn validate(&self) -> Result<(), DescriptionError> {
        for (i, shape) in self.shapes.iter().enumerate() {
            shape.material.validate().map_err(|why| DescriptionError::Material(i, why))?;
            if !shape.emission.is_physical() {
                return Err(DescriptionError::Emission(i));
            }
        }
        for (i, light) in self.lights.iter().enumerate() {
            light.validate().map_err(|why| DescriptionError::Light(i, why))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use crate::optics::Rgb;
    use crate::scene::{ConstantEnvironment, PointLight};

    #[test]
    fn says_what_cannot_be() {
        let shape = |reflectance: f64, emission: f64| Shape {
            material: Arc::new(DiffuseMaterial { reflectance: reflectance.into() }),
            emission: Rgb::splat(emission).into(),
            ..Shape::default()
        };
        let shapes = |last| SceneDescription { shapes: vec![shape(1.0, 5.0), last], ..Default::default() };
        assert_eq!(shapes(shape(0.0, 0.0)).validate(), Ok(()));
        for bad in [-0.1, 1.000_001, f64::NAN] {
            assert!(matches!(shapes(shape(bad, 0.0)).validate(), Err(DescriptionError::Material(1, _))));
        }
        for bad in [-0.1, f64::INFINITY, f64::NAN] {
            assert_eq!(shapes(shape(0.5, bad)).validate(), Err(DescriptionError::Emission(1)));
            let good = || Arc::new(ConstantEnvironment { radiance: Rgb::ONE }) as Arc<dyn Light>;
            let point = Arc::new(PointLight { position: DVec3::ZERO, intensity: Rgb::splat(bad) });
            let points = SceneDescription { lights: vec![good(), point], ..Default::default() };
            assert!(matches!(points.validate(), Err(DescriptionError::Light(1, _))));
            let sky = Arc::new(ConstantEnvironment { radiance: Rgb::splat(bad) });
            let sky = SceneDescription { lights: vec![sky], ..Default::default() };
            assert!(matches!(sky.validate(), Err(DescriptionError::Light(0, _))));
        }
    }
}
