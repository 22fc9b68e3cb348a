//! Fills grid cells with the primitives they overlap by a counting sort: count per cell, prefix sums, then placement
//! (Lagae and Dutré, "Compact, Fast and Robust Grids for Ray Tracing", 2008).
//!
//! Large primitives overlap many cells. To bound memory, a grid over budget is made coarser until it fits. Each step
//! leaves a third of the cells, so all attempts together take little more than the first.

use super::lattice::Lattice;
use super::overlap::Overlap;
use super::resolution::coarser;
use crate::walk::Input;
use raywright_base::math::Aabb;
use raywright_base::parallel;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Limits on the cost of a grid.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// The total number of cells that primitives' boxes overlap: a bound on the time.
    pub looked_at: u64,
    /// The total number of references in cells: a bound on the memory.
    pub references: u64,
}

/// A filled grid.
#[derive(Debug)]
pub struct Filled {
    pub lattice: Lattice,
    /// The number of references in each cell.
    pub counts: Vec<u32>,
    /// The primitives' numbers, cell by cell, sorted within each.
    pub order: Vec<u32>,
}

impl Filled {
    /// Fill a grid around `bounds` with the given number of cells, or fewer if it exceeds the budget.
    pub fn new(input: &Input, primitives: &[u32], bounds: &Aabb, mut cells: [u32; 3], budget: Budget) -> Self {
        loop {
            // A canceled build may return any grid.
            cells = if input.work.is_stopped() { [1; 3] } else { cells };
            let touching = Touching { input, lattice: Lattice::around(bounds, cells) };
            let is_last = cells == [1; 3];
            let in_box = |some: Range<usize>| primitives[some].iter().map(|&p| touching.in_box(p)).sum::<u64>();
            let looked_at: u64 = parallel::map_chunks(primitives.len(), TOGETHER, in_box).iter().sum();
            if !is_last && looked_at > budget.looked_at {
                cells = coarser(cells);
                continue;
            }
            let counts: Vec<AtomicU32> = (0..touching.lattice.count()).map(|_| AtomicU32::new(0)).collect();
            each(primitives, |p| {
                touching.each(p, |cell| {
                    counts[cell].fetch_add(1, Relaxed);
                });
            });
            let counts: Vec<u32> = counts.into_iter().map(AtomicU32::into_inner).collect();
            let references: u64 = counts.iter().map(|&n| u64::from(n)).sum();
            if !is_last && references > budget.references {
                cells = coarser(cells);
                continue;
            }
            return touching.sorted(primitives, counts, references as usize);
        }
    }

    /// The nonempty cells with their indices and primitives.
    pub fn lists(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut rest = self.order.as_slice();
        self.counts.iter().enumerate().filter(|&(_, &count)| count > 0).map(move |(cell, &count)| {
            let (own, others) = rest.split_at(count as usize);
            rest = others;
            (cell, own)
        })
    }
}

/// Primitives, or lists of them, per parallel task.
const TOGETHER: usize = 512;

/// Call `work` with each primitive, in any order.
fn each(primitives: &[u32], work: impl Fn(u32) + Sync) {
    parallel::map_chunks(primitives.len(), TOGETHER, |some| primitives[some].iter().for_each(|&p| work(p)));
}

/// Tests which cells of a lattice primitives overlap.
struct Touching<'a> {
    input: &'a Input<'a>,
    lattice: Lattice,
}

impl Touching<'_> {
    /// The number of cells that a primitive's box overlaps.
    fn in_box(&self, primitive: u32) -> u64 {
        let range = self.lattice.range(&self.input.boxes[primitive as usize]);
        range.map_or(0, |(from, to)| (0..3).map(|a| u64::from(to[a] - from[a]) + 1).product())
    }

    /// Call `touched` with every cell that a primitive overlaps.
    fn each(&self, primitive: u32, mut touched: impl FnMut(usize)) {
        let Some((from, to)) = self.lattice.range(&self.input.boxes[primitive as usize]) else { return };
        let axes = (0..3).filter(|&axis| from[axis] < to[axis]).count();
        // A triangle that spans a single row of cells overlaps all of them.
        let overlap = (axes > 1).then(|| self.overlap(primitive)).flatten();
        for z in from[2]..=to[2] {
            for y in from[1]..=to[1] {
                for x in from[0]..=to[0] {
                    let cell = [x, y, z];
                    if overlap.as_ref().is_none_or(|o| o.touches(self.lattice.middle(cell))) {
                        touched(self.lattice.number(cell));
                    }
                }
            }
        }
    }

    /// The separating axis test of a triangle; None for other primitives.
    fn overlap(&self, primitive: u32) -> Option<Overlap> {
        let Input { region, primitives, .. } = self.input;
        let corners = primitives.corners(primitive);
        corners.iter().all(|c| c.is_finite()).then(|| Overlap::new(corners.map(|c| region.to_box(c)), &self.lattice))
    }

    /// Place all references, given `counts`.
    fn sorted(self, primitives: &[u32], counts: Vec<u32>, references: usize) -> Filled {
        let mut end = 0;
        let places: Vec<AtomicU32> = counts
            .iter()
            .map(|&count| {
                end += count;
                AtomicU32::new(end - count)
            })
            .collect();
        let order: Vec<AtomicU32> = (0..references).map(|_| AtomicU32::new(0)).collect();
        each(primitives, |p| {
            self.each(p, |cell| order[places[cell].fetch_add(1, Relaxed) as usize].store(p, Relaxed));
        });
        let mut order: Vec<u32> = order.into_iter().map(AtomicU32::into_inner).collect();
        // Threads place references in any order; sorting makes the grid deterministic.
        let (mut rest, mut lists) = (order.as_mut_slice(), Vec::new());
        for &count in counts.iter().filter(|&&count| count > 0) {
            let (own, others) = rest.split_at_mut(count as usize);
            rest = others;
            if count > 1 {
                lists.push(own);
            }
        }
        parallel::each_chunk_mut(&mut lists, TOGETHER, &|_, lists| {
            lists.iter_mut().for_each(|own| own.sort_unstable())
        });
        Filled { lattice: self.lattice, counts, order }
    }
}

/// The primitives that overlap each cell, in order: the reference for checks.
pub fn expected(input: &Input, lattice: &Lattice, primitives: &[u32]) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); lattice.count()];
    let touching = Touching { input, lattice: *lattice };
    for &p in primitives {
        touching.each(p, |cell| lists[cell].push(p));
    }
    lists
}
