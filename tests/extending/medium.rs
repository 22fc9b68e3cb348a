use raywright::math::{DVec3, Ray};
use raywright::optics::{Phase, Rgb};
use raywright::scene::media::{Coefficients, Content, Medium, Stretch, Stretches};

/// Fog that is even below z = 0 and thins out exponentially above.
#[derive(Debug)]
struct GroundFog {
    ground: Coefficients,
    /// The height over which the extinction falls to 1/e.
    scale: f64,
}

impl GroundFog {
    fn density(&self, z: f64) -> Rgb {
        Rgb::splat((-z.max(0.0) / self.scale).exp())
    }
}

impl Medium for GroundFog {
    fn phase(&self) -> Phase {
        Phase::Isotropic
    }

    fn scatters(&self) -> bool {
        !self.ground.scattering.is_black()
    }

    fn glows(&self) -> bool {
        !self.ground.emission.is_black()
    }

    // The density is monotonic along a ray, so its values at the ends bound it. Tighter stretches cost fewer lookups.
    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        let rise = ray.direction.z;
        let ends = span.map(|t| self.density(ray.origin.z + if rise == 0.0 { 0.0 } else { rise * t }));
        let [a, b] = ends.map(|density| self.ground.times(density).extinction);
        Stretches::whole(Stretch { end: span[1], content: Content::Varies([a.at_most(b), a.at_least(b)]) })
    }

    fn at(&self, point: DVec3) -> Coefficients {
        self.ground.times(self.density(point.z))
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

#[test]
fn a_stretch_of_fog_bounds_the_extinction_in_it() {
    let fog = GroundFog { ground: Coefficients::new(Rgb::splat(0.1), Rgb::splat(0.4), Rgb::ZERO), scale: 2.0 };
    assert!((fog.extinction(DVec3::Z * 2.0).mean() - 0.5 / 1f64.exp()).abs() < 1e-12);
    for direction in [DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::new(0.6, 0.0, -0.8)] {
        let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), direction);
        let stretches: Vec<Stretch> = fog.stretches(&ray, [0.0, 20.0]).collect();
        let [Stretch { end: 20.0, content: Content::Varies([least, most]) }] = stretches[..] else {
            panic!("{stretches:?}");
        };
        for i in 0..=100 {
            let here = fog.extinction(ray.at(f64::from(i) * 0.2)).mean();
            assert!((least.mean()..=most.mean()).contains(&here), "{direction} {i}");
        }
    }
    let level = Ray::new(DVec3::Z, DVec3::X);
    assert!(fog.stretches(&level, [0.0, f64::INFINITY]).all(|stretch| stretch.end == f64::INFINITY));
}
