//! Paths of groups that share what they find from their second surface on ([`crate::path_sharing`]).

use super::queues::Flags;
use super::waves;
use super::worker::{BATCH, WavefrontWorker};
use crate::CameraSamples;
use crate::dimensions::Dimensions;
use crate::path_sharing::SharingPoint;
use raywright_base::math::Vec3;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

impl WavefrontWorker<'_> {
    /// Stage: sixteen paths come to the first or second point of a group that shares.
    pub(super) fn visit(&mut self, bounce: u32, samples: u32) {
        for lane in 0..self.block.surfaces.count {
            let normal = self.block.surfaces.normal.get(lane);
            self.visit_lane(lane, (self.block.reflectance.get(lane), normal, false), bounce, samples);
        }
    }

    /// A path comes to its first or second point, which reflects so much about a shading normal; that may have been
    /// bent towards its ray.
    pub(super) fn visit_lane(
        &mut self,
        lane: usize,
        (reflectance, shading, is_bent): (Vec3, Vec3, bool),
        bounce: u32,
        samples: u32,
    ) {
        let (Some(sharing), block) = (&mut self.sharing, &mut *self.block) else { return };
        let rgb = |v: Vec3| Rgb::from_array(v.as_dvec3().to_array());
        let reflectance = rgb(reflectance);
        if reflectance.is_black() {
            return;
        }
        let (sample, throughput) = (block.sample[lane], rgb(block.throughput.get(lane)));
        let point = SharingPoint {
            position: block.surfaces.position.get(lane),
            origin: block.surfaces.origin.get(lane),
            shading,
            normal: block.surfaces.normal.get(lane),
            primitive: block.surfaces.primitive[lane],
        };
        if bounce == 0 {
            // Two paths that have both ended their other wavelengths would count the hero three times too often.
            if block.bsdf.flags[lane] & Flags::SINGLE != 0 {
                return;
            }
            sharing.add_first(sample, &point, throughput * reflectance);
        } else if !is_bent && sharing.add_second(sample, &point, throughput) {
            block.throughput.set(lane, Vec3::ONE);
            block.sample[lane] = sample + samples;
        }
    }

    /// Follows the paths of groups that share, as many groups at a time as make a batch.
    pub(super) fn follow_groups(
        &mut self,
        samples: &CameraSamples,
        groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        let mut found = std::mem::take(&mut self.found);
        let (mut groups, mut start) = (groups, 0);
        while !groups.is_empty() && !cancel.is_raised() {
            let (mut some, mut count) = (0, 0);
            while some < groups.len() && (some == 0 || count + groups[some] as usize <= BATCH) {
                count += groups[some] as usize;
                some += 1;
            }
            let (these, rest) = groups.split_at(some);
            let radiance = &mut radiance[start..start + count];
            found.clear();
            found.resize(3 * count, Rgb::ZERO);
            if let Some(sharing) = &mut self.sharing {
                sharing.begin(count);
            }
            if let Some(sharing) = self.media.as_mut().and_then(|media| media.sharing.as_mut()) {
                sharing.begin(count);
            }
            self.follow(samples, start..start + count, these, cancel, &mut found);
            let (own, shared) = found.split_at(count);
            radiance.copy_from_slice(own);
            let number = |sample: u32| {
                let samplers = samples.samplers.as_ref();
                samplers.map_or(0.0, |all| all.get(start + sample as usize).one(Dimensions::SHARING))
            };
            if let Some(sharing) = &mut self.sharing {
                sharing.share(self.scene, these, shared, cancel, radiance, number);
            }
            if let Some(sharing) = self.media.as_mut().and_then(|media| media.sharing.as_mut()) {
                sharing.share(self.scene, these, shared, cancel, radiance);
            }
            waves::see(&self.waves, radiance);
            (groups, start) = (rest, start + count);
        }
        self.found = found;
    }
}
