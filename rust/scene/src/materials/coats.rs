//! What goes through the rough coats of plastics.

use raywright_optics::{Facets, Through};
use std::sync::{Arc, PoisonError, RwLock};

/// What goes through the coat of a plastic whose facets scatter once, made ready for each index of refraction that is
/// asked of it.
#[derive(Debug, Default)]
pub struct Coats {
    ready: RwLock<Vec<(f64, Arc<[Through]>)>>,
}

impl Coats {
    /// What goes through facets of roughness `alpha`, one within `range`, which is always the same, and the index below
    /// over that above.
    pub fn through<F: Facets>(&self, range: [f64; 2], alpha: f64, eta: f64) -> Through {
        let all = self.of::<F>(range, eta);
        let [low, high] = range.map(f64::sqrt);
        let at = (alpha.sqrt() - low) / (high - low) * (all.len() - 1) as f64;
        // Also of a range that is none.
        let below = (at.max(0.0) as usize).min(all.len().saturating_sub(2));
        match all.get(below + 1) {
            Some(above) => Through::between(&all[below], above, (at - below as f64).clamp(0.0, 1.0)),
            None => all[0],
        }
    }

    /// That of roughnesses spread evenly, by their roots, over a range.
    fn of<F: Facets>(&self, range: [f64; 2], eta: f64) -> Arc<[Through]> {
        let find =
            |ready: &[(f64, Arc<[Through]>)]| ready.iter().find(|(index, _)| *index == eta).map(|(_, all)| all.clone());
        // What panicked left nothing half done.
        if let Some(all) = find(&self.ready.read().unwrap_or_else(PoisonError::into_inner)) {
            return all;
        }
        let [low, high] = range.map(f64::sqrt);
        let steps = ((high - low) * STEPS).ceil() as usize;
        let alpha = |i: usize| (low + (high - low) * i as f64 / steps.max(1) as f64).powi(2);
        let all: Arc<[Through]> = (0..=steps).map(|i| Through::new(&F::new([alpha(i); 2]), eta)).collect();
        let mut ready = self.ready.write().unwrap_or_else(PoisonError::into_inner);
        find(&ready).unwrap_or_else(|| {
            ready.push((eta, all.clone()));
            all
        })
    }
}

/// How many parts the whole range of roughness is cut into.
const STEPS: f64 = 24.0;
