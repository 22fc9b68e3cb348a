//! A scene ready for rays.

use super::{DescriptionError, Geometry, Lights, Material, SceneDescription};
use crate::accel::{Accelerator, Cost, Crossings, Primitives};
use crate::math::{Hit, Ray, Region};

/// A scene ready for rays.
pub struct Scene {
    geometry: Geometry,
    materials: Vec<Material>,
    lights: Lights,
    accelerator: Box<dyn Accelerator>,
    region: Region,
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
        let region = geometry.region();
        let lights = Lights::new(&geometry, emission, points, environment);
        let accelerator = accelerator(&geometry);
        Ok(Self { geometry, materials, lights, accelerator, region })
    }

    /// The closest hit of each ray.
    pub fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.accelerator.intersect(rays, hits);
    }

    /// Whether each ray hits anything.
    pub fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.accelerator.occluded(rays, occluded);
    }

    /// Every hit of each ray.
    pub fn crossings(&self, rays: &[Ray]) -> Crossings {
        self.accelerator.crossings(rays)
    }

    /// What finding the closest hit of each ray takes.
    pub fn cost(&self, rays: &[Ray], costs: &mut [Cost]) {
        self.accelerator.cost(rays, costs);
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

    /// Where all that can be hit lies.
    pub fn region(&self) -> &Region {
        &self.region
    }
}
