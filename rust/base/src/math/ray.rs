//! What is asked (a ray) and what is answered (a hit).

use glam::DVec3;

/// A half-line `origin + t · direction`, asked for `t_min ≤ t ≤ t_max`.
///
/// The direction need not be unit: `t` counts in its lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: DVec3,
    /// Where it goes, of any finite non-zero length.
    pub direction: DVec3,
    /// The least `t` that counts, itself included.
    pub t_min: f64,
    /// The greatest `t` that counts, itself included.
    pub t_max: f64,
    /// When it is asked, for what moves: 0 as the shutter opens, 1 as it closes.
    pub time: f64,
    /// Triangles that it is known to miss, by their numbers among the primitives that it is asked of, such as the one
    /// that it leaves and the one that it goes to. They need not be asked about; that changes no answer.
    pub misses: [u32; 2],
}

impl Ray {
    /// In place of a triangle that a ray is known to miss.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// A ray asked for every `t` from 0 on.
    #[inline(always)]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY, time: 0.0, misses: [Self::NO_TRIANGLE; 2] }
    }

    /// The segment from `a` to `b`: `t` runs from 0 to 1.
    #[inline(always)]
    pub fn segment(a: DVec3, b: DVec3) -> Self {
        Self { t_max: 1.0, ..Self::new(a, b - a) }
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// The answer to a ray. A miss is [`Hit::MISS`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Distance in lengths of the ray's direction; infinite for a miss.
    pub t: f64,
    /// Coordinates on the primitive; for a triangle the weights of its second and third corner.
    pub uv: [f64; 2],
    /// Index among all primitives of the scene; `u32::MAX` for a miss.
    pub primitive: u32,
    /// Of an instance, which primitive in it; 0 for what is no instance.
    pub inner: u32,
}

impl Hit {
    /// Nothing was hit.
    pub const MISS: Self = Self { t: f64::INFINITY, uv: [0.0; 2], primitive: u32::MAX, inner: 0 };

    /// Whether something was hit.
    pub fn is_hit(&self) -> bool {
        self.primitive != u32::MAX
    }
}
