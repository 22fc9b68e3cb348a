//! Batches of surface interactions, for integrators written in Python.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Numbers, Triples, numbers, sealed, unwritten};
use super::query::CompiledScene;
use super::rays::{SplitOutput, answer, chunks, each, share};
use raywright::integrators::indices_outside;
use raywright::math::{DVec3, Hit, Ray};
use raywright::optics::{Bsdf, BsdfSample, Rgb};
use raywright::scene::{Interaction, Scene, ShadingPoint, SurfaceInteraction};

type Vectors<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Surface interactions of a batch of rays, one entry per ray, including misses.
#[pyclass(frozen, module = "raywright._core")]
pub struct Interactions {
    scene: Py<CompiledScene>,
    entries: Vec<InteractionEntry>,
}

/// The interaction of a ray.
#[derive(Clone)]
struct InteractionEntry {
    ray: Ray,
    hit: Hit,
    /// None for a miss.
    here: Option<Box<SurfaceInteraction>>,
    /// Radiance emitted along the ray.
    emission: Rgb,
    /// Cosine between the direction back along the ray and the normal.
    cosine: f64,
}

impl InteractionEntry {
    fn new(scene: &Scene, ray: Ray, hit: Hit, outside: f64) -> Self {
        if !hit.is_hit() {
            let emission = scene.lights().infinite_radiance(ray.direction);
            return Self { ray, hit, here: None, emission, cosine: 0.0 };
        }
        let surface = scene.geometry().surface(&ray, &hit);
        let cosine = -ray.direction.dot(surface.normal);
        let emission = scene.emission_at(&surface);
        let point = ShadingPoint::new(scene.geometry(), &ray, &hit, surface, emission.needs(), 0.0);
        let emission = emission.towards(cosine, &point.texture);
        let here = SurfaceInteraction::new(scene, &ray, &hit, surface, 0.0, outside);
        Self { ray, hit, here: Some(Box::new(here)), emission, cosine }
    }
}

/// An array with a row per ray, each computed by its own call.
fn filled<'py, const K: usize>(
    py: Python<'py>,
    count: usize,
    of: impl Fn(usize) -> [f64; K] + Sync,
) -> PyResult<Vectors<'py>> {
    let array = unwritten::<f64>(py, &[count], (K > 1).then_some(K))?;
    {
        let mut array = array.readwrite();
        let rows: &mut [[f64; K]] = array.as_slice_mut()?.as_chunks_mut().0;
        answer(py, count, share(count), None, rows, |start, rows| {
            for (i, row) in rows.iter_mut().enumerate() {
                *row = of(start + i);
            }
        })?;
    }
    sealed(array)
}

/// Several arrays at once.
fn all_filled<'py, const N: usize>(
    py: Python<'py>,
    count: usize,
    of: impl Fn(usize) -> ([[f64; 3]; N], f64) + Sync,
) -> PyResult<([Vectors<'py>; N], Vectors<'py>)> {
    let vectors: Vec<_> = (0..N).map(|_| unwritten::<f64>(py, &[count], Some(3))).collect::<PyResult<_>>()?;
    let vectors: [Vectors<'py>; N] = vectors.try_into().expect("as many as asked");
    let single = unwritten::<f64>(py, &[count], None)?;
    {
        let mut written = vectors.each_ref().map(|v| v.readwrite());
        let mut last = single.readwrite();
        let rows: Vec<&mut [[f64; 3]]> =
            written.iter_mut().map(|w| w.as_slice_mut().map(|s| s.as_chunks_mut().0)).collect::<Result<_, _>>()?;
        answer(py, count, share(count), None, (Columns(rows), last.as_slice_mut()?), |start, (mut rows, last)| {
            for (i, last) in last.iter_mut().enumerate() {
                let (values, one) = of(start + i);
                for (row, value) in rows.0.iter_mut().zip(values) {
                    row[i] = value;
                }
                *last = one;
            }
        })?;
    }
    for array in &vectors {
        array.readwrite().make_nonwriteable();
    }
    Ok((vectors, sealed(single)?))
}

/// Several arrays of vectors that are split together.
struct Columns<'a>(Vec<&'a mut [[f64; 3]]>);

impl SplitOutput for Columns<'_> {
    fn split(self, at: usize) -> (Self, Self) {
        let (first, others) = self.0.into_iter().map(|column| column.split_at_mut(at)).unzip();
        (Self(first), Self(others))
    }
}

