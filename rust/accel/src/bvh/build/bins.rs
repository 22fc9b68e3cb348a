//! Binned splits: the surface area heuristic at the borders of equal bins (Wald, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies", 2007).

use super::reference::{Bounds, Extents, MANY, Reference, SHARE};
use glam::Vec4;
use raywright_base::parallel;
use std::ops::Range;

/// Maximum number of bins.
pub const MAX_BINS: usize = 64;

/// The number of references on a side of a plane, and their bounds.
pub type BinSide = (usize, Bounds);

/// A plane between bins.
#[derive(Clone, Copy)]
pub struct Split {
    axis: usize,
    /// The last place on the left, as returned by [`Binning::place`].
    last: f32,
    binning: Binning,
}

impl Split {
    /// The cheapest plane; None if no plane separates the centers.
    #[inline(always)]
    pub fn best(references: &[Reference], extents: &Extents, bins: usize, workspace: &mut Bins) -> Option<Self> {
        // Fewer bins are as good for small nodes, which are numerous.
        let bins = bins.min((references.len() / 2).max(8));
        let binning = Binning::new(&extents.centres, bins);
        workspace.clear(bins);
        workspace.add(references, &binning);
        workspace.best(bins, binning)
    }

    /// The same in parallel.
    pub fn best_of_many(references: &[Reference], extents: &Extents, bins: usize) -> Option<Self> {
        Self::filled_by_many(references, extents, bins).0
    }

    /// The cheapest plane and its two sides, in parallel for many references.
    pub fn best_with_sides(references: &[Reference], extents: &Extents, bins: usize) -> Option<(Self, [BinSide; 2])> {
        let (split, bins) = if references.len() < MANY {
            let mut filled = Bins::new();
            (Self::best(references, extents, bins, &mut filled), filled)
        } else {
            Self::filled_by_many(references, extents, bins)
        };
        split.map(|split| (split, bins.sides(&split)))
    }

    fn filled_by_many(references: &[Reference], extents: &Extents, bins: usize) -> (Option<Self>, Bins) {
        let binning = Binning::new(&extents.centres, bins);
        let fill = |share: Range<usize>| {
            let mut filled = Bins::new();
            filled.add(&references[share], &binning);
            filled
        };
        let shares = parallel::map_chunks(references.len(), SHARE, fill).into_iter();
        let filled = shares.reduce(|a, b| a.join(&b, bins)).unwrap_or_else(Bins::new);
        (filled.best(bins, binning), filled)
    }

    /// Return whether a reference is on the left.
    #[inline(always)]
    pub fn is_left(&self, r: &Reference) -> bool {
        self.binning.place(r, self.axis) <= self.last
    }
}

/// Adding this rounds to an integer in the lower bits, which is faster than a conversion.
pub const WHOLE: f32 = 1.5 * (1 << 23) as f32;

/// The map from a center to its bin. Binning and partitioning round in the same way, so they always agree.
#[derive(Clone, Copy)]
struct Binning {
    origin: Vec4,
    scale: Vec4,
}

impl Binning {
    fn new(centres: &Bounds, bins: usize) -> Self {
        let size = centres.size();
        // Just under the number of bins, so that the last center falls into the last bin. Flat axes use bin 0 alone.
        let scale = Vec4::splat(bins as f32 * (1.0 - 1e-6)) / size;
        let usable = scale.is_finite_mask() & size.cmpgt(Vec4::ZERO);
        Self { origin: centres.least(), scale: Vec4::select(usable, scale, Vec4::ZERO) }
    }

    /// The bins of a reference along the three axes.
    #[inline(always)]
    fn bins(&self, r: &Reference) -> [usize; 3] {
        let places = ((r.centre() - self.origin) * self.scale - 0.5) + WHOLE;
        let [x, y, z, _] = places.to_array();
        let bin = |place: f32| place.to_bits() as usize & (MAX_BINS - 1);
        [bin(x), bin(y), bin(z)]
    }

    /// The bin of a reference along an axis, plus [`WHOLE`].
    #[inline(always)]
    fn place(&self, r: &Reference, axis: usize) -> f32 {
        ((r.centre_on(axis) - self.origin.as_ref()[axis]) * self.scale.as_ref()[axis] - 0.5) + WHOLE
    }
}

/// The bins of the three axes, with bounds and counts. They are reused for every node, since clearing all of them costs
/// more than filling a few.
pub struct Bins {
    bounds: Box<[[Bounds; MAX_BINS]; 3]>,
    counts: [[u32; MAX_BINS]; 3],
}

impl Bins {
    /// Empty bins.
    pub fn new() -> Self {
        Self { bounds: Box::new([[Bounds::EMPTY; MAX_BINS]; 3]), counts: [[0; MAX_BINS]; 3] }
    }

    #[inline(always)]
    fn clear(&mut self, bins: usize) {
        for axis in 0..3 {
            self.bounds[axis][..bins].fill(Bounds::EMPTY);
            self.counts[axis][..bins].fill(0);
        }
    }

    #[inline(always)]
    fn add(&mut self, references: &[Reference], binning: &Binning) {
        // Neighbors often share a bin, which makes the second wait for the first: alternate with distant ones.
        let (first, second) = references.split_at(references.len() / 2);
        for (i, r) in second.iter().enumerate() {
            self.add_one(r, binning);
            if let Some(r) = first.get(i) {
                self.add_one(r, binning);
            }
        }
    }

    #[inline(always)]
    fn add_one(&mut self, r: &Reference, binning: &Binning) {
        let bins = binning.bins(r);
        for axis in 0..3 {
            self.bounds[axis][bins[axis]].grow(&r.bounds);
            self.counts[axis][bins[axis]] += 1;
        }
    }

    fn join(mut self, other: &Self, bins: usize) -> Self {
        for axis in 0..3 {
            for i in 0..bins {
                self.bounds[axis][i].grow(&other.bounds[axis][i]);
                self.counts[axis][i] += other.counts[axis][i];
            }
        }
        self
    }

    /// The content of both sides of a plane.
    fn sides(&self, split: &Split) -> [BinSide; 2] {
        let last = (split.last - WHOLE) as usize;
        let mut sides = [(0, Bounds::EMPTY); 2];
        for (i, (bounds, &count)) in self.bounds[split.axis].iter().zip(&self.counts[split.axis]).enumerate() {
            let side = &mut sides[usize::from(i > last)];
            side.0 += count as usize;
            side.1.grow(bounds);
        }
        sides
    }

    #[inline(always)]
    fn best(&self, bins: usize, binning: Binning) -> Option<Split> {
        let (mut least, mut best) = (f32::INFINITY, None);
        for axis in 0..3 {
            if binning.scale.as_ref()[axis] <= 0.0 {
                continue;
            }
            let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
            // The costs to the right of each plane; then a sweep from the left.
            let mut right = [0f32; MAX_BINS];
            let (mut grown, mut count) = (Bounds::EMPTY, 0);
            for i in (1..bins).rev() {
                grown.grow(&bounds[i]);
                count += counts[i];
                right[i] = if count > 0 { grown.half_area() * count as f32 } else { f32::INFINITY };
            }
            let (mut grown, mut count) = (Bounds::EMPTY, 0);
            for i in 0..bins - 1 {
                grown.grow(&bounds[i]);
                count += counts[i];
                // NaN if the left is empty, which fails the comparison.
                let cost = grown.half_area() * count as f32 + right[i + 1];
                if cost < least {
                    (least, best) = (cost, Some(Split { axis, last: WHOLE + i as f32, binning }));
                }
            }
        }
        best
    }
}
