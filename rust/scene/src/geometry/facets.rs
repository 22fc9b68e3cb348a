//! What is asked of a triangle at every hit.

use raywright_base::math::{DVec3, Vec3};

/// A face, in a cache line: its corners, its normal, and which shape it is of.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Facet {
    /// Unit normal as the winding gives it; NaN for a face without area.
    pub normal: DVec3,
    /// Where they have no more digits than these; NaN otherwise, and for what is no face.
    pub corners: [Vec3; 3],
    /// Which shape.
    pub shape: u32,
}

/// Those of all primitives of a geometry of few. A normal takes a root and six quotients, and the shape a search; of
/// more faces than the processor's second cache holds, to read them would be to wait for memory, and would push out of
/// the cache what else is needed.
#[derive(Debug, Default)]
pub(super) struct Facets(Vec<Facet>);

impl Facets {
    /// Primitives that count as few: half a megabyte of facets.
    const FEW: usize = 1 << 13;

    /// Of so many primitives, by what they are computed from; none if there are many.
    pub fn new(count: usize, of: impl Fn(u32) -> Facet) -> Self {
        let few = if count <= Self::FEW { count as u32 } else { 0 };
        Self((0..few).map(of).collect())
    }

    /// That of a primitive, if they are kept.
    #[inline]
    pub fn get(&self, primitive: u32) -> Option<&Facet> {
        self.0.get(primitive as usize)
    }

    /// Whether none are kept.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geometry, Mesh};

    /// So many askew triangles, in meshes of a hundred, and one without area at the end.
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
