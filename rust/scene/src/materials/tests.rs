//! Materials: their BSDFs, normals and opacity.

use super::*;
use crate::textures::{Between, Checker, Domain, Noise, ObjectTransform, Texture, UvTransform, Value};
use crate::{ShadingPoint, SurfacePoint};
use raywright_base::math::{DVec3, Frame};
use raywright_base::sampling::chi_square::assert_frequencies;
use raywright_base::sampling::{Sampler, warp};
use raywright_optics::{Bsdf, Diffuse, Rgb, Transparent};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A point of the plane z = 0 with texture coordinates u and v equal to x and y.
fn at(u: f64, v: f64) -> ShadingPoint {
    let position = DVec3::new(u, v, 0.0);
    let (normal, shading_normal) = (DVec3::Z, DVec3::Z);
    let point = SurfacePoint { position, error: 0.0, normal, shading_normal, shape: 0, inner: None };
    ShadingPoint {
        texture: TexturePoint { uv: [u, v], position, ..TexturePoint::default() },
        dp: [DVec3::X, DVec3::Y],
        object_dp: [DVec3::X, DVec3::Y],
        ..ShadingPoint::plain(point)
    }
}

/// The point with another shading normal.
fn tilted(shading_normal: DVec3, u: f64, v: f64) -> ShadingPoint {
    let here = at(u, v);
    ShadingPoint { point: SurfacePoint { shading_normal, ..here.point }, ..here }
}

fn checker(a: f64, b: f64) -> Value {
    let pattern = Checker(Domain::Uv(UvTransform::default()));
    Value::Texture(Arc::new(Between { a: a.into(), b: b.into(), pattern }))
}

fn grey(reflectance: f64) -> Arc<dyn Material> {
    Arc::new(DiffuseMaterial { reflectance: reflectance.into() })
}

fn mirror() -> Arc<dyn Material> {
    Arc::new(MirrorMaterial { reflectance: 1.0.into() })
}

fn gold(roughness: impl Into<Roughness>) -> ConductorMaterial {
    let (eta, k) = (Rgb::new(0.143, 0.375, 1.442), Rgb::new(3.983, 2.386, 1.603));
    conductor(eta, k, roughness)
}

fn conductor(eta: impl Into<Value>, k: impl Into<Value>, roughness: impl Into<Roughness>) -> ConductorMaterial {
    let index = Index::Constants { eta: eta.into(), k: k.into() };
    ConductorMaterial { index, roughness: roughness.into() }
}

fn glass(roughness: f64) -> DielectricMaterial {
    DielectricMaterial { interior: Interior::new(1.5, 0), roughness: roughness.into(), medium: None }
}

/// One of each kind, most with a texture.
fn all() -> Vec<Arc<dyn Material>> {
    let phong = PhongMaterial {
        diffuse: checker(0.1, 0.9),
        specular: Rgb::new(0.3, 0.2, 0.1).into(),
        exponent: 20.0.into(),
        ambient: 0.1.into(),
    };
    let PhongMaterial { diffuse, specular, exponent, ambient } = phong.clone();
    let blinn = BlinnPhongMaterial { diffuse, specular, exponent, ambient };
    let coat = PlasticMaterial {
        reflectance: checker(1.0, 0.2),
        ior: 1.5,
        roughness: Roughness::from(checker(0.0, 0.6).number()),
        coats: Arc::default(),
    };
    let gltf = MetallicRoughMaterial {
        base_colour: Rgb::new(1.0, 0.8, 0.2).into(),
        metallic: checker(0.0, 1.0).number(),
        roughness: 0.5.into(),
    };
    let brushed = gold(Roughness { along: [0.1.into(), 0.5.into()], is_alpha: true, facets: FacetKind::Ggx });
    let mixed = MixMaterial { a: Arc::new(gold(0.4)), b: grey(1.0), amount: checker(0.25, 0.75).number() };
    vec![
        Arc::new(DiffuseMaterial { reflectance: checker(0.0, 1.0) }),
        Arc::new(OrenNayarMaterial { reflectance: 1.0.into(), roughness: checker(0.0, 1.0).number() }),
        mirror(),
        Arc::new(gold(0.0)),
        Arc::new(brushed.clone()),
        Arc::new(glass(0.0)),
        Arc::new(glass(0.7)),
        Arc::new(ThinDielectricMaterial { ior: 1.33, within: None }),
        Arc::new(coat.clone()),
        Arc::new(phong),
        Arc::new(blinn),
        Arc::new(gltf),
        Arc::new(mixed.clone()),
        Arc::new(Mask { material: Arc::new(coat), opacity: 0.5.into() }),
        Arc::new(BumpMap { material: Arc::new(brushed), height: checker(0.0, 1.0).number(), scale: 0.1 }),
        Arc::new(NormalMap { material: grey(0.5), normals: Rgb::new(0.6, 0.3, 0.9).into(), scale: 1.0 }),
        Arc::new(TwoSided { front: Arc::new(mixed), back: mirror() }),
    ]
}

