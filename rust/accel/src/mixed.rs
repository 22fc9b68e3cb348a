//! Triangles and objects in separate structures. A ray queries one, then the other with the remaining interval.

use super::walk::{Build, Mailbox};
use super::walked::walked;
use super::{
    Accelerator, Boxes, ByColumns, Cost, Counts, Crossings, Every, Exits, Info, Nearest, PrimitiveFilter, Primitives,
    Touches, UserGeometry,
};
use raywright_base::math::{DVec3, Hit, HitColumns, Ray, RayColumns};
use raywright_base::simd::Level;
use raywright_base::work::Work;
use raywright_shapes::Bounds;
use raywright_shapes::triangle::SolidCone;
use std::cell::Cell;
use std::sync::Arc;

/// Build an accelerator over both: `triangles` builds the one over triangles, `objects` the other. If there is only one
/// kind, its accelerator alone is returned.
pub fn mixed(
    primitives: &dyn Primitives,
    level: Level,
    triangles: &dyn Fn(&dyn Primitives) -> Box<dyn Accelerator>,
    objects: &Build,
) -> Box<dyn Accelerator> {
    let Some(kept) = primitives.objects() else { return triangles(primitives) };
    // An estimate: the build times are seldom known beforehand.
    let [first, then] = primitives.work().parts([1.0, 3.0]);
    let (kept_moves, kept_nests) = (kept.moves(), kept.is_nested());
    let others = walked(&OnlyObjects(primitives, kept, first), level, Mailbox::Stamps, objects);
    let triangles = triangles(&OnlyTriangles(primitives, then));
    if triangles.info().primitives == 0 {
        return others;
    }
    Box::new(Mixed::of(triangles, others, !kept_moves && !kept_nests))
}

/// The triangles among the primitives.
struct OnlyTriangles<'a>(&'a dyn Primitives, Work<'a>);

impl Primitives for OnlyTriangles<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0.corners(primitive)
    }
    fn is_single(&self) -> bool {
        self.0.is_single()
    }
    fn work(&self) -> Work<'_> {
        self.1
    }
}

/// The primitives other than triangles.
struct OnlyObjects<'a>(&'a dyn Primitives, Arc<dyn UserGeometry>, Work<'a>);

impl<'a> OnlyObjects<'a> {
    fn of(primitives: &'a dyn Primitives) -> Result<Self, String> {
        let objects = primitives.objects().ok_or("the scene has only triangles, but had other primitives")?;
        Ok(Self(primitives, objects, primitives.work()))
    }
}

impl Primitives for OnlyObjects<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }
    fn corners(&self, _: u32) -> [DVec3; 3] {
        [DVec3::NAN; 3]
    }
    fn is_single(&self) -> bool {
        true
    }
    fn work(&self) -> Work<'_> {
        self.2
    }
    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        Some(self.1.clone())
    }
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        self.1.bounds(primitive)
    }
}

struct Mixed {
    triangles: Box<dyn Accelerator>,
    objects: Box<dyn Accelerator>,
    /// True if the SoA interface suffices: nothing moves, and there are no nested primitives.
    is_plain: bool,
    info: Info,
}

/// Rays per batch for objects, small enough to stay in the cache.
const TOGETHER: usize = 256;

impl Mixed {
    fn of(triangles: Box<dyn Accelerator>, objects: Box<dyn Accelerator>, is_plain: bool) -> Self {
        let (a, b) = (triangles.info(), objects.info());
        let info = Info {
            kind: format!("{}; beside it {}", a.kind, b.kind),
            precision: a.precision,
            primitives: a.primitives + b.primitives,
            nodes: a.nodes + b.nodes,
            leaves: a.leaves + b.leaves,
            depth: a.depth.max(b.depth),
            bytes: a.bytes + b.bytes,
            build_seconds: a.build_seconds + b.build_seconds,
            sah_cost: a.sah_cost + b.sah_cost,
        };
        Self { triangles, objects, is_plain, info }
    }

