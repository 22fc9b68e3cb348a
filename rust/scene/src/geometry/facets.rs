//! Per-triangle data that every hit reads.

use raywright_base::math::{DVec3, Vec3};

/// A face in one cache line: its corners, normal and shape number.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Facet {
    /// Unit normal by the winding; NaN for a face without area.
    pub normal: DVec3,
    /// The corners, if f32 holds them exactly; otherwise NaN, and NaN for a primitive that is not a face.
    pub corners: [Vec3; 3],
    /// Shape number.
    pub shape: u32,
}

/// The facets of all primitives, for a geometry with few of them. Recomputing a normal takes a square root and six
/// divisions, and finding the shape a search. With more faces than the second-level cache holds, reading facets would
/// wait for memory and evict other data.
#[derive(Debug, Default)]
pub(super) struct Facets(Vec<Facet>);

impl Facets {
    /// Largest number of primitives with facets: half a megabyte.
    const FEW: usize = 1 << 13;

    /// Computes the facets of `count` primitives; keeps none if there are many.
    pub fn new(count: usize, of: impl Fn(u32) -> Facet) -> Self {
        let few = if count <= Self::FEW { count as u32 } else { 0 };
        Self((0..few).map(of).collect())
    }

    /// The facet of a primitive, if it is kept.
    #[inline]
    pub fn get(&self, primitive: u32) -> Option<&Facet> {
        self.0.get(primitive as usize)
    }

    /// Returns whether no facet is kept.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geometry, Mesh};

    /// `count` arbitrary triangles in meshes of a hundred, with one without area at the end.
    fn geometry(count: u32) -> Geometry {
        let corner = |i: u32| Vec3::new((i as f32).sin(), (2.3 * i as f32).cos(), (0.7 * i as f32).sin());
        let mesh = |first: u32| Mesh {
            vertices: (first..first + 102).map(corner).collect(),
            faces: (0..100).map(|i| if i + 1 == 100 { [i, i, i + 1] } else { [i, i + 1, i + 2] }).collect(),
            ..Mesh::default()
        };
        Geometry::new((0..count / 100).map(|i| mesh(100 * i)))
    }

    #[test]
    fn few_and_many_are_told_the_same() {
        let (few, many) = (geometry(1000), geometry(2 * Facets::FEW as u32));
        let facet = |_| Facet { normal: DVec3::Z, corners: [Vec3::ZERO; 3], shape: 0 };
        assert_eq!([1000, Facets::FEW + 1].map(|count| Facets::new(count, facet).bytes()), [64_000, 0]);
        for primitive in 0..1000 {
            let (a, b) = (few.on_triangle(primitive, [0.2, 0.3]), many.on_triangle(primitive, [0.2, 0.3]));
            assert_eq!(few.locate(primitive), many.locate(primitive));
            assert_eq!((a.shape, few.locate(primitive)), (primitive / 100, (primitive / 100, primitive % 100)));
            assert_eq!(a.normal.to_array().map(f64::to_bits), b.normal.to_array().map(f64::to_bits));
            assert_eq!(a.normal.is_nan(), primitive % 100 == 99);
        }
    }
}
