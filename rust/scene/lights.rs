//! All lights of a scene, and the choice among them.

use super::light::{sample_triangle, solid_angle_pdf};
use super::{Geometry, LightSample, PointLight};
use crate::accel::Primitives;
use crate::math::{Aabb, DVec3};
use crate::optics::Rgb;
use crate::sampling::{AliasTable, warp};
use std::f64::consts::PI;

/// The lights of a scene: emitting triangles, points, and what comes from outside.
///
/// One is chosen by its power, and the density of any direction that meets a light is known in constant time: emitting
/// triangles are numbered shape after shape, then come the points, and last the environment.
#[derive(Debug)]
pub struct Lights {
    /// Radiance of each shape.
    emission: Vec<Rgb>,
    /// For each shape, the number of its first triangle among lights; it means nothing for one that is dark.
    first: Vec<u32>,
    /// The primitive of each emitting triangle.
    triangles: Vec<u32>,
    points: Vec<PointLight>,
    environment: Rgb,
    /// `None` in a scene without light.
    choice: Option<AliasTable>,
}

impl Lights {
    /// Numbers the lights: the emission of each shape of a geometry with these bounds, points, and the environment.
    pub(super) fn new(
        geometry: &Geometry,
        bounds: &Aabb,
        emission: Vec<Rgb>,
        points: Vec<PointLight>,
        environment: Rgb,
    ) -> Self {
        let (mut first, mut triangles, mut powers) = (Vec::new(), Vec::new(), Vec::new());
        for (shape, &radiance) in emission.iter().enumerate() {
            first.push(triangles.len() as u32);
            if radiance != Rgb::ZERO {
                for primitive in geometry.primitives_of(shape as u32) {
                    let area = 0.5 * geometry.area_vector(primitive).length();
                    triangles.push(primitive);
                    // What no ray can hit must not shine either.
                    powers.push(if geometry.aabb(primitive).is_empty() { 0.0 } else { PI * area * strength(radiance) });
                }
            }
        }
        powers.extend(points.iter().map(|p| 4.0 * PI * strength(p.intensity)));
        if environment != Rgb::ZERO {
            // What falls on the sphere around the scene. Without a surface it lights nothing, and any number will do.
            let radius =
                if bounds.is_empty() { 1.0 } else { 0.5 * (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length() };
            let power = 4.0 * PI * PI * radius * radius * strength(environment);
            powers.push(power.clamp(f64::MIN_POSITIVE, f64::MAX));
        }
        Self { choice: AliasTable::new(&powers), emission, first, triangles, points, environment }
    }

    /// Whether nothing shines.
    pub fn is_dark(&self) -> bool {
        self.choice.is_none()
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.emission.as_slice())
            + size_of_val(self.first.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.points.as_slice())
            + self.choice.as_ref().map_or(0, AliasTable::bytes)
    }

    /// Radiance of a shape on the side that its normals point to.
    #[inline]
    pub fn emission(&self, shape: u32) -> Rgb {
        self.emission[shape as usize]
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
        if let Some(&primitive) = self.triangles.get(chosen) {
            let radiance = self.emission(geometry.locate(primitive).0);
            sample_triangle(geometry, primitive, radiance, point, probability, u)
        } else if let Some(light) = self.points.get(chosen - self.triangles.len()) {
            light.sample(point, probability)
        } else {
            let direction = crate::math::Frame::new(normal).to_world(warp::cosine_hemisphere(u));
            let pdf = self.environment_pdf(normal, direction);
            // Rounding may turn a direction in the plane to below it.
            (pdf > 0.0).then(|| LightSample { direction, weight: self.environment / pdf, pdf, source: None })
        }
    }

    /// The density with which [`Lights::sample`] draws a direction that meets an emitting primitive of a shape, at a
    /// distance and under the cosine of an angle to its normal.
    #[inline]
    pub fn surface_pdf(&self, geometry: &Geometry, shape: u32, primitive: u32, distance: f64, cosine: f64) -> f64 {
        let Some(table) = &self.choice else { return 0.0 };
        let light = self.first[shape as usize] + (primitive - geometry.primitives_of(shape).start);
        table.probability(light as usize) * solid_angle_pdf(geometry, primitive, distance, cosine)
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