    /// Query the objects for hits closer than the given ones, and report those found.
    fn nearer(
        &self,
        count: usize,
        ray: impl Fn(usize) -> Ray,
        hit: impl Fn(usize) -> Hit,
        mut found: impl FnMut(usize, Hit),
    ) {
        let mut rays = Vec::with_capacity(TOGETHER.min(count));
        let mut others = [Hit::MISS; TOGETHER];
        for start in (0..count).step_by(TOGETHER) {
            let these = start..count.min(start + TOGETHER);
            rays.clear();
            // At equal `t`, a hit on a lower primitive wins.
            rays.extend(these.clone().map(|i| {
                let ray = ray(i);
                Ray { t_max: ray.t_max.min(hit(i).t), ..ray }
            }));
            let others = &mut others[..these.len()];
            self.objects.intersect(&rays, others);
            for (i, other) in these.zip(others) {
                if is_before(other, &hit(i)) {
                    found(i, *other);
                }
            }
        }
    }

    /// Query the objects for rays that hit no triangle.
    fn also(&self, ray: impl Fn(usize) -> Ray, occluded: &mut [bool]) {
        let open: Vec<usize> = (0..occluded.len()).filter(|&i| !occluded[i]).collect();
        let (mut rays, mut others) = (Vec::with_capacity(TOGETHER.min(open.len())), [false; TOGETHER]);
        for open in open.chunks(TOGETHER) {
            rays.clear();
            rays.extend(open.iter().map(|&i| ray(i)));
            let others = &mut others[..open.len()];
            self.objects.occluded(&rays, others);
            for (&i, other) in open.iter().zip(others) {
                occluded[i] = *other;
            }
        }
    }
}

/// The order of hits: at equal `t`, the lowest primitive comes first.
fn is_before(a: &Hit, b: &Hit) -> bool {
    (a.t, a.primitive, a.inner) < (b.t, b.primitive, b.inner)
}

/// Merge the hits of two structures in order.
fn joined(count: usize, a: &Crossings, b: &Crossings) -> Crossings {
    let mut all = Crossings { splits: vec![0], hits: Vec::with_capacity(a.hits.len() + b.hits.len()) };
    for i in 0..count {
        let of = |c: &Crossings| c.splits[i]..c.splits[i + 1];
        let from = all.hits.len();
        all.hits.extend_from_slice(&a.hits[of(a)]);
        all.hits.extend_from_slice(&b.hits[of(b)]);
        // The sort is stable, so duplicates remain. Adding zero turns −0 into +0.
        all.hits[from..].sort_by(|x, y| {
            (x.t + 0.0).total_cmp(&(y.t + 0.0)).then((x.primitive, x.inner).cmp(&(y.primitive, y.inner)))
        });
        all.splits.push(all.hits.len());
    }
    all
}

