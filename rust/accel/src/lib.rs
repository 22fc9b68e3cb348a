//! Floor 2: acceleration structures, and their queries for hits, nearest points and cones.

// Types in the signatures of this crate.
pub use raywright_base::{math, simd};
pub use raywright_shapes as shapes;

// Shared test files refer to the crate by the name its users use.
#[cfg(test)]
extern crate self as raywright_accel;

mod box_tree;
mod boxes;
mod brute;
pub mod bsp;
pub mod bvh;
mod crossings;
#[cfg(test)]
mod fans;
mod few_shapes;
mod filtered_query;
pub mod flat;
pub mod grid;
pub mod kdtree;
mod mixed;
mod nearest;
pub mod octree;
mod parity;
mod query;
mod rare_query;
mod slab;
mod tangent_balls;
mod touches;
pub mod trees;
mod user_geometry;
pub mod walk;
mod walked;

pub use box_tree::BoxTree;
pub use boxes::{Boxes, NodeBox};
pub use brute::BruteForce;
pub use crossings::Crossings;
pub use few_shapes::FewShapes;
pub use filtered_query::Counts;
pub use nearest::{Nearest, PrimitiveFilter};
pub use parity::{Exit, Exits, Side};
pub use slab::SlabRay;
pub use tangent_balls::TangentBalls;
pub use touches::{Touch, Touches};
pub use user_geometry::{Placed, UserGeometry};
pub use walked::walked;

pub use query::{Every, Meeting, Wanted};

use filtered_query::Kept;
use parity::WaysOut;
use query::{Answers, CostQuery};
use rare_query::RareQuery;
use raywright_base::math::{DVec3, Hit, HitColumns, PlacedHits, Ray, RayColumns, Region};
use raywright_base::parallel::{self, CHUNK};
use raywright_base::work::Work;
use raywright_shapes::triangle::SolidCone;
use raywright_shapes::{Bounds, Candidate};
use std::ops::Range;
use std::sync::Arc;

/// The input of an accelerator: triangles given by number and corners, and objects given by number alone.
///
/// Accelerators do not depend on the scene; the owner of the primitives implements this trait.
pub trait Primitives: Sync {
    /// The number of primitives, which are numbered from 0.
    fn count(&self) -> usize;

    /// The corners of a triangle; NaN for other primitives.
    fn corners(&self, primitive: u32) -> [DVec3; 3];

    /// Return whether every coordinate of a triangle is an f32, so that leaves can store f32.
    fn is_single(&self) -> bool;

    /// The primitives that are not triangles, if any.
    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        None
    }

    /// The observer of the build, which may cancel it; by default there is none.
    ///
    /// A canceled accelerator is empty and has to be dropped.
    fn work(&self) -> Work<'_> {
        Work::UNWATCHED
    }

    /// Return whether it is a triangle that can be hit: all corners are finite.
    fn is_finite(&self, primitive: u32) -> bool {
        self.corners(primitive).iter().all(|c| c.is_finite())
    }

    /// The bounding box of any primitive; None if it cannot be hit.
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        let [a, b, c] = self.corners(primitive);
        if a.is_finite() && b.is_finite() && c.is_finite() {
            return Some(Bounds { min: a.min(b).min(c), max: a.max(b).max(c) });
        }
        self.objects()?.bounds(primitive)
    }

    /// The region of all bounded primitives that can be hit; [`region`] unless it is known.
    fn region(&self) -> Region {
        region(self.count(), &|p| self.bounds(p))
    }
}

/// The region of the primitives with finite bounds.
pub fn region(count: usize, bounds: &(dyn Fn(u32) -> Option<Bounds> + Sync)) -> Region {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
    let around = |some: Range<usize>| {
        let all = some.filter_map(|p| bounds(p as u32).filter(Bounds::is_finite));
        all.map(|b| (b.min, b.max)).fold(nothing, join)
    };
    let (min, max) = parallel::map_chunks(count, CHUNK, around).into_iter().fold(nothing, join);
    Region::new(min, max)
}

