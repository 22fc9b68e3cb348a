//! Planes that part what they cut: bins of equal width that hold the parts of each reference (Stich, Friedrich and
//! Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009; "chopped binning" after Popov, Günther, Seidel and
//! Slusallek 2006).

use super::binned::MAX_BINS;
use super::reference::{Bounds, Reference};
use crate::math::Aabb;
use rayon::prelude::*;

/// From so many references on, several threads look at them: to cut one takes much longer than to look at its box.
const MANY: usize = 1 << 12;

/// So many are one thread's share then.
const SHARE: usize = 1 << 10;

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

    /// The first and the last bin that an interval reaches into, which is that of its lower end if it only touches the
    /// next.
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
        // Half as many as for whole references, and fewer for few: what is long is cut in each that it passes, and
        // planes found so are hardly worse.
        let bins = bins.div_ceil(2).min(references.len() / 2).max(4);
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
        clip: &(impl Fn(u32, &Aabb) -> Aabb + Sync),
    ) -> (Vec<Reference>, Vec<Reference>) {
        let Self { left: (mut left_bounds, mut left_count), right: (mut right_bounds, mut right_count), .. } = *self;
        let Sorted { mut left, mut right, across } = if references.len() < MANY {
            self.sort(references, clip)
        } else {
            let shares: Vec<_> = references.par_chunks(SHARE).map(|share| self.sort(share, clip)).collect();
            shares.into_iter().fold(Sorted::default(), Sorted::then)
        };
        for Across { whole, halves: [below, above] } in across {
            let in_left = left_bounds.union(&whole.bounds);
            let in_right = right_bounds.union(&whole.bounds);
            let (l, r) = (left_bounds.half_area(), right_bounds.half_area());
            let (n, m) = (left_count as f32, right_count as f32);
            let parted = l * n + r * m;
            let all_left = in_left.half_area() * n + r * (m - 1.0);
            let all_right = l * (n - 1.0) + in_right.half_area() * m;
            if above.is_empty() || (all_left <= parted && all_left <= all_right && !below.is_empty()) {
                left_bounds = in_left;
                right_count -= 1;
                left.push(whole);
            } else if below.is_empty() || all_right <= parted {
                right_bounds = in_right;
                left_count -= 1;
                right.push(whole);
            } else {
                left.push(Reference::new(&below, whole.primitive()));
                right.push(Reference::new(&above, whole.primitive()));
            }
        }
        (left, right)
    }

    /// Tells what lies on either side, and cuts what straddles.
    fn sort(&self, references: &[Reference], clip: &impl Fn(u32, &Aabb) -> Aabb) -> Sorted {
        let Self { grid, last, .. } = *self;
        let at = grid.border(last + 1);
        let mut sorted = Sorted::default();
        for &whole in references {
            let [begin, end] = grid.place_of(&whole);
            if end <= last {
                sorted.left.push(whole);
            } else if begin > last {
                sorted.right.push(whole);
            } else {
                let (mut below, mut above) = (whole.bounds.aabb(), whole.bounds.aabb());
                (below.max[grid.axis], above.min[grid.axis]) = (at, at);
                let halves = [below, above].map(|half| clip(whole.primitive(), &half));
                sorted.across.push(Across { whole, halves });
            }
        }
        sorted
    }
}

/// References on either side of a plane, and those that straddle it.
#[derive(Default)]
struct Sorted {
    left: Vec<Reference>,
    right: Vec<Reference>,
    across: Vec<Across>,
}

impl Sorted {
    /// These, and then others.
    fn then(mut self, other: Self) -> Self {
        self.left.extend(other.left);
        self.right.extend(other.right);
        self.across.extend(other.across);
        self
    }
}

/// A reference that straddles a plane.
struct Across {
    whole: Reference,
    /// What of it lies below the plane, and above.
    halves: [Aabb; 2],
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
