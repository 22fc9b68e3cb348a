//! Which front a ray meets, also where two faces lie back to back, or touch front to front.

use super::coincident::{Overlap, coincident};
use super::facet::Facet;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind, warp};
use raywright_scene::{RayOrigin, Scene};
use std::collections::BTreeMap;

/// A face in the plane of another that looks the other way.
#[derive(Clone, Debug)]
struct Opposite {
    face: u32,
    facet: Facet,
    /// Whether both touch front to front; else they lie back to back, as both sides of a sheet do.
    touches: bool,
}

/// Faces that lie in the planes of others and look the other way.
///
/// Rays meet both sides of a sheet at once, and which of them is told depends on roundings; that which looks at the ray
/// counts. All that leaves a face where another touches it comes to that.
#[derive(Clone, Debug, Default)]
pub struct Fronts {
    opposite: BTreeMap<u32, Vec<Opposite>>,
}

impl Fronts {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        let pairs: Vec<Overlap> = coincident(scene).into_iter().filter(|overlap| !overlap.is_same).collect();
        let mut opposite = BTreeMap::<u32, Vec<Opposite>>::new();
        let facet = |face| Facet::new(scene.geometry().corners(face));
        for [i, j] in pairs.iter().flat_map(|pair| [pair.faces, [pair.faces[1], pair.faces[0]]]) {
            opposite.entry(i).or_default().push(Opposite { face: j, facet: facet(j), touches: false });
        }
        let mut found = Self { opposite };
        let touches = parallel::map(pairs.len(), |i| found.is_touching(scene, &pairs[i]));
        for (pair, _) in pairs.iter().zip(touches).filter(|(_, touches)| *touches) {
            for [i, j] in [pair.faces, [pair.faces[1], pair.faces[0]]] {
                let all = found.opposite.get_mut(&i).into_iter().flatten();
                all.filter(|opposite| opposite.face == j).for_each(|opposite| opposite.touches = true);
            }
        }
        found
    }

    /// Whether two faces touch front to front.
    ///
    /// Where they do, at least one is of a solid, and the front of the other looks into that: most rays from there meet
    /// backs. Those that meet a sheet, or faces that touch, tell nothing.
    fn is_touching(&self, scene: &Scene, pair: &Overlap) -> bool {
        /// Rays from each of both.
        const RAYS: u32 = 32;
        let geometry = scene.geometry();
        let kind = SamplerKind::Sobol(BatchSize::for_budget(Some(4 * RAYS)));
        let looks_into = |face: u32| {
            let normal = Facet::new(geometry.corners(face)).normal;
            let origin = RayOrigin::off(pair.middle, geometry.error(face), normal);
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
        pair.faces.iter().any(|&face| looks_into(face))
    }

    /// Whether no face has another in its plane that looks the other way.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.opposite.is_empty()
    }

    /// Whether a face touches another front to front.
    pub fn is_touched(&self, face: u32) -> bool {
        self.opposite.get(&face).is_some_and(|all| all.iter().any(|found| found.touches))
    }

    /// Whether another face touches this one at a place, so that nothing else is seen from there.
    #[inline]
    pub fn is_touched_at(&self, face: u32, place: DVec3) -> bool {
        self.at(face, place).is_some_and(|found| found.touches)
    }

    /// Whether two faces touch front to front.
    pub fn touch(&self, [one, other]: [u32; 2]) -> bool {
        self.opposite.get(&one).is_some_and(|all| all.iter().any(|found| found.face == other && found.touches))
    }

    /// The face to whose front a ray from a place on a face comes, and the weights of its second and third corner
    /// there; `None` if it meets a back alone, or nothing.
    #[inline]
    pub fn met(&self, scene: &Scene, (from, place): (u32, DVec3), ray: &Ray, hit: &Hit) -> Option<(u32, [f64; 2])> {
        if let Some(found) = self.at(from, place).filter(|found| found.touches) {
            return Some((found.face, found.facet.weights(place)));
        }
        if !hit.is_hit() {
            return None;
        }
        let surface = scene.geometry().surface(ray, hit);
        if surface.is_front(ray) {
            return Some((hit.primitive, hit.uv));
        }
        let found = self.at(hit.primitive, surface.position).filter(|found| !found.touches)?;
        Some((found.face, found.facet.weights(surface.position)))
    }

    /// The face that lies at a place of another and looks the other way.
    #[inline]
    fn at(&self, face: u32, place: DVec3) -> Option<&Opposite> {
        if self.opposite.is_empty() {
            return None;
        }
        self.opposite.get(&face)?.iter().find(|found| found.facet.covers(place))
    }
}
