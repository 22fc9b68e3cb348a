//! Spatial splits: equal bins that hold the parts of each reference (Stich, Friedrich and Dietrich, "Spatial Splits in
//! Bounding Volume Hierarchies", 2009; "chopped binning" after Popov, Günther, Seidel and Slusallek 2006).
//!
//! Planes are compared by estimates. The parts of a triangle are bounded by the planes' cuts of its edges and the
//! reference's box, in f32. Only references that straddle the chosen plane are clipped exactly.

use super::binned::MAX_BINS;
use super::bins::WHOLE;
use super::reference::{Bounds, Reference};
use super::{Shapes, chop};
use glam::Vec4;
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::Work;
use std::ops::Range;

/// Minimum number of references for parallel processing.
const MANY: usize = 1 << 13;

/// References per parallel task.
const SHARE: usize = 1 << 12;

/// Maximum number of parallel tasks that fill bins.
const MOST_SHARES: usize = 256;

/// Only axes with at least this fraction of the longest extent are tried; others hardly ever win.
const LENGTH: f32 = 0.5;

/// Equal bins along the three axes.
#[derive(Clone, Copy)]
struct ChopGrid {
    origin: Vec4,
    width: Vec4,
    /// The inverse bin width; 0 along axes that are not tried.
    scale: Vec4,
    /// The last bin as a float.
    last: Vec4,
}

impl ChopGrid {
    fn new(around: &Bounds, bins: usize) -> Self {
        let width = around.size() / bins as f32;
        let scale = width.recip();
        let worth = width.cmpge(Vec4::splat(LENGTH * width.truncate().max_element()));
        let usable = worth & width.cmpge(Vec4::splat(f32::MIN_POSITIVE)) & scale.is_finite_mask();
        let scale = Vec4::select(usable, scale, Vec4::ZERO);
        Self { origin: around.least(), width, scale, last: Vec4::splat((bins - 1) as f32) }
    }

    /// The axes that are tried.
    fn axes(&self) -> impl Iterator<Item = usize> {
        let scale = self.scale.to_array();
        (0..3).filter(move |&axis| scale[axis] > 0.0)
    }

    /// The lower border of a bin.
    #[inline(always)]
    fn border(&self, axis: usize, bin: usize) -> f32 {
        self.origin.as_ref()[axis] + self.width.as_ref()[axis] * bin as f32
    }

    /// The first and the last bin that a reference overlaps along each axis, excluding bins it only touches.
    #[inline(always)]
    fn places(&self, r: &Reference) -> [[usize; 3]; 2] {
        let whole = Vec4::splat(WHOLE);
        let below = (r.bounds.least() - self.origin) * self.scale;
        let above = (r.bounds.greatest() - self.origin) * self.scale;
        // Round to the nearest integer, and correct it by one if it is on the wrong side.
        let (near_below, near_above) = ((below + whole) - whole, (above + whole) - whole);
        let down = Vec4::select(near_below.cmpgt(below), Vec4::ONE, Vec4::ZERO);
        let up = Vec4::select(near_above.cmplt(above), Vec4::ZERO, Vec4::ONE);
        let first = (near_below - down).max(Vec4::ZERO).min(self.last);
        let last = (near_above - up).max(first).min(self.last);
        [first, last].map(|places| {
            let [x, y, z, _] = (places + whole).to_array();
            [x, y, z].map(|place| place.to_bits() as usize & (MAX_BINS - 1))
        })
    }
}

/// The bins of the three axes: bounds of the parts, and the numbers of references that begin and end there.
pub struct Chopped {
    bounds: Box<[[Bounds; MAX_BINS]; 3]>,
    begin: [[u32; MAX_BINS]; 3],
    end: [[u32; MAX_BINS]; 3],
}

impl Chopped {
    fn new() -> Self {
        let none = [[0; MAX_BINS]; 3];
        Self { bounds: Box::new([[Bounds::EMPTY; MAX_BINS]; 3]), begin: none, end: none }
    }

    fn add(&mut self, references: &[Reference], grid: &ChopGrid, shapes: &impl Shapes) {
        let (mut axes, mut count) = ([0; 3], 0);
        for axis in grid.axes() {
            axes[count] = axis;
            count += 1;
        }
        // Neighbors often share a bin, which makes the second wait for the first: alternate with distant ones.
        let (first, second) = references.split_at(references.len() / 2);
        for (i, r) in second.iter().enumerate() {
            self.add_one(r, grid, &axes[..count], shapes);
            if let Some(r) = first.get(i) {
                self.add_one(r, grid, &axes[..count], shapes);
            }
        }
    }

    #[inline(always)]
    fn add_one(&mut self, r: &Reference, grid: &ChopGrid, axes: &[usize], shapes: &impl Shapes) {
        let [first, last] = grid.places(r);
        let mut corners = None;
        for &axis in axes {
            let (first, last) = (first[axis], last[axis]);
            self.begin[axis][first] += 1;
            self.end[axis][last] += 1;
            let bins = &mut self.bounds[axis];
            if first == last {
                bins[first].grow(&r.bounds);
                continue;
            }
            let whole = || shapes.corners(r.primitive()).map(|corners| corners.map(|c| c.extend(0.0)));
            if let Some(corners) = corners.get_or_insert_with(whole) {
                let border = |bin: usize| grid.border(axis, bin);
                chop::parts(corners, &r.bounds, axis, first..=last, border, |bin, part| bins[bin].grow(part));
                continue;
            }
            let whole = r.bounds.aabb();
            for bin in first..=last {
                let mut slab = whole;
                slab.min[axis] = if bin > first { grid.border(axis, bin) } else { whole.min[axis] };
                slab.max[axis] = if bin < last { grid.border(axis, bin + 1) } else { whole.max[axis] };
                let part = shapes.clip(r.primitive(), &slab);
                if !part.is_empty() {
                    bins[bin].grow(&Bounds::from(&part));
                }
            }
        }
    }

