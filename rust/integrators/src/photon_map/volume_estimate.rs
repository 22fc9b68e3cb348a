//! In-scattered radiance from photons in media.

use super::estimate::Estimate;
use super::kernel::Kernel;
use super::volume_photon::VolumeIndex;
use crate::known_light::Visit;
use crate::media::current_medium::Filled;
use crate::media::hit_classification::{ClassifiedHit, meet};
use crate::media::scattering::Scattering;
use crate::nesting::MediumStack;
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::sampling::{Sampler, warp};
use raywright_optics::Rgb;
use raywright_scene::{Interaction, Scene};
use std::f64::consts::TAU;

impl Estimate {
    /// Return the in-scattered radiance toward the incident ray's origin, per unit of scattering, from photons of the
    /// same medium in a ball. `share` returns the share of the ball in the medium for its squared radius (Jensen and
    /// Christensen, "Efficient Simulation of Light Transport in Scenes with Participating Media using Photon Maps",
    /// 1998). Each photon is divided by the extinction at its own position. So only the light needs to be uniform
    /// within the ball, not the medium.
    pub fn scattered(
        &self,
        of: &VolumeIndex,
        here: &Scattering,
        media: &MediumStack<Filled>,
        visit: &Visit,
        share: impl FnOnce(f64) -> f64,
    ) -> Rgb {
        let (mut sum, filled) = (Rgb::ZERO, Filled::there(media));
        let scale = self.scale * self.scale;
        let counts = |number: u32| of.photons[number as usize].counts(filled, visit.bounces);
        let measured = |number: u32, squared: f64| counts(number).then_some(squared);
        let squared_radius =
            of.places.gather(here.position, (self.nearest, self.most), measured, |number, squared, radius| {
                let weight = self.kernel.ball_weight(squared, radius * scale);
                if weight > 0.0 {
                    let photon = &of.photons[number as usize];
                    let scattered = here.evaluate(-photon.direction.as_dvec3()).0;
                    sum += scattered * photon.power(visit.has_gamut_excess, visit.single) * weight;
                }
            });
        if sum.is_black() || !sum.is_radiance() {
            return Rgb::ZERO;
        }
        sum / share(squared_radius * scale)
    }
}

/// Return the kernel-weighted share of a ball, given its squared radius, that is in the same medium and visible from
/// its center. There are no photons beyond the boundary of a cloud.
///
/// Rays in sixteen evenly spread directions measure the extent; a flat boundary is accurate to some hundredths.
pub(super) fn room(
    scene: &Scene,
    position: DVec3,
    media: &MediumStack<Filled>,
    squared: f64,
    kernel: Kernel,
    time: f64,
) -> f64 {
    const RAYS: usize = 16;
    /// Fraction of a turn between consecutive directions that spreads them evenly.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (radius, there) = (squared.sqrt(), Filled::there(media));
    // The rotation of the directions is pseudorandom and depends on the position alone.
    let bits = position.to_array().map(f64::to_bits);
    let mut sampler = Sampler::new(bits[0] ^ bits[1].rotate_left(21) ^ bits[2].rotate_left(42), 1, 0);
    let frame = Frame::new(warp::uniform_sphere(sampler.two(0)));
    let turn = sampler.one(1);
    let rays: [Ray; RAYS] = std::array::from_fn(|i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / RAYS as f64;
        let sine = (1.0 - z * z).sqrt();
        let (sin, cos) = (TAU * (turn + i as f64 * GOLDEN)).sin_cos();
        let direction = frame.to_world(DVec3::new(sine * cos, sine * sin, z));
        Ray { t_max: radius, time, ..Ray::new(position, direction) }
    });
    let mut hits = [Hit::MISS; RAYS];
    scene.intersect(&rays, &mut hits);
    let ends = |(ray, hit): (&Ray, &Hit)| {
        let (mut ray, mut hit, mut now) = (*ray, *hit, *media);
        // Nested boundaries of the same medium are few.
        for _ in 0..16 {
            if !hit.is_hit() {
                return 1.0;
            }
            match meet(scene, &ray, &hit, &now) {
                ClassifiedHit::Passed(beyond, media) if Filled::there(&media) == there => {
                    (ray.t_min, now) = (beyond, media)
                }
                _ => break,
            }
            if ray.t_min > ray.t_max {
                return 1.0;
            }
            let mut next = [Hit::MISS];
            scene.intersect(&[ray], &mut next);
            [hit] = next;
        }
        kernel.ball_share((hit.t / radius).min(1.0))
    };
    let sum: f64 = rays.iter().zip(&hits).map(ends).sum();
    // The point itself is in the medium.
    (sum / RAYS as f64).max(1.0 / (2 * RAYS) as f64)
}

