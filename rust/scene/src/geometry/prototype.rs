//! Prototypes of instances: shapes in a local space with an accelerator over them.

use super::plane_point::PlanePoint;
use super::{Enclosing, Geometry, Solids};
use crate::textures::Needs;
use crate::{Emission, Material, ShadingPoint, SurfacePoint};
use raywright_accel::{Accelerator, Primitives, Side};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::parallel::{self, CHUNK};
use raywright_shapes::Bounds;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Shapes that are instanced together, compiled once.
///
/// Their primitives are numbered consecutively, *flattened*, shape by shape. A mesh contributes its faces and another
/// shape one primitive. Instances contribute all primitives of their prototype once per instance, in order.
pub struct Prototype {
    geometry: Geometry,
    accelerator: Box<dyn Accelerator>,
    materials: Vec<Arc<dyn Material>>,
    emission: Vec<Emission>,
    /// The flattened number of each shape's first primitive, and the total at the end.
    first: Vec<u64>,
    has_instances: bool,
    moves: bool,
    bounds: Option<Bounds>,
    /// The closed solids in it, computed on first use.
    solids: OnceLock<Arc<Solids>>,
}

impl fmt::Debug for Prototype {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Prototype({} shapes, {} primitives)", self.geometry.shapes(), self.count())
    }
}

