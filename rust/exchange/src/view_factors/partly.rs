//! Pairs that something may lie between, by rays.

use super::facet::Facet;
use super::{Aim, Sampled};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::{BatchSize, SamplerKind, warp};
use raywright_scene::{RayOrigin, Scene, SeenTriangle};
use std::f64::consts::PI;

/// Two faces, by number, and what they would exchange if nothing lay between.
pub struct Open {
    /// The one and the other.
    pub faces: [u32; 2],
    /// Its area times its view factor, unblocked.
    pub whole: f64,
}

/// No pair takes more batches.
const MOST_BATCHES: u32 = 1 << 10;

/// What of a batch would be exchanged if nothing lay between, and what is.
type Batch = [f64; 2];

/// The estimates of some pairs, one each.
///
/// A sample is a point x of the smaller triangle, drawn by area, and a direction from there to the other, drawn by
/// solid angle; it counts w = A cos θ / (π p), V times that where it is seen. Of a batch the estimate is
///
/// mean(w V) + β (whole − mean(w)),
///
/// with the share β that the *other* batches have seen. As β does not depend on the batch, the estimate has no bias
/// (control variates: Hammersley and Handscomb 1964). What is hidden wholly is 0, and what is seen wholly is exact.
pub fn sampled(scene: &Scene, facets: &[Facet], pairs: &[Open], aim: &Aim, rays: &mut u64) -> Vec<Sampled> {
    let size = BatchSize::for_budget(Some(aim.rays));
    let first = aim.rays.div_ceil(size.samples()).max(2);
    let mut batches: Vec<Vec<Batch>> = pairs.iter().map(|_| Vec::new()).collect();
    let mut found = vec![Sampled::default(); pairs.len()];
    let mut open: Vec<usize> = (0..pairs.len()).collect();
    let mut target = first;
    while !open.is_empty() {
        for some in open.chunks(64) {
            *rays += ask(scene, facets, pairs, some, target, size, aim.seed, &mut batches);
        }
        for &i in &open {
            found[i] = estimate(pairs[i].whole, &batches[i], size);
        }
        let Some(error) = aim.error else { break };
        open.retain(|&i| found[i].error > error * facets_area(facets, &pairs[i]) && target < MOST_BATCHES);
        target *= 2;
    }
    for (found, pair) in found.iter_mut().zip(pairs) {
        found.faces = pair.faces;
    }
    found
}

/// The smaller area of a pair: of its two view factors the larger one is over that.
fn facets_area(facets: &[Facet], pair: &Open) -> f64 {
    let [one, other] = pair.faces.map(|face| facets[face as usize].area);
    one.min(other)
}

/// Has some pairs have so many batches.
#[allow(clippy::too_many_arguments)]
fn ask(
    scene: &Scene,
    facets: &[Facet],
    pairs: &[Open],
    some: &[usize],
    target: u32,
    size: BatchSize,
    seed: u64,
    batches: &mut [Vec<Batch>],
) -> u64 {
    let kind = SamplerKind::Sobol(size);
    let (mut rays, mut of) = (Vec::new(), Vec::new());
    for &i in some {
        let [mut from, mut to] = pairs[i].faces;
        let pixel = (u64::from(from) * facets.len() as u64 + u64::from(to)) as u32;
        if facets[from as usize].area > facets[to as usize].area {
            (from, to) = (to, from);
        }
        let (one, other) = (&facets[from as usize], &facets[to as usize]);
        let errors = [from, to].map(|face| scene.geometry().error(face));
        let done = batches[i].len() as u32;
        batches[i].resize(target as usize, [0.0; 2]);
        for sample in done * size.samples()..target * size.samples() {
            let mut sampler = kind.sampler(seed, pixel, sample);
            let start = point(one, warp::uniform_triangle(sampler.two(1)));
            let seen = SeenTriangle::new(other.corners, start);
            let end = point(other, seen.sample(sampler.two(3)));
            let way = end - start;
            let distance = way.length();
            let (leaves, arrives) = (one.normal.dot(way) / distance, -other.normal.dot(way) / distance);
            if !(leaves > 0.0 && arrives > 0.0) {
                continue;
            }
            let weight = one.area * leaves / (PI * seen.pdf(distance, arrives));
            if !weight.is_finite() {
                continue;
            }
            let batch = sample / size.samples();
            batches[i][batch as usize][0] += weight;
            let origin = RayOrigin::off(start, errors[0], one.normal);
            let segment = origin.segment(&RayOrigin::off(end, errors[1], other.normal));
            rays.push(Ray { misses: [from, to], ..segment });
            of.push((i, batch as usize, weight));
        }
    }
    let mut hidden = vec![false; rays.len()];
    scene.occluded(&rays, &mut hidden);
    for ((i, batch, weight), hidden) in of.into_iter().zip(hidden) {
        batches[i][batch][1] += if hidden { 0.0 } else { weight };
    }
    rays.len() as u64
}

fn point(facet: &Facet, [second, third]: [f64; 2]) -> DVec3 {
    let [a, b, c] = facet.corners;
    a + (b - a) * second + (c - a) * third
}

fn estimate(whole: f64, batches: &[Batch], size: BatchSize) -> Sampled {
    let (count, each) = (batches.len() as f64, f64::from(size.samples()));
    let all = batches.iter().fold([0.0; 2], |sum, batch| [sum[0] + batch[0], sum[1] + batch[1]]);
    let mut sums = [0.0; 2];
    for [drawn, seen] in batches {
        let others = [all[0] - drawn, all[1] - seen];
        let share = if others[0] > 0.0 { (others[1] / others[0]).clamp(0.0, 1.0) } else { 1.0 };
        let value = seen / each + share * (whole - drawn / each);
        sums[0] += value;
        sums[1] += value * value;
    }
    let mean = sums[0] / count;
    let variance = (sums[1] / count - mean * mean).max(0.0) / (count - 1.0);
    // Where all rays agree, the share of those that would not is still not known to be 0: after n of them it is on
    // average 1 / (n + 2), and so is its spread (Laplace's rule of succession).
    let doubt = if all[1] == 0.0 || all[1] == all[0] { whole / (count * each + 2.0) } else { 0.0 };
    let exact = if all[1] == 0.0 { Some(0.0) } else { (all[1] == all[0]).then_some(whole) };
    Sampled { value: exact.unwrap_or(mean), error: variance.sqrt().max(doubt), ..Sampled::default() }
}