/// Interactions of rays of unit direction: (N,3) origins and directions, and one time or one per ray.
#[pyfunction]
pub fn interactions<'py>(
    py: Python<'py>,
    scene: Bound<'py, CompiledScene>,
    origins: Triples<'py>,
    directions: Triples<'py>,
    time: Numbers<'py>,
) -> PyResult<Interactions> {
    let (origins, directions) = (origins.rows("origins")?, directions.rows("directions")?);
    let time = time.slice("time")?;
    let count = directions.len();
    if origins.len() != count || (time.len() != 1 && time.len() != count) {
        return Err(PyValueError::new_err(format!(
            "origins, directions and time have lengths {}, {count} and {}, expected the same",
            origins.len(),
            time.len()
        )));
    }
    let compiled = scene.get().scene();
    let made = each(py, None, chunks(count, share(count)), |(start, count)| {
        let ray = |i: usize| Ray {
            time: time[if time.len() == 1 { 0 } else { i }],
            ..Ray::new(origins.get(i), directions.get(i))
        };
        let rays: Vec<_> = (start..start + count).map(ray).collect();
        let mut hits = vec![Hit::MISS; count];
        compiled.intersect(&rays, &mut hits);
        let outside = indices_outside(compiled, &rays, &hits);
        let met = rays.into_iter().zip(hits).zip(outside);
        met.map(|((ray, hit), outside)| InteractionEntry::new(compiled, ray, hit, outside)).collect::<Vec<_>>()
    })?;
    Ok(Interactions { scene: scene.unbind(), entries: made.into_iter().flatten().collect() })
}

impl Interactions {
    /// Checks that there are as many rows as rays.
    fn check(&self, name: &str, count: usize) -> PyResult<()> {
        let expected = self.entries.len();
        if count == expected {
            return Ok(());
        }
        Err(PyValueError::new_err(format!("{name} has {count} rows, expected {expected}, one for each ray")))
    }

    fn vectors<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&SurfaceInteraction) -> DVec3 + Sync,
    ) -> PyResult<Vectors<'py>> {
        filled(py, self.entries.len(), |i| self.entries[i].here.as_ref().map_or(DVec3::NAN, |here| of(here)).to_array())
    }
}

#[pymethods]
impl Interactions {
    fn __len__(&self) -> usize {
        self.entries.len()
    }

    /// The entries at some indices.
    fn take(&self, py: Python<'_>, indices: PyReadonlyArray1<'_, i64>) -> PyResult<Self> {
        let indices = numbers("indices", &indices)?;
        let count = self.entries.len();
        if let Some(bad) = indices.iter().find(|&&i| !usize::try_from(i).is_ok_and(|i| i < count)) {
            return Err(PyValueError::new_err(format!("index {bad} is out of range for {count} rays")));
        }
        let entries = py.detach(|| indices.iter().map(|&i| self.entries[i as usize].clone()).collect());
        Ok(Self { scene: self.scene.clone_ref(py), entries })
    }

