//! Stream compaction of sixteen lanes.

use super::Level;
use std::marker::PhantomData;

/// Lanes of a column.
const LANES: usize = 16;

/// The plain types of columns.
pub trait Word: Copy + private::Sealed {}

mod private {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for u32 {}
    impl Sealed for f64 {}
    impl Sealed for [u32; 2] {}
}

impl Word for f32 {}
impl Word for u32 {}
impl Word for f64 {}
impl Word for [u32; 2] {}

/// Sixteen lanes, and the destination of the surviving ones.
pub struct Column<'a> {
    from: *const u8,
    to: *mut u8,
    /// True if lanes have eight bytes rather than four.
    is_wide: bool,
    of: PhantomData<&'a mut u8>,
}

impl<'a> Column<'a> {
    /// Set up source and destination.
    ///
    /// # Panics
    ///
    /// If the destination has fewer than sixteen entries.
    #[inline(always)]
    pub fn new<T: Word>(from: &'a [T; LANES], to: &'a mut [T]) -> Self {
        assert!(to.len() >= LANES, "room for sixteen lanes");
        Self { from: from.as_ptr().cast(), to: to.as_mut_ptr().cast(), is_wide: size_of::<T>() == 8, of: PhantomData }
    }
}

/// Move the lanes in a mask to the front of their columns, in order. The entries after them, up to the sixteenth, are
/// unspecified.
#[inline]
pub fn pack(level: Level, mask: u32, columns: &[Column<'_>]) {
    let mask = mask & 0xffff;
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 if super::Avx512::detect().is_some() => {
            // SAFETY: the processor was just checked for the features that `x86::pack_512` is compiled for.
            unsafe { x86::pack_512(mask, columns) }
        }
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 if super::Avx2::detect().is_some() => {
            // SAFETY: the processor was just checked for the features that `x86::pack_256` is compiled for.
            unsafe { x86::pack_256(mask, columns) }
        }
        _ => pack_any(mask, columns),
    }
}

fn pack_any(mask: u32, columns: &[Column<'_>]) {
    let (mut lanes, mut count) = ([0usize; LANES], 0);
    for lane in 0..LANES {
        lanes[count & (LANES - 1)] = lane;
        count += (mask >> lane & 1) as usize;
    }
    for column in columns {
        for (place, &lane) in lanes[..count].iter().enumerate() {
            // SAFETY: both have sixteen lanes of this size (`Column::new`).
            unsafe {
                if column.is_wide {
                    column
                        .to
                        .cast::<u64>()
                        .add(place)
                        .write_unaligned(column.from.cast::<u64>().add(lane).read_unaligned());
                } else {
                    column
                        .to
                        .cast::<u32>()
                        .add(place)
                        .write_unaligned(column.from.cast::<u32>().add(lane).read_unaligned());
                }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Column;
    use std::arch::x86_64::*;

    /// The lanes of each mask of eight.
    const FRONT: [[u32; 8]; 256] = {
        let mut all = [[0; 8]; 256];
        let mut mask = 0;
        while mask < 256 {
            let (mut lane, mut count) = (0, 0);
            while lane < 8 {
                if mask >> lane & 1 == 1 {
                    all[mask][count] = lane as u32;
                    count += 1;
                }
                lane += 1;
            }
            mask += 1;
        }
        all
    };

    /// The same for four lanes of two words each.
    const FRONT_WIDE: [[u32; 8]; 16] = {
        let mut all = [[0; 8]; 16];
        let mut mask = 0;
        while mask < 16 {
            let (mut lane, mut count) = (0, 0);
            while lane < 4 {
                if mask >> lane & 1 == 1 {
                    all[mask][2 * count] = 2 * lane as u32;
                    all[mask][2 * count + 1] = 2 * lane as u32 + 1;
                    count += 1;
                }
                lane += 1;
            }
            mask += 1;
        }
        all
    };

    #[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
    pub fn pack_256(mask: u32, columns: &[Column<'_>]) {
        let halves = [mask as usize & 0xff, mask as usize >> 8 & 0xff];
        let quarters = [0, 4, 8, 12].map(|first| mask as usize >> first & 0xf);
        for column in columns {
            // SAFETY: both have sixteen lanes of this size (`Column::new`), and the survivors of the lanes before a
            // register are no more than these lanes.
            unsafe {
                let (mut from, mut to) = (column.from.cast::<__m256i>(), column.to);
                if column.is_wide {
                    for quarter in quarters {
                        let order = _mm256_loadu_si256(FRONT_WIDE[quarter].as_ptr().cast());
                        let packed = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(from), order);
                        _mm256_storeu_si256(to.cast(), packed);
                        (from, to) = (from.add(1), to.add(8 * quarter.count_ones() as usize));
                    }
                } else {
                    for half in halves {
                        let order = _mm256_loadu_si256(FRONT[half].as_ptr().cast());
                        let packed = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(from), order);
                        _mm256_storeu_si256(to.cast(), packed);
                        (from, to) = (from.add(1), to.add(4 * half.count_ones() as usize));
                    }
                }
            }
        }
    }

    #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
    pub fn pack_512(mask: u32, columns: &[Column<'_>]) {
        let low = (mask & 0xff) as u8;
        for column in columns {
            // SAFETY: as in `pack_256`.
            unsafe {
                let from = column.from.cast::<__m512i>();
                if column.is_wide {
                    let first = _mm512_maskz_compress_epi64(low, _mm512_loadu_si512(from));
                    let second = _mm512_maskz_compress_epi64((mask >> 8) as u8, _mm512_loadu_si512(from.add(1)));
                    _mm512_storeu_si512(column.to.cast(), first);
                    _mm512_storeu_si512(column.to.add(8 * low.count_ones() as usize).cast(), second);
                } else {
                    let packed = _mm512_maskz_compress_epi32(mask as u16, _mm512_loadu_si512(from));
                    _mm512_storeu_si512(column.to.cast(), packed);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survivors_stand_in_front_in_their_order_at_every_level() {
        let single: [f32; 16] = std::array::from_fn(|i| i as f32 + 0.5);
        let word: [u32; 16] = std::array::from_fn(|i| 100 + i as u32);
        let double: [f64; 16] = std::array::from_fn(|i| 0.1 * i as f64);
        let pair: [[u32; 2]; 16] = std::array::from_fn(|i| [i as u32, 7 * i as u32]);
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            for mask in (0..0x10000).step_by(if cfg!(miri) { 4099 } else { 37 }).chain([0xffff]) {
                let (mut a, mut b, mut c, mut d) = ([0.0; 20], [0; 20], [0.0; 20], [[0; 2]; 20]);
                let columns = [
                    Column::new(&single, &mut a[4..]),
                    Column::new(&word, &mut b[..16]),
                    Column::new(&double, &mut c[2..]),
                    Column::new(&pair, &mut d[1..]),
                ];
                pack(level, mask, &columns);
                let lanes = (0..16).filter(|lane| mask >> lane & 1 == 1);
                for (place, lane) in lanes.enumerate() {
                    assert_eq!((a[4 + place], b[place]), (single[lane], word[lane]), "{level:?} {mask:x}");
                    assert_eq!((c[2 + place], d[1 + place]), (double[lane], pair[lane]), "{level:?} {mask:x}");
                }
            }
        }
    }
}
