//! Environments: densities and irradiances.

use super::super::{ConstantEnvironment, EnvironmentMap, Light, LightSampleContext, Picture, PointLight, SunSky};
use super::{FLOOR, Grid, assert_density, assert_near, irradiance_at, white};
use crate::{Scene, SceneDescription, fixtures::scene};
use raywright_base::math::DVec3;
use raywright_base::sampling::Sampler;
use raywright_optics::Rgb;
use std::f64::consts::PI;
use std::sync::Arc;

/// From z up to y up.
const UPRIGHT: [DVec3; 3] = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 1.0, 0.0)];

fn map(width: usize, height: usize, of: impl Fn(usize, usize) -> [f32; 3]) -> EnvironmentMap {
    let texels = (0..height).flat_map(|j| (0..width).map(move |i| (i, j))).map(|(i, j)| of(i, j)).collect();
    EnvironmentMap::new(Arc::new(Picture::new(width, texels).unwrap()), UPRIGHT, 1.0)
}

fn under(lights: Vec<Arc<dyn Light>>) -> Scene {
    scene(SceneDescription { lights, ..Default::default() })
}

/// Maps of all kinds: constant, patterned, black except for a texel at a pole or elsewhere, and of a single texel, row
/// or column.
fn maps() -> Vec<EnvironmentMap> {
    vec![
        map(8, 4, |_, _| [1.0; 3]),
        map(16, 8, |i, j| [(i * j % 5) as f32, (i % 3) as f32, j as f32]),
        map(16, 8, |i, j| if j == 0 && i == 3 { [5.0, 1.0, 0.0] } else { [0.0; 3] }),
        map(16, 8, |i, j| if (i, j) == (15, 5) { [2.0; 3] } else { [0.1; 3] }),
        map(1, 1, |_, _| [0.5; 3]),
        map(1, 6, |_, j| [j as f32; 3]),
        map(6, 1, |i, _| [i as f32; 3]),
    ]
}

#[test]
fn maps_are_drawn_by_their_density() {
    for map in maps() {
        assert_eq!(map.validate(), Ok(()));
        assert_density(&map, &FLOOR, 60, 2e-3);
    }
}

#[test]
fn all_light_of_a_map_is_its_integral() {
    // By sample weights, which are nearly constant, and by brute force.
    for map in maps() {
        let grid = Grid { rows: 8, columns: 12 };
        let expected: f64 = grid.integrals(60, |d| map.infinite_radiance(d)[1]).iter().sum();
        let found = irradiance_at(&under(vec![Arc::new(map)]), &LightSampleContext::free(DVec3::ZERO), 20_000);
        assert!((found.0 / expected - 1.0).abs() < 3e-3 + 5.0 * found.1 / expected, "{found:?} {expected}");
    }
}

#[test]
fn a_map_is_upright_and_not_mirrored() {
    let map = map(4, 2, |i, j| [if j == 0 { 1.0 } else { 0.0 }, i as f32, 0.0]);
    let at = |d: DVec3| {
        // The picture's y axis is the world's z axis.
        map.infinite_radiance(d)
    };
    assert!((at(DVec3::Z)[0] - 1.0).abs() < 1e-12 && at(DVec3::NEG_Z)[0].abs() < 1e-12);
    // Its center lies between columns 1 and 2; 90 degrees to the right lies between 2 and 3.
    let (middle, right) = (at(DVec3::Y)[1], at(DVec3::X)[1]);
    assert!((middle - 1.5).abs() < 1e-12 && (right - 2.5).abs() < 1e-12, "{middle} {right}");
    let behind = at(DVec3::NEG_Y)[1];
    assert!((behind - 1.5).abs() < 1e-12, "{behind}");
}

#[test]
fn a_sun_of_one_texel_leaves_no_heavy_tail() {
    // A sun of 10⁷ in a sky of 1: every sample from above has nearly the mean weight.
    let map = map(64, 32, |i, j| if (i, j) == (20, 6) { [1e7; 3] } else { [1.0; 3] });
    let grid = Grid { rows: 64, columns: 64 };
    let expected: f64 = grid.integrals(24, |d| map.infinite_radiance(d)[1] * d.z.max(0.0)).iter().sum();
    let lit = under(vec![Arc::new(map.clone())]);
    let found = irradiance_at(&lit, &FLOOR, 20_000);
    assert_near((found.0, found.1 + 1e-3 * expected / 5.0), expected, 0.01);
    for number in 0..20_000 {
        let sample = map.sample(&FLOOR, Sampler::new(6, 0, number).two(0)).unwrap();
        let whole = expected * 4.0;
        assert!(sample.weight[1] < whole, "{} of {whole}", sample.weight[1]);
    }
}

