//! Loops over arrays that the compiler turns into vectors, compiled for each level.

use super::Level;

/// Loops over arrays, one turn a lane, whatever the level: the same arithmetic in every lane and at every level, so the
/// same bits.
///
/// What a level has is what the compiler may use; it fuses nothing by itself. A loop becomes vectors where its lanes do
/// the same: no branch that jumps, no call, no index that depends on a lane. Such steps stand in loops of their own.
pub trait Loops {
    /// What they give.
    type Output;

    /// Runs them. Implementations must be `#[inline(always)]`, down to every function that they call, so that all is
    /// compiled for the level that [`Level::compiled`] chose.
    fn run(self) -> Self::Output;
}

impl Level {
    /// Runs loops compiled for this level, which must be available.
    #[inline]
    pub fn compiled<L: Loops>(self, loops: L) -> L::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if super::Avx512::detect().is_some() => {
                // SAFETY: the processor was just seen to have what `with_avx512` is compiled for.
                unsafe { with_avx512(loops) }
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 if super::Avx2::detect().is_some() => {
                // SAFETY: the processor was just seen to have what `with_avx2` is compiled for.
                unsafe { with_avx2(loops) }
            }
            _ => loops.run(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
unsafe fn with_avx2<L: Loops>(loops: L) -> L::Output {
    loops.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
unsafe fn with_avx512<L: Loops>(loops: L) -> L::Output {
    loops.run()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Roots<'a> {
        of: &'a [f64; 16],
        to: &'a mut [f64; 16],
    }

    impl Loops for Roots<'_> {
        type Output = f64;

        #[inline(always)]
        fn run(self) -> f64 {
            for i in 0..16 {
                self.to[i] = (self.of[i] * self.of[i] + 1.0 / self.of[i]).sqrt();
            }
            self.to[3]
        }
    }

    #[test]
    fn levels_agree_to_the_bit() {
        let of = std::array::from_fn(|i| 0.1 + 0.7 * i as f64);
        let mut wanted = [0.0; 16];
        let third = Roots { of: &of, to: &mut wanted }.run();
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let mut to = [0.0; 16];
            assert_eq!(level.compiled(Roots { of: &of, to: &mut to }), third);
            assert_eq!(to.map(f64::to_bits), wanted.map(f64::to_bits), "{level:?}");
        }
    }
}