impl Prototype {
    /// Creates a prototype from surfaces with their materials and emission, and builds an accelerator.
    ///
    /// # Errors
    /// If there are 2³¹ primitives or more, flattened: their number.
    pub(crate) fn of(
        geometry: Geometry,
        materials: Vec<Arc<dyn Material>>,
        emission: Vec<Emission>,
        accelerator: impl FnOnce(&Geometry) -> Box<dyn Accelerator>,
    ) -> Result<Self, u64> {
        let mut first = vec![0u64];
        for shape in 0..geometry.shapes() as u32 {
            let primitives = geometry.primitives_of(shape).len() as u64;
            let each = geometry.instances_of(shape).map_or(1, |instances| u64::from(instances.prototype().count()));
            first.push(first[shape as usize] + primitives * each);
        }
        let count = first[first.len() - 1];
        if count >= 1 << 31 {
            return Err(count);
        }
        let (has_instances, moves) = (geometry.has_instances(), geometry.moves());
        let region = geometry.region();
        let is_endless = |p: usize| geometry.bounds(p as u32).is_some_and(|b| !b.is_finite());
        let any_endless = || parallel::map_chunks(geometry.count(), CHUNK, |mut some| some.any(is_endless));
        let bounds = if geometry.objects().is_some() && any_endless().contains(&true) {
            Some(Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY })
        } else {
            (!region.is_empty()).then_some(Bounds { min: region.min, max: region.max })
        };
        let (accelerator, solids) = (accelerator(&geometry), OnceLock::new());
        Ok(Self { geometry, accelerator, materials, emission, first, has_instances, moves, bounds, solids })
    }

    /// Number of primitives, flattened.
    pub fn count(&self) -> u32 {
        self.first[self.first.len() - 1] as u32
    }

    /// Bounds over all times; `None` if rays can hit nothing.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// Returns whether anything in it moves.
    pub fn moves(&self) -> bool {
        self.moves
    }

    /// The surfaces.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The acceleration structure.
    pub fn accelerator(&self) -> &dyn Accelerator {
        self.accelerator.as_ref()
    }

    /// The flattened primitive number of a hit.
    #[inline]
    pub fn flatten(&self, hit: &Hit) -> u32 {
        if !self.has_instances {
            return hit.primitive;
        }
        let (shape, number) = self.geometry.locate(hit.primitive);
        let within = match self.geometry.instances_of(shape) {
            Some(instances) => number * instances.prototype().count() + hit.inner,
            None => number,
        };
        self.first[shape as usize] as u32 + within
    }

    /// The primitive of a flattened number, and the flattened number within it.
    #[inline]
    pub fn split(&self, flat: u32) -> (u32, u32) {
        if !self.has_instances {
            return (flat, 0);
        }
        let shape = self.first.partition_point(|&f| f <= u64::from(flat)) - 1;
        let rest = flat - self.first[shape] as u32;
        let (number, inner) = match self.geometry.instances_of(shape as u32) {
            Some(instances) => (rest / instances.prototype().count(), rest % instances.prototype().count()),
            None => (rest, 0),
        };
        (self.geometry.primitives_of(shape as u32).start + number, inner)
    }

    /// The flattened number of the first primitive in the same shape of the same instance.
    pub fn first_alike(&self, flat: u32) -> u32 {
        let (primitive, inner) = self.split(flat);
        let (primitive, inner) = self.geometry.first_alike(primitive, inner);
        self.flatten(&Hit { primitive, inner, ..Hit::MISS })
    }

    /// The surface point where a ray in the prototype's space hits the primitive with flattened number `inner`.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (primitive, inner) = self.split(hit.inner);
        self.geometry.surface(ray, &Hit { primitive, inner, ..*hit })
    }

    /// The shading data where a ray in the prototype's space hits the primitive with flattened number `inner`.
    pub(super) fn shading_point(&self, ray: &Ray, hit: &Hit, needs: Needs) -> ShadingPoint {
        let (primitive, inner) = self.split(hit.inner);
        let hit = Hit { primitive, inner, ..*hit };
        self.geometry.shading_point(ray, &hit, self.geometry.surface(ray, &hit), needs)
    }

    /// A point of the triangle with a flattened number, at barycentric coordinates; `None` if it is not a triangle.
    pub(super) fn plane_point(&self, flat: u32, uv: [f64; 2], time: f64) -> Option<PlanePoint> {
        let (primitive, inner) = self.split(flat);
        if let Some((instances, instance)) = self.geometry.instance(primitive) {
            let plane = instances.prototype().plane_point(inner, uv, time)?;
            return Some(instances.pose(instance, time)?.plane_point(&plane));
        }
        let corners = self.geometry.corners(primitive);
        corners[0].is_finite().then(|| PlanePoint::of(corners, uv))
    }

    /// Material and emission of the primitive with a flattened number.
    pub fn appearance(&self, flat: u32) -> (&dyn Material, &Emission) {
        let (primitive, inner) = self.split(flat);
        let (shape, _) = self.geometry.locate(primitive);
        match self.geometry.instances_of(shape) {
            Some(instances) => instances.prototype().appearance(inner),
            None => (&*self.materials[shape as usize], &self.emission[shape as usize]),
        }
    }

    /// Material and emission of each shape.
    pub fn appearances(&self) -> impl Iterator<Item = (&dyn Material, &Emission)> {
        self.materials.iter().map(|material| &**material).zip(&self.emission)
    }

    /// The side of the closed solids on which a ray's origin lies, by the surfaces that the ray crosses.
    pub fn side(&self, ray: &Ray) -> Side {
        self.solids().sides(&self.geometry, self.accelerator(), std::slice::from_ref(ray))[0]
    }

    /// The closed solids.
    pub fn solids(&self) -> Arc<Solids> {
        // Computed outside the lock: a thread that waits for others may take up their tasks, and those may call this
        // function.
        let solids = || Arc::new(Solids::new(&self.geometry, self.accelerator(), &Enclosing::default()));
        let solids = self.solids.get().cloned().unwrap_or_else(solids);
        let _ = self.solids.set(solids.clone());
        solids
    }

    /// Memory in bytes, excluding prototypes in `seen`; this one and those in it are added to it.
    pub fn bytes(&self, seen: &mut Vec<*const Self>) -> usize {
        let me = std::ptr::from_ref(self);
        if seen.contains(&me) {
            return 0;
        }
        seen.push(me);
        let tables = size_of_val(self.materials.as_slice())
            + size_of_val(self.emission.as_slice())
            + size_of_val(self.first.as_slice());
        self.accelerator.info().bytes + self.geometry.bytes_but(seen) + tables
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{rectangle, shape};
    use crate::{DescriptionError, Instances, Matrix, Shape};
    use raywright_accel::BruteForce;
    use raywright_base::simd::Level;
    use raywright_optics::Rgb;

    const HERE: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    fn prototype(shapes: Vec<Shape>) -> Result<Arc<Prototype>, DescriptionError> {
        Prototype::new(shapes, |geometry| BruteForce::over(geometry, Level::Scalar)).map(Arc::new)
    }

    fn sheet(emission: f64) -> Shape {
        shape(rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.25; 3], emission)
    }

    fn instances(prototype: &Arc<Prototype>, count: usize) -> Shape {
        Shape { surface: Instances::new(prototype.clone(), &vec![HERE; count]).unwrap().into(), ..Shape::default() }
    }

    #[test]
    fn numbers_are_flattened_and_split() {
        let pair = prototype(vec![sheet(1.0), sheet(2.0)]).unwrap();
        let all =
            prototype(vec![sheet(3.0), instances(&pair, 3), sheet(4.0), instances(&pair, 0), sheet(5.0)]).unwrap();
        assert_eq!((pair.count(), all.count()), (4, 2 + 12 + 2 + 2));
        // Shape, number within it and inner number of each flattened number.
        let mut flat = 0;
        for (shape, each, inner, emission) in
            [(0, 2, 1, [3.0; 2]), (1, 3, 4, [1.0, 2.0]), (2, 2, 1, [4.0; 2]), (4, 2, 1, [5.0; 2])]
        {
            for number in 0..each {
                for inner in 0..inner {
                    let primitive = all.geometry().primitives_of(shape).start + number;
                    let hit = Hit { primitive, inner, ..Hit::MISS };
                    assert_eq!((all.flatten(&hit), all.split(flat)), (flat, (primitive, inner)));
                    assert_eq!(*all.appearance(flat).1, Rgb::splat(emission[inner as usize / 2]).into());
                    flat += 1;
                }
            }
        }
        assert_eq!(flat, all.count());
    }

    #[test]
    fn what_cannot_be_counted_or_be_is_refused() {
        let mut shape = sheet(0.0);
        for _ in 0..6 {
            shape = instances(&prototype(vec![shape]).unwrap(), 32);
        }
        assert_eq!(prototype(vec![shape]).unwrap_err(), DescriptionError::TooMany(1 << 31));
        assert_eq!(prototype(vec![sheet(0.0), sheet(f64::NAN)]).unwrap_err(), DescriptionError::Emission(1));
    }
}
