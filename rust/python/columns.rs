//! Rays of arrays by columns, and their closest hits back to arrays.

use super::arrays::Rows;
use super::rays::{BATCH, RayArrays};
use crate::accel::ByColumns;
use crate::math::{HitColumns, Numbers, RayColumns, Vectors};
use crate::scene::Geometry;
use crate::simd::columns_of_four;

/// Where t, shape_id, primitive and uv of some rays are written.
pub type HitParts<'a> = (&'a mut [f64], &'a mut [i32], &'a mut [i32], &'a mut [[f64; 2]]);

/// Which of a chunk's rays are asked together.
#[derive(Clone, Copy)]
pub enum Places<'a> {
    /// Neighbours, from one on.
    From(usize),
    /// These, in this order.
    At(&'a [usize]),
}

/// Room for vectors by axis.
enum Room {
    Single([Vec<f32>; 3]),
    Double([Vec<f64>; 3]),
}

impl Room {
    /// For so many of some rows.
    fn new(rows: &Rows<'_>, count: usize) -> Self {
        match rows {
            Rows::Single(_) => Self::Single([0; 3].map(|_| vec![0.0; count])),
            Rows::Double(_) => Self::Double([0; 3].map(|_| vec![0.0; count])),
        }
    }

    /// The rows that lie at some places after `start`, by axis.
    fn fill(&mut self, rows: &Rows<'_>, start: usize, count: usize, places: Places<'_>) -> Vectors<'_> {
        match (self, rows) {
            (Self::Single(room), Rows::Single(rows)) => Vectors::Single(fill(room, rows, start, count, places)),
            (Self::Double(room), Rows::Double(rows)) => Vectors::Double(fill(room, rows, start, count, places)),
            _ => unreachable!("room was made for these rows"),
        }
    }
}

/// Numbers that vectors are made of.
trait Coordinate: Copy {
    /// Some neighbours by axis.
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

/// The first `count` of each column, filled with the rows at some places.
fn fill<'a, T: Coordinate>(
    room: &'a mut [Vec<T>; 3],
    rows: &[[T; 3]],
    start: usize,
    count: usize,
    places: Places<'_>,
) -> [&'a [T]; 3] {
    let [x, y, z] = room;
    let (x, y, z) = (&mut x[..count], &mut y[..count], &mut z[..count]);
    // One that serves for all.
    if let [row] = rows {
        for (column, number) in [&mut *x, &mut *y, &mut *z].into_iter().zip(row) {
            column.fill(*number);
        }
        return [x, y, z];
    }
    let rows = &rows[start..];
    let runs = x.as_chunks_mut::<RUN>().0.iter_mut().zip(y.as_chunks_mut::<RUN>().0).zip(z.as_chunks_mut::<RUN>().0);
    for (at, ((x, y), z)) in runs.enumerate() {
        let from = match places {
            Places::From(from) => Some(from + at * RUN),
            Places::At(places) => run(&places[at * RUN..][..RUN]),
        };
        if let Some(from) = from {
            [*x, *y, *z] = T::columns(rows[from..].first_chunk().expect("places of rows"));
        } else if let Places::At(places) = places {
            for (i, &place) in places[at * RUN..][..RUN].iter().enumerate() {
                [x[i], y[i], z[i]] = rows[place];
            }
        }
    }
    for i in count / RUN * RUN..count {
        let place = match places {
            Places::From(from) => from + i,
            Places::At(places) => places[i],
        };
        [x[i], y[i], z[i]] = rows[place];
    }
    [x, y, z]
}

/// Neighbours of a tile that are neighbours in the arrays, too.
const RUN: usize = 4;

/// Where so many places begin that are one after the other, if they are.
#[inline(always)]
fn run(places: &[usize]) -> Option<usize> {
    let places: &[usize; RUN] = places.try_into().ok()?;
    let is_run = places[1] == places[0] + 1 && places[2] == places[0] + 2 && places[3] == places[0] + 3;
    is_run.then_some(places[0])
}

/// The numbers at some places after `start`; `room` holds them where they are not neighbours.
fn numbers<'a>(all: &'a [f64], start: usize, count: usize, places: Places<'_>, room: &'a mut Vec<f64>) -> Numbers<'a> {
    match places {
        _ if all.len() == 1 => Numbers::One(all[0]),
        Places::From(from) => Numbers::Each(&all[start + from..][..count]),
        Places::At(places) => {
            room.clear();
            room.extend(places[..count].iter().map(|&place| all[start + place]));
            Numbers::Each(room)
        }
    }
}

