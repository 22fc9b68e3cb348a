//! Precomputed transmittance of rough plastic coats.

use raywright_optics::{Facets, Through};
use std::sync::{Arc, PoisonError, RwLock};

/// Transmittance of a plastic's single-scattering coat, precomputed for each relative index of refraction that occurs.
#[derive(Debug, Default)]
pub struct Coats {
    ready: RwLock<Vec<(f64, Arc<[Through]>)>>,
}

impl Coats {
    /// Transmittance at a roughness `alpha` within `range`, which must be the same in all calls, and a relative index
    /// of refraction, inside over outside.
    pub fn through<F: Facets>(&self, range: [f64; 2], alpha: f64, eta: f64) -> Through {
        let all = self.of::<F>(range, eta);
        let [low, high] = range.map(f64::sqrt);
        let at = (alpha.sqrt() - low) / (high - low) * (all.len() - 1) as f64;
        // Also valid for an empty range.
        let below = (at.max(0.0) as usize).min(all.len().saturating_sub(2));
        match all.get(below + 1) {
            Some(above) => Through::between(&all[below], above, (at - below as f64).clamp(0.0, 1.0)),
            None => all[0],
        }
    }

    /// Transmittances at roughnesses with equally spaced square roots over a range.
    fn of<F: Facets>(&self, range: [f64; 2], eta: f64) -> Arc<[Through]> {
        let find =
            |ready: &[(f64, Arc<[Through]>)]| ready.iter().find(|(index, _)| *index == eta).map(|(_, all)| all.clone());
        // A poisoned lock is safe: a panic cannot leave a partial entry.
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

/// Number of steps over the whole range of roughness.
const STEPS: f64 = 24.0;
