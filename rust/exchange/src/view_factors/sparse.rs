//! The matrix of scenes with many faces: rows by rays, of which only what is hit is kept.

use super::by_rays::{Entry, Rows};
use super::fronts::Fronts;
use super::{Aim, facets};
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use raywright_scene::Scene;
use std::ops::Range;

/// Rows one after the other, as compressed sparse rows have it.
#[derive(Debug, Default)]
pub struct Sparse {
    /// Where each row starts, and where the last ends.
    pub starts: Vec<i64>,
    /// Which faces are seen, in rising order by row.
    pub faces: Vec<i32>,
    /// How much of each.
    pub values: Vec<f64>,
    /// Its standard error.
    pub errors: Vec<f32>,
    /// Rays that were sent.
    pub rays: u64,
}

/// Rows that a thread makes at a time.
const TOGETHER: usize = 64;

/// All rows of a scene by rays.
pub fn sparse(scene: &Scene, aim: &Aim, work: Work) -> Result<Sparse, Stopped> {
    let facets = facets(scene);
    let fronts = Fronts::new(scene);
    let steps = work.steps(facets.len());
    let mut all = Sparse { starts: vec![0], ..Sparse::default() };
    let round = TOGETHER * parallel::threads() * 4;
    for start in (0..facets.len()).step_by(round) {
        let count = round.min(facets.len() - start);
        let of_faces = |some: Range<usize>| -> Vec<(Vec<Entry>, u64)> {
            let mut rows = Rows::new(scene, &fronts, aim.seed);
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
