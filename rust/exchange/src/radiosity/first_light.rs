//! Direct irradiance of patches from lights that are not surfaces.

use super::Enclosure;
use super::origins::Origin;
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{LightSampleContext, RayOrigin, Scene};

/// Sources per parallel task, between checks for cancellation.
const TOGETHER: usize = 256;

/// The irradiance of each source from a scene with lights only, by light sampling with the given number of rays per
/// source. Objects in `scene` cast shadows.
pub(super) fn irradiance(
    scene: &Scene,
    lamps: &Scene,
    enclosure: &Enclosure,
    rays: &[u32],
    seed: u64,
    cancel: &Cancel,
) -> Vec<Rgb> {
    let of = |source: u32, count: u32| {
        let (mut shadows, mut brought) = (Vec::new(), Vec::new());
        let kind = SamplerKind::Sobol(BatchSize::new(64).unwrap_or_default());
        for number in 0..count {
            let mut sampler = kind.sampler(seed, source, number);
            let Some(origin) = Origin::draw(scene, enclosure, source, sampler.two(0)) else { continue };
            if enclosure.is_touched(origin.place()) {
                continue;
            }
            let normal = origin.surface.normal * origin.side;
            let from = RayOrigin::new(&origin.surface);
            let receiver = LightSampleContext { position: from.ray(normal).origin, normal, waves: None };
            let drawn = lamps.lights().sample(lamps.geometry(), &receiver, sampler.one(2), sampler.two(3));
            let Some(light) = drawn else { continue };
            let cosine = light.direction.dot(normal);
            if cosine > 0.0 {
                let ray = light.source.map_or_else(|| from.ray(light.direction), |source| from.segment(&source));
                shadows.push(origin.past_itself(ray));
                brought.push(light.weight * (cosine / f64::from(count)));
            }
        }
        let mut occluded = vec![false; shadows.len()];
        scene.occluded(&shadows, &mut occluded);
        brought.iter().zip(&occluded).filter(|(_, occluded)| !**occluded).map(|(light, _)| *light).sum::<Rgb>()
    };
    let mut found = vec![Rgb::ZERO; rays.len()];
    parallel::each_chunk_mut(&mut found, TOGETHER, &|first, found| {
        if !cancel.is_raised() {
            for (source, found) in (first..).zip(found) {
                *found = of(source as u32, rays[source]);
            }
        }
    });
    found
}

#[cfg(test)]
mod tests {
    use super::super::Sides;
    use super::*;
    use raywright_scene::fixtures::{rectangle, scene, shape};
    use raywright_scene::{ConstantEnvironment, Patches, SceneDescription};
    use std::f64::consts::PI;
    use std::sync::Arc;

    #[test]
    fn an_even_sky_brings_pi_times_its_radiance_to_what_lies_open() {
        let floor = rectangle([0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        let scene_of = |shapes, lights| scene(SceneDescription { shapes, lights });
        let floor = scene_of(vec![shape(floor, [0.5; 3], 0.0)], vec![]);
        let sky = scene_of(vec![], vec![Arc::new(ConstantEnvironment { radiance: Rgb::new(1.0, 2.0, 3.0) }) as _]);
        let patches = Patches::new(vec![2; 2]).unwrap();
        let enclosure = Enclosure::new(&floor, patches, Sides::Both).unwrap();
        let found = irradiance(&floor, &sky, &enclosure, &[4096; 16], 3, &Cancel::default());
        // 4096 samples from nets of 64, each accurate to better than 1 in 10.
        for light in found {
            assert!((light - Rgb::new(1.0, 2.0, 3.0) * PI).abs().max() < 0.01 * PI, "{light:?}");
        }
    }
}