#[cfg(test)]
mod tests {
    use super::super::volume_photon::VolumePhoton;
    use super::*;
    use raywright_optics::Phase;
    use raywright_scene::SceneDescription;
    use raywright_scene::fixtures::scene;
    use std::f64::consts::PI;

    fn photons(count: u32, map: u32, side: f64) -> Vec<VolumePhoton> {
        let one = |i| {
            let mut sampler = Sampler::new(8, i, map);
            let [x, y, z] = [0, 1, 2].map(|axis| side * (sampler.one(axis) - 0.5));
            let here = Scattering { position: DVec3::new(x, y, z), before: DVec3::Z, phase: Phase::Isotropic };
            let power = side.powi(3) / f64::from(count);
            VolumePhoton::new(&here, (Rgb::splat(power), false), Rgb::ONE, 0, &MediumStack::NONE)
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn even_light_is_told_without_bias() {
        // A fluence of 1 scatters 1 / 4π into each direction. An estimate from the 50 nearest counts 49 with any
        // kernel; 1,000 maps give its mean to half a percent.
        let here = Scattering { position: DVec3::ZERO, before: DVec3::X, phase: Phase::Isotropic };
        let visit = Visit { number: 0, looks_about: false, has_gamut_excess: false, single: false, bounces: None };
        for kernel in [Kernel::Box, Kernel::Cone, Kernel::Epanechnikov] {
            for (nearest, radius) in [(Some(50), None), (None, Some(0.5))] {
                let most = radius.unwrap_or(f64::INFINITY) * radius.unwrap_or(1.0);
                let estimate = Estimate { nearest, most, kernel, scale: 1.0 };
                let (mut sum, mut squares) = (0.0, 0.0);
                let maps = 1000;
                for map in 0..maps {
                    let of = VolumeIndex::new(photons(400, map, 2.0), radius);
                    let told = estimate.scattered(&of, &here, &MediumStack::NONE, &visit, |_| 1.0).mean() * 4.0 * PI;
                    sum += told;
                    squares += told * told;
                }
                let mean = sum / f64::from(maps);
                let error = ((squares / f64::from(maps) - mean * mean) / f64::from(maps)).sqrt();
                assert!((mean - 1.0).abs() < 4.0 * error && error < 0.01, "{kernel:?}: {mean} {error}");
            }
        }
    }

    #[test]
    fn balls_have_their_bias() {
        // A fluence of 1 + x² has the average 1 + r²/5 over a ball of radius r. The error of photons on a lattice is
        // that of the number of lattice points as the ball's volume.
        let fine = 80;
        let place = |i: i32| (f64::from(i) + 0.5) * 2.0 / f64::from(fine) - 1.0;
        let one = |i: i32, j: i32, k: i32| {
            let position = DVec3::new(place(i), place(j), place(k));
            let here = Scattering { position, before: DVec3::Z, phase: Phase::Isotropic };
            let power = (1.0 + position.x * position.x) * 8.0 / f64::from(fine).powi(3);
            VolumePhoton::new(&here, (Rgb::splat(power), false), Rgb::ONE, 0, &MediumStack::NONE)
        };
        let plane = |i| (0..fine).flat_map(move |j| (0..fine).map(move |k| one(i, j, k)));
        let of = VolumeIndex::new((0..fine).flat_map(plane).collect(), Some(1.0));
        let here = Scattering { position: DVec3::ZERO, before: DVec3::X, phase: Phase::Isotropic };
        let visit = Visit { number: 0, looks_about: false, has_gamut_excess: false, single: false, bounces: None };
        for scale in [1.0, 0.5f64.sqrt(), 0.5] {
            let estimate = Estimate { nearest: None, most: f64::INFINITY, kernel: Kernel::Box, scale };
            let told = estimate.scattered(&of, &here, &MediumStack::NONE, &visit, |_| 1.0).mean() * 4.0 * PI;
            assert!((told - 1.0 - 0.2 * scale * scale).abs() < 2e-3, "{told}");
        }
    }

    #[test]
    fn all_of_a_ball_is_there_where_nothing_is() {
        let scene = scene(SceneDescription::default());
        assert_eq!(room(&scene, DVec3::ONE, &MediumStack::NONE, 4.0, Kernel::Cone, 0.0), 1.0);
    }
}