impl RayArrays<'_> {
    /// Calls `answer` with up to [`BATCH`] rays at a time of the `count` from `start` on, and with where they lie among
    /// them.
    fn columns(&self, start: usize, count: usize, mut answer: impl FnMut(&RayColumns<'_>, Places<'_>)) {
        let some = BATCH.min(count);
        let (mut origins, mut directions) = (Room::new(&self.origins, some), Room::new(&self.directions, some));
        let (mut nears, mut fars) = (Vec::new(), Vec::new());
        let mut order = vec![0; if self.tiling.is_sequence() { 0 } else { some }];
        for from in (0..count).step_by(BATCH) {
            let some = BATCH.min(count - from);
            let places = if self.tiling.is_sequence() {
                Places::From(from)
            } else {
                self.tiling.places(from, count, &mut order[..some]);
                Places::At(&order[..some])
            };
            let rays = RayColumns::new(
                origins.fill(&self.origins, start, some, places),
                directions.fill(&self.directions, start, some, places),
                numbers(self.t_min, start, some, places, &mut nears),
                numbers(self.t_max, start, some, places, &mut fars),
            );
            answer(&rays, places);
        }
    }

    /// The closest hits of the rays from `start` on, of which there are as many as there is room for.
    pub fn closest(&self, geometry: &Geometry, tree: &dyn ByColumns, start: usize, to: HitParts<'_>) {
        let (t, shape, primitive, uv) = to;
        let count = t.len();
        let scattered = if self.tiling.is_sequence() { 0 } else { BATCH.min(count) };
        let (mut ts, mut uvs) = (vec![0.0; scattered], vec![[0.0; 2]; scattered]);
        let (mut shapes, mut primitives) = (vec![0; scattered], vec![0; scattered]);
        self.columns(start, count, |rays, places| match places {
            Places::From(from) => {
                let here = from..from + rays.len();
                let (t, uv, primitive) = (&mut t[here.clone()], &mut uv[here.clone()], &mut primitive[here.clone()]);
                tree.intersect(rays, HitColumns { t, uv, primitive });
                locate(geometry, &mut shape[here], primitive);
            }
            Places::At(places) => {
                let count = rays.len();
                let (ts, uvs, primitives) = (&mut ts[..count], &mut uvs[..count], &mut primitives[..count]);
                tree.intersect(rays, HitColumns { t: ts, uv: uvs, primitive: primitives });
                locate(geometry, &mut shapes[..count], primitives);
                for at in (0..count).step_by(RUN) {
                    let places = &places[at..count.min(at + RUN)];
                    if let Some(to) = run(places) {
                        t[to..][..RUN].copy_from_slice(&ts[at..][..RUN]);
                        uv[to..][..RUN].copy_from_slice(&uvs[at..][..RUN]);
                        shape[to..][..RUN].copy_from_slice(&shapes[at..][..RUN]);
                        primitive[to..][..RUN].copy_from_slice(&primitives[at..][..RUN]);
                        continue;
                    }
                    for (i, &place) in (at..).zip(places) {
                        (t[place], uv[place]) = (ts[i], uvs[i]);
                        (shape[place], primitive[place]) = (shapes[i], primitives[i]);
                    }
                }
            }
        });
    }

    /// Whether the rays from `start` on hit anything, of which there are as many as there is room for.
    pub fn occluded(&self, tree: &dyn ByColumns, start: usize, to: &mut [bool]) {
        let count = to.len();
        let mut found = vec![false; if self.tiling.is_sequence() { 0 } else { BATCH.min(count) }];
        self.columns(start, count, |rays, places| match places {
            Places::From(from) => tree.occluded(rays, &mut to[from..][..rays.len()]),
            Places::At(places) => {
                let found = &mut found[..rays.len()];
                tree.occluded(rays, found);
                for at in (0..found.len()).step_by(RUN) {
                    let places = &places[at..found.len().min(at + RUN)];
                    if let Some(from) = run(places) {
                        to[from..][..RUN].copy_from_slice(&found[at..][..RUN]);
                        continue;
                    }
                    for (&place, &found) in places.iter().zip(&found[at..]) {
                        to[place] = found;
                    }
                }
            }
        });
    }
}

/// The shape of a primitive and its number there; −1 for none.
#[inline(always)]
fn located(geometry: &Geometry, primitive: i32) -> (i32, i32) {
    if primitive < 0 {
        return (-1, -1);
    }
    let (shape, primitive) = geometry.locate(primitive as u32);
    (shape as i32, primitive as i32)
}

/// Takes primitives as numbered among all to the shapes that they are of.
fn locate(geometry: &Geometry, shape: &mut [i32], primitive: &mut [i32]) {
    if geometry.shapes() == 1 {
        for (shape, &primitive) in shape.iter_mut().zip(&*primitive) {
            // 0, or −1 where there is none.
            *shape = primitive >> 31;
        }
        return;
    }
    for (shape, primitive) in shape.iter_mut().zip(primitive) {
        (*shape, *primitive) = located(geometry, *primitive);
    }
}
