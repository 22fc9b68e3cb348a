//! White furnace tests by quadrature.

use super::{Bsdf, Facets, Ggx, fresnel};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Directional albedo of the first channel towards `wo`, ∫ f(wo, wi) |cos θi| dωi without the η² of radiance; 1 if
/// energy is conserved. `eta` is the index of refraction below over that above. Delta components are excluded.
///
/// The quadrature only uses [`Bsdf::evaluate`]. Cells in elevation and azimuth are subdivided until Gauss's rule of 3
/// by 3 points agrees with that of the four subcells to `precision`. Cells are narrow, down to the `width` of the
/// sharpest lobe, near reflected and refracted directions and near the tangent plane.
pub fn directional_albedo(scatter: &impl Bsdf, eta: f64, wo: DVec3, width: f64, precision: f64) -> f64 {
    let width = width.max(Ggx::SMOOTH);
    let eta = if wo.z > 0.0 { eta } else { 1.0 / eta };
    let up = DVec3::new(wo.x, wo.y, wo.z.abs());
    let elevation = |z: f64| z.min(1.0).asin();
    // Facets deflect refracted light little if the index is nearly 1, and grazing light even less.
    let bent = width * (eta - 1.0).abs().min(1.0) * up.z.max(1e-6);
    let refracted = fresnel::refract(up, DVec3::Z, eta).map_or(0.0, |w| elevation(-w.z));
    let (mirrored, straight) = (elevation(up.z), elevation(up.z));
    let mut sum = side(scatter, wo, 1.0, &[mirrored], width, precision);
    if scatter.transmits() {
        // Facets seen edge-on from both sides refract to the last of these elevations.
        let mut lobes = [refracted, straight, elevation(up.z / eta)];
        lobes.sort_unstable_by(f64::total_cmp);
        sum += side(scatter, wo, -1.0, &lobes, bent, precision) * eta * eta;
    }
    sum
}

/// Directional albedo as the mean weight of samples, for lobes that are too narrow for cells. Their numbers are
/// Hammersley's ("Monte Carlo Methods for Solving Multivariable Problems", 1960): with 2¹⁴ the error of the mean is
/// some 10⁻⁴. (With a Kronecker sequence it was 70 times larger.)
pub fn drawn_albedo(scatter: &impl Bsdf, wo: DVec3, draws: u32) -> f64 {
    let weight = |i: u32| {
        let u = [(f64::from(i) + 0.5) / f64::from(draws), radical_inverse(i, 3)];
        let choice = radical_inverse(i, 2);
        scatter.sample(wo, &mut || choice, u).map_or(0.0, |drawn| drawn.weight[0] * drawn.eta * drawn.eta)
    };
    (0..draws).map(weight).sum::<f64>() / f64::from(draws)
}

/// Radical inverse of a number in a base.
fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut digits, mut place) = (0.0, 1.0);
    while number > 0 {
        place /= f64::from(base);
        digits += place * f64::from(number % base);
        number /= base;
    }
    digits
}

/// Contribution from the side of `wo`, 1, or the opposite side, −1, with lobes at these elevations.
fn side(scatter: &impl Bsdf, wo: DVec3, side: f64, lobes: &[f64], width: f64, precision: f64) -> f64 {
    let radius = wo.x.hypot(wo.y);
    let ahead = if radius > 0.0 { [-wo.x / radius, -wo.y / radius] } else { [1.0, 0.0] };
    // A direction grazing the facets is displaced sideways by the square of their slope.
    let around = Graded { from: 0.0, to: PI, width: width * wo.z.abs().max(1e-6) };
    let mut sum = 0.0;
    let mut last = 0.0;
    for (k, &end) in lobes.iter().chain(&[FRAC_PI_2]).enumerate() {
        let middle = if k == lobes.len() { end } else { 0.5 * (last + end) };
        let near = if k == 0 { width.min(1e-3) } else { width };
        let halves = [Graded { from: last, to: middle, width: near }, Graded { from: end, to: middle, width }];
        last = end;
        for part in halves.iter().filter(|part| part.to != part.from) {
            for turn in [1.0, -1.0] {
                let value = |u: f64, v: f64| {
                    let ((elevation, along), (azimuth, across)) = (part.at(u), around.at(v));
                    let ((z, radius), (sin, cos)) = (elevation.sin_cos(), (turn * azimuth).sin_cos());
                    let x = radius * (ahead[0] * cos - ahead[1] * sin);
                    let y = radius * (ahead[1] * cos + ahead[0] * sin);
                    let wi = DVec3::new(x, y, z.copysign(side * wo.z));
                    scatter.evaluate(wo, wi).0[0] * radius * along * across
                };
                for k in 0..16 {
                    let at = [f64::from(k / 4) * 0.25, f64::from(k % 4) * 0.25];
                    sum += cell(&value, at, 0.25, gauss(&value, at, 0.25), precision, 12);
                }
            }
        }
    }
    sum
}

