//! Rays of a wavefront of paths in SoA layout.

use super::{DVec3, LANES, Numbers, Ray, RayColumns, Vectors};

/// Rays that leave surfaces, in SoA layout. Origins are in f64, since rays that leave a surface must not be rounded.
/// Directions are unit vectors, for which f32 is precise enough in light transport.
///
/// Every column has sixteen spare entries, so that loops over sixteen lanes need no remainder.
#[derive(Clone, Debug, Default)]
pub struct PathRays {
    /// Number of rays.
    pub len: usize,
    /// Origins, by axis.
    pub origin: [Vec<f64>; 3],
    /// Unit directions, by axis.
    pub direction: [Vec<f32>; 3],
    /// Maximum `t`, in lengths of the direction. Empty if all rays are unbounded.
    pub t_max: Vec<f64>,
    /// Triangles that each ray misses: the one it leaves and, for bounded rays, the one it goes to, or
    /// [`Ray::NO_TRIANGLE`].
    pub misses: Vec<[u32; 2]>,
    /// When each sees the scene, from 0 to 1 while the shutter is open. Empty if nothing moves.
    pub time: Vec<f64>,
}

impl PathRays {
    /// Rays to a point end at this share of the way. Directions in f32 miss the point by 2⁻²³ of the way, so surfaces
    /// right behind it must not block it; surfaces within 2⁻²⁰ of the way before it do not either.
    pub const END: f64 = 1.0 - 1.0 / (1u64 << 20) as f64;

    /// Room for so many rays, endless or not.
    pub fn with_room(most: usize, are_endless: bool) -> Self {
        let room = most + LANES;
        Self {
            len: 0,
            origin: [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; room]),
            direction: [const { Vec::new() }; 3].map(|_: Vec<f32>| vec![0.0; room]),
            t_max: vec![f64::INFINITY; if are_endless { 0 } else { room }],
            misses: vec![[Ray::NO_TRIANGLE; 2]; room],
            time: Vec::new(),
        }
    }

    /// The same, with times.
    pub fn with_times(mut self) -> Self {
        self.time = vec![0.0; self.misses.len()];
        self
    }

    /// Make room for so many rays, and keep those that are there.
    pub fn make_room(&mut self, most: usize) {
        let room = most + LANES;
        if self.misses.len() < room {
            self.origin.iter_mut().for_each(|column| column.resize(2 * room, 0.0));
            self.direction.iter_mut().for_each(|column| column.resize(2 * room, 0.0));
            self.misses.resize(2 * room, [Ray::NO_TRIANGLE; 2]);
            if !self.t_max.is_empty() {
                self.t_max.resize(2 * room, f64::INFINITY);
            }
            if !self.time.is_empty() {
                self.time.resize(2 * room, 0.0);
            }
        }
    }

    /// The greatest `t` of a ray.
    #[inline(always)]
    pub fn end(&self, i: usize) -> f64 {
        self.t_max.get(i).copied().unwrap_or(f64::INFINITY)
    }

    /// The time of a ray.
    #[inline(always)]
    pub fn time(&self, i: usize) -> f64 {
        self.time.get(i).copied().unwrap_or(0.0)
    }

    /// The direction of a ray.
    #[inline(always)]
    pub fn direction(&self, i: usize) -> DVec3 {
        DVec3::new(self.direction[0][i].into(), self.direction[1][i].into(), self.direction[2][i].into())
    }

    /// The origin of a ray.
    #[inline(always)]
    pub fn origin(&self, i: usize) -> DVec3 {
        DVec3::new(self.origin[0][i], self.origin[1][i], self.origin[2][i])
    }

    /// One ray, in f64.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        let (t_max, time, misses) = (self.end(i), self.time(i), self.misses[i]);
        Ray { t_max, time, misses, ..Ray::new(self.origin(i), self.direction(i)) }
    }

    /// All rays as columns.
    pub fn columns(&self) -> RayColumns<'_> {
        let some = self.len;
        let origin = Vectors::Double(self.origin.each_ref().map(|column| &column[..some]));
        let direction = Vectors::Single(self.direction.each_ref().map(|column| &column[..some]));
        let t_max =
            if self.t_max.is_empty() { Numbers::One(f64::INFINITY) } else { Numbers::Each(&self.t_max[..some]) };
        RayColumns::new(origin, direction, Numbers::One(0.0), t_max).missing(&self.misses[..some])
    }
}
