//! Planes that part what they cut: bins of equal width that hold the parts of each reference (Stich, Friedrich and Dietrich,
//! "Spatial Splits in Bounding Volume Hierarchies", 2009; "chopped binning" after Popov, Günther, Seidel and Slusallek 2006).

use super::binned::MAX_BINS;
use super::reference::{Bounds, MANY, Reference, SHARE};
use crate::math::Aabb;
use rayon::prelude::*;

/// Bins of equal width along an axis.
#[derive(Clone, Copy)]
struct Grid {
    axis: usize,
    origin: f32,
    width: f32,
    bins: usize,
}

impl Grid {
    /// None where there is nothing to cut, or too little.
    fn new(axis: usize, around: &Aabb, bins: usize) -> Option<Self> {
        let (origin, width) = (around.min[axis], (around.max[axis] - around.min[axis]) / bins as f32);
        (width.is_normal() && width > 0.0).then_some(Self { axis, origin, width, bins })
    }

    /// The lower border of a bin.
    #[inline(always)]
    fn border(&self, bin: usize) -> f32 {
        self.origin + self.width * bin as f32
    }

    /// The first and the last bin that an interval reaches into, which is that of its lower end if it only touches the next.
    #[inline(always)]
    fn place(&self, min: f32, max: f32) -> [usize; 2] {
        let guess = |x: f32| (((x - self.origin) / self.width) as usize).min(self.bins - 1);
        let (mut first, mut last) = (guess(min), guess(max));
        // The borders as they are computed decide.
        while first > 0 && self.border(first) > min {
            first -= 1;
        }
        while first + 1 < self.bins && self.border(first + 1) <= min {
            first += 1;
        }
        while last > 0 && self.border(last) >= max {
            last -= 1;
        }
        while last + 1 < self.bins && self.border(last + 1) < max {
            last += 1;
        }
        [first, last.max(first)]
    }

    #[inline(always)]
    fn place_of(&self, r: &Reference) -> [usize; 2] {
        let Aabb { min, max } = r.bounds.aabb();
        self.place(min[self.axis], max[self.axis])
    }
}

/// The bins of the three axes: around the parts in each, and how many references begin and end there.
#[derive(Clone)]
pub struct Chopped {
    bounds: Box<[[Bounds; MAX_BINS]; 3]>,
    begin: [[u32; MAX_BINS]; 3],
    end: [[u32; MAX_BINS]; 3],
}

impl Chopped {
    /// All of them, empty.
    pub fn new() -> Self {
        let none = [[0; MAX_BINS]; 3];
        Self { bounds: Box::new([[Bounds::EMPTY; MAX_BINS]; 3]), begin: none, end: none }
    }

    fn clear(&mut self, bins: usize) {
        for axis in 0..3 {
            self.bounds[axis][..bins].fill(Bounds::EMPTY);
            self.begin[axis][..bins].fill(0);
            self.end[axis][..bins].fill(0);
        }
    }

    fn add(&mut self, references: &[Reference], grids: &[Option<Grid>; 3], clip: &impl Fn(u32, &Aabb) -> Aabb) {
        for r in references {
            let whole = r.bounds.aabb();
            for grid in grids.iter().flatten() {
                let (axis, [first, last]) = (grid.axis, grid.place_of(r));
                self.begin[axis][first] += 1;
                self.end[axis][last] += 1;
                if first == last {
                    self.bounds[axis][first].grow(&r.bounds);
                    continue;
                }
                for bin in first..=last {
                    let mut slab = whole;
                    slab.min[axis] = if bin > first { grid.border(bin) } else { whole.min[axis] };
                    slab.max[axis] = if bin < last { grid.border(bin + 1) } else { whole.max[axis] };
                    let part = clip(r.primitive(), &slab);
                    if !part.is_empty() {
                        self.bounds[axis][bin].grow(&Bounds::from(&part));
                    }
                }
            }
        }
    }

    fn join(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..MAX_BINS {
                self.bounds[axis][bin].grow(&other.bounds[axis][bin]);
                self.begin[axis][bin] += other.begin[axis][bin];
                self.end[axis][bin] += other.end[axis][bin];
            }
        }
        self
    }
}

/// A plane between two bins.
#[derive(Clone, Copy)]
pub struct Plane {
    grid: Grid,
    /// The last bin on the left.
    last: usize,
    /// What is there if all that straddle are parted, and how many.
    left: (Bounds, usize),
    right: (Bounds, usize),
}

