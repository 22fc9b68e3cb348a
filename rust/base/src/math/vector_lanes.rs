//! Vectors in SoA layout, so that loops over lanes vectorize.

use glam::{DVec3, Vec3};
use std::fmt::Debug;

/// Lanes processed together.
pub const LANES: usize = 16;

/// Select one of two vectors without a branch.
#[inline(always)]
pub fn select(first: bool, a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(if first { a.x } else { b.x }, if first { a.y } else { b.y }, if first { a.z } else { b.z })
}

/// One vector per lane.
#[derive(Clone, Copy, Debug)]
pub struct VectorLanes {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
}

impl VectorLanes {
    /// Zero in every lane.
    pub const ZERO: Self = Self { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    /// The vector of a lane.
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

    /// Set the vector of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: DVec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }
}

/// One f32 vector per lane.
#[derive(Clone, Copy, Debug)]
pub struct SingleLanes(pub [[f32; LANES]; 3]);

impl SingleLanes {
    /// Zero in every lane.
    pub const ZERO: Self = Self([[0.0; LANES]; 3]);

    /// The vector of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.0[0][lane], self.0[1][lane], self.0[2][lane])
    }

    /// Set the vector of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        (self.0[0][lane], self.0[1][lane], self.0[2][lane]) = (v.x, v.y, v.z);
    }
}

/// Gather sixteen entries of a column. If they are contiguous, as survivors of a stage usually are, they are copied as
/// vectors.
#[inline(always)]
pub fn gather<T: Copy>(column: &[T], which: &[u32; LANES], to: &mut [T; LANES]) {
    let start = which[0];
    let mut differ = 0;
    for (i, &place) in (0u32..).zip(which) {
        differ |= place ^ start.wrapping_add(i);
    }
    let (first, are_neighbours) = (start as usize, differ == 0);
    match column.get(first..first + LANES) {
        Some(neighbours) if are_neighbours => to.copy_from_slice(neighbours),
        _ => {
            for (to, &i) in to.iter_mut().zip(which) {
                *to = column[i as usize];
            }
        }
    }
}

/// A type that has an SoA layout of sixteen lanes.
pub trait InLanes: Sized {
    /// The type of that layout.
    type Lanes: Clone + Debug;
    /// Empty lanes.
    const EMPTY: Self::Lanes;

    /// The value of a lane.
    fn get(lanes: &Self::Lanes, lane: usize) -> Self;

    /// Store the value in a lane.
    fn put(&self, lanes: &mut Self::Lanes, lane: usize);
}

/// Plain values use an array.
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

/// Define the SoA type of a structure, with one column per field, and implement `InLanes` for the structure.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_gathered_in_any_order() {
        let column: Vec<u32> = (0..64).map(|i| 7 * i + 1).collect();
        let contiguous: [u32; LANES] = std::array::from_fn(|i| 5 + i as u32);
        let mut swapped = contiguous;
        swapped.swap(3, 4);
        let repeated = contiguous.map(|i| i.min(9));
        let at_the_end: [u32; LANES] = std::array::from_fn(|i| 48 + i as u32);
        for which in [contiguous, swapped, repeated, at_the_end] {
            let mut got = [0; LANES];
            gather(&column, &which, &mut got);
            assert_eq!(got, which.map(|i| 7 * i + 1));
        }
    }
}
