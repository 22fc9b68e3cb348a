//! All hits of all rays: per-chunk results joined into arrays.

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use std::mem::take;

use super::arrays::{sealed, unwritten};
use super::instances::located;
use super::rays::{RayArrays, RayBatch, chunks, each};
use raywright::math::Hit;
use raywright::scene::{Filter, Scene};

/// Hits of a chunk of rays, in ray order.
#[derive(Default)]
struct Chunk {
    /// Number of hits of each ray.
    lengths: Vec<u32>,
    hits: Vec<Hit>,
}

impl Chunk {
    fn of(scene: &Scene, rays: &RayArrays<'_>, start: usize, count: usize, filter: Option<&Filter>) -> Self {
        // Images are traced in tile order.
        let mut batches = Vec::new();
        let mut lengths = vec![0u32; count];
        rays.gathered(start, count, |batch, places| {
            let crossings = match filter {
                Some(filter) => filter.crossings(scene, batch),
                None => scene.crossings(batch),
            };
            for (at, &place) in crossings.splits.windows(2).zip(places) {
                lengths[place] = (at[1] - at[0]) as u32;
            }
            batches.push((places.to_vec(), crossings));
        });
        let mut from = 0;
        let mut starts: Vec<usize> = Vec::with_capacity(count);
        for &length in &lengths {
            starts.push(from);
            from += length as usize;
        }
        let mut hits = vec![Hit::MISS; from];
        for (places, crossings) in batches {
            for (at, place) in crossings.splits.windows(2).zip(places) {
                let mine = &crossings.hits[at[0]..at[1]];
                hits[starts[place]..][..mine.len()].copy_from_slice(mine);
            }
        }
        Self { lengths, hits }
    }
}

/// Splits (N+1,), and t (K,), shape_id (K,), primitive (K,) and uv (K,2) of all hits, and in a scene with instances
/// instance (K,).
pub type AllHits<'py> = (
    Bound<'py, PyArrayDyn<i64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<f64>>,
    Option<Bound<'py, PyArrayDyn<i32>>>,
);

/// All hits of all rays, optionally filtered.
pub fn intersect_all<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: &RayBatch<'_>,
    threads: Option<usize>,
    filter: Option<&Filter>,
) -> PyResult<AllHits<'py>> {
    let mut found = each(py, threads, chunks(rays.count(), rays.chunk()), |(start, count)| {
        rays.part(start, count, |rays, start| Chunk::of(scene, rays, start, count, filter))
    })?;
    let total: usize = found.iter().map(|chunk| chunk.hits.len()).sum();
    let (splits, t) = (unwritten(py, &[rays.count() + 1], None)?, unwritten(py, &[total], None)?);
    let (shape, primitive) = (unwritten(py, &[total], None)?, unwritten(py, &[total], None)?);
    let uv = unwritten(py, &[total], Some(2))?;
    let has_instances = scene.geometry().has_instances();
    let instance = has_instances.then(|| unwritten(py, &[total], None)).transpose()?;
    {
        let mut instance = instance.as_ref().map(|instance| instance.readwrite());
        let mut instance = instance.as_mut().map(|to| to.as_slice_mut()).transpose()?;
        let (mut splits, mut t) = (splits.readwrite(), t.readwrite());
        let (mut shape, mut primitive, mut uv) = (shape.readwrite(), primitive.readwrite(), uv.readwrite());
        let (before, mut splits) = splits.as_slice_mut()?.split_at_mut(1);
        before[0] = 0;
        let (mut t, mut shape) = (t.as_slice_mut()?, shape.as_slice_mut()?);
        let (mut primitive, mut uv) = (primitive.as_slice_mut()?, uv.as_slice_mut()?.as_chunks_mut().0);
        // Each chunk is freed once it is written, so that hits are never in memory twice.
        let mut from = 0i64;
        let places = found.iter_mut().map(take).map(|chunk| {
            let (rays, hits) = (chunk.lengths.len(), chunk.hits.len());
            let at = from;
            from += hits as i64;
            let hit = (first(&mut t, hits), first(&mut shape, hits), first(&mut primitive, hits), first(&mut uv, hits));
            let instances = instance.as_mut().map(|instance| first(instance, hits));
            (chunk, at, first(&mut splits, rays), hit, instances)
        });
        each(
            py,
            threads,
            places.collect(),
            |(chunk, mut at, splits, (t, shape, primitive, uv), mut instances): HitRows<'_>| {
                for (split, length) in splits.iter_mut().zip(chunk.lengths) {
                    at += i64::from(length);
                    *split = at;
                }
                for (i, hit) in chunk.hits.into_iter().enumerate() {
                    let (s, p) = scene.geometry().locate(hit.primitive);
                    (t[i], uv[i], shape[i], primitive[i]) = (hit.t, hit.uv, s as i32, p as i32);
                    if let Some(instances) = &mut instances {
                        (instances[i], primitive[i]) = located(scene, &hit, p as i32);
                    }
                }
            },
        )?;
    }
    Ok((sealed(splits)?, t, sealed(shape)?, sealed(primitive)?, uv, instance.map(sealed).transpose()?))
}

type HitRows<'a> = (
    Chunk,
    i64,
    &'a mut [i64],
    (&'a mut [f64], &'a mut [i32], &'a mut [i32], &'a mut [[f64; 2]]),
    Option<&'a mut [i32]>,
);

/// Splits off the first `count` elements of a slice.
fn first<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, others) = take(rest).split_at_mut(count);
    *rest = others;
    first
}

/// Number of hits of each ray.
pub fn count(scene: &Scene, rays: &RayArrays<'_>, start: usize, counts: &mut [i32]) {
    rays.gathered(start, counts.len(), |batch, places| {
        let crossings = scene.crossings(batch);
        for (at, &place) in crossings.splits.windows(2).zip(places) {
            counts[place] = (at[1] - at[0]) as i32;
        }
    });
}
