//! Properties of every kind of BSDF.

use super::conductors::Reflectance;
use super::energy_loss::Lossy;
use super::*;
use glam::DVec3;
use proptest::prelude::*;
use raywright_base::cases;
use raywright_base::math::{LANES, VectorLanes};
use raywright_base::sampling::Sampler;
use raywright_base::sampling::warp::uniform_sphere;
use raywright_base::simd::Level;
use std::array::from_fn;
use std::sync::OnceLock;

fn direction(degrees: f64, turn: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin * turn.cos(), sin * turn.sin(), cos)
}

/// Silver's index of refraction near the centers of red, green and blue.
const SILVER: (Rgb, Rgb) = (Rgb::new(0.0569, 0.0540, 0.0469), Rgb::new(4.2543, 3.4290, 2.8028));

fn gold(outside: f64, alpha: [f64; 2]) -> AnyBsdf {
    Conductor::metal(conductors::metal("gold").unwrap(), outside, alpha).into()
}

/// Silver and glass with these facets.
fn faceted<F: Lossy>(alpha: [f64; 2], eta: f64) -> [AnyBsdf; 2]
where
    AnyBsdf: From<Conductor<F>> + From<Dielectric<F>>,
{
    let silver = Reflectance::Index(fresnel::ConductorIndex::new(SILVER.0, SILVER.1));
    let (brushed, alike) = (F::new(alpha), F::new([alpha[0]; 2]));
    [Conductor::of(silver, Some(brushed)).into(), Dielectric::of(eta, Some(alike)).into()]
}

/// Plastics with single-scattering coats. Their transmittance is integrated once.
fn plastics_once() -> &'static [AnyBsdf] {
    static MADE: OnceLock<Vec<AnyBsdf>> = OnceLock::new();
    fn made<F: Facets>(alpha: f64, eta: f64) -> AnyBsdf
    where
        AnyBsdf: From<CoatedOnce<F>>,
    {
        let facets = Once::<F>::new([alpha; 2]);
        CoatedOnce::new(Rgb::new(0.9, 0.3, 1.0), eta, facets, Through::new(&facets, eta)).into()
    }
    let alphas = [1e-4, 0.01, 0.1, 0.4, 1.0];
    let all = alphas.into_iter().flat_map(|alpha| [1.0, 1.01, 1.5].map(|eta| (alpha, eta)));
    let both = |(alpha, eta)| [made::<Ggx>(alpha, eta), made::<Beckmann>(alpha, eta)];
    MADE.get_or_init(|| all.flat_map(both).collect())
}

/// Oil, a coating and a gap on dielectrics, and oxide on silver and gold.
fn filmed<F: Lossy>(alpha: f64) -> Vec<AnyBsdf>
where
    AnyBsdf: From<Dielectric<F, Filmed>> + From<Conductor<F>>,
{
    // The gap is smooth: rough facets that reflect where bare ones do not gain some energy.
    let last = if alpha == 0.0 { (80.0, [1.5, 1.0, 1.6]) } else { (80.0, [1.5, 1.55, 1.6]) };
    let clear = [(300.0, [1.0, 1.47, 1.33]), (99.6, [1.0, 1.38, 1.52]), last].map(|(thickness, indices)| {
        let eta = indices[2] / indices[0];
        Dielectric::with(eta, F::rough([alpha; 2]), Filmed::new(thickness, indices)).into()
    });
    let silver = Reflectance::Filmed { thickness: 120.0, layers: [1.0, 1.5], index: SILVER, waves: None };
    let gold = conductors::FilmedCurve::of(conductors::metal("gold").unwrap(), 250.0, 1.5, 1.0);
    let gold = Reflectance::FilmedMetal(conductors::FilmedMetal::One(gold));
    let metal = [silver, gold].map(|metal| Conductor::of(metal, F::rough([alpha, 0.2])).into());
    clear.into_iter().chain(metal).collect()
}

