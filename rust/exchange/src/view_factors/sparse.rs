//! Sparse matrices of view factors for scenes with many faces: rows by ray tracing, with entries for hit faces only.

use super::hit_fronts::Fronts;
use super::row_sampler::{Entry, RowSampler};
use super::{Aim, facets};
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use raywright_scene::Scene;
use std::ops::Range;

/// A matrix in compressed sparse row format.
#[derive(Debug, Default)]
pub struct Sparse {
    /// The start of each row, and the end of the last one.
    pub starts: Vec<i64>,
    /// The column indices, increasing within each row.
    pub faces: Vec<i32>,
    /// The view factors.
    pub values: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f32>,
    /// The number of rays traced.
    pub rays: u64,
}

/// Rows per parallel task.
const TOGETHER: usize = 64;

/// Compute all rows of a scene by ray tracing.
pub fn sparse(scene: &Scene, aim: &Aim, work: Work) -> Result<Sparse, Stopped> {
    let facets = facets(scene);
    let fronts = Fronts::new(scene);
    let steps = work.steps(facets.len());
    let mut all = Sparse { starts: vec![0], ..Sparse::default() };
    let round = TOGETHER * parallel::threads() * 4;
    for start in (0..facets.len()).step_by(round) {
        let count = round.min(facets.len() - start);
        let of_faces = |some: Range<usize>| -> Vec<(Vec<Entry>, u64)> {
            let mut rows = RowSampler::new(scene, &fronts, aim.seed);
            let faces = (start + some.start..start + some.end).take_while(|_| !steps.is_stopped());
            let row = |face: usize| {
                let (mut row, sent) =
                    rows.row(face as u32, &facets[face], aim, |_, _, _| aim.error.unwrap_or(f64::INFINITY));
                row.sort_unstable_by_key(|entry| entry.0);
                (row, u64::from(sent))
            };
            faces.map(row).collect()
        };
        let rows = parallel::map_chunks(count, TOGETHER, of_faces);
        steps.did(count)?;
        for (row, sent) in rows.into_iter().flatten() {
            all.rays += sent;
            all.faces.extend(row.iter().map(|entry| entry.0 as i32));
            all.values.extend(row.iter().map(|entry| entry.1));
            all.errors.extend(row.iter().map(|entry| entry.2 as f32));
            all.starts.push(all.faces.len() as i64);
        }
    }
    work.done();
    Ok(all)
}
