//! Samples follow their densities (chi-square tests).

use super::conductors::Reflectance;
use super::*;
use glam::DVec3;
use raywright_base::cases;
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;
use std::f64::consts::{PI, TAU};

const DRAWS: u32 = 20_000;
const ROWS: usize = 12;
const COLUMNS: usize = 8;
/// Midpoints per cell along each side.
const FINE: usize = 24;

/// A map of directions to the unit square, and back with the solid angle per area.
trait Chart {
    fn cell(&self, wi: DVec3) -> Option<[f64; 2]>;
    fn direction(&self, at: [f64; 2]) -> Option<(DVec3, f64)>;
}

/// Height and azimuth.
struct Sphere;

impl Chart for Sphere {
    fn cell(&self, wi: DVec3) -> Option<[f64; 2]> {
        Some([0.5 + 0.5 * wi.z, (wi.y.atan2(wi.x) + PI) / TAU])
    }

    fn direction(&self, at: [f64; 2]) -> Option<(DVec3, f64)> {
        let (z, (sin, cos)) = (2.0 * at[0] - 1.0, (at[1] * TAU - PI).sin_cos());
        let radius = (1.0 - z * z).sqrt();
        Some((DVec3::new(radius * cos, radius * sin, z), 4.0 * PI))
    }
}

/// Slopes of the facet that reflects or refracts to `wo`, in units of α, so that even a narrow lobe fills the square.
struct Slopes {
    wo: DVec3,
    alpha: [f64; 2],
    /// Index of refraction beyond the surface, to test refraction.
    eta: Option<f64>,
}

impl Slopes {
    /// Slopes above 3 α are excluded: midpoints would miss the tail of a narrow lobe.
    const TAIL: f64 = 0.9;
}

impl Chart for Slopes {
    fn cell(&self, wi: DVec3) -> Option<[f64; 2]> {
        let q = match self.eta {
            None if wi.z * self.wo.z > 0.0 => self.wo + wi,
            Some(eta) if wi.z * self.wo.z < 0.0 => self.wo + wi * eta,
            _ => return None,
        };
        let h = if q.z < 0.0 { -q } else { q };
        // The facet must face both directions; otherwise the pair belongs to the other of reflection and refraction.
        if self.eta.is_some() && (self.wo.dot(h) * self.wo.z <= 0.0 || wi.dot(h) * wi.z <= 0.0) {
            return None;
        }
        let (x, y) = (h.x / h.z / self.alpha[0], h.y / h.z / self.alpha[1]);
        let square = x * x + y * y;
        let share = square / (1.0 + square);
        (share < Self::TAIL).then(|| [share / Self::TAIL, (y.atan2(x) + PI) / TAU])
    }

    fn direction(&self, at: [f64; 2]) -> Option<(DVec3, f64)> {
        let at = [at[0] * Self::TAIL, at[1]];
        let (radius, (sin, cos)) = ((at[0] / (1.0 - at[0])).sqrt(), (at[1] * TAU - PI).sin_cos());
        let slopes = DVec3::new(self.alpha[0] * radius * cos, self.alpha[1] * radius * sin, 1.0);
        let mut h = slopes.normalize();
        let facets = self.alpha[0] * self.alpha[1] * PI / (1.0 - at[0]).powi(2) * h.z.powi(3) * Self::TAIL;
        if self.wo.z < 0.0 {
            h = -h;
        }
        let cosine = self.wo.dot(h);
        if cosine <= 0.0 {
            // A facet that faces away is invisible.
            return None;
        }
        match self.eta {
            None => {
                let wi = h * (2.0 * cosine) - self.wo;
                (wi.z * self.wo.z > 0.0).then_some((wi, facets * 4.0 * cosine))
            }
            Some(eta) => {
                let wi = fresnel::refract(self.wo, h, eta)?;
                let q = self.wo.dot(h) + eta * wi.dot(h);
                (wi.z * self.wo.z < 0.0).then_some((wi, facets * q * q / (eta * eta * wi.dot(h).abs())))
            }
        }
    }
}

