//! Decides exactly which of a ray's candidates is the first hit, as every accelerator does.
//!
//! The result of an f32 kernel for a ray is a superset of its possible first hits, or an overflow mark. Each candidate
//! is tested as in any leaf. For a candidate that is certain, only its `t` is computed, for sixteen rays at a time.

use super::arrays::Flat;
use crate::query::{ClosestQuery, Query};
use crate::{Accelerator, Primitives, UserGeometry, Wanted};
use raywright_base::math::{DVec3, Hit, Ray, Region};
use raywright_base::simd::{Level, loops};
use raywright_shapes::Candidate;
use raywright_shapes::triangle::{Column, EdgeRay, EdgeRays, Met, RAYS};
use std::sync::Arc;

/// Maximum number of candidates per ray.
pub const CANDIDATES: usize = 4;

/// Marks an unused candidate slot.
pub const NO_CANDIDATE: u32 = u32::MAX;

/// In the first slot: too many candidates.
pub const OVERFLOW: u32 = u32::MAX - 1;

/// In the second slot: the first candidate is a triangle and certainly the first hit. In occlusion results: something
/// is certainly hit.
pub const CERTAIN: u32 = u32::MAX - 2;

/// The data for exact decisions.
pub struct Settler<'a> {
    primitives: &'a dyn Primitives,
    objects: Option<Arc<dyn UserGeometry>>,
    /// The region of the triangles.
    region: &'a Region,
    /// Unbounded primitives, which every ray may hit besides its candidates.
    unbounded: &'a [u32],
    level: Level,
    /// The fallback for rays with too many candidates.
    accelerator: &'a dyn Accelerator,
}

/// Statistics: rays decided among candidates, and rays traced by the accelerator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settled {
    /// Rays decided among candidates.
    pub decided: usize,
    /// Rays traced by the accelerator.
    pub walked: usize,
}

/// Up to sixteen rays, each known to hit a triangle.
struct SettledBatch {
    places: [usize; RAYS],
    triangles: [u32; RAYS],
    edges: EdgeRays,
    /// The triangles' corners, by corner and axis.
    corners: [[Column<f64>; 3]; 3],
    len: usize,
}

impl<'a> Settler<'a> {
    /// Decide for primitives in flat arrays, with an accelerator over the same primitives.
    pub fn new(primitives: &'a dyn Primitives, flat: &'a Flat, accelerator: &'a dyn Accelerator, level: Level) -> Self {
        let (region, unbounded) = (&flat.of_triangles, flat.unbounded.as_slice());
        Self { primitives, objects: primitives.objects(), region, unbounded, level, accelerator }
    }

    /// Find the closest hit of each ray among its candidates.
    pub fn closest(&self, rays: &[Ray], candidates: &[[u32; CANDIDATES]], hits: &mut [Hit]) -> Settled {
        assert!(rays.len() == candidates.len() && rays.len() == hits.len(), "candidates and a hit for each ray");
        let mut settled = Settled::default();
        let mut sixteen = SettledBatch::new();
        let (mut walked, mut places) = (Vec::new(), Vec::new());
        for (i, (ray, mine)) in rays.iter().zip(candidates).enumerate() {
            match *mine {
                [NO_CANDIDATE, ..] if self.unbounded.is_empty() => hits[i] = Hit::MISS,
                [OVERFLOW, ..] => {
                    walked.push(*ray);
                    places.push(i);
                }
                [only, CERTAIN, ..] if self.unbounded.is_empty() => {
                    sixteen.put(i, ray, only, self.primitives.corners(only));
                    if sixteen.len == RAYS {
                        self.settle(&mut sixteen, rays, hits);
                    }
                }
                _ => {
                    settled.decided += 1;
                    hits[i] = self.first(ray, mine);
                }
            }
        }
        self.settle(&mut sixteen, rays, hits);
        if !walked.is_empty() {
            settled.walked = walked.len();
            let mut found = vec![Hit::MISS; walked.len()];
            self.accelerator.intersect(&walked, &mut found);
            for (&i, hit) in places.iter().zip(found) {
                hits[i] = hit;
            }
        }
        settled
    }