#[test]
fn no_material_gives_more_light_than_it_gets() {
    for material in all() {
        assert_eq!(material.validate(), Ok(()), "{material:?}");
        for (point, cosine) in [(at(0.5, 0.5), 0.9), (at(1.5, 0.5), 0.3), (at(0.5, 0.5), -0.6)] {
            let point = ShadingPoint { is_front: cosine > 0.0, ..point };
            let wo = DVec3::new(f64::sqrt(1.0 - cosine * cosine), 0.0, cosine);
            let bsdf = material.bsdf(&point);
            let (draws, mut sum, mut squares) = (4000, Rgb::ZERO, Rgb::ZERO);
            for sample in 0..draws {
                let mut sampler = Sampler::new(31, 2, sample);
                let u = sampler.two(0);
                let Some(drawn) = bsdf.sample(wo, &mut || sampler.one(1), u) else { continue };
                assert!((drawn.wi.length() - 1.0).abs() < 1e-9, "{material:?}");
                // Radiance scales by the squared index, as its solid angle is compressed.
                let energy = drawn.weight * drawn.eta * drawn.eta;
                assert!(energy.is_radiance(), "{material:?} {drawn:?}");
                sum += energy;
                squares += energy * energy;
                if drawn.pdf.is_finite() {
                    let (value, pdf) = bsdf.evaluate(wo, drawn.wi);
                    assert!((pdf / drawn.pdf - 1.0).abs() < 1e-6, "{material:?} {pdf} {drawn:?}");
                    assert!((value - drawn.weight * pdf).abs().max() <= 1e-6 * value.max());
                }
                assert!(material.transmits() || drawn.wi.z * wo.z >= 0.0, "{material:?}");
            }
            let mean = sum / f64::from(draws);
            let error = ((squares / f64::from(draws) - mean * mean) / f64::from(draws)).at_least(Rgb::ZERO)[0].sqrt();
            // Tables are accurate to 0.5 %; the probability of exceeding five standard errors is one in two million.
            assert!(mean.max() <= 1.005 + 5.0 * error, "{material:?} {mean} ± {error}");
        }
    }
}

#[test]
fn a_mix_is_linear() {
    let (wo, wi) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.6, 0.64));
    let (a, b): (Arc<dyn Material>, Arc<dyn Material>) = (Arc::new(gold(0.6)), grey(0.7));
    let alone = |material: &Arc<dyn Material>| material.bsdf(&at(0.5, 0.5)).evaluate(wo, wi);
    for amount in [0.0, 0.3, 0.5, 1.0] {
        let mix = MixMaterial { a: a.clone(), b: b.clone(), amount: amount.into() };
        let (value, pdf) = mix.bsdf(&at(0.5, 0.5)).evaluate(wo, wi);
        let expected = alone(&a).0 * (1.0 - amount) + alone(&b).0 * amount;
        assert!((value - expected).abs().max() < 1e-15);
        assert!((pdf - alone(&a).1 * (1.0 - amount) - alone(&b).1 * amount).abs() < 1e-15);
    }
    // A nested mixture, and a mixture with share 0 or 1.
    let inner = Arc::new(MixMaterial { a: a.clone(), b: b.clone(), amount: 0.5.into() });
    let outer = MixMaterial { a: inner, b: a.clone(), amount: 0.25.into() };
    let expected = alone(&a).0 * 0.625 + alone(&b).0 * 0.375;
    assert!((outer.bsdf(&at(0.5, 0.5)).evaluate(wo, wi).0 - expected).abs().max() < 1e-15);
    let same = MixMaterial { a: a.clone(), b: b.clone(), amount: checker(0.0, 1.0).number() };
    assert!(matches!(same.bsdf(&at(0.5, 0.5)), BsdfMix::One(_)));
    assert!(matches!(same.bsdf(&at(1.5, 0.5)), BsdfMix::One(_)));
}