/// One or more BSDFs of each kind.
fn kinds() -> Vec<AnyBsdf> {
    let (grey, red) = (Rgb::splat(0.6), Rgb::new(0.9, 0.3, 0.1));
    let mut kinds: Vec<AnyBsdf> = vec![
        Diffuse { reflectance: red }.into(),
        OrenNayar::new(red, 0.7).into(),
        Mirror { reflectance: red }.into(),
        ThinDielectric::new(1.5).into(),
        Dielectric::new(1.5, 0.0).into(),
        Conductor::new(SILVER.0, SILVER.1, [0.0; 2]).into(),
        Coated::new(red, 1.5, 0.0).into(),
        MetallicRough::new(red, 0.5, 0.0).into(),
        Transparent { transmittance: red }.into(),
        Null.into(),
        gold(1.0, [0.0; 2]),
        gold(1.33, [0.2; 2]),
        SoapFilm::new(300.0, 1.33, 1.0, None).into(),
        Tinted { inner: ThinDielectric::new(1.5), reflectance: grey, transmittance: red }.into(),
        Tinted { inner: Dielectric::new(1.5, 0.0), reflectance: grey, transmittance: red }.into(),
        Tinted { inner: Dielectric::new(1.5, 0.3), reflectance: Rgb::ONE, transmittance: red }.into(),
    ];
    kinds.extend(filmed::<Ggx>(0.0));
    for n in [0.0, 1.0, 30.0, 5000.0] {
        kinds.push(Phong::new(grey * 0.5, grey * 0.5, n).into());
        kinds.push(BlinnPhong::new(grey * 0.5, grey * 0.5, n).into());
    }
    for alpha in [1e-4, 0.01, 0.1, 0.4, 1.0] {
        kinds.push(Conductor::new(SILVER.0, SILVER.1, [alpha; 2]).into());
        kinds.push(Conductor::new(SILVER.0, SILVER.1, [alpha, 0.3]).into());
        kinds.push(gold(1.0, [alpha; 2]));
        for eta in [1.00001, 1.01, 1.5, 1.0 / 1.5, 3.0] {
            kinds.push(Dielectric::new(eta, alpha).into());
        }
        kinds.push(Coated::new(red, 1.5, alpha).into());
        kinds.push(MetallicRough::new(red, 0.5, alpha.sqrt()).into());
        kinds.push(MetallicRough::new(grey, 1.0, alpha.sqrt()).into());
        for eta in [1.01, 1.5] {
            kinds.extend(faceted::<Once<Ggx>>([alpha, 0.3], eta));
            kinds.extend(faceted::<Once<Beckmann>>([alpha, 0.3], eta));
        }
        for eta in [1.00001, 1.01, 1.5, 1.0 / 1.5, 3.0] {
            kinds.extend(faceted::<Beckmann>([alpha, 0.3], eta));
        }
        kinds.push(Coated::of(red, 1.5, Beckmann::rough([alpha; 2])).into());
    }
    kinds.extend(filmed::<Ggx>(0.1).into_iter().chain(filmed::<Beckmann>(0.4)).chain(filmed::<Once<Ggx>>(1.0)));
    kinds.extend(plastics_once());
    kinds
}

/// Index of refraction below over that above.
fn index(bsdf: &AnyBsdf) -> f64 {
    match bsdf {
        AnyBsdf::Dielectric(d) => d.eta(),
        AnyBsdf::Faceted(Faceted::BeckmannDielectric(d)) => d.eta(),
        AnyBsdf::Faceted(Faceted::DielectricOnce(d)) => d.eta(),
        AnyBsdf::Faceted(Faceted::BeckmannDielectricOnce(d)) => d.eta(),
        AnyBsdf::Faceted(Faceted::FilmedDielectric(d)) => d.eta(),
        AnyBsdf::Faceted(Faceted::BeckmannFilmedDielectric(d)) => d.eta(),
        AnyBsdf::Faceted(Faceted::FilmedDielectricOnce(d)) => d.eta(),
        AnyBsdf::Faceted(Faceted::TintedDielectric(tinted)) => tinted.inner.eta(),
        _ => 1.0,
    }
}

/// Directions from normal to grazing incidence, and some from below.
fn directions() -> Vec<DVec3> {
    let mut directions = Vec::new();
    for (degrees, turn) in [(0.0, 0.0), (20.0, 1.0), (45.0, 0.0), (60.0, 2.0), (80.0, 4.0), (89.0, 5.0), (89.9, 0.3)] {
        directions.extend([direction(degrees, turn), direction(180.0 - degrees, turn)]);
    }
    directions
}

fn draw(bsdf: &AnyBsdf, wo: DVec3, numbers: &mut Sampler) -> Option<BsdfSample> {
    let (choice, u) = (numbers.one(2), numbers.two(0));
    bsdf.sample(wo, &mut || choice, u)
}

