//! Radiance estimates from surface photons.

use super::kernel::Kernel;
use super::photon::StoredPhoton;
use super::photon_tracing::PhotonIndex;
use crate::known_light::Visit;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Interaction, SurfaceInteraction};

/// Parameters of the radiance estimate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    /// Number of nearest photons, where the radius has as many; `None` for all within the radius.
    pub nearest: Option<u32>,
    /// Maximum squared distance of nearest neighbors.
    pub most: f64,
    pub kernel: Kernel,
    /// Factor on the radius found, at most 1: the estimate of a smaller disk from the same photons.
    pub scale: f64,
}

impl Estimate {
    /// Return the radiance of photons scattered back along the incident ray. `share` returns the surface share of the
    /// disk for its squared radius.
    pub fn radiance<B: Bsdf>(
        &self,
        of: &PhotonIndex,
        here: &SurfaceInteraction<B>,
        visit: &Visit,
        share: impl FnOnce(f64) -> f64,
    ) -> Rgb {
        let (mut sum, bounces) = (Rgb::ZERO, visit.bounces);
        let scale = self.scale * self.scale;
        let mut add = |photon: &StoredPhoton, squared: f64, radius: f64| {
            let weight = self.kernel.weight(squared, radius * scale);
            if weight > 0.0 {
                let towards = -photon.direction.as_dvec3();
                // Photon power is per area across the geometric normal; the BSDF is per solid angle, so its cosine is
                // divided out.
                let scattered = here.evaluate(towards).0 / here.normal().dot(towards);
                sum += scattered * photon.power(visit.has_gamut_excess, visit.single) * weight;
            }
        };
        let measured = |number: u32, squared: f64| of.photons[number as usize].measured(here, squared, bounces);
        let squared_radius =
            of.places.gather(here.position(), (self.nearest, self.most), measured, |number, squared, radius| {
                add(&of.photons[number as usize], squared, radius);
            });
        if sum.is_black() || !sum.is_radiance() {
            return Rgb::ZERO;
        }
        sum / share(squared_radius * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::gauss::gauss;
    use raywright_base::math::{DVec3, Hit, Ray};
    use raywright_base::sampling::Sampler;
    use raywright_scene::fixtures::{rectangle, scene, shape};
    use raywright_scene::{Scene, SceneDescription};
    use std::f64::consts::PI;

    /// Return a white floor.
    fn floor() -> Scene {
        let mesh = rectangle([-10.0, -10.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
        scene(SceneDescription { shapes: vec![shape(mesh, [1.0; 3], 0.0)], ..Default::default() })
    }

    fn look(scene: &Scene, x: f64) -> SurfaceInteraction {
        let ray = Ray::new(DVec3::new(x, 0.0, 1.0), DVec3::NEG_Z);
        let mut hits = [Hit::MISS];
        scene.intersect(&[ray], &mut hits);
        SurfaceInteraction::at(scene, &ray, &hits[0])
    }

    fn photon(x: f64, y: f64, power: f64) -> StoredPhoton {
        StoredPhoton::new(DVec3::new(x, y, 0.0), DVec3::NEG_Z, DVec3::Z, Rgb::splat(power), 1)
    }

    const FIXED: Estimate = Estimate { nearest: None, most: f64::INFINITY, kernel: Kernel::Box, scale: 1.0 };

    fn visit(bounces: Option<u32>) -> Visit {
        Visit { number: 0, looks_about: false, has_gamut_excess: false, single: false, bounces }
    }

    /// Return the irradiance at a point of a white floor: π times its radiance.
    fn irradiance(estimate: Estimate, of: &PhotonIndex, scene: &Scene, x: f64) -> f64 {
        estimate.radiance(of, &look(scene, x), &visit(None), |_| 1.0).mean() * PI
    }

    /// Make photons on a square lattice around a point of the floor, with power from a density.
    fn lattice(density: impl Fn(f64, f64) -> f64, at: f64, half: f64, fine: i32) -> Vec<StoredPhoton> {
        let step = 2.0 * half / f64::from(fine);
        let of = |i: i32, j: i32| {
            let place = |i: i32| (f64::from(i) + 0.5) * step - half;
            let (x, y) = (at + place(i), place(j));
            photon(x, y, density(x, y) * step * step)
        };
        (0..fine).flat_map(|j| (0..fine).map(move |i| (i, j))).map(|(i, j)| of(i, j)).collect()
    }

    /// Make photons on rings around a point of the floor within a radius, with power from a density: Gauss quadrature
    /// over rings, equal steps along each.
    fn rings(density: impl Fn(f64, f64) -> f64, at: f64, radius: f64) -> Vec<StoredPhoton> {
        let turns = 64;
        let of = |(share, weight): (f64, f64), j: i32| {
            let far = radius * share.sqrt();
            let (sin, cos) = (f64::from(j) * 2.0 * PI / f64::from(turns)).sin_cos();
            let (x, y) = (at + far * cos, far * sin);
            photon(x, y, density(x, y) * PI * radius * radius * weight / f64::from(turns))
        };
        // The inner half of the area is a disk of its own.
        let half = |half: f64| gauss(16).into_iter().map(move |(x, weight)| (0.5 * (x + half), 0.5 * weight));
        let rings = half(0.0).chain(half(1.0));
        rings.flat_map(|ring| (0..turns).map(move |j| (ring, j))).map(|(ring, j)| of(ring, j)).collect()
    }

    #[test]
    fn disks_have_their_bias() {
        // A lamp of intensity 1 at height 1, at points below it and 1 aside. The quadrature is more exact than the
        // photons' f32 power: the roundings of 32 rings leave some 1e-8.
        let light = |x: f64, y: f64| (1.0 + x * x + y * y).powf(-1.5);
        let scene = floor();
        for (radius, under, aside) in
            [(0.5, 0.844_582_472_000_673, 0.359_955_386_261_336), (1.0, 0.585_786_437_626_905, 0.357_362_318_226_876)]
        {
            for (x, expected) in [(0.0, under), (1.0, aside)] {
                let of = PhotonIndex::new(rings(light, x, radius), Some(radius));
                let found = irradiance(FIXED, &of, &scene, x);
                assert!((found / expected - 1.0).abs() < 3e-8, "{found} {expected}");
                if radius == 0.5 && x == 0.0 {
                    // Richardson extrapolation of two radii from the same photons.
                    let half = Estimate { scale: 0.5f64.sqrt(), ..FIXED };
                    let better = 2.0 * irradiance(half, &of, &scene, x) - found;
                    assert!((better - 0.985_528_197_373_299).abs() < 8e-8, "{better}");
                    assert!(((1.0 - better) / (1.0 - found) - 0.093_115_640_256_248).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn edges_have_their_bias() {
        // A lit half plane and a lit quadrant: at the edge, in the corner, and half a radius from the edge. These
        // points lie between lattice points. A circle of 500 steps contains its area's number of lattice points to some
        // 2e-5.
        let scene = floor();
        type IsLit = fn(f64, f64) -> bool;
        let cases: [(IsLit, f64, f64); 3] = [
            (|x, _| x > 0.0, 0.0, 0.5),
            (|x, y| x > 0.0 && y > 0.0, 0.0, 0.25),
            (|x, _| x > 0.0, 0.5, 0.804_498_890_522_115),
        ];
        for (is_lit, x, expected) in cases {
            let light = |x: f64, y: f64| f64::from(u8::from(is_lit(x, y)));
            let of = PhotonIndex::new(lattice(light, x, 1.0, 1000), Some(1.0));
            assert!((irradiance(FIXED, &of, &scene, x) - expected).abs() < 1e-4);
        }
    }

    #[test]
    fn the_nearest_are_n_less_one() {
        // 400 photons uniform on a square of side 2, with 50 in each estimate. The estimate is unbiased, with a
        // relative standard deviation of 1/√48. 4,000 maps give its mean to 0.2 %; the false alarm rate at 4 standard
        // errors is 1 in 16,000.
        let scene = floor();
        let nearest = |kernel| Estimate { nearest: Some(50), kernel, ..FIXED };
        let maps = 4000;
        let mut sums = [[0.0; 2]; 3];
        for map in 0..maps {
            let of = |i| {
                let [x, y] = Sampler::new(5, i, map).two(0);
                photon(2.0 * x - 1.0, 2.0 * y - 1.0, 1.0 / 100.0)
            };
            let of = PhotonIndex::new((0..400).map(of).collect(), None);
            for (sum, kernel) in sums.iter_mut().zip([Kernel::Box, Kernel::Cone, Kernel::Epanechnikov]) {
                let found = irradiance(nearest(kernel), &of, &scene, 0.0);
                sum[0] += found;
                sum[1] += found * found;
            }
        }
        let stats = sums.map(|[sum, squares]| {
            let mean = sum / f64::from(maps);
            (mean, (squares / f64::from(maps) - mean * mean).sqrt())
        });
        for (mean, deviation) in stats {
            assert!((mean - 1.0).abs() < 4.0 * deviation / f64::from(maps).sqrt(), "{mean}");
        }
        // A Poisson process has 0.144338; 400 photons have a few percent less.
        assert!((stats[0].1 / 0.144_337_567 - 1.0).abs() < 0.1, "{}", stats[0].1);
    }

    #[test]
    fn other_surfaces_and_longer_paths_are_left_out() {
        let scene = floor();
        let good = photon(0.1, 0.0, 1.0);
        let (up, down) = (DVec3::Z, DVec3::NEG_Z);
        let at = |z| DVec3::new(0.1, 0.0, z);
        let others = [
            StoredPhoton::new(at(0.3), down, up, Rgb::ONE, 1),
            StoredPhoton::new(at(0.0), up, down, Rgb::ONE, 1),
            StoredPhoton::new(at(0.0), DVec3::NEG_X, DVec3::X, Rgb::ONE, 1),
            StoredPhoton::new(at(0.0), down, up, Rgb::ONE, 2),
        ];
        for radius in [Some(1.0), None] {
            let alone = PhotonIndex::new(vec![good], radius);
            let all = PhotonIndex::new([&[good][..], &others].concat(), radius);
            let here = look(&scene, 0.0);
            let estimate = Estimate { nearest: Some(8), most: 1.0, ..FIXED };
            let of_bounces = |of: &PhotonIndex, most| estimate.radiance(of, &here, &visit(most), |_| 1.0);
            let expected = 1.0 / (PI * PI);
            for of in [&alone, &all] {
                assert!((of_bounces(of, Some(1)).mean() / expected - 1.0).abs() < 1e-6);
            }
            assert!(of_bounces(&alone, Some(0)).is_black());
            assert!(of_bounces(&PhotonIndex::new(Vec::new(), radius), None).is_black());
        }
    }
}
