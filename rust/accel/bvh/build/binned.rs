//! Top-down by the surface-area heuristic, evaluated at the borders of equal bins (Wald, "On fast Construction of
//! SAH-based Bounding Volume Hierarchies", 2007), on all cores.
//!
//! Splits until every leaf has one primitive; how many go into one leaf of the tree that rays walk is decided when it is
//! collapsed, where the cost of a block of triangles is known.

use super::{BinaryBvh, Bounds, Node, Reference};
use crate::math::Aabb;
use glam::Vec4;
use rayon::prelude::*;

/// Most bins that may be asked for.
pub const MAX_BINS: usize = 64;

/// Below so many primitives a subtree is built by one thread.
const PARALLEL: usize = 1024;

/// From so many primitives on a node is binned by several threads.
const PARALLEL_BINNING: usize = 1 << 16;

/// Builds a tree over boxes, leaving out empty ones. `bins` is from 2 to [`MAX_BINS`].
///
/// Takes time n log n on any input: a split that makes no progress by area gives way to the median, and so do all
/// splits from a depth on that a reasonable tree does not reach.
pub fn build(boxes: &[Aabb], bins: usize) -> BinaryBvh {
    assert!((2..=MAX_BINS).contains(&bins), "bins is {bins}, not from 2 to {MAX_BINS}");
    let mut references: Vec<Reference> =
        boxes.par_iter().enumerate().filter(|(_, b)| !b.is_empty()).map(|(i, b)| Reference::new(b, i as u32)).collect();
    if references.is_empty() {
        return BinaryBvh::default();
    }
    let n = references.len();
    let mut nodes = vec![Node::leaf(Aabb::EMPTY, 0, 0); 2 * n - 1];
    let (root, below) = nodes.split_at_mut(1);
    let spare = 2 * n.ilog2() as usize + 40;
    let task = Task { bins, first: 0, base: 1, spare };
    let extents = bounds(&references);
    task.split(&mut references, extents, &mut root[0], below, &mut Bins::new());
    BinaryBvh { nodes, order: references.iter().map(Reference::primitive).collect() }
}

/// Boxes of a set of references: of all that they hold, and of their centres (doubled).
#[derive(Clone, Copy)]
struct Extents {
    all: Bounds,
    centres: Bounds,
}

fn bounds(references: &[Reference]) -> Extents {
    let empty = Extents { all: Bounds::EMPTY, centres: Bounds::EMPTY };
    let grow = |mut e: Extents, r: &Reference| {
        e.all.grow(r.min, r.max);
        e.centres.grow(r.centre(), r.centre());
        e
    };
    let join = |a: Extents, b: Extents| Extents { all: a.all.union(b.all), centres: a.centres.union(b.centres) };
    if references.len() < PARALLEL_BINNING {
        references.iter().fold(empty, grow)
    } else {
        references.par_chunks(1 << 14).map(|c| c.iter().fold(empty, grow)).reduce(|| empty, join)
    }
}

/// Where a subtree goes: a subtree of n primitives has 2n − 1 nodes, so every part of the array is known beforehand
/// and threads need not agree on anything.
#[derive(Clone, Copy)]
struct Task {
    bins: usize,
    /// The first primitive, as leaves refer to it.
    first: u32,
    /// The index of the first node below this one.
    base: u32,
    /// How many more levels may be split by area.
    spare: usize,
}

impl Task {
    fn split(
        self,
        references: &mut [Reference],
        extents: Extents,
        node: &mut Node,
        below: &mut [Node],
        workspace: &mut Bins,
    ) {
        let aabb = extents.all.aabb();
        if references.len() == 1 {
            *node = Node::leaf(aabb, self.first, 1);
            return;
        }
        *node = Node::inner(aabb, self.base);
        let by_area = if self.spare > 0 && references.len() > 2 {
            best_split(references, &extents, self.bins, workspace)
        } else {
            None
        };
        let middle = match by_area {
            Some(split) => partition(references, |r| split.is_left(r)),
            None => median(references, &extents.centres),
        };
        let (left, right) = references.split_at_mut(middle);
        let (children, below) = below.split_at_mut(2);
        let (left_below, right_below) = below.split_at_mut(2 * middle - 2);
        let [left_node, right_node] = children else { unreachable!("split_at_mut(2) gives two") };
        let spare = self.spare.saturating_sub(1);
        let base = self.base + 2;
        let left_task = Self { base, spare, ..self };
        let right_task =
            Self { base: base + left_below.len() as u32, first: self.first + middle as u32, spare, ..self };
        if left.len() + right.len() < PARALLEL {
            left_task.split(left, bounds(left), left_node, left_below, workspace);
            right_task.split(right, bounds(right), right_node, right_below, workspace);
        } else {
            rayon::join(
                || left_task.split(left, bounds(left), left_node, left_below, workspace),
                || right_task.split(right, bounds(right), right_node, right_below, &mut Bins::new()),
            );
        }
    }
}