    /// Test whether each ray hits anything, given the kernel's result: a mark, or the only candidate.
    pub fn occluded(&self, rays: &[Ray], told: &[u32], occluded: &mut [bool]) -> Settled {
        assert!(rays.len() == told.len() && rays.len() == occluded.len(), "what is told and an answer for each ray");
        let mut settled = Settled::default();
        let (mut walked, mut places) = (Vec::new(), Vec::new());
        for (i, (ray, &told)) in rays.iter().zip(told).enumerate() {
            occluded[i] = match told {
                CERTAIN => true,
                NO_CANDIDATE | OVERFLOW => false,
                only if self.unbounded.is_empty() => {
                    settled.decided += 1;
                    self.meets(ray, only)
                }
                _ => false,
            };
            // Unbounded primitives may be hit where nothing else is.
            if told == OVERFLOW || (!occluded[i] && !self.unbounded.is_empty()) {
                walked.push(*ray);
                places.push(i);
            }
        }
        if !walked.is_empty() {
            settled.walked = walked.len();
            let mut found = vec![false; walked.len()];
            self.accelerator.occluded(&walked, &mut found);
            for (&i, found) in places.iter().zip(found) {
                occluded[i] = found;
            }
        }
        settled
    }

    /// Return whether a ray hits a primitive.
    fn meets(&self, ray: &Ray, primitive: u32) -> bool {
        let Some(edges) = EdgeRay::new(ray, self.region) else { return false };
        let corners = self.primitives.corners(primitive);
        if corners.iter().all(|c| c.is_finite()) {
            return edges.meet(corners).is_some();
        }
        let asked = Ray { t_min: edges.t_min, t_max: edges.t_max, time: ray.time, ..along(&edges) };
        let is_hit = |met: Candidate| (met.t * edges.scale).is_finite();
        self.objects.as_ref().is_some_and(|objects| objects.meet(primitive, Wanted::Any, &asked, &mut { is_hit }))
    }

    /// The first hit among candidates.
    fn first(&self, ray: &Ray, candidates: &[u32]) -> Hit {
        let mut hit = [Hit::MISS];
        let mut query = ClosestQuery(&mut hit);
        let answer = EdgeRay::new(ray, self.region).map(|edges| {
            let mut state = query.start(0, edges.t_max);
            for &primitive in candidates.iter().take_while(|&&p| p < CERTAIN).chain(self.unbounded) {
                let corners = self.primitives.corners(primitive);
                if corners.iter().all(|c| c.is_finite()) {
                    if let Some(candidate) = edges.meet(corners) {
                        query.offer(&mut state, primitive, candidate);
                    }
                } else if let Some(objects) = &self.objects {
                    let t_max = edges.t_max.min(ClosestQuery::limit(&state));
                    let asked = Ray { t_min: edges.t_min, t_max, time: ray.time, ..along(&edges) };
                    objects.meet(primitive, Wanted::Closest, &asked, &mut |met| {
                        (met.t * edges.scale).is_finite() && query.offer(&mut state, primitive, met)
                    });
                }
            }
            (edges.along(), state)
        });
        query.finish(0, answer);
        hit[0]
    }

    /// Compute the hits of the collected rays, and empty the collection.
    fn settle(&self, sixteen: &mut SettledBatch, rays: &[Ray], hits: &mut [Hit]) {
        let count = std::mem::take(&mut sixteen.len);
        if count == 0 {
            return;
        }
        let here = !(u32::MAX << count);
        let mut all = Met::NONE;
        won(self.level, &mut sixteen.edges, &sixteen.corners, self.region, here, &mut all);
        for i in 0..count {
            let (place, primitive) = (sixteen.places[i], sixteen.triangles[i]);
            hits[place] = if all.met >> i & 1 == 1 {
                Hit { t: all.t[i], uv: [all.uv[0][i], all.uv[1][i]], primitive, inner: 0 }
            } else {
                self.first(&rays[place], &[primitive])
            };
        }
    }
}

loops! {
    /// The intersections of sixteen rays with triangles they are known to hit.
    fn won(edges: &mut EdgeRays, corners: &[[Column<f64>; 3]; 3], region: &Region, here: u32, all: &mut Met) {
        let plain = edges.prepare(region) & here;
        *all = edges.won(false, corners, plain);
    }
}

/// The ray along its scaled direction.
fn along(edges: &EdgeRay) -> Ray {
    Ray::new(edges.origin, edges.direction)
}

impl SettledBatch {
    fn new() -> Self {
        Self {
            places: [0; RAYS],
            triangles: [0; RAYS],
            edges: EdgeRays::default(),
            corners: [[[0.0; RAYS]; 3]; 3],
            len: 0,
        }
    }

    fn put(&mut self, place: usize, ray: &Ray, triangle: u32, corners: [DVec3; 3]) {
        let at = self.len;
        (self.places[at], self.triangles[at]) = (place, triangle);
        self.edges.put(at, ray);
        for (to, corner) in self.corners.iter_mut().zip(corners) {
            for (axis, to) in to.iter_mut().enumerate() {
                to[at] = corner[axis];
            }
        }
        self.len = at + 1;
    }
}
