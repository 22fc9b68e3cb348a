//! Generation of the tables, and a test of their contents.

use super::anisotropic::{self, mean_square, ratio};
use super::cubic::Table;
use super::quadrature::{direction, even_light, interface_loss, inverse, mirror_loss, reflected_share};
use super::tables::*;
use super::variables::{alpha, alpha_of_root, effective_cosine, index, of_cosine};
use super::{Brushed, Coat, Interface, MirrorLoss, Rough, SchlickShare, Tabulated};
use crate::{Beckmann, Facets, Ggx, fresnel};
use glam::DVec3;
use raywright_base::parallel;
use std::f64::consts::FRAC_PI_2;

/// Computes a table from a function of its variables. If the environment variable TABLES lists names, other tables are
/// left unchanged.
fn filled<const N: usize>(name: &str, like: &Table<N>, value: impl Fn([f64; N]) -> f64 + Sync) -> Table<N> {
    if std::env::var("TABLES").is_ok_and(|names| !names.split(',').any(|wanted| wanted == name)) {
        return *like;
    }
    let [low, high] = like.range.map(f64::from);
    let entry = |number: usize| {
        let mut rest = number;
        let mut variables = [0.0; N];
        for k in (0..N).rev() {
            variables[k] = (rest % like.sizes[k]) as f64 / (like.sizes[k] - 1) as f64;
            rest /= like.sizes[k];
        }
        let value = value(variables);
        // Tolerance for roundings, which dominate where the loss is tiny.
        let rounding = 1e-4 * (high - low);
        assert!((low - rounding..=high + rounding).contains(&value), "{value} at {variables:?}");
        (((value - low) / (high - low) * 65535.0).round() as u16).to_le_bytes()
    };
    let bytes: Vec<[u8; 2]> = parallel::map(like.sizes.iter().product(), entry);
    Table { bytes: bytes.concat().leak(), ..*like }
}

/// Integrates all tables of a distribution, with the sizes of others.
fn integrated<F: Facets + Sync>(like: &Tables) -> &'static Tables {
    // Below this cosine nothing changes any more.
    let from = |cosine: f64, scale: f64| direction(cosine.max(1e-7 * scale));
    let alike = |alpha: f64| F::new([alpha; 2]);
    let mirror = filled("mirror", &like.mirror, |[v, a]| {
        let a = alpha(a);
        let w = from(inverse(v, |c| of_cosine(a, c)), a);
        mirror_loss(&alike(a), w) / (a * a) * (w.z * w.z + a * a * w.x * w.x)
    });
    let brushed = filled("brushed", &like.brushed, |[v, t, r, b]| {
        // For small roughnesses only their ratio matters.
        let b = alpha(b).max(Ggx::SMOOTH / ratio(r));
        let a = b * ratio(r);
        let along = if r > 0.0 {
            let scale = (b / a).ln().recip();
            a * (b / a).powf(inverse(t, |power| anisotropic::of_along(a * (b / a).powf(power), [a, b], scale)))
        } else {
            b
        };
        let sine2 = if r > 0.0 { ((along * along - a * a) / (b * b - a * a)).clamp(0.0, 1.0) } else { t };
        let w = from(inverse(v, |c| anisotropic::of_cosine(along, b, c)), along);
        let across = a * a * w.x * w.x * (1.0 - sine2) + b * b * w.x * w.x * sine2;
        let most = (across + w.z * w.z * mean_square([a, b])) / (across + w.z * w.z);
        mirror_loss(&F::new([a, b]), DVec3::new(w.x * (1.0 - sine2).sqrt(), w.x * sine2.sqrt(), w.z)) / most
    });
    let between = |name: &str, like: &Table<3>, dense: bool| {
        filled(name, like, |[a, v, i]| {
            let a = alpha(a);
            let eta = index(a, i);
            let rough = Rough::new(a, eta);
            let at = |w: DVec3| if dense { rough.dense(w) } else { rough.thin(w) };
            let scale = if dense { a * rough.bent } else { a };
            let w = from(inverse(v, |c| at(direction(c)).0), scale);
            interface_loss(&alike(a), if dense { 1.0 / eta } else { eta }, w) / at(w).1
        })
    };
    let coat = filled("coat", &like.coat, |[a, v, i]| {
        let a = alpha_of_root(a);
        let eta = index(a, i);
        let w = from(inverse(v, |c| of_cosine(a, c)), a);
        let kept = 1.0 - mirror_loss(&alike(a), w);
        reflected_share(&alike(a), w, |c| fresnel::dielectric(c, eta)) / kept
            - fresnel::dielectric(effective_cosine(a, w.z), eta)
    });
    let schlick = filled("schlick", &like.schlick, |[v, a]| {
        let a = alpha(a);
        let w = from(inverse(v, |c| of_cosine(a, c)), a);
        reflected_share(&alike(a), w, fresnel::schlick_weight) - fresnel::schlick_weight(effective_cosine(a, w.z))
    });
    let (thin, dense) = (between("thin", &like.thin, false), between("dense", &like.dense, true));
    Box::leak(Box::new(Tables { mirror, brushed, thin, dense, coat, schlick, ..*like }))
}

