//! The SIMD level, detected once or forced by `RAYWRIGHT_SIMD`.

#[cfg(target_arch = "aarch64")]
use super::Neon;
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
use super::Scalar;
use super::Simd;
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, Sse2};
use std::sync::OnceLock;

/// A level of the processor's vector instructions, in increasing order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Arrays, for processors without vectors. Others always have vectors and need no scalar copy of each kernel.
    Scalar,
    /// NEON, on every 64-bit ARM.
    Neon,
    /// SSE2, on every x86-64.
    Sse2,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512 (F, VL, DQ, BW).
    Avx512,
}

impl Level {
    /// All levels in increasing order.
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Neon, Self::Sse2, Self::Avx2, Self::Avx512];

    /// The name in `RAYWRIGHT_SIMD`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Neon => "neon",
            Self::Sse2 => "sse2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The lanes of its f32 vectors; kernels may use fewer.
    pub fn lanes(self) -> usize {
        if self >= Self::Avx2 { 8 } else { 4 }
    }

    /// Return whether this processor supports it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => cfg!(not(any(target_arch = "x86_64", target_arch = "aarch64"))),
            Self::Neon => cfg!(target_arch = "aarch64"),
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Avx2::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Avx512::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The level of kernels: the one named by `RAYWRIGHT_SIMD` at the first call in the process, or the best.
    ///
    /// An unknown or unsupported level is an error rather than ignored.
    pub fn current() -> Result<Self, String> {
        static CURRENT: OnceLock<Result<Level, String>> = OnceLock::new();
        CURRENT
            .get_or_init(|| {
                let forced = std::env::var("RAYWRIGHT_SIMD").unwrap_or_default();
                let available: Vec<_> = Self::ALL.into_iter().filter(|l| l.is_available()).collect();
                let best = *available.last().expect("each processor has its least level");
                if forced.is_empty() {
                    return Ok(best);
                }
                available.iter().copied().find(|l| l.name() == forced).ok_or_else(|| {
                    let names: Vec<_> = available.iter().map(|l| l.name()).collect();
                    format!("RAYWRIGHT_SIMD is {forced:?}, expected one of {}", names.join(", "))
                })
            })
            .clone()
    }
}

/// A computation on vectors of `N` lanes, generic over the level.
pub trait Kernel<const N: usize> {
    /// Its result.
    type Output;

    /// True if it is compiled for AVX-512, too. AVX2 suffices for rare kernels, and each copy takes long to compile.
    const AVX512: bool = true;

    /// Run it. Implementations must be `#[inline(always)]`, as must every function that takes `simd`, so that all is
    /// compiled for the level that [`Dispatch`] chose.
    fn run<S: Simd<N>>(self, simd: S) -> Self::Output;
}

/// Runs kernels of `N` lanes compiled for a level, which must be available and have at least N lanes
/// ([`Level::lanes`]).
pub trait Dispatch<const N: usize> {
    /// Run a kernel.
    fn dispatch<K: Kernel<N>>(self, kernel: K) -> K::Output;
}

impl Dispatch<4> for Level {
    #[inline]
    fn dispatch<K: Kernel<4>>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
            Self::Scalar => with_scalar(kernel),
            // Four lanes are for processors without more; wider levels have no separate code for them.
            #[cfg(target_arch = "x86_64")]
            _ => with_sse2(kernel),
            #[cfg(target_arch = "aarch64")]
            _ => kernel.run(Neon::new()),
            #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
            level => panic!("only scalar code is compiled for this processor, not {}", level.name()),
        }
    }
}

impl Dispatch<8> for Level {
    #[inline]
    fn dispatch<K: Kernel<8>>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if K::AVX512 => {
                let simd = Avx512::detect().expect("an available level");
                // SAFETY: the processor was just checked for the features that `with_avx512` is compiled for.
                unsafe { with_avx512(kernel, simd) }
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 | Self::Avx512 => {
                let simd = Avx2::detect().expect("an available level");
                // SAFETY: the processor was just checked for the features that `with_avx2` is compiled for.
                unsafe { with_avx2(kernel, simd) }
            }
            // Processors without vectors of eight use four.
            level => {
                let _ = kernel;
                panic!("eight lanes need AVX2, not {}", level.name())
            }
        }
    }
}

