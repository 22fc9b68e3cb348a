//! The sources of a radiosity solution: patch sides with their emission and reflectance.

use crate::view_factors::Fronts;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::parallel;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Patches, Scene, SurfaceInteraction, SurfacePoint};
use std::f64::consts::PI;

/// The sides of faces that take part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The sides of the normals; the other sides are black.
    Front,
    /// Both sides, independently.
    Both,
}

/// Patches of a scene that exchange light. A source is one side of one patch: first all fronts, then all backs if they
/// take part.
#[derive(Clone, Debug)]
pub struct Enclosure {
    pub(super) patches: Patches,
    pub(super) sides: Sides,
    pub(super) areas: Vec<f64>,
    pub(super) emission: Vec<Rgb>,
    pub(super) reflectance: Vec<Rgb>,
    fronts: Fronts,
}

/// Sample points of a patch, as the weights of its second and third corner: the centroids of its four quarters.
const LOOKS: [[f64; 2]; 4] = [[1.0 / 3.0, 1.0 / 3.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0], [1.0 / 6.0; 2]];

impl Enclosure {
    /// The patches of a scene. Nondiffuse materials count as black, and textures are averaged over four points per
    /// patch. Degenerate triangles and those with a non-finite corner are never hit: they have no area, and are black.
    ///
    /// # Errors
    ///
    /// If a shape is unbounded, or cannot be sampled uniformly.
    pub fn new(scene: &Scene, patches: Patches, sides: Sides) -> Result<Self, String> {
        let geometry = scene.geometry();
        if patches.primitives() != geometry.count() {
            return Err(format!("patches are of {} faces, expected all {}", patches.primitives(), geometry.count()));
        }
        let count = patches.count() as u32;
        let area = |patch: usize| {
            let primitive = patches.cell(patch as u32).primitive;
            let is_dropped =
                geometry.shape(primitive).is_none() && !geometry.corners(primitive).iter().all(|c| c.is_finite());
            if is_dropped { 0.0 } else { geometry.area(primitive) * patches.share(primitive) }
        };
        let areas = parallel::collect(patches.count(), area);
        let is_bad = |(patch, area): (usize, &f64)| {
            let is_curved = geometry.shape(patches.cell(patch as u32).primitive).is_some();
            !area.is_finite() || (is_curved && *area <= 0.0)
        };
        if let Some(bad) = areas.iter().enumerate().position(is_bad) {
            let (shape, face) = geometry.locate(patches.cell(bad as u32).primitive);
            return Err(format!("face {face} of shape {shape} must have a finite area above 0 to exchange light"));
        }
        let all = if sides == Sides::Both { 2 * count } else { count };
        let fronts = match sides {
            Sides::Front => Fronts::new(scene),
            // Rays hit each side of a sheet as the back of the other side.
            Sides::Both => Fronts::of_touching(scene),
        };
        let mut made = Self { patches, sides, areas, emission: Vec::new(), reflectance: Vec::new(), fronts };
        let looks = parallel::collect(all as usize, |source| made.look(scene, source as u32));
        let looks: Vec<(Rgb, Rgb)> = looks.into_iter().collect::<Result<_, _>>()?;
        (made.emission, made.reflectance) = looks.into_iter().unzip();
        Ok(made)
    }

    /// Replace emitted radiosities and reflectances, one per source.
    ///
    /// # Errors
    ///
    /// If their numbers differ from the number of sources.
    pub fn with(self, emission: Vec<Rgb>, reflectance: Vec<Rgb>) -> Result<Self, String> {
        let count = self.sources();
        if emission.len() != count || reflectance.len() != count {
            return Err(format!(
                "got {} emissions and {} reflectances, expected {count} of each",
                emission.len(),
                reflectance.len()
            ));
        }
        Ok(Self { emission, reflectance, ..self })
    }