/// Mean sample weight without the 1 / η² of radiance, and its standard error: the directional albedo.
fn share(bsdf: &AnyBsdf, wo: DVec3, draws: u32) -> (Rgb, f64) {
    let (mut sum, mut squares) = (Rgb::ZERO, 0.0);
    for i in 0..draws {
        let mut numbers = Sampler::new(9, 1, i);
        if let Some(s) = draw(bsdf, wo, &mut numbers) {
            let weight = s.weight * s.eta * s.eta;
            sum += weight;
            squares += weight[0] * weight[0];
        }
    }
    let n = f64::from(draws);
    let mean = sum / n;
    (mean, ((squares / n - mean[0] * mean[0]).max(0.0) / n).sqrt())
}

#[test]
fn white_is_white_at_every_roughness_and_angle() {
    let mirror = |alpha: [f64; 2]| Conductor::new(Rgb::ONE, Rgb::splat(1e9), alpha);
    for alpha in [0.0, 1e-4, 0.001, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0] {
        let mut white: Vec<(AnyBsdf, f64)> = vec![
            (mirror([alpha; 2]).into(), 0.005),
            (mirror([alpha, 0.2]).into(), 0.01),
            (Coated::new(Rgb::ONE, 1.5, alpha).into(), 0.005),
            (OrenNayar::new(Rgb::ONE, alpha).into(), 0.005),
            (MetallicRough::new(Rgb::ONE, 0.0, alpha.sqrt()).into(), 0.005),
            (MetallicRough::new(Rgb::ONE, 0.4, alpha.sqrt()).into(), 0.005),
            (MetallicRough::new(Rgb::ONE, 1.0, alpha.sqrt()).into(), 0.005),
        ];
        for eta in [1.0, 1.0 + 1e-7, 1.0001, 1.01, 1.1, 1.33, 1.5, 2.0, 3.0, 5.0, 10.0] {
            white.push((Dielectric::new(eta, alpha).into(), 0.005));
            white.push((Dielectric::new(1.0 / eta, alpha).into(), 0.005));
        }
        for (number, (bsdf, bound)) in white.into_iter().enumerate() {
            for wo in cases::every(2, number, directions()) {
                let (mean, error) = share(&bsdf, wo, 4_000);
                // Five standard errors beyond the bound: the probability that one of these 4,900 means fails is 1 in
                // 350 per seed.
                let off = (mean - 1.0).abs().max();
                assert!(off <= bound + 5.0 * error, "{mean} ± {error} {bsdf:?} {wo}");
            }
        }
    }
}

#[test]
fn light_is_scattered_alike_in_both_directions() {
    for bsdf in kinds() {
        let (mut a, mut b) = (directions(), directions());
        a.rotate_left(3);
        b.extend(a.clone());
        for wo in a {
            // Also near a lobe: the direction of a sample, from both sides of the surface.
            let drawn = bsdf.sample(wo, &mut || 0.9, [0.3, 0.4]).map(|s| s.wi);
            for &wi in b.iter().chain(drawn.as_ref()) {
                // f(wo, wi) / η² of the side of wi is symmetric.
                let index = |w: DVec3| if w.z < 0.0 { index(&bsdf) } else { 1.0 };
                let one = bsdf.evaluate(wo, wi).0 / wi.z.abs() * index(wi).powi(2);
                let two = bsdf.evaluate(wi, wo).0 / wo.z.abs() * index(wo).powi(2);
                let off = (one - two).abs().max();
                assert!(off <= 1e-6 * one.max() + 1e-12, "{one} {two} {bsdf:?} {wo} {wi}");
            }
        }
    }
}

#[test]
fn draws_weigh_what_is_evaluated() {
    for bsdf in kinds() {
        for wo in directions() {
            for i in 0..400 {
                let mut numbers = Sampler::new(3, 0, i);
                let Some(s) = draw(&bsdf, wo, &mut numbers) else {
                    continue;
                };
                assert!((s.wi.length() - 1.0).abs() < 1e-9 && s.weight.is_radiance() && s.pdf > 0.0);
                assert_eq!(s.eta != 1.0, s.wi.z * wo.z < 0.0 && index(&bsdf) != 1.0, "{s:?}");
                if s.pdf.is_infinite() {
                    continue;
                }
                assert!(!bsdf.is_delta());
                let (value, pdf) = bsdf.evaluate(wo, s.wi);
                // Values are 0 where a facet's density underflows and nothing is lost.
                let off = (value - s.weight * s.pdf).abs().max() / value.max().max(f64::MIN_POSITIVE);
                // Directions are accurate to 10⁻¹⁶, and values computed from them to that over a lobe's width.
                let bound = 1e-9 + 1e-12 * s.pdf.sqrt();
                assert!(off < bound && (pdf / s.pdf - 1.0).abs() < bound, "{off:e} {pdf} {s:?} {bsdf:?} {wo}");
            }
        }
    }
}