/// A separate function, as for the other levels.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[inline(never)]
fn with_scalar<const N: usize, K: Kernel<N>>(kernel: K) -> K::Output
where
    Scalar: Simd<N>,
{
    kernel.run(Scalar)
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn with_sse2<const N: usize, K: Kernel<N>>(kernel: K) -> K::Output
where
    Sse2: Simd<N>,
{
    kernel.run(Sse2::new())
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
unsafe fn with_avx2<const N: usize, K: Kernel<N>>(kernel: K, simd: Avx2) -> K::Output
where
    Avx2: Simd<N>,
{
    kernel.run(simd)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
unsafe fn with_avx512<const N: usize, K: Kernel<N>>(kernel: K, simd: Avx512) -> K::Output
where
    Avx512: Simd<N>,
{
    kernel.run(simd)
}

#[cfg(test)]
mod tests {
    use super::super::{ASCENDING, Lanes, Scalar};
    use super::*;
    use proptest::prelude::*;

    /// Every operation on the same numbers, as bits: with the lanes of a node, and with sixteen.
    struct Everything<const N: usize> {
        a: [f32; 16],
        b: [f32; 16],
    }

    /// All operations of `Lanes`.
    #[inline(always)]
    fn arithmetic<const N: usize, S: Lanes<N>>(simd: S, a: &[f32; N], b: &[f32; N], out: &mut Vec<u32>) {
        let one = simd.splat(a[1]);
        let (a, b) = (simd.load(a), simd.load(b));
        let mut lanes = [0f32; N];
        out.extend([simd.le(a, b), simd.gt(a, b)]);
        for x in [
            simd.min(a, b),
            simd.max(a, b),
            simd.add(a, b),
            simd.sub(a, b),
            simd.mul(a, b),
            simd.div(a, b),
            simd.neg(a),
            simd.abs(a),
            one,
            simd.select(0, a, b),
            simd.select(0xa59c, a, b),
            simd.select(simd.gt(a, b), a, b),
        ] {
            simd.store(x, &mut lanes);
            out.extend(lanes.map(f32::to_bits));
        }
        out.extend([simd.same(a, b), simd.same(a, a)]);
        // The sign of a zero maximum or minimum is unspecified.
        out.extend([simd.greatest(a), simd.least(a)].map(|x| (x + 0.0).to_bits()));
    }

    impl<const N: usize> Kernel<N> for Everything<N> {
        type Output = Vec<u32>;

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) -> Vec<u32> {
            let (few_a, few_b) = (self.a.first_chunk().unwrap(), self.b.first_chunk().unwrap());
            let mut out = Vec::new();
            arithmetic::<N, _>(simd, few_a, few_b, &mut out);
            arithmetic::<16, _>(simd.sixteen(), &self.a, &self.b, &mut out);
            let (a, b) = (simd.load(few_a), simd.load(few_b));
            for (order, count) in [(ASCENDING, N), (0o01234567, N - 1), (0o21306574, 3), (0o44332211, 0)] {
                let items = std::array::from_fn(|i| 100 + i as u32);
                let (mut nears, mut picked) = ([0.0; N], [0; N]);
                let count = simd.pick(a, b, &items, order, count as u32, &mut nears, &mut picked);
                out.push(count as u32);
                out.extend(nears[..count].iter().map(|x| x.to_bits()).chain(picked[..count].iter().copied()));
            }
            out
        }
    }

    fn agree<const N: usize>(a: [f32; 16], b: [f32; 16]) -> Result<(), TestCaseError>
    where
        Level: Dispatch<N>,
    {
        // The sign of a resulting NaN is unspecified.
        let plain = |bits: Vec<u32>| -> Vec<u32> {
            bits.into_iter().map(|x| if f32::from_bits(x).is_nan() { f32::NAN.to_bits() } else { x }).collect()
        };
        let wanted = plain(Everything::<N> { a, b }.run(Scalar));
        for level in levels::<N>() {
            prop_assert_eq!(&plain(level.dispatch(Everything { a, b })), &wanted, "{:?}", level);
        }
        Ok(())
    }

    /// The levels of this processor with at least N lanes.
    fn levels<const N: usize>() -> impl Iterator<Item = Level> {
        Level::ALL.into_iter().filter(|l| l.is_available() && l.lanes() >= N)
    }

    fn ordered() -> impl Strategy<Value = f32> {
        any::<f32>().prop_filter("ordered", |x| !x.is_nan())
    }

    proptest! {
        #[test]
        fn all_levels_agree_bit_for_bit(
            a in prop::array::uniform16(ordered()), b in prop::array::uniform16(ordered()),
        ) {
            agree::<8>(a, b)?;
            agree::<4>(a, b)?;
        }
    }

    #[test]
    fn comparisons_with_nan_are_false() {
        let (a, b) = ([f32::NAN; 16], [1.0; 16]);
        for level in levels::<4>() {
            assert_eq!(level.dispatch(Everything::<4> { a, b })[..2], [0, 0], "{level:?}");
        }
        for level in levels::<8>() {
            assert_eq!(level.dispatch(Everything::<8> { a, b })[..2], [0, 0], "{level:?}");
        }
    }
}
