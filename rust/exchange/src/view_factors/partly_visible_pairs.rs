//! Ray-traced estimates of pairs of faces with potential blockers.

use super::Sampled;
use super::distant::Quadrature;
use super::facet::Facet;
use super::hit_fronts::Fronts;
use super::pair_pieces::{PairPiece, Pieces};
use super::proportion_error::Counts;
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::{BatchSize, Sampler, SamplerKind, warp};
use raywright_scene::{RayOrigin, Scene, SeenTriangle};
use std::f64::consts::PI;

/// Two faces and their unblocked exchange.
#[derive(Clone, Copy, Debug)]
pub struct Open {
    /// The numbers of the faces.
    pub faces: [u32; 2],
    /// The unblocked area times view factor.
    pub whole: f64,
}

/// The samples of a pair in a round: first index and count.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    pub first: u32,
    pub rays: u32,
}

/// An estimate, its number of rays, and whether all of them agree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate {
    pub sampled: Sampled,
    pub rays: u32,
    pub agrees: bool,
}

/// Rays traced together.
const TOGETHER: usize = 1 << 12;

/// The data shared by all estimates.
pub struct Pairs<'a> {
    pub scene: &'a Scene,
    pub fronts: &'a Fronts,
    pub facets: &'a [Facet],
    pub seed: u64,
}

/// The sums of a batch: of all weights, and of weights of mutually visible points.
type Batch = [f64; 2];

/// The running sums of a pair.
struct Tally {
    open: Open,
    size: BatchSize,
    batches: Vec<Batch>,
    counts: Counts,
}

/// A ray in flight: its pair, batch and weight.
type Sent = (usize, usize, f64);

impl Pairs<'_> {
    /// Estimate pairs, each with the number of rays of its round.
    ///
    /// A sample is a piece of the pair, chosen by its exchange w₀, a point x of its smaller part, sampled by area, and
    /// a direction from there to the larger part, sampled by solid angle. Its weight is w = A cos θ / (π p w₀), with
    /// mean 1, and V is 1 if both points are mutually visible. The estimate of a batch is
    ///
    /// whole · (mean(w V) + β (1 − mean(w))),
    ///
    /// with the visible fraction β of the *other* batches. As β does not depend on the batch, the estimate is unbiased
    /// (control variates: Hammersley and Handscomb 1964), before it is clamped between 0 and the whole.
    pub fn estimate(&self, quadrature: &mut Quadrature, pairs: &[(Open, Round)], sent: &mut u64) -> Vec<Estimate> {
        let tally = |&(open, round): &(Open, Round)| {
            let size = BatchSize::for_budget(Some(round.rays));
            let batches = round.rays.div_ceil(size.samples()).max(2) as usize;
            Tally { open, size, batches: vec![[0.0; 2]; batches], counts: Counts::default() }
        };
        let mut tallies: Vec<Tally> = pairs.iter().map(tally).collect();
        let (mut rays, mut of) = (Vec::with_capacity(TOGETHER), Vec::with_capacity(TOGETHER));
        for (i, (open, round)) in pairs.iter().enumerate() {
            let [one, other] = open.faces.map(|face| &self.facets[face as usize]);
            let pieces = Pieces::new(quadrature, one, other, open.whole);
            let (size, batches) = (tallies[i].size, tallies[i].batches.len() as u32);
            let kind = SamplerKind::Sobol(size);
            let pixel = (u64::from(open.faces[0]) * self.facets.len() as u64 + u64::from(open.faces[1])) as u32;
            for number in 0..batches * size.samples() {
                let mut sampler = kind.sampler(self.seed, pixel, round.first + number);
                let Some(piece) = pieces.at(sampler.one(0)) else { continue };
                let Some((ray, weight)) = self.draw(&mut sampler, piece, open.faces) else { continue };
                let batch = (number / size.samples()) as usize;
                let Some(ray) = ray else {
                    tallies[i].add(batch, weight, false);
                    continue;
                };
                rays.push(ray);
                of.push((i, batch, weight));
                if rays.len() == TOGETHER {
                    *sent += self.trace(&mut tallies, &mut rays, &mut of);
                }
            }
        }
        *sent += self.trace(&mut tallies, &mut rays, &mut of);
        tallies.iter().map(Tally::estimate).collect()
    }

    /// Sample a segment between both parts of a piece, and its weight; no segment if another face touches one of its
    /// ends.
    fn draw(&self, sampler: &mut Sampler, piece: &PairPiece, faces: [u32; 2]) -> Option<(Option<Ray>, f64)> {
        let [one, other] = &piece.facets;
        let start = point(one, warp::uniform_triangle(sampler.two(1)));
        let seen = SeenTriangle::new(other.corners, start);
        let end = point(other, seen.sample(sampler.two(3)));
        let way = end - start;
        let distance = way.length();
        let (leaves, arrives) = (one.normal.dot(way) / distance, -other.normal.dot(way) / distance);
        let weight = one.area * leaves / (PI * seen.pdf(distance, arrives) * piece.whole);
        if !(leaves > 0.0 && arrives > 0.0 && weight.is_finite()) {
            return None;
        }
        let misses = [faces[piece.from], faces[1 - piece.from]];
        let touching = |side: usize, place| self.fronts.touching(misses[side], place);
        if touching(0, start).or_else(|| touching(1, end)).is_some() {
            return Some((None, weight));
        }
        let errors = misses.map(|face| self.scene.geometry().error(face));
        let origin = RayOrigin::off(start, errors[0], one.normal);
        let segment = origin.segment(&RayOrigin::off(end, errors[1], other.normal));
        Some((Some(Ray { misses, ..segment }), weight))
    }

    fn trace(&self, tallies: &mut [Tally], rays: &mut Vec<Ray>, of: &mut Vec<Sent>) -> u64 {
        let mut hidden = vec![false; rays.len()];
        self.scene.occluded(rays, &mut hidden);
        for ((i, batch, weight), hidden) in of.drain(..).zip(hidden) {
            tallies[i].add(batch, weight, !hidden);
        }
        let sent = rays.len() as u64;
        rays.clear();
        sent
    }
}