    fn join(mut self, other: &Self, bins: usize) -> Self {
        for axis in 0..3 {
            for bin in 0..bins {
                self.bounds[axis][bin].grow(&other.bounds[axis][bin]);
                self.begin[axis][bin] += other.begin[axis][bin];
                self.end[axis][bin] += other.end[axis][bin];
            }
        }
        self
    }

    /// The cheapest plane along an axis.
    fn best(&self, grid: &ChopGrid, axis: usize, bins: usize, count: usize, budget: usize) -> Option<ChopPlane> {
        let mut after = [(Bounds::EMPTY, 0usize); MAX_BINS];
        let mut right = (Bounds::EMPTY, 0);
        for bin in (1..bins).rev() {
            right.0.grow(&self.bounds[axis][bin]);
            right.1 += self.end[axis][bin] as usize;
            after[bin] = right;
        }
        let mut left = (Bounds::EMPTY, 0);
        let mut best: Option<ChopPlane> = None;
        for last in 0..bins - 1 {
            left.0.grow(&self.bounds[axis][last]);
            left.1 += self.begin[axis][last] as usize;
            let right = after[last + 1];
            let plane = ChopPlane { grid: *grid, axis, last, left, right };
            let allowed = left.1 > 0 && right.1 > 0 && left.1 + right.1 - count <= budget;
            // NaN fails the comparison.
            if allowed && plane.cost() < best.as_ref().map_or(f32::INFINITY, ChopPlane::cost) {
                best = Some(plane);
            }
        }
        best
    }
}

/// A plane between two bins.
#[derive(Clone, Copy)]
pub struct ChopPlane {
    grid: ChopGrid,
    axis: usize,
    /// The last bin on the left.
    last: usize,
    /// Approximate bounds and counts of both sides if all straddling references are split.
    left: (Bounds, usize),
    right: (Bounds, usize),
}

impl ChopPlane {
    /// The cheapest plane that adds no more references than the budget. None once the work is canceled.
    pub fn best(
        references: &[Reference],
        around: &Bounds,
        bins: usize,
        shapes: &impl Shapes,
        budget: usize,
        work: Work,
    ) -> Option<Self> {
        // Half as many bins as for object splits, and fewer for small sets: such planes are hardly worse.
        let bins = bins.div_ceil(2).min(references.len() / 256).max(bins.div_ceil(4)).max(4);
        let grid = ChopGrid::new(around, bins);
        let fill = |share: Range<usize>| {
            let mut filled = Chopped::new();
            if !work.is_stopped() {
                filled.add(&references[share], &grid, shapes);
            }
            filled
        };
        let filled = if references.len() < MANY {
            fill(0..references.len())
        } else {
            // Few tasks, since each has its own bins.
            let share = SHARE.max(references.len().div_ceil(MOST_SHARES));
            let shares = parallel::map_chunks(references.len(), share, fill).into_iter();
            shares.reduce(|a, b| a.join(&b, bins)).unwrap_or_else(Chopped::new)
        };
        if work.is_stopped() {
            // The counts may be incomplete.
            return None;
        }
        let planes = grid.axes().filter_map(|axis| filled.best(&grid, axis, bins, references.len(), budget));
        // The first of several equal ones.
        planes.reduce(|best, plane| if plane.cost() < best.cost() { plane } else { best })
    }

    /// The cost by area and count.
    pub fn cost(&self) -> f32 {
        self.left.0.half_area() * self.left.1 as f32 + self.right.0.half_area() * self.right.1 as f32
    }

    /// Distribute references to both sides. Straddling ones are split, or go to one side as a whole if that is cheaper.
    pub fn part(&self, references: &[Reference], shapes: &impl Shapes) -> (Vec<Reference>, Vec<Reference>) {
        let Self { left: (mut left_bounds, mut left_count), right: (mut right_bounds, mut right_count), .. } = *self;
        let Sorted { mut left, mut right, across } = if references.len() < MANY {
            self.sort(references, shapes)
        } else {
            let sort = |share: Range<usize>| self.sort(&references[share], shapes);
            let shares = parallel::map_chunks(references.len(), SHARE, sort);
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

    /// Classify references, and clip straddling ones.
    fn sort(&self, references: &[Reference], shapes: &impl Shapes) -> Sorted {
        let Self { grid, axis, last, .. } = *self;
        let at = grid.border(axis, last + 1);
        let room = || Vec::with_capacity(references.len());
        let mut sorted = Sorted { left: room(), right: room(), across: Vec::new() };
        for &whole in references {
            let [begin, end] = grid.places(&whole).map(|places| places[axis]);
            if end <= last {
                sorted.left.push(whole);
            } else if begin > last {
                sorted.right.push(whole);
            } else {
                let (mut below, mut above) = (whole.bounds.aabb(), whole.bounds.aabb());
                (below.max[axis], above.min[axis]) = (at, at);
                let clip = |half: Aabb| if half.is_empty() { half } else { shapes.clip(whole.primitive(), &half) };
                sorted.across.push(Across { whole, halves: [clip(below), clip(above)] });
            }
        }
        sorted
    }
}

/// References on either side of a plane, and straddling ones.
#[derive(Default)]
struct Sorted {
    left: Vec<Reference>,
    right: Vec<Reference>,
    across: Vec<Across>,
}

impl Sorted {
    /// Append others.
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
    /// The boxes of its parts below and above the plane.
    halves: [Aabb; 2],
}
