//! Vectors by lane: each coordinate in an array of its own, so that a loop over lanes becomes vectors.

use glam::{DVec3, Vec3};
use std::fmt::Debug;

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

    /// One coordinate of all lanes.
    #[inline(always)]
    pub fn axis_mut(&mut self, axis: usize) -> &mut [f64; LANES] {
        [&mut self.x, &mut self.y, &mut self.z][axis]
    }

    /// Sets that of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: DVec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }
}

/// Vectors of f32, a lane each.
#[derive(Clone, Copy, Debug)]
pub struct SingleLanes(pub [[f32; LANES]; 3]);

impl SingleLanes {
    /// Zero in every lane.
    pub const ZERO: Self = Self([[0.0; LANES]; 3]);

    /// That of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.0[0][lane], self.0[1][lane], self.0[2][lane])
    }

    /// Sets that of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        (self.0[0][lane], self.0[1][lane], self.0[2][lane]) = (v.x, v.y, v.z);
    }
}

/// Sixteen of a column, in its order; the last may be the same. Where they are neighbours, as survivors of a stage
/// mostly are, they are read as vectors.
#[inline(always)]
pub fn gather<T: Copy>(column: &[T], which: &[u32; LANES], to: &mut [T; LANES]) {
    let (first, end) = (which[0] as usize, which[LANES - 1] as usize);
    let are_neighbours = end == first + LANES - 1 && which[LANES - 2] as usize + 1 == end;
    match column.get(first..first + LANES) {
        Some(neighbours) if are_neighbours => to.copy_from_slice(neighbours),
        _ => {
            for (to, &i) in to.iter_mut().zip(which) {
                *to = column[i as usize];
            }
        }
    }
}

/// What sixteen of can stand in columns, a lane each.
pub trait InLanes: Sized {
    /// Those columns.
    type Lanes: Clone + Debug;
    /// Of nothing yet.
    const EMPTY: Self::Lanes;

    /// That of a lane.
    fn get(lanes: &Self::Lanes, lane: usize) -> Self;

    /// Puts it into a lane.
    fn put(&self, lanes: &mut Self::Lanes, lane: usize);
}

/// Plain values: an array of them.
macro_rules! plain {
    ($($of:ty: $none:expr,)+) => {
        $(impl InLanes for $of {
            type Lanes = [Self; LANES];
            const EMPTY: Self::Lanes = [$none; LANES];

            #[inline(always)]
            fn get(lanes: &Self::Lanes, lane: usize) -> Self {
                lanes[lane]
            }

            #[inline(always)]
            fn put(&self, lanes: &mut Self::Lanes, lane: usize) {
                lanes[lane] = *self;
            }
        })+
    };
}

plain! { f64: 1.0, bool: false, }

impl InLanes for DVec3 {
    type Lanes = VectorLanes;
    const EMPTY: VectorLanes = VectorLanes::ZERO;

    #[inline(always)]
    fn get(lanes: &VectorLanes, lane: usize) -> Self {
        lanes.get(lane)
    }

    #[inline(always)]
    fn put(&self, lanes: &mut VectorLanes, lane: usize) {
        lanes.set(lane, *self);
    }
}

impl<T: InLanes> InLanes for [T; 2] {
    type Lanes = [T::Lanes; 2];
    const EMPTY: Self::Lanes = [T::EMPTY; 2];

    #[inline(always)]
    fn get(lanes: &Self::Lanes, lane: usize) -> Self {
        [T::get(&lanes[0], lane), T::get(&lanes[1], lane)]
    }

    #[inline(always)]
    fn put(&self, lanes: &mut Self::Lanes, lane: usize) {
        self[0].put(&mut lanes[0], lane);
        self[1].put(&mut lanes[1], lane);
    }
}

/// Makes a type of columns, one of each of these fields, and of another that has them, all of them, one that can stand
/// there.
#[macro_export]
macro_rules! in_lanes {
    ($(#[$about:meta])* $lanes:ident of $one:ident { $($field:ident: $type:ty),+ $(,)? }) => {
        $(#[$about])*
        #[derive(Clone, Debug)]
        pub struct $lanes {
            $($field: <$type as $crate::math::InLanes>::Lanes),+
        }

        impl $crate::math::InLanes for $one {
            type Lanes = $lanes;
            const EMPTY: $lanes = $lanes { $($field: <$type as $crate::math::InLanes>::EMPTY),+ };

            #[inline(always)]
            fn get(lanes: &$lanes, lane: usize) -> Self {
                Self { $($field: $crate::math::InLanes::get(&lanes.$field, lane)),+ }
            }

            #[inline(always)]
            fn put(&self, lanes: &mut $lanes, lane: usize) {
                $($crate::math::InLanes::put(&self.$field, &mut lanes.$field, lane);)+
            }
        }
    };
}

pub use crate::in_lanes;
