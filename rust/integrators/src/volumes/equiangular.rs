//! Equiangular sampling of point lights along rays.

use super::camera_paths::Walker;
use super::medium_traversal::{OnTheWay, RaySegmentState};
use super::path_numbers::PathNumbers;
use super::path_state::PathState;
use super::ray_tracer::TraceRays;
use super::scattering::Scattering;
use super::spectral_mis::Weights;
use crate::transport::power_heuristic;
use raywright_base::math::{DVec3, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::{Phase, Rgb};
use raywright_scene::media::Coefficients;
use raywright_scene::{Interaction, LightSampleContext};

/// Equiangular sampling of a ray segment of unit direction: distances are uniform in the angle seen from a point (Kulla
/// and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating Media", 2012). The density is
/// proportional to 1/d², as is the point's illumination.
pub(super) struct Equiangular {
    /// The `t` of the ray's closest point to the light, and the distance there.
    foot: f64,
    distance: f64,
    angles: [f64; 2],
}

impl Equiangular {
    /// Make the sampling of a segment, which may be infinite; `None` if the point lies on the ray.
    pub fn new(ray: &Ray, [start, end]: [f64; 2], point: DVec3) -> Option<Self> {
        let foot = (point - ray.origin).dot(ray.direction);
        let distance = (point - ray.origin).cross(ray.direction).length();
        let angles = [start, end].map(|t| (t - foot).atan2(distance));
        (distance > 0.0 && angles[1] > angles[0]).then_some(Self { foot, distance, angles })
    }

    /// Return the density per length of a distance.
    pub fn pdf(&self, t: f64) -> f64 {
        let (along, [from, to]) = (t - self.foot, self.angles);
        self.distance / ((to - from) * (self.distance * self.distance + along * along))
    }

    /// Sample a distance.
    pub fn sample(&self, u: f64) -> f64 {
        let [from, to] = self.angles;
        self.foot + self.distance * (from + u * (to - from)).tan()
    }
}

/// Adds the light of points along a path's segments.
struct OfPoints<'p, 'a, A> {
    walker: &'p Walker<'a, A>,
    path: &'p PathState,
    hero: usize,
    cancel: &'p Cancel,
}

impl<A: TraceRays> OnTheWay for OfPoints<'_, '_, A> {
    async fn add(
        &self,
        now: &RaySegmentState,
        span: [f64; 2],
        (here, phase): (&Coefficients, Phase),
        numbers: &mut PathNumbers<'_>,
    ) -> Rgb {
        let RaySegmentState { ray, weights, media, .. } = *now;
        let path = PathState { ray, weights, media, ..*self.path };
        self.walker.lit_on_the_way(&path, span, here, phase, self.hero, numbers, self.cancel).await
    }
}

impl<'a, A: TraceRays> Walker<'a, A> {
    /// Return the adder of point lights for a path.
    pub(super) fn of_points<'p>(
        &'p self,
        path: &'p PathState,
        hero: usize,
        cancel: &'p Cancel,
    ) -> impl OnTheWay + use<'p, 'a, A> {
        OfPoints { walker: self, path, hero, cancel }
    }

    /// Return the in-scattered light of point lights from a homogeneous medium between two `t` of a path's ray. MIS
    /// combines it with light sampling at the path's own scattering events.
    #[allow(clippy::too_many_arguments)]
    async fn lit_on_the_way(
        &self,
        path: &PathState,
        span: [f64; 2],
        here: &Coefficients,
        phase: Phase,
        hero: usize,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
    ) -> Rgb {
        let choice = numbers.ray.light_choice(1);
        let count = self.points.len() as f64;
        let (place, light) = self.points[((numbers.one(choice) * count) as usize).min(self.points.len() - 1)];
        let Some(ways) = Equiangular::new(&path.ray, span, place) else { return Rgb::ZERO };
        let [u, _] = numbers.two(choice + 1);
        let t = ways.sample(u).clamp(span[0], span[1]);
        let pdf = ways.pdf(t) / count;
        let left = here.left(t - span[0]);
        let point = Scattering { position: path.ray.at(t), before: path.ray.direction, phase };
        let Some(light) = light.sample(&LightSampleContext { waves: path.waves, ..point.light_context() }, [0.5; 2])
        else {
            return Rgb::ZERO;
        };
        let weights = Weights { carried: path.weights.carried * here.scattering * left / pdf, ..path.weights };
        let there = PathState { weights, ..*path };
        let arrives = self.arriving(&point, &there, &light, path.media, hero, numbers, cancel).await;
        let Some(arrives) = arrives else {
            return Rgb::ZERO;
        };
        let drawn = (path.weights.drawn * here.extinction * left).mean() / path.weights.drawn.mean();
        arrives * power_heuristic(pdf, drawn)
    }

    /// Return the MIS weight of a point light sampled at a scattering event, against equiangular sampling.
    pub(super) fn beside_the_way(&self, ray: &Ray, span: [f64; 2], t: f64, density: f64, place: DVec3) -> f64 {
        if !self.points.iter().any(|(point, _)| *point == place) {
            return 1.0;
        }
        let Some(ways) = Equiangular::new(ray, span, place) else { return 1.0 };
        power_heuristic(density, ways.pdf(t) / self.points.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::chi_square::assert_frequencies;

    #[test]
    fn places_are_drawn_with_the_density_that_is_told() {
        let ray = Ray::new(DVec3::new(1.0, 2.0, 3.0), DVec3::X);
        for (point, span) in [
            (DVec3::new(2.0, 2.5, 3.0), [0.0, 3.0]),
            (DVec3::new(-4.0, 2.0, 2.0), [0.5, 20.0]),
            (DVec3::new(3.0, 2.0, 3.01), [0.0, f64::INFINITY]),
        ] {
            let ways = Equiangular::new(&ray, span, point).unwrap();
            // Boundaries of twenty segments of equal probability.
            let cuts: Vec<f64> = (0..=20).map(|i| ways.sample(f64::from(i) / 20.0)).collect();
            for pair in cuts.windows(2).filter(|pair| pair[1] < 1e6) {
                let steps = 4000;
                let step = (pair[1] - pair[0]) / f64::from(steps);
                let sum: f64 = (0..steps).map(|i| ways.pdf(pair[0] + (f64::from(i) + 0.5) * step) * step).sum();
                assert!((sum - 0.05).abs() < 1e-4, "{sum}");
            }
            let mut counts = vec![0; 20];
            for number in 0..20_000 {
                let t = ways.sample(Sampler::new(31, 0, number).one(0));
                assert!(t >= span[0] - 1e-9 && t <= span[1] + 1e-9);
                counts[(cuts.partition_point(|&cut| cut <= t).max(1) - 1).min(19)] += 1;
            }
            assert_frequencies(&counts, &[0.05; 20]);
        }
        // From a point on the ray itself all directions coincide.
        assert!(Equiangular::new(&ray, [0.0, 5.0], DVec3::new(4.0, 2.0, 3.0)).is_none());
    }
}
