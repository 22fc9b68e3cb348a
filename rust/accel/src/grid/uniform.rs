//! Uniform grids.

use super::dda::Walk;
use super::fill::{Budget, Filled, expected};
use super::halving::Halving;
use super::lattice::{Lattice, Occupied};
use super::{PAD, Resolution, can_step};
use crate::walk::{Input, Lists, Structure, Walker};
use crate::{Info, SlabRay};
use raywright_base::math::{Aabb, Vec3};

/// Build options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The resolution. It is reduced to limit references to a dozen per primitive, or two million.
    pub resolution: Resolution,
}

impl Options {
    /// Two primitives per cell. More cells mean fewer primitive tests each. But up to eight are tested at once, and
    /// every cell keeps its own copies of primitives, which have to be loaded from memory.
    pub const DEFAULT: Self = Self { resolution: Resolution::Density(0.5) };
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A uniform grid.
struct Grid {
    /// None without primitives.
    lattice: Option<Lattice>,
    occupied: Occupied,
    references: usize,
}

/// Build a grid; its leaves are the nonempty cells, in order.
pub fn build(input: &Input, options: &Options) -> (Box<dyn Structure>, Lists) {
    let primitives: Vec<u32> = present(input);
    if primitives.is_empty() {
        return (Box::new(Grid { lattice: None, occupied: Occupied::default(), references: 0 }), Lists::default());
    }
    let bounds = around(input, &primitives);
    let n = primitives.len() as u64;
    let budget = match options.resolution {
        Resolution::Density(_) => Budget { looked_at: 64 * n + (1 << 16), references: 12 * n + (1 << 14) },
        _ => Budget { looked_at: 64 * n + (1 << 24), references: 12 * n + (1 << 21) },
    };
    let cells = options.resolution.cells(&bounds, primitives.len());
    let Filled { lattice, counts, order } = Filled::new(input, &primitives, &bounds, cells, budget);
    let mut occupied = Occupied::default();
    occupied.push(&counts);
    let grid = Grid { lattice: Some(lattice), occupied, references: order.len() };
    (Box::new(grid), Lists { counts: counts.into_iter().filter(|&n| n > 0).collect(), order })
}

/// The primitives that can be hit.
pub(super) fn present(input: &Input) -> Vec<u32> {
    (0..input.boxes.len() as u32).filter(|&p| !input.boxes[p as usize].is_empty()).collect()
}

/// The bounding box of primitives.
pub(super) fn around(input: &Input, primitives: &[u32]) -> Aabb {
    primitives.iter().fold(Aabb::EMPTY, |all, &p| all.union(input.boxes[p as usize]))
}

/// Check that a lattice extends far enough beyond its content.
pub(super) fn check_border(lattice: &Lattice, bounds: &Aabb) -> Result<(), String> {
    let room = Vec3::splat(2.0 * PAD);
    let needed = Aabb { min: bounds.min - room, max: bounds.max + room };
    match lattice.aabb([0; 3], lattice.cells.map(|n| n - 1)) {
        all if all.contains(&needed) => Ok(()),
        all => Err(format!("the grid {all:?} has no margin around its content {bounds:?}")),
    }
}

impl Structure for Grid {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        if counted { Box::new(GridWalk::<true>::new(self)) } else { Box::new(GridWalk::<false>::new(self)) }
    }

    /// The cost is that of a random line through the grid's box without a hit. By the surface area heuristic, this is
    /// the probability of entering each cell, times one step and a test of each primitive in it (as in Cleary and
    /// Wyvill 1988).
    fn info(&self) -> Info {
        let cells = self.lattice.map_or(0, |l| l.count());
        let share = self.lattice.map_or(0.0, |l| l.cell_area() / l.area());
        let [x, y, z] = self.lattice.map_or([0; 3], |l| l.cells);
        Info {
            kind: format!("grid of {x} x {y} x {z}"),
            nodes: cells,
            leaves: self.occupied.count() as usize,
            depth: usize::from(cells > 0),
            bytes: self.occupied.bytes() + size_of::<Self>(),
            sah_cost: share * (cells + self.references) as f64,
            ..Info::default()
        }
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let all = present(input);
        let Some(lattice) = &self.lattice else {
            return if all.is_empty() { Ok(()) } else { Err(format!("no grid over {} primitives", all.len())) };
        };
        check_border(lattice, &around(input, &all))?;
        let mut leaves = 0;
        for (cell, wanted) in expected(input, lattice, &all).into_iter().enumerate() {
            let leaf = self.leaf(cell);
            let mut own = leaf.map_or(Vec::new(), primitives);
            own.sort_unstable();
            if own != wanted || leaf.is_some_and(|leaf| leaf != leaves) {
                return Err(format!("cell {cell} is leaf {leaf:?} with {own:?}, expected {wanted:?}"));
            }
            leaves += u32::from(leaf.is_some());
        }
        Ok(())
    }
}

impl Grid {
    /// The leaf of a cell, if nonempty.
    #[inline(always)]
    fn leaf(&self, cell: usize) -> Option<u32> {
        self.occupied.has(0, cell).then(|| self.occupied.rank(0, cell))
    }
}

struct GridWalk<'a, const COUNTED: bool> {
    grid: &'a Grid,
    /// The traversal, at the next cell; None if the ray misses the grid, or is too distant to step from cell to cell.
    walk: Option<Walk>,
    /// True if it is still in the first cell.
    is_new: bool,
    ray: SlabRay,
    halving: Halving,
    nodes: u32,
}

impl<'a, const COUNTED: bool> GridWalk<'a, COUNTED> {
    fn new(grid: &'a Grid) -> Self {
        let halving = Halving::default();
        Self { grid, walk: None, is_new: false, ray: SlabRay::EVERYWHERE, halving, nodes: 0 }
    }

    #[cold]
    #[inline(never)]
    fn next_by_halving(&mut self, limit: f32) -> Option<u32> {
        let Grid { lattice, occupied, .. } = self.grid;
        let lattice = lattice.as_ref()?;
        let (_, cell) = self.halving.next(&self.ray, limit, occupied, |_| (lattice, 0), &mut self.nodes)?;
        Some(occupied.rank(0, cell))
    }
}

impl<const COUNTED: bool> Walker for GridWalk<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        (self.walk, self.nodes) = (None, 0);
        self.halving.clear();
        let Some(lattice) = &self.grid.lattice else { return };
        if can_step(ray) {
            self.walk = Walk::new(lattice, ray, ray.t_min, f32::INFINITY);
            self.is_new = true;
        } else {
            self.ray = *ray;
            self.halving.push(0, lattice);
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let Some(walk) = &mut self.walk else { return self.next_by_halving(limit) };
        let mut is_there = std::mem::replace(&mut self.is_new, false) || walk.step(limit);
        while is_there {
            self.nodes += u32::from(COUNTED);
            if self.grid.occupied.has(0, walk.cell) {
                return Some(self.grid.occupied.rank(0, walk.cell));
            }
            is_there = walk.step(limit);
        }
        None
    }

    fn nodes(&self) -> u32 {
        if COUNTED { self.nodes } else { 0 }
    }
}
