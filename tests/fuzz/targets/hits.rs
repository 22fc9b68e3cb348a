//! Any rays at any triangles: every accelerator agrees with the hits triangle by triangle, bit for bit, for all queries
//! and sizes of batches.

use super::accelerators;
use super::builders::{builder, optimisers};
use super::numbers::{Range, one_of};
use super::triangles::{Triangles, rays, triangles};
use arbitrary::{Result, Unstructured};
use raywright::accel::bvh::{Options, Quality};
use raywright::accel::{Accelerator, Cost, Crossings, Primitives};
use raywright::math::{Hit, Ray, Region};
use raywright::shapes::triangle::EdgeRay;

/// Panics if accelerators disagree.
pub fn check(data: &[u8]) {
    // Missing bytes read as zero, so there is always a scene.
    let _ = scene(&mut Unstructured::new(data)).map(|(triangles, rays, options)| agree(&triangles, &rays, &options));
}

fn scene(u: &mut Unstructured) -> Result<(Triangles, Vec<Ray>, Options)> {
    let options = Options {
        quality: one_of(u, &Quality::ALL)?,
        builder: builder(u)?,
        optimisers: Some(optimisers(u)?),
        // From the smallest possible leaves to the largest.
        traversal_cost: one_of(u, &[1.0, 1e-3, 1e3])?,
        intersection_cost: 1.0,
    };
    let triangles = triangles(u, Range::Any)?;
    let rays = rays(u, &triangles)?;
    Ok((triangles, rays, options))
}

/// The closest hit, triangle by triangle: without boxes, lanes or a test in f32 before.
fn closest(triangles: &Triangles, ray: &Ray, region: &Region) -> Hit {
    let Some(edges) = EdgeRay::new(ray, region) else { return Hit::MISS };
    let mut best = Hit::MISS;
    for p in (0..triangles.count() as u32).filter(|&p| triangles.is_finite(p)) {
        if let Some(c) = edges.meet(triangles.corners(p))
            && c.t < best.t
        {
            best = Hit { t: c.t, uv: c.uv, primitive: p, inner: 0 };
        }
    }
    Hit { t: best.t * edges.scale, ..best }
}

/// A hit as bits, to tell −0 from 0.
fn bits(hit: &Hit) -> (u64, [u64; 2], u32) {
    (hit.t.to_bits(), hit.uv.map(f64::to_bits), hit.primitive)
}

fn agree(triangles: &Triangles, rays: &[Ray], options: &Options) {
    let region = triangles.region();
    let wanted: Vec<Hit> = rays.iter().map(|ray| closest(triangles, ray, &region)).collect();
    let mut every: Option<Crossings> = None;
    for (name, accelerator) in accelerators::all(triangles, options) {
        // All at once, a fan at a time, and few enough that each ray goes alone; brute force makes no difference
        // between them.
        let batches: &[usize] = if name.starts_with("brute force") { &[usize::MAX] } else { &[usize::MAX, 16, 3] };
        for &batch in batches {
            for (rays, wanted) in rays.chunks(batch).zip(wanted.chunks(batch)) {
                let mut found = vec![Hit::MISS; rays.len()];
                let mut occluded = vec![false; rays.len()];
                accelerator.intersect(rays, &mut found);
                accelerator.occluded(rays, &mut occluded);
                for (i, ray) in rays.iter().enumerate() {
                    let told = || format!("{name}, ray {i} of {batch}, {ray:?} at {triangles:?}");
                    assert_eq!(bits(&found[i]), bits(&wanted[i]), "{}", told());
                    assert_eq!(occluded[i], wanted[i].is_hit(), "{}", told());
                }
            }
        }
        let crossings = accelerator.crossings(rays);
        for (i, ray) in rays.iter().enumerate() {
            let first = crossings.hits[crossings.splits[i]..crossings.splits[i + 1]].first();
            let told = || format!("{name}, first crossing of {ray:?} at {triangles:?}");
            assert_eq!(first.map_or(bits(&Hit::MISS), bits), bits(&wanted[i]), "{}", told());
        }
        let same =
            |a: &Crossings, b: &Crossings| a.splits == b.splits && a.hits.iter().map(bits).eq(b.hits.iter().map(bits));
        let before = every.get_or_insert_with(|| crossings.clone());
        assert!(same(before, &crossings), "{name} crosses {triangles:?} with {rays:?} otherwise");
        work_is_bounded(accelerator.as_ref(), rays);
    }
}

/// No ray tests more primitives than exist, and one that cannot hit anything tests none.
fn work_is_bounded(accelerator: &dyn Accelerator, rays: &[Ray]) {
    let mut costs = vec![Cost::default(); rays.len()];
    accelerator.cost(rays, &mut costs);
    let info = accelerator.info();
    // Parts of one primitive stand in several leaves, of at most eight parts each.
    let most = if info.kind.contains("spatial splits") || info.kind.contains("pieces") {
        8 * info.leaves
    } else {
        info.primitives
    };
    for (cost, ray) in costs.iter().zip(rays) {
        assert!(cost.nodes as usize <= info.nodes && cost.primitives as usize <= most, "{ray:?}: {cost:?}");
        if !(ray.origin.is_finite() && ray.direction.is_finite()) {
            assert_eq!(*cost, Cost::default(), "{ray:?}");
        }
    }
}
