//! A scene ready for rays.

use super::geometry::Watched;
use super::lights::{Emitters, not_drawn};
use super::media::Medium;
use super::{
    DescriptionError, Emission, Enclosing, Geometry, Lights, Material, Plan, SceneDescription, Solids, SurfacePoint,
};
use raywright_accel::{Accelerator, Cost, Crossings, FewShapes, Nearest, PrimitiveFilter, Primitives, Side, Touches};
use raywright_base::math::{DVec3, Hit, PathRays, Ray, RayQueue, Region};
use raywright_base::simd::Level;
use raywright_base::work::{Stopped, Work};
use raywright_shapes::triangle::SolidCone;
use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// A scene ready for rays.
pub struct Scene {
    geometry: Geometry,
    materials: Vec<Arc<dyn Material>>,
    lights: Lights,
    plan: Plan,
    /// Values derived from the scene by other crates, at most one of each type.
    kept: Mutex<Vec<Arc<dyn Any + Send + Sync>>>,
    accelerator: Box<dyn Accelerator>,
    /// The triangles as a flat list for path rays, if they are few and the scene has nothing else.
    few: Option<FewShapes>,
    region: Region,
    /// The medium outside all closed surfaces.
    surrounding: Option<Arc<dyn Medium>>,
    /// The accelerator's cost when it was built.
    built_cost: f64,
}

/// Results of [`Scene::solids`], the latest first.
#[derive(Default)]
struct LastSolids(Mutex<Vec<(Enclosing, Arc<Solids>)>>);

/// Number of results kept.
const MOST_SOLIDS: usize = 4;

/// Ray directions of [`Scene::contains`]. They avoid special positions relative to man-made geometry. Their largest
/// coordinate is between 1 and 2, so that `t` is not scaled.
const WAYS_OUT: [DVec3; 7] = [
    DVec3::new(1.289_430_857_193_402_8, 0.371_920_584_301_275_66, 0.587_109_384_750_921_3),
    DVec3::new(-1.289_430_857_193_402_8, -0.371_920_584_301_275_66, -0.587_109_384_750_921_3),
    DVec3::new(-0.518_302_947_561_093_8, 1.470_193_857_204_918_4, -0.219_385_710_482_957_5),
    DVec3::new(0.293_847_502_918_375_7, -0.638_201_947_562_910_4, 1.619_204_857_391_028_3),
    DVec3::new(0.851_029_384_756_102_9, -1.137_482_910_583_749_2, -0.743_918_205_764_839_1),
    DVec3::new(-1.057_291_840_375_629_3, -0.482_910_375_829_104_7, 0.963_820_194_756_382_9),
    DVec3::new(0.139_204_857_610_293_8, 0.917_364_820_591_837_4, -1.384_710_293_857_460_2),
];

impl Scene {
    /// Compiles a description and builds an accelerator over its geometry.
    ///
    /// # Panics
    /// If a mesh is invalid; see [`Geometry::new`].
    pub fn new(
        description: SceneDescription,
        accelerator: impl FnOnce(&dyn Primitives) -> Box<dyn Accelerator>,
    ) -> Result<Self, DescriptionError> {
        Self::watched(description, accelerator, Work::UNWATCHED)
    }

    /// Like [`Scene::new`], but interruptible; interruption is an error.
    ///
    /// # Panics
    /// As [`Scene::new`].
    pub fn watched(
        description: SceneDescription,
        accelerator: impl FnOnce(&dyn Primitives) -> Box<dyn Accelerator>,
        work: Work,
    ) -> Result<Self, DescriptionError> {
        let goes_on = || work.goes_on().map_err(|Stopped| DescriptionError::Stopped);
        let parts = description.joined()?;
        goes_on()?;
        let lights = Lights::new(&parts.geometry, &parts.materials, parts.emission, parts.lights);
        goes_on()?;
        let accelerator = accelerator(&Watched { geometry: &parts.geometry, work });
        goes_on()?;
        Ok(Self::with(accelerator, None, parts.geometry, parts.materials, lights))
    }

