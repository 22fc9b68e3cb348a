use super::super::AnyBsdf;
use super::*;
use raywright_base::math::trig::sin_cos_turn;
use raywright_base::sampling::Sampler;
use std::f64::consts::PI;

fn look() -> Look {
    Look {
        base_color: Rgb::new(0.8, 0.5, 0.2),
        luminance: Rgb::new(0.8, 0.5, 0.2).luminance(),
        roughness: 0.5,
        anisotropic: 0.0,
        transmission: 0.0,
        specular_tint: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
    }
}

/// Metal under a coat, coated glass and a sheet, as published and with energy conservation.
fn kinds() -> [AnyBsdf; 6] {
    let metal = Look {
        roughness: 0.4,
        anisotropic: 0.6,
        specular_tint: 0.4,
        sheen: 0.7,
        sheen_tint: 0.5,
        flatness: 0.3,
        ..look()
    };
    let glass = Look { roughness: 0.6, anisotropic: 0.3, transmission: 0.7, sheen: 0.4, ..look() };
    let sheet = Look {
        anisotropic: 0.4,
        transmission: 0.6,
        specular_tint: 0.3,
        sheen: 0.5,
        sheen_tint: 0.2,
        flatness: 0.4,
        ..look()
    };
    [
        Principled::new(metal, 1.4, 0.3, [0.8, 0.2], false).into(),
        Principled::new(glass, 1.6, 0.2, [0.5, 0.0], true).into(),
        PrincipledThin::new(sheet, 1.33, 0.4).into(),
        LayeredPrincipled::new(metal, 1.4, 0.3, [0.8, 0.2]).into(),
        LayeredPrincipled::new(glass, 1.6, 0.2, [0.5, 0.0]).into(),
        LayeredPrincipledThin::new(sheet, 1.33, 0.4).into(),
    ]
}

/// Index of the BSDF, wo, wi, the value with its cosine, and the density.
type Told = (usize, [f64; 3], [f64; 3], [f64; 3], f64);

/// Values of Mitsuba 3.9.1 (scalar_rgb).
#[rustfmt::skip]
const MITSUBA: [Told; 15] = [
    (0, [0.341881729, 0.227921153, 0.911684612], [-0.577350269, 0.115470054, 0.808290377],
     [0.18356, 0.117941, 0.0523227], 0.214292),
    (0, [0.963086825, -0.120385853, 0.240771706], [-0.717137166, 0.358568583, 0.597614305],
     [0.180342, 0.120767, 0.0611918], 0.180917),
    (0, [0.10976426, 0.10976426, 0.98787834], [0.131369364, 0.10947447, 0.985270232],
     [0.334081, 0.217146, 0.100211], 0.490689),
    (1, [0.341881729, 0.227921153, 0.911684612], [-0.577350269, 0.115470054, 0.808290377],
     [0.117588, 0.0802116, 0.0428349], 0.182532),
    (1, [0.963086825, -0.120385853, 0.240771706], [-0.717137166, 0.358568583, 0.597614305],
     [0.150335, 0.114662, 0.0789894], 0.214311),
    (1, [0.127000127, 0.762000762, 0.635000635], [-0.101015254, -0.404061018, -0.90913729],
     [0.768185, 0.607303, 0.384092], 1.61911),
    (1, [0.227921153, -0.341881729, -0.911684612], [-0.38411064, 0.51214752, -0.76822128],
     [0.0273689, 0.0273689, 0.0273689], 0.0499073),
    (1, [0.301511345, 0.301511345, -0.904534034], [-0.209369569, -0.261711961, 0.942163061],
     [0.82352, 0.65105, 0.41176], 0.644815),
    (1, [0.10976426, 0.10976426, 0.98787834], [0.131369364, 0.10947447, 0.985270232],
     [0.159404, 0.110198, 0.0609912], 0.25064),
    (2, [0.341881729, 0.227921153, 0.911684612], [-0.577350269, 0.115470054, 0.808290377],
     [0.0485266, 0.0313834, 0.0142403], 0.159392),
    (2, [0.963086825, -0.120385853, 0.240771706], [-0.717137166, 0.358568583, 0.597614305],
     [0.0587002, 0.0430026, 0.0273051], 0.15477),
    (2, [0.127000127, 0.762000762, 0.635000635], [-0.101015254, -0.404061018, -0.90913729],
     [0.0734852, 0.0459282, 0.0183713], 0.0696208),
    (2, [0.227921153, -0.341881729, -0.911684612], [-0.38411064, 0.51214752, -0.76822128],
     [0.0535091, 0.0361238, 0.0187384], 0.298314),
    (2, [0.301511345, 0.301511345, -0.904534034], [-0.209369569, -0.261711961, 0.942163061],
     [4.09839, 2.56149, 1.0246], 2.63855),
    (2, [0.10976426, 0.10976426, 0.98787834], [0.131369364, 0.10947447, 0.985270232],
     [0.0601359, 0.0395945, 0.0190532], 0.266202),
];