/// Two directions: arbitrary, grazing, normal, in the plane, mirrored, opposite, or near the critical angle.
fn two_directions(turn: u32, sampler: &mut Sampler) -> [DVec3; 2] {
    let [wo, wi] = [1, 3].map(|dimension| uniform_sphere(sampler.two(dimension)));
    match turn % 10 {
        0 => [DVec3::new(wo.x, wo.y, 1e-9 * wo.z).normalize(), wi],
        1 => [DVec3::Z.copysign(wo), wi],
        2 => [DVec3::X, wi],
        3 => [wo, DVec3::new(-wo.x, -wo.y, wo.z)],
        4 => [wo, -wo],
        5 => [DVec3::new((1.0 / 1.5) * (1.0 + 1e-16 * (wi.x * 4.0).round()), 0.0, -(5f64 / 9.0).sqrt()), wi],
        6 => [DVec3::new(1.0, 0.0, 1e-90), DVec3::new(-1.0, 0.0, 1e-90)],
        _ => [wo, wi],
    }
}

/// Asserts that lanes equal scalar results at every level.
fn assert_alike(turn: u32, each: &[AnyBsdf; LANES]) {
    let mut sampler: [Sampler; LANES] = from_fn(|lane| Sampler::new(8, turn, lane as u32));
    let (mut lanes, mut to, mut from, mut u) =
        (AnyBsdfLanes::NONE, VectorLanes::ZERO, VectorLanes::ZERO, [[0.0; LANES]; 2]);
    for lane in 0..LANES {
        let [wo, wi] = two_directions(turn + lane as u32, &mut sampler[lane]);
        to.set(lane, wo);
        from.set(lane, wi);
        lanes.set(lane, &each[lane], wo);
        [u[0][lane], u[1][lane]] = sampler[lane].two(5);
    }
    let choice = from_fn(|lane| sampler[lane].one(6));
    let asks = from_fn(|lane| lane as u32 != turn % 16);
    let one = |lane: usize| Some(&each[lane]);
    for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
        let (mut value, mut pdf) = (RgbLanes::ZERO, [f64::NAN; LANES]);
        lanes.evaluate(level, one, &asks, [&to, &from], &mut value, &mut pdf);
        let mut drawn = BsdfSampleLanes::NONE;
        lanes.sample(level, one, &asks, &to, (&choice, &u), &mut drawn);
        for lane in 0..LANES {
            let (one, wo, drawn) = (&each[lane], to.get(lane), drawn.get(lane));
            if !asks[lane] {
                assert!(value.get(lane).is_black() && pdf[lane] == 0.0 && drawn.is_none());
                continue;
            }
            let found = (value.get(lane), pdf[lane]);
            assert_eq!(found, one.evaluate(wo, from.get(lane)), "{level:?} {turn} {lane} {one:?}");
            let wanted = one.sample(wo, &mut || choice[lane], [u[0][lane], u[1][lane]]);
            let told = |of: BsdfSample| (of.wi, of.weight, of.pdf, of.eta, of.is_through);
            assert_eq!(drawn.map(told), wanted.map(told), "{level:?} {turn} {lane} {one:?}");
        }
    }
}

/// Principled surfaces and sheets, from diffuse and metal to glass.
fn principled() -> Vec<AnyBsdf> {
    let look = |roughness: f64, transmission: f64| Look {
        base_color: Rgb::new(0.9, 0.4, 0.1),
        luminance: 0.48,
        roughness,
        anisotropic: 0.5 * roughness,
        transmission,
        specular_tint: 0.3,
        sheen: 0.5,
        sheen_tint: 0.4,
        flatness: 0.2,
    };
    let all = [0.0, 0.2, 0.7, 1.0].into_iter().flat_map(|roughness| [0.0, 0.6, 1.0].map(|share| (roughness, share)));
    let made = |(roughness, share): (f64, f64)| -> [AnyBsdf; 5] {
        [
            LayeredPrincipled::new(look(roughness, share), 1.5, 0.3, [share, roughness]).into(),
            LayeredPrincipledThin::new(look(roughness, share), 1.5, roughness).into(),
            Principled::new(look(roughness, share), 1.5, 0.3, [share, roughness], true).into(),
            Principled::new(look(roughness, 0.0), 1.33, share, [1.0 - share, 0.9], false).into(),
            PrincipledThin::new(look(roughness, share), 1.5, roughness).into(),
        ]
    };
    all.flat_map(made).collect()
}