impl Tally {
    fn add(&mut self, batch: usize, weight: f64, is_seen: bool) {
        self.batches[batch][0] += weight;
        self.batches[batch][1] += if is_seen { weight } else { 0.0 };
        self.counts.add(weight, is_seen);
    }

    fn estimate(&self) -> Estimate {
        let (count, each) = (self.batches.len() as f64, f64::from(self.size.samples()));
        let all = self.batches.iter().fold([0.0; 2], |sum, batch| [sum[0] + batch[0], sum[1] + batch[1]]);
        let mut sums = [0.0; 2];
        for [drawn, seen] in &self.batches {
            let others = [all[0] - drawn, all[1] - seen];
            let share = if others[0] > 0.0 { (others[1] / others[0]).clamp(0.0, 1.0) } else { 0.5 };
            let value = seen / each + share * (1.0 - drawn / each);
            sums[0] += value;
            sums[1] += value * value;
        }
        let mean = sums[0] / count;
        let between = (sums[1] / count - mean * mean).max(0.0) / (count - 1.0);
        let agrees = self.counts.agree();
        let share = if agrees { f64::from(self.counts.hits > 0.0) } else { mean.clamp(0.0, 1.0) };
        let error = self.open.whole * self.counts.variance((between, count)).sqrt();
        let sampled = Sampled { faces: self.open.faces, value: self.open.whole * share, error, most: self.open.whole };
        Estimate { sampled, rays: self.batches.len() as u32 * self.size.samples(), agrees }
    }
}

fn point(facet: &Facet, [second, third]: [f64; 2]) -> DVec3 {
    let [a, b, c] = facet.corners;
    a + (b - a) * second + (c - a) * third
}
