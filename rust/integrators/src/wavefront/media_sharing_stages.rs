//! The stages of paths that share in a homogeneous medium.

use super::media::{MediumScattering, PathMedia};
use super::queues::Flags;
use super::worker::WavefrontWorker;
use crate::media::path_reuse::{FirstVertex, SecondVertex};
use raywright_base::math::Vec3;
use raywright_optics::Rgb;

impl WavefrontWorker<'_> {
    /// Return whether paths of groups share anything.
    pub(super) fn shares(&self) -> bool {
        self.sharing.is_some() || self.media.as_ref().is_some_and(|media| media.sharing.is_some())
    }

    /// Stage: sixteen paths may come to a vertex of a group that shares in a medium. Returns the lanes that come to
    /// their first, and those that come to their second.
    pub(super) fn share_in_medium(&mut self, some: &[MediumScattering], bounce: u32, samples: u32) -> [u32; 2] {
        let (mut firsts, mut seconds) = (0, 0);
        let (Some(media), Some(flights)) = (&mut self.media, &self.flights) else { return [0; 2] };
        let Some(sharing) = &mut media.sharing else { return [0; 2] };
        let block = &mut *self.block;
        for (lane, at) in some.iter().enumerate() {
            let sample = block.sample[lane];
            if sample >= samples {
                continue;
            }
            let vertices = &mut sharing.vertices[sample as usize];
            if at.is_second {
                vertices.second = Some(SecondVertex::of_medium(at.position));
                seconds |= 1 << lane;
                block.share(lane, samples);
            } else if let (None, Some(here), false) =
                (vertices.first, at.even(), block.bsdf.flags[lane] & (Flags::HAS_GAMUT_EXCESS | Flags::SINGLE) != 0)
            {
                let PathMedia { media: number, drawn, .. } = media.paths[sample as usize];
                let throughput = Rgb::from_array(block.throughput.get(lane).as_dvec3().to_array());
                vertices.first = FirstVertex::new(
                    (at.position, at.before),
                    (at.phase, here),
                    (throughput, drawn),
                    &flights.stacks.get(number).media,
                    self.settings.max_depth.map(|_| bounce),
                );
                media.paths[sample as usize].is_first = vertices.first.is_some();
                firsts |= u32::from(vertices.first.is_some()) << lane;
            }
        }
        [firsts, seconds]
    }

    /// Stage: sixteen paths may come from a medium to their second vertex on a surface, if that is matte. `matte` tells
    /// its shading normal, and whether that was bent towards the ray.
    pub(super) fn share_beyond_medium(&mut self, samples: u32, matte: impl Fn(&Self, usize) -> Option<(Vec3, bool)>) {
        for lane in 0..self.block.surfaces.count {
            let sample = self.block.sample[lane];
            let inside =
                self.media.as_ref().filter(|_| sample < samples).and_then(|media| media.paths[sample as usize].shares);
            let (Some(inside), Some((shading, false))) = (inside, matte(self, lane)) else { continue };
            let block = &mut *self.block;
            let normal = block.surfaces.normal.get(lane);
            let Some(sharing) = self.media.as_mut().and_then(|media| media.sharing.as_mut()) else { return };
            if shading == normal {
                let (departure, normal) = (block.surfaces.ray_origin(lane), normal.as_dvec3());
                sharing.vertices[sample as usize].second = Some(SecondVertex::of_surface(departure, normal, inside));
                block.share(lane, samples);
            }
        }
    }
}