#[test]
fn lanes_answer_as_each_by_itself() {
    let mut kinds = kinds();
    kinds.extend(principled());
    let name = |of: &AnyBsdf| {
        let told = format!("{of:?}");
        told[..told.find(' ').unwrap_or(told.len())].to_owned()
    };
    let mut names: Vec<String> = kinds.iter().map(name).collect();
    names.sort();
    names.dedup();
    for turn in 0..20 {
        // Lanes of one kind, smooth and rough, and of many kinds.
        for wanted in &names {
            let alike: Vec<&AnyBsdf> = kinds.iter().filter(|of| name(of) == *wanted).collect();
            assert_alike(turn, &from_fn(|lane| *alike[(lane + turn as usize) % alike.len()]));
        }
        assert_alike(turn, &from_fn(|lane| kinds[(lane * 17 + turn as usize * 31) % kinds.len()]));
    }
}

#[test]
fn choices_say_which_lobe_is_drawn() {
    for bsdf in kinds() {
        for wo in directions() {
            for i in 0..60 {
                let mut numbers = Sampler::new(4, 0, i);
                let (choice, u) = (numbers.one(2), numbers.two(0));
                let drawn = |choice: f64| bsdf.sample(wo, &mut || choice, u);
                let Some(s) = drawn(choice) else { continue };
                let [from, to] = s.choices;
                assert!(0.0 <= from && from <= choice && choice < to && to <= 1.0, "{choice} {s:?} {bsdf:?} {wo}");
                // All choices inside the range select this lobe, and none outside; a rounding may lie between.
                let rounding = if s.is_delta() { 0.0 } else { 1e-15 };
                let is_same =
                    |choice| drawn(choice).is_some_and(|other| (other.wi, other.choices) == (s.wi, s.choices));
                let is_inside = |choice: f64| from <= choice && choice < to;
                for inside in [from + rounding, from + 0.3 * (to - from), to.next_down() - rounding] {
                    assert!(!is_inside(inside) || is_same(inside), "{inside} {s:?} {bsdf:?} {wo}");
                }
                for outside in [from - rounding - 1e-15, to + rounding] {
                    assert!(!(0.0..1.0).contains(&outside) || !is_same(outside), "{outside} {s:?} {bsdf:?} {wo}");
                }
                assert_eq!(s.is_through, s.wi.z * wo.z < 0.0, "{s:?} {bsdf:?} {wo}");
                // Delta lobes come first.
                let before = if from > 0.0 { drawn(0.0) } else { None };
                assert!(!s.is_delta() || before.is_none_or(|first| first.is_delta()), "{s:?} {bsdf:?} {wo}");
            }
        }
    }
}

#[test]
fn nothing_gains_light() {
    for (number, bsdf) in kinds().into_iter().enumerate() {
        for wo in cases::every(3, number, directions()) {
            let (mean, error) = share(&bsdf, wo, 5_000);
            // A surface may exceed 1 only once along a path.
            let again = mean * bsdf.repeat_correction();
            assert!(again.max() < 1.005 + 5.0 * error, "{mean} {bsdf:?} {wo}");
            // A film on gold may have an orange that is purer than that of the bare metal.
            let most = if format!("{bsdf:?}").contains("FilmedMetal") { 1.1 } else { 1.03 };
            assert!(mean.max() < most + 5.0 * error, "{mean} {bsdf:?} {wo}");
        }
    }
}

#[test]
fn films_on_rough_glass_keep_nearly_all_light() {
    // By roughness: under oil and a lens coating, and under a film that reflects much more than glass.
    let (few, many) = ([0.002, 0.002, 0.005, 0.015], [0.005, 0.015, 0.07, 0.14]);
    for (indices, bounds) in [([1.0, 1.47, 1.33], few), ([1.0, 1.38, 1.52], few), ([1.0, 2.3, 1.5], many)] {
        for (alpha, most) in [0.05, 0.2, 0.5, 1.0].into_iter().zip(bounds) {
            for thickness in [90.0, 300.0] {
                let film = Filmed::new(thickness, indices);
                let bsdf: AnyBsdf = Dielectric::with(indices[2], Ggx::rough([alpha; 2]), film).into();
                for wo in directions() {
                    let (mean, error) = share(&bsdf, wo, 4_000);
                    // Channels differ in sampling probability, and in their errors by at most this factor.
                    let off = (mean - 1.0).abs().max();
                    assert!(off <= most + 7.0 * error.max(1e-3), "{mean} ± {error} {indices:?} {alpha} {wo}");
                }
            }
        }
    }
}

