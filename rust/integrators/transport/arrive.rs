//! What rays come to.

use super::dimensions::Dimensions;
use super::features::{Carried, Features};
use super::nesting::{Boundary, MediumStack, around};
use super::path_state::PathState;
use super::shadows::opacity;
use super::worker::TransportWorker;
use crate::integrators::CameraSample;
use crate::math::{Hit, Ray};
use crate::optics::Rgb;
use crate::sampling::Sampler;

impl<N: Features> TransportWorker<'_, N> {
    /// Sorts paths by what their rays have come to: those that leave the scene take what light comes from there, and
    /// those that pass what they hit go on at once.
    pub(super) fn arrive(&mut self, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        let mut arrivals = std::mem::take(&mut self.arrivals);
        arrivals.diffuse.clear();
        arrivals.others.clear();
        arrivals.windows.clear();
        arrivals.of.clear();
        if self.nested {
            for (i, hit) in self.hits.iter().enumerate() {
                if hit.is_hit()
                    && let Some(window) = around(self.scene, &self.now.rays.get(i), hit)
                {
                    arrivals.windows.push(window);
                    arrivals.of.push(i as u32);
                }
            }
            arrivals.boundaries.resize(self.now.rays.len(), (1.0, MediumStack::NONE));
        }
        let crossings = if self.nested { self.scene.crossings(&arrivals.windows) } else { Default::default() };
        let mut window = 0;
        for i in 0..self.now.rays.len() {
            let mut hit = self.hits[i];
            if !hit.is_hit() {
                let (ray, path) = (&self.now.rays.get(i), &self.now.paths[i]);
                radiance[path.sample as usize] += path.throughput * self.infinite_light(ray, path);
                continue;
            }
            let mut shape = self.scene.geometry().locate(hit.primitive).0;
            let mut outside = 1.0;
            if N::GENERAL && (self.masks || self.nested) {
                let (ray, path, mut carried) = (self.now.rays.get(i), self.now.paths[i], self.now.carried[i]);
                if arrivals.of.get(window) == Some(&(i as u32)) {
                    window += 1;
                    match Boundary::new(self.scene, &ray, &carried.media, &crossings, window - 1) {
                        Boundary::None(media) => {
                            carried.media = media;
                            let t_min = arrivals.windows[window - 1].t_max.next_up();
                            self.pass(Ray { t_min, ..ray }, path, carried);
                            continue;
                        }
                        Boundary::Between { hit: owner, outside: ior, through } => {
                            if owner.primitive != hit.primitive || owner.inner != hit.inner {
                                hit = owner;
                            }
                            outside = ior;
                            arrivals.boundaries[i] = (ior, through);
                        }
                    }
                } else if self.nested {
                    arrivals.boundaries[i] = (1.0, carried.media);
                }
                let sampler = &mut samples[Self::own(path.sample, samples.len())].sampler;
                if self.masks && self.is_passed(&ray, &hit, (&path, &mut carried), sampler) {
                    self.pass(Ray { t_min: hit.t.next_up(), ..ray }, path, carried);
                    continue;
                }
                (self.hits[i], self.now.carried[i]) = (hit, carried);
                shape = self.scene.geometry().locate(hit.primitive).0;
            }
            let is_diffuse = outside == 1.0 && self.diffuse(shape).is_some();
            let list = if is_diffuse { &mut arrivals.diffuse } else { &mut arrivals.others };
            self.scene.geometry().expect(hit.primitive, false);
            list.push(i as u32);
        }
        self.arrivals = arrivals;
    }

    /// What a shape reflects on the front and on the back, if each side scatters by one diffuse colour and paths need
    /// no more of it.
    #[inline]
    pub(super) fn diffuse(&self, shape: u32) -> Option<[Rgb; 2]> {
        self.scene.plan().diffuse(shape).filter(|_| self.in_columns)
    }

    /// Whether a ray passes a mask.
    fn is_passed(
        &self,
        ray: &Ray,
        hit: &Hit,
        (path, carried): (&PathState, &mut Carried),
        sampler: &mut Sampler,
    ) -> bool {
        let opacity = opacity(self.scene, ray, hit);
        if opacity >= 1.0 {
            return false;
        }
        if carried.chance < 0.0 {
            carried.chance = sampler.one(Dimensions::of(path.bounce, carried.branch).mask());
        }
        let is_passed = carried.chance >= opacity;
        if is_passed {
            carried.chance = (carried.chance - opacity) / (1.0 - opacity);
        }
        is_passed
    }

    /// Sends a path on along the ray that it was on: with the same origin, so that nothing but the surface is left out.
    fn pass(&mut self, ray: Ray, path: PathState, carried: Carried) {
        self.next.rays.push(&ray);
        self.next.paths.push(path);
        self.next.carried.push(carried);
    }
}
