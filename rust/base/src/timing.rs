//! Where the time of a picture goes, for those who work on it: `benches/shading.py` tells it. Without the feature
//! `timing` there is nothing of it in what is compiled.

/// What the time of a picture goes into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Samples of the camera, and its rays.
    Camera,
    /// Rays to what they meet first.
    Closest,
    /// Rays to lights.
    Shadow,
    /// Paths are sorted by what they have come to, and light from outside is added.
    Arriving,
    /// What is known of the surfaces there.
    Surface,
    /// What they emit.
    Emission,
    /// What scatters there.
    Scattering,
    /// Light that is asked for.
    Light,
    /// Where paths go on to.
    Continuation,
    /// Random numbers for these.
    Numbers,
    /// Samples are added to the film.
    Film,
}

impl Part {
    /// Every one, with its name.
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

    /// Does some work, of which the time is told.
    #[inline(always)]
    pub fn timed<T>(_: Part, work: impl FnOnce() -> T) -> T {
        work()
    }

    /// Counts surfaces that paths have come to.
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

    /// Of all threads, nanoseconds by part, and how often it was begun or left.
    static TOLD: [[AtomicU64; 2]; PARTS] = [const { [const { AtomicU64::new(0) }; 2] }; PARTS];
    static VERTICES: AtomicU64 = AtomicU64::new(0);

    thread_local! {
        /// What is being done, and since when.
        static NOW: Cell<Option<(Part, Instant)>> = const { Cell::new(None) };
    }

    /// Changes to another part, and says which it was.
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

    /// Does some work, of which the time is told: that of parts within it is theirs.
    pub fn timed<T>(part: Part, work: impl FnOnce() -> T) -> T {
        let before = change(Some(part));
        let done = work();
        change(before);
        done
    }

    /// Counts surfaces that paths have come to.
    pub fn count(vertices: usize) {
        VERTICES.fetch_add(vertices as u64, Ordering::Relaxed);
    }

    /// Nanoseconds by part, less what looking at the clock takes, and vertices, since this was last asked.
    pub fn take() -> ([f64; PARTS], u64) {
        let swapped = |cell: &AtomicU64| cell.swap(0, Ordering::Relaxed) as f64;
        let (told, vertices) =
            (TOLD.each_ref().map(|pair| pair.each_ref().map(swapped)), VERTICES.swap(0, Ordering::Relaxed));
        // Each part has half of what it takes to begin or to leave one.
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