#[test]
fn draws_of_mixes_have_their_density() {
    let wo = DVec3::new(0.6, 0.0, 0.8);
    let rough = Arc::new(gold(Roughness { along: [0.5.into(), 0.8.into()], is_alpha: true, facets: FacetKind::Ggx }));
    let mix = MixMaterial { a: rough, b: grey(0.8), amount: 0.4.into() };
    let bsdf = mix.bsdf(&at(0.5, 0.5));
    let (rows, columns, draws) = (12, 16, 100_000);
    // The last cell counts draws without a sample.
    let mut counts = vec![0; rows * columns + 1];
    for sample in 0..draws {
        let mut sampler = Sampler::new(32, 3, sample);
        let u = sampler.two(0);
        let Some(drawn) = bsdf.sample(wo, &mut || sampler.one(1), u) else {
            counts[rows * columns] += 1;
            continue;
        };
        let row = ((drawn.wi.z * rows as f64) as usize).min(rows - 1);
        let turn = (drawn.wi.y.atan2(drawn.wi.x) + PI) / TAU;
        counts[row * columns + ((turn * columns as f64) as usize).min(columns - 1)] += 1;
    }
    // Cell integrals by a 32 × 32 midpoint rule.
    let steps = 32;
    let mut expected: Vec<f64> = (0..rows * columns)
        .map(|cell| {
            let part = |i: usize, k: usize, of: usize| (i as f64 + (k as f64 + 0.5) / steps as f64) / of as f64;
            let sum: f64 = (0..steps * steps)
                .map(|k| {
                    let z = part(cell / columns, k / steps, rows);
                    let (sin, cos) = (TAU * part(cell % columns, k % steps, columns) - PI).sin_cos();
                    let radius = (1.0 - z * z).sqrt();
                    bsdf.evaluate(wo, DVec3::new(radius * cos, radius * sin, z)).1
                })
                .sum();
            sum * TAU / (rows * columns * steps * steps) as f64
        })
        .collect();
    expected.push((1.0 - expected.iter().sum::<f64>()).max(0.0));
    assert_frequencies(&counts, &expected);
}

#[test]
fn black_parts_of_a_mix_are_never_drawn() {
    let wo = DVec3::new(0.6, 0.0, 0.8);
    let mix = MixMaterial { a: grey(0.0), b: grey(0.8), amount: 0.25.into() };
    let bsdf = mix.bsdf(&at(0.0, 0.0));
    for sample in 0..100 {
        let mut sampler = Sampler::new(35, 6, sample);
        let u = sampler.two(0);
        let drawn = bsdf.sample(wo, &mut || sampler.one(1), u).unwrap();
        assert!((drawn.weight - 0.2).abs().max() < 1e-15);
        assert!((drawn.pdf - drawn.wi.z / PI).abs() < 1e-15);
    }
    let black = MixMaterial { a: grey(0.0), b: grey(0.0), amount: 0.25.into() };
    let black = black.bsdf(&at(0.0, 0.0));
    assert!(black.sample(wo, &mut || 0.5, [0.5; 2]).is_none());
    assert_eq!(black.evaluate(wo, DVec3::Z), (Rgb::ZERO, 0.0));
}

#[test]
fn mixes_with_single_directions_keep_both() {
    let mix = MixMaterial { a: grey(1.0), b: mirror(), amount: 0.25.into() };
    let bsdf = mix.bsdf(&at(0.5, 0.5));
    let (mut single, draws) = (0u32, 10_000);
    for sample in 0..draws {
        let mut sampler = Sampler::new(33, 4, sample);
        let u = sampler.two(0);
        let drawn = bsdf.sample(DVec3::new(0.6, 0.0, 0.8), &mut || sampler.one(1), u).unwrap();
        assert!((drawn.weight - 1.0).abs().max() < 1e-12);
        single += u32::from(drawn.pdf == f64::INFINITY);
    }
    // Binomial with a standard deviation of 43.
    assert!((f64::from(single) - 2500.0).abs() < 220.0, "{single}");
}