#[test]
fn values_and_densities_are_those_of_mitsuba() {
    let kinds = kinds();
    // Energy-conserving variants have other values.
    for (which, wo, wi, value, density) in MITSUBA {
        let [wo, wi] = [wo, wi].map(|w| DVec3::from_array(w).normalize());
        let (found, pdf) = kinds[which].evaluate(wo, wi);
        // Mitsuba computes in f32; six of its digits are kept.
        let near = |a: f64, b: f64| (a - b).abs() <= 3e-5 * b.abs();
        assert!((0..3).all(|c| near(found[c], value[c])), "{which} {wo} {wi} {found:?} {value:?}");
        assert!(near(pdf, density), "{which} {wo} {wi} {pdf} {density}");
    }
}

/// Directions on both sides, off the axes.
fn directions() -> Vec<DVec3> {
    let mut found = Vec::new();
    for (degrees, turn) in [(5.0f64, 1.0f64), (40.0, 0.3), (70.0, 2.5), (85.0, 4.0)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let w = DVec3::new(sin * turn.cos(), sin * turn.sin(), cos);
        found.extend([w, -w]);
    }
    found
}

#[test]
fn light_can_go_either_way() {
    let [metal, glass, sheet, layered, clear, thin] = kinds();
    for a in directions() {
        for b in directions() {
            for (bsdf, eta) in
                [(&metal, 1.0), (&glass, 1.6f64), (&sheet, 1.0), (&layered, 1.0), (&clear, 1.6), (&thin, 1.0)]
            {
                // Coats and colors of glass are on its front only. On the back only its facets reflect, and both
                // directions of a reflection are on the same side.
                let square = |w: DVec3| if w.z > 0.0 { 1.0 } else { eta * eta };
                let there = bsdf.evaluate(a, b).0 * (a.z.abs() / square(a));
                let back = bsdf.evaluate(b, a).0 * (b.z.abs() / square(b));
                for c in 0..3 {
                    assert!(
                        (there[c] - back[c]).abs() <= 1e-12 * there[c].abs().max(1e-3),
                        "{a} {b} {there:?} {back:?}"
                    );
                }
            }
        }
    }
}

/// Sample weights match their directions, and the integral of the density equals the share of samples that scatter, by
/// as many uniform directions, within five standard errors.
#[test]
fn draws_are_as_dense_as_they_say() {
    for bsdf in kinds() {
        for wo in directions() {
            let count = 20_000;
            let (mut drawn, mut sums) = (0.0, [0.0; 2]);
            for i in 0..count {
                let mut numbers = Sampler::new(7, 0, i);
                let (choice, u, place) = (numbers.one(2), numbers.two(0), numbers.two(3));
                if let Some(sample) = bsdf.sample(wo, &mut || choice, u) {
                    let (value, pdf) = bsdf.evaluate(wo, sample.wi);
                    assert!((sample.pdf / pdf - 1.0).abs() < 1e-12);
                    assert!((sample.weight - value / pdf).abs().max() < 1e-12);
                    assert!(sample.choices[0] <= choice && choice < sample.choices[1]);
                    assert_eq!(sample.is_through, sample.wi.z * wo.z < 0.0);
                    drawn += 1.0;
                }
                let (z, [sin, cos]) = (2.0 * place[0] - 1.0, sin_cos_turn(place[1]));
                let radius = (1.0 - z * z).sqrt();
                let density = 4.0 * PI * bsdf.evaluate(wo, DVec3::new(radius * cos, radius * sin, z)).1;
                sums = [sums[0] + density, sums[1] + density * density];
            }
            let count = f64::from(count);
            let (share, mean) = (drawn / count, sums[0] / count);
            let error = ((sums[1] / count - mean * mean + share * (1.0 - share)) / count).sqrt();
            assert!((share - mean).abs() < 5.0 * error, "{bsdf:?} {wo}: {share} {mean} {error}");
        }
    }
}

