//! Next-event estimation: what light that was drawn brings if nothing blocks it.

use raywright_base::math::single::{choose, mask};
use raywright_base::math::{LANES, SingleLanes};
use raywright_base::simd::loops;
use raywright_scene::{LightBlock, SurfaceBlock};
use std::f32::consts::FRAC_1_PI;

/// The weight of a draw of one technique beside another (Veach and Guibas, 1995, with the exponent 2), by the ratio of
/// their densities, so that no square overflows.
#[inline(always)]
pub(super) fn power_heuristic(pdf: f32, other: f32) -> f32 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

loops! {
    /// Light samples times throughput, matte BSDF and MIS weight. `follows` is 1, or 0 if paths end there and no light
    /// is found by chance; `is_lit` is all bits where that is anything.
    pub(super) fn reflect(
        surfaces: &SurfaceBlock,
        lights: &LightBlock,
        reflectance: &SingleLanes,
        throughput: &SingleLanes,
        follows: f32,
        arriving: &mut SingleLanes,
        is_lit: &mut [u32; LANES],
    ) {
        for i in 0..LANES {
            let cosine = surfaces.normal.get(i).dot(lights.direction.get(i));
            let pdf = cosine * FRAC_1_PI;
            let all = throughput.get(i) * reflectance.get(i) * lights.weight.get(i);
            let all = all * (pdf * power_heuristic(lights.pdf[i], follows * pdf));
            let lit = mask(lights.pdf[i] > 0.0) & mask(cosine > 0.0) & mask(all.x + all.y + all.z > 0.0);
            arriving.set(i, all * choose(lit, 1.0, 0.0));
            is_lit[i] = lit;
        }
    }
}

/// The densities with which matte surfaces scatter into directions to light, over those of their draws. `follows` is 1,
/// or 0 if paths end there.
pub(super) fn compare(surfaces: &SurfaceBlock, lights: &LightBlock, follows: f32, ratio: &mut [f32; LANES]) {
    for i in 0..LANES {
        let cosine = surfaces.normal.get(i).dot(lights.direction.get(i));
        ratio[i] = choose(mask(lights.pdf[i] > 0.0), follows * cosine * FRAC_1_PI / lights.pdf[i], 0.0);
    }
}
