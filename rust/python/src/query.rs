//! Queries on a compiled scene, from arrays to arrays.

use numpy::{PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use super::accelerators;
use super::all_hits;
use super::arrays::{Numbers, Triples, numbers, rows, sealed, unwritten, writable};
use super::builds::{self, Builds};
use super::describe::Scene;
use super::hit_parts::located;
use super::hits::{ALL, HitArrays, Hits};
use super::info::AcceleratorInfo;
use super::instances;
use super::rays::{BATCH, RayArguments, answer, share, sorted_share};
use raywright::accel::{Cost, Nearest, Primitives, TangentBalls};
use raywright::integrators::optical_depths;
use raywright::math::{DVec3, Hit};
use raywright::optics::Rgb;
use raywright::scene;
use raywright::scene::media::Medium;
use raywright::work::{Watch, Work};
use raywright::workers;
use std::sync::Arc;

/// A scene ready for rays.
#[pyclass(frozen, module = "raywright._core")]
pub struct CompiledScene(
    pub scene::Scene,
    /// Objects whose addresses identify its prototypes; see `instances`.
    #[expect(dead_code, reason = "it is only held")]
    Vec<Py<PyAny>>,
    /// The Python shapes that it was compiled from.
    Py<PyAny>,
);

/// Flags of the shapes that count, and whether only front faces do.
#[derive(FromPyObject)]
struct FilterArgument(Option<Vec<bool>>, bool);

impl From<FilterArgument> for scene::Filter {
    fn from(FilterArgument(shapes, is_front_only): FilterArgument) -> Self {
        Self { shapes, is_front_only }
    }
}

/// Options of a scene's compilation: the surrounding medium, and whether shading normals are used as given.
struct Around {
    medium: Option<Arc<dyn Medium>>,
    as_given: bool,
}

impl Around {
    fn put(self, scene: scene::Scene) -> scene::Scene {
        let scene = scene.surrounded_by(self.medium);
        if self.as_given { scene.with_normals_as_given() } else { scene }
    }
}

/// Numbers of nodes and primitives.
type Costs<'py> = (Bound<'py, PyArrayDyn<i32>>, Bound<'py, PyArrayDyn<i32>>);

/// Distance, position, shape_id, primitive and uv.
type ClosestPoints<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<f64>>,
    Option<Bound<'py, PyArrayDyn<i32>>>,
);

#[pymethods]
#[allow(clippy::too_many_arguments)]
impl CompiledScene {
    /// `progress` is called now and then with the finished share of the build, and may raise to end it.
    #[new]
    #[pyo3(signature = (scene, accelerator, progress=None))]
    fn new(
        py: Python<'_>,
        scene: Scene<'_>,
        accelerator: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let build = accelerators::read(accelerator, &scene.quality)?;
        let builds = Builds::new(progress, scene.size()?);
        let shapes = scene.all_shapes.clone_ref(py);
        let around = Around { medium: scene.surrounding()?, as_given: scene.normals_as_given() };
        let (description, kept) = scene.describe(&builds)?;
        let size = builds::size(&description.shapes);
        let scene = builds.build(py, size, |work| scene::Scene::watched(description, build, work))?;
        Ok(Self(around.put(scene), kept, shapes))
    }

    fn refitted(&self, py: Python<'_>, scene: Scene<'_>) -> PyResult<Option<Self>> {
        let shapes = scene.all_shapes.clone_ref(py);
        let around = Around { medium: scene.surrounding()?, as_given: scene.normals_as_given() };
        let (description, kept) = scene.describe(&Builds::new(None, 0))?;
        let (watch, mut signal) = (Watch::default(), Ok(()));
        let look = || {
            signal = Python::attach(|py| py.check_signals());
            signal.is_ok() || {
                watch.stop();
                false
            }
        };
        let compiled = py
            .detach(|| workers::watched(None, |_| self.0.refitted(description, Work::of(&watch)), look))
            .map_err(PyRuntimeError::new_err)?;
        signal?;
        compiled
            .map(|scene| scene.map(|scene| Self(around.put(scene), kept, shapes)))
            .map_err(|e| PyValueError::new_err(e.to_string()))
    }

