//! Shapes that camera rays hit first.

use crate::CameraSample;
use crate::dimensions::Dimensions;
use crate::nesting::MediumStack;
use crate::skip_intersections::{Met, Passing};
use raywright_base::math::{Hit, RayQueue};
use raywright_scene::Scene;

/// Finds the shape that each camera ray comes to first, past what of masks is open to it and past surfaces that are
/// none because another medium is there. Random decisions are those of paths.
pub struct FirstSeen<'a> {
    scene: &'a Scene,
    passing: Passing,
    rays: RayQueue,
    hits: Vec<Hit>,
    on_way: Vec<OnWay>,
    next: Vec<OnWay>,
}

/// A ray that has come to nothing yet.
#[derive(Clone, Copy)]
struct OnWay {
    sample: u32,
    /// A uniform number that decides which masks it passes; negative until it is asked for.
    chance: f64,
    media: MediumStack,
}

impl<'a> FirstSeen<'a> {
    /// For the rays of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        let needs = scene.plan().needs();
        Self {
            scene,
            passing: Passing::new(needs.masks, needs.nested),
            rays: RayQueue::default(),
            hits: Vec::new(),
            on_way: Vec::new(),
            next: Vec::new(),
        }
    }

    /// Writes the number of the shape that each ray comes to, or `None` where it leaves the scene.
    pub fn look(&mut self, samples: &mut [CameraSample], seen: &mut Vec<Option<u32>>) {
        seen.clear();
        seen.resize(samples.len(), None);
        self.rays.clear();
        samples.iter().for_each(|sample| self.rays.push(&sample.ray));
        let start = |sample| OnWay { sample, chance: -1.0, media: MediumStack::NONE };
        self.on_way.clear();
        self.on_way.extend((0..samples.len() as u32).map(start));
        if self.passing.is_nested() {
            let mut media = Vec::new();
            MediumStack::at(self.scene, self.rays.rows(), &mut media);
            for (ray, media) in self.on_way.iter_mut().zip(media) {
                ray.media = media;
            }
        }
        while !self.on_way.is_empty() {
            self.hits.clear();
            self.hits.resize(self.rays.len(), Hit::MISS);
            self.scene.intersect_queue(&mut self.rays, &mut self.hits);
            self.meet(samples, seen);
        }
    }

    /// Takes rays to their hits; those that pass these go on.
    fn meet(&mut self, samples: &mut [CameraSample], seen: &mut [Option<u32>]) {
        self.passing.begin(self.scene, &self.rays, &self.hits);
        let mut further = RayQueue::default();
        self.next.clear();
        for (i, hit) in self.hits.iter().enumerate().filter(|(_, hit)| hit.is_hit()) {
            let mut way = self.on_way[i];
            let mut found = *hit;
            if self.passing.is_needed() {
                let (ray, sampler) = (self.rays.get(i), &mut samples[way.sample as usize].sampler);
                let number = || sampler.one(Dimensions::of(0, 0).mask());
                match self.passing.meet(self.scene, i, (&ray, hit), &way.media, &mut way.chance, number) {
                    Met::Nothing(ray, media) => {
                        further.push(&ray);
                        self.next.push(OnWay { media, ..way });
                        continue;
                    }
                    Met::Surface { hit, .. } => found = hit,
                }
            }
            seen[way.sample as usize] = Some(self.scene.geometry().locate(found.primitive).0);
        }
        std::mem::swap(&mut self.on_way, &mut self.next);
        self.rays = further;
    }
}
