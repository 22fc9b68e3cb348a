//! Lambertian reflection.

use super::bsdf_columns::LaneBsdf;
use super::soa_lanes::Straight;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;
use raywright_base::math::in_lanes;
use raywright_base::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// Lambertian reflection: equal radiance in all directions on the side of the light (Lambert, 1760). Both sides
/// reflect.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Reflectance.
    pub reflectance: Rgb,
}

impl Bsdf for Diffuse {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        let pdf = if wo.z * wi.z > 0.0 { wi.z.abs() * FRAC_1_PI } else { 0.0 };
        (self.reflectance * pdf, pdf)
    }

    /// Sampled by the cosine, so that every weight equals the reflectance.
    #[inline(always)]
    fn sample(&self, wo: DVec3, _choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 || self.reflectance.is_black() {
            return None;
        }
        let mut wi = warp::cosine_hemisphere(u);
        let pdf = warp::cosine_hemisphere_pdf(wi);
        wi.z = wi.z.copysign(wo.z);
        Some(BsdfSample::new(wi, self.reflectance, pdf))
    }

    fn albedo(&self) -> Rgb {
        self.reflectance
    }

    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        Some(self.reflectance)
    }
}

in_lanes! {
    /// Reflectances, one per lane.
    DiffuseLanes of Diffuse { reflectance: Rgb }
}

impl LaneBsdf for Diffuse {
    type Lanes = Straight<Self>;
}

#[cfg(test)]
mod tests {
    use super::super::AnyBsdf;
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::chi_square::assert_frequencies;
    use std::f64::consts::{PI, TAU};

    const GREY: Diffuse = Diffuse { reflectance: Rgb::new(0.2, 0.5, 0.8) };
    const ABOVE: DVec3 = DVec3::new(0.6, 0.0, 0.8);

    #[test]
    fn reflects_what_it_should() {
        // Hemispherical integral of f cos θ by uniform directions; its standard error is below 0.002 of it.
        let (count, below) = (100_000, DVec3::new(0.6, 0.0, -0.8));
        for wo in [ABOVE, below] {
            let mut sum = Rgb::ZERO;
            for sample in 0..count {
                let wi = warp::uniform_sphere(Sampler::new(5, 0, sample).two(0));
                sum += AnyBsdf::Diffuse(GREY).evaluate(wo, wi).0 / warp::UNIFORM_SPHERE_PDF;
            }
            assert!((sum / f64::from(count) / GREY.reflectance - 1.0).abs().max() < 0.008);
        }
    }

    #[test]
    fn is_reciprocal_and_on_one_side() {
        let wi = DVec3::new(0.0, 0.28, 0.96);
        let swapped = GREY.evaluate(wi, ABOVE).0 / ABOVE.z;
        assert!((GREY.evaluate(ABOVE, wi).0 / wi.z - swapped).abs().max() < 1e-15);
        assert_eq!(GREY.evaluate(ABOVE, -wi), (Rgb::ZERO, 0.0));
        assert_eq!(GREY.evaluate(-ABOVE, -wi), GREY.evaluate(ABOVE, wi));
    }

    #[test]
    fn draws_agree_with_density_and_weight() {
        for wo in [ABOVE, -ABOVE] {
            let mut counts = vec![0; 20 * 12];
            for sample in 0..100_000 {
                let u = Sampler::new(6, 0, sample).two(0);
                let s = AnyBsdf::Diffuse(GREY).sample(wo, &mut || unreachable!("it has one part"), u).unwrap();
                let (value, pdf) = GREY.evaluate(wo, s.wi);
                assert!((s.weight * s.pdf - value).abs().max() < 1e-15);
                assert_eq!(s.pdf, pdf);
                let row = (((s.wi.z + 1.0) * 10.0) as usize).min(19);
                counts[row * 12 + (((s.wi.y.atan2(s.wi.x) + PI) / TAU * 12.0) as usize).min(11)] += 1;
            }
            // The density is linear in the height, so its value at a band's center is its mean.
            let expected: Vec<f64> = (0..240)
                .map(|i| {
                    let z = (f64::from(i / 12) + 0.5) / 10.0 - 1.0;
                    GREY.evaluate(wo, DVec3::new((1.0 - z * z).sqrt(), 0.0, z)).1 * TAU / 120.0
                })
                .collect();
            assert_frequencies(&counts, &expected);
        }
    }

    #[test]
    fn black_ends_a_path() {
        assert!(Diffuse { reflectance: Rgb::ZERO }.sample(ABOVE, &mut || 0.0, [0.3, 0.3]).is_none());
    }
}