    #[pyo3(signature = (rays, out=None, counted=None, fields=ALL))]
    fn intersect<'py>(
        &self,
        py: Python<'py>,
        rays: RayArguments<'py>,
        out: Option<Hits<'py>>,
        counted: Option<FilterArgument>,
        fields: u32,
    ) -> PyResult<Hits<'py>> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let (scene, filter) = (&self.0, counted.map(scene::Filter::from));
        let by_columns = scene.accelerator().by_columns().filter(|_| filter.is_none());
        let chunk = if by_columns.is_some() { rays.window() } else { rays.chunk() };
        HitArrays::new(py, scene, lead, out, fields)?.written(|parts| {
            answer(py, rays.count(), chunk, threads, parts, |start, mut parts| {
                let count = parts.count;
                rays.part(start, count, |rays, start| {
                    if let Some(tree) = by_columns {
                        return rays.closest(scene.geometry(), tree, start, parts);
                    }
                    let mut hits = vec![Hit::MISS; BATCH.min(count)];
                    rays.gathered(start, count, |batch, places| {
                        let hits = &mut hits[..batch.len()];
                        match &filter {
                            Some(filter) => filter.intersect(scene, batch, false, hits),
                            None => scene.intersect(batch, hits),
                        }
                        parts.write(scene, hits, places);
                    });
                });
            })
        })
    }

    /// `intersect` for plain rays on meshes; `None` for others.
    fn intersect_plain<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: &Bound<'py, PyAny>,
        t_max: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Hits<'py>>> {
        if self.curved() {
            return Ok(None);
        }
        let rays = RayArguments::plain([origins, directions, t_min, t_max]);
        rays.map(|rays| self.intersect(origins.py(), rays, None, None, ALL)).transpose()
    }

    /// `occluded` for plain rays; `None` for others.
    fn occluded_plain<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: &Bound<'py, PyAny>,
        t_max: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyArrayDyn<bool>>>> {
        let rays = RayArguments::plain([origins, directions, t_min, t_max]);
        rays.map(|rays| self.occluded(origins.py(), rays, None, None)).transpose()
    }

    #[pyo3(signature = (rays, out=None, counted=None))]
    fn occluded<'py>(
        &self,
        py: Python<'py>,
        rays: RayArguments<'py>,
        out: Option<Bound<'py, PyArrayDyn<bool>>>,
        counted: Option<FilterArgument>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let out = out.map_or_else(|| unwritten(py, lead, None), Ok)?;
        {
            let mut out = writable("out", &out, lead, None)?;
            let (scene, filter) = (&self.0, counted.map(scene::Filter::from));
            let by_columns = scene.accelerator().by_columns().filter(|_| filter.is_none());
            let chunk = if by_columns.is_some() { rays.window() } else { rays.chunk() };
            answer(py, rays.count(), chunk, threads, out.as_slice_mut()?, |start, out| {
                let count = out.len();
                rays.part(start, count, |rays, start| {
                    if let Some(tree) = by_columns {
                        return rays.occluded(tree, start, out);
                    }
                    let mut found = vec![false; BATCH.min(count)];
                    let mut hits = vec![Hit::MISS; if filter.is_some() { found.len() } else { 0 }];
                    rays.gathered(start, count, |batch, places| {
                        let found = &mut found[..batch.len()];
                        match &filter {
                            Some(filter) => {
                                let hits = &mut hits[..batch.len()];
                                filter.intersect(scene, batch, true, hits);
                                found.iter_mut().zip(hits).for_each(|(found, hit)| *found = hit.is_hit());
                            }
                            None => scene.occluded(batch, found),
                        }
                        for (&found, &i) in found.iter().zip(places) {
                            out[i] = found;
                        }
                    });
                });
            })?;
        }
        Ok(out)
    }

    fn optical_depth<'py>(&self, py: Python<'py>, rays: RayArguments<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let out = unwritten::<f64>(py, lead, Some(3))?;
        let has_media = self.0.plan().needs().media;
        {
            let mut out = out.readwrite();
            let rows: &mut [[f64; 3]] = out.as_slice_mut()?.as_chunks_mut().0;
            answer(py, rays.count(), rays.chunk(), threads, rows, |start, rows| {
                let count = rows.len();
                let mut depths = vec![Rgb::ZERO; BATCH.min(count)];
                rays.part(start, count, |rays, start| {
                    rays.gathered(start, count, |batch, places| {
                        let depths = &mut depths[..batch.len()];
                        if has_media {
                            optical_depths(&self.0, batch, depths);
                        }
                        for (depth, &i) in depths.iter().zip(places) {
                            rows[i] = depth.to_array();
                        }
                    });
                });
            })?;
        }
        Ok(out)
    }

    #[pyo3(signature = (rays, counted=None))]
    fn intersect_all<'py>(
        &self,
        py: Python<'py>,
        rays: RayArguments<'py>,
        counted: Option<FilterArgument>,
    ) -> PyResult<all_hits::AllHits<'py>> {
        all_hits::intersect_all(py, &self.0, &rays.rays()?, rays.threads, counted.map(scene::Filter::from).as_ref())
    }

    fn count_hits<'py>(&self, py: Python<'py>, rays: RayArguments<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let out = unwritten(py, lead, None)?;
        answer(py, rays.count(), rays.chunk(), threads, out.readwrite().as_slice_mut()?, |start, out| {
            rays.part(start, out.len(), |rays, start| all_hits::count(&self.0, rays, start, out));
        })?;
        Ok(out)
    }

    fn traversal_cost<'py>(&self, py: Python<'py>, rays: RayArguments<'py>) -> PyResult<Costs<'py>> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let (nodes, primitives) = (unwritten(py, lead, None)?, unwritten(py, lead, None)?);
        {
            let (mut nodes, mut primitives) = (nodes.readwrite(), primitives.readwrite());
            let parts = (nodes.as_slice_mut()?, primitives.as_slice_mut()?);
            answer(py, rays.count(), rays.chunk(), threads, parts, |start, (nodes, primitives)| {
                let count = nodes.len();
                let mut costs = vec![Cost::default(); BATCH.min(count)];
                rays.part(start, count, |rays, start| {
                    rays.gathered(start, count, |batch, places| {
                        let costs = &mut costs[..batch.len()];
                        self.0.cost(batch, costs);
                        for (cost, &i) in costs.iter().zip(places) {
                            (nodes[i], primitives[i]) = (cost.nodes as i32, cost.primitives as i32);
                        }
                    });
                });
            })?;
        }
        Ok((sealed(nodes)?, sealed(primitives)?))
    }

    #[pyo3(signature = (points, shape, threads, shapes=None, tolerance=None, is_even_odd=false))]
    fn contains<'py>(
        &self,
        py: Python<'py>,
        points: Triples<'py>,
        shape: Vec<usize>,
        threads: Option<usize>,
        shapes: Option<Vec<bool>>,
        tolerance: Option<f64>,
        is_even_odd: bool,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let points = points.rows("points")?;
        let out = unwritten(py, &shape, None)?;
        let count = shape.iter().product();
        let enclosing = scene::Enclosing { shapes, tolerance, is_even_odd };
        // Computed once, before threads use it.
        py.detach(|| self.0.solids(&enclosing));
        answer(py, count, share(count), threads, out.readwrite().as_slice_mut()?, |start, out| {
            let some: Vec<_> = (start..start + out.len()).map(|i| points.get(i)).collect();
            self.0.contains(&some, &enclosing, out);
        })?;
        Ok(out)
    }

    /// Meshes whose normals point inwards.
    #[pyo3(signature = (shapes=None, tolerance=None))]
    fn inverted(&self, py: Python<'_>, shapes: Option<Vec<bool>>, tolerance: Option<f64>) -> Vec<u32> {
        py.detach(|| self.0.solids(&scene::Enclosing { shapes, tolerance, is_even_odd: false }).inverted().to_vec())
    }

    #[pyo3(signature = (points, max_distance, shape, threads, shapes=None))]
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        points: Triples<'py>,
        max_distance: Numbers<'py>,
        shape: Vec<usize>,
        threads: Option<usize>,
        shapes: Option<Vec<bool>>,
    ) -> PyResult<ClosestPoints<'py>> {
        let (points, most) = (points.rows("points")?, max_distance.slice("max_distance")?);
        let (count, lead) = (shape.iter().product(), &shape);
        if [points.len(), most.len()].iter().any(|&n| n != 1 && n != count) {
            let lengths = [points.len(), most.len()];
            return Err(PyValueError::new_err(format!(
                "points and max_distance have lengths {lengths:?}, expected 1 or {count}"
            )));
        }
        let (distance, position) = (unwritten(py, lead, None)?, unwritten(py, lead, Some(3))?);
        let (shape, primitive, uv) =
            (unwritten(py, lead, None)?, unwritten(py, lead, None)?, unwritten(py, lead, Some(2))?);
        let instance = match self.0.geometry().has_instances() {
            true => Some(unwritten(py, lead, None)?),
            false => None,
        };
        {
            let mut to_instance = instance.as_ref().map(|to| to.readwrite());
            let instances = to_instance.as_mut().map(|to| to.as_slice_mut()).transpose()?;
            let (mut distance, mut position) = (distance.readwrite(), position.readwrite());
            let (mut shape, mut primitive, mut uv) = (shape.readwrite(), primitive.readwrite(), uv.readwrite());
            let numbers = (shape.as_slice_mut()?, primitive.as_slice_mut()?);
            let (position, uv) = (position.as_slice_mut()?.as_chunks_mut().0, uv.as_slice_mut()?.as_chunks_mut().0);
            let parts = ((distance.as_slice_mut()?, position, numbers, uv), instances);
            let scene = &self.0;
            answer(py, count, sorted_share(count, threads)?, threads, parts, |start, (parts, mut instance)| {
                let (distance, position, (shape, primitive), uv) = parts;
                let some = start..start + distance.len();
                let of = |n: usize, i: usize| if n == 1 { 0 } else { i };
                let places: Vec<_> = some.clone().map(|i| points.get(of(points.len(), i))).collect();
                let within: Vec<_> = some.map(|i| most[of(most.len(), i)]).collect();
                let mut found = vec![Nearest::MISS; places.len()];
                scene.nearest(&places, &within, shapes.as_deref(), &mut found);
                for (i, nearest) in found.iter().enumerate() {
                    (distance[i], position[i], uv[i]) = (nearest.distance, nearest.position.to_array(), nearest.uv);
                    (shape[i], primitive[i]) = located(scene, nearest.primitive);
                    if let Some(instance) = &mut instance {
                        let Nearest { primitive: number, inner, .. } = *nearest;
                        let hit = Hit { primitive: number, inner, ..Hit::MISS };
                        (instance[i], primitive[i]) = instances::located(scene, &hit, primitive[i]);
                    }
                }
            })?;
        }
        let instance = instance.map(sealed).transpose()?;
        Ok((distance, position, sealed(shape)?, sealed(primitive)?, uv, instance))
    }

    /// Radii of the largest spheres, up to `radius`, that touch meshes at points, have centers along unit vectors from
    /// there, and contain no triangle.
    fn tangent_balls<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        ways: PyReadonlyArray2<'py, f64>,
        radius: PyReadonlyArray1<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (points, ways) = (rows::<f64, 3>("points", &points)?, rows::<f64, 3>("ways", &ways)?);
        let radius = numbers("radius", &radius)?;
        let count = radius.len();
        if [points.len(), ways.len()] != [count; 2] {
            return Err(PyValueError::new_err(format!("points and ways must be {count}, one for each radius")));
        }
        let geometry = self.0.geometry();
        let tree = py.detach(|| {
            let triangles = (0..Primitives::count(geometry) as u32).map(|i| Primitives::corners(geometry, i));
            TangentBalls::new(triangles)
        });
        let out = unwritten(py, &[count], None)?;
        answer(py, count, (count / 256).clamp(16, BATCH), threads, out.readwrite().as_slice_mut()?, |start, out| {
            for (i, to) in (start..).zip(out) {
                let (point, way) = (DVec3::from_array(points[i]), DVec3::from_array(ways[i]));
                *to = tree.radius(point, way, radius[i]);
            }
        })?;
        Ok(out)
    }

    fn positions<'py>(
        &self,
        py: Python<'py>,
        shape_id: PyReadonlyArray1<'py, i32>,
        primitive: PyReadonlyArray1<'py, i32>,
        uv: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let uv = rows("uv", &uv)?;
        self.of_primitives(py, &shape_id, &primitive, |geometry, p, i| geometry.position(p, uv[i]).to_array())
    }

    fn sites<'py>(
        &self,
        py: Python<'py>,
        shape_id: PyReadonlyArray1<'py, i32>,
        primitive: PyReadonlyArray1<'py, i32>,
        uv: PyReadonlyArray2<'py, f64>,
        position: PyReadonlyArray2<'py, f64>,
        instance: Option<PyReadonlyArray1<'py, i32>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (uv, position) = (rows("uv", &uv)?, rows("position", &position)?);
        let instance = instance.as_ref().map(|instance| numbers("instance_id", instance)).transpose()?;
        // For a shape of instances, primitives are numbered by instance; those inside come from `primitive`.
        let copy_of = |i: usize| instance.and_then(|all| u32::try_from(all[i]).ok());
        let inside = numbers("primitive_id", &primitive)?.to_vec();
        let which: Vec<i32> = (0..inside.len()).map(|i| copy_of(i).map_or(inside[i], |copy| copy as i32)).collect();
        let which = numpy::PyArray1::from_vec(py, which).readonly();
        self.of_primitives(py, &shape_id, &which, |geometry, p, i| {
            let inner = copy_of(i).map_or(0, |_| inside[i] as u32);
            let (normal, error) = geometry.site(p, inner, DVec3::from_array(position[i]), uv[i]);
            [normal.x, normal.y, normal.z, error]
        })
    }

    fn normals<'py>(
        &self,
        py: Python<'py>,
        shape_id: PyReadonlyArray1<'py, i32>,
        primitive: PyReadonlyArray1<'py, i32>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.of_primitives(py, &shape_id, &primitive, |geometry, p, _| geometry.normal(p).to_array())
    }

    fn errors<'py>(
        &self,
        py: Python<'py>,
        shape_id: PyReadonlyArray1<'py, i32>,
        primitive: PyReadonlyArray1<'py, i32>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.of_primitives(py, &shape_id, &primitive, |geometry, p, _| [geometry.error(p)])
    }

    /// The Python shapes that it was compiled from.
    #[getter]
    fn shapes(&self, py: Python<'_>) -> Py<PyAny> {
        self.2.clone_ref(py)
    }

    #[getter]
    fn growth(&self) -> f64 {
        self.0.growth()
    }

    #[getter]
    fn accelerator(&self) -> AcceleratorInfo {
        AcceleratorInfo(self.0.accelerator().info().clone())
    }

    /// Returns whether any shape is not a mesh.
    #[getter]
    fn curved(&self) -> bool {
        self.0.geometry().first_other().is_some()
    }

    #[getter]
    fn dropped(&self) -> usize {
        self.0.geometry().dropped()
    }

    /// Returns whether rounding to f32 has moved vertices.
    #[getter]
    fn is_rounded(&self) -> bool {
        self.0.geometry().is_single() && self.0.geometry().rounding().moved > 0.0
    }

    /// Displacement of vertices by rounding to f32, and its share of the mesh's extent, if it is a loss.
    #[getter]
    fn loss(&self) -> Option<(f64, f64)> {
        self.0.plan().loss().map(|rounding| (rounding.moved, rounding.share()))
    }

    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let bounds = self.0.region();
        if bounds.is_empty() {
            return Ok(None);
        }
        let corners = [bounds.min, bounds.max].map(|c| c.to_array().to_vec());
        Ok(Some(PyArray2::from_vec2(py, &corners)?))
    }

    #[getter]
    fn bytes(&self) -> usize {
        self.0.accelerator().info().bytes + self.0.geometry().bytes()
    }
}

