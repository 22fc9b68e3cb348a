//! The ray and the hit.

use glam::DVec3;

/// A half-line `origin + t · direction`, restricted to `t_min ≤ t ≤ t_max`.
///
/// The direction need not be a unit vector: `t` is in multiples of its length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// The origin.
    pub origin: DVec3,
    /// The direction, of any finite nonzero length.
    pub direction: DVec3,
    /// The least `t`, inclusive.
    pub t_min: f64,
    /// The greatest `t`, inclusive.
    pub t_max: f64,
    /// The time, from 0 at the opening of the shutter to 1 at its closing.
    pub time: f64,
    /// Triangles that the ray is known to miss, by number, such as the one it leaves and the one it goes to. Their
    /// tests may be skipped without changing results.
    pub misses: [u32; 2],
}

impl Ray {
    /// Marks an unused entry of `misses`.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// A ray for all `t ≥ 0`.
    #[inline(always)]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY, time: 0.0, misses: [Self::NO_TRIANGLE; 2] }
    }

    /// The segment from `a` to `b`, with `t` from 0 to 1.
    #[inline(always)]
    pub fn segment(a: DVec3, b: DVec3) -> Self {
        Self { t_max: 1.0, ..Self::new(a, b - a) }
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// The result of a ray query. A miss is [`Hit::MISS`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Distance in lengths of the ray's direction; infinite for a miss.
    pub t: f64,
    /// Coordinates on the primitive; for a triangle the weights of its second and third corner.
    pub uv: [f64; 2],
    /// Index among all primitives of the scene; `u32::MAX` for a miss.
    pub primitive: u32,
    /// The primitive within an instance; 0 for other primitives.
    pub inner: u32,
}

impl Hit {
    /// No hit.
    pub const MISS: Self = Self { t: f64::INFINITY, uv: [0.0; 2], primitive: u32::MAX, inner: 0 };

    /// Return whether it is a hit.
    pub fn is_hit(&self) -> bool {
        self.primitive != u32::MAX
    }
}
