//! Instances of a prototype.

use super::instance_ray::InstanceRay;
use super::pose::{Pose, between, carried_by};
use super::prototype::Prototype;
use crate::textures::Needs;
use crate::{ShadingPoint, SurfacePoint};
use raywright_accel::{Placed, Side, Wanted};
use raywright_base::math::{DVec3, Hit, Ray, Singular};
use raywright_base::parallel;
use raywright_shapes::{Bounds, Candidate, Contact};
use std::sync::Arc;

/// An affine map of points (x, y, z, 1) by its first three rows.
pub type Matrix = [[f64; 4]; 3];

/// Instances of a prototype, each of them a primitive. An instance at rest takes 168 bytes, or 24 if all are only
/// translated.
///
/// A ray is transformed into the prototype's space and intersected by the prototype's accelerator. Hits are decided
/// exactly for that transformed ray, whichever accelerator finds the instances. Their `t` is reported, and compared
/// with the ends of the ray, for the given ray and map (`instance_ray.rs`).
#[derive(Clone, Debug)]
pub struct Instances {
    prototype: Arc<Prototype>,
    places: Arc<Places>,
}

#[derive(Debug)]
enum Places {
    /// At rest and only translated.
    Shifted(Vec<DVec3>),
    Still(Vec<Pose>),
    /// At shutter open and close; in between, matrices are interpolated entry by entry.
    Moving(Vec<[Matrix; 2]>),
}

/// A transform without an inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadTransform {
    /// Index of the transform.
    pub index: usize,
    /// The reason.
    pub why: Singular,
}

impl std::fmt::Display for BadTransform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "transform {} has no inverse: {}", self.index, self.why)
    }
}

impl std::error::Error for BadTransform {}

/// Maps all items in parallel, or returns the error of the first that fails.
fn each<A: Sync, B: Send>(
    items: &[A],
    make: impl Fn(&A) -> Result<B, Singular> + Sync,
) -> Result<Vec<B>, BadTransform> {
    parallel::collect(items.len(), |i| make(&items[i])).into_iter().collect::<Result<_, _>>().map_err(|_: Singular| {
        let failed = items.iter().enumerate().find_map(|(index, item)| Some((index, make(item).err()?)));
        let (index, why) = failed.unwrap_or((0, Singular::NotFinite));
        BadTransform { index, why }
    })
}

/// Checks that every matrix has an inverse.
///
/// # Errors
/// If one has none: the first.
pub fn check_transforms(matrices: &[Matrix]) -> Result<(), BadTransform> {
    each(matrices, |matrix| Pose::new(matrix).map(drop)).map(drop)
}

/// A finite `t` within the ray's ends.
fn some_t(ray: &Ray) -> f64 {
    if ray.t_min.is_finite() { ray.t_min } else { ray.t_max.min(0.0) }
}

/// A hit at `t` for occlusion tests, without other data.
fn anywhere(t: f64) -> Candidate {
    Candidate { t, uv: [0.0; 2], contact: Contact::Inside, inner: 0 }
}

impl Instances {
    /// Instances at rest.
    ///
    /// # Errors
    /// If a matrix has no inverse.
    pub fn new(prototype: Arc<Prototype>, matrices: &[Matrix]) -> Result<Self, BadTransform> {
        let poses = each(matrices, Pose::new)?;
        let shifts: Option<Vec<DVec3>> = poses.iter().map(Pose::shift_alone).collect();
        let places = shifts.map_or_else(|| Places::Still(poses), Places::Shifted);
        Ok(Self { prototype, places: Arc::new(places) })
    }

    /// Instances that move while the shutter is open, with a matrix at its opening and one at its closing. Every point
    /// moves on a straight line. An instance is invisible at a time when its interpolated matrix has no inverse.
    ///
    /// # Errors
    /// If one of the matrices given has no inverse.
    pub fn moving(prototype: Arc<Prototype>, matrices: Vec<[Matrix; 2]>) -> Result<Self, BadTransform> {
        each(&matrices, |[start, end]| Pose::new(start).and(Pose::new(end)))?;
        Ok(Self { prototype, places: Arc::new(Places::Moving(matrices)) })
    }

    /// The prototype.
    pub fn prototype(&self) -> &Arc<Prototype> {
        &self.prototype
    }

