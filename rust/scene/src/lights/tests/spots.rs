//! Delta lights: their power, and invalid parameters.

use super::super::{
    DirectionalLight, Light, LightSample, LightSampleContext, Picture, PointLight, Profile, Projector, Reach, SpotLight,
};
use super::{FLOOR, white};
use raywright_base::math::DVec3;
use raywright_base::sampling::warp::uniform_sphere;
use raywright_optics::Rgb;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Power of a light at the origin: its mean intensity over all directions times 4π.
fn power(light: &dyn Light) -> f64 {
    const SIDE: u32 = 600;
    let cell = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let sent = |i: u32, j: u32| {
        let receiver = LightSampleContext::free(uniform_sphere([cell(i), cell(j)]));
        light.sample(&receiver, [0.5; 2]).map_or(0.0, |sample| sample.weight.mean())
    };
    let sum: f64 = (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))).map(|(i, j)| sent(i, j)).sum();
    sum * 4.0 * PI / f64::from(SIDE * SIDE)
}

fn told_power(light: &dyn Light) -> f64 {
    match light.reach() {
        Reach::Finite { power, .. } => power,
        Reach::Infinite { .. } => panic!("a light inside"),
    }
}

fn spot(angle: f64, falloff: f64) -> SpotLight {
    let axis = DVec3::new(1e-3, -2e-3, 2e-3);
    SpotLight::new(DVec3::ZERO, axis, Rgb::new(1.0, 2.0, 3.0), angle.to_radians(), falloff.to_radians())
}

#[test]
fn powers_are_the_integrals_of_intensities() {
    for (angle, falloff) in [(90.0, 0.0), (90.0, 90.0), (40.0, 10.0), (60.0, 60.0), (25.0, 0.0)] {
        let light = spot(angle, falloff);
        let (sum, told) = (power(&light), told_power(&light));
        // Error of the grid at a sharp rim.
        assert!((sum / told - 1.0).abs() < 5e-3, "{angle} {falloff}: {sum} {told}");
        let light = light.with_profile(Profile::Linear);
        let (sum, told) = (power(&light), told_power(&light));
        assert!((sum / told - 1.0).abs() < 5e-3, "linear, {angle} {falloff}: {sum} {told}");
    }
    // A hemisphere has exactly 2π I.
    assert!((told_power(&spot(90.0, 0.0)) - 4.0 * PI).abs() < 1e-12);
    let point = PointLight { position: DVec3::ZERO, intensity: Rgb::new(1.0, 2.0, 3.0) };
    assert!((power(&point) / told_power(&point) - 1.0).abs() < 1e-12);
    let texels = (0..12u8).map(|i| [f32::from(i), 1.0, 2.0]).collect();
    let picture = Arc::new(Picture::new(4, texels).unwrap());
    let places = [DVec3::ZERO, DVec3::new(0.3, 1.0, 0.2), DVec3::Z];
    let projector = Projector::new(picture, places, 1.2, Rgb::ONE).unwrap();
    // Interpolated to its edges, the image has nearly the mean of its texels.
    assert!((power(&projector) / told_power(&projector) - 1.0).abs() < 5e-3);
}

#[test]
fn a_spot_shines_within_its_cone_and_falls_off_between() {
    let light = SpotLight::new(DVec3::Z, DVec3::NEG_Z * 3.0, Rgb::ONE, 0.6, 0.2);
    let at = |angle: f64| {
        let receiver = LightSampleContext::free(DVec3::new(angle.tan(), 0.0, 0.0));
        let square = 1.0 + angle.tan().powi(2);
        light.sample(&receiver, [0.5; 2]).map_or(0.0, |sample| sample.weight[1] * square)
    };
    assert!((at(0.0) - 1.0).abs() < 1e-12 && (at(0.3999) - 1.0).abs() < 1e-12);
    assert_eq!((at(0.6001), at(1.5)), (0.0, 0.0));
    let middle = (0.5 * (0.4f64.cos() + 0.6f64.cos())).acos();
    assert!((at(middle) - 0.5).abs() < 1e-12);
    let falling: Vec<f64> = (0..=100).map(|i| at(0.4 + 0.002 * f64::from(i))).collect();
    assert!(falling.windows(2).all(|pair| pair[0] >= pair[1]));
    // A negligible falloff removes negligible power.
    let sharp = SpotLight::new(DVec3::Z, DVec3::NEG_Z, Rgb::ONE, 0.6, 1e-15).with_profile(Profile::Linear);
    assert!((told_power(&sharp) - 2.0 * PI * (1.0 - 0.6f64.cos())).abs() < 1e-12);
    // Linear in the angle.
    let straight = light.with_profile(Profile::Linear);
    for (angle, share) in [(0.0, 1.0), (0.4, 1.0), (0.45, 0.75), (0.5, 0.5), (0.59, 0.05), (0.61, 0.0)] {
        let receiver = LightSampleContext::free(DVec3::new(f64::tan(angle), 0.0, 0.0));
        let square = 1.0 + f64::tan(angle).powi(2);
        let found = straight.sample(&receiver, [0.5; 2]).map_or(0.0, |sample| sample.weight[1] * square);
        assert!((found - share).abs() < 1e-12, "{angle}: {found}");
    }
    // Receivers behind the light, and at it.
    assert!(light.sample(&LightSampleContext::free(DVec3::Z * 2.0), [0.5; 2]).is_none());
    assert!(light.sample(&LightSampleContext::free(DVec3::Z), [0.5; 2]).is_none());
}

