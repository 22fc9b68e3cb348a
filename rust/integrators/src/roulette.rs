//! Russian roulette: which paths go on, of those that bring less and less.

use raywright_optics::Rgb;

/// Bounces after which roulette is played whatever was asked, so that every path ends.
pub(super) const AT_LATEST: u32 = 4096;

/// The greatest probability to survive a round: a path in a closed box of albedo 1 ends after some four thousand
/// bounces.
pub(super) const SURVIVAL: f64 = 1.0 - 1.0 / 4096.0;

/// The probability that a path of this throughput survives a round of Russian roulette (Arvo and Kirk, 1990). `scale`
/// is how much less radiance is where the path is than where it started, because of the index of refraction alone:
/// light that is spread so is not lost.
///
/// Dividing by it must not let the throughput grow from round to round: after k rounds of reflectance ρ and survival q
/// the second moment is (ρ²/q)ᵏ, whose sum over k is finite only for q > ρ². A fixed bound such as the usual 0.95
/// breaks that in bright surroundings, and the error bar with it. By the root of the throughput, both settle at ρ, and
/// up to a reflectance of 0.9998 the bound is never reached. The throughput itself would do as well, but ends paths
/// earlier than pays: it costs more in error than it saves in time, and has a longer tail.
#[inline]
pub(super) fn survival(throughput: Rgb, scale: f64) -> f64 {
    (throughput.max() * scale).sqrt().min(SURVIVAL)
}

/// The same where a medium has scattered a path, out of which light gets sooner or later, so that none has to be ended
/// that has lost nothing.
///
/// Such a path finds about as much at each of many points as at the last, and to end it early costs more than at
/// surfaces: none is ended that brings a quarter. Then the second moment settles as [`survival`] has it.
#[inline]
pub(super) fn survival_among(throughput: Rgb, scale: f64) -> f64 {
    (4.0 * throughput.max() * scale).min(1.0)
}

/// Whether glass holds light that goes on in a direction: it is reflected where it could go through.
#[inline]
pub(super) fn is_held(transmits: bool, is_single: bool, is_through: bool) -> bool {
    transmits && is_single && !is_through
}

/// The greatest probability to survive a round for light that glass has held so many times in a row.
///
/// Light that is reflected totally loses nothing, and in a block or a ball of glass it is so for ever: its angles stay
/// the same. It brings nothing to anybody, and to end it costs nothing. Where it is not for ever, as in a cut stone, of
/// whose ways the share that is left falls by much more than this from round to round, the second moment of what comes
/// out stays finite as [`survival`] has it.
#[inline]
pub(super) fn held(times: u32) -> f64 {
    /// Of all light that stays less long in glass, none is ended so.
    const AT_LEAST: u32 = 64;
    if times < AT_LEAST { 1.0 } else { 1.0 - 1.0 / 32.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survival_settles_at_the_reflectance() {
        for reflectance in [0.5, 0.9, 0.999] {
            let mut throughput = 1.0;
            for _ in 0..100 {
                throughput *= reflectance;
                throughput /= survival(Rgb::splat(throughput), 1.0);
            }
            assert!((survival(Rgb::splat(throughput * reflectance), 1.0) - reflectance).abs() < 1e-9);
        }
        // Among media as well, where as much is left of what has lost nothing.
        let mut throughput = 1.0;
        for _ in 0..200 {
            throughput *= 0.9 / survival_among(Rgb::splat(throughput * 0.9), 1.0);
        }
        assert!((survival_among(Rgb::splat(throughput * 0.9), 1.0) - 0.9).abs() < 1e-9);
        assert_eq!(survival_among(Rgb::splat(0.25), 1.0), 1.0);
        // Light that has gone into glass of index 2 is a quarter as bright there, and goes on as surely.
        assert_eq!(survival(Rgb::splat(0.2), 4.0), survival(Rgb::splat(0.8), 1.0));
    }
}
