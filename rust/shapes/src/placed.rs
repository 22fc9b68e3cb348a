//! A shape transformed by an affine map.

use super::{Bounds, Candidate, Carried, Closest, Drawn, Flat, Point, Shape};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Ray, Singular};
use std::sync::Arc;

/// A shape under an affine map, itself a shape in the map's target space.
///
/// Rays are transformed to object space without normalizing the direction, so `t` is the same in both spaces. Shapes
/// with exact predicates decide for the given ray and matrix ([`Carried`]); others intersect the ray rounded once.
#[derive(Clone, Debug)]
pub struct Placed {
    shape: Arc<dyn Shape>,
    to_world: Affine,
    to_object: Affine,
}

impl Placed {
    /// Place a shape under a map.
    ///
    /// # Errors
    ///
    /// If the map has no inverse.
    pub fn new(shape: Arc<dyn Shape>, to_world: Affine) -> Result<Self, Singular> {
        let to_object = to_world.inverse()?;
        Ok(Self { shape, to_world, to_object })
    }

    /// Map a point to the target space.
    ///
    /// The map is evaluated in double-double arithmetic and rounded once; the point's own error is propagated.
    fn carried(&self, point: Point) -> Point {
        let map = &self.to_world;
        let position = map.point(point.position);
        let error = UNIT * position.abs().max_element() + map.spread(point.error);
        // Normals transform by the inverse transpose, scaled so that no square overflows or underflows.
        let image = self.to_object.transposed(point.normal);
        let scale = image.abs().max_element();
        let length = (image / scale).length();
        let normal = image / scale / length;
        let dn = point.dn.map(|d| {
            let turned = self.to_object.transposed(d) / scale / length;
            turned - normal * normal.dot(turned)
        });
        Point { position, error, normal, uv: point.uv, dp: point.dp.map(|d| map.vector(d)), dn }
    }

    /// Object-space solid angle per target-space solid angle: |det L⁻¹| / |L⁻¹ d|³ for a unit vector d.
    fn crowding(&self, direction: DVec3) -> f64 {
        let own = self.to_object.vector(direction.normalize());
        self.to_object.determinant().abs() / own.length().powi(3)
    }
}

impl Shape for Placed {
    fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    /// The shape's support along the inversely transformed direction. This is exact up to the roundings of a few
    /// products, so it is as tight as the shape's own.
    fn support(&self, d: DVec3) -> f64 {
        let own = self.to_world.transposed(d);
        let reach = self.shape.support(own);
        if !reach.is_finite() {
            return reach;
        }
        let bounds = self.shape.bounds();
        let extent = bounds.min.abs().max(bounds.max.abs());
        let sizes = self.to_world.rows.map(|row| row.abs());
        let rounded = sizes[0] * d.x.abs() + sizes[1] * d.y.abs() + sizes[2] * d.z.abs();
        // For axis-parallel directions, which bounding boxes use, products and sums are exact.
        let plain = [d.x, d.y, d.z].iter().filter(|x| **x != 0.0).count() <= 1 && d.abs().max_element() == 1.0;
        let slack = if plain { 0.0 } else { 4.0 * UNIT * (rounded * extent).element_sum() };
        let shift = self.to_world.shift;
        let sum = shift.dot(d) + reach + slack;
        sum + 4.0 * UNIT * ((shift.abs() * d.abs()).element_sum() + reach.abs())
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet_carried(&Carried::Ray(ray), met)
    }

    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        ray.is_line() && self.shape.meet_carried(&Carried::Into(ray, &self.to_world), met)
    }

    fn point(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Point {
        let own = Carried::Into(&Carried::Ray(ray), &self.to_world).rounded();
        self.carried(self.shape.point(&own, t, uv))
    }

    fn area(&self) -> f64 {
        self.shape.area_under(&self.to_world)
    }

    fn area_under(&self, map: &Affine) -> f64 {
        self.shape.area_under(&map.compose(&self.to_world))
    }

    fn facing(&self) -> Option<DVec3> {
        self.to_world.normal(self.shape.facing()?).try_normalize()
    }

    fn flats(&self) -> Vec<Flat> {
        self.shape.flats().iter().map(|flat| flat.mapped(&self.to_world)).collect()
    }

    fn is_closed(&self) -> bool {
        self.shape.is_closed()
    }

    /// Mapped samples of the shape; uniform only if the map stretches all areas equally.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let Drawn { point, pdf } = self.shape.sample(u)?;
        let stretch = self.to_world.cofactors(point.normal).length();
        Some(Drawn { point: self.carried(point), pdf: pdf / stretch })
    }

    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let Drawn { point, pdf } = self.shape.sample_from(self.to_object.point(place), u)?;
        let point = self.carried(point);
        let pdf = pdf * self.crowding(point.position - place);
        Some(Drawn { point, pdf })
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        self.shape.closest_under(&self.to_world, &self.to_object, place)
    }

    fn closest_under(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        self.shape.closest_under(&to_world.compose(&self.to_world), &self.to_object.compose(to_object), place)
    }

    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let own = self.shape.pdf_from(self.to_object.point(place), self.to_object.vector(direction));
        if own > 0.0 { own * self.crowding(direction) } else { 0.0 }
    }
}
