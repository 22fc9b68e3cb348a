//! Outputs of first-hit and occlusion queries.

use raywright_base::math::{Hit, HitColumns, PlacedHits, Ray};
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

impl Answer for PlacedHits<'_> {
    const ANY: bool = false;

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        self.put(i, Hit::MISS.t, Hit::MISS.uv, -1);
    }

    #[inline(always)]
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32) {
        self.put(i, t, uv, primitive as i32);
    }

    #[inline(always)]
    fn some(&mut self, start: usize, count: usize, hits: u32, all: &Met, primitives: &Column<u32>) {
        const RUN: usize = PlacedHits::RUN;
        for run in 0..count.min(RAYS) / RUN {
            let (mut t, mut uv, mut primitive) = ([Hit::MISS.t; RUN], [Hit::MISS.uv; RUN], [-1; RUN]);
            for k in 0..RUN {
                let i = run * RUN + k;
                let is_hit = hits >> i & 1 == 1;
                t[k] = if is_hit { all.t[i] } else { Hit::MISS.t };
                uv[k][0] = if is_hit { all.uv[0][i] } else { Hit::MISS.uv[0] };
                uv[k][1] = if is_hit { all.uv[1][i] } else { Hit::MISS.uv[1] };
                primitive[k] = if is_hit { primitives[i] as i32 } else { -1 };
            }
            self.put_run(start / RUN + run, &t, &uv, &primitive);
        }
    }
}

/// Closest hits in rows or columns, or the hit primitives. The layout is chosen at each write, so that kernels are
/// compiled once for all.
pub enum Closest<'a> {
    Rows(&'a mut [Hit]),
    Columns(HitColumns<'a>),
    Placed(PlacedHits<'a>),
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
            Self::Placed(hits) => hits.miss(i),
            Self::Primitives(primitives) => primitives[i] = Ray::NO_TRIANGLE,
        }
    }

    #[inline(always)]
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32) {
        match self {
            Self::Rows(hits) => hits.hit(i, t, uv, primitive),
            Self::Columns(hits) => hits.hit(i, t, uv, primitive),
            Self::Placed(hits) => hits.hit(i, t, uv, primitive),
            Self::Primitives(primitives) => primitives[i] = primitive,
        }
    }

    #[inline(always)]
    fn some(&mut self, start: usize, count: usize, hits: u32, all: &Met, primitives: &Column<u32>) {
        match self {
            Self::Rows(rows) => rows.some(start, count, hits, all, primitives),
            Self::Columns(columns) => columns.some(start, count, hits, all, primitives),
            Self::Placed(placed) => placed.some(start, count, hits, all, primitives),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ByColumns;
    use raywright_base::math::{Numbers, RayColumns, Vectors};
    use raywright_shapes::triangle::ALL;

    /// Finds the hits that it is given.
    struct Known(u32);

    impl Known {
        fn store(&self, mut to: impl Answer, count: usize) {
            let number = |i: usize| i as f64;
            let (mut all, mut primitives) = (Met { met: self.0, ..Met::NONE }, [0; RAYS]);
            for i in 0..RAYS {
                (all.t[i], all.uv[0][i], all.uv[1][i]) = (number(i) + 1.0, number(i) / 16.0, number(i) / 32.0);
                primitives[i] = 100 + i as u32;
            }
            to.some(0, count, self.0, &all, &primitives);
        }
    }

    impl ByColumns for Known {
        fn intersect(&self, rays: &RayColumns<'_>, hits: HitColumns<'_>) {
            self.store(hits, rays.len());
        }

        fn first_hits(&self, rays: &RayColumns<'_>, hits: &mut [Hit]) {
            self.store(hits, rays.len());
        }

        fn occluded(&self, _: &RayColumns<'_>, _: &mut [bool]) {}

        fn extent(&self) -> Option<f64> {
            None
        }
    }

    #[test]
    fn runs_stand_at_their_places_and_nothing_else_is_touched() {
        let numbers = [0f32; RAYS];
        for (count, known) in [4, 12, 16].into_iter().flat_map(|n| [0, ALL, 0x5a3c].map(|hits| (n, Known(hits)))) {
            let vectors = Vectors::Single([&numbers[..count]; 3]);
            let rays = RayColumns::new(vectors, vectors, Numbers::One(0.0), Numbers::One(1.0));
            let mut wanted = vec![Hit::MISS; count];
            known.first_hits(&rays, &mut wanted);
            let places = &[20, 0, 9, 31][..count / PlacedHits::RUN];
            for is_direct in [true, false] {
                let (mut t, mut uv, mut primitive, mut shape) = ([-1.0; 40], [[-1.0; 2]; 40], [-2; 40], [-2; 40]);
                let shapes = Some(&mut shape[..]);
                let to = PlacedHits { t: &mut t, uv: &mut uv, primitive: &mut primitive, shape: shapes, places };
                if is_direct {
                    known.store(to, count)
                } else {
                    known.intersect_placed(&rays, to)
                }
                let mut rest = 40;
                for (i, hit) in wanted.iter().enumerate() {
                    let place = places[i / 4] + i % 4;
                    let found = Hit { t: t[place], uv: uv[place], primitive: primitive[place] as u32, inner: 0 };
                    assert_eq!((&found, shape[place]), (hit, if hit.is_hit() { 0 } else { -1 }), "{count} {}", known.0);
                    (t[place], rest) = (-1.0, rest - 1);
                }
                assert!(t.iter().all(|&t| t == -1.0));
                assert_eq!(primitive.iter().filter(|&&number| number == -2).count(), rest);
            }
        }
    }
}
