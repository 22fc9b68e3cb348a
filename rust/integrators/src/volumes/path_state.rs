//! Paths on their way.

use super::filled::Filled;
use super::weights::Weights;
use crate::nesting::MediumStack;
use crate::parting::Parting;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::Waves;
use raywright_optics::{BsdfSample, Rgb};
use raywright_scene::{Footprint, Scene, SurfacePoint};

/// A path on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathState {
    /// Of unit direction.
    pub ray: Ray,
    pub weights: Weights,
    /// What the ray starts in.
    pub media: MediumStack<Filled>,
    /// The normal that lights were drawn by where it was scattered last ([`raywright_scene::LightSampleContext`]).
    pub normal: DVec3,
    /// Density with which this direction was drawn; infinite for a camera's ray.
    pub pdf: f64,
    /// How much less radiance is here than where the path started, because of the index of refraction alone.
    pub scale: f64,
    /// How often it has been scattered.
    pub bounce: u32,
    /// Which of the branches that its sample has split into.
    pub branch: u32,
    /// Whether it has come to a surface that gives more than there is, in a channel.
    pub gilded: bool,
    /// Its wavelengths; none for red, green and blue. And whether the first is all that it carries.
    pub waves: Option<Waves>,
    pub single: bool,
    /// Whether other paths have the same, and the one that decides may be any of them.
    pub shares_waves: bool,
    /// Into how many it is split where it is; 0 where it ends.
    pub splits: f64,
    /// Whether it looks about from where light is known, and has been at something sharp since.
    pub is_gathered: bool,
    pub is_sharp_since: bool,
    /// Whether it has just been where it takes from others, and whether what it finds is shared with them
    /// ([`super::reuse`]).
    pub is_first: bool,
    pub is_shared: bool,
    /// The bundle of its neighbours where its ray starts, as far as anybody looks at a texture by its width; and the
    /// mean curvature of the surface there.
    pub footprint: Footprint,
    pub curvature: f64,
    /// How many ends of media its ray has passed ([`super::course::Going::passed`]).
    pub passed: u32,
}

impl PathState {
    /// That of a camera's ray, which starts in these media.
    pub fn of_camera(ray: Ray, media: MediumStack<Filled>, waves: Option<Waves>) -> Self {
        Self {
            ray,
            weights: Weights::START,
            media,
            normal: DVec3::ZERO,
            pdf: f64::INFINITY,
            scale: 1.0,
            bounce: 0,
            branch: 0,
            gilded: false,
            waves,
            single: false,
            shares_waves: false,
            splits: 1.0,
            is_gathered: false,
            is_sharp_since: false,
            is_first: false,
            is_shared: false,
            footprint: Footprint::default(),
            curvature: 0.0,
            passed: 0,
        }
    }

    /// It has come to a `t` of its ray, to a surface of mean curvature `curvature` or to none.
    pub fn come_to(&mut self, t: f64, curvature: f64) {
        (self.footprint, self.curvature) = (self.footprint.at(t), curvature);
    }

    /// It comes to a surface, beyond which it would be in other media: what parts its wavelengths there, if anything
    /// does, and the index of refraction around.
    pub fn parting(
        &self,
        scene: &Scene,
        surface: &SurfacePoint,
        beyond: &MediumStack<Filled>,
        outside: f64,
    ) -> (f64, Option<Parting>) {
        let Some(waves) = &self.waves else { return (outside, None) };
        let is_front = surface.is_front(&self.ray);
        let around = if is_front { &self.media } else { beyond }.dispersion();
        Parting::at(scene.material_at(surface), is_front, (outside, around), waves)
    }

    /// It goes on along a direction drawn at a surface that parts wavelengths, if they have come together so far.
    pub fn part(&mut self, parting: Option<&Parting>, wo: DVec3, next: &BsdfSample) {
        match parting {
            Some(_) if next.is_through => self.end_all_but_hero(),
            Some(parting) if !self.single => {
                let by = parting.mirrored(wo);
                self.weights.times(by, if self.shares_waves { Rgb::ONE } else { by }, Rgb::ONE);
            }
            _ => {}
        }
    }

    /// Leaves the first of its wavelengths alone, which stands for all from here on.
    pub fn end_all_but_hero(&mut self) {
        if !self.single {
            if self.shares_waves {
                self.weights.end_all_but_first();
            } else {
                self.weights.end_all_but_hero();
            }
            (self.waves, self.single) = (self.waves.map(|waves| waves.alone()), true);
        }
    }

    /// From here on it counts by itself, for all that share what it finds; roulette knows what it has lost.
    pub fn share(&mut self) {
        self.scale *= self.weights.throughput().max();
        self.weights.carried = Rgb::splat(self.weights.drawn.mean());
        self.is_shared = true;
    }

    /// It comes to a surface that leaves so much of its light if it has been at such a surface before
    /// ([`raywright_optics::Bsdf::again`]).
    pub fn meet(&mut self, again: Rgb) {
        if again != Rgb::ONE {
            if self.gilded {
                self.weights.carried *= again;
            }
            self.gilded = true;
        }
    }
}
