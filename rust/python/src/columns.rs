//! Ray arrays in columns, and their closest hits back in arrays.

use super::arrays::TripleRows;
use super::hit_parts::{HitParts, Rounded, To};
use super::rays::{BATCH, RayArrays};
use raywright::accel::ByColumns;
use raywright::math::coherence::is_coherent;
use raywright::math::ray_sort::{Gathering, RUN, RunBounds, WINDOW};
use raywright::math::{HitColumns, Numbers, PlacedHits, RayColumns, Run, Tiling, Vectors};
use raywright::scene::Geometry;
use raywright::simd::{ask_for, columns_of_four};
use std::cell::Cell;

/// Rays that are asked together, of a chunk of `count`.
#[derive(Clone, Copy)]
struct RayChunk<'a> {
    tiling: Tiling,
    from: usize,
    len: usize,
    count: usize,
    /// Order of runs of neighbors after `window`, if it is neither sequential nor an image's tiling. The remainder of
    /// a window, shorter than a run, is last.
    order: Option<&'a [u16]>,
    window: usize,
}

impl RayChunk<'_> {
    /// Returns whether the order is sequential.
    fn is_sequence(&self) -> bool {
        self.tiling.is_sequence() && self.order.is_none()
    }

    /// Positions in the chunk.
    #[inline(always)]
    fn runs(&self, mut each: impl FnMut(Run)) {
        let Some(order) = self.order else { return self.tiling.runs(self.from, self.len, self.count, each) };
        for (i, &run) in order.iter().enumerate() {
            each(Run { place: self.window + RUN * usize::from(run), at: RUN * i, len: RUN });
        }
        let at = RUN * order.len();
        if at < self.len {
            each(Run { place: self.from + at, at, len: self.len - at });
        }
    }

    /// The place of each run, if the order is not sequential and all runs are of [`PlacedHits::RUN`].
    fn places<'a>(&self, room: &'a mut Vec<usize>) -> Option<&'a [usize]> {
        if self.is_sequence() || !self.len.is_multiple_of(PlacedHits::RUN) {
            return None;
        }
        let places = some(room, self.len / PlacedHits::RUN);
        let mut are_whole = true;
        self.runs(|Run { place, at, len }| {
            are_whole &= len == PlacedHits::RUN && at.is_multiple_of(PlacedHits::RUN);
            places[at / PlacedHits::RUN] = place;
        });
        are_whole.then_some(places)
    }

    /// Gathers values into traversal order.
    #[inline(always)]
    fn read<T: Copy>(&self, from: &[T], to: &mut [T]) {
        self.runs(|Run { place, at, len }| copy(&from[place..][..len], &mut to[at..][..len]));
    }

    /// The same the other way.
    #[inline(always)]
    fn write<T: Copy>(&self, from: &[T], to: &mut [T]) {
        self.runs(|Run { place, at, len }| copy(&from[at..][..len], &mut to[place..][..len]));
    }
}

/// Prefetch distance in rays along a row: four tiles ahead.
const AHEAD: usize = 32;

/// Fewer rays than these are not reordered.
const FEW: usize = 256;

/// Buffers of a thread for rays traced together. They are kept, because allocating them takes as long as many rays.
#[derive(Default)]
struct RayBuffers {
    single: [[Vec<f32>; 3]; 2],
    double: [[Vec<f64>; 3]; 2],
    t_min: Vec<f64>,
    t_max: Vec<f64>,
    answers: Answers,
    gathering: Gathering,
}

/// Buffers for results in traversal order.
#[derive(Default)]
struct Answers {
    t: Vec<f64>,
    uv: Vec<[f64; 2]>,
    shape: Vec<i32>,
    primitive: Vec<i32>,
    first: Vec<u32>,
    found: Vec<bool>,
    places: Vec<usize>,
}

thread_local! {
    static ROOM: Cell<Option<Box<RayBuffers>>> = const { Cell::new(None) };
}

/// Number type of vectors.
trait Coordinate: Copy + Default {
    /// Transposes a run of vectors.
    fn columns(rows: &[[Self; 3]; RUN]) -> [[Self; RUN]; 3];
}

impl Coordinate for f32 {
    #[inline(always)]
    fn columns(rows: &[[f32; 3]; RUN]) -> [[f32; RUN]; 3] {
        columns_of_four(rows)
    }
}

impl Coordinate for f64 {
    #[inline(always)]
    fn columns(rows: &[[f64; 3]; RUN]) -> [[f64; RUN]; 3] {
        [0, 1, 2].map(|axis| [rows[0][axis], rows[1][axis], rows[2][axis], rows[3][axis]])
    }
}

/// Copies numbers, mostly [`RUN`] at a time without a call.
#[inline(always)]
fn copy<T: Copy>(from: &[T], to: &mut [T]) {
    let ((fours, others), (to_fours, to_others)) = (from.as_chunks::<RUN>(), to.as_chunks_mut::<RUN>());
    for (from, to) in fours.iter().zip(to_fours) {
        *to = *from;
    }
    for (from, to) in others.iter().zip(to_others) {
        *to = *from;
    }
}

