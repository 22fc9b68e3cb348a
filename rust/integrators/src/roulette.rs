//! Russian roulette.

use raywright_optics::Rgb;

/// Number of bounces after which roulette starts regardless of settings, so that every path ends.
pub(super) const AT_LATEST: u32 = 4096;

/// Maximum survival probability of a round: a path in a closed box of albedo 1 ends after some four thousand bounces.
pub(super) const SURVIVAL: f64 = 1.0 - 1.0 / 4096.0;

/// Return the probability that a path of this throughput survives a round of Russian roulette (Arvo and Kirk, 1990).
/// `scale` is the ratio of radiance here to radiance at the start of the path due to the index of refraction alone.
/// Such a change of radiance is no loss.
///
/// Division by it must not let the throughput grow from round to round. After k rounds of reflectance ρ and survival q
/// the second moment is (ρ²/q)ᵏ, whose sum over k is finite only for q > ρ². A fixed bound such as the usual 0.95
/// violates that in bright scenes, and invalidates the error estimate. With the square root of the throughput, both
/// settle at ρ, and up to a reflectance of 0.9998 the bound is never reached. The throughput itself would also work,
/// but it terminates paths too early: the added error outweighs the time saved, and has a longer tail.
#[inline]
pub(super) fn survival(throughput: Rgb, scale: f64) -> f64 {
    (throughput.max() * scale).sqrt().min(SURVIVAL)
}

/// Return the survival probability after scattering in a medium. Light leaves a medium eventually, so paths without
/// loss need not be terminated.
///
/// Such a path contributes about as much at each of many vertices, and early termination costs more than at surfaces.
/// No path with a throughput of at least a quarter is terminated. Below it the second moment settles as in
/// [`survival`].
#[inline]
pub(super) fn survival_among(throughput: Rgb, scale: f64) -> f64 {
    (4.0 * throughput.max() * scale).min(1.0)
}

/// Return whether transmissive glass reflects light specularly in a direction.
#[inline]
pub(super) fn is_held(transmits: bool, is_single: bool, is_through: bool) -> bool {
    transmits && is_single && !is_through
}

/// Return the maximum survival probability of light after a number of consecutive reflections by glass.
///
/// Total internal reflection loses nothing, and in a block or a ball of glass it lasts forever: the angles stay the
/// same. Such light contributes nothing, so its termination costs nothing. In a cut stone it does not last: the share
/// of light left inside falls much faster per round than this probability. So the second moment of the emerging light
/// stays finite as in [`survival`].
#[inline]
pub(super) fn held(times: u32) -> f64 {
    /// Number of reflections before this roulette starts.
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
        // In media as well, from the initial survival of paths without loss on.
        let mut throughput = 1.0;
        for _ in 0..200 {
            throughput *= 0.9 / survival_among(Rgb::splat(throughput * 0.9), 1.0);
        }
        assert!((survival_among(Rgb::splat(throughput * 0.9), 1.0) - 0.9).abs() < 1e-9);
        assert_eq!(survival_among(Rgb::splat(0.25), 1.0), 1.0);
        // A path into glass of index 2 has a quarter of the throughput and a `scale` of 4: it survives equally.
        assert_eq!(survival(Rgb::splat(0.2), 4.0), survival(Rgb::splat(0.8), 1.0));
    }
}
