//! Nested grids: dense cells contain grids of their own resolution (Jevans and Wyvill, "Adaptive Voxel Subdivision for
//! Ray Tracing", 1989). They suit scenes with small detailed parts, for which a single grid is either too coarse or too
//! large.
//!
//! An inner grid surrounds the part of its cell's primitives inside the cell widened by PAD, and is traversed while the
//! ray is in the cell. While traversal assumes that the ray is in the cell, the ray is at most PAD outside. A hit at
//! that time is therefore within the content of the inner grid, whose border is beyond that by a margin. So the
//! argument of the module for one grid holds for nested ones.

use super::dda::Walk;
use super::fill::{Budget, Filled, expected};
use super::halving::Halving;
use super::lattice::{Lattice, Occupied};
use super::uniform::{around, check_border, present};
use super::{Resolution, can_step};
use crate::walk::{Input, Lists, Structure, Walker};
use crate::{Info, SlabRay};
use raywright_base::math::Aabb;
use raywright_base::parallel;

/// Build options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The resolution of the outermost grid.
    pub resolution: Resolution,
    /// Cells per primitive of inner grids.
    pub density: f32,
    /// Maximum number of primitives in a cell without an inner grid.
    pub leaf: u32,
    /// Maximum nesting depth; 1 for a single grid.
    pub depth: u32,
}

impl Options {
    /// One cell per primitive in every grid; cells with more than eight primitives are subdivided, up to depth five.
    pub const DEFAULT: Self = Self { resolution: Resolution::Density(1.0), density: 1.0, leaf: 8, depth: 5 };
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A grid and its first word of bits.
struct SubGrid {
    lattice: Lattice,
    word: usize,
}

/// Marks an entry of a nonempty cell as a grid rather than a leaf.
const INNER: u32 = 1 << 31;

/// All grids, outermost first; none without primitives.
struct Nested {
    parts: Vec<SubGrid>,
    occupied: Occupied,
    /// The entries of nonempty cells, in order.
    entries: Vec<u32>,
    depth: usize,
    cost: f64,
}

/// A grid during the build.
struct BuiltGrid {
    filled: Filled,
    /// Cells with inner grids and the indices of these, in order.
    inner: Vec<(usize, u32)>,
    /// The average probability that a ray through the outermost grid's box enters a cell.
    share: f64,
}

/// The cost of entering a grid, in steps or tests: ten times the instructions of a step, plus memory latency.
const ENTRY: f64 = 12.0;

/// Build the grids. Leaves are numbered grid by grid, those inside a cell before those of the next one.
///
/// Grids are added level by level until one of three limits: `depth`, a dozen references per primitive, or no grid that
/// lowers the cost.
pub fn build(input: &Input, options: &Options) -> (Box<dyn Structure>, Lists) {
    let primitives = present(input);
    if primitives.is_empty() {
        let nothing =
            Nested { parts: Vec::new(), occupied: Occupied::default(), entries: Vec::new(), depth: 0, cost: 0.0 };
        return (Box::new(nothing), Lists::default());
    }
    let (made, depth) = levels(input, &primitives, options);
    let mut cost = 0.0;
    let (mut parts, mut occupied) = (Vec::with_capacity(made.len()), Occupied::default());
    for BuiltGrid { filled: Filled { lattice, counts, .. }, inner, share } in &made {
        parts.push(SubGrid { lattice: *lattice, word: occupied.words() });
        occupied.push(counts);
        let outside: u64 = counts.iter().map(|&n| u64::from(n)).sum();
        let inside: u64 = inner.iter().map(|&(cell, _)| u64::from(counts[cell])).sum();
        cost += share * ((outside - inside) as f64 + lattice.count() as f64);
    }
    let mut nested = Nested { entries: vec![0; occupied.count() as usize], parts, occupied, depth, cost };
    let mut lists = Lists::default();
    nested.number(&made, 0, &mut lists);
    (Box::new(nested), lists)
}

/// All grids, each after its parent, and the depth.
fn levels(input: &Input, primitives: &[u32], options: &Options) -> (Vec<BuiltGrid>, usize) {
    let n = primitives.len() as u64;
    let bounds = around(input, primitives);
    let budget = Budget { looked_at: 64 * n + (1 << 16), references: 4 * n + (1 << 12) };
    let cells = options.resolution.cells(&bounds, primitives.len());
    let filled = Filled::new(input, primitives, &bounds, cells, budget);
    let mut left = (12 * n + (1 << 14)).saturating_sub(filled.order.len() as u64);
    let share = filled.lattice.cell_area() / filled.lattice.area();
    let mut made = vec![BuiltGrid { filled, inner: Vec::new(), share }];
    let (mut depth, mut from) = (1, 0);
    let steps = input.work.steps(options.depth as usize);
    while depth < options.depth as usize && steps.did(1).is_ok() {
        let dense = (from..made.len()).flat_map(|outer| {
            let lists = made[outer].filled.lists().filter(|(_, own)| own.len() > options.leaf as usize);
            lists.map(move |(cell, own)| (outer, cell, own))
        });
        let dense: Vec<_> = dense.collect();
        let inner = parallel::map_parts(dense, |(outer, cell, own)| {
            let filled = inside(input, &made[outer].filled.lattice, cell, own, options)?;
            Some((outer, cell, own.len() as u64, filled))
        });
        from = made.len();
        for (outer, cell, before, filled) in inner.into_iter().flatten() {
            let more = (filled.order.len() as u64).saturating_sub(before);
            if more > left {
                continue;
            }
            left -= more;
            let share = made[outer].share * filled.lattice.cell_area() / made[outer].filled.lattice.cell_area();
            let number = made.len() as u32;
            made[outer].inner.push((cell, number));
            made.push(BuiltGrid { filled, inner: Vec::new(), share });
        }
        if made.len() == from {
            break;
        }
        depth += 1;
    }
    (made, depth)
}

/// A grid inside a cell, if it is cheaper than testing the cell's primitives.
fn inside(input: &Input, outer: &Lattice, cell: usize, own: &[u32], options: &Options) -> Option<Filled> {
    let bounds = content(input, outer, cell, own);
    if bounds.is_empty() {
        return None;
    }
    let n = own.len() as u64;
    let cells = Resolution::Density(options.density).cells(&bounds, own.len());
    let filled = Filled::new(input, own, &bounds, cells, Budget { looked_at: 64 * n + 4096, references: 4 * n });
    let lattice = &filled.lattice;
    let walked = lattice.cell_area() * (lattice.count() + filled.order.len()) as f64;
    let cost = (ENTRY * lattice.area() + walked) / outer.cell_area();
    (lattice.count() > 1 && cost < n as f64).then_some(filled)
}

/// The bounding box of the primitives' parts inside a cell.
fn content(input: &Input, lattice: &Lattice, cell: usize, own: &[u32]) -> Aabb {
    let place = lattice.cell(cell);
    let cell = lattice.aabb(place, place);
    own.iter().fold(Aabb::EMPTY, |all, &p| {
        let Aabb { min, max } = input.boxes[p as usize];
        let part = Aabb { min: min.max(cell.min), max: max.min(cell.max) };
        if part.is_empty() { all } else { all.union(part) }
    })
}

impl Nested {
    /// Number the leaves below a grid.
    fn number(&mut self, made: &[BuiltGrid], part: u32, lists: &mut Lists) {
        let BuiltGrid { filled, inner, .. } = &made[part as usize];
        let mut inner = inner.iter().peekable();
        let first = self.occupied.rank(self.parts[part as usize].word, 0);
        for (place, (cell, own)) in filled.lists().enumerate() {
            let entry = match inner.next_if(|&&(at, _)| at == cell) {
                Some(&(_, grid)) => {
                    self.number(made, grid, lists);
                    INNER | grid
                }
                None => {
                    lists.order.extend_from_slice(own);
                    lists.counts.push(own.len() as u32);
                    lists.counts.len() as u32 - 1
                }
            };
            self.entries[first as usize + place] = entry;
        }
    }