/// Writes a run of numbers that may be wanted in f32, or not at all.
#[inline(always)]
fn put<T: Rounded>(from: &[T], to: Option<&mut To<'_, T>>, Run { place, at, len }: Run) {
    match to {
        Some(To::Double(to)) => copy(&from[at..][..len], &mut to[place..][..len]),
        Some(To::Single(to)) => {
            for (to, &from) in to[place..][..len].iter_mut().zip(&from[at..][..len]) {
                *to = from.single();
            }
        }
        None => {}
    }
}

/// A buffer of this size, grown if necessary.
fn some<T: Clone + Default>(room: &mut Vec<T>, count: usize) -> &mut [T] {
    if room.len() < count {
        room.resize(count, T::default());
    }
    &mut room[..count]
}

fn spread(rows: TripleRows<'_>) -> RunBounds {
    match rows {
        TripleRows::Single(rows) => RunBounds::of(rows),
        TripleRows::Double(rows) => RunBounds::of(rows),
    }
}

/// Rows of a part of a chunk, transposed.
fn vectors<'a>(
    single: &'a mut [Vec<f32>; 3],
    double: &'a mut [Vec<f64>; 3],
    rows: &TripleRows<'_>,
    start: usize,
    part: &RayChunk<'_>,
) -> Vectors<'a> {
    match rows {
        TripleRows::Single(rows) => Vectors::Single(fill(single, rows, start, part)),
        TripleRows::Double(rows) => Vectors::Double(fill(double, rows, start, part)),
    }
}

fn fill<'a, T: Coordinate>(
    room: &'a mut [Vec<T>; 3],
    rows: &[[T; 3]],
    start: usize,
    part: &RayChunk<'_>,
) -> [&'a [T]; 3] {
    let [x, y, z] = room;
    let (x, y, z) = (some(x, part.len), some(y, part.len), some(z, part.len));
    // One row for all.
    if let [row] = rows {
        for (column, number) in [&mut *x, &mut *y, &mut *z].into_iter().zip(row) {
            column.fill(*number);
        }
        return [x, y, z];
    }
    let rows = &rows[start..];
    part.runs(|Run { place, at, len }| {
        ask_for(rows.as_ptr().wrapping_add(place + AHEAD).cast());
        let (rows, x, y, z) = (&rows[place..][..len], &mut x[at..][..len], &mut y[at..][..len], &mut z[at..][..len]);
        let (fours, others) = rows.as_chunks::<RUN>();
        let to = x.as_chunks_mut().0.iter_mut().zip(y.as_chunks_mut().0).zip(z.as_chunks_mut().0);
        for (four, ((x, y), z)) in fours.iter().zip(to) {
            [*x, *y, *z] = T::columns(four);
        }
        for (i, &row) in (len - others.len()..).zip(others) {
            [x[i], y[i], z[i]] = row;
        }
    });
    [x, y, z]
}

/// Numbers of a part of a chunk; `room` holds them if they are reordered.
fn numbers<'a>(all: &'a [f64], start: usize, part: &RayChunk<'_>, room: &'a mut Vec<f64>) -> Numbers<'a> {
    if let [one] = all {
        return Numbers::One(*one);
    }
    let all = &all[start..];
    if part.is_sequence() {
        return Numbers::Each(&all[part.from..][..part.len]);
    }
    let room = some(room, part.len);
    part.read(all, room);
    Numbers::Each(room)
}

