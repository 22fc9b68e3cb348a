use raywright::math::DVec3;
use raywright::optics::Rgb;
use raywright::scene::textures::{Needs, Texture, TexturePoint};

/// A color that changes evenly with height, from z = 0 to a height, and is constant beyond.
#[derive(Debug)]
struct Gradient {
    bottom: Rgb,
    top: Rgb,
    height: f64,
}

impl Texture for Gradient {
    // The mean over the width of a ray is the value in its middle, except near the two ends.
    fn at(&self, point: &TexturePoint) -> Rgb {
        let share = (point.position.z / self.height).clamp(0.0, 1.0);
        self.bottom * (1.0 - share) + self.top * share
    }

    fn range(&self) -> [Rgb; 2] {
        [self.bottom.at_most(self.top), self.bottom.at_least(self.top)]
    }

    // The power of an emitter is computed from it.
    fn mean(&self) -> Rgb {
        (self.bottom + self.top) * 0.5
    }

    // Only these are computed at each hit.
    fn needs(&self) -> Needs {
        Needs { position: true, ..Needs::NONE }
    }
}

#[test]
fn a_gradient_stays_within_its_range() {
    let gradient = Gradient { bottom: Rgb::new(0.8, 0.1, 0.0), top: Rgb::new(0.2, 0.5, 0.0), height: 4.0 };
    let at = |z| gradient.at(&TexturePoint { position: DVec3::new(7.0, -1.0, z), ..TexturePoint::default() });
    assert_eq!(at(-1.0), gradient.bottom);
    assert_eq!(at(9.0), gradient.top);
    assert_eq!(at(2.0), gradient.mean());
    let [low, high] = gradient.range();
    for color in (0..=40).map(|i| at(f64::from(i) * 0.1)) {
        assert!((0..3).all(|i| color[i] >= low[i] - 1e-15 && color[i] <= high[i] + 1e-15));
    }
}
