//! Triangle-cell overlap tests.
//!
//! A triangle overlaps a box unless one of thirteen axes separates them: the box's three, the triangle's normal, and
//! the nine cross products of their edges (Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", 2001). All cells
//! have the same size, so the allowed interval on each axis is computed once per triangle, and a cell takes one dot
//! product with its center (Schwarz and Seidel, "Fast Parallel Surface and Solid Voxelization on GPUs", 2010).
//!
//! The test is valid for any axis, even a rounded one. Projections in f64 err by some 2⁻⁵⁰ of the axis' length, and the
//! cell is widened by [`PAD`], a sixth of which is spare. So rounding never excludes an overlapping triangle.

use super::PAD;
use super::lattice::Lattice;
use raywright_base::math::{DVec3, Vec3};

/// The potential separating axes of a triangle and cells, other than the coordinate axes.
pub struct Overlap {
    /// Axes, each with the interval of cell centers that overlap.
    axes: [(DVec3, f64, f64); 10],
}

impl Overlap {
    /// Set up the test of a triangle in box units against the cells of a lattice.
    pub fn new(corners: [DVec3; 3], lattice: &Lattice) -> Self {
        let half = (Vec3::from(lattice.width) / 2.0 + Vec3::splat(PAD)).as_dvec3();
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let bounded = |axis: DVec3| {
            // Products may underflow below this.
            if axis.abs().max_element() < 1e-200 {
                return (axis, f64::NEG_INFINITY, f64::INFINITY);
            }
            let [a, b, c] = corners.map(|corner| axis.dot(corner));
            let reach = axis.abs().dot(half);
            (axis, a.min(b).min(c) - reach, a.max(b).max(c) + reach)
        };
        let mut axes = [bounded(edges[0].cross(edges[1])); 10];
        for (i, edge) in edges.into_iter().enumerate() {
            for (j, side) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
                axes[1 + 3 * i + j] = bounded(edge.cross(side));
            }
        }
        Self { axes }
    }

    /// Return whether the triangle overlaps a cell that its bounding box overlaps.
    #[inline]
    pub fn touches(&self, middle: DVec3) -> bool {
        self.axes.iter().all(|&(axis, least, most)| {
            let at = axis.dot(middle);
            least <= at && at <= most
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::Aabb;

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(prop_oneof![-1.0..1.0f64, (-4i32..=4).prop_map(|x| f64::from(x) / 4.0)])
            .prop_map(DVec3::from_array)
    }

    /// Clip a polygon against one side of an axis-aligned plane (Sutherland and Hodgman 1974).
    fn clipped(polygon: &[DVec3], axis: usize, plane: f64, sign: f64) -> Vec<DVec3> {
        let depth = |p: DVec3| sign * (p[axis] - plane);
        let mut rest = Vec::new();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (from, to) = (depth(p), depth(q));
            if from >= 0.0 {
                rest.push(p);
            }
            if (from < 0.0) != (to < 0.0) {
                rest.push(p + (q - p) * (from / (from - to)));
            }
        }
        rest
    }

    proptest! {
        #[test]
        fn a_triangle_touches_the_cells_that_clipping_leaves_something_in(corners in prop::array::uniform3(point())) {
            let lattice = Lattice::around(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE }, [5, 4, 3]);
            let overlap = Overlap::new(corners, &lattice);
            let left_by = |middle: DVec3, pad: f64| {
                let half = (Vec3::from(lattice.width) / 2.0).as_dvec3() + pad;
                (0..3).fold(corners.to_vec(), |rest, axis| {
                    let rest = clipped(&rest, axis, middle[axis] - half[axis], 1.0);
                    clipped(&rest, axis, middle[axis] + half[axis], -1.0)
                })
            };
            let min = corners[0].min(corners[1]).min(corners[2]).as_vec3() - 1e-6;
            let max = corners[0].max(corners[1]).max(corners[2]).as_vec3() + 1e-6;
            for number in 0..lattice.count() {
                let cell = lattice.cell(number);
                let middle = lattice.middle(cell);
                let (from, to) = lattice.range(&Aabb { min, max }).unwrap();
                let in_range = (0..3).all(|a| (from[a]..=to[a]).contains(&cell[a]));
                let touches = in_range && overlap.touches(middle);
                if !left_by(middle, 0.9 * f64::from(PAD)).is_empty() {
                    prop_assert!(touches, "{cell:?} is touched by {corners:?}");
                }
                // The thirteen axes are exhaustive, up to rounding.
                if left_by(middle, 2.0 * f64::from(PAD)).is_empty() {
                    prop_assert!(!touches, "{cell:?} is not touched by {corners:?}");
                }
            }
        }
    }

    #[test]
    fn a_diagonal_leaves_most_cells_of_its_box_alone() {
        let lattice = Lattice::around(&Aabb { min: Vec3::ZERO, max: Vec3::ONE }, [10; 3]);
        let sliver = Overlap::new([DVec3::ZERO, DVec3::ONE, DVec3::new(1.0, 1.0, 0.99)], &lattice);
        let touched = (0..1000).filter(|&i| sliver.touches(lattice.middle(lattice.cell(i)))).count();
        // The diagonal passes through nine corners, each shared by eight cells.
        assert_eq!(touched, 10 + 9 * 6);
    }

    #[test]
    fn points_and_lines_are_triangles_too() {
        let lattice = Lattice::around(&Aabb { min: Vec3::ZERO, max: Vec3::ONE }, [3; 3]);
        for corners in [[DVec3::splat(0.5); 3], [DVec3::splat(0.5), DVec3::splat(0.6), DVec3::splat(0.55)]] {
            assert!(Overlap::new(corners, &lattice).touches(lattice.middle([1, 1, 1])));
        }
    }
}
