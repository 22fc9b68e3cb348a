//! What rays come to among masks, which some of them pass, and media that lie in one another.

use super::nesting::{Boundary, MediumStack, around};
use super::shadows::opacity;
use raywright_accel::Crossings;
use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_scene::Scene;
use raywright_scene::materials::Interior;

/// Finds out which of the surfaces that rays hit are there for them.
#[derive(Default)]
pub(super) struct Passing {
    masks: bool,
    nested: bool,
    /// The parts of rays around hits of what encloses a medium, and which rays' they are.
    windows: Vec<Ray>,
    of: Vec<u32>,
    crossings: Crossings,
    /// The first of these that was not asked for.
    next: usize,
}

/// What a ray has come to.
pub(super) enum Met {
    /// Nothing that is there for it. It goes on, from the same origin so that nothing but the surface is left out, in
    /// these media.
    Nothing(Ray, MediumStack),
    /// A surface.
    Surface {
        /// Which hit has it.
        hit: Hit,
        /// The index of refraction on the other side of what it encloses, or around what encloses nothing.
        outside: f64,
        /// What a ray that goes through is in.
        through: MediumStack,
    },
}

impl Passing {
    /// For a scene that has masks, or nested media, or both.
    pub fn new(masks: bool, nested: bool) -> Self {
        Self { masks, nested, ..Self::default() }
    }

    /// Whether there is anything to find out.
    pub fn is_needed(&self) -> bool {
        self.masks || self.nested
    }

    /// Whether there are nested media.
    pub fn is_nested(&self) -> bool {
        self.nested
    }

    /// Begins with rays and what they hit.
    pub fn begin(&mut self, scene: &Scene, rays: &RayQueue, hits: &[Hit]) {
        if !self.nested {
            return;
        }
        self.windows.clear();
        self.of.clear();
        for (i, hit) in (0u32..).zip(hits) {
            if hit.is_hit()
                && let Some(window) = around::<Interior>(scene, &rays.get(i as usize), hit)
            {
                self.windows.push(window);
                self.of.push(i);
            }
        }
        self.crossings = scene.crossings(&self.windows);
        self.next = 0;
    }

    /// What ray number `i`, which hits something, has come to; asked in the order of the rays. It is in some media.
    /// `chance` is a uniform number that decides which masks it passes, negative until `number` is asked for it; given
    /// what it has decided, the rest of it is uniform again.
    pub fn meet(
        &mut self,
        scene: &Scene,
        i: usize,
        (ray, hit): (&Ray, &Hit),
        media: &MediumStack,
        chance: &mut f64,
        number: impl FnOnce() -> f64,
    ) -> Met {
        let (mut hit, mut outside, mut through) = (*hit, media.ior_around(scene, hit), *media);
        if self.of.get(self.next) == Some(&(i as u32)) {
            let window = self.next;
            self.next += 1;
            match Boundary::new(scene, ray, media, self.crossings.of_ray(window)) {
                Boundary::None(media) => {
                    return Met::Nothing(Ray { t_min: self.windows[window].t_max.next_up(), ..*ray }, media);
                }
                Boundary::Between { hit: owner, outside: ior, through: beyond } => {
                    if owner.primitive != hit.primitive || owner.inner != hit.inner {
                        hit = owner;
                    }
                    (outside, through) = (ior, beyond);
                }
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
