//! The stages of stochastic alpha masks: paths pass surfaces that are not there for them, and shadow rays are dimmed.

use super::masks::Masks;
use super::queues::own;
use super::worker::WavefrontWorker;
use crate::dimensions::Dimensions;
use crate::shadows::opacity;
use raywright_base::math::{Hit, LANES, Ray};
use raywright_base::sampling::SamplerLanes;
use raywright_optics::Rgb;

impl WavefrontWorker<'_> {
    /// Stage: paths pass what is not there for them, to the surfaces that they meet. Each decides by one number of its
    /// own, whose remainder is uniform again after a decision.
    pub(super) fn pass_masks(&mut self, numbers: &mut SamplerLanes, bounce: u32, samples: u32) {
        let (Some(masks), Some(columns), scene) = (&mut self.masks, &self.samplers, self.scene) else { return };
        let (queue, Masks { shapes, on_way, rays, hits, .. }) = (&self.paths[0], masks);
        let may_pass =
            |primitive: u32| primitive != Ray::NO_TRIANGLE && shapes[scene.geometry().locate(primitive).0 as usize];
        let which = (0u32..).zip(&self.primitives[..queue.rays.len]);
        on_way.clear();
        on_way.extend(which.filter(|&(_, &primitive)| may_pass(primitive)).map(|(i, _)| (i, 0.0)));
        for some in on_way.chunks_mut(LANES) {
            let (mut which, mut chance) = ([0; LANES], [0.0; LANES]);
            for (to, &(i, _)) in which.iter_mut().zip(&*some) {
                *to = own(queue.sample[i as usize], samples);
            }
            columns.gather(&which, numbers);
            let branch = |sample: u32| self.branches.as_ref().map_or(0, |branches| branches.number(sample));
            numbers.one(self.level, &which.map(|sample| Dimensions::of(bounce, branch(sample)).mask()), &mut chance);
            some.iter_mut().zip(chance).for_each(|(path, chance)| path.1 = chance);
        }
        rays.clear();
        rays.extend(on_way.iter().map(|&(i, _)| queue.rays.get(i as usize)));
        while !rays.is_empty() {
            hits.clear();
            hits.resize(rays.len(), Hit::MISS);
            scene.intersect(rays, hits);
            let mut kept = 0;
            for k in 0..rays.len() {
                let ((i, chance), ray, hit) = (on_way[k], rays[k], hits[k]);
                let opacity = if hit.is_hit() { opacity(scene, &ray, &hit) } else { 1.0 };
                if opacity < 1.0 && chance >= opacity {
                    on_way[kept] = (i, (chance - opacity) / (1.0 - opacity));
                    rays[kept] = Ray { t_min: hit.t.next_up(), ..ray };
                    kept += 1;
                    continue;
                }
                self.primitives[i as usize] = if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
                if let Some(to) = self.hits.get_mut(i as usize) {
                    *to = hit;
                }
            }
            rays.truncate(kept);
        }
    }

    /// Lets shadow rays to lamps with masks meet these lamps: light of the far side comes through the near one.
    pub(super) fn meet_masked_lamps(&mut self) {
        let (Some(Masks { shapes, .. }), geometry) = (&self.masks, self.scene.geometry()) else { return };
        let rays = &mut self.shadows.rays;
        for [_, lamp] in &mut rays.misses[..rays.len] {
            if *lamp != Ray::NO_TRIANGLE && geometry.shape(*lamp).is_some() && shapes[geometry.locate(*lamp).0 as usize]
            {
                *lamp = Ray::NO_TRIANGLE;
            }
        }
    }

    /// Stage: what arrives along shadow rays that something blocks is dimmed by the masks on the way, and added.
    pub(super) fn dim_by_masks(&mut self, radiance: &mut [Rgb]) {
        let Some(mut shadows) = self.masks.as_mut().map(|masks| std::mem::take(&mut masks.shadows)) else { return };
        let queue = &self.shadows;
        let [r, g, b] = &queue.arriving;
        shadows.clear();
        for i in (0..queue.rays.len).filter(|&i| self.is_occluded[i]) {
            shadows.push(&queue.rays.get(i));
            let light = Rgb::new(r[i].into(), g[i].into(), b[i].into()) * self.light_of(i);
            shadows.bring(self.receiver(i) as u32, light);
        }
        shadows.add_through(self.scene, radiance);
        if let Some(masks) = &mut self.masks {
            masks.shadows = shadows;
        }
    }
}
