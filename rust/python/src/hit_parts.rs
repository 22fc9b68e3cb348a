//! What is written of hits: all that is known of them or some of it, in f64 or f32.

use super::instances;
use super::rays::SplitOutput;
use raywright::math::Hit;
use raywright::scene::Scene;

/// Numbers that may be kept in f32.
pub trait Rounded: Copy + Send {
    /// As f32.
    type Single: Copy + Send;
    /// Rounded to the nearest.
    fn single(self) -> Self::Single;
}

impl Rounded for f64 {
    type Single = f32;
    #[inline(always)]
    fn single(self) -> f32 {
        self as f32
    }
}

impl Rounded for [f64; 2] {
    type Single = [f32; 2];
    #[inline(always)]
    fn single(self) -> [f32; 2] {
        self.map(|x| x as f32)
    }
}

/// Where numbers are written, one of each ray.
pub enum To<'a, T: Rounded> {
    /// f64.
    Double(&'a mut [T]),
    /// f32.
    Single(&'a mut [T::Single]),
}

impl<T: Rounded> To<'_, T> {
    /// Returns whether they are f32.
    #[inline(always)]
    pub fn is_single(&self) -> bool {
        matches!(self, Self::Single(_))
    }

    #[inline(always)]
    fn put(&mut self, i: usize, value: T) {
        match self {
            Self::Double(to) => to[i] = value,
            Self::Single(to) => to[i] = value.single(),
        }
    }
}

impl<T: Rounded> SplitOutput for To<'_, T> {
    fn split(self, at: usize) -> (Self, Self) {
        match self {
            Self::Double(to) => {
                let (first, others) = to.split_at_mut(at);
                (Self::Double(first), Self::Double(others))
            }
            Self::Single(to) => {
                let (first, others) = to.split_at_mut(at);
                (Self::Single(first), Self::Single(others))
            }
        }
    }
}

/// Where the hits of `count` rays are written; none of what nobody asks for.
pub struct HitParts<'a> {
    pub count: usize,
    pub t: Option<To<'a, f64>>,
    pub shape: Option<&'a mut [i32]>,
    pub primitive: Option<&'a mut [i32]>,
    pub uv: Option<To<'a, [f64; 2]>>,
    /// −1 where there is none.
    pub instance: Option<&'a mut [i32]>,
}

impl SplitOutput for HitParts<'_> {
    fn split(self, at: usize) -> (Self, Self) {
        let (t, uv) = (self.t.split(at), self.uv.split(at));
        let (shape, primitive) = (self.shape.split(at), self.primitive.split(at));
        let instance = self.instance.split(at);
        let first = Self { count: at, t: t.0, shape: shape.0, primitive: primitive.0, uv: uv.0, instance: instance.0 };
        let count = self.count - at;
        (first, Self { count, t: t.1, shape: shape.1, primitive: primitive.1, uv: uv.1, instance: instance.1 })
    }
}

impl HitParts<'_> {
    /// Writes hits down where they belong.
    // On its own, or the loop's pointers do not fit into registers.
    #[inline(never)]
    pub fn write(&mut self, scene: &Scene, hits: &[Hit], places: &[usize]) {
        let has_instances = scene.geometry().has_instances();
        for (hit, &i) in hits.iter().zip(places) {
            let (shape, mut primitive) = located(scene, hit.primitive);
            let mut instance = -1;
            if has_instances {
                (instance, primitive) = instances::located(scene, hit, primitive);
            }
            if let Some(to) = &mut self.t {
                to.put(i, hit.t);
            }
            if let Some(to) = &mut self.uv {
                to.put(i, hit.uv);
            }
            for (to, number) in
                [(&mut self.shape, shape), (&mut self.primitive, primitive), (&mut self.instance, instance)]
            {
                if let Some(to) = to {
                    to[i] = number;
                }
            }
        }
    }
}

/// The shape and the face of a primitive, as arrays say it: −1 for none.
pub fn located(scene: &Scene, primitive: u32) -> (i32, i32) {
    if primitive == Hit::MISS.primitive {
        return (-1, -1);
    }
    let (shape, primitive) = scene.geometry().locate(primitive);
    (shape as i32, primitive as i32)
}
