//! Where first hits are written.

use crate::math::{Hit, HitColumns};

/// Where answers go.
pub trait Answer {
    /// Whether any hit will do, whatever it is.
    const ANY: bool;

    /// Ray `i` hits nothing.
    fn miss(&mut self, i: usize);

    /// Ray `i` hits a primitive, at `t` in lengths of its own direction.
    fn hit(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: u32);
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
