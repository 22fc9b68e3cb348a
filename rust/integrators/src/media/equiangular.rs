//! Equiangular sampling of point lights along rays.

use crate::mis_weight::power_heuristic;
use raywright_base::math::{DVec3, Ray};
use raywright_scene::Scene;
use raywright_scene::lights::{Light, Place};

/// The point lights of a scene.
#[derive(Default)]
pub(crate) struct PointLights<'a>(Vec<(DVec3, &'a dyn Light)>);

/// A distance in a homogeneous medium where a path was scattered: its span of the ray, and the density of the distance.
#[derive(Clone, Copy)]
pub(crate) struct ScatteringSpan {
    pub ray: Ray,
    pub span: [f64; 2],
    pub t: f64,
    pub density: f64,
}

impl<'a> PointLights<'a> {
    pub fn of(scene: &'a Scene) -> Self {
        let point = |light: &'a dyn Light| match light.place() {
            Some(Place::Point(place)) => Some((place, light)),
            _ => None,
        };
        Self(scene.lights().others().filter_map(point).collect())
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Choose a light by a uniform number, and a distance along a span of a ray by another. Return both with the
    /// density per length; `None` if the light lies on the ray.
    pub fn sample(&self, ray: &Ray, span: [f64; 2], [choice, u]: [f64; 2]) -> Option<(&'a dyn Light, f64, f64)> {
        let count = self.0.len() as f64;
        let (place, light) = *self.0.get(((choice * count) as usize).min(self.0.len().checked_sub(1)?))?;
        let distances = Equiangular::new(ray, span, place)?;
        let t = distances.sample(u).clamp(span[0], span[1]);
        Some((light, t, distances.pdf(t) / count))
    }

    /// Return the MIS weight of the light of a point that was sampled where a path was scattered, against equiangular
    /// sampling. `place` is the point's position to within some rounding; 1 if it is none of these.
    pub fn weight(&self, at: &ScatteringSpan, place: DVec3) -> f64 {
        let ScatteringSpan { ray, span, t, density } = at;
        let reach = 1e-5 * (ray.at(*t) - place).length();
        let distance = |(point, _): &&(DVec3, &dyn Light)| (*point - place).length();
        let nearest = self.0.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some((place, _)) = nearest.filter(|point| distance(point) <= reach) else { return 1.0 };
        let Some(distances) = Equiangular::new(ray, *span, *place) else { return 1.0 };
        power_heuristic(*density, distances.pdf(*t) / self.0.len() as f64)
    }
}

/// Equiangular sampling of a ray segment of unit direction: distances are uniform in the angle seen from a point (Kulla
/// and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating Media", 2012). The density is
/// proportional to 1/d², as is the point's illumination.
struct Equiangular {
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
