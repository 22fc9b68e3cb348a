//! Mailboxes, which avoid testing a ray twice against a primitive that is in several leaves.

use std::sync::Mutex;

/// Kinds of mailboxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mailbox {
    /// No mailbox: tests are repeated, without effect on the results.
    None,
    /// A stamp per primitive, with the last ray that tested it (Amanatides and Woo, "A Fast Voxel Traversal Algorithm
    /// for Ray Tracing", 1987). Nothing is decided twice.
    #[default]
    Stamps,
    /// A small hash table of recently tested primitives (Benthin, "Realtime Ray Tracing on Current CPU Architectures",
    /// 2006). It fits into the L1 cache, and forgets.
    Cache,
}

/// Entries of the hash table.
const ENTRIES: usize = 64;

/// The primitives already tested for the current ray.
#[derive(Debug)]
pub struct Marks {
    /// By primitive or its hash: the ray's number, and in the cache the primitive's, too.
    stamps: Vec<u64>,
    kind: Mailbox,
    ray: u32,
}

impl Marks {
    fn new(kind: Mailbox, primitives: usize) -> Self {
        let entries = match kind {
            Mailbox::None => 0,
            Mailbox::Stamps => primitives,
            Mailbox::Cache => ENTRIES,
        };
        Self { stamps: vec![0; entries], kind, ray: 0 }
    }

    /// Start the next ray.
    #[inline(always)]
    pub fn next_ray(&mut self) {
        self.ray = self.ray.wrapping_add(1);
        if self.ray == 0 {
            self.stamps.fill(0);
            self.ray = 1;
        }
    }

    /// Return whether the primitive is new to the ray, as far as is known; mark it as tested.
    #[inline(always)]
    pub fn is_new(&mut self, primitive: u32) -> bool {
        let (entry, stamp) = match self.kind {
            Mailbox::None => return true,
            Mailbox::Stamps => (primitive as usize, u64::from(self.ray)),
            Mailbox::Cache => (primitive as usize % ENTRIES, u64::from(self.ray) << 32 | u64::from(primitive)),
        };
        std::mem::replace(&mut self.stamps[entry], stamp) != stamp
    }
}

/// A pool of marks, one per active batch: stamps are large, and are not cleared for every batch.
#[derive(Debug)]
pub struct Mailboxes {
    free: Mutex<Vec<Marks>>,
    kind: Mailbox,
    primitives: usize,
}

impl Mailboxes {
    /// A pool for the given number of primitives.
    pub fn new(kind: Mailbox, primitives: usize) -> Self {
        Self { free: Mutex::new(Vec::new()), kind, primitives }
    }

    /// A pool of the same kind and size.
    pub fn another(&self) -> Self {
        Self::new(self.kind, self.primitives)
    }

    /// Run `work` with marks from the pool.
    pub fn with<T>(&self, work: impl FnOnce(&mut Marks) -> T) -> T {
        let free = || self.free.lock().expect("nobody panics here");
        let found = free().pop();
        let mut marks = found.unwrap_or_else(|| Marks::new(self.kind, self.primitives));
        let done = work(&mut marks);
        free().push(marks);
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_know_all_and_the_cache_the_last() {
        let numbers = [5, 5, 69, 5, 6, 6];
        for (kind, wanted) in [
            (Mailbox::None, [true; 6]),
            (Mailbox::Stamps, [true, false, true, false, true, false]),
            (Mailbox::Cache, [true, false, true, true, true, false]),
        ] {
            let boxes = Mailboxes::new(kind, 100);
            for _ in 0..3 {
                boxes.with(|marks| {
                    for _ in 0..3 {
                        marks.next_ray();
                        assert_eq!(numbers.map(|p| marks.is_new(p)), wanted, "{kind:?}");
                    }
                });
            }
        }
    }

    #[test]
    fn after_all_numbers_of_rays_stamps_begin_anew() {
        let mut marks = Marks::new(Mailbox::Stamps, 3);
        marks.next_ray();
        assert!(marks.is_new(2));
        marks.ray = u32::MAX;
        marks.next_ray();
        assert!(marks.is_new(2) && !marks.is_new(2));
    }
}
