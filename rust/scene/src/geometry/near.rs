//! The nearest point on shapes and instances.
//!
//! A box tree is traversed nearest first. Distances within an instance are measured in world space, with corners and
//! boxes mapped on the way. A non-uniform scaling changes the nearest point, so a search in the prototype's space would
//! be wrong.

use super::Geometry;
use raywright_accel::{BoxTree, Nearest, PrimitiveFilter, Primitives};
use raywright_base::math::{Affine, DVec3, Hit};
use raywright_shapes::gap_under;
use raywright_shapes::triangle::{length, nearest_point, point_of};

/// A nearest-point query.
#[derive(Clone, Copy)]
struct Quest {
    place: DVec3,
    /// Maximum distance.
    most: f64,
    found: Nearest,
}

impl Quest {
    /// The current search radius.
    fn left(&self) -> f64 {
        self.found.distance.min(self.most)
    }

    /// Accepts a point that is nearer than the best, or as near with a lower number.
    fn offer(&mut self, other: Nearest) {
        let key = |nearest: &Nearest| (nearest.distance, nearest.primitive, nearest.inner);
        if other.distance <= self.most && other.distance.is_finite() && key(&other) < key(&self.found) {
            self.found = other;
        }
    }
}

impl Geometry {
    /// Replaces the nearest points on meshes by points of other shapes and instances that are nearer, among those that
    /// `counts` accepts. Moving objects are placed as at shutter open.
    pub(crate) fn nearest_of_others(
        &self,
        points: &[DVec3],
        most: &[f64],
        counts: PrimitiveFilter<'_>,
        found: &mut [Nearest],
    ) {
        let Some(tree) = self.tree_of_others() else { return };
        for (i, (&place, found)) in points.iter().zip(found).enumerate() {
            // One for all points, or one per point.
            let most = most[if most.len() == 1 { 0 } else { i }];
            if place.is_finite() && most >= 0.0 {
                let mut quest = Quest { place, most, found: *found };
                self.look(tree, None, counts, &mut quest);
                *found = quest.found;
            }
        }
    }

    fn tree_of_others(&self) -> Option<&BoxTree> {
        let others = self.others.as_ref()?;
        let boxed = |number: u32| self.bounds(number).map(|bounds| (number, bounds));
        Some(self.near_others.get_or_init(|| BoxTree::new(others.all().filter_map(boxed))))
    }

    fn tree_of_all(&self) -> &BoxTree {
        let boxed = |number: u32| self.bounds(number).map(|bounds| (number, bounds));
        self.near_all.get_or_init(|| BoxTree::new((0..self.count() as u32).filter_map(boxed)))
    }

    /// Searches a tree of this geometry under a map.
    fn look(&self, tree: &BoxTree, map: Option<&Affine>, counts: PrimitiveFilter<'_>, quest: &mut Quest) {
        let place = quest.place;
        let gap = |bounds: &_| gap_under(map, bounds, place);
        tree.nearest(quest.left(), gap, |primitive, _| {
            let is_asked = counts.is_none_or(|counts| counts(primitive));
            if is_asked && let Some(found) = self.nearest_on(primitive, map, quest) {
                quest.offer(found);
            }
            quest.left()
        });
    }

    /// The nearest point of a primitive under a map, if it is within the search radius.
    fn nearest_on(&self, primitive: u32, map: Option<&Affine>, quest: &Quest) -> Option<Nearest> {
        let place = quest.place;
        if let Some((instances, number)) = self.instance(primitive) {
            let pose = instances.pose(number, 0.0)?.map();
            let map = match map {
                Some(map) => map.compose(&pose),
                None => pose,
            };
            let prototype = instances.prototype();
            let (inside, most) = (prototype.geometry(), quest.left());
            let mut within = Quest { place, most, found: Nearest::MISS };
            inside.look(inside.tree_of_all(), Some(&map), None, &mut within);
            let found = within.found;
            let (own, inner) = (found.primitive, found.inner);
            return found.is_hit().then(|| {
                let inner = prototype.flatten(&Hit { primitive: own, inner, ..Hit::MISS });
                Nearest { primitive, inner, ..found }
            });
        }
        if let Some(shape) = self.shape(primitive) {
            let closest = match map {
                Some(map) => shape.closest_under(map, &map.inverse().ok()?, place)?,
                None => shape.closest(place)?,
            };
            let (position, uv) = (closest.position, closest.uv);
            return Some(Nearest { distance: length(place - position), position, uv, primitive, inner: 0 });
        }
        let corners = self.corners(primitive);
        let corners = map.map_or(corners, |map| corners.map(|corner| map.point(corner)));
        let on = nearest_point(corners, place);
        Some(Nearest { distance: on.distance, position: point_of(corners, on.uv), uv: on.uv, primitive, inner: 0 })
    }

    /// Unit normal at a point of a primitive, and a bound on the error of each coordinate. For an instance the
    /// primitive is given by its flattened number, placed as at shutter open.
    pub fn site(&self, primitive: u32, inner: u32, position: DVec3, uv: [f64; 2]) -> (DVec3, f64) {
        if let Some((instances, number)) = self.instance(primitive) {
            let none = (DVec3::NAN, f64::NAN);
            let Some(map) = instances.pose(number, 0.0).map(|pose| pose.map()) else { return none };
            let Ok(inverse) = map.inverse() else { return none };
            let prototype = instances.prototype();
            let (own, within) = prototype.split(inner);
            let (normal, error) = prototype.geometry().site(own, within, inverse.point(position), uv);
            // The point was rounded in world space.
            let rounded = 8.0 * f64::EPSILON * position.abs().max_element();
            return (map.normal(normal).normalize(), map.spread(error) + rounded);
        }
        match self.shape(primitive) {
            Some(shape) => {
                let point = shape.point(&raywright_base::math::Ray::new(position, DVec3::X), 0.0, uv);
                // Finding the nearest point takes a few more roundings than evaluating a point at given coordinates.
                (point.normal, 4.0 * point.error)
            }
            None => (self.normal(primitive), self.error(primitive)),
        }
    }
}
