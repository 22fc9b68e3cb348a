//! Photons as maps keep them.

use crate::math::{DVec3, Vec3};
use crate::optics::Rgb;

/// Light that has come to a matt surface, in as few bytes as its numbers need.
#[derive(Clone, Copy, Debug)]
pub(super) struct StoredPhoton {
    pub position: DVec3,
    /// The unit direction that it came along.
    pub direction: Vec3,
    /// The unit geometric normal, on the side that it came to.
    pub normal: Vec3,
    power: [f32; 3],
    /// How many surfaces it has been scattered at before.
    pub bounces: u32,
}

impl StoredPhoton {
    pub fn new(position: DVec3, direction: DVec3, normal: DVec3, power: Rgb, bounces: u32) -> Self {
        let power = power.to_array().map(|x| x as f32);
        Self { position, direction: direction.as_vec3(), normal: normal.as_vec3(), power, bounces }
    }

    /// The flux that it stands for, W.
    pub fn power(&self) -> Rgb {
        Rgb::from_array(self.power.map(f64::from))
    }
}