    /// Number of instances.
    pub fn count(&self) -> usize {
        match &*self.places {
            Places::Shifted(shifts) => shifts.len(),
            Places::Still(poses) => poses.len(),
            Places::Moving(matrices) => matrices.len(),
        }
    }

    /// Returns whether the instances move, or anything in the prototype does.
    pub fn moves(&self) -> bool {
        matches!(&*self.places, Places::Moving(_)) || self.prototype.moves()
    }

    /// Returns whether no instance moves as a whole.
    pub(crate) fn stand_still(&self) -> bool {
        !matches!(&*self.places, Places::Moving(_))
    }

    /// Memory in bytes, without the prototype's.
    pub fn bytes(&self) -> usize {
        match &*self.places {
            Places::Shifted(shifts) => size_of_val(shifts.as_slice()),
            Places::Still(poses) => size_of_val(poses.as_slice()),
            Places::Moving(matrices) => size_of_val(matrices.as_slice()),
        }
    }

    /// Pose of an instance at a time; `None` when its matrix has no inverse.
    #[inline]
    pub(crate) fn pose(&self, instance: u32, time: f64) -> Option<Pose> {
        match &*self.places {
            Places::Shifted(shifts) => Some(Pose::shifted(shifts[instance as usize])),
            Places::Still(poses) => Some(poses[instance as usize]),
            Places::Moving(matrices) => {
                let [start, end] = &matrices[instance as usize];
                Pose::new(&between(start, end, time)).ok()
            }
        }
    }

    /// Bounds of an instance at shutter open and close; interpolating them linearly bounds it in between. `None` if the
    /// prototype is empty.
    pub fn ends(&self, instance: u32) -> Option<[Bounds; 2]> {
        let inside = self.prototype.bounds()?;
        match &*self.places {
            Places::Moving(matrices) => Some(matrices[instance as usize].map(|matrix| carried_by(&matrix, &inside))),
            _ => self.pose(instance, 0.0).map(|pose| [pose.around(&inside); 2]),
        }
    }

    /// Bounds of an instance over all times.
    pub fn bounds(&self, instance: u32) -> Option<Bounds> {
        let [a, b] = self.ends(instance)?;
        Some(Bounds { min: a.min.min(b.min), max: a.max.max(b.max) })
    }

