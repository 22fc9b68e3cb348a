//! Surfaces that reflect diffusely.

use crate::roulette;
use raywright_base::math::single::{choose, cosine_hemisphere, greater, lesser, mask, to_world};
use raywright_base::math::{LANES, SingleLanes, Vec3};
use raywright_base::simd::loops;
use raywright_scene::{Scene, SurfaceBlock};
use std::f32::consts::FRAC_1_PI;

/// Reflectances of each shape's front and back.
pub(super) struct Reflectances(Vec<[Vec3; 2]>);

impl Reflectances {
    pub fn new(scene: &Scene) -> Self {
        let of =
            |shape: u32| scene.plan().diffuse(shape).map_or([Vec3::ZERO; 2], |sides| sides.map(|side| side.as_vec3()));
        Self((0..scene.geometry().shapes() as u32).map(of).collect())
    }

    /// Those of the sides that rays have met.
    #[inline]
    pub fn gather(&self, surfaces: &SurfaceBlock, reflectance: &mut SingleLanes) {
        for lane in 0..LANES {
            let side = (!surfaces.is_front[lane] & 1) as usize;
            reflectance.set(lane, self.0[surfaces.shape[lane] as usize][side]);
        }
    }
}

loops! {
    /// Draws directions by the cosine; each multiplies the throughput by the reflectance.
    pub(super) fn sample(
        normal: &SingleLanes,
        u: &[[f32; LANES]; 2],
        reflectance: &SingleLanes,
        throughput: &mut SingleLanes,
        direction: &mut SingleLanes,
        pdf: &mut [f32; LANES],
    ) {
        for i in 0..LANES {
            let local = cosine_hemisphere([u[0][i], u[1][i]]);
            direction.set(i, to_world(normal.get(i), local));
            throughput.set(i, throughput.get(i) * reflectance.get(i));
            pdf[i] = local.z * FRAC_1_PI;
        }
    }
}

loops! {
    /// Plays Russian roulette by numbers in [0, 1): what goes on has its throughput raised; of the others it is zero.
    /// `scale` is the ratio of radiance at the start of a path to that here due to the index of refraction alone.
    pub(super) fn play(chance: &[f32; LANES], scale: &[f32; LANES], throughput: &mut SingleLanes) {
        for i in 0..LANES {
            let t = throughput.get(i);
            let survival = lesser((greater(greater(t.x, t.y), t.z) * scale[i]).sqrt(), roulette::SURVIVAL as f32);
            let goes_on = mask(chance[i] < survival);
            throughput.set(i, t * choose(goes_on, 1.0 / survival, 0.0));
        }
    }
}

loops! {
    /// All bits where a path goes on.
    pub(super) fn survive(throughput: &SingleLanes, pdf: &[f32; LANES], goes_on: &mut [u32; LANES]) {
        for i in 0..LANES {
            let t = throughput.get(i);
            goes_on[i] = mask(t.x + t.y + t.z > 0.0) & mask(pdf[i] > 0.0);
        }
    }
}
