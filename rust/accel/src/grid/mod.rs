//! Grids: space divided into equal cells, traversed from cell to cell.
//!
//! Textbooks accept a hit only inside its cell, since a primitive referenced in many cells may be hit in one that the
//! ray reaches later. Here this test is not needed, for the following reason.
//!
//! Along axis a, plane i of a grid is at the real number pᵢ = low + i · width. Traversal computes the `t` of that plane
//! as Tₐ(i), in f32 by one formula (`dda.rs`). That is monotone in i, so the rounded values divide the line of t into
//! intervals without gaps. Traversal visits every cell with a nonempty interval, the intersection of those of its three
//! axes. Let a ray hit a primitive at t, in the interval of some cell. In exact arithmetic the ray would be in that
//! cell at t. With rounding it is at most PAD outside along each axis. A primitive is referenced in every cell that it
//! overlaps when the cell is widened by PAD, so in this one, too. Hence every hit up to the t at which the ray leaves a
//! cell is referenced in the cells visited so far. A hit is valid wherever it lies, and traversal ends once the nearest
//! known hit is before the end of the current cell. The outer planes of a grid are so much farther than PAD from its
//! content that no hit is outside their intervals.
//!
//! The bound. Let v = 2⁻²⁴, all lengths be in box units, and r be the inverse of the direction along an axis, as
//! [`SlabRay`] has it. Planes are at most P = 2 from the center, plus a little. A ray that is not far starts at most 8
//! radii away, O = 16, and its reach is R = 18. In units of v·|r|, a plane's computed t errs by 2R for r; by 4O for the
//! shift −o·r (o is rounded, the product, `near` and `far`, and their sum); by 2·4 for i · (width · r); by P + (P + O)
//! for low · r and its sum with the shift; and by R for the last sum: 146. So the ray is 146v from the plane's assumed
//! position. A hit's own t errs by a quarter of v times the reach, along which the ray moves less than twice as far:
//! 9v. For a ray that is far and was moved, R is 6 and O is 4: 53v in all. The move costs less than the ray's pad, of
//! which 48v are for other errors: if the pad is at most MOST_PAD = 144v, 96v remain, 149v together. PAD is 192v. Rays
//! with a larger pad, from beyond a hundred million radii, bisect the grid instead (`halving.rs`).
//!
//! Sources: Fujimoto, Tanaka and Iwata, "ARTS: Accelerated Ray-Tracing System", 1986; Amanatides and Woo, "A Fast Voxel
//! Traversal Algorithm for Ray Tracing", 1987; Cleary and Wyvill, "Analysis of an Algorithm for Fast Ray Tracing Using
//! Uniform Space Subdivision", 1988.

mod dda;
mod fill;
mod halving;
mod lattice;
pub mod nested;
mod overlap;
mod resolution;
pub mod uniform;

pub use resolution::Resolution;

use crate::SlabRay;
use raywright_shapes::triangle::EdgeRay;

/// Distance from a cell, in box units, within which primitives are referenced in it.
const PAD: f32 = 3.0 / (1u32 << 18) as f32;

/// Maximum pad of rays that step from cell to cell: that of the most distant origin that is not moved, with an
/// allowance for rounding.
const MOST_PAD: f32 = (2.0 * (EdgeRay::FAR + 1.0) * (1.0 + 1e-6)) as f32 / (1u32 << 21) as f32;