    /// See [`raywright_accel::UserGeometry::inside`].
    pub fn inside(&self, instance: u32) -> Option<Placed<'_>> {
        if self.moves() {
            return None;
        }
        let (rows, shift) = self.pose(instance, 0.0)?.to_prototype();
        let id = Arc::as_ptr(&self.prototype).addr();
        Some(Placed { id, primitives: self.prototype.geometry(), rows, shift })
    }

    /// See [`raywright_accel::UserGeometry::meet`].
    pub fn meet(&self, instance: u32, wanted: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        let place;
        let pose = match &*self.places {
            Places::Still(poses) => &poses[instance as usize],
            _ => {
                place = self.pose(instance, ray.time);
                let Some(pose) = &place else { return false };
                pose
            }
        };
        let ray = InstanceRay::new(&self.prototype, pose, ray);
        match wanted {
            Wanted::Closest => ray.closest().is_some_and(met),
            Wanted::Any => ray.is_occluded() && met(anywhere(some_t(ray.inside()))),
            Wanted::Every => {
                let hits = self.prototype.accelerator().crossings(&[ray.widened()]).hits;
                // The accelerator reports a touching hit twice; a hit with its contact is reported once here.
                let twice = hits.chunk_by(|a, b| a == b);
                let each =
                    twice.map(|same| (&same[0], if same.len() == 1 { Contact::Inside } else { Contact::Touching }));
                each.filter_map(|(hit, contact)| ray.told(hit, contact)).any(met)
            }
            Wanted::Met => ray.met(&ray.widened()).filter_map(|(hit, contact)| ray.told(&hit, contact)).any(met),
            Wanted::Side => match self.prototype.side(ray.inside()) {
                Side::Outside => false,
                Side::Inside => met(anywhere(f64::MAX)),
                Side::Surface => met(anywhere(0.0)),
            },
        }
    }

    /// The surface point where a ray hits an instance.
    ///
    /// # Panics
    /// If it does not hit.
    pub fn surface(&self, instance: u32, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let pose = self.pose(instance, ray.time).expect("what is hit has a place");
        let inside = self.prototype.surface(&pose.enter(ray), hit);
        pose.point(&inside)
    }

    /// The shading data of the point where a ray hits an instance.
    ///
    /// # Panics
    /// If it does not hit.
    pub(super) fn shading_point(
        &self,
        instance: u32,
        ray: &Ray,
        hit: &Hit,
        point: SurfacePoint,
        needs: Needs,
    ) -> ShadingPoint {
        let pose = self.pose(instance, ray.time).expect("what is hit has a place");
        pose.shading_point(self.prototype.shading_point(&pose.enter(ray), hit, needs), point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{inward_box, shape};
    use crate::{Mesh, RayOrigin, Scene, SceneDescription, Shape};
    use raywright_accel::bvh::Options;
    use raywright_accel::{Accelerator, BruteForce, Primitives, trees};
    use raywright_base::math::Vec3;
    use raywright_base::sampling::{Sampler, warp};
    use raywright_base::simd::Level;
    use raywright_base::work::Work;

    fn tree(geometry: &dyn Primitives) -> Box<dyn Accelerator> {
        trees::over(geometry, &Options::default(), Level::current().unwrap())
    }

    fn brute(geometry: &dyn Primitives) -> Box<dyn Accelerator> {
        BruteForce::over(geometry, Level::Scalar)
    }

    fn copied(instances: Instances) -> Shape {
        Shape { surface: instances.into(), ..Shape::default() }
    }

    fn compiled(shapes: Vec<Shape>, build: fn(&dyn Primitives) -> Box<dyn Accelerator>) -> Scene {
        Scene::new(SceneDescription { shapes, ..Default::default() }, build).unwrap()
    }

    fn draw(sample: u32) -> impl FnMut() -> DVec3 {
        let (mut sampler, mut dimension) = (Sampler::new(11, 0, sample), 0);
        move || {
            dimension += 1;
            warp::uniform_sphere(sampler.two(dimension)) * sampler.one(dimension + 1000).cbrt()
        }
    }

    /// An arbitrary map: sheared, mirrored, with scales 1e-6 to 1e6, up to `far` away.
    fn hostile(sample: u32, far: f64) -> Matrix {
        let mut next = draw(sample);
        let rows = DVec3::AXES.map(|axis| axis + next());
        let (scale, shift) = (next() * 6.0, next() * far);
        std::array::from_fn(|i| [0, 1, 2, 3].map(|j| if j == 3 { shift[i] } else { rows[i][j] * 10f64.powf(scale.x) }))
    }

    /// A map with moderate scale and shear.
    fn mild(sample: u32, far: f64) -> Matrix {
        let mut next = draw(sample);
        let (rows, shift) = (DVec3::AXES.map(|axis| 1.5 * axis + 0.6 * next()), next() * far);
        std::array::from_fn(|i| [rows[i].x, rows[i].y, rows[i].z, shift[i]])
    }

    fn soup(count: u32) -> Mesh {
        let mut next = draw(99);
        let corners = (0..count).flat_map(|_| {
            let middle = next();
            [0; 3].map(|_| (middle + 0.2 * next()).as_vec3())
        });
        let vertices: Vec<Vec3> = corners.collect();
        Mesh {
            vertices: vertices.into(),
            faces: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            normals: None,
            ..Mesh::default()
        }
    }

    #[test]
    fn every_structure_at_every_level_answers_alike() {
        let soup = || vec![shape(soup(200), [0.5; 3], 0.0)];
        let mut scenes = Vec::new();
        for (within, outside) in [
            (tree as fn(&dyn Primitives) -> _, tree as fn(&dyn Primitives) -> _),
            (brute, tree),
            (tree, brute),
            (brute, brute),
        ] {
            let prototype = Arc::new(Prototype::new(soup(), within).unwrap());
            let few = Instances::new(prototype.clone(), &[0, 1, 2].map(|i| mild(i, 2.0)));
            // The same nested in another prototype, among triangles; some of those move.
            let mut inner = soup();
            inner.push(copied(few.unwrap()));
            let nested = Arc::new(Prototype::new(inner, outside).unwrap());
            let place = |i: u32| -> Matrix { mild(i, 3.0) };
            let still = Instances::new(nested.clone(), &[place(5), place(6), place(5)]).unwrap();
            let moving = Instances::moving(nested, vec![[place(7), place(8)], [place(9), place(10)]]).unwrap();
            scenes.push(compiled(vec![copied(still.clone()), soup().remove(0)], within));
            scenes.push(compiled(vec![copied(still), soup().remove(0), copied(moving)], outside));
        }
        let rays: Vec<_> = (0..2000)
            .map(|i| {
                let mut next = draw(1000 + i);
                let origin = next() * 9.0;
                let ray = Ray::new(origin, next() * 4.0 - origin);
                Ray { t_max: if i % 3 == 0 { 1.0 } else { f64::INFINITY }, time: f64::from(i % 5) / 4.0, ..ray }
            })
            .collect();
        for kind in 0..2 {
            let mut wanted = vec![Hit::MISS; rays.len()];
            scenes[kind].intersect(&rays, &mut wanted);
            assert!(wanted.iter().filter(|h| h.is_hit()).count() > 100);
            let all = scenes[kind].crossings(&rays);
            for scene in scenes.iter().skip(kind).step_by(2) {
                let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
                scene.intersect(&rays, &mut hits);
                assert_eq!(hits, wanted);
                scene.occluded(&rays, &mut occluded);
                assert!(hits.iter().zip(&occluded).all(|(hit, &occluded)| hit.is_hit() == occluded));
                assert_eq!(scene.crossings(&rays), all);
                let firsts = all.splits.windows(2).map(|ends| all.hits[ends[0]..ends[1]].first().copied());
                assert!(firsts.zip(&hits).all(|(first, hit)| first.unwrap_or(Hit::MISS) == *hit));
                scene.accelerator().validate(scene.geometry()).unwrap();
            }
        }
    }

    #[test]
    fn no_ray_hits_the_copy_of_the_triangle_that_it_leaves() {
        for sample in 0..60 {
            let far = [0.0, 1.0, 1e3, 1e7][sample as usize % 4];
            let mut next = draw(sample + 500);
            let corners: Vec<Vec3> = (0..3).map(|_| (next() * 2.0 + next()).as_vec3()).collect();
            let mesh = Mesh { vertices: corners.into(), faces: vec![[0, 1, 2]], normals: None, ..Mesh::default() };
            let prototype = Arc::new(Prototype::new(vec![shape(mesh, [0.5; 3], 0.0)], brute).unwrap());
            let inner = Instances::new(prototype, &[hostile(sample + 1000, 1.0)]).unwrap();
            let nested = Arc::new(Prototype::new(vec![copied(inner)], brute).unwrap());
            let instances = Instances::new(nested, &[hostile(sample, far)]).unwrap();
            let scene = compiled(vec![copied(instances)], brute);
            let mut rays = Vec::new();
            for number in 0..100 {
                let mut sampler = Sampler::new(2, sample, number);
                let hit = Hit { t: 0.0, uv: warp::uniform_triangle(sampler.two(0)), primitive: 0, inner: 0 };
                let surface = scene.geometry().surface(&Ray::new(DVec3::ZERO, DVec3::Z), &hit);
                let direction = warp::uniform_sphere(sampler.two(1));
                let departure = RayOrigin::new(&surface);
                rays.push(departure.ray(direction));
                // Rays that graze the plane, down to an angle of 10⁻¹².
                let along = direction.cross(surface.normal).normalize();
                rays.push(departure.ray(along + surface.normal * 10f64.powf(-12.0 * sampler.one(2))));
            }
            let mut occluded = vec![false; rays.len()];
            scene.occluded(&rays, &mut occluded);
            assert_eq!(occluded.iter().filter(|&&o| o).count(), 0, "sample {sample}");
        }
    }

    #[test]
    fn points_are_inside_of_copies_to_the_last_bit() {
        let cube = || inward_box([-1.0; 3], [2.0; 3]).map(|mesh| shape(mesh, [0.5; 3], 0.0)).into();
        let prototype = Arc::new(Prototype::new(cube(), tree).unwrap());
        // A cube of side 4 around (8, 0, 0), rotated by 90 degrees, and nested in another prototype at (8, 0, 16),
        // mirrored.
        let matrix: Matrix = [[0.0, -2.0, 0.0, 8.0], [2.0, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0]];
        let once = Instances::new(prototype, &[matrix]).unwrap();
        let nested = Arc::new(Prototype::new(vec![copied(once.clone())], tree).unwrap());
        let up: Matrix = [[-1.0, 0.0, 0.0, 16.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 16.0]];
        let scene = compiled(vec![copied(once), copied(Instances::new(nested, &[up]).unwrap())], tree);
        let near = [-3.0, -2f64.next_up(), -2.0, (-2f64).next_up(), -0.0, 0.3, 2f64.next_down(), 2.0, 2f64.next_up()];
        let points = near.iter().flat_map(|&x| near.iter().flat_map(move |&y| near.map(|z| DVec3::new(x, y, z))));
        for centre in [DVec3::new(8.0, 0.0, 0.0), DVec3::new(8.0, 0.0, 16.0)] {
            let points: Vec<_> = points.clone().map(|p| p + centre).collect();
            let mut inside = vec![false; points.len()];
            scene.contains(&points, &crate::Enclosing::default(), &mut inside);
            for (p, inside) in points.iter().zip(inside) {
                assert_eq!(inside, (*p - centre).abs().max_element() <= 2.0, "{p}");
            }
        }
    }

    #[test]
    fn of_copies_upon_each_other_the_first_is_hit_and_all_are_crossed() {
        let prototype = Arc::new(Prototype::new(vec![shape(soup(20), [0.5; 3], 0.0)], tree).unwrap());
        let one = mild(3, 1.0);
        let scene = compiled(vec![copied(Instances::new(prototype, &[one; 5]).unwrap())], tree);
        let rays: Vec<_> = (0..300).map(draw).map(|mut next| Ray::new(next() * 4.0, next())).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        scene.intersect(&rays, &mut hits);
        assert!(hits.iter().any(Hit::is_hit) && hits.iter().all(|h| !h.is_hit() || h.primitive == 0));
        let all = scene.crossings(&rays);
        assert!(all.splits.iter().all(|end| end % 5 == 0));
    }

    #[test]
    fn copies_take_so_many_bytes_and_their_group_counts_once() {
        let prototype = Arc::new(Prototype::new(vec![shape(soup(1000), [0.5; 3], 0.0)], tree).unwrap());
        let count = 100_000;
        let matrices: Vec<Matrix> = (0..count)
            .map(|i| {
                let at = draw(i)() * 100.0;
                std::array::from_fn(|row| {
                    [0, 1, 2, 3].map(|j| if j == 3 { at[row] } else { f64::from(u8::from(j == row)) })
                })
            })
            .collect();
        let instances = || copied(Instances::new(prototype.clone(), &matrices).unwrap());
        let bytes = |scene: &Scene| scene.accelerator().info().bytes + scene.geometry().bytes();
        let (once, twice) = (compiled(vec![instances()], tree), compiled(vec![instances(), instances()], tree));
        let alone = prototype.bytes(&mut Vec::new());
        assert!(alone > 50_000);
        assert!(bytes(&once) - alone <= 160 * count as usize, "{}", bytes(&once) - alone);
        assert!(bytes(&twice) - alone <= 320 * count as usize);
    }

    #[test]
    fn copies_that_are_put_elsewhere_keep_their_group() {
        let prototype = Arc::new(Prototype::new(vec![shape(soup(30), [0.5; 3], 0.0)], tree).unwrap());
        let matrices = |by: u32| (0..40).map(|i| mild(i + by, 9.0)).collect::<Vec<_>>();
        let place =
            |by| vec![copied(Instances::new(prototype.clone(), &matrices(by)).unwrap()), shape(soup(5), [0.5; 3], 0.0)];
        let moving = |by| {
            let ends = matrices(by).into_iter().zip(matrices(by + 7)).map(|(a, b)| [a, b]).collect();
            vec![copied(Instances::moving(prototype.clone(), ends).unwrap())]
        };
        let rays: Vec<_> = (0..500)
            .map(|i| {
                let mut next = draw(i);
                let origin = next() * 20.0;
                Ray { time: f64::from(i) / 500.0, ..Ray::new(origin, next() * 9.0 - origin) }
            })
            .collect();
        for (before, after) in [(place(0), place(100)), (moving(0), moving(100))] {
            let still = compiled(before, tree);
            let description = SceneDescription { shapes: after.clone(), ..Default::default() };
            let (refitted, built) =
                (still.refitted(description, Work::UNWATCHED).unwrap().unwrap(), compiled(after, tree));
            let (mut a, mut b) = (vec![Hit::MISS; 500], vec![Hit::MISS; 500]);
            refitted.intersect(&rays, &mut a);
            built.intersect(&rays, &mut b);
            assert_eq!(a, b);
            assert!(a.iter().filter(|h| h.is_hit()).count() > 20);
            refitted.accelerator().validate(refitted.geometry()).unwrap();
        }
    }
}