impl Plane {
    /// The cheapest plane that adds no more references than the budget.
    pub fn best(
        references: &[Reference],
        around: &Bounds,
        bins: usize,
        clip: &(impl Fn(u32, &Aabb) -> Aabb + Sync),
        budget: usize,
        workspace: &mut Chopped,
    ) -> Option<Self> {
        let around = around.aabb();
        // Few are parted as well with fewer, and each would be cut many times.
        let bins = bins.min((references.len() / 2).max(4));
        let grids = [0, 1, 2].map(|axis| Grid::new(axis, &around, bins));
        workspace.clear(bins);
        if references.len() < MANY {
            workspace.add(references, &grids, clip);
        } else {
            let add = |mut filled: Chopped, share: &[Reference]| {
                filled.add(share, &grids, clip);
                filled
            };
            let shares = references.par_chunks(SHARE).fold(Chopped::new, add);
            *workspace = shares.reduce(Chopped::new, |a, b| a.join(&b));
        }
        let planes = grids.iter().flatten().filter_map(|grid| workspace.best(*grid, references.len(), budget));
        // Of equals the first.
        planes.reduce(|best, plane| if plane.cost() < best.cost() { plane } else { best })
    }

    /// Its cost, by area and number.
    pub fn cost(&self) -> f32 {
        self.left.0.half_area() * self.left.1 as f32 + self.right.0.half_area() * self.right.1 as f32
    }

    /// Both sides: what straddles is parted, or goes to one side as a whole where that costs less.
    pub fn part(
        &self,
        references: &[Reference],
        clip: &impl Fn(u32, &Aabb) -> Aabb,
    ) -> (Vec<Reference>, Vec<Reference>) {
        let Self { grid, last, left: (mut left_bounds, mut left_count), right: (mut right_bounds, mut right_count) } =
            *self;
        let at = grid.border(last + 1);
        let (mut left, mut right) = (Vec::with_capacity(left_count), Vec::with_capacity(right_count));
        for reference in references {
            let [begin, end] = grid.place_of(reference);
            if end <= last {
                left.push(*reference);
                continue;
            }
            if begin > last {
                right.push(*reference);
                continue;
            }
            let (primitive, whole) = (reference.primitive(), reference.bounds.aabb());
            let (mut below, mut above) = (whole, whole);
            (below.max[grid.axis], above.min[grid.axis]) = (at, at);
            let [below, above] = [below, above].map(|half| clip(primitive, &half));
            let in_left = left_bounds.union(&reference.bounds);
            let in_right = right_bounds.union(&reference.bounds);
            let (l, r) = (left_bounds.half_area(), right_bounds.half_area());
            let (n, m) = (left_count as f32, right_count as f32);
            let parted = l * n + r * m;
            let all_left = in_left.half_area() * n + r * (m - 1.0);
            let all_right = l * (n - 1.0) + in_right.half_area() * m;
            if above.is_empty() || (all_left <= parted && all_left <= all_right && !below.is_empty()) {
                left_bounds = in_left;
                right_count -= 1;
                left.push(*reference);
            } else if below.is_empty() || all_right <= parted {
                right_bounds = in_right;
                left_count -= 1;
                right.push(*reference);
            } else {
                left.push(Reference::new(&below, primitive));
                right.push(Reference::new(&above, primitive));
            }
        }
        (left, right)
    }
}

impl Chopped {
    /// The cheapest plane along an axis.
    fn best(&self, grid: Grid, count: usize, budget: usize) -> Option<Plane> {
        let Grid { axis, bins, .. } = grid;
        let mut after = [(Bounds::EMPTY, 0usize); MAX_BINS];
        let mut right = (Bounds::EMPTY, 0);
        for bin in (1..bins).rev() {
            right.0.grow(&self.bounds[axis][bin]);
            right.1 += self.end[axis][bin] as usize;
            after[bin] = right;
        }
        let mut left = (Bounds::EMPTY, 0);
        let mut best: Option<Plane> = None;
        for last in 0..bins - 1 {
            left.0.grow(&self.bounds[axis][last]);
            left.1 += self.begin[axis][last] as usize;
            let right = after[last + 1];
            let plane = Plane { grid, last, left, right };
            let allowed = left.1 > 0 && right.1 > 0 && left.1 + right.1 - count <= budget;
            // A cost that is no number is not less than any.
            if allowed && plane.cost() < best.as_ref().map_or(f32::INFINITY, Plane::cost) {
                best = Some(plane);
            }
        }
        best
    }
}