#[test]
fn a_slide_is_thrown_upright_and_evenly() {
    // Red above green, blue at the upper left, seen from the projector; the screen is perpendicular.
    let texels = vec![[0.0, 0.0, 9.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 9.0, 0.0]];
    let picture = Arc::new(Picture::new(2, texels).unwrap());
    let projector = Projector::new(picture, [DVec3::ZERO, DVec3::NEG_Z, DVec3::Y], FRAC_PI_2, Rgb::splat(2.0)).unwrap();
    let screen = |x: f64, y: f64| {
        let receiver = LightSampleContext { position: DVec3::new(x, y, -1.0), normal: DVec3::Z, waves: None };
        projector.sample(&receiver, [0.5; 2]).map_or(Rgb::ZERO, |s| s.weight * s.direction.dot(DVec3::Z))
    };
    let close = |a: Rgb, b: Rgb| assert!((a - b).abs().max() < 1e-12, "{a} {b}");
    close(screen(-0.9, 0.9), Rgb::new(0.0, 0.0, 18.0));
    close(screen(0.9, 0.9), Rgb::new(18.0, 0.0, 0.0));
    close(screen(-0.9, -0.9), Rgb::new(0.0, 18.0, 0.0));
    close(screen(0.0, 0.9), Rgb::new(9.0, 0.0, 9.0));
    close(screen(1.01, 0.0), Rgb::ZERO);
    close(screen(0.0, -1.01), Rgb::ZERO);
    assert!(projector.sample(&LightSampleContext::free(DVec3::Z), [0.5; 2]).is_none());
}

#[test]
fn a_distant_light_brings_its_irradiance_to_what_faces_it() {
    let light = DirectionalLight::new(DVec3::new(0.0, 3e-200, -4e-200), Rgb::new(1.0, 5.0, 2.0));
    let LightSample { direction, weight, pdf, source, .. } = light.sample(&FLOOR, [0.5; 2]).unwrap();
    assert!((direction - DVec3::new(0.0, -0.6, 0.8)).length() < 1e-15);
    assert!((weight * direction.z)[1] - 4.0 < 1e-12 && pdf == f64::INFINITY && source.is_none());
    assert_eq!(light.infinite_radiance(direction), Rgb::ZERO);
}

#[test]
fn what_cannot_be_is_told() {
    let good = Arc::new(Picture::new(1, vec![[1.0; 3]]).unwrap());
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let why = Picture::new(2, vec![[1.0; 3], [0.0; 3], [0.0, bad, 0.0], [0.0; 3]]).unwrap_err();
        assert!(why.contains("row 1, column 0"), "{why}");
    }
    assert!(Picture::new(0, vec![]).is_err() && Picture::new(3, vec![[0.0; 3]; 4]).is_err());
    let place = [DVec3::ZERO, DVec3::X, DVec3::Y];
    assert!(Projector::new(good.clone(), [DVec3::X, DVec3::X, DVec3::Y], 1.0, Rgb::ONE).is_err());
    assert!(Projector::new(good.clone(), [DVec3::ZERO, DVec3::X, DVec3::X], 1.0, Rgb::ONE).is_err());
    assert!(Projector::new(good.clone(), place, 0.0, Rgb::ONE).unwrap().validate().is_err());
    assert!(Projector::new(good, place, 1.0, white(-1.0)).unwrap().validate().is_err());
    for (angle, falloff) in [(0.0, 0.0), (91.0, 0.0), (-5.0, 0.0), (f64::NAN, 0.0), (30.0, 31.0), (30.0, -1.0)] {
        assert!(spot(angle, falloff).validate().is_err(), "{angle} {falloff}");
    }
    assert!(SpotLight::new(DVec3::ZERO, DVec3::ZERO, Rgb::ONE, 0.5, 0.1).validate().is_err());
    assert!(DirectionalLight::new(DVec3::ZERO, Rgb::ONE).validate().is_err());
    assert!(DirectionalLight::new(DVec3::X, white(f64::NAN)).validate().is_err());
    assert!(PointLight { position: DVec3::NAN, intensity: Rgb::ONE }.validate().is_err());
    assert_eq!(spot(30.0, 30.0).validate(), Ok(()));
}