/// An acceleration structure. All return the same results, ties included: at equal `t`, the lowest primitive wins.
pub trait Accelerator: Send + Sync {
    /// The closest hit of each ray.
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]);

    /// The closest hit of one ray.
    fn intersect_one(&self, ray: &Ray) -> Hit {
        let mut hit = [Hit::MISS];
        self.intersect(std::slice::from_ref(ray), &mut hit);
        hit[0]
    }

    /// Return whether one ray hits anything.
    fn occluded_one(&self, ray: &Ray) -> bool {
        let mut occluded = [false];
        self.occluded(std::slice::from_ref(ray), &mut occluded);
        occluded[0]
    }

    /// Test whether each ray hits anything.
    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]);

    /// The same accelerator with an SoA interface, if it has one. It avoids converting rays and hits, which may take
    /// as long as the traversal.
    fn by_columns(&self) -> Option<&dyn ByColumns> {
        None
    }

    /// Find every hit of each ray; fewer than 2³² rays.
    fn crossings(&self, rays: &[Ray]) -> Crossings;

    /// Find the closest accepted hit of each ray, or with `any` some accepted hit. Rejected intersections have no
    /// effect.
    fn kept(&self, rays: &[Ray], counts: &Counts<'_>, any: bool, hits: &mut [Hit]);

    /// Find all intersections of each ray, including duplicates at shared edges.
    fn met(&self, rays: &[Ray]) -> Every;

    /// Find every accepted hit of each ray.
    fn crossings_kept(&self, rays: &[Ray], counts: &Counts<'_>) -> Crossings;

    /// Find all surfaces of the counting primitives that each ray crosses ahead of its origin. Rays have a `t_min` of
    /// 0.
    fn exits(&self, counts: &(dyn Fn(u32) -> bool + Sync), rays: &[Ray]) -> Exits;

    /// Find the nearest point to each query point, within a maximum distance, inclusive, given once for all or per
    /// point. A non-finite point has none. At equal distances, the lowest primitive wins.
    fn nearest(&self, points: &[DVec3], max_distances: &[f64], nearest: &mut [Nearest]) {
        self.nearest_kept(points, max_distances, None, nearest);
    }

    /// The same, among the counting primitives.
    fn nearest_kept(
        &self,
        points: &[DVec3],
        max_distances: &[f64],
        counts: PrimitiveFilter<'_>,
        nearest: &mut [Nearest],
    );

    /// Find the triangles that each cone touches, nearest first: those that share a point with it, within the bounds of
    /// [`SolidCone`]. An invalid cone, None, touches nothing.
    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches;

    /// Measure the traversal cost of the closest hit of each ray.
    fn cost(&self, rays: &[Ray], costs: &mut [Cost]);

    /// The boxes of all nodes, for each tree of the accelerator; `None` for structures without boxes.
    fn boxes(&self) -> Option<Vec<Boxes>>;

    /// Refit the structure to moved primitives: the same number, of which the same can be hit.
    fn refitted(&self, primitives: &dyn Primitives) -> Result<Box<dyn Accelerator>, String>;

    /// Check the invariants that queries rely on; the error describes the violation.
    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String>;

    /// Statistics of the structure.
    fn info(&self) -> &Info;
}

/// An [`Accelerator`] over triangles with an SoA interface and the same results.
pub trait ByColumns: Send + Sync {
    /// The closest hit of each ray.
    fn intersect(&self, rays: &RayColumns<'_>, hits: HitColumns<'_>);

    /// Find the closest hit of each ray, and store it at the ray's place.
    fn intersect_placed(&self, rays: &RayColumns<'_>, mut hits: PlacedHits<'_>) {
        let count = rays.len();
        let (mut t, mut uv, mut primitive) = (vec![0.0; count], vec![[0.0; 2]; count], vec![0; count]);
        self.intersect(rays, HitColumns { t: &mut t, uv: &mut uv, primitive: &mut primitive });
        for i in 0..count {
            hits.put(i, t[i], uv[i], primitive[i]);
        }
    }

    /// Find the closest hit of each ray, as an array of structures.
    fn first_hits(&self, rays: &RayColumns<'_>, hits: &mut [Hit]);

    /// Find the first primitive that each ray hits, or [`Ray::NO_TRIANGLE`].
    fn first_primitives(&self, rays: &RayColumns<'_>, primitives: &mut [u32]) {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.first_hits(rays, &mut hits);
        for (to, hit) in primitives.iter_mut().zip(hits) {
            *to = if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
        }
    }

    /// Test whether each ray hits anything.
    fn occluded(&self, rays: &RayColumns<'_>, occluded: &mut [bool]);

    /// The size of the scene, if sorting rays for coherence pays.
    fn extent(&self) -> Option<f64>;
}

impl<A: Answers> Accelerator for A {
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "a hit for each ray");
        Answers::intersect(self, rays, hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "an answer for each ray");
        Answers::occluded(self, rays, occluded);
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Answers::by_columns(self)
    }

    fn crossings(&self, rays: &[Ray]) -> Crossings {
        Crossings::of(self.met(rays))
    }

    fn kept(&self, rays: &[Ray], counts: &Counts<'_>, any: bool, hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "a hit for each ray");
        self.answer(rays, &mut RareQuery::Kept(Kept { counts, any, hits }));
    }

    fn met(&self, rays: &[Ray]) -> Every {
        let mut every = Every::of(rays.len());
        self.answer(rays, &mut RareQuery::Every(&mut every));
        every
    }

    fn crossings_kept(&self, rays: &[Ray], counts: &Counts<'_>) -> Crossings {
        let mut every = self.met(rays);
        every.met.retain(|(ray, meeting)| {
            let Hit { t, uv, primitive, inner } = meeting.hit;
            counts(*ray as usize, primitive, &Candidate { t, uv, contact: meeting.contact, inner })
        });
        Crossings::of(every)
    }

    fn exits(&self, counts: &(dyn Fn(u32) -> bool + Sync), rays: &[Ray]) -> Exits {
        let exits = Exits { crossed: Vec::new(), on_surface: vec![false; rays.len()] };
        let mut out = WaysOut { counts, exits };
        self.answer(rays, &mut out);
        out.exits.in_order()
    }

    fn nearest_kept(
        &self,
        points: &[DVec3],
        max_distances: &[f64],
        counts: PrimitiveFilter<'_>,
        nearest: &mut [Nearest],
    ) {
        assert_eq!(points.len(), nearest.len(), "an answer for each point");
        assert!(matches!(max_distances.len(), n if n == 1 || n == points.len()), "a distance for each point");
        Answers::nearest(self, points, max_distances, counts, nearest);
    }

    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches {
        Answers::touched(self, cones)
    }

    fn cost(&self, rays: &[Ray], costs: &mut [Cost]) {
        assert_eq!(rays.len(), costs.len(), "a cost for each ray");
        self.answer(rays, &mut CostQuery(costs));
    }

    fn boxes(&self) -> Option<Vec<Boxes>> {
        Answers::boxes(self).map(|boxes| vec![boxes])
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Box<dyn Accelerator>, String> {
        Answers::refitted(self, primitives).map(|a| Box::new(a) as _)
    }

    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        Answers::validate(self, primitives)
    }

    fn info(&self) -> &Info {
        Answers::info(self)
    }
}

/// The cost of a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Nodes with tested boxes.
    pub nodes: u32,
    /// Primitives in the visited leaves, without those already marked as tested.
    pub primitives: u32,
}

/// Statistics of an accelerator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Info {
    /// The kind of structure and build.
    pub kind: String,
    /// The precision of triangle corners in its leaves: "single" or "double".
    pub precision: &'static str,
    /// The number of primitives that can be hit.
    pub primitives: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// The depth of the tree; 0 if the root is a leaf.
    pub depth: usize,
    /// Memory use in bytes.
    pub bytes: usize,
    /// Wall-clock time of the build.
    pub build_seconds: f64,
    /// The expected cost of a random ray that hits the root's box by the surface area heuristic (Goldsmith and Salmon
    /// 1987), in tests of a node or of a block of triangles.
    pub sah_cost: f64,
}