impl CompiledScene {
    pub(super) fn scene(&self) -> &scene::Scene {
        &self.0
    }

    /// `K` numbers of each primitive, NaN for misses.
    fn of_primitives<'py, const K: usize>(
        &self,
        py: Python<'py>,
        shape_id: &PyReadonlyArray1<'py, i32>,
        primitive: &PyReadonlyArray1<'py, i32>,
        numbers_of: impl Fn(&scene::Geometry, u32, usize) -> [f64; K] + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (shape, primitive) = (numbers("shape_id", shape_id)?, numbers("primitive_id", primitive)?);
        let count = primitive.len();
        let out = unwritten(py, &[count], Some(K))?;
        {
            let geometry = self.0.geometry();
            let mut out = out.readwrite();
            answer(py, count, share(count), None, out.as_slice_mut()?.as_chunks_mut().0, |start, out| {
                for (i, to) in out.iter_mut().enumerate() {
                    let i = start + i;
                    *to = match (u32::try_from(shape[i]), u32::try_from(primitive[i])) {
                        (Ok(shape), Ok(primitive)) => {
                            numbers_of(geometry, geometry.primitives_of(shape).start + primitive, i)
                        }
                        _ => [f64::NAN; K],
                    };
                }
            })?;
        }
        Ok(out)
    }
}
