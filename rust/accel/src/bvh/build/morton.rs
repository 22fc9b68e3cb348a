//! Linear BVHs: primitives in Morton order, split bit by bit (Lauterbach, Garland, Sengupta, Luebke and Manocha, "Fast
//! BVH Construction on GPUs", 2009; Karras, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d
//! Trees", 2012). Codes are radix sorted, subtrees are written in parallel, and boxes are computed bottom-up.
//!
//! Leaves have one primitive each; blocks are formed when the tree is collapsed.

use super::reference::{Extents, Reference, references};
use super::slices::{self, Opened, Subtree};
use super::{BinaryBvh, radix};
use raywright_base::math::Aabb;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;

/// The resolution of the codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 30 bits: 1024 positions per axis.
    Thirty,
    /// 63 bits: 2²¹ positions per axis.
    #[default]
    SixtyThree,
}

impl Bits {
    /// The number of bits in a code.
    pub const fn count(self) -> u32 {
        match self {
            Self::Thirty => 30,
            Self::SixtyThree => 63,
        }
    }
}

/// Build a tree over boxes, skipping empty ones. Its depth is at most the number of bits, plus the logarithm of the
/// number of equal codes, which are split at the median.
pub fn build<'a>(boxes: impl Into<Cow<'a, [Aabb]>>, bits: Bits, work: Work) -> Result<BinaryBvh, Stopped> {
    let [gather, sort, write] = work.parts([1.0, 8.0, 10.0]);
    let references = references(boxes, gather)?;
    if references.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let sorted = sorted(&references, bits, sort)?;
    slices::write(Codes { sorted: &sorted, references: &references }, references.len(), write)
}

/// The Morton codes with the indices of their references, sorted by code, then by index.
pub fn sorted(references: &[Reference], bits: Bits, work: Work) -> Result<Vec<(u64, u32)>, Stopped> {
    let centres = Extents::around_many(references).centres.aabb();
    let (min, max) = (centres.min.as_dvec3(), centres.max.as_dvec3());
    // The same scale for all axes, so that cells are cubes.
    let places = (1u64 << (bits.count() / 3)) as f64;
    let size = (max - min).max_element();
    let scale = if size > 0.0 { places / size } else { 0.0 };
    // The greatest center belongs to the last cell.
    let last = places as u64 - 1;
    let code = |r: &Reference| {
        let [x, y, z, _] = r.centre().to_array();
        let place = |at: f32, min: f64| (((f64::from(at) - min) * scale) as u64).min(last);
        spread(place(x, min.x)) << 2 | spread(place(y, min.y)) << 1 | spread(place(z, min.z))
    };
    let [encode, sort] = work.parts([1.0, 8.0]);
    let mut sorted = encode.collect(references.len(), |i| (code(&references[i]), i as u32))?;
    radix::sort(&mut sorted, bits.count(), sort)?;
    Ok(sorted)
}

/// Insert two zero bits between adjacent bits of the lowest 21.
pub fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// A run of codes with a common prefix.
#[derive(Clone, Copy)]
struct Codes<'a> {
    sorted: &'a [(u64, u32)],
    references: &'a [Reference],
}

impl Subtree for Codes<'_> {
    fn open(self) -> Opened<Self> {
        let Self { sorted, references } = self;
        let (first, last) = (sorted[0], sorted[sorted.len() - 1]);
        if sorted.len() == 1 {
            let reference = &references[first.1 as usize];
            return Opened::Leaf(reference.bounds.aabb(), reference.primitive());
        }
        let left = match first.0 ^ last.0 {
            0 => sorted.len() / 2,
            differing => {
                let bit = 1 << differing.ilog2();
                sorted.partition_point(|&(code, _)| code & bit == 0)
            }
        };
        let (left, right) = sorted.split_at(left);
        let codes = |sorted| Self { sorted, references };
        Opened::Pair(codes(left), codes(right), left.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::Vec3;

    #[test]
    fn bits_are_spread() {
        for x in [0, 1, 2, 5, 0x1f_ffff, 0x15_5555, 0xa_aaaa] {
            let wanted = (0..21).fold(0, |code, bit| code | (x >> bit & 1) << (3 * bit));
            assert_eq!(spread(x), wanted, "{x:#x}");
        }
    }

    #[test]
    fn points_of_a_grid_are_parted_in_their_middles() {
        // In Morton order every inner node is a box of a power of two of points.
        let boxes: Vec<_> =
            (0..512).map(|i| Aabb::around([Vec3::new((i % 8) as f32, (i / 8 % 8) as f32, (i / 64) as f32)])).collect();
        for bits in [Bits::Thirty, Bits::SixtyThree] {
            let bvh = build(&boxes, bits, Work::UNWATCHED).unwrap();
            bvh.validate(&boxes).unwrap();
            assert_eq!(bvh.depth(), 9);
            assert_eq!(bvh.nodes[1].aabb(), Aabb { min: Vec3::ZERO, max: Vec3::new(3.0, 7.0, 7.0) });
        }
    }
}
