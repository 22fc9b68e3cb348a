//! Estimate of the bias of density estimation (photon gathering).

use super::{Progress, RenderError, Settings, Until, render};
use raywright_integrators::Integrator;
use raywright_optics::Rgb;
use raywright_scene::{Camera, Scene};

/// Maximum and minimum number of samples for the estimate.
const SAMPLES: [u32; 2] = [16, 4];

/// Maximum number of groups, each with its own photons; their spread measures the noise.
const GROUPS: u32 = 8;

/// Estimates the bias of each pixel of a picture with this many samples, and its standard error, from a few samples.
/// Returns `None` for an unbiased integrator.
///
/// The same samples and photons are evaluated with disks of radius r, r/√2 and r/2, so that common noise cancels in the
/// differences. If the bias is proportional to r², the first two disks give it as 2 (E(r) − E(r/√2)), and the last two
/// as 4 (E(r/√2) − E(r/2)), with some three times the noise. If the two estimates differ by more than noise explains,
/// the law is another, and the larger is returned.
pub fn bias(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn Integrator,
    settings: &Settings,
    samples: u32,
    progress: &mut dyn Progress,
) -> Result<Option<Vec<[Rgb; 2]>>, RenderError> {
    let [most, least] = SAMPLES;
    let few = samples.div_ceil(4).clamp(least, most);
    let groups = few.min(GROUPS);
    let mut sums = Vec::new();
    for group in 0..groups {
        // Offset by the golden ratio, to be far from the seeds of other pictures.
        let seed = settings.seed.wrapping_add(u64::from(group).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let until = Until { samples: Some(few / groups), ..Until::default() };
        let settings = Settings { until, seed, ..settings.clone() };
        let mut means = Vec::new();
        for scale in [1.0, std::f64::consts::FRAC_1_SQRT_2, 0.5] {
            let Some(narrowed) = integrator.narrowed(scale, samples) else { return Ok(None) };
            means.push(render(scene, camera, &*narrowed, &settings, progress)?.film.means());
        }
        sums.resize(means[0].len(), BiasSums::default());
        for (i, sums) in sums.iter_mut().enumerate() {
            sums.add(means[0][i], means[1][i], means[2][i]);
        }
    }
    Ok(Some(sums.iter().map(|sums| sums.told(f64::from(groups))).collect()))
}

/// Sums over groups of a pixel's estimates from three disks, each with half the area of the previous one: by the first
/// two, by the last two, and their difference.
#[derive(Clone, Copy, Debug, Default)]
struct BiasSums {
    sums: [Rgb; 3],
    squares: [Rgb; 3],
}

impl BiasSums {
    /// Significant difference, in standard errors.
    const APART: f64 = 4.0;

    /// Adds a group's estimates from the three disks.
    fn add(&mut self, whole: Rgb, half: Rgb, quarter: Rgb) {
        let (first, second) = (2.0 * (whole - half), 4.0 * (half - quarter));
        for (k, told) in [first, second, second - first].into_iter().enumerate() {
            self.sums[k] += told;
            self.squares[k] += told * told;
        }
    }

    /// Bias and its standard error.
    fn told(&self, groups: f64) -> [Rgb; 2] {
        let channel = |c: usize| {
            let [first, second, more] = [0, 1, 2].map(|k| {
                let (mean, square) = (self.sums[k][c] / groups, self.squares[k][c] / groups);
                (mean, ((square - mean * mean).max(0.0) / (groups - 1.0)).sqrt())
            });
            let (a, b) = (first.0.abs(), second.0.abs());
            let differ = more.0.abs() > 0.25 * a.max(b) && more.0.abs() > Self::APART * more.1;
            if differ && b > a { second } else { first }
        };
        let [(red, e), (green, f), (blue, g)] = [0, 1, 2].map(channel);
        [Rgb::new(red, green, blue), Rgb::new(e, f, g)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Quiet;
    use super::*;
    use raywright_integrators::{Path, PhotonMap, ProgressivePhotonMap};
    use raywright_scene::fixtures::cornell;

    #[test]
    fn bias_is_told_by_its_law() {
        let law = |power: f64| [1.0, 0.5f64.sqrt(), 0.5].map(|r: f64| Rgb::splat(2.0 + r.powf(power)));
        // Exact for r²; for r⁴ and r the larger estimate, which is 1.5 and 0.83 of the bias.
        for (power, expected) in [(2.0, 1.0), (4.0, 1.5), (1.0, 0.828_427_124_746_19)] {
            let [whole, half, quarter] = law(power);
            let mut sums = BiasSums::default();
            (0..4).for_each(|_| sums.add(whole, half, quarter));
            let [told, error] = sums.told(4.0);
            assert!((told.mean() - expected).abs() < 1e-12 && error.max() < 1e-7);
        }
        let mut sums = BiasSums::default();
        (0..4).for_each(|_| sums.add(Rgb::ONE, Rgb::ONE, Rgb::ONE));
        assert!(sums.told(4.0)[0].is_black());
    }

    #[test]
    fn noise_is_told_and_not_taken_for_another_law() {
        // The noise of the smaller disks exceeds their signal.
        let mut sums = BiasSums::default();
        for noise in [0.3, -0.2, 0.1, -0.3] {
            sums.add(Rgb::splat(2.0), Rgb::splat(1.9 + 0.1 * noise), Rgb::splat(1.8 + noise));
        }
        let [told, error] = sums.told(4.0);
        assert!((told.mean() - 0.205).abs() < 1e-12);
        // 0.2 of the standard deviation of the four, over the square root of their number.
        assert!((error.mean() - 0.2 * 0.275_378_527_364_305 / 2.0).abs() < 1e-12);
    }

    #[test]
    fn only_what_gathers_is_biased() {
        let (scene, camera) = cornell(6, 6);
        let settings = Settings { threads: Some(2), ..Settings::default() };
        let of = |way: &dyn Integrator| bias(&scene, &camera, way, &settings, 4, &mut Quiet).unwrap();
        assert!(of(&Path::default()).is_none());
        let progressive = ProgressivePhotonMap { photons: Some(2000), ..Default::default() };
        let found = of(&progressive).unwrap();
        assert!(found.len() == 36 && found.iter().all(|[bias, error]| bias.is_black() || error.max() > 0.0));
        assert!(found.iter().any(|[bias, _]| !bias.is_black()));
        assert!(of(&PhotonMap { photons: 2000, ..Default::default() }).is_some());
    }
}
