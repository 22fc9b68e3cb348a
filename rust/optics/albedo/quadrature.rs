//! The integrals that the tables hold, the writing of the tables, and the check that they hold them.

use super::{MirrorLoss, coat, interface, mirror, schlick};
use super::{effective_cosine, of_alpha, of_x};
use crate::optics::{Facets, Ggx, fresnel};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The mean over the facets that `w` sees of a function of their normal, by midpoints. Half the azimuths are enough by
/// symmetry where `w` lies in the plane of x and z; the tail of the distribution is spread out: 1 − u = s².
fn mean_over_facets(ggx: &Ggx, w: DVec3, steps: [usize; 2], value: impl Fn(DVec3) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..steps[0] {
        // s = t² puts points where lobes meet the horizon, at small s.
        let t = (i as f64 + 0.5) / steps[0] as f64;
        let (s, ds) = (t * t, 2.0 * t);
        for j in 0..steps[1] {
            let u = [(j as f64 + 0.5) / steps[1] as f64 * if w.y == 0.0 { 0.5 } else { 1.0 }, 1.0 - s * s];
            sum += 2.0 * s * ds * value(ggx.sample_visible(w, u));
        }
    }
    sum / (steps[0] * steps[1]) as f64
}

/// G₂ / G₁(wo) of a reflection, 0 below the horizon.
fn reflected(ggx: &Ggx, wo: DVec3, h: DVec3) -> f64 {
    let wi = h * (2.0 * wo.dot(h)) - wo;
    if wi.z > 0.0 { ggx.reflection_geometry(wo, wi) * 2.0 * (wo.z + ggx.stretch(wo)) } else { 0.0 }
}

/// G₂ / G₁(wo) of a refraction, 0 if it ends on the side of `wo`.
fn refracted(ggx: &Ggx, wo: DVec3, h: DVec3, eta: f64) -> f64 {
    match fresnel::refract(wo, h, eta) {
        Some(wi) if wi.z < 0.0 => (ggx.masking(wi) / ggx.masking(wo)).min(1.0),
        _ => 0.0,
    }
}

const STEPS: [usize; 2] = [96, 48];

/// What is reflected totally ends at a line between the facets, which so many midpoints tell to a few thousandths.
const SHARP_STEPS: [usize; 2] = [300, 48];

/// 1 − what perfect mirrors reflect once.
pub(super) fn mirror_loss(ggx: &Ggx, w: DVec3) -> f64 {
    1.0 - mean_over_facets(ggx, w, STEPS, |h| reflected(ggx, w, h))
}

/// 1 − what facets of index `eta` reflect and refract once; `w` is above, where the index is 1.
pub(super) fn interface_loss(ggx: &Ggx, eta: f64, w: DVec3) -> f64 {
    1.0 - mean_over_facets(ggx, w, SHARP_STEPS, |h| {
        let f = fresnel::dielectric(w.dot(h), eta);
        f * reflected(ggx, w, h) + (1.0 - f) * refracted(ggx, w, h, eta)
    })
}

/// The mean of a function of the facets' cosine over what is reflected once.
fn reflected_mean(ggx: &Ggx, w: DVec3, value: impl Fn(f64) -> f64) -> f64 {
    let whole = mean_over_facets(ggx, w, STEPS, |h| reflected(ggx, w, h));
    mean_over_facets(ggx, w, STEPS, |h| reflected(ggx, w, h) * value(w.dot(h))) / whole
}

/// The integral over even light, ∫ f(μ) 2μ dμ, of a function that changes on the scale of `alpha`. The variable
/// t = μ / (μ + α), spread to its ends, has that scale in the middle.
fn even_light(alpha: f64, f: impl Fn(DVec3) -> f64) -> f64 {
    let steps = 400;
    let top = 1.0 / (1.0 + alpha);
    let sum: f64 = (0..steps)
        .map(|i| {
            let v = (i as f64 + 0.5) / steps as f64;
            let (t, dt) = (top * v * v * (3.0 - 2.0 * v), top * 6.0 * v * (1.0 - v));
            let (mu, dmu) = (alpha * t / (1.0 - t), alpha / ((1.0 - t) * (1.0 - t)) * dt);
            f(direction(mu.min(1.0))) * 2.0 * mu * dmu
        })
        .sum();
    sum / steps as f64
}

fn direction(cosine: f64) -> DVec3 {
    DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine)
}

