//! A profile of rendering, printed by `benches/shading.py`. Without the feature `timing` it compiles to nothing.

/// The parts of rendering that are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Camera samples and camera rays.
    Camera,
    /// Closest-hit queries.
    Closest,
    /// Shadow rays.
    Shadow,
    /// Sorting paths by material, and light from the environment.
    Arriving,
    /// Surface interactions.
    Surface,
    /// Emission.
    Emission,
    /// BSDFs.
    Scattering,
    /// Light sampling.
    Light,
    /// Continuation of paths.
    Continuation,
    /// Random numbers for these.
    Numbers,
    /// Adding samples to the film.
    Film,
}

impl Part {
    /// All parts with their names.
    pub const ALL: [(Self, &'static str); 11] = [
        (Self::Camera, "camera"),
        (Self::Closest, "closest"),
        (Self::Shadow, "shadow"),
        (Self::Arriving, "arriving"),
        (Self::Surface, "surface"),
        (Self::Emission, "emission"),
        (Self::Scattering, "scattering"),
        (Self::Light, "light"),
        (Self::Continuation, "continuation"),
        (Self::Numbers, "numbers"),
        (Self::Film, "film"),
    ];
}

#[cfg(not(feature = "timing"))]
mod nothing {
    use super::Part;

    /// Run and time some work.
    #[inline(always)]
    pub fn timed<T>(_: Part, work: impl FnOnce() -> T) -> T {
        work()
    }

    /// Count path vertices on surfaces.
    #[inline(always)]
    pub fn count(_vertices: usize) {}
}

#[cfg(feature = "timing")]
mod told {
    use super::Part;
    use std::cell::Cell;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Instant;

    const PARTS: usize = Part::ALL.len();

    /// Nanoseconds by part, and the number of entries and exits, summed over all threads.
    static TOLD: [[AtomicU64; 2]; PARTS] = [const { [const { AtomicU64::new(0) }; 2] }; PARTS];
    static VERTICES: AtomicU64 = AtomicU64::new(0);

    thread_local! {
        /// The current part and its start time.
        static NOW: Cell<Option<(Part, Instant)>> = const { Cell::new(None) };
    }

    /// Switch to another part; return the previous one.
    fn change(to: Option<Part>) -> Option<Part> {
        let now = Instant::now();
        let before = NOW.replace(to.map(|part| (part, now)));
        if let Some(part) = to {
            TOLD[part as usize][1].fetch_add(1, Ordering::Relaxed);
        }
        before.map(|(part, since)| {
            let [spent, looks] = &TOLD[part as usize];
            spent.fetch_add(now.duration_since(since).as_nanos() as u64, Ordering::Relaxed);
            looks.fetch_add(1, Ordering::Relaxed);
            part
        })
    }

    /// Run and time some work, excluding nested parts.
    pub fn timed<T>(part: Part, work: impl FnOnce() -> T) -> T {
        let before = change(Some(part));
        let done = work();
        change(before);
        done
    }

    /// Count path vertices on surfaces.
    pub fn count(vertices: usize) {
        VERTICES.fetch_add(vertices as u64, Ordering::Relaxed);
    }

    /// Return the nanoseconds by part, corrected for clock reads, and the number of vertices since the last call.
    pub fn take() -> ([f64; PARTS], u64) {
        let swapped = |cell: &AtomicU64| cell.swap(0, Ordering::Relaxed) as f64;
        let (told, vertices) =
            (TOLD.each_ref().map(|pair| pair.each_ref().map(swapped)), VERTICES.swap(0, Ordering::Relaxed));
        // Each part contains half of the cost of an entry or exit.
        let (start, looks) = (Instant::now(), 10_000u32);
        (0..looks).for_each(|_| timed(Part::Camera, || ()));
        let of_look = start.elapsed().as_nanos() as f64 / f64::from(2 * looks);
        TOLD.iter().flatten().for_each(|cell| cell.store(0, Ordering::Relaxed));
        (told.map(|[spent, looks]| (spent - 0.5 * looks * of_look).max(0.0)), vertices)
    }
}

#[cfg(not(feature = "timing"))]
pub use nothing::{count, timed};
#[cfg(feature = "timing")]
pub use told::{count, take, timed};
