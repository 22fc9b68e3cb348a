//! Grid traversal for rays with a large pad, whose origin is so distant that f32 hardly separates adjacent cells. The
//! grid is bisected, nearer half first, as long as [`SlabRay::passes`] cannot exclude a part. This relies only on the
//! bound of the box test.
//!
//! Bisection splits slices first, then rows, then cells. So the cells of a part are a contiguous interval, and testing
//! whether it is empty takes constant time.

use super::lattice::{Lattice, Occupied};
use crate::SlabRay;
use std::ops::Range;

/// The stack of parts that a ray may hit.
#[derive(Debug, Default)]
pub struct Halving {
    /// The grid and a range of its cells.
    open: Vec<(u32, Range<usize>)>,
}

impl Halving {
    /// Discard all parts.
    pub fn clear(&mut self) {
        self.open.clear();
    }

    /// Push a whole grid.
    pub fn push(&mut self, grid: u32, lattice: &Lattice) {
        self.open.push((grid, 0..lattice.count()));
    }

    /// The next nonempty cell that the ray may hit, and its grid. `grid` returns a grid's lattice and its first word of
    /// bits. Every box test is counted in `nodes`.
    pub fn next<'a>(
        &mut self,
        ray: &SlabRay,
        limit: f32,
        occupied: &Occupied,
        grid: impl Fn(u32) -> (&'a Lattice, usize),
        nodes: &mut u32,
    ) -> Option<(u32, usize)> {
        while let Some((number, cells)) = self.open.pop() {
            let (lattice, word) = grid(number);
            if !occupied.has_any(word, cells.start, cells.end) {
                continue;
            }
            *nodes += 1;
            let (from, to) = (lattice.cell(cells.start), lattice.cell(cells.end - 1));
            if ray.passes(&lattice.aabb(from, to), limit).is_none() {
                continue;
            }
            let Some(axis) = (0..3).rev().find(|&axis| from[axis] < to[axis]) else {
                return Some((number, cells.start));
            };
            let below = (to[axis] - from[axis]).div_ceil(2) as usize;
            let middle = cells.start + below * lattice.strides()[axis];
            let halves = [(number, cells.start..middle), (number, middle..cells.end)];
            let first = ray.first[axis];
            self.open.extend([halves[1 - first].clone(), halves[first].clone()]);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::{Aabb, Vec3};

    #[test]
    fn a_ray_that_meets_everything_comes_to_all_that_is_not_empty_once() {
        let lattice = Lattice::around(&Aabb { min: Vec3::ZERO, max: Vec3::ONE }, [5, 3, 4]);
        let counts: Vec<u32> = (0..60).map(|i| i % 7).collect();
        let mut occupied = Occupied::default();
        occupied.push(&counts);
        let mut halving = Halving::default();
        halving.push(7, &lattice);
        let (mut seen, mut nodes) = (vec![0; 60], 0);
        let mut next = || halving.next(&SlabRay::EVERYWHERE, f32::INFINITY, &occupied, |_| (&lattice, 0), &mut nodes);
        while let Some((grid, cell)) = next() {
            assert_eq!(grid, 7);
            seen[cell] += 1;
        }
        assert!(seen.iter().zip(counts).all(|(&seen, count)| seen == u32::from(count > 0)));
        assert!(nodes < 2 * 60);
    }
}
