//! Loops whose rounds threads share out, compiled once.
//!
//! Rayon's own are compiled anew for each closure, and take some hundred kilobytes of intermediate code each time.
//! Where a closure comes in many kinds (one an accelerator, a width, a sort of answer), that is most of what it is
//! compiled to. Here it is called through a pointer, some microseconds of work at a time.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Shares of a loop for each thread, where its rounds are even: so many that those who are done early find another.
const SHARES: usize = 16;

/// Rounds of an even loop that a thread takes at a time, at most.
const LARGEST: usize = 4096;

/// Calls `work` with each number below `count`, in any order, on the threads of the pool in which it is called.
pub fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(work);
}

/// What `work` makes of each of the parts, in their order. Parts are taken one at a time.
pub fn of_parts<P: Send, T: Send>(parts: Vec<P>, work: impl Fn(P) -> T + Sync) -> Vec<T> {
    let parts: Vec<_> = parts.into_iter().map(|part| Mutex::new((Some(part), None))).collect();
    each(parts.len(), &|i| {
        let mut slot = parts[i].lock().unwrap_or_else(PoisonError::into_inner);
        let part = slot.0.take().expect("each number comes once");
        slot.1 = Some(work(part));
    });
    let made = |slot: Mutex<(_, Option<T>)>| slot.into_inner().unwrap_or_else(PoisonError::into_inner).1;
    parts.into_iter().map(|slot| made(slot).expect("all were called")).collect()
}

/// Adds to `made` what `make` gives for each number of a range, in order. All take about as long, and not long.
pub fn extend<T: Send>(made: &mut Vec<T>, range: Range<usize>, make: impl Fn(usize) -> T + Sync) {
    let count = range.len();
    made.reserve(count);
    let share = count.div_ceil(SHARES * rayon::current_num_threads()).clamp(1, LARGEST);
    let places = &mut made.spare_capacity_mut()[..count];
    let shares: Vec<_> = places.chunks_mut(share).map(Mutex::new).collect();
    each(shares.len(), &|i| {
        let mut places = shares[i].lock().unwrap_or_else(PoisonError::into_inner);
        let first = range.start + i * share;
        for (place, number) in places.iter_mut().zip(first..) {
            place.write(make(number));
        }
    });
    drop(shares);
    // SAFETY: room for so many was reserved, and `each` has come to all shares, which together are all places. Had one
    // panicked, it would not have come here, and what was written would only not be dropped.
    unsafe { made.set_len(made.len() + count) };
}

/// What `make` gives for each number below `count`, in order. All take about as long, and not long.
pub fn collect<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut made = Vec::new();
    extend(&mut made, 0..count, make);
    made
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

    #[test]
    fn each_number_comes_once() {
        let seen: Vec<_> = (0..1000).map(|_| AtomicU32::new(0)).collect();
        each(seen.len(), &|i| {
            seen[i].fetch_add(1, Relaxed);
        });
        assert!(seen.iter().all(|n| n.load(Relaxed) == 1));
        each(0, &|_| panic!("there is none"));
    }

    #[test]
    fn what_is_made_is_in_order() {
        for count in [0, 1, 2, 63, 64, 65, 100_003] {
            assert_eq!(collect(count, |i| i.to_string()), (0..count).map(|i| i.to_string()).collect::<Vec<_>>());
            let mut more = vec![7];
            extend(&mut more, 5..5 + count, |i| i);
            assert_eq!(more, std::iter::once(7).chain(5..5 + count).collect::<Vec<_>>());
        }
        let parts: Vec<String> = (0..100).map(|i| i.to_string()).collect();
        assert_eq!(
            of_parts(parts.clone(), |part| part + "."),
            parts.iter().map(|p| format!("{p}.")).collect::<Vec<_>>()
        );
    }

    #[test]
    fn panics_come_through() {
        let caught = std::panic::catch_unwind(|| collect(100, |i| if i == 40 { panic!("from within") } else { i }));
        assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"from within"));
    }
}
