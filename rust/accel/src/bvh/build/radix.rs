//! A stable parallel radix sort by integer keys (Zagha and Blelloch, "Radix Sort for Vector Multiprocessors", 1991).

use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::ops::Range;

/// Bits per digit.
const DIGIT: u32 = 8;

const DIGITS: usize = 1 << DIGIT;

/// Pairs per parallel task.
const SHARE: usize = 1 << 14;

/// Sort pairs by the lowest `bits` of the first component, stably.
pub fn sort(pairs: &mut Vec<(u64, u32)>, bits: u32, work: Work) -> Result<(), Stopped> {
    let mut other = vec![(0, 0); pairs.len()];
    let steps = work.steps(bits.div_ceil(DIGIT) as usize);
    for shift in (0..bits).step_by(DIGIT as usize) {
        if pass(pairs, &mut other, shift) {
            std::mem::swap(pairs, &mut other);
        }
        steps.did(1)?;
    }
    Ok(())
}

fn digit(key: u64, shift: u32) -> usize {
    (key >> shift) as usize & (DIGITS - 1)
}

/// Distribute the pairs by one digit. Return false, without writing, if all have the same digit.
fn pass(from: &[(u64, u32)], to: &mut [(u64, u32)], shift: u32) -> bool {
    let count = |share: Range<usize>| {
        let mut counts = [0usize; DIGITS];
        from[share].iter().for_each(|&(key, _)| counts[digit(key, shift)] += 1);
        counts
    };
    let counts = parallel::map_chunks(from.len(), SHARE, count);
    if (0..DIGITS).any(|d| counts.iter().map(|c| c[d]).sum::<usize>() == from.len()) {
        return false;
    }
    // The output slices of each task for each digit: by digit, then by task.
    let mut rooms: Vec<Vec<std::slice::IterMut<(u64, u32)>>> =
        counts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
    let mut rest = to;
    for d in 0..DIGITS {
        for (room, counts) in rooms.iter_mut().zip(&counts) {
            let (own, others) = rest.split_at_mut(counts[d]);
            room.push(own.iter_mut());
            rest = others;
        }
    }
    parallel::each_mut(&mut rooms, &|share, room| {
        for &pair in &from[share * SHARE..((share + 1) * SHARE).min(from.len())] {
            let place = room[digit(pair.0, shift)].next().expect("as much room as was counted");
            *place = pair;
        }
    });
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sorted(keys: &[u64], bits: u32) -> Vec<(u64, u32)> {
        let mut pairs: Vec<_> = keys.iter().copied().zip(0..).collect();
        sort(&mut pairs, bits, Work::UNWATCHED).unwrap();
        pairs
    }

    proptest! {
        #[test]
        fn as_the_standard_sort_does_it(keys in prop::collection::vec(prop_oneof![0..1u64 << 63, 0..5u64], 0..600)) {
            let mut wanted: Vec<(u64, u32)> = keys.iter().copied().zip(0..).collect();
            wanted.sort_by_key(|p| p.0);
            prop_assert_eq!(sorted(&keys, 63), wanted);
        }
    }

    #[test]
    fn many_with_any_number_of_threads() {
        let keys: Vec<u64> = (0..200_000u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 34).collect();
        let mut wanted: Vec<(u64, u32)> = keys.iter().copied().zip(0..).collect();
        wanted.sort();
        for threads in [1, 3] {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            assert_eq!(pool.install(|| sorted(&keys, 30)), wanted);
        }
    }
}
