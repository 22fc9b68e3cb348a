//! Loops over arrays, vectorized by the compiler for each level.

/// Define a function of loops over arrays, one iteration per lane, compiled for each level. Its first argument selects
/// the level, which must be available. The arithmetic of lanes is the same at all levels, and so are the bits.
///
/// The compiler may use a level's instructions; it fuses no operations by itself. A loop vectorizes if all lanes do the
/// same: no branches, no calls, no lane-dependent indices. Such steps need loops of their own. Called functions must be
/// `#[inline(always)]` throughout, so that all is compiled for the level. Every output must be a separate argument,
/// since only arguments are known not to alias. Such a function may be generic over types, and is compiled for each.
#[macro_export]
macro_rules! loops {
    (
        $(#[$attribute:meta])*
        $visibility:vis fn $name:ident $(<$($of:ident: $bound:ident $(+ $more:ident)*),+>)?(
            $($argument:ident: $type:ty),* $(,)?
        ) $body:block
    ) => {
        $(#[$attribute])*
        #[allow(clippy::too_many_arguments)]
        $visibility fn $name$(<$($of: $bound $(+ $more)*),+>)?(level: $crate::simd::Level, $($argument: $type),*) {
            #[inline(always)]
            #[allow(clippy::too_many_arguments)]
            fn run$(<$($of: $bound $(+ $more)*),+>)?($($argument: $type),*) $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
            #[allow(clippy::too_many_arguments)]
            unsafe fn with_avx2$(<$($of: $bound $(+ $more)*),+>)?($($argument: $type),*) {
                run$(::<$($of),+>)?($($argument),*);
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
            #[allow(clippy::too_many_arguments)]
            unsafe fn with_avx512$(<$($of: $bound $(+ $more)*),+>)?($($argument: $type),*) {
                run$(::<$($of),+>)?($($argument),*);
            }

            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn at_base_level$(<$($of: $bound $(+ $more)*),+>)?($($argument: $type),*) {
                run$(::<$($of),+>)?($($argument),*);
            }

            match level {
                #[cfg(target_arch = "x86_64")]
                $crate::simd::Level::Avx512 if $crate::simd::Avx512::detect().is_some() => {
                    // SAFETY: the processor was just checked for the features that `with_avx512` is compiled for.
                    unsafe { with_avx512$(::<$($of),+>)?($($argument),*) }
                }
                #[cfg(target_arch = "x86_64")]
                $crate::simd::Level::Avx2 if $crate::simd::Avx2::detect().is_some() => {
                    // SAFETY: the processor was just checked for the features that `with_avx2` is compiled for.
                    unsafe { with_avx2$(::<$($of),+>)?($($argument),*) }
                }
                _ => at_base_level$(::<$($of),+>)?($($argument),*),
            }
        }
    };
}

pub use crate::loops;

#[cfg(test)]
mod tests {
    use super::super::Level;

    loops! {
        fn roots(of: &[f64; 16], to: &mut [f64; 16]) {
            for i in 0..16 {
                to[i] = (of[i] * of[i] + 1.0 / of[i]).sqrt();
            }
        }
    }

    #[test]
    fn levels_agree_to_the_bit() {
        let of = std::array::from_fn(|i| 0.1 + 0.7 * i as f64);
        let mut wanted = [0.0; 16];
        roots(Level::Scalar, &of, &mut wanted);
        assert_eq!(wanted[1], (0.8f64 * 0.8 + 1.0 / 0.8).sqrt());
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let mut to = [0.0; 16];
            roots(level, &of, &mut to);
            assert_eq!(to.map(f64::to_bits), wanted.map(f64::to_bits), "{level:?}");
        }
    }
}