#[test]
fn a_map_of_one_radiance_is_that_radiance() {
    let map = map(32, 16, |_, _| [0.25, 0.5, 1.0]);
    for number in 0..1000 {
        let d = raywright_base::sampling::warp::uniform_sphere(Sampler::new(7, 0, number).two(0));
        assert!((map.infinite_radiance(d) - Rgb::new(0.25, 0.5, 1.0)).abs().max() < 1e-12);
    }
    for pole in [DVec3::Z, DVec3::NEG_Z] {
        assert!(map.infinite_radiance(pole).is_finite() && map.infinite_pdf(&FLOOR, pole) > 0.0);
    }
    let spread = |light: &dyn Light| match light.reach() {
        super::super::Reach::Infinite { flux, spread } => (flux, spread),
        super::super::Reach::Finite { .. } => panic!("a light outside"),
    };
    let (flux, whole) = spread(&map);
    assert!((flux / (4.0 * PI * 1.75 / 3.0) - 1.0).abs() < 1e-12 && (whole - 1.0).abs() < 1e-12, "{flux} {whole}");
}

#[test]
fn a_map_may_be_black_and_may_only_be_turned() {
    let black = map(4, 2, |_, _| [0.0; 3]);
    assert!(under(vec![Arc::new(black)]).lights().is_dark());
    let picture = Arc::new(Picture::new(1, vec![[1.0; 3]]).unwrap());
    let stretched = EnvironmentMap::new(picture.clone(), [DVec3::X * 2.0, DVec3::Y, DVec3::Z], 1.0);
    assert!(stretched.validate().is_err());
    assert!(EnvironmentMap::new(picture, UPRIGHT, f64::NAN).validate().is_err());
}

#[test]
fn environments_add_up() {
    let all: Vec<Arc<dyn Light>> = vec![
        Arc::new(ConstantEnvironment { radiance: white(0.3) }),
        Arc::new(map(8, 4, |_, _| [2.0; 3])),
        Arc::new(ConstantEnvironment { radiance: white(0.0) }),
    ];
    let lit = under(all.clone());
    assert_near(irradiance_at(&lit, &FLOOR, 20_000), 2.3 * PI, 0.01);
    assert!((lit.lights().infinite_radiance(DVec3::X) - white(2.3)).abs().max() < 1e-12);
    // With a lamp, and for light from all directions.
    let lamp = PointLight { position: DVec3::Z, intensity: white(7.0) };
    let lit = under(all.into_iter().chain([Arc::new(lamp) as _]).collect());
    assert_near(irradiance_at(&lit, &FLOOR, 50_000), 2.3 * PI + 7.0, 0.02);
    assert_near(irradiance_at(&lit, &LightSampleContext::free(DVec3::ZERO), 50_000), 2.3 * 4.0 * PI + 7.0, 0.02);
    // The density is that of sampled directions, whichever light they come from.
    let grid = Grid { rows: 8, columns: 12 };
    let sum: f64 = grid.integrals(40, |d| lit.lights().infinite_pdf(&FLOOR, d)).iter().sum();
    let outside = (0..20_000).filter_map(|n| super::draw(&lit, &FLOOR, n)).filter(|s| s.source.is_none()).count();
    let spread = 5.0 * (sum * (1.0 - sum) / 20_000.0).sqrt();
    assert!((outside as f64 / 20_000.0 - sum).abs() < spread + 1e-3, "{outside} {sum}");
}

#[test]
fn daylight_is_drawn_by_its_density() {
    for (height, turbidity) in [(1.0, 2.0), (0.5, 3.0), (0.0, 6.0), (0.1, 10.0)] {
        let sun = DVec3::new(0.6 * f64::sqrt(1.0 - height * height), -0.8 * f64::sqrt(1.0 - height * height), height);
        // The sun is too small for the grid, so the sky is tested without it.
        let sky = SunSky::new([sun, DVec3::Z], turbidity, white(0.3), [0.0, 1.0]);
        assert_eq!(sky.validate(), Ok(()));
        for receiver in [FLOOR, LightSampleContext::free(DVec3::ZERO), LightSampleContext { normal: DVec3::X, ..FLOOR }]
        {
            assert_density(&sky, &receiver, 60, 2e-3);
        }
    }
}