impl Accelerator for Mixed {
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.triangles.intersect(rays, hits);
        let hits = Cell::from_mut(hits).as_slice_of_cells();
        self.nearer(rays.len(), |i| rays[i], |i| hits[i].get(), |i, hit| hits[i].set(hit));
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        (self.is_plain && self.triangles.by_columns().is_some()).then_some(self)
    }

    fn intersect_one(&self, ray: &Ray) -> Hit {
        let hit = self.triangles.intersect_one(ray);
        let other = self.objects.intersect_one(&Ray { t_max: ray.t_max.min(hit.t), ..*ray });
        if is_before(&other, &hit) { other } else { hit }
    }

    fn occluded_one(&self, ray: &Ray) -> bool {
        self.triangles.occluded_one(ray) || self.objects.occluded_one(ray)
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.triangles.occluded(rays, occluded);
        self.also(|i| rays[i], occluded);
    }

    fn crossings(&self, rays: &[Ray]) -> Crossings {
        joined(rays.len(), &self.triangles.crossings(rays), &self.objects.crossings(rays))
    }

    fn kept(&self, rays: &[Ray], counts: &Counts<'_>, any: bool, hits: &mut [Hit]) {
        self.triangles.kept(rays, counts, any, hits);
        let left = |(ray, hit): (&Ray, &Hit)| Ray { t_max: ray.t_max.min(hit.t), ..*ray };
        let left: Vec<_> = rays.iter().zip(&*hits).map(left).collect();
        let mut others = vec![Hit::MISS; rays.len()];
        self.objects.kept(&left, counts, any, &mut others);
        for (hit, other) in hits.iter_mut().zip(&others) {
            if is_before(other, hit) {
                *hit = *other;
            }
        }
    }

    fn met(&self, rays: &[Ray]) -> Every {
        let (mut all, others) = (self.triangles.met(rays), self.objects.met(rays));
        all.met.extend(others.met);
        // A structure sets no conversion for rays that hit nothing in it.
        for (mine, other) in all.rays.iter_mut().zip(others.rays) {
            *mine = if *mine == Every::UNTOLD { other } else { *mine };
        }
        all
    }

    fn crossings_kept(&self, rays: &[Ray], counts: &Counts<'_>) -> Crossings {
        let (a, b) = (self.triangles.crossings_kept(rays, counts), self.objects.crossings_kept(rays, counts));
        joined(rays.len(), &a, &b)
    }

    fn exits(&self, counts: &(dyn Fn(u32) -> bool + Sync), rays: &[Ray]) -> Exits {
        self.triangles.exits(counts, rays).joined(self.objects.exits(counts, rays))
    }

    fn nearest_kept(
        &self,
        points: &[DVec3],
        max_distances: &[f64],
        counts: PrimitiveFilter<'_>,
        nearest: &mut [Nearest],
    ) {
        self.triangles.nearest_kept(points, max_distances, counts, nearest);
    }

    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches {
        self.triangles.touched(cones)
    }

    fn cost(&self, rays: &[Ray], costs: &mut [Cost]) {
        self.triangles.cost(rays, costs);
        let mut hits = vec![Hit::MISS; rays.len()];
        self.triangles.intersect(rays, &mut hits);
        let rays: Vec<_> = rays.iter().zip(&hits).map(|(r, h)| Ray { t_max: r.t_max.min(h.t), ..*r }).collect();
        let mut others = vec![Cost::default(); rays.len()];
        self.objects.cost(&rays, &mut others);
        for (cost, other) in costs.iter_mut().zip(others) {
            cost.nodes += other.nodes;
            cost.primitives += other.primitives;
        }
    }

    fn boxes(&self) -> Option<Vec<Boxes>> {
        let mut all = self.triangles.boxes()?;
        all.append(&mut self.objects.boxes()?);
        Some(all)
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Box<dyn Accelerator>, String> {
        let triangles = self.triangles.refitted(&OnlyTriangles(primitives, primitives.work()))?;
        let objects = self.objects.refitted(&OnlyObjects::of(primitives)?)?;
        Ok(Box::new(Self::of(triangles, objects, self.is_plain)))
    }

    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        self.triangles.validate(&OnlyTriangles(primitives, primitives.work()))?;
        self.objects.validate(&OnlyObjects::of(primitives)?)
    }

    fn info(&self) -> &Info {
        &self.info
    }
}

impl Mixed {
    /// The SoA interface of the triangles.
    fn columns(&self) -> &dyn ByColumns {
        self.triangles.by_columns().expect("asked only where they are")
    }
}

impl ByColumns for Mixed {
    fn intersect(&self, rays: &RayColumns<'_>, hits: HitColumns<'_>) {
        let HitColumns { t, uv, primitive } = hits;
        self.columns().intersect(rays, HitColumns { t, uv, primitive });
        let (t, primitive) = (Cell::from_mut(t).as_slice_of_cells(), Cell::from_mut(primitive).as_slice_of_cells());
        // A miss has −1, which converts to the greatest number.
        let hit = |i: usize| Hit { t: t[i].get(), primitive: primitive[i].get() as u32, ..Hit::MISS };
        self.nearer(
            rays.len(),
            |i| rays.get(i),
            hit,
            |i, hit| {
                t[i].set(hit.t);
                primitive[i].set(hit.primitive as i32);
                uv[i] = hit.uv;
            },
        );
    }

    fn first_hits(&self, rays: &RayColumns<'_>, hits: &mut [Hit]) {
        self.columns().first_hits(rays, hits);
        let hits = Cell::from_mut(hits).as_slice_of_cells();
        self.nearer(rays.len(), |i| rays.get(i), |i| hits[i].get(), |i, hit| hits[i].set(hit));
    }

    fn occluded(&self, rays: &RayColumns<'_>, occluded: &mut [bool]) {
        self.columns().occluded(rays, occluded);
        self.also(|i| rays.get(i), occluded);
    }

    fn extent(&self) -> Option<f64> {
        self.columns().extent()
    }
}
