//! The description of a scene before it is compiled.

use super::geometry::Watched;
use super::textures::Needs;
use super::{DiffuseMaterial, Emission, Geometry, Light, Material, Prototype, Surface};
use raywright_accel::{Accelerator, Primitives};
use raywright_base::work::{Stopped, Work};
use std::fmt;
use std::sync::Arc;

/// A surface with its material and emission.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Geometry.
    pub surface: Surface,
    /// Material.
    pub material: Arc<dyn Material>,
    /// Emission.
    pub emission: Emission,
}

impl Default for Shape {
    /// An empty mesh, of 50 % gray.
    fn default() -> Self {
        let material = Arc::new(DiffuseMaterial::default());
        Self { surface: Surface::default(), material, emission: Emission::default() }
    }
}

impl Shape {
    /// The lookup data that shading a point of the shape needs.
    pub fn needs(&self) -> Needs {
        // Emission textures of a dark shape are never evaluated.
        let emission = if self.emission.is_dark() { Needs::NONE } else { self.emission.needs() };
        self.material.needs() | emission
    }
}

/// A scene before compilation.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// Surfaces; the index of one is its shape number.
    pub shapes: Vec<Shape>,
    /// Lights that are not surfaces.
    pub lights: Vec<Arc<dyn Light>>,
}

/// The reason why a description is invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DescriptionError {
    /// The material of this shape is invalid, for this reason.
    Material(usize, String),
    /// This shape emits a negative, NaN or infinite radiance.
    Emission(usize),
    /// This light, which is not a surface, is invalid, for this reason.
    Light(usize, String),
    /// A prototype has this many primitives, with all instances in it flattened; that is too many.
    TooMany(u64),
    /// The build was interrupted.
    Stopped,
}

impl fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material(i, why) => write!(f, "material of shape {i}: {why}"),
            Self::Emission(i) => write!(f, "emission of shape {i} must be finite and not negative"),
            Self::Light(i, why) => write!(f, "light {i}: {why}"),
            Self::TooMany(n) => {
                write!(f, "an instance holds {n} primitives in all its copies, expected fewer than 2^31")
            }
            Self::Stopped => write!(f, "the build was canceled"),
        }
    }
}

impl std::error::Error for DescriptionError {}

impl SceneDescription {
    /// Checks that the description is valid.
    pub fn validate(&self) -> Result<(), DescriptionError> {
        for (i, shape) in self.shapes.iter().enumerate() {
            shape.material.validate().map_err(|why| DescriptionError::Material(i, why))?;
            if shape.material.is_passed() && !shape.emission.is_dark() {
                let why = "a medium interface cannot emit light; give the medium an emission";
                return Err(DescriptionError::Material(i, why.into()));
            }
            if !shape.emission.is_physical() {
                return Err(DescriptionError::Emission(i));
            }
        }
        for (i, light) in self.lights.iter().enumerate() {
            light.validate().map_err(|why| DescriptionError::Light(i, why))?;
        }
        Ok(())
    }

    /// Joins the surfaces, without vertex attributes that no material reads.
    ///
    /// # Panics
    /// If a mesh is invalid; see [`Geometry::new`].
    pub(super) fn joined(self) -> Result<SceneParts, DescriptionError> {
        self.validate()?;
        let (mut surfaces, mut materials, mut emission) = (Vec::new(), Vec::new(), Vec::new());
        for shape in self.shapes {
            let needs = shape.needs();
            surfaces.push(shape.surface.with_only(needs));
            materials.push(shape.material);
            emission.push(shape.emission);
        }
        Ok(SceneParts { geometry: Geometry::new(surfaces), materials, emission, lights: self.lights })
    }
}

/// The parts of a description before an accelerator is built.
pub(super) struct SceneParts {
    pub geometry: Geometry,
    /// Material of each shape.
    pub materials: Vec<Arc<dyn Material>>,
    /// Emission of each shape.
    pub emission: Vec<Emission>,
    /// Lights that are not surfaces.
    pub lights: Vec<Arc<dyn Light>>,
}

impl Prototype {
    /// Compiles shapes and builds an accelerator over their geometry.
    ///
    /// # Errors
    /// If a shape's material is invalid, or there are 2³¹ primitives or more, flattened: arrays count them as int32.
    pub fn new(
        shapes: Vec<Shape>,
        accelerator: impl FnOnce(&dyn Primitives) -> Box<dyn Accelerator>,
    ) -> Result<Self, DescriptionError> {
        Self::watched(shapes, accelerator, Work::UNWATCHED)
    }

    /// Like [`Prototype::new`], but interruptible.
    ///
    /// # Errors
    /// As [`Prototype::new`], and if it was interrupted.
    pub fn watched(
        shapes: Vec<Shape>,
        accelerator: impl FnOnce(&dyn Primitives) -> Box<dyn Accelerator>,
        work: Work,
    ) -> Result<Self, DescriptionError> {
        let parts = SceneDescription { shapes, ..SceneDescription::default() }.joined()?;
        let accelerator = |geometry: &Geometry| accelerator(&Watched { geometry, work });
        let prototype = Self::of(parts.geometry, parts.materials, parts.emission, accelerator);
        work.goes_on().map_err(|Stopped| DescriptionError::Stopped)?;
        prototype.map_err(DescriptionError::TooMany)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ConstantEnvironment, PointLight};
    use raywright_base::math::DVec3;
    use raywright_optics::Rgb;

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
