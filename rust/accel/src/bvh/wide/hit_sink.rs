//! Outputs of first-hit and occlusion queries.

use raywright_base::math::{Hit, HitColumns, Ray};
use raywright_shapes::triangle::{Column, Met, RAYS};

/// An output of hits.
pub trait Answer {
    /// True if any hit will do.
    const ANY: bool;

    /// The output for primitives, if nothing else about hits is needed; then the rest is not computed.
    #[inline(always)]
    fn primitives(&mut self) -> Option<&mut [u32]> {
        None
    }

    /// Store a miss of ray `i`.
    fn miss(&mut self, i: usize);

    /// Store a hit of ray `i`, with `t` in lengths of its own direction.
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32);

    /// Store the results of up to sixteen consecutive rays from `start`: hits for those in `hits`, misses for the
    /// others.
    #[inline(always)]
    fn some(&mut self, start: usize, count: usize, hits: u32, all: &Met, primitives: &Column<u32>) {
        for i in 0..count.min(RAYS) {
            if hits >> i & 1 == 1 {
                self.hit(start + i, all.t[i], [all.uv[0][i], all.uv[1][i]], primitives[i]);
            } else {
                self.miss(start + i);
            }
        }
    }
}

impl Answer for &mut [Hit] {
    const ANY: bool = false;

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        self[i] = Hit::MISS;
    }

    #[inline(always)]
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32) {
        self[i] = Hit { t, uv, primitive, inner: 0 };
    }
}

impl Answer for HitColumns<'_> {
    const ANY: bool = false;

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        (self.t[i], self.uv[i], self.primitive[i]) = (Hit::MISS.t, Hit::MISS.uv, -1);
    }

    #[inline(always)]
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32) {
        (self.t[i], self.uv[i], self.primitive[i]) = (t, uv, primitive as i32);
    }

    #[inline(always)]
    fn some(&mut self, start: usize, count: usize, hits: u32, all: &Met, primitives: &Column<u32>) {
        let (t, uv) = (&mut self.t[start..][..count], &mut self.uv[start..][..count]);
        let primitive = &mut self.primitive[start..][..count];
        for i in 0..count.min(RAYS) {
            let is_hit = hits >> i & 1 == 1;
            t[i] = if is_hit { all.t[i] } else { Hit::MISS.t };
            uv[i][0] = if is_hit { all.uv[0][i] } else { Hit::MISS.uv[0] };
            uv[i][1] = if is_hit { all.uv[1][i] } else { Hit::MISS.uv[1] };
            primitive[i] = if is_hit { primitives[i] as i32 } else { -1 };
        }
    }
}

/// Closest hits in rows or columns, or the hit primitives. The layout is chosen at each write, so that kernels are
/// compiled once for all.
pub enum Closest<'a> {
    Rows(&'a mut [Hit]),
    Columns(HitColumns<'a>),
    /// [`Ray::NO_TRIANGLE`] for a miss.
    Primitives(&'a mut [u32]),
}

impl Answer for Closest<'_> {
    const ANY: bool = false;

    #[inline(always)]
    fn primitives(&mut self) -> Option<&mut [u32]> {
        match self {
            Self::Primitives(primitives) => Some(primitives),
            _ => None,
        }
    }

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        match self {
            Self::Rows(hits) => hits.miss(i),
            Self::Columns(hits) => hits.miss(i),
            Self::Primitives(primitives) => primitives[i] = Ray::NO_TRIANGLE,
        }
    }

    #[inline(always)]
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32) {
        match self {
            Self::Rows(hits) => hits.hit(i, t, uv, primitive),
            Self::Columns(hits) => hits.hit(i, t, uv, primitive),
            Self::Primitives(primitives) => primitives[i] = primitive,
        }
    }

    #[inline(always)]
    fn some(&mut self, start: usize, count: usize, hits: u32, all: &Met, primitives: &Column<u32>) {
        match self {
            Self::Rows(rows) => rows.some(start, count, hits, all, primitives),
            Self::Columns(columns) => columns.some(start, count, hits, all, primitives),
            Self::Primitives(to) => {
                for (i, to) in to[start..][..count].iter_mut().enumerate() {
                    *to = if hits >> i & 1 == 1 { primitives[i] } else { Ray::NO_TRIANGLE };
                }
            }
        }
    }
}

impl Answer for &mut [bool] {
    const ANY: bool = true;

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        self[i] = false;
    }

    #[inline(always)]
    fn hit(&mut self, i: usize, _: f64, _: [f64; 2], _: u32) {
        self[i] = true;
    }
}