/// Return whether a ray may step from cell to cell.
#[inline(always)]
fn can_step(ray: &SlabRay) -> bool {
    ray.pad <= MOST_PAD
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Primitives;
    use crate::walk::{Input, Lists, Structure};
    use raywright_base::math::{DVec3, Ray, Region};
    use raywright_base::sampling::philox4x32;
    use raywright_base::work::Work;

    struct Triangles(Vec<[DVec3; 3]>);

    impl Primitives for Triangles {
        fn count(&self) -> usize {
            self.0.len()
        }

        fn corners(&self, primitive: u32) -> [DVec3; 3] {
            self.0[primitive as usize]
        }

        fn is_single(&self) -> bool {
            false
        }
    }

    impl Triangles {
        /// Triangles of a given size in the unit cube.
        fn soup(count: u32, size: f64) -> Self {
            let point = |i, which| {
                let [x, y, z, _] = philox4x32([i, which, 0, 0], [0, 0]).map(|bits| f64::from(bits) / 2f64.powi(32));
                DVec3::new(x, y, z)
            };
            Self((0..count).map(|i| [1, 2, 3].map(|k| point(i, 0) + size * point(i, k))).collect())
        }

        fn input(&self) -> Input<'_> {
            let region = self.region();
            Input {
                region,
                boxes: self.0.iter().map(|&corners| region.aabb(corners)).collect(),
                primitives: self,
                work: Work::UNWATCHED,
            }
        }
    }

    /// Both kinds of grids over triangles.
    fn built(triangles: &Triangles) -> [(Box<dyn Structure>, Lists); 2] {
        let input = triangles.input();
        [uniform::build(&input, &uniform::Options::DEFAULT), nested::build(&input, &nested::Options::DEFAULT)]
    }

    fn check(triangles: &Triangles, structure: &dyn Structure, lists: &Lists) -> Result<(), String> {
        let leaf = |leaf: u32| {
            let start: u32 = lists.counts[..leaf as usize].iter().sum();
            lists.order[start as usize..][..lists.counts[leaf as usize] as usize].to_vec()
        };
        structure.validate(&triangles.input(), &leaf)
    }

    #[test]
    fn what_walks_rely_on_is_checked() {
        let triangles = Triangles::soup(800, 0.2);
        for (structure, lists) in built(&triangles) {
            check(&triangles, structure.as_ref(), &lists).unwrap();
            assert_eq!(structure.info().leaves, lists.counts.len());
            // Invalid inputs: a primitive in other cells, one missing from a leaf, one outside the grid.
            let mut moved = Triangles(triangles.0.clone());
            moved.0[7] = moved.0[7].map(|c| DVec3::ONE - c);
            check(&moved, structure.as_ref(), &lists).unwrap_err();
            let mut other = lists.clone();
            other.order[100] = if other.order[100] == 5 { 6 } else { 5 };
            check(&triangles, structure.as_ref(), &other).unwrap_err();
            let larger = Triangles(triangles.0.iter().copied().chain([[DVec3::ZERO; 3]]).collect());
            check(&larger, structure.as_ref(), &lists).unwrap_err();
        }
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let triangles = Triangles::soup(20_000, 0.05);
        let on = |threads| {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            pool.install(|| built(&triangles).map(|(structure, lists)| (structure.info(), lists)))
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn no_input_takes_more_references_than_a_dozen_a_primitive() {
        let coincident = Triangles(vec![[DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 0.7)]; 30_000]);
        let huge = Triangles::soup(30_000, 1e3);
        let mut with_tiny = Triangles::soup(30_000, 1e-6);
        with_tiny.0.extend(Triangles::soup(20, 1e4).0);
        let point = Triangles(vec![[DVec3::ONE; 3]; 30_000]);
        for triangles in [coincident, huge, with_tiny, point] {
            for (structure, lists) in built(&triangles) {
                assert!(lists.order.len() < 12 * 30_020 + (1 << 14), "{} references", lists.order.len());
                assert!(structure.info().nodes < 20 * 30_020, "{:?}", structure.info());
            }
        }
    }

    #[test]
    fn rays_that_are_not_far_go_from_cell_to_cell() {
        let region = Region::new(DVec3::splat(-3.9), DVec3::splat(3.9));
        for exponent in 0..40 {
            let distance = 1.2f64.powi(exponent) * 3.9;
            let ray = Ray::new(DVec3::new(0.3, distance, 0.1), -DVec3::Y);
            let (_, slabs) = SlabRay::prepare(None, &ray, &region).expect("it meets the region");
            assert!(can_step(&slabs), "{distance}: {} is more than {MOST_PAD}", slabs.pad);
        }
        let ray = Ray::new(DVec3::new(0.0, 4e11, 0.0), -DVec3::Y);
        assert!(!can_step(&SlabRay::prepare(None, &ray, &region).expect("it meets the region").1));
    }
}
