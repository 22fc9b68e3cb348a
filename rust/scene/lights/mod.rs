//! All lights of a scene, and the choice among them.

mod emission;
mod light;

pub use emission::Emission;
pub use light::{LightSample, PointLight};

use super::{Geometry, textures::TexturePoint};
use crate::math::{DVec3, Frame, Hit, Ray};
use crate::optics::Rgb;
use crate::sampling::{AliasTable, warp};
use light::{sample_shape, sample_triangle, solid_angle_pdf};
use std::f64::consts::PI;

/// The lights of a scene: emitting surfaces, points, and what comes from outside.
///
/// One is chosen by its power, and the density of any direction that meets a light is known in constant time: emitting
/// triangles are numbered shape after shape, then come the points, and last the environment.
#[derive(Debug)]
pub struct Lights {
    /// How each shape shines.
    emission: Vec<Emission>,
    /// For each shape, the number of its first primitive among lights; it means nothing for one that is dark.
    first: Vec<u32>,
    /// The primitives that emit.
    surfaces: Vec<u32>,
    points: Vec<PointLight>,
    environment: Rgb,
    /// `None` in a scene without light.
    choice: Option<AliasTable>,
}

/// The greatest power that is told from greater ones: the sum of as many as there can be is still finite.
const MOST: f64 = 1e290;

/// How often the environment is chosen where there are other lights. In a studio with a lamp and a sky, shares of 0.1,
/// 0.25, 0.5 and 0.7 gave relMSE of 1.4, 2.0, 3.9 and 7.7 thousandths.
const ENVIRONMENT_SHARE: f64 = 0.1;

impl Lights {
    /// Numbers the lights: the emission of each shape of a geometry, points, and the environment.
    pub(super) fn new(geometry: &Geometry, emission: Vec<Emission>, points: Vec<PointLight>, environment: Rgb) -> Self {
        let (mut first, mut surfaces, mut powers) = (Vec::new(), Vec::new(), Vec::new());
        for (shape, emission) in emission.iter().enumerate() {
            first.push(surfaces.len() as u32);
            if !emission.is_dark() {
                let radiance = emission.radiance.mean();
                for primitive in geometry.primitives_of(shape as u32) {
                    let area = geometry.area(primitive);
                    surfaces.push(primitive);
                    // What no ray can hit must not shine either, and from what has no end no point can be drawn: its light is found by
                    // rays that meet it.
                    powers.push(if area.is_finite() { (PI * area * strength(radiance)).min(MOST) } else { 0.0 });
                }
            }
        }
        powers.extend(points.iter().map(|p| (4.0 * PI * strength(p.intensity)).min(MOST)));
        if environment != Rgb::ZERO {
            // What an environment sends into a scene grows with the scene's extent, and falls mostly on floors far away:
            // chosen by its power, it would leave next to nothing for a lamp. It needs no more than a fixed share, since
            // scattering finds it well by itself.
            let others: f64 = powers.iter().sum();
            powers.push(if others > 0.0 { others * ENVIRONMENT_SHARE / (1.0 - ENVIRONMENT_SHARE) } else { 1.0 });
        }
        Self { choice: AliasTable::new(&powers), emission, first, surfaces, points, environment }
    }