#[test]
fn a_receiver_is_lit_by_sun_and_sky_as_integrals_say() {
    let sun = DVec3::new(0.48, 0.64, 0.6);
    let day = SunSky::new([sun, DVec3::Z], 3.0, white(0.2), [1.0, 1.0]);
    let sky = SunSky::new([sun, DVec3::Z], 3.0, white(0.0), [0.0, 1.0]);
    let grid = Grid { rows: 32, columns: 32 };
    let from_sky: f64 = grid.integrals(24, |d| sky.infinite_radiance(d)[1] * d.z.max(0.0)).iter().sum();
    let disk = day.infinite_radiance(sun)[1] - sky.infinite_radiance(sun)[1];
    let from_sun = disk * super::super::sky::sun::solid_angle() * 0.6;
    assert_near(irradiance_at(&under(vec![Arc::new(day.clone())]), &FLOOR, 50_000), from_sky + from_sun, 0.01);
    // The ground's radiance is its reflected irradiance.
    let ground = day.infinite_radiance(DVec3::new(0.6, 0.0, -0.8))[1];
    assert!((ground / (0.2 * (from_sky + from_sun) / PI) - 1.0).abs() < 1e-3, "{ground}");
    // A receiver that faces down sees neither sun nor sky; one that faces away from the sun does not see the sun.
    let down = LightSampleContext { normal: DVec3::NEG_Z, ..FLOOR };
    assert_near(irradiance_at(&under(vec![Arc::new(day.clone())]), &down, 10_000), PI * ground, 0.02);
    let away = LightSampleContext { normal: -sun, ..FLOOR };
    for number in 0..1000 {
        let sample = day.sample(&away, Sampler::new(8, 0, number).two(0));
        assert!(sample.is_none_or(|s| s.direction.dot(sun) < 0.9999), "no draw is spent on the sun");
    }
}

#[test]
fn daylight_goes_out_as_the_sun_sets() {
    let way = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        DVec3::new(cos, 0.0, sin)
    };
    let day = |degrees: f64| SunSky::new([way(degrees), DVec3::Z], 3.0, white(0.2), [1.0, 1.0]);
    let zenith = |degrees: f64| day(degrees).infinite_radiance(DVec3::Z)[1];
    // The sky is continuous at the horizon. At −6 degrees it is darker by the almanac's ratio of ground illuminance,
    // and below −18 it is black.
    assert!((zenith(-1e-7) / zenith(1e-7) - 1.0).abs() < 1e-5, "{} {}", zenith(-1e-7), zenith(1e-7));
    assert!((zenith(-6.0) / zenith(0.0) * 10f64.powf(2.88) / 3.4 - 1.0).abs() < 0.02);
    for below in [18.5, 60.0, 90.0] {
        let night = day(-below);
        assert_eq!(night.validate(), Ok(()));
        for towards in [DVec3::Z, DVec3::X, DVec3::NEG_Z, way(-below), way(0.1), way(-0.1)] {
            assert_eq!(night.infinite_radiance(towards), Rgb::ZERO);
        }
        assert!(night.sample(&FLOOR, [0.3, 0.7]).is_none());
    }
    // Twilight samples follow their density, and the sun is visible while its edge is above the horizon.
    assert_density(&day(-4.0), &FLOOR, 60, 2e-3);
    let edge = |degrees: f64| {
        let sky = SunSky::new([way(degrees), DVec3::Z], 3.0, white(0.2), [0.0, 1.0]);
        day(degrees).infinite_radiance(way(0.005))[1] - sky.infinite_radiance(way(0.005))[1]
    };
    assert!(edge(0.0) > 0.0 && edge(-0.25) > 0.0);
    assert_eq!((edge(-0.27), edge(0.28)), (0.0, 0.0));
    // Below the horizon the sun is hidden.
    assert_eq!(day(0.0).infinite_radiance(way(-0.1)), day(0.0).infinite_radiance(DVec3::NEG_Z));
}

#[test]
fn daylight_that_cannot_be_is_told() {
    let day = |sun: DVec3, turbidity: f64, albedo: f64, scale: f64| {
        SunSky::new([sun, DVec3::Z], turbidity, white(albedo), [scale, 1.0]).validate()
    };
    assert_eq!(day(DVec3::X, 2.0, 1.0, 0.0), Ok(()));
    for (sun, turbidity, albedo, scale) in [
        (DVec3::ZERO, 3.0, 0.2, 1.0),
        (DVec3::Z, 1.9, 0.2, 1.0),
        (DVec3::Z, f64::NAN, 0.2, 1.0),
        (DVec3::Z, 3.0, 1.1, 1.0),
        (DVec3::Z, 3.0, -0.1, 1.0),
        (DVec3::Z, 3.0, 0.2, -1.0),
        (DVec3::Z, 3.0, 0.2, f64::INFINITY),
    ] {
        assert!(day(sun, turbidity, albedo, scale).is_err(), "{sun} {turbidity} {albedo} {scale}");
    }
}