    /// The entry of a cell, if nonempty.
    #[inline(always)]
    fn entry(&self, part: u32, cell: usize) -> Option<u32> {
        let word = self.parts[part as usize].word;
        self.occupied.has(word, cell).then(|| self.entries[self.occupied.rank(word, cell) as usize])
    }

    /// Check a grid and its inner grids, given its primitives; return the depth.
    fn check(
        &self,
        part: u32,
        input: &Input,
        primitives: &[u32],
        leaf: &mut dyn FnMut(u32) -> Vec<u32>,
    ) -> Result<usize, String> {
        let lattice = &self.parts[part as usize].lattice;
        let mut depth = 1;
        for (cell, wanted) in expected(input, lattice, primitives).into_iter().enumerate() {
            match self.entry(part, cell) {
                None if wanted.is_empty() => {}
                None => return Err(format!("cell {cell} of grid {part} is empty, expected {wanted:?}")),
                Some(entry) if entry & INNER != 0 => {
                    let grid = entry & !INNER;
                    if grid <= part {
                        return Err(format!("grid {grid} is inside grid {part}"));
                    }
                    check_border(&self.parts[grid as usize].lattice, &content(input, lattice, cell, &wanted))?;
                    depth = depth.max(1 + self.check(grid, input, &wanted, leaf)?);
                }
                Some(entry) => {
                    let mut own = leaf(entry);
                    own.sort_unstable();
                    if own != wanted {
                        return Err(format!("cell {cell} of grid {part} has {own:?}, expected {wanted:?}"));
                    }
                }
            }
        }
        Ok(depth)
    }
}

impl Structure for Nested {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        if counted { Box::new(NestedWalk::<true>::new(self)) } else { Box::new(NestedWalk::<false>::new(self)) }
    }

