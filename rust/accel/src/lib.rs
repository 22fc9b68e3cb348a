//! Floor 2: what finds hits.

// What its functions take and return.
pub use raywright_base::{math, simd};
pub use raywright_shapes as shapes;

// Files that tests share name the crate as its users do.
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
mod few_triangles;
pub mod flat;
pub mod grid;
pub mod kdtree;
mod kept;
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
pub use few_triangles::FewTriangles;
pub use kept::Counts;
pub use nearest::{Nearest, PrimitiveFilter};
pub use parity::{Exit, Exits, Side};
pub use slab::SlabRay;
pub use tangent_balls::TangentBalls;
pub use touches::{Touch, Touches};
pub use user_geometry::{Placed, UserGeometry};
pub use walked::walked;

pub use query::{Every, Meeting, Wanted};

use kept::Kept;
use parity::WaysOut;
use query::{Answers, Counted};
use rare_query::RareQuery;
use raywright_base::math::{DVec3, Hit, HitColumns, Ray, RayColumns, Region};
use raywright_base::parallel::{self, CHUNK};
use raywright_base::work::Work;
use raywright_shapes::triangle::SolidCone;
use raywright_shapes::{Bounds, Candidate};
use std::ops::Range;
use std::sync::Arc;

/// What an accelerator is built from: triangles known by their numbers and corners, and objects known by their numbers
/// alone.
///
/// The accelerators know no scene; whoever owns primitives shows them so.
pub trait Primitives: Sync {
    /// The number of primitives; they are numbered from 0.
    fn count(&self) -> usize;

    /// The corners of a triangle; NaN of what is none.
    fn corners(&self, primitive: u32) -> [DVec3; 3];

    /// Whether every coordinate of a triangle is an f32, so that leaves need not keep more.
    fn is_single(&self) -> bool;

    /// What is no triangle; none if there is no such thing.
    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        None
    }

    /// Who watches what is made over them, and may stop it: nobody, unless it is said.
    ///
    /// An accelerator that was stopped holds nothing, and is of no use: whoever stops it drops it.
    fn work(&self) -> Work<'_> {
        Work::UNWATCHED
    }

    /// Whether it is a triangle that can be hit: not if a corner is NaN or infinite.
    fn is_finite(&self, primitive: u32) -> bool {
        self.corners(primitive).iter().all(|c| c.is_finite())
    }

    /// The box around a primitive, triangle or not; none if nothing can hit it.
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        let [a, b, c] = self.corners(primitive);
        if a.is_finite() && b.is_finite() && c.is_finite() {
            return Some(Bounds { min: a.min(b).min(c), max: a.max(b).max(c) });
        }
        self.objects()?.bounds(primitive)
    }

    /// Where the primitives lie that can be hit, but for those without end: [`region`], unless that is known.
    fn region(&self) -> Region {
        region(self.count(), &|p| self.bounds(p))
    }
}

/// Where all of so many lie that have bounds, and an end.
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

