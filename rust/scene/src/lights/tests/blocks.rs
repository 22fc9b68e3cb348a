//! Light drawn for sixteen points against that of each point alone.

use crate::fixtures::{rectangle, scene, shape};
use crate::geometry::SurfaceBlock;
use crate::lights::{LightBlock, LightSampleContext, ReceiverBlock};
use crate::textures::{Spectral, Value};
use crate::{Emission, SceneDescription, Shape, Sides};
use raywright_base::math::{DVec3, LANES, SingleLanes, Vec3};
use raywright_base::sampling::Sampler;
use raywright_base::simd::Level;
use raywright_optics::Rgb;
use raywright_optics::spectra::{Role, Smooth, Spectrum, Waves};
use raywright_shapes::Sphere;
use std::array::from_fn;
use std::sync::Arc;

/// Emission with a spectrum.
fn spectral(colour: [f64; 3]) -> Emission {
    let spectrum = Spectrum::Smooth(Smooth::of(Rgb::from_array(colour), Role::Amount));
    Emission { radiance: Value::Texture(Arc::new(Spectral::new(Arc::new(spectrum)))), sides: Sides::Both }
}

#[test]
fn lamps_shine_by_wavelength() {
    let triangles = || {
        let lamp = |x: f32, colour| {
            let lamp = shape(rectangle([x, -1.0, 3.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.0; 3], 0.0);
            Shape { emission: spectral(colour), ..lamp }
        };
        vec![lamp(-3.0, [4.0, 1.0, 0.5]), lamp(1.0, [0.2, 2.0, 7.0])]
    };
    let sphere = || {
        let surface =
            Arc::new(Sphere { center: DVec3::new(0.0, 2.0, 4.0), radius: 0.7 }) as Arc<dyn raywright_shapes::Shape>;
        Shape { surface: surface.into(), emission: spectral([1.0, 3.0, 0.1]), ..Shape::default() }
    };
    let grey = || shape(rectangle([4.0, 4.0, 5.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0; 3], 9.0);
    let all = || triangles().into_iter().chain([sphere(), grey()]).collect::<Vec<_>>();
    for shapes in [triangles(), all()] {
        let scene = scene(SceneDescription { shapes, ..Default::default() });
        let lights = scene.lights();
        let mut surfaces = SurfaceBlock { count: LANES, ..SurfaceBlock::NONE };
        let (mut normal, mut drawn) = (SingleLanes::ZERO, LightBlock::NONE);
        let mut lit = 0;
        for number in 0..64 {
            let mut samplers: [Sampler; LANES] = from_fn(|lane| Sampler::new(5, lane as u32, number));
            let waves = from_fn(|lane| (lane != 3).then(|| Waves::of(samplers[lane].one(2))));
            for lane in 0..LANES {
                let [x, y] = samplers[lane].two(4);
                surfaces.position.set(lane, DVec3::new(x, y, 0.0));
                surfaces.origin.set(lane, DVec3::new(x, y, 0.0));
                normal.set(lane, Vec3::Z);
            }
            let choice = from_fn(|lane| samplers[lane].one(0));
            let u = samplers.map(|mut sampler| sampler.two(1).map(|u| u as f32));
            let columns = [0, 1].map(|i| from_fn(|lane| u[lane][i]));
            let receivers = ReceiverBlock { surfaces: &surfaces, normal: &normal, waves: &waves };
            lights.draw_block(Level::current().unwrap(), scene.geometry(), &receivers, &choice, &columns, &mut drawn);
            for lane in 0..LANES {
                let position = surfaces.position.get(lane);
                let receiver = LightSampleContext { position, normal: DVec3::Z, waves: waves[lane] };
                let alone = lights.sample(scene.geometry(), &receiver, choice[lane], u[lane].map(f64::from));
                let Some(alone) = alone else {
                    assert_eq!(drawn.pdf[lane], 0.0);
                    continue;
                };
                let (found, truth) = (drawn.weight.get(lane).as_dvec3(), alone.weight.as_vec3().as_dvec3());
                assert!((found - truth).length() < 1e-4 * truth.length(), "{lane}: {found} {truth}");
                lit += 1;
            }
        }
        assert!(lit > 900, "{lit}");
    }
}
