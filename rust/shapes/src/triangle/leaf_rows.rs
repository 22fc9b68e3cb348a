//! Leaf triangles in f32 SoA layout, and their pretest.

use super::pretest::{BlockRay, difference, not_rejected};
use raywright_base::math::Vec3;
use raywright_base::parallel;
use raywright_base::simd::Lanes;

/// Values per triangle: nine coordinates and the index.
const ROWS: usize = 10;

/// Length of a slice that contains the first nine rows of any leaf of up to eight triangles, so that one bounds check
/// suffices.
const WHOLE: usize = 8 * MOST + MOST;

/// Maximum number of triangles in a leaf.
const MOST: usize = 8;

/// The triangles of all leaves in f32. A leaf of n triangles has n numbers per row, one row after the other: the
/// coordinates of three vectors by axis, then the triangles' indices. So a leaf takes only the memory its triangles
/// need. `N` numbers read from a row start with the leaf's; the others are irrelevant.
#[derive(Clone, Debug)]
pub struct Rows<const N: usize> {
    numbers: Vec<f32>,
}

/// One of the first nine rows of a leaf with `count` triangles.
#[inline(always)]
fn whole_row<const N: usize>(whole: &[f32; WHOLE], row: usize, count: u32) -> &[f32; N] {
    whole[row * (count as usize).min(MOST)..].first_chunk().expect("within")
}

impl<const N: usize> Rows<N> {
    /// Turns small integers into the bits of normal floats. Unused lanes compute with these bits, and subnormal floats
    /// would be slow.
    const MASK: u32 = 0x4000_0000;

    pub(super) fn new(order: &[u32], counts: &[u32], vectors: impl Fn(u32) -> [Vec3; 3] + Sync) -> Self {
        /// Leaves per parallel task.
        const SOME: usize = 1024;
        assert_eq!(counts.iter().sum::<u32>() as usize, order.len(), "as many triangles as their counts say");
        const { assert!(N <= MOST) };
        // Padding, so that the last leaf can be read like any other.
        let last = counts.last().map_or(0, |&count| count as usize * ROWS);
        let mut numbers = vec![0.0; order.len() * ROWS + WHOLE.saturating_sub(last)];
        let mut parts = Vec::with_capacity(counts.len().div_ceil(SOME));
        let (mut rest, mut order) = (numbers.as_mut_slice(), order);
        for counts in counts.chunks(SOME) {
            let triangles = counts.iter().sum::<u32>() as usize;
            let (part, others) = rest.split_at_mut(triangles * ROWS);
            let (mine, more) = order.split_at(triangles);
            parts.push((part, mine, counts));
            (rest, order) = (others, more);
        }
        parallel::map_parts(parts, |(mut part, mut order, counts): (&mut [f32], &[u32], &[u32])| {
            for &count in counts {
                let count = count as usize;
                assert!(count <= N, "a leaf has at most {N} triangles");
                let (leaf, others) = part.split_at_mut(count * ROWS);
                let (mine, more) = order.split_at(count);
                for (lane, &primitive) in mine.iter().enumerate() {
                    assert!(primitive < Self::MASK, "fewer than 2^30 triangles");
                    for (which, vector) in vectors(primitive).into_iter().enumerate() {
                        for axis in 0..3 {
                            leaf[(3 * which + axis) * count + lane] = vector[axis];
                        }
                    }
                    leaf[9 * count + lane] = f32::from_bits(primitive | Self::MASK);
                }
                (part, order) = (others, more);
            }
        });
        Self { numbers }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice())
    }

    /// The address of a leaf, for prefetching only.
    #[inline(always)]
    pub(super) fn place(&self, first: usize) -> *const u8 {
        self.numbers.as_ptr().wrapping_add(first * ROWS).cast()
    }

    /// The index of the triangle in a lane of a leaf.
    #[inline(always)]
    pub(super) fn primitive(&self, first: usize, count: u32, lane: usize) -> u32 {
        self.numbers[first * ROWS + 9 * count as usize + lane].to_bits() ^ Self::MASK
    }

    /// The three vectors of the triangle in a lane of a leaf.
    #[inline(always)]
    pub(super) fn vectors(&self, first: usize, count: u32, lane: usize) -> [Vec3; 3] {
        let count = count as usize;
        let leaf = &self.numbers[first * ROWS + lane..][..8 * count + 1];
        #[inline(always)]
        fn vector(leaf: &[f32], count: usize, c: usize) -> Vec3 {
            Vec3::new(leaf[3 * c * count], leaf[(3 * c + 1) * count], leaf[(3 * c + 2) * count])
        }
        [vector(leaf, count, 0), vector(leaf, count, 1), vector(leaf, count, 2)]
    }

    /// The numbers from the start of a leaf.
    #[inline(always)]
    fn whole(&self, first: usize) -> &[f32; WHOLE] {
        let start = first * ROWS;
        (&self.numbers[start..start + WHOLE]).try_into().expect("as many")
    }

    /// One of the three vectors of the triangles of a leaf, axis by axis.
    #[inline(always)]
    pub fn numbers<S: Lanes<N>>(&self, simd: S, first: usize, count: u32, which: usize) -> [S::F32; 3] {
        let (whole, row) = (self.whole(first), 3 * which);
        let [x, y, z] =
            [whole_row(whole, row, count), whole_row(whole, row + 1, count), whole_row(whole, row + 2, count)];
        [simd.load(x), simd.load(y), simd.load(z)]
    }

    /// The triangles of a leaf as a corner and its two edges, axis by axis. `edges` says that they are stored so.
    #[inline(always)]
    pub(super) fn edges<S: Lanes<N>>(&self, simd: S, first: usize, count: u32, edges: bool) -> [[S::F32; 3]; 3] {
        let a = self.numbers(simd, first, count, 0);
        let mut e = self.numbers(simd, first, count, 1);
        let mut f = self.numbers(simd, first, count, 2);
        if !edges {
            (e, f) = (difference(simd, e, a), difference(simd, f, a));
        }
        [a, e, f]
    }

    /// The lanes of a leaf that f32 cannot reject.
    #[inline(always)]
    pub(super) fn not_rejected<S: Lanes<N>>(
        &self,
        simd: S,
        ray: &BlockRay,
        first: usize,
        count: u32,
        edges: bool,
    ) -> u32 {
        let (o, d) = ray.splat(simd);
        not_rejected(simd, self.edges(simd, first, count, edges), o, d, &ray.errors) & ((1 << count) - 1)
    }
}