/// Finds hits among primitives. Every accelerator gives the same answers, ties included: of equal `t`, the lowest
/// primitive.
pub trait Accelerator: Send + Sync {
    /// The closest hit of each ray.
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]);

    /// The closest hit of one ray.
    fn intersect_one(&self, ray: &Ray) -> Hit {
        let mut hit = [Hit::MISS];
        self.intersect(std::slice::from_ref(ray), &mut hit);
        hit[0]
    }

    /// Whether one ray hits anything.
    fn occluded_one(&self, ray: &Ray) -> bool {
        let mut occluded = [false];
        self.occluded(std::slice::from_ref(ray), &mut occluded);
        occluded[0]
    }

    /// Whether each ray hits anything.
    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]);

    /// It as what takes rays by columns, if it does: where a ray's way in and out would otherwise take as long as its
    /// way through the structure.
    fn by_columns(&self) -> Option<&dyn ByColumns> {
        None
    }

    /// Every hit of each ray, of which there are fewer than 2³².
    fn crossings(&self, rays: &[Ray]) -> Crossings;

    /// The closest hit of each ray among what counts for it or, if `any` will do, one of these: as if all else were not
    /// there.
    fn kept(&self, rays: &[Ray], counts: &Counts<'_>, any: bool, hits: &mut [Hit]);

    /// All that each ray meets, by every triangle.
    fn met(&self, rays: &[Ray]) -> Every;

    /// Every hit of each ray among what counts for it.
    fn crossings_kept(&self, rays: &[Ray], counts: &Counts<'_>) -> Crossings;

    /// All surfaces that the rays, asked from a `t_min` of 0 on, cross ahead of their origins, among the primitives
    /// that count.
    fn exits(&self, counts: &(dyn Fn(u32) -> bool + Sync), rays: &[Ray]) -> Exits;

    /// The nearest point to each point, within its greatest distance, that distance included; one greatest distance for
    /// all of them, or one each. A point that is NaN or infinite has none. Of primitives as near, the lowest.
    fn nearest(&self, points: &[DVec3], max_distances: &[f64], nearest: &mut [Nearest]) {
        self.nearest_kept(points, max_distances, None, nearest);
    }

    /// The same among the primitives that count.
    fn nearest_kept(
        &self,
        points: &[DVec3],
        max_distances: &[f64],
        counts: PrimitiveFilter<'_>,
        nearest: &mut [Nearest],
    );

    /// The triangles that each cone touches, nearest first: those that share a point with it, within the bounds that
    /// [`SolidCone`] states. None of what is no cone.
    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches;

    /// What finding the closest hit of each ray takes, ray by ray.
    fn cost(&self, rays: &[Ray], costs: &mut [Cost]);

    /// The boxes of all nodes, of each of the trees that it is; `None` of what has no boxes.
    fn boxes(&self) -> Option<Vec<Boxes>>;

    /// The same structure over primitives that have moved: as many, of the same numbers and of which the same can be
    /// hit.
    fn refitted(&self, primitives: &dyn Primitives) -> Result<Box<dyn Accelerator>, String>;

    /// Checks what queries rely on; says what is wrong.
    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String>;

    /// What it looks like.
    fn info(&self) -> &Info;
}

/// An [`Accelerator`] over triangles that takes rays by columns, and gives the same answers.
pub trait ByColumns: Send + Sync {
    /// The closest hit of each ray.
    fn intersect(&self, rays: &RayColumns<'_>, hits: HitColumns<'_>);

    /// The closest hit of each ray, one after the other.
    fn first_hits(&self, rays: &RayColumns<'_>, hits: &mut [Hit]);

    /// The primitive that each ray hits first, or [`Ray::NO_TRIANGLE`].
    fn first_primitives(&self, rays: &RayColumns<'_>, primitives: &mut [u32]) {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.first_hits(rays, &mut hits);
        for (to, hit) in primitives.iter_mut().zip(hits) {
            *to = if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
        }
    }

    /// Whether each ray hits anything.
    fn occluded(&self, rays: &RayColumns<'_>, occluded: &mut [bool]);

    /// How large what rays meet is, if it matters to them in which order they come.
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
        self.answer(rays, &mut Counted(costs));
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

/// What a query took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Nodes whose boxes were tested.
    pub nodes: u32,
    /// Primitives that stood in the leaves visited; each once, where it is known to have been met before.
    pub primitives: u32,
}

/// What an accelerator looks like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Info {
    /// What it is, and how it was built.
    pub kind: String,
    /// How precisely the corners of triangles are kept in its leaves: "single" or "double".
    pub precision: &'static str,
    /// Primitives in it: those that can be hit.
    pub primitives: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// The longest way from the root to a leaf; 0 where the root is a leaf.
    pub depth: usize,
    /// Memory held.
    pub bytes: usize,
    /// Wall-clock time of the build.
    pub build_seconds: f64,
    /// Expected cost of a random ray that meets the root's box, by the surface-area heuristic (Goldsmith and Salmon
    /// 1987), in tests of a node or of a block of triangles.
    pub sah_cost: f64,
}
