//! Light sampling by lanes equals scalar sampling bit for bit.

use super::super::{ConstantEnvironment, DirectionalLight, Light, LightContextLanes, LightLanes, LightSampleContext};
use super::{FLOOR, white};
use crate::fixtures::{rectangle, scene, shape};
use crate::{LightSample, Scene, SceneDescription, Shape};
use raywright_base::math::{DVec3, LANES};
use raywright_base::sampling::Sampler;
use raywright_base::sampling::warp::uniform_sphere;
use raywright_base::simd::Level;
use raywright_shapes::{Disk, Sphere};
use std::array::from_fn;
use std::sync::Arc;

const BALL: Sphere = Sphere { center: DVec3::new(0.3, -0.2, 2.0), radius: 0.5 };

fn round(surface: impl raywright_shapes::Shape + 'static) -> Shape {
    let surface: Arc<dyn raywright_shapes::Shape> = Arc::new(surface);
    Shape { surface: surface.into(), emission: white(3.0).into(), ..Shape::default() }
}

/// Scenes with combinations of a panel, spheres, a disk and infinite lights.
fn scenes() -> Vec<Scene> {
    let panel = || shape(rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]), [0.0; 3], 1.0);
    let small = Sphere { center: DVec3::new(1e3, 0.0, 1.0), radius: 1e-6 };
    let center = DVec3::new(0.0, 3.0, 1.0);
    let disk = Disk { center, normal: DVec3::NEG_Y, radius: 0.5, inner_radius: 0.0 };
    let sky = || Arc::new(ConstantEnvironment { radiance: white(0.2) }) as Arc<dyn Light>;
    let sun = || Arc::new(DirectionalLight::new(DVec3::NEG_Z, white(1.0))) as Arc<dyn Light>;
    let with = |shapes: Vec<Shape>, lights| scene(SceneDescription { shapes, lights });
    vec![
        with(vec![panel()], vec![]),
        with(vec![round(BALL)], vec![]),
        with(vec![panel(), round(BALL), round(small)], vec![]),
        with(vec![panel(), round(BALL), round(disk)], vec![]),
        with(vec![panel(), round(BALL)], vec![sky()]),
        with(vec![], vec![sky()]),
        with(vec![], vec![sun()]),
        with(vec![panel()], vec![sky(), sun()]),
    ]
}

/// Receivers around them: also inside a sphere, on it, and with light from all directions.
fn receiver(number: u32) -> LightSampleContext {
    let mut sampler = Sampler::new(3, 0, number);
    let normal = uniform_sphere(sampler.two(0));
    let position = match number % 5 {
        0 => BALL.center + normal * (BALL.radius * sampler.one(2)),
        1 => BALL.center + normal * BALL.radius,
        2 => FLOOR.position,
        _ => uniform_sphere(sampler.two(2)) * (4.0 * sampler.one(4)),
    };
    if number.is_multiple_of(7) {
        LightSampleContext::free(position)
    } else {
        LightSampleContext { position, normal, waves: None }
    }
}

fn bits(light: Option<LightSample>) -> Option<Vec<u64>> {
    light.map(|light| {
        let source = light.source.map(|from| [from.position(), from.ray(light.direction).origin]);
        let vectors = [light.direction].into_iter().chain(source.into_iter().flatten());
        let numbers = vectors.flat_map(|v: DVec3| v.to_array()).chain(light.weight.to_array());
        let numbers = numbers.chain([light.pdf, f64::from(light.primitive)]);
        numbers.map(f64::to_bits).collect()
    })
}

#[test]
fn lanes_have_the_light_of_each_draw_at_every_level() {
    for (which, scene) in scenes().iter().enumerate() {
        let (lights, geometry) = (scene.lights(), scene.geometry());
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let (mut lanes, mut receivers) = (LightLanes::NONE, LightContextLanes::NONE);
            for block in 0..40 {
                let own: [LightSampleContext; LANES] = from_fn(|lane| receiver(block * LANES as u32 + lane as u32));
                let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
                for (lane, one) in own.iter().enumerate() {
                    let mut sampler = Sampler::new(4, block, lane as u32);
                    receivers.set(lane, one);
                    choice[lane] = sampler.one(0);
                    [u[0][lane], u[1][lane]] = sampler.two(1);
                }
                let at = |lane: usize| [u[0][lane], u[1][lane]];
                lights.sample_lanes(level, geometry, &receivers, &choice, &u, &mut lanes);
                for lane in 0..LANES {
                    let wanted = lights.sample(geometry, &own[lane], choice[lane], at(lane));
                    assert_eq!(bits(lanes.sample(lane)), bits(wanted), "{which} {level:?} {:?}", own[lane]);
                }
                for one in 0..lights.few() {
                    lights.sample_one_lanes(one, level, geometry, &receivers, &choice, &u, &mut lanes);
                    for lane in 0..LANES {
                        let wanted = lights.sample_one(one, geometry, &own[lane], &mut || choice[lane], at(lane));
                        assert_eq!(bits(lanes.sample(lane)), bits(wanted), "{which} {one} {level:?} {:?}", own[lane]);
                    }
                }
            }
        }
    }
}
