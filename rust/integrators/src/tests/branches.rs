//! Paths that split, several light samples and ambient light by stages, against paths that are followed one by one in
//! f64.

use super::flights::{self, floor, glass, lamp, smoke};
use super::wavefront::{assert_each_on_its_own, assert_same_by};
use super::{job, kinds};
use crate::path_settings::{Follow, PathSettings};
use crate::{CameraSample, Integrator, PhotonMap, Whitted};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::{Sampler, warp};
use raywright_base::workers::Cancel;
use raywright_optics::{Conductor, Mirror, Rgb};
use raywright_scene::fixtures::{cornell, rectangle};
use raywright_scene::materials::Interior;
use raywright_scene::{Scene, Shape};

const EYE: DVec3 = DVec3::new(0.1, 1.1, 2.5);

/// Glass, a mirror and rough metal on a matte floor under a lamp.
fn shapes() -> Vec<Shape> {
    let panel = |x: f32| rectangle([x, 0.1, -1.0], [0.0, 0.0, 2.0], [0.4, 1.5, 0.0]);
    let metal = Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), [0.4; 2]);
    let mirror = kinds::of(panel(-1.8), Mirror { reflectance: Rgb::new(0.9, 0.8, 0.7) });
    vec![
        floor(),
        lamp(),
        glass(DVec3::new(0.0, 1.0, 0.0), 0.6, Interior::new(1.5, 0)),
        mirror,
        kinds::of(panel(1.5), metal),
    ]
}

fn scenes() -> Vec<Scene> {
    let haze = flights::haze([0.2, 0.3, 0.4], 0.0);
    let nested = || shapes().into_iter().chain([glass(DVec3::new(0.1, 0.9, 0.0), 0.3, Interior::new(1.3, 1))]);
    let hazy = nested().chain([smoke(DVec3::new(0.8, 1.0, 0.8), 0.7, &haze)]);
    vec![
        flights::of(shapes(), vec![]),
        flights::of(shapes(), vec![flights::sky()]),
        flights::of(nested().collect(), vec![flights::sky()]),
        flights::of(hazy.collect(), vec![]),
    ]
}

#[test]
fn both_directions_of_glass_are_followed() {
    let dimmed = PathSettings { follow: Follow::DeltaLobes, ..PathSettings::dimmed(5) };
    for scene in &scenes() {
        assert_same_by(scene, dimmed, EYE);
        assert_same_by(scene, PathSettings { least: 0.02, light_samples: 3, ..dimmed }, EYE);
        assert_same_by(scene, PathSettings { ambient: Rgb::new(0.3, 0.2, 0.1), ..dimmed }, EYE);
    }
}

#[test]
fn the_first_surface_splits_paths() {
    for scene in &scenes() {
        for (light_samples, splits) in [(1, 3), (4, 1), (2, 5)] {
            assert_same_by(scene, PathSettings { light_samples, splits, ..PathSettings::dimmed(1) }, EYE);
        }
        let gloss = PathSettings { follow: Follow::MinDensity(1.0), ..PathSettings::dimmed(4) };
        assert_same_by(scene, PathSettings { ambient: Rgb::splat(0.2), ..gloss }, EYE);
        assert_same_by(scene, PathSettings { light_samples: 4, splits: 4, ..gloss }, EYE);
    }
    let (cornell, _) = cornell(4, 4);
    let cast = PathSettings { follow: Follow::Nothing, ambient: Rgb::splat(0.2), ..PathSettings::dimmed(1) };
    assert_same_by(&cornell, cast, DVec3::new(0.5, 0.6, 0.9));
    assert_same_by(&cornell, PathSettings { light_samples: 3, ..cast }, DVec3::new(0.5, 0.6, 0.9));
}

#[test]
fn what_a_sample_of_split_paths_finds_depends_on_no_other() {
    let (whitted, maps) = (Whitted::default(), PhotonMap { gather: 3, ..PhotonMap::default() });
    for scene in &scenes()[..2] {
        for integrator in [&whitted as &dyn Integrator, &maps] {
            let session = integrator.begin(job(scene), &Cancel::default());
            session.before_samples(0..1, false, &Cancel::default());
            let sample = |pixel| {
                let mut sampler = Sampler::new(3, pixel, 0);
                CameraSample { ray: Ray::new(EYE, warp::uniform_sphere(sampler.two(0))), sampler }
            };
            let samples: Vec<_> = (0..1500).map(sample).collect();
            assert_each_on_its_own(&*session, &samples, &[1, 7, 100]);
        }
    }
}
