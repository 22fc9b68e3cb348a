//! The triangles of a tree's leaves in f32, side by side, and the first test of them.

use super::pretest::{BlockRay, difference, not_rejected};
use raywright_base::math::Vec3;
use raywright_base::parallel;
use raywright_base::simd::Lanes;

/// Numbers of a triangle: nine coordinates and which it is.
const ROWS: usize = 10;

/// Numbers from where a leaf begins, of which its first nine rows are a part however many triangles it has, up to
/// eight: so one look says that all of them are there.
const WHOLE: usize = 8 * MOST + MOST;

/// Triangles of the largest leaf.
const MOST: usize = 8;

/// The triangles of all leaves in f32. A leaf of n has n numbers of each row, one row after the other: the coordinates
/// of three vectors by axis, then the triangles' own numbers. So a leaf takes no more memory than its triangles need,
/// and `N` numbers read from any row are those of the leaf and others that do not matter.
#[derive(Clone, Debug)]
pub struct Rows<const N: usize> {
    numbers: Vec<f32>,
}

/// One of the first nine rows of a leaf of so many.
#[inline(always)]
fn whole_row<const N: usize>(whole: &[f32; WHOLE], row: usize, count: u32) -> &[f32; N] {
    whole[row * (count as usize).min(MOST)..].first_chunk().expect("within")
}

impl<const N: usize> Rows<N> {
    /// Makes the bits of small whole numbers those of ordinary floats: they are computed with, to no end, by lanes that
    /// do not matter, and subnormal ones would make that slow.
    const MASK: u32 = 0x4000_0000;

    pub(super) fn new(order: &[u32], counts: &[u32], vectors: impl Fn(u32) -> [Vec3; 3] + Sync) -> Self {
        /// Leaves that a thread fills at a time.
        const SOME: usize = 1024;
        assert_eq!(counts.iter().sum::<u32>() as usize, order.len(), "as many triangles as their counts say");
        const { assert!(N <= MOST) };
        // The last leaf can be read as any other.
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

    /// Where a leaf begins. The address is only asked for.
    #[inline(always)]
    pub(super) fn place(&self, first: usize) -> *const u8 {
        self.numbers.as_ptr().wrapping_add(first * ROWS).cast()
    }

    /// The number of the triangle in a lane of a leaf.
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

    /// What stands from where a leaf begins.
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

    /// The triangles of a leaf as a corner and the edges from there, axis by axis. `edges` says that they are kept so.
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

    /// Of the lanes of a leaf, those that f32 cannot reject.
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