/// A plane between bins.
struct Split {
    axis: usize,
    /// The last bin on the left.
    bin: i32,
    binning: Binning,
}

impl Split {
    #[inline(always)]
    fn is_left(&self, r: &Reference) -> bool {
        self.binning.bin(r.centre(), self.axis) <= self.bin
    }
}

/// From a centre to its bin. Binning and partitioning round alike, so they always agree.
#[derive(Clone, Copy)]
struct Binning {
    origin: Vec4,
    scale: Vec4,
}

impl Binning {
    fn new(centres: &Bounds, bins: usize) -> Self {
        let size = centres.max - centres.min;
        // Just under the number of bins, so that the last centre falls into the last bin. Flat axes get bin 0 alone.
        let scale = Vec4::splat(bins as f32 * (1.0 - 1e-6)) / size;
        let usable = scale.is_finite_mask() & size.cmpgt(Vec4::ZERO);
        Self { origin: centres.min, scale: Vec4::select(usable, scale, Vec4::ZERO) }
    }

    #[inline(always)]
    fn bins(&self, centre: Vec4) -> Vec4 {
        (centre - self.origin) * self.scale
    }

    #[inline(always)]
    fn bin(&self, centre: Vec4, axis: usize) -> i32 {
        self.bins(centre)[axis] as i32
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, count: 0 };
}

/// The bins of the three axes. Reused from node to node, since clearing all of them costs more than filling a few.
struct Bins(Box<[[Bin; MAX_BINS]; 3]>);

impl Bins {
    fn new() -> Self {
        Self(Box::new([[Bin::EMPTY; MAX_BINS]; 3]))
    }

    fn clear(&mut self, bins: usize) {
        for line in self.0.iter_mut() {
            line[..bins].fill(Bin::EMPTY);
        }
    }

    fn add(&mut self, references: &[Reference], binning: &Binning) {
        for r in references {
            let place = binning.bins(r.centre());
            for (axis, line) in self.0.iter_mut().enumerate() {
                let bin = &mut line[place[axis] as usize & (MAX_BINS - 1)];
                bin.bounds.grow(r.min, r.max);
                bin.count += 1;
            }
        }
    }

    fn join(mut self, other: &Self, bins: usize) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0.iter()) {
            for (a, b) in a.iter_mut().zip(b).take(bins) {
                a.bounds = a.bounds.union(b.bounds);
                a.count += b.count;
            }
        }
        self
    }

    fn fill(&mut self, references: &[Reference], binning: &Binning, bins: usize) {
        if references.len() < PARALLEL_BINNING {
            self.clear(bins);
            self.add(references, binning);
        } else {
            *self = references
                .par_chunks(1 << 14)
                .fold(Self::new, |mut filled, chunk| {
                    filled.add(chunk, binning);
                    filled
                })
                .reduce(Self::new, |a, b| a.join(&b, bins));
        }
    }
}

