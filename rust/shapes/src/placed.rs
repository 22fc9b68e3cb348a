//! Any shape, moved by an affine map.

use super::{Bounds, Candidate, Carried, Closest, Drawn, Flat, Point, Shape};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Ray, Singular};
use std::sync::Arc;

/// A shape under an affine map: itself a shape, in the space that the map leads to.
///
/// A ray is taken back to the shape's own space, with its direction as long as it comes out, so that `t` is the same in
/// both. Shapes that decide without error do so for the ray and the matrix as they are given ([`Carried`]); others get
/// the ray rounded once.
#[derive(Clone, Debug)]
pub struct Placed {
    shape: Arc<dyn Shape>,
    to_world: Affine,
    to_object: Affine,
}

impl Placed {
    /// A shape under a map.
    ///
    /// # Errors
    ///
    /// If the map has no inverse.
    pub fn new(shape: Arc<dyn Shape>, to_world: Affine) -> Result<Self, Singular> {
        let to_object = to_world.inverse()?;
        Ok(Self { shape, to_world, to_object })
    }

    /// A point of the shape, in the world.
    ///
    /// The map is computed with twice the digits and rounded once; the error that the point had goes along.
    fn carried(&self, point: Point) -> Point {
        let map = &self.to_world;
        let position = map.point(point.position);
        let error = UNIT * position.abs().max_element() + map.spread(point.error);
        // Normals go with the inverse's transpose, scaled so that no square overflows or vanishes.
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

    /// How much solid angle of the shape's space there is to one of the world's: |det L⁻¹| / |L⁻¹ d|³ about a unit
    /// vector d.
    fn crowding(&self, direction: DVec3) -> f64 {
        let own = self.to_object.vector(direction.normalize());
        self.to_object.determinant().abs() / own.length().powi(3)
    }
}

impl Shape for Placed {
    fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    /// That of the shape along the direction taken back, which is exact but for roundings of the few products in it:
    /// where the shape's own is tight, so is this.
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
        // Of a direction along an axis, as the box asks, the products and sums are exact.
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

    /// Drawn as the shape draws it, and so even only where the map stretches all of it alike.
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