#[test]
fn masks_let_their_share_through() {
    let mask = |opacity| Mask { material: grey(0.5), opacity };
    assert_eq!(mask(checker(0.0, 1.0).number()).opacity(&at(0.5, 0.5).texture), 0.0);
    assert_eq!(mask(checker(0.0, 1.0).number()).opacity(&at(1.5, 0.5).texture), 1.0);
    assert!(!mask(checker(0.0, 1.0).number()).is_opaque() && mask(1.0.into()).is_opaque());
    let twice = Mask { material: Arc::new(mask(0.5.into())), opacity: 0.5.into() };
    assert_eq!(twice.opacity(&at(0.0, 0.0).texture), 0.25);
    // In a mixture with a hole, only the other material is hit.
    let mix = MixMaterial { a: grey(0.3), b: Arc::new(mask(0.0.into())), amount: 0.75.into() };
    assert_eq!(mix.opacity(&at(0.0, 0.0).texture), 0.25);
    let met = mix.bsdf(&at(0.0, 0.0));
    assert!(matches!(met, BsdfMix::One(AnyBsdf::Diffuse(Diffuse { reflectance })) if reflectance == Rgb::splat(0.3)));
    let half = Mask { material: grey(0.9), opacity: 0.5.into() };
    let mix = MixMaterial { a: grey(0.3), b: Arc::new(half), amount: 0.5.into() };
    // Opacity 0.75: two thirds of one material, a third of the other.
    assert_eq!(mix.opacity(&at(0.0, 0.0).texture), 0.75);
    assert!((mix.bsdf(&at(0.0, 0.0)).albedo()[0] - (0.6 + 0.9) / 3.0).abs() < 1e-15);
}

/// A sinusoidal height field.
#[derive(Debug)]
struct Wave;

impl Texture<f64> for Wave {
    fn at(&self, point: &TexturePoint) -> f64 {
        (3.0 * point.uv[0]).sin() * (2.0 * point.uv[1]).cos()
    }
    fn range(&self) -> [f64; 2] {
        [-1.0, 1.0]
    }
    fn mean(&self) -> f64 {
        0.0
    }
    fn needs(&self) -> Needs {
        Needs { uv: true, ..Needs::NONE }
    }
}

#[test]
fn bumps_have_the_normals_of_the_height_field() {
    let bump = |scale| BumpMap { material: grey(0.5), height: Value::Texture(Arc::new(Wave)), scale };
    for (u, v) in [(0.0, 0.0), (0.3, 0.7), (-2.0, 1.1), (5.0, -3.0)] {
        let (du, dv) = (3.0 * f64::cos(3.0 * u) * f64::cos(2.0 * v), -2.0 * f64::sin(3.0 * u) * f64::sin(2.0 * v));
        for scale in [0.0, 0.1, -0.4] {
            let expected = DVec3::new(-scale * du, -scale * dv, 1.0).normalize();
            let normal = bump(scale).normal(&at(u, v)).unwrap();
            assert!((normal - expected).length() < 1e-6, "{normal} {expected}");
            // Mirrored texture coordinates have no effect.
            let mirrored = ShadingPoint { dp: [DVec3::X, -DVec3::Y], ..at(u, v) };
            let normal = bump(scale).normal(&mirrored).unwrap();
            assert!((normal - expected * DVec3::new(1.0, -1.0, 1.0)).length() < 1e-6);
        }
    }
}

#[test]
fn a_raised_sphere_keeps_its_normals() {
    // A constant height on a curved surface scales tangents and keeps their directions.
    let bump = BumpMap { material: grey(0.5), height: 0.3.into(), scale: 1.0 };
    let n = DVec3::new(0.48, 0.6, 0.64);
    let frame = Frame::new(n);
    let (dp, dn) = ([frame.tangent * 2.0, frame.bitangent], [frame.tangent * 2.0, frame.bitangent]);
    let here = tilted(n, 0.0, 0.0);
    let point = ShadingPoint { point: SurfacePoint { normal: n, ..here.point }, dp, dn, ..here };
    assert!((bump.normal(&point).unwrap() - n).length() < 1e-15);
}

