//! Single-scattering energy loss of perfectly reflecting facets.

use super::{Alike, Brushed, Tables, Tabulated};
use glam::DVec3;

/// Share of white light that does not leave after one reflection, for facets of given roughness.
#[derive(Clone, Copy, Debug)]
pub struct MirrorLoss(MirrorKind);

#[derive(Clone, Copy, Debug)]
enum MirrorKind {
    Alike(Alike),
    Brushed(Brushed),
}

impl MirrorLoss {
    /// Looks up these facets.
    #[inline]
    pub fn new<F: Tabulated>(facets: F) -> Self {
        Self::with(F::TABLES, facets.alpha())
    }

    /// Looks up a roughness in these tables.
    #[inline]
    pub(super) fn with(tables: &'static Tables, alpha: [f64; 2]) -> Self {
        let [a, b] = alpha;
        Self(if a == b {
            MirrorKind::Alike(Alike::new(tables, a))
        } else {
            MirrorKind::Brushed(Brushed::new(tables, alpha))
        })
    }

    /// Loss for direction `w`: 1 − ∫ D G₂ / (4 cos θ) dω.
    #[inline]
    pub fn of(&self, w: DVec3) -> f64 {
        match &self.0 {
            MirrorKind::Alike(alike) => alike.of(w.z.abs()),
            MirrorKind::Brushed(brushed) => brushed.of(w),
        }
    }

    /// Cosine-weighted average of the loss, ∫ loss cos θ dω / π.
    #[inline]
    pub fn average(&self) -> f64 {
        match &self.0 {
            MirrorKind::Alike(alike) => alike.average(),
            MirrorKind::Brushed(brushed) => brushed.average(),
        }
    }
}