/// Recomputes the averages from the interpolated tables, so that the energy given back equals the energy lost.
fn averaged(once: &'static Tables) -> &'static Tables {
    let like = once;
    let mirror_average = filled("mirror_average", &like.mirror_average, |[a]| {
        let a = alpha(a);
        let loss = MirrorLoss::with(once, [a; 2]);
        (even_light(a, |c| loss.of(direction(c))) / (a * a)).ln()
    });
    let brushed_average = filled("brushed_average", &like.brushed_average, |[r, b]| {
        let b = alpha(b).max(Ggx::SMOOTH / ratio(r));
        let a = b * ratio(r);
        let loss = Brushed::new(once, [a, b]);
        let steps = 48;
        let sum: f64 = (0..steps)
            .map(|k| {
                // Denser near the direction of lesser roughness.
                let u = (f64::from(k) + 0.5) / f64::from(steps);
                let (sin, cos) = (FRAC_PI_2 * u * u * u).sin_cos();
                let along = (a * cos).hypot(b * sin);
                let at = |c| {
                    let w = direction(c);
                    loss.of(DVec3::new(w.x * cos, w.x * sin, w.z))
                };
                3.0 * u * u * even_light(along, at)
            })
            .sum();
        (sum / f64::from(steps) / mean_square([a, b])).ln()
    });
    let average = |name: &str, like: &Table<2>, dense: bool| {
        filled(name, like, |[a, i]| {
            let (a, eta) = (alpha(a), index(alpha(a), i));
            let (rough, interface) = (Rough::new(a, eta), Interface::with(once, a, eta));
            let scale = if dense { a * rough.bent } else { a };
            let loss = |w: DVec3| interface.loss(if dense { -w } else { w });
            (even_light(scale, |c| loss(direction(c))) / rough.unit()).ln()
        })
    };
    let coat_average = filled("coat_average", &like.coat_average, |[a, i]| {
        let (a, eta) = (alpha(a), index(alpha(a), i));
        let coat = Coat::with(once, a, eta);
        even_light(1.0, |c| coat.of(c)) - fresnel::dielectric_average(eta)
    });
    let schlick_average = filled("schlick_average", &like.schlick_average, |[a]| {
        let share = SchlickShare::with(once, alpha(a));
        even_light(1.0, |c| share.of(c))
    });
    let thin_average = average("thin_average", &like.thin_average, false);
    let dense_average = average("dense_average", &like.dense_average, true);
    Box::leak(Box::new(Tables {
        mirror_average,
        brushed_average,
        thin_average,
        dense_average,
        coat_average,
        schlick_average,
        ..*once
    }))
}

/// Writes the tables. If their sizes have changed, files of the new sizes must exist for the crate to compile.
#[test]
#[ignore = "writes files"]
fn write_tables() {
    write::<Beckmann>("beckmann");
    write::<Ggx>("ggx");
}

/// Writes the tables of a distribution to its folder.
fn write<F: Tabulated + Sync>(folder: &str) {
    let folder = format!("{}/rust/optics/albedo/tables/{folder}", env!("CARGO_MANIFEST_DIR"));
    let write = |tables: &Tables| {
        for (name, bytes) in tables.files() {
            std::fs::write(format!("{folder}/{name}.bin"), bytes).unwrap();
        }
    };
    let once = integrated::<F>(F::TABLES);
    write(once);
    write(averaged(once));
}
