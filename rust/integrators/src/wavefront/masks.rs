//! Stochastic alpha masks of a scene.

use crate::shadows::Shadows;
use raywright_base::math::{Hit, Ray};
use raywright_scene::Scene;

/// Per-thread state of masks.
pub(super) struct Masks {
    /// By shape, whether it may have any.
    pub shapes: Vec<bool>,
    /// Paths whose next surface is not known yet, each with a uniform number, and their rays and hits.
    pub on_way: Vec<(u32, f64)>,
    pub rays: Vec<Ray>,
    pub hits: Vec<Hit>,
    pub shadows: Shadows,
}

impl Masks {
    /// Those of a scene; `None` if it has none.
    pub fn of(scene: &Scene) -> Option<Self> {
        let has_mask = |shape| scene.geometry().instances_of(shape).is_some() || !scene.material(shape).is_opaque();
        let shapes = || (0..scene.geometry().shapes() as u32).map(has_mask).collect();
        scene.plan().needs().masks.then(|| Self {
            shapes: shapes(),
            on_way: Vec::new(),
            rays: Vec::new(),
            hits: Vec::new(),
            shadows: Shadows::default(),
        })
    }
}
