//! Loops that threads share, compiled once.
//!
//! Rayon's own are compiled anew for each closure, to some thousand lines of intermediate code each time. Where a
//! closure comes in many kinds (one an accelerator, a width, a sort of answer), that is most of what it is compiled to.
//! Here it is called through a pointer.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Calls `work` with each number below `count`, in any order, on the threads of the pool in which it is called.
pub fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(work);
}

/// Calls `work` with each item and its number, in any order, one item at a time. Compiled once a type.
pub fn each_mut<T: Send>(items: &mut [T], work: &(dyn Fn(usize, &mut T) + Sync)) {
    items.par_iter_mut().with_max_len(1).enumerate().for_each(|(i, item)| work(i, item));
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

/// Adds to `made` what `make` gives for each number of a range, in order. Compiled once a type.
pub fn extend<T: Send>(made: &mut Vec<T>, range: Range<usize>, make: &(dyn Fn(usize) -> T + Sync)) {
    made.par_extend(range.into_par_iter().map(make));
}

/// What `make` gives for each number below `count`, in order. Compiled once a type.
pub fn collect<T: Send>(count: usize, make: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
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
        let mut items: Vec<usize> = (0..1000).collect();
        each_mut(&mut items, &|i, item| *item += i);
        assert!(items.iter().enumerate().all(|(i, &item)| item == 2 * i));
    }

    #[test]
    fn what_is_made_is_in_order() {
        for count in [0, 1, 2, 63, 64, 65, 100_003] {
            assert_eq!(collect(count, &|i| i.to_string()), (0..count).map(|i| i.to_string()).collect::<Vec<_>>());
            let mut more = vec![7];
            extend(&mut more, 5..5 + count, &|i| i);
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
        let caught = std::panic::catch_unwind(|| collect(100, &|i| if i == 40 { panic!("from within") } else { i }));
        assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"from within"));
    }
}