    /// Rebuilds the scene over meshes that have moved, with the accelerator refitted. Returns `None` if the accelerator
    /// cannot be refitted ([`Accelerator::refitted`]).
    ///
    /// # Panics
    /// As [`Scene::new`].
    pub fn refitted(&self, description: SceneDescription, work: Work) -> Result<Option<Self>, DescriptionError> {
        let parts = description.joined()?;
        let lights = Lights::new(&parts.geometry, &parts.materials, parts.emission, parts.lights);
        let accelerator = self.accelerator.refitted(&Watched { geometry: &parts.geometry, work }).ok();
        work.goes_on().map_err(|Stopped| DescriptionError::Stopped)?;
        Ok(accelerator.map(|a| Self::with(a, Some(self.built_cost), parts.geometry, parts.materials, lights)))
    }

    fn with(
        accelerator: Box<dyn Accelerator>,
        built_cost: Option<f64>,
        geometry: Geometry,
        materials: Vec<Arc<dyn Material>>,
        lights: Lights,
    ) -> Self {
        let (region, cost) = (geometry.region(), accelerator.info().sah_cost);
        let plan = Plan::new(&geometry, &materials, &lights);
        let built_cost = built_cost.unwrap_or(cost);
        let kept = Mutex::default();
        let few = accelerator.by_columns().and_then(|_| FewShapes::new(&geometry));
        Self { geometry, materials, lights, plan, kept, accelerator, few, region, surrounding: None, built_cost }
    }

    /// Sets the medium outside all closed surfaces.
    pub fn surrounded_by(self, medium: Option<Arc<dyn Medium>>) -> Self {
        let plan = self.plan.with_medium_around(medium.as_deref());
        Self { plan, surrounding: medium, ..self }
    }

    /// Uses all shading normals as given, without correction.
    pub fn with_normals_as_given(self) -> Self {
        let plan = self.plan.clone().with_normals_as_given(&self.geometry);
        Self { plan, ..self }
    }

    /// The medium outside all closed surfaces; `None` for vacuum.
    #[inline]
    pub fn surrounding(&self) -> Option<&dyn Medium> {
        self.surrounding.as_deref()
    }

    /// Surface-area-heuristic cost of the accelerator over its cost when built; 1 until it is refitted.
    pub fn growth(&self) -> f64 {
        let cost = self.accelerator.info().sah_cost;
        if cost == self.built_cost { 1.0 } else { cost / self.built_cost }
    }

