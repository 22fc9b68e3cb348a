//! The stage that makes paths of camera samples.

use super::worker::WavefrontWorker;
use crate::CameraSamples;
use crate::narrow_views::CameraStart;
use raywright_base::math::{DVec3, Ray};
use std::ops::Range;

impl WavefrontWorker<'_> {
    /// Stage: some of the camera's rays become paths.
    pub(super) fn start(&mut self, samples: &CameraSamples, some: Range<usize>) {
        let (queue, count) = (&mut self.paths[0], some.len());
        queue.make_room(count);
        queue.rays.len = count;
        for axis in 0..3 {
            queue.rays.origin[axis][..count].copy_from_slice(&samples.origin[axis][some.clone()]);
            for (to, &from) in queue.rays.direction[axis].iter_mut().zip(&samples.direction[axis][some.clone()]) {
                *to = from as f32;
            }
        }
        for (i, sample) in (0..).zip(&mut queue.sample[..count]) {
            *sample = i;
        }
        queue.throughput.iter_mut().for_each(|column| column[..count].fill(1.0));
        queue.pdf[..count].fill(f32::INFINITY);
        if self.extra.state {
            queue.scale[..count].fill(1.0);
            queue.flags[..count].fill(0);
        }
        if self.extra.aimed {
            queue.aimed[..count].fill(1.0);
        }
        if self.extra.time {
            queue.rays.time[..count].copy_from_slice(&samples.time[some.clone()]);
        }
        if self.extra.width {
            queue.width[..count].fill(self.footprint.width as f32);
            queue.spread[..count].fill(self.footprint.spread as f32);
        }
        if self.camera_start != CameraStart::AtCamera {
            let vector =
                |columns: &[Vec<f64>; 3], i: usize| DVec3::from_array(columns.each_ref().map(|column| column[i]));
            let ray = |i: usize| {
                let time = samples.time[i];
                Ray { time, ..Ray::new(vector(&samples.origin, i), vector(&samples.direction, i)) }
            };
            let rays: Vec<Ray> = some.clone().map(ray).collect();
            for (i, (ray, way)) in rays.iter().zip(self.camera_start.ways(self.scene, &rays)).enumerate() {
                let start = ray.at(way);
                (0..3).for_each(|axis| queue.rays.origin[axis][i] = start[axis]);
                if self.extra.width {
                    queue.width[i] = self.footprint.at(way).width as f32;
                }
            }
        }
        queue.rays.misses[..count].fill([Ray::NO_TRIANGLE; 2]);
        if let Some(samplers) = &samples.samplers {
            self.samplers.get_or_insert_with(|| samplers.clone()).take_from(samplers, some);
        }
    }
}