/// A variable that moves from one value to another, slowly at first, on the scale of a width.
struct Graded {
    from: f64,
    to: f64,
    width: f64,
}

impl Graded {
    /// Its value and derivative at `u`, 0 to 1.
    fn at(&self, u: f64) -> (f64, f64) {
        let length = (self.to - self.from).abs();
        let width = self.width.min(length);
        let rate = (length / width).ln_1p();
        let far = width * (u * rate).exp_m1();
        (self.from + far.copysign(self.to - self.from), rate * (far + width))
    }
}

/// Gauss's rule of 3 by 3 points on a square.
fn gauss(f: &impl Fn(f64, f64) -> f64, at: [f64; 2], size: f64) -> f64 {
    const NODES: [(f64, f64); 3] =
        [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
    let mut sum = 0.0;
    for (x, a) in NODES {
        for (y, b) in NODES {
            sum += a * b * f(at[0] + x * size, at[1] + y * size);
        }
    }
    sum * size * size
}

/// Integral over a square; `whole` is its value by Gauss's rule.
fn cell(f: &impl Fn(f64, f64) -> f64, at: [f64; 2], size: f64, whole: f64, precision: f64, depth: u32) -> f64 {
    let half = 0.5 * size;
    let corners = [[0.0, 0.0], [half, 0.0], [0.0, half], [half, half]].map(|[x, y]| [at[0] + x, at[1] + y]);
    let quarters = corners.map(|at| gauss(f, at, half));
    let sum: f64 = quarters.iter().sum();
    if (sum - whole).abs() < precision || depth == 0 {
        return sum;
    }
    (0..4).map(|k| cell(f, corners[k], half, quarters[k], precision, depth - 1)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::albedo::Tabulated;
    use super::super::conductors::Reflectance;
    use super::super::fresnel::ConductorIndex;
    use super::super::{
        AnyBsdf, Beckmann, Coated, Conductor, Dielectric, Diffuse, LayeredPrincipled, LayeredPrincipledThin, Look,
        MetallicRough, OrenNayar, Rgb,
    };
    use super::*;
    use raywright_base::{cases, parallel};

    /// A direction with a cosine, off both axes.
    fn turned(cosine: f64) -> DVec3 {
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        DVec3::new(0.8 * sine, 0.6 * sine, cosine)
    }

    /// From normal to grazing incidence.
    const COSINES: [f64; 9] = [1.0, 0.93, 0.8, 0.6, 0.4, 0.2, 0.08, 0.02, 0.004];

    /// From nearly smooth to fully rough, mostly between table entries.
    const ALPHAS: [f64; 9] = [0.001, 0.011, 0.05, 0.12, 0.21, 0.3, 0.47, 0.71, 1.0];

    /// Asserts that named materials conserve energy in all directions. Each has an index of refraction and the width of
    /// its sharpest lobe (`None` to use samples instead).
    fn assert_white<S: Bsdf + Sync>(materials: Vec<(S, f64, Option<f64>, String)>) {
        // A subset of directions per material, which changes from one to the next; all if `RAYWRIGHT_SLOW` is set.
        let all = materials.iter().flat_map(|case| COSINES.map(|cosine| (case, cosine)));
        let asked: Vec<_> = cases::every(5, 0, all).collect();
        let wrong = parallel::map(asked.len(), |i| {
            let ((scatter, eta, width, name), cosine) = asked[i];
            let sides = [1.0, -1.0].into_iter().filter(|&side| side > 0.0 || scatter.transmits());
            let wrong = sides.filter_map(|side| {
                let wo = turned(cosine) * side;
                let found = match *width {
                    Some(width) => directional_albedo(scatter, *eta, wo, width, 1e-6),
                    None => drawn_albedo(scatter, wo, 1 << 14),
                };
                let right = (found - 1.0).abs() < MOST;
                (!right).then(|| format!("{name} from a cosine of {}: {found}", side * cosine))
            });
            wrong.collect::<Vec<String>>()
        });
        let wrong = wrong.concat();
        assert!(wrong.is_empty(), "{} of {}: {wrong:#?}", wrong.len(), asked.len());
    }

    /// Tolerance of the albedo.
    const MOST: f64 = 0.002;

    fn glass<F: Tabulated + Send + Sync>()
    where
        Dielectric<F>: Bsdf,
    {
        let etas = [0.5, 0.66, 0.75, 0.9, 0.99, 1.01, 1.1, 1.33, 1.5, 1.8, 2.4, 3.0];
        let all = ALPHAS.iter().flat_map(|&alpha| etas.map(|eta| (alpha, eta)));
        let case = |(alpha, eta)| {
            (Dielectric::of(eta, F::rough([alpha; 2])), eta, Some(alpha), format!("index {eta}, alpha {alpha}"))
        };
        assert_white(all.map(case).collect());
    }

    fn metal<F: Tabulated + Send + Sync>()
    where
        Conductor<F>: Bsdf,
    {
        let white = || Reflectance::Index(ConductorIndex::new(Rgb::ONE, Rgb::splat(1e12)));
        let all = ALPHAS.iter().flat_map(|&alpha| [alpha, 0.003, 0.05, 0.3].map(|across| [alpha, across]));
        let case = |alpha: [f64; 2]| {
            let width = (alpha[0] == alpha[1]).then_some(alpha[0]);
            (Conductor::of(white(), F::rough(alpha)), 1.0, width, format!("{alpha:?}"))
        };
        assert_white(all.map(case).collect());
    }

    fn plastic<F: Tabulated + Send + Sync>()
    where
        Coated<F>: Bsdf,
    {
        let all = ALPHAS.iter().flat_map(|&alpha| [1.0, 1.1, 1.33, 1.5, 2.0, 3.0].map(|eta| (alpha, eta)));
        let case = |(alpha, eta)| {
            (Coated::of(Rgb::ONE, eta, F::rough([alpha; 2])), 1.0, Some(alpha), format!("index {eta}, alpha {alpha}"))
        };
        assert_white(all.map(case).collect());
    }

    #[test]
    fn glass_loses_and_gains_nothing() {
        glass::<Ggx>();
    }

    #[test]
    fn glass_of_beckmanns_facets_loses_and_gains_nothing() {
        glass::<Beckmann>();
    }

    #[test]
    fn metal_loses_and_gains_nothing() {
        metal::<Ggx>();
    }

    #[test]
    fn metal_of_beckmanns_facets_loses_and_gains_nothing() {
        metal::<Beckmann>();
    }

    #[test]
    fn plastic_loses_and_gains_nothing() {
        plastic::<Ggx>();
    }

    #[test]
    fn plastic_of_beckmanns_facets_loses_and_gains_nothing() {
        plastic::<Beckmann>();
    }

    #[test]
    fn other_white_materials_lose_and_gain_nothing() {
        let rough =
            |&alpha: &f64| (OrenNayar::new(Rgb::ONE, alpha), 1.0, Some(1.0), format!("Oren and Nayar's, {alpha}"));
        assert_white(ALPHAS.iter().map(rough).collect());
        let all = ALPHAS.iter().flat_map(|&alpha| [0.0, 0.4, 1.0].map(|metallic| (alpha, metallic)));
        let gltf = |(alpha, metallic): (f64, f64)| {
            let name = format!("glTF's, alpha {alpha}, metallic {metallic}");
            (MetallicRough::new(Rgb::ONE, metallic, alpha.sqrt()), 1.0, Some(alpha), name)
        };
        assert_white(all.map(gltf).collect());
        // In water, and in a medium of its own index.
        let all = ALPHAS.iter().flat_map(|&alpha| [(0.0, 1.33), (0.4, 1.33), (0.0, 1.5)].map(|of| (alpha, of)));
        let within = |(alpha, (metallic, outside)): (f64, (f64, f64))| {
            let name = format!("glTF's, alpha {alpha}, metallic {metallic} in {outside}");
            (MetallicRough::within(Rgb::ONE, metallic, alpha.sqrt(), outside), 1.0, Some(alpha), name)
        };
        assert_white(all.map(within).collect());
    }

    /// A white surface with a roughness, and other parameters that should not matter.
    fn white(roughness: f64, transmission: f64, other: f64, anisotropic: f64) -> Look {
        Look {
            base_color: Rgb::ONE,
            luminance: 1.0,
            roughness,
            anisotropic,
            transmission,
            specular_tint: other,
            sheen: other,
            sheen_tint: 0.5 * other,
            flatness: 1.0 - other,
        }
    }

    /// [`assert_white`] by samples, because quadrature over this many parameters would take long.
    fn assert_principled(made: impl Fn(f64, usize) -> Vec<(AnyBsdf, f64, String)>) {
        let all = ALPHAS.iter().enumerate().flat_map(|(k, &alpha)| made(alpha, k));
        assert_white(all.map(|(scatter, eta, name)| (scatter, eta, None, name)).collect());
    }

    #[test]
    fn principled_surfaces_lose_and_gain_nothing() {
        let shares = [(0.0, 0.0), (0.4, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, 0.6)];
        let others = [
            (1.5, 0.0, 0.0, [0.0; 2]),
            (1.33, 1.0, 0.0, [0.0; 2]),
            (2.4, 0.3, 0.9, [1.0, 0.0]),
            (0.7, 0.7, 0.5, [0.6, 0.9]),
        ];
        assert_principled(|alpha, k| {
            // A few of all combinations, different for each roughness.
            let case = |n: usize| {
                let ((metallic, through), (eta, other, stretch, coat)) = (shares[(n + k) % 5], others[(n + k / 5) % 4]);
                let name = format!("alpha {alpha}, {metallic} {through}, {eta} {other} {stretch} {coat:?}");
                let look = white(alpha.sqrt(), through, other, stretch);
                (LayeredPrincipled::new(look, eta, metallic, coat).into(), eta, name)
            };
            (0..4).map(case).collect()
        });
    }

    #[test]
    fn principled_sheets_lose_and_gain_nothing() {
        assert_principled(|alpha, _| {
            let case = |(sharp, eta): (f64, f64)| {
                let look = white(alpha.sqrt(), sharp, 1.0 - sharp, 0.5);
                let name = format!("sheet, alpha {alpha}, {sharp} {eta}");
                (LayeredPrincipledThin::new(look, eta, 0.3).into(), 1.0, name)
            };
            [(0.0, 1.5), (0.6, 1.33), (1.0, 2.4)].map(case).into()
        });
    }

    #[test]
    fn what_is_even_is_integrated() {
        // A diffuse surface has its reflectance as albedo, to the requested precision.
        let grey = Diffuse { reflectance: Rgb::splat(0.3) };
        for cosine in COSINES {
            let found = directional_albedo(&grey, 1.0, turned(cosine), 1.0, 1e-9);
            assert!((found - 0.3).abs() < 1e-7 && Rgb::splat(found).is_radiance(), "{cosine} {found}");
        }
    }
}
