//! The matrix of scenes with many faces: rows by rays, of which only what is hit is kept.

use super::by_rays::{Entry, Rows};
use super::{Aim, facets};
use rayon::prelude::*;
use raywright_base::work::{Stopped, Work};
use raywright_scene::Scene;

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
    let steps = work.steps(facets.len());
    let mut all = Sparse { starts: vec![0], ..Sparse::default() };
    let round = TOGETHER * rayon::current_num_threads() * 4;
    for start in (0..facets.len()).step_by(round) {
        let some: Vec<usize> = (start..(start + round).min(facets.len())).collect();
        let rows: Vec<(Vec<Entry>, u64)> = some
            .par_iter()
            .with_min_len(TOGETHER)
            .map_init(
                || Rows::new(scene, aim.seed),
                |rows, &face| {
                    let mut sent = 0;
                    if steps.is_stopped() {
                        return (Vec::new(), 0);
                    }
                    let mut row = rows.row(face as u32, &facets[face], aim, &mut sent);
                    row.sort_unstable_by_key(|entry| entry.0);
                    (row, sent)
                },
            )
            .collect();
        steps.did(rows.len())?;
        for (row, sent) in rows {
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