/// The cheapest plane; none if no plane parts the centres.
fn best_split(references: &[Reference], extents: &Extents, bins: usize, workspace: &mut Bins) -> Option<Split> {
    // Small nodes, of which there are most, need no more bins than they have primitives.
    let bins = bins.min(references.len().max(4));
    let binning = Binning::new(&extents.centres, bins);
    workspace.fill(references, &binning, bins);
    let mut best: Option<(f32, usize, usize)> = None;
    for (axis, line) in workspace.0.iter().enumerate().filter(|(axis, _)| binning.scale[*axis] > 0.0) {
        // Costs of all that lies right of a plane, then swept from the left.
        let mut right = [0f32; MAX_BINS];
        let (mut grown, mut count) = (Bounds::EMPTY, 0);
        for i in (1..bins).rev() {
            grown = grown.union(line[i].bounds);
            count += line[i].count;
            right[i] = if count > 0 { grown.half_area() * count as f32 } else { f32::INFINITY };
        }
        let (mut grown, mut count) = (Bounds::EMPTY, 0);
        for i in 0..bins - 1 {
            grown = grown.union(line[i].bounds);
            count += line[i].count;
            if count == 0 {
                continue;
            }
            let cost = grown.half_area() * count as f32 + right[i + 1];
            if cost < best.map_or(f32::INFINITY, |b| b.0) {
                best = Some((cost, axis, i));
            }
        }
    }
    best.map(|(_, axis, bin)| Split { axis, bin: bin as i32, binning })
}

/// Brings all for which `is_left` holds to the front and tells how many they are.
fn partition(references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> usize {
    let (mut i, mut j) = (0, references.len());
    loop {
        while i < j && is_left(&references[i]) {
            i += 1;
        }
        while i < j && !is_left(&references[j - 1]) {
            j -= 1;
        }
        if i == j {
            return i;
        }
        references.swap(i, j - 1);
    }
}

/// Halves by number along the longest axis of the centres; equal centres by their primitive's number.
fn median(references: &mut [Reference], centres: &Bounds) -> usize {
    let size = centres.max - centres.min;
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    let middle = references.len() / 2;
    references.select_nth_unstable_by(middle, |a, b| {
        a.centre()[axis].total_cmp(&b.centre()[axis]).then(a.primitive().cmp(&b.primitive()))
    });
    middle
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn check(boxes: &[Aabb]) -> BinaryBvh {
        let bvh = build(boxes, 16);
        bvh.validate(boxes).unwrap();
        let n = boxes.iter().filter(|b| !b.is_empty()).count();
        assert_eq!(bvh.nodes.len(), (2 * n).saturating_sub(1));
        let limit = if n > 0 { 3 * n.ilog2() as usize + 42 } else { 0 };
        assert!(bvh.depth() <= limit, "depth {} for {n} boxes", bvh.depth());
        bvh
    }

    fn point(p: [f32; 3]) -> Aabb {
        Aabb::around([Vec3::from(p)])
    }

    proptest! {
        #[test]
        fn trees_over_any_boxes_are_valid(corners in prop::collection::vec(([-2f32..2.0, -2f32..2.0, -2f32..2.0], [0f32..0.5, 0f32..0.5, 0f32..0.5]), 0..300)) {
            let boxes: Vec<_> = corners
                .iter()
                .map(|(p, d)| Aabb { min: Vec3::from(*p), max: Vec3::from(*p) + Vec3::from(*d) })
                .collect();
            check(&boxes);
        }
    }

    #[test]
    fn empty_boxes_are_left_out() {
        assert!(check(&[]).nodes.is_empty());
        assert!(check(&[Aabb::EMPTY; 3]).nodes.is_empty());
        assert_eq!(check(&[Aabb::EMPTY, point([1.0; 3]), Aabb::EMPTY]).order, [1]);
    }

    #[test]
    fn coinciding_boxes_are_halved() {
        let bvh = check(&vec![point([0.5; 3]); 100_000]);
        assert_eq!(bvh.depth(), 17);
    }

    #[test]
    fn a_staircase_of_scales_stays_shallow() {
        // Each box holds all that come before it, and equal bins can cut off only one at a time.
        let boxes: Vec<_> = (0..40_000)
            .map(|i| {
                let s = 1.0 - 0.9997f32.powi(i);
                Aabb { min: Vec3::ZERO, max: Vec3::splat(s) }
            })
            .collect();
        check(&boxes);
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let boxes: Vec<_> = (0..70_000u32)
            .map(|i| point([(i * 7919 % 10_007) as f32, (i * 31 % 997) as f32, (i % 13) as f32]))
            .collect();
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| build(&boxes, 16)).order
        };
        assert_eq!(on(1), on(3));
    }
}
