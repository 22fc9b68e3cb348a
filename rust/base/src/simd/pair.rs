//! Vectors of twice as many lanes as a level has, in two registers.

use super::Lanes;

/// Two vectors as one.
#[derive(Clone, Copy, Debug)]
pub struct Pair<S>(pub S);

/// The lower and the upper half of an array.
macro_rules! halves {
    ($half:literal, $whole:literal) => {
        impl<S: Lanes<$half>> Lanes<$whole> for Pair<S> {
            type F32 = [S::F32; 2];
            const FUSED: bool = S::FUSED;

            #[inline(always)]
            fn splat(self, x: f32) -> [S::F32; 2] {
                let x = self.0.splat(x);
                [x, x]
            }
            #[inline(always)]
            fn load(self, from: &[f32; $whole]) -> [S::F32; 2] {
                let [low, high] = from.as_chunks::<$half>().0 else { unreachable!() };
                [self.0.load(low), self.0.load(high)]
            }
            #[inline(always)]
            fn store(self, x: [S::F32; 2], to: &mut [f32; $whole]) {
                let [low, high] = to.as_chunks_mut::<$half>().0 else { unreachable!() };
                self.0.store(x[0], low);
                self.0.store(x[1], high);
            }
            #[inline(always)]
            fn neg(self, a: [S::F32; 2]) -> [S::F32; 2] {
                [self.0.neg(a[0]), self.0.neg(a[1])]
            }
            #[inline(always)]
            fn abs(self, a: [S::F32; 2]) -> [S::F32; 2] {
                [self.0.abs(a[0]), self.0.abs(a[1])]
            }
            #[inline(always)]
            fn mul_sub(self, a: [S::F32; 2], b: [S::F32; 2], c: [S::F32; 2]) -> [S::F32; 2] {
                [self.0.mul_sub(a[0], b[0], c[0]), self.0.mul_sub(a[1], b[1], c[1])]
            }
            #[inline(always)]
            fn mul_add(self, a: [S::F32; 2], b: [S::F32; 2], c: [S::F32; 2]) -> [S::F32; 2] {
                [self.0.mul_add(a[0], b[0], c[0]), self.0.mul_add(a[1], b[1], c[1])]
            }
            #[inline(always)]
            fn select(self, mask: u32, a: [S::F32; 2], b: [S::F32; 2]) -> [S::F32; 2] {
                [self.0.select(mask, a[0], b[0]), self.0.select(mask >> $half, a[1], b[1])]
            }
            #[inline(always)]
            fn le(self, a: [S::F32; 2], b: [S::F32; 2]) -> u32 {
                self.0.le(a[0], b[0]) | self.0.le(a[1], b[1]) << $half
            }
            #[inline(always)]
            fn gt(self, a: [S::F32; 2], b: [S::F32; 2]) -> u32 {
                self.0.gt(a[0], b[0]) | self.0.gt(a[1], b[1]) << $half
            }
            #[inline(always)]
            fn same(self, a: [S::F32; 2], b: [S::F32; 2]) -> u32 {
                self.0.same(a[0], b[0]) | self.0.same(a[1], b[1]) << $half
            }
            #[inline(always)]
            fn greatest(self, a: [S::F32; 2]) -> f32 {
                self.0.greatest(self.0.max(a[0], a[1]))
            }
            halves!(add sub mul div min max; $whole);
        }
    };
    ($($name:ident)*; $whole:literal) => {$(
        #[inline(always)]
        fn $name(self, a: [S::F32; 2], b: [S::F32; 2]) -> [S::F32; 2] {
            [self.0.$name(a[0], b[0]), self.0.$name(a[1], b[1])]
        }
    )*};
}

halves!(4, 8);
halves!(8, 16);
