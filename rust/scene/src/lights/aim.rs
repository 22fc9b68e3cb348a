//! Balls that light which sets out is aimed at.

use raywright_base::math::turn::sin_cos_turn;
use raywright_base::math::{DVec3, Frame};
use std::f64::consts::TAU;

/// Balls that are worth aiming at: about mirrors and glass, which gather light, and of which lights know nothing.
///
/// What falls beside them matters as well, so that directions are drawn from cones to the balls or as a light shines,
/// and weighed by the density of both together (Veach and Guibas, 1995: the one-sample model). The more a place sees of
/// the balls, the less it aims; what is within one of them does not.
#[derive(Clone, Debug, Default)]
pub struct Aim {
    /// The middle and the radius of each.
    balls: Vec<(DVec3, f64)>,
}

/// The cones from a place to balls.
pub(super) struct Cones<'a> {
    balls: &'a [(DVec3, f64)],
    place: DVec3,
    /// The sum of their solid angles.
    angle: f64,
    /// How often to aim.
    share: f64,
}

/// 1 - cos θ of the cone to a ball in which a place is not, without the cancellation of small ones.
fn height((middle, radius): (DVec3, f64), place: DVec3) -> f64 {
    let square = radius * radius / middle.distance_squared(place);
    square / (1.0 + (1.0 - square).sqrt())
}

impl Aim {
    /// How often light aims at most.
    const SHARE: f64 = 0.5;

    /// At balls of these middles and radii.
    pub fn at(balls: Vec<(DVec3, f64)>) -> Self {
        Self { balls }
    }

    /// What is aimed at from a place; `None` where that is nothing.
    #[inline]
    pub(super) fn from(&self, place: DVec3) -> Option<Cones<'_>> {
        let mut angle = 0.0;
        for &(middle, radius) in &self.balls {
            if middle.distance_squared(place) <= radius * radius {
                return None;
            }
            angle += TAU * height((middle, radius), place);
        }
        // As much as a surface can see of anything.
        let share = Self::SHARE * (1.0 - angle / TAU);
        (angle > 0.0 && share > 0.0).then_some(Cones { balls: &self.balls, place, angle, share })
    }
}

impl Cones<'_> {
    /// How often to aim.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Draws a direction into one of the cones, by numbers that are uniform in [0, 1).
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
        // What is left of the choice is uniform in the cone again; roundings must not lead beyond it.
        let down = (left / TAU).min(height);
        let across = (down * (2.0 - down)).sqrt();
        let [sin, cos] = sin_cos_turn(v);
        let axis = (middle - self.place).normalize();
        Frame::new(axis).to_world(DVec3::new(across * cos, across * sin, 1.0 - down))
    }

    /// The density with which a unit direction is drawn in either way, by solid angle, where a light has this one.
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
        // The density over all directions is 1, for those that a light draws alike too.
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
        // The small ball fills 2e-7 of all: what is drawn towards it is seen in the second mean alone.
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
        // From far away the ball is small, and its cone as exact as anywhere.
        let far = Aim::at(vec![(DVec3::new(1e9, 0.0, 0.0), 1.0)]);
        let cones = far.from(DVec3::ZERO).unwrap();
        assert!((cones.angle / (PI * 1e-18) - 1.0).abs() < 1e-12);
        assert!(cones.density(cones.sample([0.3, 0.2]), 0.0) > 1e16);
    }
}
