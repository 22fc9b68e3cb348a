//! Puts primitives into the cells that they touch: each cell's number is counted, the counts are added up, and
//! everything goes to its place, a counting sort (Lagae and Dutré, "Compact, Fast and Robust Grids for Ray Tracing",
//! 2008).
//!
//! What is large stands in many cells. Lest a few large things in fine cells take all memory, a grid that would need
//! more than it may is made coarser until it does not; each time a third of the cells is left, so all tries together
//! take little more than the first.

use super::lattice::Lattice;
use super::overlap::Overlap;
use super::resolution::coarser;
use crate::walk::Input;
use raywright_base::math::Aabb;
use raywright_base::parallel;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// How much a grid may take.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Cells that primitives' boxes touch, in all: the time that it takes to look at them.
    pub looked_at: u64,
    /// Cells that primitives stand in, in all: the memory.
    pub references: u64,
}

/// Cells with what stands in them.
#[derive(Debug)]
pub struct Filled {
    pub lattice: Lattice,
    /// By cell, how many stand in it.
    pub counts: Vec<u32>,
    /// The numbers of primitives, cell by cell, each cell's in order.
    pub order: Vec<u32>,
}

impl Filled {
    /// Puts primitives into a grid around `bounds` of so many cells, or of fewer if that takes more than it may.
    pub fn new(input: &Input, primitives: &[u32], bounds: &Aabb, mut cells: [u32; 3], budget: Budget) -> Self {
        loop {
            // Whoever has stopped it takes anything.
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

    /// What stands in the cells that are not empty, cell by cell, with their numbers.
    pub fn lists(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut rest = self.order.as_slice();
        self.counts.iter().enumerate().filter(|&(_, &count)| count > 0).map(move |(cell, &count)| {
            let (own, others) = rest.split_at(count as usize);
            rest = others;
            (cell, own)
        })
    }
}

/// Primitives that a thread takes at a time, and lists of them.
const TOGETHER: usize = 512;

/// Calls `work` with each primitive, in any order.
fn each(primitives: &[u32], work: impl Fn(u32) + Sync) {
    parallel::map_chunks(primitives.len(), TOGETHER, |some| primitives[some].iter().for_each(|&p| work(p)));
}

/// Which cells of a lattice primitives touch.
struct Touching<'a> {
    input: &'a Input<'a>,
    lattice: Lattice,
}

impl Touching<'_> {
    /// How many cells touch a primitive's box.
    fn in_box(&self, primitive: u32) -> u64 {
        let range = self.lattice.range(&self.input.boxes[primitive as usize]);
        range.map_or(0, |(from, to)| (0..3).map(|a| u64::from(to[a] - from[a]) + 1).product())
    }

    /// Calls `touched` with every cell that touches a primitive.
    fn each(&self, primitive: u32, mut touched: impl FnMut(usize)) {
        let Some((from, to)) = self.lattice.range(&self.input.boxes[primitive as usize]) else { return };
        let axes = (0..3).filter(|&axis| from[axis] < to[axis]).count();
        // Along one axis alone, a triangle that reaches from end to end touches all there are between.
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

    /// What parts a triangle from cells; none of what is no triangle.
    fn overlap(&self, primitive: u32) -> Option<Overlap> {
        let Input { region, primitives, .. } = self.input;
        let corners = primitives.corners(primitive);
        corners.iter().all(|c| c.is_finite()).then(|| Overlap::new(corners.map(|c| region.to_box(c)), &self.lattice))
    }

    /// Everything in its place, `counts` being known.
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
        // Threads come in any order; the grid is the same.
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

/// By cell, the primitives that touch it, as they come: what grids are checked against.
pub fn expected(input: &Input, lattice: &Lattice, primitives: &[u32]) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); lattice.count()];
    let touching = Touching { input, lattice: *lattice };
    for &p in primitives {
        touching.each(p, |cell| lists[cell].push(p));
    }
    lists
}