/// Fails if samples contradict the density, with a false alarm rate of 10⁻⁴ per call. Directions without a cell and
/// delta directions form one class with the remaining probability.
fn assert_density(bsdf: &AnyBsdf, wo: DVec3, chart: &impl Chart) {
    let mut counts = vec![0; ROWS * COLUMNS + 1];
    for i in 0..DRAWS {
        let mut numbers = Sampler::new(18, 0, i);
        let (choice, u) = (numbers.one(2), numbers.two(0));
        let wi = bsdf.sample(wo, &mut || choice, u).filter(|s| s.pdf.is_finite()).map(|s| s.wi);
        let cell = wi.and_then(|wi| chart.cell(wi)).map_or(ROWS * COLUMNS, |[a, b]| {
            ((a * ROWS as f64) as usize).min(ROWS - 1) * COLUMNS + ((b * COLUMNS as f64) as usize).min(COLUMNS - 1)
        });
        counts[cell] += 1;
    }
    let mut expected: Vec<f64> = (0..ROWS * COLUMNS)
        .map(|cell| {
            let mut sum = 0.0;
            for i in 0..FINE * FINE {
                let part =
                    |low: usize, i: usize, count: usize| (low as f64 + (i as f64 + 0.5) / FINE as f64) / count as f64;
                let at = [part(cell / COLUMNS, i / FINE, ROWS), part(cell % COLUMNS, i % FINE, COLUMNS)];
                if let Some((wi, area)) = chart.direction(at) {
                    sum += bsdf.evaluate(wo, wi).1 * area;
                }
            }
            sum / (FINE * FINE * ROWS * COLUMNS) as f64
        })
        .collect();
    let sum: f64 = expected.iter().sum();
    assert!(sum < 1.003, "{sum} {bsdf:?} {wo}");
    // Midpoints miss the edge of the sampled region, so a nearly empty cell joins the remaining class.
    let mut rest = 1.0 - sum;
    for cell in 0..ROWS * COLUMNS {
        if expected[cell] < 1e-4 {
            rest += expected[cell];
            counts[ROWS * COLUMNS] += counts[cell];
            (expected[cell], counts[cell]) = (0.0, 0);
        }
    }
    expected.push(rest.max(1e-3));
    if counts.iter().filter(|&&count| count > 40).count() > 1 {
        assert_frequencies(&counts, &expected);
    }
}

/// Directions at these angles, off the axes.
fn directions() -> [DVec3; 4] {
    [0.0f64, 40.0, 80.0, 89.9].map(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        DVec3::new(sin * 0.6, sin * 0.8, cos)
    })
}

#[test]
fn wide_lobes_have_their_density() {
    let half = Rgb::splat(0.5);
    let mut kinds: Vec<AnyBsdf> = vec![OrenNayar::new(half, 0.8).into(), Coated::new(half, 1.5, 0.0).into()];
    kinds.push(Phong::new(half, half, 3.0).into());
    kinds.push(BlinnPhong::new(half, half, 3.0).into());
    kinds.push(MetallicRough::new(half, 0.0, 0.0).into());
    for bsdf in &kinds {
        for wo in directions() {
            assert_density(bsdf, wo, &Sphere);
            assert_density(bsdf, -wo, &Sphere);
        }
    }
}

#[test]
fn reflections_have_their_density() {
    for alpha in [1e-4f64, 0.01, 0.3, 1.0] {
        let gold = |alpha| Conductor::metal(conductors::metal("Au").unwrap(), 1.0, alpha);
        for wo in directions() {
            for across in [alpha, (4.0 * alpha).min(0.7)] {
                let chart = Slopes { wo, alpha: [alpha, across], eta: None };
                assert_density(&gold([alpha, across]).into(), wo, &chart);
            }
            let chart = Slopes { wo, alpha: [alpha; 2], eta: None };
            assert_density(&Coated::new(Rgb::splat(0.5), 1.5, alpha).into(), wo, &chart);
            assert_density(&MetallicRough::new(Rgb::splat(0.5), 0.5, alpha.sqrt()).into(), wo, &chart);
            once_reflected::<Ggx>([alpha, (4.0 * alpha).min(0.7)], wo);
            once_reflected::<Beckmann>([alpha, (4.0 * alpha).min(0.7)], wo);
        }
    }
}

/// Tests a conductor and a plastic with single-scattering facets.
fn once_reflected<F: Facets>(alpha: [f64; 2], wo: DVec3)
where
    AnyBsdf: From<Conductor<Once<F>>> + From<CoatedOnce<F>>,
{
    let index = fresnel::ConductorIndex::new(Rgb::splat(0.2), Rgb::splat(3.0));
    let metal = Conductor::of(Reflectance::Index(index), Some(Once::<F>::new(alpha)));
    assert_density(&metal.into(), wo, &Slopes { wo, alpha, eta: None });
    let alike = Once::<F>::new([alpha[0]; 2]);
    let plastic = CoatedOnce::new(Rgb::splat(0.5), 1.5, alike, Through::new(&alike, 1.5));
    assert_density(&plastic.into(), wo, &Slopes { wo, alpha: [alpha[0]; 2], eta: None });
}

#[test]
fn refractions_have_their_density() {
    for alpha in [1e-4f64, 0.01, 0.3, 1.0] {
        for (number, eta) in [1.01, 1.5, 3.0].into_iter().enumerate() {
            for wo in cases::every(
                5,
                number + 3 * usize::from(alpha > 0.1),
                directions().into_iter().flat_map(|wo| [wo, -wo]),
            ) {
                let beyond = if wo.z > 0.0 { eta } else { 1.0 / eta };
                for bsdf in [
                    Dielectric::new(eta, alpha).into(),
                    Dielectric::of(eta, Some(Once::<Ggx>::new([alpha; 2]))).into(),
                    Dielectric::of(eta, Some(Once::<Beckmann>::new([alpha; 2]))).into(),
                    Dielectric::with(eta, Some(Ggx::new([alpha; 2])), Filmed::new(300.0, [1.0, 1.9, eta])).into(),
                ] {
                    for eta in [None, Some(beyond)] {
                        assert_density(&bsdf, wo, &Slopes { wo, alpha: [alpha; 2], eta });
                    }
                }
            }
        }
    }
}
