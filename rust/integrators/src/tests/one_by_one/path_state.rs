//! State of a camera path.

use crate::media::current_medium::Filled;
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use crate::terminate_wavelengths::Parting;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::Waves;
use raywright_optics::{BsdfSample, Rgb};
use raywright_scene::{Footprint, Scene, SurfacePoint};

/// The state of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathState {
    /// Ray of unit direction.
    pub ray: Ray,
    pub weights: Weights,
    /// Media at the ray's origin.
    pub media: MediumStack<Filled>,
    /// Primitive at the vertex that the path is about to leave; [`Ray::NO_TRIANGLE`] in a medium or on the way.
    pub leaves: u32,
    /// Normal for light sampling at the last scattering event ([`raywright_scene::LightSampleContext`]).
    pub normal: DVec3,
    /// Sampling density of the ray's direction; infinite for camera rays.
    pub pdf: f64,
    /// Ratio of radiance here to radiance at the start of the path due to the index of refraction alone.
    pub scale: f64,
    /// Number of scattering events.
    pub bounce: u32,
    /// Index of the branch among those of a split sample.
    pub branch: u32,
    /// True if a surface of the path has a reflectance above 1 in a channel.
    pub has_gamut_excess: bool,
    /// Wavelengths, `None` for RGB; and true if only the hero is left.
    pub waves: Option<Waves>,
    pub single: bool,
    /// Number of paths that it is split into here; 0 if it ends.
    pub splits: f64,
    /// Footprint at the ray's origin, if texture lookups use it; and the mean curvature of the surface there.
    pub footprint: Footprint,
    pub curvature: f64,
}

impl PathState {
    /// Make the state of a camera ray that starts in given media.
    pub fn of_camera(ray: Ray, media: MediumStack<Filled>, waves: Option<Waves>) -> Self {
        Self {
            ray,
            weights: Weights::START,
            media,
            leaves: Ray::NO_TRIANGLE,
            normal: DVec3::ZERO,
            pdf: f64::INFINITY,
            scale: 1.0,
            bounce: 0,
            branch: 0,
            has_gamut_excess: false,
            waves,
            single: false,
            splits: 1.0,
            footprint: Footprint::default(),
            curvature: 0.0,
        }
    }

    /// Move to a `t` of the ray, to a surface of mean curvature `curvature` or to none.
    pub fn come_to(&mut self, t: f64, curvature: f64) {
        (self.footprint, self.curvature) = (self.footprint.at(t), curvature);
    }

    /// Return the dispersion of a surface, if any, and the surrounding index of refraction. `through` are the media
    /// beyond it.
    pub fn parting(
        &self,
        scene: &Scene,
        surface: &SurfacePoint,
        beyond: &MediumStack<Filled>,
        outside: f64,
    ) -> (f64, Option<Parting>) {
        let Some(waves) = &self.waves else { return (outside, None) };
        let is_front = surface.is_front(&self.ray);
        let around = if is_front { &self.media } else { beyond }.dispersion();
        Parting::at(scene.material_at(surface), is_front, (outside, around), waves)
    }

    /// Continue along a sampled direction. At a dispersive surface, refraction terminates the secondary wavelengths,
    /// and reflection reweights them.
    pub fn part(&mut self, parting: Option<&Parting>, wo: DVec3, next: &BsdfSample) {
        match parting {
            Some(_) if next.is_through => self.end_all_but_hero(),
            Some(parting) if !self.single => {
                let by = parting.mirrored(wo);
                self.weights.times(by, by, Rgb::ONE);
            }
            _ => {}
        }
    }

    /// Terminate all wavelengths but the hero, which then stands for all.
    pub fn end_all_but_hero(&mut self) {
        if !self.single {
            self.weights.end_all_but_hero();
            (self.waves, self.single) = (self.waves.map(|waves| waves.alone()), true);
        }
    }

    /// Apply the correction of a surface with reflectance above 1, if the path has met such a surface before
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    pub fn meet(&mut self, again: Rgb) {
        if again != Rgb::ONE {
            if self.has_gamut_excess {
                self.weights.carried *= again;
            }
            self.has_gamut_excess = true;
        }
    }
}

impl Weights {
    /// Keep the light of the first wavelength, the hero, which then stands for all three. No other wavelength could
    /// sample the rest of the path, so only its own density counts for the path so far.
    pub fn end_all_but_hero(&mut self) {
        let (carried, asked) = (Waves::ended(self.carried), Rgb::splat(self.asked[0]));
        *self = Self { carried, drawn: Rgb::ONE, asked };
    }
}
