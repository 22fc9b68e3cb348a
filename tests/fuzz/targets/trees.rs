//! Any boxes and any triangles: trees are valid, and stay so after refits.

use super::accelerators;
use super::builders::{builder, optimisers};
use super::numbers::{Range, one_of, single_point};
use super::triangles::{Triangles, rays, triangles};
use arbitrary::{Result, Unstructured};
use raywright::accel::bvh::build::{Builder, Leaves};
use raywright::accel::bvh::optimise::{reinsertion, treelet};
use raywright::accel::bvh::{Cuts, Options, Quality, Steps};
use raywright::accel::{BruteForce, Primitives};
use raywright::math::{Aabb, DVec3, Hit};
use raywright::simd::Level;
use raywright::work::Work;

/// Panics if a tree is not valid.
pub fn check(data: &[u8]) {
    let u = &mut Unstructured::new(data);
    let _ = if u.arbitrary().unwrap_or(false) { boxes(u) } else { moved(u) };
}

/// Boxes, some of them empty, many alike; up to some thousand, enough for several threads to sort.
fn boxes(u: &mut Unstructured) -> Result<()> {
    let block = u.int_in_range(1..=Leaves::MAX_BLOCK)?;
    // Splits gain nothing for boxes, so no box is split.
    let steps = Steps {
        may_turn: false,
        cuts: Some(Cuts::and_splits(None, 8.0)),
        builder: builder(u)?,
        leaves: if u.arbitrary()? { Leaves::for_blocks(block) } else { Leaves::by_cost(block, 1.0, 1.0) },
        optimisers: optimisers(u)?,
        reinsertion: reinsertion::Options {
            rounds: u.int_in_range(0..=30)?,
            share: one_of(u, &[0.0, 0.1, 0.3, 1.0])?,
            worthwhile: one_of(u, &[0.0, 1e-4, 1e-2])?,
            block,
        },
        treelet: treelet::Options { rounds: u.int_in_range(0..=4)?, worthwhile: one_of(u, &[0.0, 1e-2])?, block },
    };
    let mut boxes = Vec::new();
    for _ in 0..u.int_in_range(0..=40)? {
        let [a, b] = [single_point(u, Range::Any)?, single_point(u, Range::Any)?];
        // NaN and infinity have no boxes: callers leave them out.
        let is_box = a.is_finite() && b.is_finite();
        let sorted = Aabb { min: a.min(b), max: a.max(b) };
        boxes.push(if !is_box || u.ratio(1, 16)? { Aabb::EMPTY } else { sorted });
    }
    let (once, copies) = (boxes.clone(), one_of(u, &[1, 1, 1, 2, 7, 40])?);
    let step = single_point(u, Range::Moderate)?;
    for i in 1..copies {
        let shift = step * i as f32;
        boxes.extend(once.iter().map(|b| Aabb { min: b.min + shift, max: b.max + shift }));
    }
    let clip = |p: u32, to: &Aabb| boxes[p as usize].intersection(*to);
    let built = steps.builder.build(&boxes, clip, &steps.leaves, Work::UNWATCHED).unwrap();
    let (improved, _) = steps.build(&boxes, clip, Work::UNWATCHED).unwrap();
    for tree in [&built, &improved] {
        let valid = if steps.builder.parts() { tree.validate_parts(&boxes, clip) } else { tree.validate(&boxes) };
        valid.unwrap_or_else(|e| panic!("{e}, of {boxes:?} by {steps:?}"));
    }
    if let Builder::Binned { .. } = steps.builder {
        // At most one split by area per level, until the median halves the rest.
        let count = boxes.iter().filter(|b| !b.is_empty()).count().max(1);
        let most = 3 * count.ilog2() as usize + 42;
        assert!(built.depth() <= most, "a depth of {} for {boxes:?} by {steps:?}", built.depth());
    }
    Ok(())
}

/// Trees over triangles, refitted to other triangles of the same count.
fn moved(u: &mut Unstructured) -> Result<()> {
    let before = triangles(u, Range::Any)?;
    let stretch = single_point(u, Range::Moderate)?.as_dvec3();
    let moved = |c: DVec3| {
        if c.is_finite() { (c * stretch + DVec3::new(stretch.y, stretch.z, stretch.x)).as_vec3().as_dvec3() } else { c }
    };
    let mut after = Triangles(before.0.iter().map(|t| t.map(moved)).collect());
    if u.arbitrary()? {
        after.0.reverse();
    }
    let rays = rays(u, &after)?;
    let options = Options { quality: one_of(u, &Quality::ALL)?, ..Options::DEFAULT };
    let mut wanted = vec![Hit::MISS; rays.len()];
    BruteForce::over(&after, Level::Scalar).intersect(&rays, &mut wanted);
    let same = (0..before.count() as u32).all(|p| before.is_finite(p) == after.is_finite(p));
    let is_single = after.is_single();
    for (name, accelerator) in accelerators::all(&before, &options) {
        let is_brute = name.starts_with("brute force");
        let keeps_precision = is_single || !accelerator.info().kind.ends_with("single");
        match accelerator.refitted(&after) {
            Ok(refitted) => {
                assert!(is_brute || same, "{name} takes other triangles");
                let mut found = vec![Hit::MISS; rays.len()];
                refitted.intersect(&rays, &mut found);
                assert_eq!(found, wanted, "{name}, refitted from {before:?} to {after:?} with {rays:?}");
            }
            Err(e) => {
                // Boxes of split triangles cannot be refitted.
                let kind = &accelerator.info().kind;
                let is_cut = kind.contains("pieces") || kind.contains("spatial splits");
                assert!(
                    is_cut || !same || !keeps_precision,
                    "{name} is not refitted from {before:?} to {after:?}: {e}"
                );
            }
        }
    }
    Ok(())
}
