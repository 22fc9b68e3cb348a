//! Path reuse within groups of samples, in a homogeneous medium ([`crate::media::path_reuse`]).

use crate::media::path_reuse::{Reuse, SecondVertex, SharedVertices};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Scene;

/// Shared vertices of a batch in homogeneous media.
#[derive(Default)]
pub(super) struct MediaSharing {
    /// By sample.
    pub vertices: Vec<SharedVertices>,
    reuse: Reuse,
}

impl MediaSharing {
    /// Forgets all, and begins with a batch of so many samples.
    pub fn begin(&mut self, samples: usize) {
        self.vertices.clear();
        self.vertices.resize(samples, SharedVertices::default());
    }

    /// Adds to the radiance of each sample its share of that of its group. `found` is the radiance of each path beyond
    /// its second vertex, and then of the light samples there.
    pub fn share(&mut self, scene: &Scene, groups: &[u32], found: &[Rgb], cancel: &Cancel, radiance: &mut [Rgb]) {
        let (onward, lit) = found.split_at(self.vertices.len());
        for (vertices, (&onward, &lit)) in self.vertices.iter_mut().zip(onward.iter().zip(lit)) {
            if let Some(second) = &mut vertices.second {
                (second.found, second.lit) = (onward, lit);
            }
        }
        self.reuse.share(scene, groups, &self.vertices, cancel, radiance);
    }

    /// The second vertex of a sample.
    pub fn second(&mut self, sample: u32) -> Option<&mut SecondVertex> {
        self.vertices[sample as usize].second.as_mut()
    }

    /// Return true if a path from its first vertex to a surface stays in the medium, or leaves it just once.
    pub fn is_within_reach(&self, sample: u32, passed: u32, is_outside: bool) -> bool {
        let first = &self.vertices[sample as usize].first;
        passed == 0 || passed == 1 && is_outside && first.as_ref().is_some_and(|first| first.is_alone)
    }
}
