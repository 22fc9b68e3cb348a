//! Vectors by lane: each coordinate in an array of its own, so that a loop over lanes becomes vectors.

use glam::DVec3;

/// Lanes that go together.
pub const LANES: usize = 16;

/// One of two vectors, without a branch.
#[inline(always)]
pub fn select(first: bool, a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(if first { a.x } else { b.x }, if first { a.y } else { b.y }, if first { a.z } else { b.z })
}

/// A vector a lane.
#[derive(Clone, Copy, Debug)]
pub struct VectorLanes {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
}

impl VectorLanes {
    /// Zero in every lane.
    pub const ZERO: Self = Self { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    /// That of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> DVec3 {
        DVec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Each coordinate of all lanes.
    #[inline(always)]
    pub fn by_axis(&self) -> [&[f64; LANES]; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// Sets that of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: DVec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }
}
