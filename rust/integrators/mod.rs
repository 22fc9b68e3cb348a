//! Floor 4: what turns rays into radiance.

mod ambient_occlusion;
mod aov;
mod direct;
mod distributed;
mod path;
mod ray_cast;
#[cfg(test)]
mod tests;
mod transport;
mod whitted;

pub use ambient_occlusion::AmbientOcclusion;
pub use aov::{Channel, aovs};
pub use direct::Direct;
pub use distributed::Distributed;
pub use path::Path;
pub use ray_cast::RayCast;
pub use whitted::Whitted;

use crate::math::Ray;
use crate::optics::Rgb;
use crate::sampling::Sampler;
use crate::scene::{Footprint, Scene};
use crate::workers::Cancel;

/// One sample of one pixel: the ray that the camera sends, and the numbers for what follows.
#[derive(Clone, Debug)]
pub struct CameraSample {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// Its numbers; the camera has used the first [`crate::sampling::CAMERA_DIMENSIONS`].
    pub sampler: Sampler,
}

/// A way to turn rays into radiance.
pub trait Integrator: Send + Sync {
    /// What one thread works with on a scene: the integrator and the memory it needs, to be used again and again.
    /// `footprint` is that of the camera's rays, for the filtering of textures.
    fn worker<'a>(&'a self, scene: &'a Scene, footprint: Footprint) -> Box<dyn Worker + 'a>;

    /// The side of the square patches of pixels whose samples of the same number work together; 1 where each sample is
    /// on its own.
    fn patch(&self, _scene: &Scene) -> u32 {
        1
    }

    /// Makes what workers need of a scene, once for all of them: it is called before there are any.
    fn prepare(&self, _scene: &Scene) {}

    /// Whether workers must run on the thread that asked for the picture, as what is written in Python must. They are
    /// then handed batches of tens of thousands of samples, and may raise the cancel themselves to end the render.
    fn runs_on_caller(&self) -> bool {
        false
    }
}

/// An integrator at work on batches of camera samples. It advances all paths of a batch together, one bounce at a
/// time, so that every ray goes through the accelerator in large groups.
pub trait Worker: Send {
    /// Writes the radiance that arrives along each ray. Each depends on its own sample only, not on the batch that it
    /// is in. Returns early, with nothing of use written, soon after `cancel` is raised.
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]);

    /// As [`Worker::radiance`], of samples that stand in groups one after the other, of so many each. What arrives
    /// along a ray may depend on all samples of its group, but on no others, and its mean not even on these.
    fn radiance_in_groups(
        &mut self,
        samples: &mut [CameraSample],
        _groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.radiance(samples, cancel, radiance);
    }
}
