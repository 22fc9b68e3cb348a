//! Parallel loops.
//!
//! Rayon compiles its loops anew for each closure, to some thousand lines of intermediate code each time. These
//! functions are compiled once, or once per type: closures are called through pointers, one call per chunk of work. A
//! call costs some 50 ns with the splitting, so a chunk should take microseconds.
//!
//! Chunks have a given size, and results are in the order of the chunks. So nothing depends on the number of threads.

use rayon::prelude::*;
use std::array::from_fn;
use std::ops::Range;

/// Items per chunk for work of some 10 ns per item.
pub const CHUNK: usize = 4096;

/// Return the number of threads of the current pool.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// Call both, possibly at the same time, and return both results.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    let (mut a, mut b, mut of_a, mut of_b) = (Some(a), Some(b), None, None);
    both(&mut || of_a = a.take().map(|a| a()), &mut || of_b = b.take().map(|b| b()));
    (of_a.expect("both were called"), of_b.expect("both were called"))
}

/// Call `work` with each number below `count`, one at a time and in any order.
pub fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    fn part(range: Range<usize>, work: &(dyn Fn(usize) + Sync)) {
        if range.len() > 1 {
            let middle = range.start + range.len() / 2;
            both(&mut || part(range.start..middle, work), &mut || part(middle..range.end, work));
        } else if !range.is_empty() {
            work(range.start);
        }
    }
    part(0..count, work);
}

/// Call `work` with each item and its number, one at a time and in any order.
pub fn each_mut<T: Send>(items: &mut [T], work: &(dyn Fn(usize, &mut T) + Sync)) {
    each_chunk_mut(items, 1, &|i, item| work(i, &mut item[0]));
}

/// Call `work` with each chunk of `size` items and the index of its first item, in any order.
pub fn each_chunk_mut<T: Send>(items: &mut [T], size: usize, work: &(dyn Fn(usize, &mut [T]) + Sync)) {
    fn part<T: Send>(first: usize, items: &mut [T], size: usize, work: &(dyn Fn(usize, &mut [T]) + Sync)) {
        if items.len() > size {
            let (left, right) = items.split_at_mut(items.len().div_ceil(size) / 2 * size);
            let middle = first + left.len();
            both(&mut || part(first, left, size, work), &mut || part(middle, right, size, work));
        } else if !items.is_empty() {
            work(first, items);
        }
    }
    part(0, items, size, work);
}

/// Return the results of `work` for each number below `count`, which are computed one at a time.
pub fn map<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    each_mut(&mut results, &|i, result| *result = Some(work(i)));
    results.into_iter().map(|result| result.expect("all were computed")).collect()
}

/// Return the results of `work` for each chunk of `size` numbers below `count`.
pub fn map_chunks<T: Send>(count: usize, size: usize, work: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    map(count.div_ceil(size), |chunk| work(chunk * size..((chunk + 1) * size).min(count)))
}

/// Return the results of `work` for each of the parts, which are consumed one at a time.
pub fn map_parts<P: Send, T: Send>(parts: Vec<P>, work: impl Fn(P) -> T + Sync) -> Vec<T> {
    let mut slots: Vec<(Option<P>, Option<T>)> = parts.into_iter().map(|part| (Some(part), None)).collect();
    each_mut(&mut slots, &|_, (part, result)| *result = part.take().map(&work));
    slots.into_iter().map(|(_, result)| result.expect("all were computed")).collect()
}

/// Return the items that `make` returns for each number below `count`. Items may be cheap: they are made in blocks, in
/// place. [`Work::collect`](super::work::Work::collect) does the same and can be canceled.
pub fn collect<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut blocks = Blocks::new(count);
    blocks.extend(0..count, &make);
    blocks.finish(&make)
}

/// Sort keys.
pub fn sort(keys: &mut [u64]) {
    keys.par_sort_unstable();
}

/// Call both, possibly at the same time. All parallelism uses this function, except [`Blocks`] and [`sort`].
#[inline(never)]
fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    rayon::join(a, b);
}

/// Items per block.
const BLOCK: usize = 32;

/// Items under construction: whole blocks, and a remainder at the end.
pub(crate) struct Blocks<T> {
    blocks: Vec<[T; BLOCK]>,
    count: usize,
}

impl<T: Send> Blocks<T> {
    /// Reserve space for `count` items.
    pub fn new(count: usize) -> Self {
        Self { blocks: Vec::with_capacity(count.div_ceil(BLOCK)), count }
    }

    /// Make the whole blocks of a range of items that starts at the end of the last one, at the start of a block.
    pub fn extend(&mut self, range: Range<usize>, make: &(impl Fn(usize) -> T + Sync)) {
        fn extend<B: Send>(blocks: &mut Vec<B>, range: Range<usize>, make: &(dyn Fn(usize) -> B + Sync)) {
            blocks.par_extend(range.into_par_iter().map(make));
        }
        let blocks = range.start / BLOCK..range.end / BLOCK;
        extend(&mut self.blocks, blocks, &|block| from_fn(|i| make(block * BLOCK + i)));
    }

    /// Make the remainder, and return all items.
    pub fn finish(self, make: &impl Fn(usize) -> T) -> Vec<T> {
        let mut items = self.blocks.into_flattened();
        items.extend((items.len()..self.count).map(make));
        items
    }
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
    fn chunks_are_of_one_size_and_come_once() {
        for (count, size) in [(0, 1), (1, 1), (1, 7), (6, 7), (7, 7), (8, 7), (1000, 7), (1000, 1001)] {
            let mut items = vec![0; count];
            each_chunk_mut(&mut items, size, &|first, chunk| {
                assert!(first % size == 0 && chunk.len() == size.min(count - first));
                chunk.iter_mut().zip(first..).for_each(|(item, i)| *item += i);
            });
            assert_eq!(items, (0..count).collect::<Vec<_>>());
            let chunks = map_chunks(count, size, |range| range);
            assert!(chunks.iter().all(|chunk| chunk.len() == size.min(count - chunk.start)));
            assert_eq!(chunks.into_iter().flatten().collect::<Vec<_>>(), items);
        }
    }

    #[test]
    fn what_is_made_is_in_order() {
        let (most, keys) = if cfg!(miri) { (75, 200) } else { (100_003, 10_000) };
        for count in [0, 1, 2, 31, 32, 33, most] {
            let wanted: Vec<_> = (0..count).map(|i| i.to_string()).collect();
            assert_eq!(collect(count, |i| i.to_string()), wanted);
            assert_eq!(map(count, |i| i.to_string()), wanted);
            assert_eq!(map_parts(wanted.clone(), |part| part + "."), map(count, |i| format!("{i}.")));
        }
        let mut keys: Vec<u64> = (0..keys).map(|i| i * 7919 % 10_007).collect();
        sort(&mut keys);
        assert!(keys.is_sorted());
        assert_eq!(join(|| 1, || "two"), (1, "two"));
    }

    #[test]
    fn panics_come_through() {
        let fail = |i: usize| if i == 40 { panic!("from within") } else { i };
        type Loop = fn(&(dyn Fn(usize) -> usize + Sync));
        let all: [Loop; 5] = [
            |fail| drop(collect(100, fail)),
            |fail| drop(map(100, fail)),
            |fail| drop(map_parts((0..100).collect(), fail)),
            |fail| each(100, &|i| assert!(fail(i) < 100)),
            |fail| assert!(join(|| fail(1), || fail(40)).0 < 40),
        ];
        for all in all {
            let caught = std::panic::catch_unwind(|| all(&fail));
            assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"from within"));
        }
    }
}
