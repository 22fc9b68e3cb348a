//! Guided emission: light paths aimed at spheres around specular objects.

use raywright_base::math::trig::sin_cos_turn;
use raywright_base::math::{DVec3, Frame};
use std::f64::consts::TAU;

/// Spheres around mirrors and glass. These cause caustics, but emission sampling alone rarely hits them.
///
/// Light outside the spheres contributes too. Directions are sampled either from the cones towards the spheres or from
/// the light's own distribution, and weighted by the density of the mixture (Veach and Guibas, 1995: the one-sample
/// model). The larger the solid angle of the spheres at a position, the smaller the share of aimed samples. Inside a
/// sphere nothing is aimed.
#[derive(Clone, Debug, Default)]
pub struct Aim {
    /// Center and radius of each sphere.
    balls: Vec<(DVec3, f64)>,
}

/// The cones from a position to the spheres.
pub(super) struct Cones<'a> {
    balls: &'a [(DVec3, f64)],
    place: DVec3,
    /// Sum of their solid angles.
    angle: f64,
    /// Probability of sampling from the cones.
    share: f64,
}

/// 1 - cos θ of the cone to a sphere from a position outside it, without cancellation for small cones.
fn height((middle, radius): (DVec3, f64), place: DVec3) -> f64 {
    let square = radius * radius / middle.distance_squared(place);
    square / (1.0 + (1.0 - square).sqrt())
}

impl Aim {
    /// Maximum probability of aiming.
    const SHARE: f64 = 0.5;

    /// Creates a distribution for spheres with these centers and radii.
    pub fn at(balls: Vec<(DVec3, f64)>) -> Self {
        Self { balls }
    }

    /// The cones from a position; `None` if nothing is aimed there.
    #[inline]
    pub(super) fn from(&self, place: DVec3) -> Option<Cones<'_>> {
        let mut angle = 0.0;
        for &(middle, radius) in &self.balls {
            if middle.distance_squared(place) <= radius * radius {
                return None;
            }
            angle += TAU * height((middle, radius), place);
        }
        // TAU is the solid angle of the hemisphere, the most that a surface can see.
        let share = Self::SHARE * (1.0 - angle / TAU);
        (angle > 0.0 && share > 0.0).then_some(Cones { balls: &self.balls, place, angle, share })
    }
}

impl Cones<'_> {
    /// Probability of sampling from the cones.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Samples a direction from one of the cones, by numbers that are uniform in [0, 1).
    pub fn sample(&self, [choice, v]: [f64; 2]) -> DVec3 {
        let mut left = choice * self.angle;
        let mut chosen = (DVec3::Z, 0.0);
        for &ball in self.balls {
            let height = height(ball, self.place);
            chosen = (ball.0, height);
            if left < TAU * height {
                break;
            }
            left -= TAU * height;
        }
        let (middle, height) = chosen;
        // The remainder of the choice is uniform in the cone and is reused; clamped against rounding.
        let down = (left / TAU).min(height);
        let across = (down * (2.0 - down)).sqrt();
        let [sin, cos] = sin_cos_turn(v);
        let axis = (middle - self.place).normalize();
        Frame::new(axis).to_world(DVec3::new(across * cos, across * sin, 1.0 - down))
    }

    /// Density of the mixture for a unit direction, by solid angle, where `lights` is the light's own density.
    pub fn density(&self, direction: DVec3, lights: f64) -> f64 {
        let mut within = 0.0;
        for &(middle, radius) in self.balls {
            let way = middle - self.place;
            let (far, along) = (way.length_squared(), way.dot(direction));
            if along > 0.0 && along * along >= far - radius * radius {
                within += 1.0;
            }
        }
        self.share * within / self.angle + (1.0 - self.share) * lights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::{Sampler, warp};
    use std::f64::consts::PI;

    fn aim() -> Aim {
        let at = DVec3::new;
        Aim::at(vec![(at(0.0, 0.0, 3.0), 0.5), (at(0.3, 0.0, 2.0), 0.25), (at(-4.0, 1.0, 0.0), 1e-3)])
    }

    #[test]
    fn directions_have_the_density_that_is_told() {
        let aim = aim();
        let place = DVec3::new(0.1, -0.2, 0.3);
        let cones = aim.from(place).unwrap();
        let even = 0.25 / PI;
        // The density integrates to 1, also for directions that the light samples uniformly.
        let (mut all, mut means, count) = (0.0, [DVec3::ZERO; 2], 1 << 20);
        for number in 0..count {
            let mut sampler = Sampler::new(5, 0, number);
            let direction = warp::uniform_sphere(sampler.two(0));
            let density = cones.density(direction, even);
            all += density / even / f64::from(count);
            means[0] += direction * (density / even / f64::from(count));
            let drawn = if sampler.one(3) < cones.share() {
                cones.sample(sampler.two(1))
            } else {
                warp::uniform_sphere(sampler.two(1))
            };
            assert!((drawn.length() - 1.0).abs() < 1e-12);
            assert!(cones.density(drawn, 0.0) >= 0.0);
            means[1] += drawn / f64::from(count);
        }
        // The small sphere covers 2e-7 of all directions: only the second mean includes the samples towards it.
        let small = 0.5 * TAU * height(aim.balls[2], place) / cones.angle;
        assert!((all - 1.0).abs() < 0.02, "{all}");
        assert!((means[0] - means[1]).length() < 0.01 + small, "{means:?}");
    }

    #[test]
    fn what_is_drawn_is_within_a_cone() {
        let aim = aim();
        let cones = aim.from(DVec3::ZERO).unwrap();
        let mut each = [0; 3];
        for number in 0..10_000 {
            let mut sampler = Sampler::new(6, 0, number);
            let direction = cones.sample(sampler.two(0));
            let hits = |(middle, radius): (DVec3, f64)| {
                middle.cross(direction).length() <= radius * (1.0 + 1e-9) && middle.dot(direction) > 0.0
            };
            assert!(aim.balls.iter().any(|&ball| hits(ball)), "{direction}");
            for (count, &ball) in each.iter_mut().zip(&aim.balls) {
                *count += i32::from(hits(ball));
            }
        }
        assert!(each[0] > 3000 && each[1] > 3000, "{each:?}");
    }

    #[test]
    fn there_is_no_aim_from_within_or_where_balls_are_all_around() {
        assert!(aim().from(DVec3::new(0.0, 0.0, 2.8)).is_none());
        assert!(Aim::default().from(DVec3::ZERO).is_none());
        let around = Aim::at(vec![(DVec3::X, 0.99), (-DVec3::X, 0.99)]);
        assert!(around.from(DVec3::ZERO).is_none());
        // From far away the sphere is small, and its cone is as accurate as elsewhere.
        let far = Aim::at(vec![(DVec3::new(1e9, 0.0, 0.0), 1.0)]);
        let cones = far.from(DVec3::ZERO).unwrap();
        assert!((cones.angle / (PI * 1e-18) - 1.0).abs() < 1e-12);
        assert!(cones.density(cones.sample([0.3, 0.2]), 0.0) > 1e16);
    }
}