impl RayArrays<'_> {
    /// Calls `answer` with up to [`BATCH`] rays at a time of the `count` from `start` on, with their positions and with
    /// buffers.
    fn columns(
        &self,
        tree: &dyn ByColumns,
        start: usize,
        count: usize,
        mut answer: impl FnMut(&RayColumns<'_>, &RayChunk<'_>, &mut Answers),
    ) {
        let mut room = ROOM.take().unwrap_or_default();
        for window in (0..count).step_by(WINDOW) {
            let end = count.min(window + WINDOW);
            let RayBuffers { single: [o, d], double: [long_o, long_d], t_min, t_max, answers, gathering } = &mut *room;
            let order = self.gather_near(tree, start + window, end - window, gathering);
            for from in (window..end).step_by(BATCH) {
                let len = BATCH.min(end - from);
                let order = order.map(|order| &order[(from - window) / RUN..][..len / RUN]);
                let part = RayChunk { tiling: self.tiling, from, len, count, order, window };
                let rays = RayColumns::new(
                    vectors(o, long_o, &self.origins, start, &part),
                    vectors(d, long_d, &self.directions, start, &part),
                    numbers(self.t_min, start, &part, t_min),
                    numbers(self.t_max, start, &part, t_max),
                );
                answer(&rays, &part, answers);
            }
        }
        ROOM.set(Some(room));
    }

    /// A coherent order of some rays, if reordering pays off.
    fn gather_near<'a>(
        &self,
        tree: &dyn ByColumns,
        start: usize,
        count: usize,
        to: &'a mut Gathering,
    ) -> Option<&'a [u16]> {
        let extent = tree.extent()?;
        let one = |rows: TripleRows<'_>, i: usize| rows.get(if rows.len() == 1 { 0 } else { start + i });
        let ray = |i: usize| (one(self.origins, i), one(self.directions, i));
        if !self.tiling.is_sequence() || count < FEW || !is_coherent(count, ray, extent) {
            return None;
        }
        let (from, towards) = (self.origins.some(start, count), self.directions.some(start, count));
        let (origins, directions) = (spread(from), spread(towards));
        let (far, wide) = (origins.over(Some(extent)), directions.over(None));
        let (rows, spread, size) = if far >= wide { (from, origins, far) } else { (towards, directions, wide) };
        if !(size > 0.0 && size < f32::INFINITY) {
            return None;
        }
        Some(match rows {
            TripleRows::Single(rows) => to.of(rows, &spread),
            TripleRows::Double(rows) => to.of(rows, &spread),
        })
    }

    /// The closest hits of the rays from `start` on, of which there are as many as there is room for.
    pub fn closest(&self, geometry: &Geometry, tree: &dyn ByColumns, start: usize, mut to: HitParts<'_>) {
        self.columns(tree, start, to.count, |rays, part, room| {
            let has_one_shape = geometry.shapes() == 1;
            if let HitParts {
                t: Some(To::Double(t)), uv: Some(To::Double(uv)), primitive: Some(primitive), shape, ..
            } = &mut to
                && has_one_shape
                && let Some(places) = part.places(&mut room.places)
            {
                let shape = shape.as_deref_mut();
                return tree.intersect_placed(rays, PlacedHits { t, uv, primitive, shape, places });
            }
            let (is_direct, len, here) = (part.is_sequence(), part.len, part.from..part.from + part.len);
            let primitives = match &mut to.primitive {
                Some(to) if is_direct => &mut to[here.clone()],
                _ => some(&mut room.primitive, len),
            };
            if to.t.is_none() && to.uv.is_none() {
                let first = some(&mut room.first, len);
                tree.first_primitives(rays, first);
                for (to, &first) in primitives.iter_mut().zip(&*first) {
                    *to = first as i32;
                }
            } else {
                let t = match &mut to.t {
                    Some(To::Double(to)) if is_direct => &mut to[here.clone()],
                    _ => some(&mut room.t, len),
                };
                let uv = match &mut to.uv {
                    Some(To::Double(to)) if is_direct => &mut to[here.clone()],
                    _ => some(&mut room.uv, len),
                };
                tree.intersect(rays, HitColumns { t, uv, primitive: primitives });
            }
            if !has_one_shape {
                let shapes = match &mut to.shape {
                    Some(to) if is_direct => &mut to[here.clone()],
                    _ => some(&mut room.shape, len),
                };
                for (shape, primitive) in shapes.iter_mut().zip(&mut *primitives) {
                    (*shape, *primitive) = located(geometry, *primitive);
                }
            } else if let Some(to) = to.shape.as_mut().filter(|_| is_direct) {
                only_shape(primitives, &mut to[here.clone()]);
            }
            // All parts of a run together, as they find the places of a tile only once.
            part.runs(|run| {
                let Run { place, at, len } = run;
                put(&room.t, to.t.as_mut().filter(|to| !is_direct || to.is_single()), run);
                put(&room.uv, to.uv.as_mut().filter(|to| !is_direct || to.is_single()), run);
                if is_direct {
                    return;
                }
                if let Some(to) = &mut to.primitive {
                    copy(&room.primitive[at..][..len], &mut to[place..][..len]);
                }
                match &mut to.shape {
                    Some(to) if has_one_shape => only_shape(&room.primitive[at..][..len], &mut to[place..][..len]),
                    Some(to) => copy(&room.shape[at..][..len], &mut to[place..][..len]),
                    None => {}
                }
            });
        });
    }

    /// Occlusion of the rays from `start` on, as many as `to` has room for.
    pub fn occluded(&self, tree: &dyn ByColumns, start: usize, to: &mut [bool]) {
        self.columns(tree, start, to.len(), |rays, part, room| {
            if part.is_sequence() {
                return tree.occluded(rays, &mut to[part.from..][..part.len]);
            }
            let found = some(&mut room.found, part.len);
            tree.occluded(rays, found);
            part.write(found, to);
        });
    }
}

/// Shape and primitive number within it; −1 for none.
#[inline(always)]
fn located(geometry: &Geometry, primitive: i32) -> (i32, i32) {
    if primitive < 0 {
        return (-1, -1);
    }
    let (shape, primitive) = geometry.locate(primitive as u32);
    (shape as i32, primitive as i32)
}

/// The shapes of primitives in a scene of one: 0, or −1 for none.
#[inline(always)]
fn only_shape(primitive: &[i32], shape: &mut [i32]) {
    for (shape, &primitive) in shape.iter_mut().zip(primitive) {
        *shape = primitive >> 31;
    }
}