    /// The closest hit of each ray.
    pub fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.accelerator.intersect(rays, hits);
    }

    /// The closest hit of one ray.
    pub fn intersect_one(&self, ray: &Ray) -> Hit {
        self.accelerator.intersect_one(ray)
    }

    /// Tests each ray for any hit.
    pub fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.accelerator.occluded(rays, occluded);
    }

    /// The first primitive that each path ray hits, or [`Ray::NO_TRIANGLE`]. Both arrays have room for sixteen elements
    /// more than there are rays.
    pub fn first_primitives(&self, level: Level, rays: &PathRays, primitives: &mut [u32]) {
        if let Some(few) = &self.few {
            return few.closest(level, rays, primitives);
        }
        let primitives = &mut primitives[..rays.len];
        match self.accelerator.by_columns() {
            Some(tree) => tree.first_primitives(&rays.columns(), primitives),
            None => {
                let mut hits = vec![Hit::MISS; rays.len];
                self.accelerator.intersect(&(0..rays.len).map(|i| rays.get(i)).collect::<Vec<_>>(), &mut hits);
                for (to, hit) in primitives.iter_mut().zip(hits) {
                    *to = if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
                }
            }
        }
    }

    /// The first hit of each path ray, with all there is to know of it.
    pub fn first_hits(&self, rays: &PathRays, hits: &mut [Hit]) {
        self.accelerator.intersect(&(0..rays.len).map(|i| rays.get(i)).collect::<Vec<_>>(), &mut hits[..rays.len]);
    }

    /// Return whether rays of paths are traced in packets of sixteen, which gain by a common origin.
    pub fn traces_packets(&self) -> bool {
        self.few.is_none()
    }

    /// Whether each of the rays of paths hits anything.
    pub fn are_occluded(&self, level: Level, rays: &PathRays, occluded: &mut [bool]) {
        if let Some(few) = &self.few {
            return few.occluded(level, rays, occluded);
        }
        let occluded = &mut occluded[..rays.len];
        match self.accelerator.by_columns() {
            Some(tree) => tree.occluded(&rays.columns(), occluded),
            None => self.accelerator.occluded(&(0..rays.len).map(|i| rays.get(i)).collect::<Vec<_>>(), occluded),
        }
    }

    /// The closest hit of each ray of a queue.
    pub fn intersect_queue(&self, rays: &mut RayQueue, hits: &mut [Hit]) {
        match self.accelerator.by_columns() {
            Some(tree) => tree.first_hits(&rays.columns(), hits),
            None => self.accelerator.intersect(rays.rows(), hits),
        }
    }

    /// Every hit of each ray.
    pub fn crossings(&self, rays: &[Ray]) -> Crossings {
        self.accelerator.crossings(rays)
    }

    /// Tests whether each point is inside a closed surface or on it.
    ///
    /// By crossing parity, every direction gives the same result for a watertight surface, so one ray is enough if all
    /// surfaces close to the last bit. If they close only to rounding, a ray may leave through a crack: one direction
    /// and its opposite are compared, and if they disagree, the majority of seven directions decides.
    pub fn contains(&self, points: &[DVec3], enclosing: &Enclosing, inside: &mut [bool]) {
        assert_eq!(points.len(), inside.len(), "an answer for each point");
        inside.fill(false);
        let solids = self.solids(enclosing);
        if solids.is_empty() {
            return;
        }
        let within = |p: &DVec3| p.cmpge(self.region.min).all() && p.cmple(self.region.max).all();
        let mut open: Vec<usize> =
            (0..points.len()).filter(|&i| within(&points[i]) && solids.may_contain(points[i])).collect();
        let mut votes = vec![0u32; points.len()];
        let vote = |rays: &[Ray], which: &[usize], inside: &mut [bool], votes: &mut [u32]| {
            for (&i, side) in which.iter().zip(solids.sides(&self.geometry, self.accelerator(), rays)) {
                votes[i] += u32::from(side == Side::Inside);
                inside[i] |= side == Side::Surface;
            }
        };
        if solids.is_exact() {
            let rays: Vec<Ray> = open.iter().map(|&i| self.ray_out(points[i])).collect();
            vote(&rays, &open, inside, &mut votes);
            open.iter().for_each(|&i| inside[i] |= votes[i] == 1);
            return;
        }
        let vote_all = |ways: &[DVec3], which: &[usize], inside: &mut [bool], votes: &mut [u32]| {
            for &way in ways.iter().filter(|_| !which.is_empty()) {
                let rays: Vec<Ray> = which.iter().map(|&i| Ray::new(points[i], way)).collect();
                vote(&rays, which, inside, votes);
            }
        };
        let (pair, others) = WAYS_OUT.split_at(2);
        vote_all(pair, &open, inside, &mut votes);
        open.retain(|&i| {
            inside[i] |= votes[i] == 2;
            votes[i] == 1 && !inside[i]
        });
        vote_all(others, &open, inside, &mut votes);
        for i in open {
            inside[i] |= 2 * votes[i] as usize > WAYS_OUT.len();
        }
    }

    /// The ray from a point along one of [`WAYS_OUT`] that leaves the scene's bounds first, and so probably crosses the
    /// fewest surfaces.
    fn ray_out(&self, point: DVec3) -> Ray {
        let length = |way: &DVec3| {
            let end = DVec3::select(way.cmpgt(DVec3::ZERO), self.region.max, self.region.min);
            ((end - point) / *way).min_element()
        };
        let lengths = WAYS_OUT.map(|way| length(&way));
        let least = (0..WAYS_OUT.len()).fold(0, |best, i| if lengths[i] < lengths[best] { i } else { best });
        Ray::new(point, WAYS_OUT[least])
    }

    /// The solids that the counted surfaces enclose. The latest results are cached.
    pub fn solids(&self, enclosing: &Enclosing) -> Arc<Solids> {
        let kept = self.kept(|| Some(LastSolids::default())).expect("it is made");
        // Computed outside the lock: a thread that waits for others may take up their tasks, and those may call this
        // function.
        let find = |all: &[(Enclosing, Arc<Solids>)]| {
            all.iter().find(|(known, _)| known == enclosing).map(|(_, solids)| solids.clone())
        };
        if let Some(found) = find(&kept.0.lock().unwrap_or_else(PoisonError::into_inner)) {
            return found;
        }
        let made = Arc::new(Solids::new(&self.geometry, self.accelerator(), enclosing));
        let mut all = kept.0.lock().unwrap_or_else(PoisonError::into_inner);
        find(&all).unwrap_or_else(|| {
            all.truncate(MOST_SOLIDS - 1);
            all.insert(0, (enclosing.clone(), made.clone()));
            made
        })
    }

    /// The nearest point to each point, within a maximum distance: one for all points, or one each. `shapes` restricts
    /// the search to some shapes.
    pub fn nearest(&self, points: &[DVec3], max_distances: &[f64], shapes: Option<&[bool]>, nearest: &mut [Nearest]) {
        let of_shapes = |primitive: u32| {
            let shape = self.geometry.locate(primitive).0 as usize;
            shapes.is_none_or(|shapes| shapes.get(shape).is_some_and(|&counts| counts))
        };
        let counts: PrimitiveFilter<'_> = if shapes.is_some() { Some(&of_shapes) } else { None };
        if self.geometry.has_vertices() {
            self.accelerator.nearest_kept(points, max_distances, counts, nearest);
        } else {
            nearest.fill(Nearest::MISS);
        }
        self.geometry.nearest_of_others(points, max_distances, counts, nearest);
    }

    /// The triangles that each cone touches, nearest first.
    pub fn touched(&self, cones: &[Option<SolidCone>]) -> Touches {
        self.accelerator.touched(cones)
    }

    /// Counts the traversal steps for the closest hit of each ray.
    pub fn cost(&self, rays: &[Ray], costs: &mut [Cost]) {
        self.accelerator.cost(rays, costs);
    }

    /// The surfaces.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The lights.
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// The features that shading this scene needs.
    #[inline]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the cached value of type `T`, or makes and caches it. Returns `None` if `make` does.
    pub fn kept<T: Any + Send + Sync>(&self, make: impl FnOnce() -> Option<T>) -> Option<Arc<T>> {
        let lock = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let find =
            |kept: &[Arc<dyn Any + Send + Sync>]| kept.iter().find_map(|one| Arc::clone(one).downcast::<T>().ok());
        if let Some(found) = find(&lock()) {
            return Some(found);
        }
        // Made outside the lock: a thread that waits for others may take up their tasks, and those may call this
        // function. If several threads make a value, all get the first one stored.
        let made = Arc::new(make()?);
        let mut kept = lock();
        Some(find(&kept).unwrap_or_else(|| {
            kept.push(Arc::clone(&made) as Arc<dyn Any + Send + Sync>);
            made
        }))
    }

    /// The material of a shape.
    #[inline]
    pub fn material(&self, shape: u32) -> &dyn Material {
        &*self.materials[shape as usize]
    }

    /// The material at a surface point.
    #[inline]
    pub fn material_at(&self, surface: &SurfacePoint) -> &dyn Material {
        match surface.inner {
            Some(inner) => self.appearance(surface.shape, inner).0,
            None => self.material(surface.shape),
        }
    }

    /// The material at a hit.
    #[inline]
    pub fn material_of(&self, hit: &Hit) -> &dyn Material {
        let shape = self.geometry.locate(hit.primitive).0;
        if self.geometry.instances_of(shape).is_some() {
            self.appearance(shape, hit.inner).0
        } else {
            self.material(shape)
        }
    }

    /// The emission at a surface point.
    #[inline]
    pub fn emission_at(&self, surface: &SurfacePoint) -> &Emission {
        match surface.inner {
            Some(inner) => self.appearance(surface.shape, inner).1,
            None => self.lights.emission(surface.shape),
        }
    }

    /// Material and emission of a primitive, by its flattened number, in a shape that is instances of a prototype.
    fn appearance(&self, shape: u32, inner: u32) -> (&dyn Material, &Emission) {
        match self.geometry.instances_of(shape) {
            Some(instances) => instances.prototype().appearance(inner),
            None => (self.material(shape), self.lights.emission(shape)),
        }
    }

    /// The acceleration structure.
    pub fn accelerator(&self) -> &dyn Accelerator {
        self.accelerator.as_ref()
    }

    /// The distribution of light emission; `None` if no emitter can be sampled.
    pub fn emitters(&self) -> Option<Emitters<'_>> {
        Emitters::new(&self.lights, &self.geometry, &self.region)
    }

    /// The reason why emission cannot be sampled from all lights, if there is one.
    pub fn not_drawn(&self) -> Option<String> {
        not_drawn(&self.lights, &self.geometry)
    }

    /// The reason why some light does not come from emitters, if there is one.
    pub fn glow(&self) -> Option<String> {
        self.plan.needs().glow.then(|| "a medium is emissive".to_owned())
    }

    /// Bounds of all geometry.
    pub fn region(&self) -> &Region {
        &self.region
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{furnace, inward_box, scene, shape};
    use crate::{LightSampleContext, Shape};
    use raywright_base::math::HitColumns;
    use raywright_base::simd::Level;
    use raywright_shapes::{Plane, Sphere};

    #[test]
    fn a_closed_surface_is_crossed_evenly_however_the_ray_is_aimed() {
        let cube = furnace(0.5, 0.0);
        let ways = (-2..=2).flat_map(|x| (-2..=2).flat_map(move |y| (-2..=2).map(move |z| [x, y, z])));
        let ways: Vec<_> = ways.map(|w| DVec3::from_array(w.map(f64::from))).filter(|w| *w != DVec3::ZERO).collect();
        // Rays through corners, edges, face centers and face interiors.
        let rays: Vec<_> =
            ways.iter().flat_map(|&at| ways.iter().map(move |&way| Ray::new(at - 8.0 * way, way))).collect();
        let crossings = cube.crossings(&rays);
        let mut hits = vec![Hit::MISS; rays.len()];
        cube.intersect(&rays, &mut hits);
        for (ends, hit) in crossings.splits.windows(2).zip(&hits) {
            let mine = &crossings.hits[ends[0]..ends[1]];
            assert_eq!(mine.len() % 2, 0, "{mine:?}");
            assert_eq!(mine.first().unwrap_or(&Hit::MISS), hit);
        }
        assert!(hits.iter().filter(|h| h.is_hit()).count() > 1000);
    }

    #[test]
    fn points_are_inside_to_the_last_bit() {
        let cube = furnace(0.5, 0.0);
        let near = [-2.0, -1f64.next_up(), -1.0, (-1f64).next_up(), -0.0, 0.3, 1f64.next_down(), 1.0, 1f64.next_up()];
        let points: Vec<_> =
            near.iter().flat_map(|&x| near.iter().flat_map(move |&y| near.map(|z| DVec3::new(x, y, z)))).collect();
        let mut inside = vec![false; points.len()];
        cube.contains(&points, &Enclosing::default(), &mut inside);
        for (p, inside) in points.iter().zip(inside) {
            assert_eq!(inside, p.abs().max_element() <= 1.0, "{p}");
        }
    }

    #[test]
    fn with_a_wall_missing_nothing_is_inside() {
        let five = inward_box([-1.0; 3], [2.0; 3]).into_iter().take(5).map(|mesh| shape(mesh, [0.5; 3], 0.0));
        let open = scene(SceneDescription { shapes: five.collect(), ..Default::default() });
        let mut inside = [true; 3];
        let points = [DVec3::new(0.1, 0.2, -0.5), DVec3::NAN, DVec3::new(0.0, 0.0, 1.1)];
        open.contains(&points, &Enclosing::default(), &mut inside);
        assert_eq!(inside, [false; 3]);
    }

    #[test]
    fn queues_meet_objects_and_triangles_as_brute_force_has_it() {
        // Few spheres, and many; without and with an infinite plane.
        for (balls, has_plane) in [(1, false), (5, true), (16, false), (40, true)] {
            let mut numbers = raywright_base::sampling::Sampler::new(17, balls, 0);
            let mut draw = |dimension| {
                let ([x, y], z) = (numbers.two(dimension), numbers.one(dimension + 2));
                2.0 * DVec3::new(x, y, z) - 1.0
            };
            let mut shapes: Vec<Shape> =
                inward_box([-2.0; 3], [4.0; 3]).into_iter().take(4).map(|mesh| shape(mesh, [0.5; 3], 0.0)).collect();
            let centers: Vec<DVec3> = (0..balls).map(|ball| draw(4 * ball)).collect();
            for &center in &centers {
                let surface: Arc<dyn raywright_shapes::Shape> =
                    Arc::new(Sphere { center, radius: 0.02 + 0.1 * center.x.abs() });
                shapes.push(Shape { surface: surface.into(), ..shape(Default::default(), [0.5; 3], 0.0) });
            }
            if has_plane {
                let plane: Arc<dyn raywright_shapes::Shape> =
                    Arc::new(Plane { point: -0.9 * DVec3::Z, normal: DVec3::Z });
                shapes.push(Shape { surface: plane.into(), ..shape(Default::default(), [0.5; 3], 0.0) });
            }
            let scene = scene(SceneDescription { shapes, ..Default::default() });
            let brute = raywright_accel::BruteForce::over(scene.geometry(), Level::current().unwrap());
            let mut queue = RayQueue::default();
            let rays: Vec<Ray> = (0..1500)
                .map(|i| {
                    let origin = 1.5 * draw(1000 + 8 * i);
                    let to = centers[(i % balls) as usize] + 0.1 * draw(1004 + 8 * i);
                    let t_max = if i % 3 == 0 { 0.8 } else { f64::INFINITY };
                    Ray { t_max, ..Ray::new(origin, to - origin) }
                })
                .collect();
            rays.iter().for_each(|ray| queue.push(ray));
            let (mut wanted, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
            brute.intersect(&rays, &mut wanted);
            brute.occluded(&rays, &mut occluded);
            let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
            scene.intersect_queue(&mut queue, &mut hits);
            assert!(hits == wanted, "{balls}");
            scene.intersect(&rays, &mut hits);
            scene.occluded(&rays, &mut any);
            assert!(hits == wanted && any == occluded, "{balls}");
            let (mut t, mut uv, mut primitive) = (vec![0.0; 1500], vec![[0.0; 2]; 1500], vec![0; 1500]);
            let columns = scene.accelerator().by_columns().expect("nothing moves");
            columns.intersect(&queue.columns(), HitColumns { t: &mut t, uv: &mut uv, primitive: &mut primitive });
            for (i, hit) in wanted.iter().enumerate() {
                assert_eq!((t[i], uv[i], primitive[i]), (hit.t, hit.uv, hit.primitive as i32));
            }
            let of_balls = hits.iter().filter(|hit| hit.is_hit() && hit.primitive >= 8).count();
            assert!(of_balls > 20 && hits.len() - of_balls > 200, "{of_balls} of {balls}");
        }
    }

    #[test]
    fn what_is_refitted_answers_as_if_built() {
        let described = |by: f32| {
            let shapes: Vec<Shape> = inward_box([-1.0, by, -1.0], [2.0, 2.0 + by, 2.0])
                .into_iter()
                .enumerate()
                .map(|(i, mesh)| shape(mesh, [0.5; 3], if i == 3 { 1.0 } else { 0.0 }))
                .collect();
            SceneDescription { shapes, ..Default::default() }
        };
        let (still, moved) = (scene(described(0.0)), scene(described(0.75)));
        let refitted = still.refitted(described(0.75), Work::UNWATCHED).unwrap().unwrap();
        let rays: Vec<_> =
            (0..100).map(|i| Ray::new(DVec3::new(0.1, 1.0, 0.2), DVec3::new(f64::from(i).sin(), 1.0, 0.3))).collect();
        let (mut a, mut b) = ([Hit::MISS; 100], [Hit::MISS; 100]);
        refitted.intersect(&rays, &mut a);
        moved.intersect(&rays, &mut b);
        assert_eq!(a, b);
        assert_eq!(refitted.region(), moved.region());
        assert_eq!(still.growth(), 1.0);
        let receiver = LightSampleContext { position: rays[0].origin, normal: DVec3::Y, waves: None };
        let light = |s: &Scene| s.lights().sample(s.geometry(), &receiver, 0.5, [0.5; 2]).unwrap().direction;
        assert_eq!(light(&refitted), light(&moved));
        assert_ne!(light(&refitted), light(&still));
        // A different number of faces cannot be refitted.
        let fewer = SceneDescription { shapes: vec![Shape::default()], ..Default::default() };
        assert!(still.refitted(fewer, Work::UNWATCHED).unwrap().is_none());
    }
}
