//! How far a picture may be off because light is gathered from about a point, and not at it.

use super::{Progress, RenderError, Settings, Until, render};
use raywright_integrators::Integrator;
use raywright_optics::Rgb;
use raywright_scene::{Camera, Scene};

/// Samples by which it is told, at most.
const SAMPLES: u32 = 16;

/// The bias of each pixel of a picture of so many samples, told by a few of them; `None` of an integrator that gathers
/// no light from about.
///
/// The same samples by the same photons are taken of disks of the radius r, of r/√2 and of r/2: noise that they share
/// falls out of their differences. Where the law of the bias is r², the first two tell it, E − 2 E(r/√2) + E(r) less
/// than E; and so do the last two, of a quarter of it. Where they do not agree, the law is another, and the larger is
/// told.
pub fn bias(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn Integrator,
    settings: &Settings,
    samples: u32,
    progress: &mut dyn Progress,
) -> Result<Option<Vec<Rgb>>, RenderError> {
    let few = samples.div_ceil(4).clamp(1, SAMPLES);
    let until = Until { samples: Some(few.min(samples.max(1))), ..Until::default() };
    let settings = Settings { until, ..settings.clone() };
    let mut means = Vec::new();
    for scale in [1.0, std::f64::consts::FRAC_1_SQRT_2, 0.5] {
        let Some(narrowed) = integrator.narrowed(scale, samples) else { return Ok(None) };
        means.push(render(scene, camera, &*narrowed, &settings, progress)?.film.means());
    }
    let told = |i: usize| told(means[0][i], means[1][i], means[2][i]);
    Ok(Some((0..means[0].len()).map(told).collect()))
}

/// The bias of the first of three estimates, of disks of which each has half the area of the one before.
fn told(whole: Rgb, half: Rgb, quarter: Rgb) -> Rgb {
    let (first, second) = (2.0 * (whole - half), 4.0 * (half - quarter));
    let larger = |a: f64, b: f64| {
        let agree = (a - b).abs() <= 0.25 * a.abs().max(b.abs());
        if agree || a.abs() >= b.abs() { a } else { b }
    };
    let ([a, b, c], [d, e, f]) = (first.to_array(), second.to_array());
    Rgb::new(larger(a, d), larger(b, e), larger(c, f))
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
        // r² exactly; r⁴ and r, which is nearer to half of it, by the larger.
        for (power, expected) in [(2.0, 1.0), (4.0, 1.5), (1.0, 0.828_427_124_746_19)] {
            let [whole, half, quarter] = law(power);
            assert!((told(whole, half, quarter).mean() - expected).abs() < 1e-12);
        }
        assert!(told(Rgb::ONE, Rgb::ONE, Rgb::ONE).is_black());
    }

    #[test]
    fn only_what_gathers_is_biased() {
        let (scene, camera) = cornell(6, 6);
        let settings = Settings { threads: Some(2), ..Settings::default() };
        let of = |way: &dyn Integrator| bias(&scene, &camera, way, &settings, 4, &mut Quiet).unwrap();
        assert!(of(&Path::default()).is_none());
        let progressive = ProgressivePhotonMap { photons: Some(2000), ..Default::default() };
        let found = of(&progressive).unwrap();
        assert!(found.len() == 36 && found.iter().any(|bias| !bias.is_black()));
        assert!(of(&PhotonMap { photons: 2000, ..Default::default() }).is_some());
    }
}
