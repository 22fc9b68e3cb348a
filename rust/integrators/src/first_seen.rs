//! Shapes that camera rays hit first.

use crate::CameraSample;
use crate::boundary_queries::BoundaryQueries;
use crate::dimensions::Dimensions;
use crate::nesting::{Boundary, MediumStack};
use crate::shadows::opacity;
use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_scene::Scene;
use raywright_scene::materials::Interior;

/// Finds the shape that each camera ray comes to first, past what of masks is open to it and past surfaces that are
/// none because another medium is there. Random decisions are those of paths.
pub struct FirstSeen<'a> {
    scene: &'a Scene,
    masks: bool,
    nested: bool,
    boundaries: BoundaryQueries,
    rays: RayQueue,
    hits: Vec<Hit>,
    on_way: Vec<OnWay>,
    next: Vec<OnWay>,
}

/// A ray that has come to nothing yet.
#[derive(Clone, Copy)]
struct OnWay {
    sample: u32,
    /// A uniform number that decides which masks it passes; negative until it is asked for. After each decision its
    /// remainder is rescaled to be uniform again.
    chance: f64,
    media: MediumStack,
}

impl<'a> FirstSeen<'a> {
    /// For the rays of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        let needs = scene.plan().needs();
        Self {
            scene,
            masks: needs.masks,
            nested: needs.nested,
            boundaries: BoundaryQueries::default(),
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
        if self.nested {
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

    /// Takes rays to their hits; those that pass these go on, from the same origin, so that they skip nothing else.
    fn meet(&mut self, samples: &mut [CameraSample], seen: &mut [Option<u32>]) {
        if self.nested {
            let rays = (0..self.hits.len()).map(|i| self.rays.get(i));
            self.boundaries.find::<Interior>(self.scene, rays, &self.hits);
        }
        let mut further = RayQueue::default();
        self.next.clear();
        for (i, hit) in self.hits.iter().enumerate().filter(|(_, hit)| hit.is_hit()) {
            let (ray, mut way, mut hit) = (self.rays.get(i), self.on_way[i], *hit);
            let boundary =
                if self.nested { self.boundaries.boundary(self.scene, i, (&ray, &hit), &way.media) } else { None };
            match boundary {
                Some((Boundary::None(media), beyond)) => {
                    further.push(&Ray { t_min: beyond, ..ray });
                    self.next.push(OnWay { media, ..way });
                    continue;
                }
                Some((Boundary::Between { hit: owner, .. }, _)) => hit = owner,
                None => {}
            }
            let opacity = if self.masks { opacity(self.scene, &ray, &hit) } else { 1.0 };
            if opacity < 1.0 {
                if way.chance < 0.0 {
                    way.chance = samples[way.sample as usize].sampler.one(Dimensions::of(0, 0).mask());
                }
                if way.chance >= opacity {
                    way.chance = (way.chance - opacity) / (1.0 - opacity);
                    further.push(&Ray { t_min: hit.t.next_up(), ..ray });
                    self.next.push(way);
                    continue;
                }
            }
            seen[way.sample as usize] = Some(self.scene.geometry().locate(hit.primitive).0);
        }
        std::mem::swap(&mut self.on_way, &mut self.next);
        self.rays = further;
    }
}
