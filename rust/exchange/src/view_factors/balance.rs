//! Balancing of estimated rows so that they sum to a known value: to one in a closed room.

use super::Sampled;
use super::facet::Facet;
use super::hit_fronts::Fronts;
use super::proportion_error::Counts;
use super::reconcile::{Term, reconcile};
use super::row_sampler::leaving;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind};
use raywright_scene::Scene;
use std::ops::Range;

/// Number of rays that search for a way out of a room, for all its faces together, and the minimum and maximum per
/// face.
const LOOKS: usize = 1 << 16;
const LEAST: usize = 1 << 6;
const MOST: usize = 1 << 12;

/// Rays per face of an open room.
const ESTIMATE: u32 = 1 << 10;

/// Separates these random numbers from those of the rows.
const SALT: u64 = 0x9E37_79B9_7F4A_7C15;

/// The data for balancing rows: the scene, the areas of its faces, and the factors so far.
pub struct Balance<'a> {
    pub scene: &'a Scene,
    pub fronts: &'a Fronts,
    pub facets: &'a [Facet],
    pub areas: &'a [f64],
    pub factors: &'a [f64],
    pub seed: u64,
}

/// The result of balancing.
pub struct Balanced {
    /// True if each row belongs to a closed room.
    pub closed: Vec<bool>,
    /// The number of rays traced.
    pub rays: u64,
}

impl Balance<'_> {
    /// Adjust estimates to row sums: exactly one in a room that no ray leaves. In other rooms each row has an escaping
    /// fraction, which is another estimate.
    ///
    /// A room is a connected component of mutual visibility. A ray leaves it if it hits nothing or a back.
    pub fn apply(&self, sampled: &mut [Sampled]) -> Balanced {
        let count = self.areas.len();
        let rooms = self.rooms();
        let mut is_sampled = vec![false; count];
        for estimate in &*sampled {
            estimate.faces.iter().for_each(|&face| is_sampled[face as usize] = true);
        }
        let looked: Vec<u32> = (0..count as u32).filter(|&face| is_sampled[face as usize]).collect();
        let mut sizes = vec![0; count];
        looked.iter().for_each(|&face| sizes[rooms[face as usize] as usize] += 1);
        let looks = |face: u32| (LOOKS / sizes[rooms[face as usize] as usize]).clamp(LEAST, MOST) as u32;
        let lost = self.lost(&looked, looks);
        let mut is_open = vec![false; count];
        for (&face, &lost) in looked.iter().zip(&lost) {
            is_open[rooms[face as usize] as usize] |= lost > 0.0;
        }
        let of_open: Vec<u32> = looked.iter().copied().filter(|&f| is_open[rooms[f as usize] as usize]).collect();
        let lost = self.lost(&of_open, |_| ESTIMATE);
        let mut terms: Vec<Term> = sampled
            .iter()
            .map(|s| Term { rows: s.faces, value: s.value, variance: s.error * s.error, most: s.most })
            .collect();
        for (&face, lost) in of_open.iter().zip(lost) {
            let area = self.areas[face as usize];
            let variance = Counts::of(lost, f64::from(ESTIMATE)).variance((0.0, 1.0));
            terms.push(Term { rows: [face; 2], value: lost * area, variance: variance * area * area, most: area });
        }
        let wanted = self.wanted(sampled, &is_sampled);
        reconcile(&mut terms, &wanted, &self.areas.iter().map(|&a| a.max(f64::MIN_POSITIVE)).collect::<Vec<_>>());
        for (estimate, term) in sampled.iter_mut().zip(&terms) {
            estimate.value = term.value;
        }
        let closed = (0..count).map(|face| is_sampled[face] && !is_open[rooms[face] as usize]).collect();
        let rays = looked.iter().map(|&face| u64::from(looks(face))).sum::<u64>();
        Balanced { closed, rays: rays + of_open.len() as u64 * u64::from(ESTIMATE) }
    }

    /// The target sums of the estimates in each row.
    fn wanted(&self, sampled: &[Sampled], is_sampled: &[bool]) -> Vec<Option<f64>> {
        let count = self.areas.len();
        let row = |i: usize| {
            let sum = self.factors[i * count..][..count].iter().fold(0.0, |sum, factor| sum + factor);
            is_sampled[i].then(|| self.areas[i] * (1.0 - sum))
        };
        let mut wanted = parallel::collect(count, row);
        for estimate in sampled {
            let [i, j] = estimate.faces.map(|face| face as usize);
            let mut add = |row: usize| {
                if let Some(wanted) = &mut wanted[row] {
                    *wanted += estimate.value;
                }
            };
            add(i);
            if i != j {
                add(j);
            }
        }
        wanted
    }

    /// The room of each face.
    fn rooms(&self) -> Vec<u32> {
        let count = self.areas.len();
        let mut rooms = vec![u32::MAX; count];
        let mut open = Vec::new();
        for first in 0..count {
            if rooms[first] == u32::MAX {
                rooms[first] = first as u32;
                open.push(first);
            }
            while let Some(face) = open.pop() {
                let row = &self.factors[face * count..][..count];
                for (other, _) in row.iter().enumerate().filter(|(_, factor)| **factor > 0.0) {
                    if rooms[other] == u32::MAX {
                        rooms[other] = first as u32;
                        open.push(other);
                    }
                }
            }
        }
        rooms
    }

    /// The fraction of rays from each of some faces that hits nothing or a back. Rays from points where another face
    /// touches hit that face.
    fn lost(&self, faces: &[u32], rays: impl Fn(u32) -> u32 + Sync) -> Vec<f64> {
        /// Faces per parallel task.
        const TOGETHER: usize = 16;
        let kind = SamplerKind::Sobol(BatchSize::for_budget(Some(1 << BatchSize::MOST_BITS)));
        let of = |face: u32| {
            let facet = &self.facets[face as usize];
            let count = rays(face);
            let from = (face, self.areas[face as usize]);
            let draw = |number| leaving(self.scene, from, facet, &mut kind.sampler(self.seed ^ SALT, face, number));
            let drawn: Vec<(Ray, f64, DVec3)> = (0..count).map(draw).collect();
            let rays: Vec<Ray> = drawn.iter().map(|drawn| drawn.0).collect();
            let mut hits = vec![Hit::MISS; rays.len()];
            self.scene.intersect(&rays, &mut hits);
            let is_lost = |((ray, weight, place), hit): (&(Ray, f64, DVec3), &Hit)| {
                *weight > 0.0 && self.fronts.met(self.scene, (face, *place), ray, hit).is_none()
            };
            let lost = drawn.iter().zip(&hits).filter(|both| is_lost((both.0, both.1))).count();
            lost as f64 / f64::from(count)
        };
        let some = |some: Range<usize>| -> Vec<f64> { faces[some].iter().map(|&face| of(face)).collect() };
        parallel::map_chunks(faces.len(), TOGETHER, some).into_iter().flatten().collect()
    }
}