    /// Distance; infinite for a miss.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        filled(py, self.entries.len(), |i| [self.entries[i].hit.t])
    }

    #[getter]
    fn shape_id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        let geometry = self.scene.get().scene().geometry();
        let shape = |e: &InteractionEntry| e.here.as_ref().map_or(-1, |_| geometry.locate(e.hit.primitive).0 as i32);
        let array = unwritten::<i32>(py, &[self.entries.len()], None)?;
        for (to, entry) in array.readwrite().as_slice_mut()?.iter_mut().zip(&self.entries) {
            *to = shape(entry);
        }
        sealed(array)
    }

    /// Face number within its shape; −1 for a miss.
    #[getter]
    fn primitive_id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        let geometry = self.scene.get().scene().geometry();
        let primitive =
            |e: &InteractionEntry| e.here.as_ref().map_or(-1, |_| geometry.locate(e.hit.primitive).1 as i32);
        let array = unwritten::<i32>(py, &[self.entries.len()], None)?;
        for (to, entry) in array.readwrite().as_slice_mut()?.iter_mut().zip(&self.entries) {
            *to = primitive(entry);
        }
        sealed(array)
    }

    #[getter]
    fn uv<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        let uv = |e: &InteractionEntry| e.here.as_ref().map_or([f64::NAN; 2], |_| e.hit.uv);
        filled(py, self.entries.len(), |i| uv(&self.entries[i]))
    }

    /// Approximate albedo for white light.
    #[getter]
    fn albedo<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        let albedo = |here: &SurfaceInteraction| DVec3::from_array(here.bsdf().albedo().to_array());
        self.vectors(py, albedo)
    }

    /// Index of refraction of the enclosed medium; 1 if there is none.
    #[getter]
    fn ior<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        let scene = self.scene.get().scene();
        let within = |here: &SurfaceInteraction| scene.material(here.surface().shape).interior();
        let ior = |e: &InteractionEntry| {
            e.here.as_ref().map_or(f64::NAN, |here| within(here).map_or(1.0, |within| within.ior))
        };
        filled(py, self.entries.len(), |i| [ior(&self.entries[i])])
    }

    /// Incident delta direction, reflected or transmitted, and its weight; pdf is infinite if there is one.
    fn single<'py>(&self, py: Python<'py>, is_through: bool) -> PyResult<(Vectors<'py>, Vectors<'py>, Vectors<'py>)> {
        let single = |entry: &InteractionEntry| {
            let here = entry.here.as_ref()?;
            let mut found: Option<BsdfSample> = None;
            here.bsdf().delta_lobes(here.wo(), |lobe| {
                let Some(lobe) = here.to_world(lobe).filter(|lobe| lobe.is_through == is_through) else { return };
                match &mut found {
                    None => found = Some(lobe),
                    // If several components are deltas, those with another refraction are left out.
                    Some(first) if first.eta == lobe.eta => first.weight += lobe.weight,
                    Some(_) => {}
                }
            });
            found.filter(|found| !found.weight.is_black())
        };
        let ([direction, weight], pdf) = all_filled(py, self.entries.len(), |i| match single(&self.entries[i]) {
            Some(found) => ([found.wi.to_array(), found.weight.to_array()], f64::INFINITY),
            None => ([[f64::NAN; 3], [0.0; 3]], 0.0),
        })?;
        Ok((direction, weight, pdf))
    }

    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        self.vectors(py, SurfaceInteraction::position)
    }

    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        self.vectors(py, SurfaceInteraction::normal)
    }

    #[getter]
    fn shading_normal<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        self.vectors(py, SurfaceInteraction::shading_normal)
    }

    /// Radiance emitted along each ray; for a miss, that of infinite lights.
    #[getter]
    fn emission<'py>(&self, py: Python<'py>) -> PyResult<Vectors<'py>> {
        filled(py, self.entries.len(), |i| self.entries[i].emission.to_array())
    }

    /// Origins of rays along these directions.
    fn spawn_rays<'py>(&self, py: Python<'py>, directions: Triples<'py>) -> PyResult<Vectors<'py>> {
        let directions = directions.rows("directions")?;
        self.check("directions", directions.len())?;
        filled(py, self.entries.len(), |i| {
            let here = self.entries[i].here.as_ref();
            here.map_or(DVec3::NAN, |here| here.ray_origin().ray(directions.get(i)).origin).to_array()
        })
    }

    /// BSDF times cosine, and the density of `sample`.
    fn evaluate<'py>(&self, py: Python<'py>, directions: Triples<'py>) -> PyResult<(Vectors<'py>, Vectors<'py>)> {
        let directions = directions.rows("directions")?;
        self.check("directions", directions.len())?;
        let ([value], pdf) = all_filled(py, self.entries.len(), |i| match &self.entries[i].here {
            Some(here) => {
                let (value, pdf) = here.evaluate(directions.get(i));
                ([value.to_array()], pdf)
            }
            None => ([[0.0; 3]], 0.0),
        })?;
        Ok((value, pdf))
    }

    /// Directions, weights and densities, by numbers from 0 to 1: `choice` (N,) and `u` (N,2).
    fn sample_bsdf<'py>(
        &self,
        py: Python<'py>,
        choice: Numbers<'py>,
        u: Numbers<'py>,
    ) -> PyResult<(Vectors<'py>, Vectors<'py>, Vectors<'py>)> {
        let (choice, u) = (choice.slice("choice")?, u.slice("u")?.as_chunks::<2>().0);
        self.check("choice", choice.len())?;
        self.check("u", u.len())?;
        let ([direction, weight], pdf) = all_filled(py, self.entries.len(), |i| {
            let drawn = self.entries[i].here.as_ref().and_then(|here| here.sample(&mut || choice[i], u[i]));
            drawn.map_or(([[f64::NAN; 3], [0.0; 3]], 0.0), |s| ([s.wi.to_array(), s.weight.to_array()], s.pdf))
        })?;
        Ok((direction, weight, pdf))
    }

    /// Light samples: directions, weights, and visibility segments as origins and directions with `t` up to 1 or, for
    /// infinite lights, infinity; finally their densities.
    #[allow(clippy::type_complexity)]
    fn sample_light<'py>(
        &self,
        py: Python<'py>,
        choice: Numbers<'py>,
        u: Numbers<'py>,
    ) -> PyResult<([Vectors<'py>; 4], Vectors<'py>, Vectors<'py>)> {
        let (choice, u) = (choice.slice("choice")?, u.slice("u")?.as_chunks::<2>().0);
        self.check("choice", choice.len())?;
        self.check("u", u.len())?;
        let scene = self.scene.get().scene();
        let draw = |i: usize| {
            let here = self.entries[i].here.as_ref()?;
            let light = scene.lights().sample(scene.geometry(), &here.light_context(), choice[i], u[i])?;
            let ray = match &light.source {
                Some(source) => here.ray_origin().segment(source),
                None => here.ray_origin().ray(light.direction),
            };
            Some((light, ray))
        };
        let (four, pdf) = all_filled(py, self.entries.len(), |i| match draw(i) {
            Some((light, ray)) => {
                let [towards, origin, direction] = [light.direction, ray.origin, ray.direction].map(|v| v.to_array());
                ([towards, light.weight.to_array(), origin, direction], light.pdf)
            }
            None => ([[f64::NAN; 3], [0.0; 3], [f64::NAN; 3], [f64::NAN; 3]], 0.0),
        })?;
        let most = filled(py, self.entries.len(), |i| [draw(i).map_or(0.0, |(_, ray)| ray.t_max)])?;
        Ok((four, most, pdf))
    }

    /// Density with which `light` of `before` would have sampled each ray's direction.
    fn light_pdf<'py>(&self, py: Python<'py>, before: &Self) -> PyResult<Vectors<'py>> {
        self.check("before", before.entries.len())?;
        let scene = self.scene.get().scene();
        let (lights, geometry) = (scene.lights(), scene.geometry());
        filled(py, self.entries.len(), |i| {
            let InteractionEntry { ray, hit, here, emission, cosine } = &self.entries[i];
            let Some(from) = &before.entries[i].here else { return [0.0] };
            [match here {
                None => lights.infinite_pdf(&from.light_context(), ray.direction),
                Some(_) if emission.is_black() => 0.0,
                Some(_) => lights.surface_pdf(geometry, &from.light_context(), ray, hit, *cosine),
            }]
        })
    }
}
