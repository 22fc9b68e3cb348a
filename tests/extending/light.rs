use raywright::math::DVec3;
use raywright::optics::Rgb;
use raywright::scene::{Light, LightBounds, LightSample, LightSampleContext, Place, RayOrigin, Reach};
use std::f64::consts::PI;

/// A point that shines in rings about an axis: as the square of a cosine of so many times the angle.
#[derive(Debug)]
struct Rings {
    position: DVec3,
    axis: DVec3,
    rings: f64,
    intensity: Rgb,
}

impl Rings {
    fn intensity(&self, direction: DVec3) -> Rgb {
        let angle = direction.angle_between(self.axis);
        self.intensity * (self.rings * angle).cos().powi(2)
    }
}

impl Light for Rings {
    fn validate(&self) -> Result<(), String> {
        let is_good = self.position.is_finite() && self.axis.length() > 0.0 && self.intensity.is_radiance();
        is_good.then_some(()).ok_or_else(|| "a light of rings must be finite, with an axis".to_owned())
    }

    // Lights are chosen by power; half of an even point's power is near enough.
    fn reach(&self) -> Reach {
        let intensity = self.intensity.mean();
        Reach::Finite { power: 2.0 * PI * intensity, bounds: LightBounds::everywhere(self.position, intensity) }
    }

    fn sample(&self, receiver: &LightSampleContext, _: [f64; 2]) -> Option<LightSample> {
        let way = self.position - receiver.position;
        let distance = way.length();
        let weight = self.intensity(-way) / (distance * distance);
        (distance > 0.0 && !weight.is_black()).then(|| LightSample {
            direction: way / distance,
            weight,
            // All light comes from a single direction.
            pdf: f64::INFINITY,
            source: Some(RayOrigin::free(self.position)),
            primitive: raywright::math::Ray::NO_TRIANGLE,
        })
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Point(self.position))
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

#[test]
fn rings_are_bright_along_the_axis_and_dark_between() {
    let lamp = Rings { position: DVec3::Z * 2.0, axis: DVec3::NEG_Z, rings: 3.0, intensity: Rgb::ONE };
    assert_eq!(lamp.validate(), Ok(()));
    let at = |position| lamp.sample(&LightSampleContext { position, normal: DVec3::Z, waves: None }, [0.5; 2]);
    assert!((at(DVec3::ZERO).unwrap().weight.mean() - 0.25).abs() < 1e-12);
    // cos² 90°, at 30° from the axis.
    let dark = DVec3::X * 2.0 * (PI / 6.0).tan();
    assert!(at(dark).is_none_or(|light| light.weight.mean() < 1e-12));
}
