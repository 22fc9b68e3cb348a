//! The front that a ray hits, also where two faces are back to back or touch front to front.

use super::flat_faces::{FlatPart, SharedPlane, shared_planes};
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind, warp};
use raywright_scene::{RayOrigin, Scene};
use std::collections::BTreeMap;

/// A face with a flat part that is coplanar with another face's and opposite in orientation.
#[derive(Clone, Debug)]
struct Opposite {
    face: u32,
    part: FlatPart,
    /// Maximum distance from the part's plane of points on the other face; infinite for a triangle, all of which is in
    /// the plane.
    room: f64,
    /// True if both touch front to front, rather than lying back to back as the two sides of a sheet.
    touches: bool,
}

/// Pairs of coplanar overlapping faces of opposite orientation.
///
/// Rays hit both sides of a sheet at once, and rounding decides which is reported; the side that faces the ray counts.
/// All light from a face goes to the face that touches it there.
#[derive(Clone, Debug, Default)]
pub struct Fronts {
    opposite: BTreeMap<u32, Vec<Opposite>>,
}

impl Opposite {
    /// Return whether it covers a point of the other face.
    #[inline]
    fn holds(&self, place: DVec3) -> bool {
        self.part.covers(place) && (self.room == f64::INFINITY || self.part.height(place).abs() <= self.room)
    }
}

impl Fronts {
    /// Find the pairs in a scene.
    pub fn new(scene: &Scene) -> Self {
        Self::among(scene, &shared_planes(scene))
    }

    /// Find the pairs among all coplanar overlapping faces.
    pub fn among(scene: &Scene, shared: &[SharedPlane]) -> Self {
        let pairs: Vec<&SharedPlane> = shared.iter().filter(|shared| !shared.is_same).collect();
        let mut opposite = BTreeMap::<u32, Vec<Opposite>>::new();
        for SharedPlane { faces, parts, room, .. } in &pairs {
            for (one, other) in [(0, 1), (1, 0)] {
                let room = if scene.geometry().shape(faces[one]).is_some() { *room } else { f64::INFINITY };
                let found = Opposite { face: faces[other], part: parts[other], room, touches: false };
                opposite.entry(faces[one]).or_default().push(found);
            }
        }
        let mut found = Self { opposite };
        let touches = parallel::map(pairs.len(), |i| found.is_touching(scene, pairs[i]));
        for (pair, _) in pairs.iter().zip(touches).filter(|(_, touches)| *touches) {
            for [i, j] in [pair.faces, [pair.faces[1], pair.faces[0]]] {
                let all = found.opposite.get_mut(&i).into_iter().flatten();
                all.filter(|opposite| opposite.face == j).for_each(|opposite| opposite.touches = true);
            }
        }
        found
    }

    /// Find only pairs that touch front to front.
    pub fn of_touching(scene: &Scene) -> Self {
        let mut found = Self::new(scene);
        found.opposite.retain(|_, all| {
            all.retain(|opposite| opposite.touches);
            !all.is_empty()
        });
        found
    }

    /// Return whether two faces touch front to front.
    ///
    /// If so, at least one belongs to a solid, and the front of the other faces its inside, so most rays from there hit
    /// backs. Rays that hit a sheet or touching faces are inconclusive. Closed shapes are solids whose flat parts face
    /// outward.
    fn is_touching(&self, scene: &Scene, pair: &SharedPlane) -> bool {
        /// Rays per face.
        const RAYS: u32 = 32;
        let geometry = scene.geometry();
        if pair.faces.iter().any(|&face| geometry.shape(face).is_some_and(|shape| shape.is_closed())) {
            return true;
        }
        let kind = SamplerKind::Sobol(BatchSize::for_budget(Some(4 * RAYS)));
        let looks_into = |(face, part): (u32, &FlatPart)| {
            let normal = part.normal();
            let error = if geometry.shape(face).is_some() { pair.room } else { geometry.error(face) };
            let origin = RayOrigin::off(pair.middle, error, normal);
            let way = |number| warp::cosine_hemisphere(kind.sampler(0, face, number).two(1));
            let ray = |number| Ray { misses: pair.faces, ..origin.ray(Frame::new(normal).to_world(way(number))) };
            let rays: Vec<Ray> = (0..RAYS).map(ray).collect();
            let mut hits = vec![Hit::MISS; rays.len()];
            scene.intersect(&rays, &mut hits);
            let (mut backs, mut fronts) = (0, 0);
            for (ray, hit) in rays.iter().zip(&hits) {
                if !hit.is_hit() {
                    fronts += 1;
                } else if !self.opposite.contains_key(&hit.primitive) {
                    let is_front = geometry.surface(ray, hit).is_front(ray);
                    *(if is_front { &mut fronts } else { &mut backs }) += 1;
                }
            }
            backs > fronts
        };
        pair.faces.into_iter().zip(&pair.parts).any(looks_into)
    }

    /// Return whether there are no such pairs.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.opposite.is_empty()
    }

    /// Return whether a face touches another front to front.
    pub fn is_touched(&self, face: u32) -> bool {
        self.opposite.get(&face).is_some_and(|all| all.iter().any(|found| found.touches))
    }

    /// The face that touches this one at a point and so hides everything else, with the barycentric weights of its
    /// second and third corner.
    #[inline]
    pub fn touching(&self, face: u32, place: DVec3) -> Option<(u32, [f64; 2])> {
        let found = self.at(face, place).filter(|found| found.touches)?;
        Some((found.face, found.part.weights(place)))
    }

    /// Return whether two faces touch front to front.
    pub fn touch(&self, [one, other]: [u32; 2]) -> bool {
        self.opposite.get(&one).is_some_and(|all| all.iter().any(|found| found.face == other && found.touches))
    }

    /// The face whose front a ray from a point on a face reaches, with the barycentric weights of its second and third
    /// corner. `None` if it hits only a back, or nothing.
    #[inline]
    pub fn met(&self, scene: &Scene, (from, place): (u32, DVec3), ray: &Ray, hit: &Hit) -> Option<(u32, [f64; 2])> {
        if let Some(found) = self.touching(from, place) {
            return Some(found);
        }
        if !hit.is_hit() {
            return None;
        }
        let surface = scene.geometry().surface(ray, hit);
        if surface.is_front(ray) {
            return (!self.lies_under(hit.primitive, surface.position)).then_some((hit.primitive, hit.uv));
        }
        let found = self.at(hit.primitive, surface.position).filter(|found| !found.touches)?;
        Some((found.face, found.part.weights(surface.position)))
    }

    /// Return whether a ray that hits the front of a face has passed through the back of another face touching it
    /// there. Points near the borders of solids are excluded: there, rounding may make rays from outside appear to.
    #[inline]
    fn lies_under(&self, face: u32, place: DVec3) -> bool {
        /// As a fraction of the other's size.
        const BORDER: f64 = 1e-6;
        self.at(face, place).is_some_and(|found| found.touches && found.part.covers_by(place, BORDER))
    }

    /// The opposite face at a point of a face.
    #[inline]
    fn at(&self, face: u32, place: DVec3) -> Option<&Opposite> {
        if self.opposite.is_empty() {
            return None;
        }
        self.opposite.get(&face)?.iter().find(|found| found.holds(place))
    }
}