    /// Whether nothing shines.
    pub fn is_dark(&self) -> bool {
        self.choice.is_none()
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.emission.as_slice())
            + size_of_val(self.first.as_slice())
            + size_of_val(self.surfaces.as_slice())
            + size_of_val(self.points.as_slice())
            + self.choice.as_ref().map_or(0, AliasTable::bytes)
    }

    /// How a shape shines.
    #[inline]
    pub fn emission(&self, shape: u32) -> &Emission {
        &self.emission[shape as usize]
    }

    /// Radiance that comes from outside along a direction.
    #[inline]
    pub fn environment(&self, _direction: DVec3) -> Rgb {
        self.environment
    }

    /// Draws light that reaches a point of a surface with this normal on its lit side. `None` if the draw gives none.
    #[inline]
    pub fn sample(
        &self,
        geometry: &Geometry,
        point: DVec3,
        normal: DVec3,
        choice: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let table = self.choice.as_ref()?;
        let chosen = table.sample(choice);
        let probability = table.probability(chosen);
        if let Some(&primitive) = self.surfaces.get(chosen) {
            let emission = self.emission(geometry.locate(primitive).0);
            let radiance = emission.radiance.at(&TexturePoint::default());
            match geometry.shape(primitive) {
                Some(shape) => sample_shape(geometry, (primitive, shape), radiance, point, probability, u),
                None => sample_triangle(geometry, primitive, radiance, point, probability, u),
            }
        } else if let Some(light) = self.points.get(chosen - self.surfaces.len()) {
            light.sample(point, probability)
        } else {
            let direction = Frame::new(normal).to_world(warp::cosine_hemisphere(u));
            let pdf = self.environment_pdf(normal, direction);
            // Rounding may turn a direction in the plane to below it.
            (pdf > 0.0).then(|| LightSample { direction, weight: self.environment / pdf, pdf, source: None })
        }
    }

    /// The density with which [`Lights::sample`] draws the direction of a ray, which is unit and meets an emitting primitive under the
    /// cosine of an angle to its normal. What shines in a copy of a group is never drawn: rays find it that meet it.
    #[inline]
    pub fn surface_pdf(&self, geometry: &Geometry, ray: &Ray, hit: &Hit, cosine: f64) -> f64 {
        let Some(table) = &self.choice else { return 0.0 };
        let (shape, number) = geometry.locate(hit.primitive);
        if geometry.copies_of(shape).is_some() {
            return 0.0;
        }
        let light = self.first[shape as usize] + number;
        let density = match geometry.shape(hit.primitive) {
            Some(shape) => shape.pdf_from(ray.origin, ray.direction),
            None => solid_angle_pdf(geometry, hit.primitive, hit.t, cosine),
        };
        table.probability(light as usize) * density
    }

    /// The density with which [`Lights::sample`], at a surface with this normal, draws a direction that leaves the
    /// scene. Constant light is best drawn by the cosine of its arrival.
    #[inline]
    pub fn environment_pdf(&self, normal: DVec3, direction: DVec3) -> f64 {
        match &self.choice {
            Some(table) if self.environment != Rgb::ZERO => {
                table.probability(table.len() - 1) * (normal.dot(direction).max(0.0) / PI)
            }
            _ => 0.0,
        }
    }
}

