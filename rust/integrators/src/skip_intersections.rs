//! Skipped intersections: alpha masks and nested dielectrics.

use super::boundary_queries::BoundaryQueries;
use super::nesting::{Boundary, MediumStack};
use super::shadows::opacity;
use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_scene::Scene;
use raywright_scene::materials::Interior;

/// Decides which intersections of rays exist for them.
#[derive(Default)]
pub(super) struct Passing {
    masks: bool,
    nested: bool,
    boundaries: BoundaryQueries,
}

/// The result of an intersection.
pub(super) enum Met {
    /// A skipped intersection. The ray continues in these media from the same origin, so that it skips nothing but this
    /// surface.
    Nothing(Ray, MediumStack),
    /// A surface.
    Surface {
        /// Its hit.
        hit: Hit,
        /// Index of refraction outside a closed object, or around an open one.
        outside: f64,
        /// Media of a transmitted ray.
        through: MediumStack,
    },
}

impl Passing {
    /// Make it for a scene with masks, nested media or both.
    pub fn new(masks: bool, nested: bool) -> Self {
        Self { masks, nested, ..Self::default() }
    }

    /// Return whether any intersection may be skipped.
    pub fn is_needed(&self) -> bool {
        self.masks || self.nested
    }

    /// Return whether media are nested.
    pub fn is_nested(&self) -> bool {
        self.nested
    }

    /// Start with rays and their hits.
    pub fn begin(&mut self, scene: &Scene, rays: &RayQueue, hits: &[Hit]) {
        if !self.nested {
            return;
        }
        self.boundaries.find::<Interior>(scene, (0..hits.len()).map(|i| rays.get(i)), hits);
    }

    /// Process the hit of ray number `i`. `media` are the ray's media. `chance`
    /// is a uniform number that decides masks. It is negative until first needed, when `number` draws it. After each
    /// decision its remainder is rescaled to be uniform again.
    pub fn meet(
        &self,
        scene: &Scene,
        i: usize,
        (ray, hit): (&Ray, &Hit),
        media: &MediumStack,
        chance: &mut f64,
        number: impl FnOnce() -> f64,
    ) -> Met {
        let (mut hit, mut outside, mut through) = (*hit, media.ior_around(scene, hit), *media);
        let boundary = if self.nested { self.boundaries.boundary(scene, i, (ray, &hit), media) } else { None };
        match boundary {
            None => {}
            Some((Boundary::None(media), beyond)) => return Met::Nothing(Ray { t_min: beyond, ..*ray }, media),
            Some((Boundary::Between { hit: owner, outside: ior, through: beyond }, _)) => {
                if owner.primitive != hit.primitive || owner.inner != hit.inner {
                    hit = owner;
                }
                (outside, through) = (ior, beyond);
            }
        }
        if self.masks {
            let opacity = opacity(scene, ray, &hit);
            if opacity < 1.0 && *chance < 0.0 {
                *chance = number();
            }
            if opacity < 1.0 && *chance >= opacity {
                *chance = (*chance - opacity) / (1.0 - opacity);
                return Met::Nothing(Ray { t_min: hit.t.next_up(), ..*ray }, *media);
            }
        }
        Met::Surface { hit, outside, through }
    }
}