/// The value at which an increasing function from [low, high] takes the value `at`.
fn inverse(low: f64, high: f64, at: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < at { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn entry(i: usize, count: usize) -> f64 {
    i as f64 / (count - 1) as f64
}

/// The roughness at a table's entry; that of none at all is taken where nothing changes any more.
fn alpha(i: usize, count: usize) -> f64 {
    inverse(0.0, 1.0, entry(i, count), of_alpha).max(1e-4)
}

/// Below this entries are those of no roughness.
const SMOOTHEST: f64 = 1e-4;

fn alpha_root(i: usize, count: usize) -> f64 {
    entry(i, count).powi(3).max(1e-5)
}

/// The direction in the plane of x and z of a table's entry for a variable of x.
fn grazing(ggx: &Ggx, i: usize, count: usize, variable: impl Fn(f64) -> f64) -> DVec3 {
    let x = inverse(0.0, 1.0, entry(i, count), variable).clamp(1e-9, 1.0);
    let (sin, cos) = (((1.0 - x) * (1.0 + x)).max(0.0).sqrt(), x * ggx.alpha()[0]);
    DVec3::new(sin, 0.0, cos).normalize()
}

/// The index of a table's entry at a roughness. In place of 1, where nothing is lost, stands one so near to it that
/// what is bent does not change any more, in units of what is.
fn index(alpha: f64, variable: f64) -> f64 {
    let w = alpha * ((1.0 - variable).powi(-3).min(1e6) - 1.0).max(0.01);
    w.hypot(1.0)
}

fn coat_index(i: usize, count: usize) -> f64 {
    let root = entry(i, count).powi(2).min(1.0 - 1e-9);
    (1.0 + root) / (1.0 - root)
}

/// The entries of the tables, by number.
mod entries {
    use super::*;

    pub fn isotropic(k: usize) -> f64 {
        let [n, m] = mirror::ISOTROPIC_SIZES;
        let ggx = Ggx::new([alpha(k % m, m); 2]);
        mirror_loss(&ggx, grazing(&ggx, k / m, n, of_x))
    }

    pub fn anisotropic(k: usize) -> f64 {
        let [n, m, l] = mirror::ANISOTROPIC_SIZES;
        let ggx = Ggx::new([alpha(k / l % m, m), alpha(k % l, l)]);
        mirror_loss(&ggx, grazing(&ggx, k / (l * m), n, of_x))
    }

    pub fn loss(k: usize, dense: bool) -> f64 {
        let [n, m, l] = if dense { interface::DENSE_SIZES } else { interface::THIN_SIZES };
        let a = entry(k / l % m, m).powf(1.0 / 0.7).max(1e-4);
        let (ggx, eta) = (Ggx::new([a; 2]), index(a, entry(k % l, l)));
        let bent = interface::bent(interface::scale(a, eta));
        let variable = |x: f64| {
            let cosine = a * x / (a * x).hypot(((1.0 - x) * (1.0 + x)).sqrt());
            if dense { interface::of_dense(a, eta, bent, x, cosine) } else { of_x(x) }
        };
        interface_loss(&ggx, if dense { 1.0 / eta } else { eta }, grazing(&ggx, k / (l * m), n, variable))
    }

    pub fn coat_mean(k: usize) -> f64 {
        let [n, m, l] = coat::SIZES;
        let (a, eta) = (alpha_root(k / l % m, m), coat_index(k % l, l));
        let w = direction(entry(k / (l * m), n).powi(2).clamp(1e-7, 1.0));
        let mean = reflected_mean(&Ggx::new([a; 2]), w, |c| fresnel::dielectric(c, eta));
        if a < SMOOTHEST { 0.5 } else { mean - fresnel::dielectric(effective_cosine(a, w.z), eta) + 0.5 }
    }

    pub fn schlick_mean(k: usize) -> f64 {
        let [n, m] = schlick::SIZES;
        let a = alpha_root(k % m, m);
        let w = direction(entry(k / m, n).powi(2).clamp(1e-7, 1.0));
        let mean = reflected_mean(&Ggx::new([a; 2]), w, fresnel::schlick_weight);
        if a < SMOOTHEST { 0.5 } else { mean - fresnel::schlick_weight(effective_cosine(a, w.z)) + 0.5 }
    }

    // Averages are those of what the tables give between their entries, so that what is given back sums to what is
    // lost.

    pub fn mirror_average(k: usize) -> f64 {
        let [m, l] = mirror::AVERAGE_SIZES;
        let alpha = [alpha_root(k / l, m), alpha_root(k % l, l)];
        let loss = MirrorLoss::new(Ggx::new(alpha));
        let [a, b] = alpha;
        let azimuths = if a == b { 1 } else { 24 };
        let sum: f64 = (0..azimuths)
            .map(|i| {
                let (sin, cos) = ((i as f64 + 0.5) / azimuths as f64 * FRAC_PI_2).sin_cos();
                let scale = (a * a * cos * cos + b * b * sin * sin).sqrt();
                even_light(scale, |w| loss.of(DVec3::new(w.x * cos, w.x * sin, w.z)))
            })
            .sum();
        (sum / azimuths as f64 / (0.5 * (a * a + b * b))).ln()
    }

    pub fn loss_average(k: usize, dense: bool) -> f64 {
        let [m, l] = interface::AVERAGE_SIZES;
        let a = alpha_root(k / l, m);
        let eta = index(a, entry(k % l, l).powi(2));
        let bent = interface::bent(interface::scale(a, eta));
        let interface = super::super::Interface::new(a, eta);
        // What is bent away has a smaller scale than the rest, which changes slowly.
        (even_light(a * bent, |w| interface.loss(if dense { -w } else { w })) / (a * a)).max(1e-30).ln()
    }

    pub fn coat_average(k: usize) -> f64 {
        let [m, l] = coat::AVERAGE_SIZES;
        let (a, eta) = (alpha_root(k / l, m), coat_index(k % l, l));
        let loss = MirrorLoss::new(Ggx::new([a; 2]));
        even_light(0.1, |w| super::super::coat(a, eta, w.z) * (1.0 - loss.of(w)))
    }

    pub fn schlick_average(k: usize) -> f64 {
        let a = alpha_root(k, schlick::AVERAGE_SIZE);
        let loss = MirrorLoss::new(Ggx::new([a; 2]));
        even_light(0.1, |w| super::super::schlick_share(a, w.z) * (1.0 - loss.of(w)))
    }
}

/// Source code of a table, in lines as long as they may be.
fn table(name: &str, doc: &str, kind: &str, numbers: Vec<String>) -> String {
    let mut source = format!("/// {doc}\n#[rustfmt::skip]\npub static {name}: [{kind}; {}] = [", numbers.len());
    let mut length = usize::MAX;
    for number in &numbers {
        if length > 116 - number.len() {
            source.push_str("\n   ");
            length = 3;
        }
        source.push_str(&format!(" {number},"));
        length += number.len() + 2;
    }
    source + "\n];\n"
}

fn shares(name: &str, doc: &str, count: usize, value: impl Fn(usize) -> f64) -> String {
    let share = |k| (value(k).clamp(0.0, 1.0) * 65535.0).round() as u16;
    table(name, doc, "u16", (0..count).map(|k| share(k).to_string()).collect())
}

fn means(name: &str, doc: &str, count: usize, value: impl Fn(usize) -> f64) -> String {
    table(name, doc, "f64", (0..count).map(|k| format!("{:.5}", value(k))).collect())
}

/// Writes the tables. What averages are made of has to be there and compiled before them: run it twice.
#[test]
#[ignore = "writes source files"]
fn write_tables() {
    let write = |name: &str, what: &str, parts: &[String]| {
        let path = format!("{}/rust/optics/albedo/tables/{name}.rs", env!("CARGO_MANIFEST_DIR"));
        std::fs::write(path, format!("//! {what}\n\n{}", parts.join("\n"))).unwrap();
    };
    const MEANS: &str = "Logarithms of the means over even light, over α².";
    let product = |sizes: &[usize]| sizes.iter().product::<usize>();
    write(
        "mirror",
        "Losses of perfect mirrors, in 65535ths.",
        &[
            shares("ISOTROPIC", "By grazing and α.", product(&mirror::ISOTROPIC_SIZES), entries::isotropic),
            shares(
                "ANISOTROPIC",
                "By grazing, α along and α across.",
                product(&mirror::ANISOTROPIC_SIZES),
                entries::anisotropic,
            ),
            means(
                "AVERAGE",
                "Logarithms of the means over even light, over the mean of α².",
                product(&mirror::AVERAGE_SIZES),
                entries::mirror_average,
            ),
        ],
    );
    let (thin, dense) = (product(&interface::THIN_SIZES), product(&interface::DENSE_SIZES));
    let average = product(&interface::AVERAGE_SIZES);
    write(
        "interface_thin",
        "Losses of facets between dielectrics from the thinner side, in 65535ths.",
        &[
            shares("THIN", "By grazing, α and index.", thin, |k| entries::loss(k, false)),
            means("THIN_AVERAGE", MEANS, average, |k| entries::loss_average(k, false)),
        ],
    );
    write(
        "interface_dense",
        "Losses of facets between dielectrics from the denser side, in 65535ths.",
        &[
            shares("DENSE", "By grazing, α and index.", dense, |k| entries::loss(k, true)),
            means("DENSE_AVERAGE", MEANS, average, |k| entries::loss_average(k, true)),
        ],
    );
    write(
        "coat",
        "Reflectances of rough coats, in 65535ths.",
        &[
            shares("MEAN", "By √cos θ, α and index.", product(&coat::SIZES), entries::coat_mean),
            means("AVERAGE", "Means over even light.", product(&coat::AVERAGE_SIZES), entries::coat_average),
        ],
    );
    write(
        "schlick",
        "Means of Schlick's term, in 65535ths.",
        &[
            shares("MEAN", "By √cos θ and α.", product(&schlick::SIZES), entries::schlick_mean),
            means("AVERAGE", "Means over even light.", schlick::AVERAGE_SIZE, entries::schlick_average),
        ],
    );
}

/// Roughnesses between the entries of every table, and cosines that are not theirs either.
const ALPHAS: [f64; 8] = [1e-4, 0.01, 0.037, 0.155, 0.23, 0.46, 0.77, 0.93];
const COSINES: [f64; 11] = [1e-6, 1e-3, 0.004, 0.017, 0.05, 0.11, 0.23, 0.55, 0.71, 0.86, 0.995];

/// Fails where two values for some arguments differ by more.
fn assert_near(value: f64, truth: f64, bound: f64, what: &[f64]) {
    assert!((value - truth).abs() < bound, "{value} for {truth} at {what:?}");
}

#[test]
fn mirrors_lose_what_the_table_says() {
    for a in ALPHAS {
        for c in COSINES {
            let (w, ggx) = (direction(c), Ggx::new([a; 2]));
            assert_near(MirrorLoss::new(ggx).of(w), mirror_loss(&ggx, w), 0.004, &[a, c]);
            let schlick = reflected_mean(&ggx, w, fresnel::schlick_weight);
            assert_near(super::schlick_share(a, c), schlick, 0.004, &[a, c]);
            for b in [0.003, 0.05, 0.3, 0.8] {
                for turn in [0.0, 0.4, 0.8, 1.2, 1.4, FRAC_PI_2] {
                    let (sin, cos) = f64::sin_cos(turn);
                    let (w, ggx) = (DVec3::new(w.x * cos, w.x * sin, w.z), Ggx::new([a, b]));
                    assert_near(MirrorLoss::new(ggx).of(w), mirror_loss(&ggx, w), 0.01, &[a, b, c, turn]);
                }
            }
        }
    }
}

#[test]
fn coats_reflect_what_the_table_says() {
    for a in ALPHAS {
        for c in COSINES {
            let (w, ggx) = (direction(c), Ggx::new([a; 2]));
            for eta in [1.2, 1.33, 1.5, 1.8, 2.4, 3.0] {
                let mean = reflected_mean(&ggx, w, |c| fresnel::dielectric(c, eta));
                assert_near(super::coat(a, eta, c), mean, 0.01, &[a, eta, c]);
            }
        }
    }
}

#[test]
fn interfaces_lose_what_the_tables_say() {
    for a in ALPHAS {
        for c in COSINES {
            let (w, ggx) = (direction(c), Ggx::new([a; 2]));
            for eta in [1.00001, 1.0003, 1.01, 1.07, 1.2, 1.33, 1.5, 1.8, 2.4, 3.0, 5.0, 10.0] {
                let interface = super::Interface::new(a, eta);
                let bound = if eta < 1.001 { 0.009 } else { 0.005 };
                assert_near(interface.loss(w), interface_loss(&ggx, eta, w), 0.005, &[a, eta, c]);
                assert_near(interface.loss(-w), interface_loss(&ggx, 1.0 / eta, w), bound, &[a, 1.0 / eta, c]);
            }
        }
    }
}