/// One number for an amount of light: the mean of its channels, so that no colour is chosen too seldom, as blue would
/// be by its luminance.
fn strength(rgb: Rgb) -> f64 {
    rgb.element_sum() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use crate::scene::fixtures::{rectangle, scene, shape};
    use crate::scene::{Mesh, Scene, SceneDescription, Shape};

    const DRAWS: u32 = 20_000;

    /// Mean and standard error of the irradiance at the origin on a plane with normal +z, nothing shadowing.
    fn irradiance(scene: &Scene) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for number in 0..DRAWS {
            let mut sampler = Sampler::new(1, 0, number);
            let (choice, u) = (sampler.one(0), sampler.two(1));
            if let Some(light) = scene.lights().sample(scene.geometry(), DVec3::ZERO, DVec3::Z, choice, u) {
                assert!((light.direction.length() - 1.0).abs() < 1e-12 && light.pdf > 0.0);
                let x = light.weight.y * light.direction.z.max(0.0);
                sum += x;
                squares += x * x;
            }
        }
        let mean = sum / f64::from(DRAWS);
        (mean, ((squares / f64::from(DRAWS) - mean * mean).max(0.0) / f64::from(DRAWS)).sqrt())
    }

    /// Within five standard errors, which chance exceeds once in two million, and to a percent.
    fn assert_irradiance(scene: &Scene, expected: f64) {
        let (mean, error) = irradiance(scene);
        assert!((mean - expected).abs() <= 5.0 * error + 1e-12 * expected, "{mean} ± {error}, not {expected}");
        assert!(error < 0.01 * expected);
    }

    fn lit_by(shapes: Vec<Shape>) -> Scene {
        scene(SceneDescription { shapes, ..Default::default() })
    }

    /// A square of side 2 that looks down from height 1, right above the point.
    fn overhead() -> Mesh {
        rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0])
    }

    /// The irradiance it gives at radiance 1: four times that of a corner (Lambert, 1760).
    const OVERHEAD: f64 = 1.740_839_502_734_206;

    #[test]
    fn rectangle_gives_lamberts_irradiance() {
        assert_irradiance(&lit_by(vec![shape(overhead(), [0.0; 3], 1.0)]), OVERHEAD);
        let up = rectangle([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        assert_eq!(irradiance(&lit_by(vec![shape(up, [0.0; 3], 1.0)])), (0.0, 0.0));
    }

    #[test]
    fn triangle_gives_lamberts_irradiance() {
        let mut mesh = rectangle([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        mesh.faces = vec![[0, 1, 3]];
        assert_irradiance(&lit_by(vec![shape(mesh, [0.0; 3], 1.0)]), 0.302_299_894_039_036_34);
    }

    #[test]
    fn point_gives_the_inverse_square() {
        let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
        let lit = scene(SceneDescription { points: vec![point], ..Default::default() });
        assert_irradiance(&lit, 0.353_553_390_593_273_73);
    }

    #[test]
    fn environment_gives_pi() {
        assert_irradiance(&scene(SceneDescription { environment: Rgb::ONE, ..Default::default() }), PI);
    }

    #[test]
    fn lights_add_up() {
        let dark = rectangle([5.0, 5.0, 1.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]);
        let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
        let all = SceneDescription {
            shapes: vec![
                shape(dark.clone(), [0.5; 3], 0.0),
                shape(overhead(), [0.0; 3], 1.0),
                shape(dark, [0.5; 3], 0.0),
            ],
            points: vec![point],
            environment: Rgb::splat(0.01),
        };
        assert_irradiance(&scene(all), OVERHEAD + 0.353_553_390_593_273_73 + 0.01 * PI);
    }

    #[test]
    fn a_draw_has_the_density_that_a_hit_is_told() {
        let shapes = vec![
            shape(overhead(), [0.0; 3], 1.0),
            shape(rectangle([3.0, 3.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), [0.5; 3], 0.0),
            shape(rectangle([-9.0, -9.0, 2.0], [0.0, 1.0, 0.0], [1.5, 0.0, 1.0]), [0.0; 3], 7.0),
        ];
        let lit = scene(SceneDescription { shapes, environment: Rgb::ONE, ..Default::default() });
        let (mut from_surfaces, mut from_outside) = (0, 0);
        for number in 0..1000 {
            let mut sampler = Sampler::new(2, 0, number);
            let (choice, u) = (sampler.one(0), sampler.two(1));
            let Some(light) = lit.lights().sample(lit.geometry(), DVec3::ZERO, DVec3::Z, choice, u) else {
                continue;
            };
            if light.source.is_none() {
                from_outside += 1;
                assert_eq!(light.pdf, lit.lights().environment_pdf(DVec3::Z, light.direction));
                continue;
            }
            from_surfaces += 1;
            let mut hits = [Hit::MISS];
            let ray = Ray::new(DVec3::ZERO, light.direction);
            lit.intersect(&[ray], &mut hits);
            let surface = lit.geometry().surface(&ray, &hits[0]);
            let cosine = -surface.normal.dot(light.direction);
            let pdf = lit.lights().surface_pdf(lit.geometry(), &ray, &hits[0], cosine);
            assert!((pdf / light.pdf - 1.0).abs() < 1e-9);
        }
        assert!(from_surfaces > 100 && from_outside > 50);
    }

    #[test]
    fn the_dark_stays_dark() {
        let lit = lit_by(vec![shape(rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.5; 3], 0.0)]);
        assert!(lit.lights().is_dark());
        assert!(lit.lights().sample(lit.geometry(), DVec3::Z, DVec3::Z, 0.5, [0.5; 2]).is_none());
    }

    #[test]
    fn what_cannot_be_hit_does_not_shine() {
        let mut mesh = overhead();
        let more = [DVec3::NAN, DVec3::splat(2.0)];
        mesh.vertices = (0..4).map(|i| mesh.vertices.get(i)).chain(more).map(|v| v.as_vec3()).collect();
        mesh.faces.extend([[0, 1, 4], [0, 5, 5], [0, 0, 1]]);
        assert_irradiance(&lit_by(vec![shape(mesh, [0.0; 3], 1.0)]), OVERHEAD);
    }

    #[test]
    fn extreme_lights_give_their_irradiance() {
        // A sheet of area 10⁻¹² and radiance 10¹² right above looks like a point of intensity 1.
        let tiny = rectangle([-5e-7, -5e-7, 1.0], [0.0, 1e-6, 0.0], [1e-6, 0.0, 0.0]);
        let (mean, _) = irradiance(&lit_by(vec![shape(tiny, [0.0; 3], 1e12)]));
        assert!((mean - 1.0).abs() < 1e-5, "{mean}");
        for strength in [1e-30, 1e30] {
            assert_irradiance(&lit_by(vec![shape(overhead(), [0.0; 3], strength)]), strength * OVERHEAD);
        }
        // Its power is beyond what a number holds.
        assert!(!lit_by(vec![shape(overhead(), [0.0; 3], 1e308); 3]).lights().is_dark());
    }
}
