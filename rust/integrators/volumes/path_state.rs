//! Paths on their way.

use super::filled::Filled;
use super::weights::Weights;
use crate::integrators::nesting::MediumStack;
use crate::math::{DVec3, Ray};
use crate::optics::Rgb;

/// A path on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathState {
    /// Of unit direction.
    pub ray: Ray,
    pub weights: Weights,
    /// What the ray starts in.
    pub media: MediumStack<Filled>,
    /// The normal that lights were drawn by where it was scattered last ([`crate::scene::LightSampleContext`]).
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
    /// Into how many it is split where it is; 0 where it ends.
    pub splits: f64,
    /// Whether it looks about from where light is known, and has been at something sharp since.
    pub is_gathered: bool,
    pub is_sharp_since: bool,
}

impl PathState {
    /// That of a camera's ray, which starts in these media.
    pub fn of_camera(ray: Ray, media: MediumStack<Filled>) -> Self {
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
            splits: 1.0,
            is_gathered: false,
            is_sharp_since: false,
        }
    }

    /// It comes to a surface that leaves so much of its light if it has been at such a surface before
    /// ([`crate::optics::Bsdf::again`]).
    pub fn meet(&mut self, again: Rgb) {
        if again != Rgb::ONE {
            if self.gilded {
                self.weights.carried *= again;
            }
            self.gilded = true;
        }
    }
}
