//! Rounds of ray tracing: a pilot round estimates how many rays each pair needs.

use super::Aim;
use super::distant::Quadrature;
use super::facet::Facet;
use super::hit_fronts::Fronts;
use super::partly_visible_pairs::{Estimate, Open, Pairs, Round};
use raywright_base::parallel;
use raywright_base::simd::Level;
use raywright_base::work::{Steps, Stopped, Work};
use raywright_scene::Scene;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Number of rounds after the pilot.
const ROUNDS: u32 = 6;

/// Maximum number of rays per pair and round; a pair that had as many is finished.
const MOST: u32 = 1 << 20;

/// Pairs per parallel task: in the pilot, and in later rounds with many rays each.
const PILOTS: usize = 64;
const PAIRS: usize = 4;

/// Rows whose factors are all smaller need no better errors than for a greatest factor of this size.
pub const FAINT: f64 = 0.01;

/// Maximum total number of rays in the rounds after the pilot, without a requested error.
const BUDGET: f64 = (1u32 << 25) as f64;

/// Safety factor on the number of rays, which the pilot estimates only roughly.
const RESERVE: f64 = 1.4;

/// Estimates pairs by rays until their errors meet the aim.
///
/// Each round traces new rays, whose number follows from earlier rounds. So its estimates do not depend on the stopping
/// time. Accumulated rays, stopped once they appear to agree, would be biased.
pub struct Rounds<'a> {
    pub scene: &'a Scene,
    pub fronts: &'a Fronts,
    pub facets: &'a [Facet],
    pub aim: &'a Aim,
    /// The greatest factor of each row so far.
    pub greatest: Vec<f64>,
}

impl Rounds<'_> {
    /// The estimates of all pairs, and the number of rays traced.
    pub fn estimate(mut self, pairs: &[Open], work: Work) -> Result<(Vec<Estimate>, u64), Stopped> {
        let steps = work.steps(2 * pairs.len());
        let pilot: Vec<usize> = (0..pairs.len()).collect();
        let mut found = vec![Estimate::default(); pairs.len()];
        let rays = vec![self.aim.rays; pairs.len()];
        let mut sent = self.send(pairs, &pilot, &rays, 0, &mut found, (PILOTS, &steps))?;
        for round in 1..=ROUNDS {
            self.note(&found);
            let wanted: Vec<f64> = pairs.iter().map(|pair| self.wanted(pair)).collect();
            let budget = if self.aim.error.is_some() { f64::INFINITY } else { BUDGET - sent as f64 };
            let rays = rays_for(&found, &wanted, budget);
            let open: Vec<usize> = (0..pairs.len()).filter(|&i| rays[i] > 0).collect();
            if open.is_empty() {
                break;
            }
            sent += self.send(pairs, &open, &rays, round, &mut found, (PAIRS, &steps))?;
        }
        work.done();
        Ok((found, sent))
    }

    /// The allowed error of a pair's exchange.
    fn wanted(&self, pair: &Open) -> f64 {
        let [i, j] = pair.faces.map(|face| face as usize);
        let areas = [self.facets[i].area, self.facets[j].area];
        let absolute = self.aim.error.map_or(f64::INFINITY, |error| error * areas[0].min(areas[1]));
        let share = self.aim.relative.unwrap_or(f64::INFINITY);
        let greatest = |row: usize| self.greatest[row].max(FAINT) * self.facets[row].area;
        absolute.min(share * greatest(i).min(greatest(j)))
    }

    /// Update the greatest factor of each row.
    fn note(&mut self, found: &[Estimate]) {
        for estimate in found {
            for face in estimate.sampled.faces.map(|face| face as usize) {
                let factor = estimate.sampled.value / self.facets[face].area;
                self.greatest[face] = self.greatest[face].max(factor);
            }
        }
    }

    fn send(
        &self,
        pairs: &[Open],
        some: &[usize],
        rays: &[u32],
        round: u32,
        found: &mut [Estimate],
        (together, steps): (usize, &Steps),
    ) -> Result<u64, Stopped> {
        let sent = AtomicU64::new(0);
        let level = Level::current().unwrap_or(Level::Scalar);
        let of = Pairs { scene: self.scene, fronts: self.fronts, facets: self.facets, seed: self.aim.seed };
        let estimates = parallel::map_chunks(some.len(), together, |chunk| {
            if steps.is_stopped() {
                return Vec::new();
            }
            let first = round << 24;
            let chunk: Vec<_> = some[chunk].iter().map(|&i| (pairs[i], Round { first, rays: rays[i] })).collect();
            let mut rays = 0;
            let found = of.estimate(&mut Quadrature::new(level), &chunk, &mut rays);
            sent.fetch_add(rays, Relaxed);
            let _ = steps.did(chunk.len());
            found
        });
        if steps.is_stopped() {
            return Err(Stopped);
        }
        for (&i, estimate) in some.iter().zip(estimates.into_iter().flatten()) {
            found[i] = estimate;
        }
        Ok(sent.into_inner())
    }
}

/// The number of rays that each pair needs: none if its error is small enough. If the total exceeds the budget, a
/// common slack on the errors reduces it, and pairs with the smallest excess get none.
fn rays_for(found: &[Estimate], wanted: &[f64], budget: f64) -> Vec<u32> {
    let needed = |slack: f64| {
        found.iter().zip(wanted).map(move |(estimate, wanted)| {
            let over = estimate.sampled.error / (wanted * slack);
            // 0 over 0 is not known to be too large.
            if over.is_nan() || over <= 1.0 || estimate.rays >= MOST {
                return 0;
            }
            // If all rays agree, the error is inversely proportional to their number.
            let times = if estimate.agrees { over } else { over * over };
            let rays = f64::from(estimate.rays) * times * RESERVE;
            (rays.min(f64::from(MOST)) as u32).next_multiple_of(64)
        })
    };
    let sum = |slack: f64| needed(slack).map(f64::from).sum::<f64>();
    let mut slack = 1.0;
    if budget.is_finite() {
        while sum(slack) > budget.max(0.0) {
            slack *= 1.25;
        }
    }
    needed(slack).collect()
}