/// With a colored base no channel gains energy, from tints or sheen.
#[test]
fn colours_gain_nothing() {
    for (base_color, specular_tint) in
        [(Rgb::new(0.0, 0.0, 1.0), 1.0), (Rgb::new(1.0, 0.2, 0.0), 0.5), (Rgb::ZERO, 0.0)]
    {
        let colored = Look {
            base_color,
            luminance: base_color.luminance(),
            specular_tint,
            sheen: 1.0,
            sheen_tint: 1.0,
            transmission: 0.3,
            ..look()
        };
        for eta in [1.5, 2.5] {
            let solid: AnyBsdf = LayeredPrincipled::new(colored, eta, 0.2, [1.0, 0.5]).into();
            let sheet: AnyBsdf = LayeredPrincipledThin::new(colored, eta, 0.3).into();
            for (bsdf, wo) in [solid, sheet].iter().flat_map(|bsdf| directions().into_iter().map(move |wo| (bsdf, wo)))
            {
                let mut sum = Rgb::ZERO;
                for i in 0..4000 {
                    let mut numbers = Sampler::new(3, 0, i);
                    let (choice, u) = (numbers.one(2), numbers.two(0));
                    sum += bsdf.sample(wo, &mut || choice, u).map_or(Rgb::ZERO, |s| s.weight * (s.eta * s.eta));
                }
                assert!((sum / 4000.0).max() < 1.02, "{bsdf:?} {wo} {sum}");
            }
        }
    }
}

/// A coat's albedo is that of the integral, and its mean that of the albedo.
#[test]
fn coats_reflect_what_they_are_taken_to() {
    for gloss in [0.0, 0.3, 0.8, 1.0] {
        let coat = Gtr1::of_gloss(gloss);
        let mut mean = 0.0;
        for k in 0..40 {
            let cosine = (f64::from(k) + 0.5) / 40.0;
            let wo = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
            let mut sum = 0.0;
            for at in 0..64 * 256 {
                let half = coat.sample([(f64::from(at % 64) + 0.5) / 64.0, (f64::from(at / 64) + 0.5) / 256.0]);
                let wi = half * (2.0 * wo.dot(half)) - wo;
                if wi.z > 0.0 && wo.dot(half) > 0.0 {
                    let density = coat.density(half);
                    let pdf = density * half.z / (4.0 * wo.dot(half));
                    sum += coat.reflected(density, wo.dot(half), [wo, wi]) / pdf;
                }
            }
            let (found, truth) = (coat.albedo(cosine), sum / (64.0 * 256.0));
            assert!((found - truth).abs() < 0.002, "{gloss} {cosine} {found} {truth}");
            assert!(found <= coat.albedo(1.0));
            mean += 2.0 * cosine * found / 40.0;
        }
        assert!((coat.albedo_average() - mean).abs() < 2e-4);
    }
}

/// A white diffuse base gains energy, because nothing subtracts the facets' reflection from it (Burley, 2012): up to a
/// sixth, and half at grazing angles. The gain does not exceed that.
#[test]
fn little_light_is_gained() {
    for roughness in [0.1, 0.5, 1.0] {
        for transmission in [0.0, 0.5, 1.0] {
            let white = Look { base_color: Rgb::ONE, luminance: 1.0, roughness, transmission, ..look() };
            let kinds: [AnyBsdf; 2] = [
                Principled::new(white, 1.5, 0.0, [0.0; 2], transmission > 0.0).into(),
                PrincipledThin::new(white, 1.5, 0.5).into(),
            ];
            for bsdf in kinds {
                for wo in directions() {
                    let mut sum = 0.0;
                    for i in 0..4000 {
                        let mut numbers = Sampler::new(3, 0, i);
                        let (choice, u) = (numbers.one(2), numbers.two(0));
                        sum += bsdf.sample(wo, &mut || choice, u).map_or(0.0, |s| s.weight.max() * s.eta * s.eta);
                    }
                    let most = if wo.z.abs() > 0.3 { 1.17 } else { 1.5 };
                    assert!(sum / 4000.0 < most, "{roughness} {transmission} {wo}: {}", sum / 4000.0);
                }
            }
        }
    }
}
