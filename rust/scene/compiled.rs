//! A scene ready for rays.

use super::{DescriptionError, Geometry, Lights, Material, SceneDescription};
use crate::accel::{Accelerator, Primitives};
use crate::math::{Aabb, Hit, Ray};

/// A scene ready for rays.
pub struct Scene {
    geometry: Geometry,
    materials: Vec<Material>,
    lights: Lights,
    accelerator: Box<dyn Accelerator>,
    bounds: Aabb,
}

impl Scene {
    /// Compiles a description, with an accelerator made for its geometry.
    ///
    /// # Panics
    /// If a mesh is no mesh; see [`Geometry::new`].
    pub fn new(
        description: SceneDescription,
        accelerator: impl FnOnce(&Geometry) -> Box<dyn Accelerator>,
    ) -> Result<Self, DescriptionError> {
        description.validate()?;
        let SceneDescription { shapes, points, environment } = description;
        let (mut meshes, mut materials, mut emission) = (Vec::new(), Vec::new(), Vec::new());
        for shape in shapes {
            meshes.push(shape.mesh);
            materials.push(shape.material);
            emission.push(shape.emission);
        }
        let geometry = Geometry::new(meshes);
        let bounds = (0..geometry.count() as u32).fold(Aabb::EMPTY, |all, p| all.union(geometry.aabb(p)));
        let lights = Lights::new(&geometry, emission, points, environment);
        let accelerator = accelerator(&geometry);
        Ok(Self { geometry, materials, lights, accelerator, bounds })
    }

    /// The closest hit of each ray.
    pub fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.accelerator.intersect(rays, hits);
    }

    /// Whether each ray hits anything.
    pub fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.accelerator.occluded(rays, occluded);
    }

    /// Its surfaces.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Its lights.
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// What a shape is made of.
    #[inline]
    pub fn material(&self, shape: u32) -> &Material {
        &self.materials[shape as usize]
    }

    /// What finds its hits.
    pub fn accelerator(&self) -> &dyn Accelerator {
        self.accelerator.as_ref()
    }

    /// The box around all that can be hit.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
}