    /// The cost is that of a uniform grid, summed over all grids. Each cell costs a step and, without an inner grid, a
    /// test of each primitive, times the probability that a line through the outermost box enters it.
    fn info(&self) -> Info {
        let cells = self.parts.iter().map(|part| part.lattice.count()).sum();
        Info {
            kind: format!("nested grid, {} in all", self.parts.len()),
            nodes: cells,
            leaves: self.entries.len() - self.parts.len().saturating_sub(1),
            depth: self.depth,
            bytes: self.occupied.bytes()
                + size_of_val(self.entries.as_slice())
                + size_of_val(self.parts.as_slice())
                + size_of::<Self>(),
            sah_cost: self.cost,
            ..Info::default()
        }
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let all = present(input);
        let Some(outermost) = self.parts.first() else {
            return if all.is_empty() { Ok(()) } else { Err(format!("no grid over {} primitives", all.len())) };
        };
        check_border(&outermost.lattice, &around(input, &all))?;
        let mut next = 0;
        let depth = self.check(0, input, &all, &mut |leaf| {
            // Leaves occur once each, in this order.
            next += u32::from(leaf == next);
            primitives(leaf)
        })?;
        let leaves = (self.entries.len() + 1 - self.parts.len()) as u32;
        if next != leaves {
            return Err(format!("cells refer to {next} leaves, expected {leaves}"));
        }
        if depth == self.depth { Ok(()) } else { Err(format!("depth is {depth}, not {}", self.depth)) }
    }
}

/// The traversal of one grid.
struct GridLevel {
    part: u32,
    walk: Walk,
    /// True if it is still in its first cell.
    is_new: bool,
}

struct NestedWalk<'a, const COUNTED: bool> {
    nested: &'a Nested,
    ray: SlabRay,
    /// The stack of traversals, each inside the current cell of the one before.
    levels: Vec<GridLevel>,
    halving: Halving,
    nodes: u32,
}

impl<'a, const COUNTED: bool> NestedWalk<'a, COUNTED> {
    fn new(nested: &'a Nested) -> Self {
        let levels = Vec::with_capacity(nested.depth);
        Self { nested, ray: SlabRay::EVERYWHERE, levels, halving: Halving::default(), nodes: 0 }
    }

    /// Enter a grid for an interval of t.
    #[inline(always)]
    fn enter(&mut self, part: u32, from: f32, until: f32) {
        let walk = Walk::new(&self.nested.parts[part as usize].lattice, &self.ray, from, until);
        self.levels.extend(walk.map(|walk| GridLevel { part, walk, is_new: true }));
    }

    #[cold]
    #[inline(never)]
    fn next_by_halving(&mut self, limit: f32) -> Option<u32> {
        let Nested { parts, occupied, entries, .. } = self.nested;
        let grid = |number: u32| {
            let SubGrid { lattice, word } = &parts[number as usize];
            (lattice, *word)
        };
        loop {
            let (number, cell) = self.halving.next(&self.ray, limit, occupied, grid, &mut self.nodes)?;
            match entries[occupied.rank(grid(number).1, cell) as usize] {
                entry if entry & INNER != 0 => self.halving.push(entry & !INNER, grid(entry & !INNER).0),
                leaf => return Some(leaf),
            }
        }
    }
}

impl<const COUNTED: bool> Walker for NestedWalk<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.levels.clear();
        self.halving.clear();
        (self.ray, self.nodes) = (*ray, 0);
        let Some(outermost) = self.nested.parts.first() else { return };
        if can_step(ray) {
            self.enter(0, ray.t_min, f32::INFINITY);
        } else {
            self.halving.push(0, &outermost.lattice);
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let Nested { parts, occupied, entries, .. } = self.nested;
        while let Some(level) = self.levels.last_mut() {
            let word = parts[level.part as usize].word;
            let GridLevel { walk, is_new, .. } = level;
            let mut is_there = std::mem::replace(is_new, false) || walk.step(limit);
            while is_there {
                self.nodes += u32::from(COUNTED);
                if occupied.has(word, walk.cell) {
                    break;
                }
                is_there = walk.step(limit);
            }
            if !is_there {
                self.levels.pop();
                continue;
            }
            let entry = entries[occupied.rank(word, walk.cell) as usize];
            if entry & INNER == 0 {
                return Some(entry);
            }
            let (from, until) = (walk.enter, walk.leave());
            self.enter(entry & !INNER, from, until);
        }
        self.next_by_halving(limit)
    }

    fn nodes(&self) -> u32 {
        if COUNTED { self.nodes } else { 0 }
    }
}
