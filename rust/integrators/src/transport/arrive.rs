//! What rays come to.

use super::carried::Carried;
use super::path_state::PathState;
use super::worker::TransportWorker;
use crate::CameraSample;
use crate::dimensions::Dimensions;
use crate::nesting::MediumStack;
use crate::skip_intersections::Met;
use raywright_base::math::Ray;
use raywright_optics::Rgb;
use raywright_scene::Plan;

impl TransportWorker<'_> {
    /// Sorts paths by what their rays have come to, so that blocks of them scatter by one kind of function: those that
    /// leave the scene take what light comes from there, and those that pass what they hit go on at once.
    pub(super) fn arrive(&mut self, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        let mut arrivals = std::mem::take(&mut self.arrivals);
        arrivals.kinds.iter_mut().for_each(Vec::clear);
        let is_nested = self.passing.is_nested();
        self.passing.begin(self.scene, &self.now.rays, &self.hits);
        if is_nested {
            arrivals.boundaries.resize(self.now.rays.len(), (1.0, MediumStack::NONE));
        }
        for i in 0..self.now.rays.len() {
            let mut hit = self.hits[i];
            if !hit.is_hit() {
                if self.is_known(&self.now.carried[i]) {
                    continue;
                }
                let (ray, path) = (&self.now.rays.get(i), &self.now.paths[i]);
                radiance[path.sample as usize] += path.throughput * self.infinite_light(ray, path);
                continue;
            }
            let mut shape = self.scene.geometry().locate(hit.primitive).0;
            let mut outside = 1.0;
            if self.passing.is_needed() {
                let (ray, path, mut carried) = (self.now.rays.get(i), self.now.paths[i], self.now.carried[i]);
                let sampler = &mut samples[path.sample as usize].sampler;
                let number = || sampler.one(Dimensions::of(path.bounce, carried.branch).mask());
                match self.passing.meet(self.scene, i, (&ray, &hit), &carried.media, &mut carried.chance, number) {
                    Met::Nothing(ray, media) => {
                        self.pass(ray, path, Carried { media, ..carried });
                        continue;
                    }
                    Met::Surface { hit: met, outside: ior, through } => {
                        (hit, outside) = (met, ior);
                        if is_nested {
                            arrivals.boundaries[i] = (ior, through);
                        }
                    }
                }
                (self.hits[i], self.now.carried[i]) = (hit, carried);
                shape = self.scene.geometry().locate(hit.primitive).0;
            }
            // Of what branches, samples add what they find in the order of their paths, which is kept.
            let kind = if self.in_columns && outside == 1.0 {
                let ray = || self.now.rays.get(i);
                self.scene.plan().kind(shape, || self.scene.geometry().surface(&ray(), &hit).is_front(&ray()))
            } else {
                Plan::MIXED
            };
            self.scene.geometry().expect(hit.primitive, false);
            arrivals.kinds[kind].push(i as u32);
        }
        self.arrivals = arrivals;
    }

    /// Sends a path on along the ray that it was on: with the same origin, so that nothing but the surface is left out.
    fn pass(&mut self, ray: Ray, path: PathState, carried: Carried) {
        self.next.rays.push(&ray);
        self.next.paths.push(path);
        self.next.carried.push(carried);
    }
}