#[test]
fn bumps_of_space_follow_it() {
    // Heights by position, with texture coordinates of another scale: normals follow the noise's slope.
    let pattern = Noise { domain: Domain::Object(ObjectTransform::default()), seed: 5 };
    let height = Between { a: 0.0.into(), b: 1.0.into(), pattern };
    let value = |x: f64, y: f64| height.at(&at(x, y).texture)[0];
    let bump =
        BumpMap { material: grey(0.5), height: Value::<Rgb>::Texture(Arc::new(height.clone())).number(), scale: 0.5 };
    for (x, y) in [(0.3, 0.4), (7.7, 2.1), (-3.2, 0.9)] {
        let h = 1e-5;
        let slope = [(value(x + h, y) - value(x - h, y)) / (2.0 * h), (value(x, y + h) - value(x, y - h)) / (2.0 * h)];
        let expected = DVec3::new(-0.5 * slope[0], -0.5 * slope[1], 1.0).normalize();
        let scaled = [DVec3::X * 1000.0, DVec3::Y * 250.0];
        let point = ShadingPoint { dp: scaled, object_dp: scaled, ..at(x, y) };
        assert!((bump.normal(&point).unwrap() - expected).length() < 1e-5);
    }
}

#[test]
fn normal_maps_turn_normals() {
    let map = |normals: Rgb, scale| NormalMap { material: grey(0.5), normals: normals.into(), scale };
    for point in [at(0.0, 0.0), tilted(DVec3::new(0.6, 0.0, 0.8), 0.0, 0.0)] {
        assert_eq!(map(Rgb::new(0.5, 0.5, 1.0), 1.0).normal(&point), None);
    }
    let turned = map(Rgb::new(0.8, 0.5, 0.9), 1.0).normal(&at(0.0, 0.0)).unwrap();
    assert!((turned - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15);
    let turned = map(Rgb::new(0.5, 0.2, 0.9), 0.5).normal(&at(0.0, 0.0)).unwrap();
    assert!((turned - DVec3::new(0.0, -0.3, 0.8).normalize()).length() < 1e-15);
    // With mirrored texture coordinates, up still points to greater v.
    let mirrored = ShadingPoint { dp: [DVec3::X, -DVec3::Y], ..at(0.0, 0.0) };
    let turned = map(Rgb::new(0.5, 0.2, 0.9), 1.0).normal(&mirrored).unwrap();
    assert!((turned - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
}

#[test]
fn normals_stay_on_their_side() {
    for sample in 0..2000 {
        let mut sampler = Sampler::new(34, 5, sample);
        let colour = Rgb::new(sampler.one(0), sampler.one(1), sampler.one(2));
        let shading_normal = warp::cosine_hemisphere(sampler.two(3));
        let point = tilted(shading_normal, sampler.one(4) * 9.0, sampler.one(5) * 9.0);
        let map = NormalMap { material: grey(0.5), normals: colour.into(), scale: 10.0 * sampler.one(6) };
        let bump = BumpMap { material: Arc::new(map.clone()), height: Value::Texture(Arc::new(Wave)), scale: 50.0 };
        for normal in [map.normal(&point), bump.normal(&point)].into_iter().flatten() {
            assert!((normal.length() - 1.0).abs() < 1e-12 && normal.z > 0.0, "{normal}");
        }
        let nowhere = ShadingPoint { dp: [DVec3::ZERO; 2], object_dp: [DVec3::ZERO; 2], ..point };
        assert_eq!((map.normal(&nowhere), bump.normal(&nowhere)), (None, None));
    }
}

#[test]
fn sides_have_their_own() {
    let sheet = TwoSided { front: grey(0.2), back: grey(0.7) };
    let albedo = |is_front| sheet.bsdf(&ShadingPoint { is_front, ..at(0.0, 0.0) }).albedo();
    assert_eq!((albedo(true), albedo(false)), (Rgb::splat(0.2), Rgb::splat(0.7)));
    let wrong = |side: Arc<dyn Material>| TwoSided { front: grey(0.5), back: side }.validate().unwrap_err();
    assert!(wrong(Arc::new(glass(0.0))).starts_with("back must not transmit light"));
    assert!(
        wrong(Arc::new(Mask { material: grey(0.5), opacity: 0.5.into() })).starts_with("back must not have a mask")
    );
    assert!(wrong(grey(2.0)).starts_with("in back: reflectance"));
}

#[test]
fn glass_is_relative_to_what_is_outside() {
    let wo = DVec3::new(0.6, 0.0, 0.8);
    let within = |outside| glass(0.0).bsdf(&ShadingPoint { outside, ..at(0.0, 0.0) });
    // By Snell's law the sine is divided by the ratio; equal indices do not bend.
    for outside in [1.0, 1.2, 1.5, 2.0] {
        let refracted = (0..100).find_map(|i| {
            within(outside).sample(wo, &mut || (f64::from(i) + 0.5) / 100.0, [0.5; 2]).filter(|drawn| drawn.wi.z < 0.0)
        });
        let refracted = refracted.unwrap();
        assert!((refracted.wi.x + 0.6 * outside / 1.5).abs() < 1e-12, "{refracted:?}");
        assert!((refracted.eta - 1.5 / outside).abs() < 1e-12);
    }
    assert_eq!(glass(0.0).interior(), Some(Interior::new(1.5, 0)));
}

#[test]
fn what_is_the_same_everywhere_is_told_as_at_any_point() {
    let (wo, wi) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.36, 0.8));
    let mut told = 0;
    for material in all() {
        let Some(bsdf) = material.constant() else { continue };
        told += 1;
        for (u, v, is_front) in [(0.1, 0.2, true), (0.7, 0.9, false)] {
            let point = ShadingPoint { is_front, ..at(u, v) };
            assert!(material.normal(&point).is_none() && material.tangent(&point).is_none(), "{material:?}");
            let here = material.bsdf(&point);
            let sharply = |s: raywright_optics::BsdfSample| (s.wi, s.weight, s.pdf, s.eta);
            for side in [wo, -wo] {
                assert_eq!(bsdf.evaluate(side, wi), here.evaluate(side, wi), "{material:?}");
                let [a, b] = [bsdf.sample(side, &mut || 0.3, [0.4, 0.6]), here.sample(side, &mut || 0.3, [0.4, 0.6])];
                assert_eq!(a.map(sharply), b.map(sharply), "{material:?}");
            }
        }
    }
    assert_eq!(told, 5);
    // Brushed metal depends on direction, and a texture on the point.
    let brushed = Roughness { along: [0.1.into(), 0.4.into()], is_alpha: false, facets: FacetKind::Ggx };
    assert!(gold(brushed).constant().is_none() && gold(checker(0.1, 0.4).number()).constant().is_none());
    assert!(gold(0.3).constant().is_some() && glass(0.3).constant().is_some());
}

#[test]
fn roughness_is_squared_and_alpha_is_not() {
    let here = &at(0.5, 0.5).texture;
    assert_eq!(Roughness::from(0.5).alpha(here), [0.25; 2]);
    assert_eq!(
        Roughness { along: [0.5.into(), 0.25.into()], is_alpha: true, facets: FacetKind::Ggx }.alpha(here),
        [0.5, 0.25]
    );
    assert_eq!(
        Roughness { along: [0.5.into(), 0.25.into()], is_alpha: false, facets: FacetKind::Ggx }.alpha(here),
        [0.25, 0.0625]
    );
    let brushed = gold(Roughness { along: [0.5.into(), 0.25.into()], is_alpha: true, facets: FacetKind::Ggx });
    assert_eq!((brushed.tangent(&at(0.0, 0.0)), gold(0.5).tangent(&at(0.0, 0.0))), (Some(DVec3::X), None));
    assert!(brushed.needs().tangents && !gold(0.5).needs().any());
}

#[test]
fn ambient_light_is_reflected_by_its_own_share() {
    let phong = |ambient: f64| {
        Arc::new(PhongMaterial {
            diffuse: 0.5.into(),
            specular: 0.25.into(),
            exponent: 8.0.into(),
            ambient: ambient.into(),
        })
    };
    let share = |material: &dyn Material| material.ambient(&at(0.0, 0.0));
    assert_eq!(share(&*phong(0.1)), Rgb::splat(0.1));
    // Materials without an ambient coefficient use their albedo; smooth ones reflect none.
    assert_eq!((share(&*grey(0.3)), share(&*mirror())), (Rgb::splat(0.3), Rgb::ZERO));
    let mixed = |b: Arc<dyn Material>| share(&MixMaterial { a: phong(0.1), b, amount: 0.5.into() });
    assert!((mixed(grey(0.3)) - 0.2).abs().max() < 1e-15);
    assert!((mixed(mirror()) - 0.05).abs().max() < 1e-15);
    let sides = TwoSided { front: phong(0.1), back: grey(0.3) };
    assert_eq!(share(&sides), Rgb::splat(0.1));
    assert_eq!(sides.ambient(&ShadingPoint { is_front: false, ..at(0.0, 0.0) }), Rgb::splat(0.3));
    assert_eq!(share(&Mask { material: phong(0.1), opacity: 0.5.into() }), Rgb::splat(0.1));
}

#[test]
fn what_cannot_be_is_refused_in_a_line() {
    let refused = |material: &dyn Material, told: &str| {
        let why = material.validate().unwrap_err();
        assert!(why.starts_with(told), "{why}");
    };
    for bad in [-0.1, 1.1, f64::NAN] {
        refused(&*grey(bad), "reflectance must lie between 0 and 1, got");
        refused(&MirrorMaterial { reflectance: bad.into() }, "reflectance must");
        refused(&OrenNayarMaterial { reflectance: 0.5.into(), roughness: bad.into() }, "roughness must");
        refused(&gold(bad), "roughness must");
        refused(&Mask { material: grey(0.5), opacity: bad.into() }, "opacity must");
        refused(&MixMaterial { a: grey(0.5), b: grey(0.5), amount: checker(0.0, bad).number() }, "amount must");
        refused(&MixMaterial { a: grey(0.5), b: grey(bad), amount: 0.5.into() }, "in b: reflectance must");
    }
    for bad in [0.0, -1.5, f64::NAN, f64::INFINITY] {
        refused(&ThinDielectricMaterial { ior: bad, within: None }, "ior must be finite and above 0, got");
        let interior = Interior::new(bad, 0);
        refused(
            &DielectricMaterial { interior, roughness: 0.0.into(), medium: None },
            "ior must be finite and above 0",
        );
        refused(&conductor(bad, 1.0, 0.0), "eta must be finite and above 0");
    }
    refused(&conductor(1.0, -1.0, 0.0), "k must be finite and not negative");
    let coat = PlasticMaterial { reflectance: 0.5.into(), ior: 0.9, roughness: 0.0.into(), coats: Arc::default() };
    refused(&coat, "ior must be finite and at least 1, got 0.9");
    let two = || Roughness { along: [0.1.into(), 0.2.into()], is_alpha: true, facets: FacetKind::Ggx };
    refused(&PlasticMaterial { ior: 1.5, roughness: two(), ..coat.clone() }, "alpha must be one number here");
    refused(&DielectricMaterial { roughness: two(), ..glass(0.0) }, "alpha must be one number here");
    let shiny = PhongMaterial { diffuse: 0.7.into(), specular: 0.4.into(), exponent: 1.0.into(), ambient: 0.0.into() };
    refused(&shiny, "diffuse and specular must add up to at most 1");
    let bump = BumpMap { material: grey(0.5), height: f64::NAN.into(), scale: 1.0 };
    refused(&bump, "height must be finite");
}

#[test]
fn a_hole_in_scattering_is_no_mask() {
    // A transparent component may be mixed like any other.
    let through = BsdfMix::from(Transparent { transmittance: Rgb::ONE });
    let half = BsdfMix::mixed((Rgb::splat(0.5), through), (Rgb::splat(0.5), Diffuse { reflectance: Rgb::ONE }.into()));
    assert!(half.transmits() && !half.is_delta());
    assert_eq!((half.albedo(), half.roughness()), (Rgb::ONE, 0.0));
}
