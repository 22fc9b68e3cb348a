//! Stages of media, nested dielectrics and wavelengths against paths that are followed one by one in f64.

use super::job;
use super::one_by_one::OneByOne;
use super::wavefront::assert_equal_samples;
use crate::path_settings::PathSettings;
use crate::wavefront::{Wavefront, f32_holds};
use raywright_base::math::DVec3;
use raywright_optics::{Dispersion, Dispersive, Phase, Rgb};
use raywright_scene::fixtures::{rectangle, scene, shape};
use raywright_scene::materials::{BoundaryMaterial, DielectricMaterial, Interior};
use raywright_scene::media::{Homogeneous, Medium};
use raywright_scene::{ConstantEnvironment, Light, Material, PointLight, Scene, SceneDescription, Shape};
use raywright_shapes::Sphere;
use std::sync::Arc;

const DEPTH: u32 = 6;

pub(super) fn haze(scattering: [f64; 3], emission: f64) -> Arc<dyn Medium> {
    let (absorption, scattering) = (Rgb::splat(0.1), Rgb::from_array(scattering));
    let haze = Homogeneous::new(absorption, scattering, Rgb::splat(emission), Phase::Rayleigh);
    Arc::new(haze.expect("a medium"))
}

fn ball(center: DVec3, radius: f64, material: impl Material + 'static) -> Shape {
    let sphere: Arc<dyn raywright_shapes::Shape> = Arc::new(Sphere { center, radius });
    Shape { surface: sphere.into(), material: Arc::new(material), ..floor() }
}

pub(super) fn smoke(center: DVec3, radius: f64, medium: &Arc<dyn Medium>) -> Shape {
    ball(center, radius, BoundaryMaterial { medium: Arc::clone(medium), priority: 0 })
}

pub(super) fn glass(center: DVec3, radius: f64, interior: Interior) -> Shape {
    ball(center, radius, DielectricMaterial { interior, roughness: 0.0.into(), medium: None })
}

pub(super) fn floor() -> Shape {
    shape(rectangle([-4.0, 0.0, -4.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0]), [0.7, 0.5, 0.2], 0.0)
}

pub(super) fn lamp() -> Shape {
    shape(rectangle([-0.5, 3.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.0; 3], 20.0)
}

/// The camera is in the middle of it.
const FROM: DVec3 = DVec3::new(0.1, 1.1, 2.5);

#[track_caller]
fn assert_same(scene: &Scene) {
    assert!(f32_holds(scene));
    let settings = PathSettings::path(Some(DEPTH), u32::MAX);
    let oracle = OneByOne::new(job(scene), settings);
    assert_equal_samples(&Wavefront::new(job(scene), settings, None, None), &oracle, FROM);
    assert_equal_samples(&Wavefront::new(job(scene), settings, None, None).with_light_in_f64(), &oracle, FROM);
}

pub(super) fn of(shapes: Vec<Shape>, lights: Vec<Arc<dyn Light>>) -> Scene {
    scene(SceneDescription { shapes, lights })
}

pub(super) fn sky() -> Arc<dyn Light> {
    Arc::new(ConstantEnvironment { radiance: Rgb::new(0.5, 0.7, 1.0) })
}

#[test]
fn haze_of_any_color_scatters_and_shines() {
    let above = DVec3::new(0.0, 1.5, 0.0);
    for (scattering, emission) in [([0.6; 3], 0.0), ([0.2, 0.9, 3.0], 0.0), ([0.5, 0.4, 0.1], 0.2)] {
        let medium = haze(scattering, emission);
        assert_same(&of(vec![floor(), lamp(), smoke(above, 1.2, &medium)], vec![]));
        assert_same(&of(vec![floor(), smoke(above, 1.2, &medium)], vec![sky()]));
    }
}

#[test]
fn the_camera_may_be_within_and_media_may_overlap_and_touch() {
    let (one, other) = (haze([0.3, 0.2, 0.4], 0.0), haze([1.0, 0.5, 0.2], 0.0));
    let inside = smoke(DVec3::new(0.0, 1.5, 1.0), 2.0, &one);
    let crossing = smoke(DVec3::new(1.0, 1.0, 0.0), 1.0, &other);
    assert_same(&of(vec![floor(), lamp(), inside, crossing], vec![]));
    let fog = of(vec![floor(), lamp()], vec![]).surrounded_by(Some(one));
    assert_same(&fog);
}

#[test]
fn points_light_a_fog_along_rays() {
    let point = || Arc::new(PointLight { position: DVec3::new(0.5, 1.0, 0.0), intensity: Rgb::new(3.0, 2.0, 1.0) });
    let medium = haze([0.3, 0.5, 0.2], 0.0);
    assert_same(&of(vec![floor(), smoke(DVec3::new(0.0, 1.2, 0.0), 1.1, &medium)], vec![point()]));
    assert_same(&of(vec![floor()], vec![point(), sky()]).surrounded_by(Some(medium)));
}

#[test]
fn glass_stands_in_haze_and_in_glass() {
    let medium = haze([0.2, 0.3, 0.4], 0.0);
    let (place, inner) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.1, 0.9, 0.0));
    let nested =
        || vec![floor(), lamp(), glass(place, 0.9, Interior::new(1.5, 0)), glass(inner, 0.5, Interior::new(1.3, 1))];
    assert_same(&of(nested(), vec![sky()]));
    assert_same(&of(nested(), vec![]).surrounded_by(Some(medium)));
}

#[test]
fn wavelengths_part_in_glass_in_glass_and_in_haze() {
    let dispersion = Dispersive::of(Dispersion::Cauchy([1.45, 0.03])).expect("room for one more");
    let disperses = Interior { ior: 1.53, dispersion, priority: 0 };
    let place = DVec3::new(0.0, 1.0, 0.0);
    let lone = || vec![floor(), lamp(), glass(place, 0.9, disperses)];
    let nested = || lone().into_iter().chain([glass(place, 0.4, Interior::new(1.2, 1))]).collect();
    assert_same(&of(lone(), vec![sky()]));
    assert_same(&of(nested(), vec![sky()]));
    assert_same(&of(lone(), vec![]).surrounded_by(Some(haze([0.2, 0.3, 0.4], 0.0))));
}