#[test]
fn nothing_is_negative_where_facets_are_as_open_as_they_are_seen() {
    let wo = DVec3::new(-0.8704846115323935, 0.49219563294009216, 3.0954523573989317e-12);
    let wi = DVec3::new(0.0, 1.0, 1.307040304137441e-12);
    for bsdf in kinds() {
        let (value, pdf) = bsdf.evaluate(wo, wi);
        assert!(value.is_radiance() && pdf >= 0.0, "{value} {pdf} {bsdf:?}");
    }
}

/// Unit vectors, many of them in the plane, close to it, or close to the axes.
fn any_direction() -> impl Strategy<Value = DVec3> {
    let tiny = prop_oneof![Just(0.0), Just(1e-300), Just(1e-12), Just(-1e-12), Just(1e-5), -1.0..1.0f64];
    (-1.0..1.0f64, -1.0..1.0f64, tiny).prop_filter_map("no direction", |(x, y, z)| DVec3::new(x, y, z).try_normalize())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn nothing_is_nan_infinite_or_negative(
        wo in any_direction(),
        other in any_direction(),
        relation in 0..5,
        choice in 0.0..1.0f64,
        u in prop_oneof![Just(2f64.powi(-33)), Just(1.0 - 2f64.powi(-33)), 0.0..1.0f64],
        v in prop_oneof![Just(2f64.powi(-33)), Just(1.0 - 2f64.powi(-33)), 1e-9..1.0f64],
        alpha in prop_oneof![Just(0.0), Just(1e-5), Just(1e-4), 0.0..=1.0f64],
        across in prop_oneof![Just(0.0), 0.0..=1.0f64],
        eta in prop_oneof![Just(1.0), Just(1.0 + 1e-7), Just(1.000002), Just(1.0001), 0.1..10.0f64],
    ) {
        let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
        let wi = [other, -wo, wo, mirrored, -mirrored][relation as usize];
        let mut kinds = kinds();
        kinds.push(Conductor::new(SILVER.0, SILVER.1, [alpha, across]).into());
        kinds.push(gold(1.0, [alpha, across]));
        kinds.push(Dielectric::new(eta, alpha).into());
        kinds.push(ThinDielectric::new(eta).into());
        kinds.push(Coated::new(Rgb::ONE, eta.max(1.0), alpha).into());
        kinds.push(MetallicRough::new(Rgb::ONE, across, alpha).into());
        kinds.push(OrenNayar::new(Rgb::ONE, alpha).into());
        kinds.extend(faceted::<Beckmann>([alpha, across], eta));
        kinds.extend(faceted::<Once<Ggx>>([alpha, across], eta));
        kinds.extend(faceted::<Once<Beckmann>>([alpha, across], eta));
        kinds.push(Coated::of(Rgb::ONE, eta.max(1.0), Beckmann::rough([alpha; 2])).into());
        for bsdf in kinds {
            let (value, pdf) = bsdf.evaluate(wo, wi);
            prop_assert!(value.is_radiance() && pdf.is_finite() && pdf >= 0.0, "{value} {pdf} {bsdf:?} {wo} {wi}");
            let albedo = bsdf.albedo() * bsdf.repeat_correction();
            prop_assert!(albedo.is_radiance() && albedo.max() <= 1.01, "{bsdf:?}");
            prop_assert!((0.0..=1.42).contains(&bsdf.roughness()));
            prop_assert!(!bsdf.is_delta() || value.is_black());
            if let Some(s) = bsdf.sample(wo, &mut || choice, [u, v]) {
                prop_assert!(s.weight.is_radiance() && s.pdf > 0.0 && s.eta > 0.0, "{s:?} {bsdf:?} {wo}");
                prop_assert!((s.wi.length() - 1.0).abs() < 1e-9, "{s:?} {bsdf:?} {wo}");
                prop_assert!(bsdf.transmits() || s.wi.z * wo.z >= 0.0);
            }
        }
    }
}
