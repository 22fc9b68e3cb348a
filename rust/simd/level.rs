//! Which vector instructions to use: found once, or forced by `RAYWRIGHT_SIMD`.

#[cfg(target_arch = "x86_64")]
use super::{Avx2, Sse2};
use super::{Scalar, Simd};
use std::sync::OnceLock;

/// A level of the processor's vector instructions, from least to most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What the compiler makes of arrays.
    Scalar,
    /// SSE2, on every x86-64.
    Sse2,
    /// AVX2 and FMA.
    Avx2,
}

impl Level {
    /// All levels, from least to most.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Sse2, Self::Avx2];

    /// The name that `RAYWRIGHT_SIMD` takes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
            Self::Avx2 => "avx2",
        }
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Avx2::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The level that kernels run at: the one that `RAYWRIGHT_SIMD` names when the process first asks, or the best.
    ///
    /// A level that is unknown or that the processor lacks is an error, since who forces one wants to know.
    pub fn current() -> Result<Self, String> {
        static CURRENT: OnceLock<Result<Level, String>> = OnceLock::new();
        CURRENT
            .get_or_init(|| {
                let forced = std::env::var("RAYWRIGHT_SIMD").unwrap_or_default();
                let available: Vec<_> = Self::ALL.into_iter().filter(|l| l.is_available()).collect();
                let best = *available.last().expect("Scalar is always available");
                if forced.is_empty() {
                    return Ok(best);
                }
                available.iter().copied().find(|l| l.name() == forced).ok_or_else(|| {
                    let names: Vec<_> = available.iter().map(|l| l.name()).collect();
                    format!("RAYWRIGHT_SIMD is {forced:?}; this processor has {}", names.join(", "))
                })
            })
            .clone()
    }
}

/// A computation on vectors of `N` lanes, whatever the level.
pub trait Kernel<const N: usize> {
    /// What it gives.
    type Output;

    /// Runs it. Implementations must be `#[inline(always)]`, down to every function that takes `simd`, so that all is
    /// compiled for the level that [`Dispatch`] chose.
    fn run<S: Simd<N>>(self, simd: S) -> Self::Output;
}

/// Runs kernels of `N` lanes compiled for a level, which must be available.
pub trait Dispatch<const N: usize> {
    /// Runs one.
    fn dispatch<K: Kernel<N>>(self, kernel: K) -> K::Output;
}

impl Dispatch<4> for Level {
    #[inline]
    fn dispatch<K: Kernel<4>>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                let simd = Avx2::detect().expect("an available level");
                // SAFETY: the processor was just seen to have AVX2 and FMA.
                unsafe { with_avx2(kernel, simd) }
            }
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => kernel.run(Sse2::new()),
            _ => kernel.run(Scalar),
        }
    }
}

impl Dispatch<8> for Level {
    #[inline]
    fn dispatch<K: Kernel<8>>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                let simd = Avx2::detect().expect("an available level");
                // SAFETY: the processor was just seen to have AVX2 and FMA.
                unsafe { with_avx2(kernel, simd) }
            }
            _ => kernel.run(Scalar),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn with_avx2<const N: usize, K: Kernel<N>>(kernel: K, simd: Avx2) -> K::Output
where
    Avx2: Simd<N>,
{
    kernel.run(simd)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every operation on the same numbers, as bits.
    struct Everything<const N: usize> {
        a: [f32; N],
        b: [f32; N],
    }

    impl<const N: usize> Kernel<N> for Everything<N> {
        type Output = Vec<u32>;

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) -> Vec<u32> {
            let (a, b) = (simd.load(&self.a), simd.load(&self.b));
            let mut lanes = [0f32; N];
            let mut out = vec![simd.le(a, b), simd.gt(a, b)];
            for x in [
                simd.min(a, b),
                simd.max(a, b),
                simd.add(a, b),
                simd.sub(a, b),
                simd.mul(a, b),
                simd.neg(a),
                simd.abs(a),
                simd.splat(self.a[1]),
            ] {
                simd.store(x, &mut lanes);
                out.extend(lanes.map(f32::to_bits));
            }
            out
        }
    }

    fn agree<const N: usize>(a: [f32; N], b: [f32; N]) -> Result<(), TestCaseError>
    where
        Level: Dispatch<N>,
    {
        // The sign of a NaN that an operation makes is not part of the promise.
        let plain = |bits: Vec<u32>| -> Vec<u32> {
            bits.into_iter().map(|x| if f32::from_bits(x).is_nan() { f32::NAN.to_bits() } else { x }).collect()
        };
        let wanted = plain(Level::Scalar.dispatch(Everything { a, b }));
        for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
            prop_assert_eq!(&plain(level.dispatch(Everything { a, b })), &wanted, "{:?}", level);
        }
        Ok(())
    }

    fn ordered() -> impl Strategy<Value = f32> {
        any::<f32>().prop_filter("ordered", |x| !x.is_nan())
    }

    proptest! {
        #[test]
        fn all_levels_agree_bit_for_bit(a in prop::array::uniform8(ordered()), b in prop::array::uniform8(ordered())) {
            agree(a, b)?;
            agree([a[0], a[1], a[2], a[3]], [b[0], b[1], b[2], b[3]])?;
        }
    }

    #[test]
    fn comparisons_with_nan_are_false() {
        for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
            let out = level.dispatch(Everything { a: [f32::NAN; 4], b: [1.0; 4] });
            assert_eq!(out[..2], [0, 0], "{level:?}");
            let out = level.dispatch(Everything { a: [f32::NAN; 8], b: [1.0; 8] });
            assert_eq!(out[..2], [0, 0], "{level:?}");
        }
    }
}