    /// The emission and reflectance of a source.
    fn look(&self, scene: &Scene, source: u32) -> Result<(Rgb, Rgb), String> {
        let (patch, side) = self.side(source);
        if self.areas[patch as usize] == 0.0 {
            return Ok((Rgb::ZERO, Rgb::ZERO));
        }
        let (geometry, cell) = (scene.geometry(), self.patches.cell(patch));
        let mut sums = (Rgb::ZERO, Rgb::ZERO);
        for look in LOOKS {
            let (surface, uv) = match geometry.shape(cell.primitive) {
                None => {
                    let uv = cell.at(look);
                    (geometry.on_triangle(cell.primitive, uv), uv)
                }
                Some(shape) => {
                    let drawn = shape.sample(look).filter(|drawn| (drawn.pdf * shape.area() - 1.0).abs() < 1e-6);
                    let drawn = drawn.ok_or_else(|| {
                        let number = geometry.locate(cell.primitive).0;
                        format!("shape {number} has a nonuniform scale and cannot be sampled uniformly: use a mesh")
                    })?;
                    (geometry.on_shape(cell.primitive, &drawn.point.site()), drawn.point.uv)
                }
            };
            let back = surface.normal * side;
            let ray = Ray::new(surface.position + back, -back);
            let hit = Hit { t: 1.0, uv, primitive: cell.primitive, inner: 0 };
            let (emission, reflectance) = seen(scene, &ray, &hit, surface);
            sums = (sums.0 + emission, sums.1 + reflectance);
        }
        let share = 1.0 / LOOKS.len() as f64;
        Ok((sums.0 * (PI * share), sums.1 * share))
    }

    /// The number of sources.
    pub fn sources(&self) -> usize {
        self.patches.count() * if self.sides == Sides::Both { 2 } else { 1 }
    }

    /// The patch of a source, and 1 for its front or −1 for its back.
    #[inline]
    pub(super) fn side(&self, source: u32) -> (u32, f64) {
        let count = self.patches.count() as u32;
        if source < count { (source, 1.0) } else { (source - count, -1.0) }
    }

    /// The source that a ray from a point on a side of a face hits; None if it hits nothing or a black side.
    ///
    /// If two faces touch front to front, all light from one reaches the other, and rays inside their solids hit backs.
    #[inline]
    pub(super) fn met(
        &self,
        scene: &Scene,
        (from, side, place): (u32, f64, DVec3),
        ray: &Ray,
        hit: &Hit,
    ) -> Option<u32> {
        if self.sides == Sides::Front && !self.fronts.is_empty() {
            let (face, uv) = self.fronts.met(scene, (from, place), ray, hit)?;
            return Some(self.patches.find(face, uv).0);
        }
        if side > 0.0
            && let Some((face, uv)) = self.fronts.touching(from, place)
        {
            return Some(self.patches.find(face, uv).0);
        }
        if !hit.is_hit() {
            return None;
        }
        let geometry = scene.geometry();
        let (mut patch, _) = self.patches.find(hit.primitive, hit.uv);
        let normal = match geometry.shape(hit.primitive) {
            None => geometry.normal(hit.primitive),
            Some(_) => geometry.surface(ray, hit).normal,
        };
        let mut is_front = ray.direction.dot(normal) <= 0.0;
        if is_front && self.fronts.is_touched(hit.primitive) {
            let place = geometry.surface(ray, hit).position;
            if let Some((face, uv)) = self.fronts.touching(hit.primitive, place) {
                (patch, is_front) = (self.patches.find(face, uv).0, false);
            }
        }
        match (is_front, self.sides) {
            (true, _) => Some(patch),
            (false, Sides::Both) => Some(patch + self.patches.count() as u32),
            (false, Sides::Front) => None,
        }
    }

    /// Return whether another face touches a side of a face at a point, so that no other light reaches it.
    #[inline]
    pub(super) fn is_touched(&self, (face, side, place): (u32, f64, DVec3)) -> bool {
        side > 0.0 && self.fronts.touching(face, place).is_some()
    }

    /// The area of a source.
    #[inline]
    pub(super) fn area(&self, source: u32) -> f64 {
        self.areas[self.side(source).0 as usize]
    }

    /// The patches.
    pub fn patches(&self) -> &Patches {
        &self.patches
    }

    /// The area of each patch.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// The emitted radiosity of each source, W/m².
    pub fn emission(&self) -> &[Rgb] {
        &self.emission
    }

    /// The reflectance of each source.
    pub fn reflectance(&self) -> &[Rgb] {
        &self.reflectance
    }
}

/// The radiance that a surface emits toward a ray's origin, and its reflectance.
fn seen(scene: &Scene, ray: &Ray, hit: &Hit, surface: SurfacePoint) -> (Rgb, Rgb) {
    let emission = scene.emission_at(&surface).sent(scene.geometry(), ray, hit, &surface, || 0.0);
    let here = SurfaceInteraction::new(scene, ray, hit, surface, 0.0, 1.0);
    (emission, here.bsdf().diffuse().unwrap_or(Rgb::ZERO))
}
