//! Culling of few objects for sixteen rays at once, without a structure.

use crate::UserGeometry;
use raywright_base::math::{LANES, Ray};
use raywright_base::simd::{Level, loops};
use raywright_shapes::Ball;

/// Up to 16 objects with bounding spheres.
///
/// With few objects, most rays miss most of them. A bounding sphere test takes a few operations and handles sixteen
/// rays in parallel, whereas preparing and traversing a ray takes as long as the test of an object. Objects that are
/// not certainly missed are tested as everywhere else.
pub struct Few {
    numbers: Vec<u32>,
    balls: Vec<Ball>,
}

/// Maximum number of objects; for more, tree traversal is faster.
const OBJECTS: usize = 16;

impl Few {
    /// Set up culling, if the objects are few and static.
    pub fn new(numbers: &[u32], objects: &dyn UserGeometry) -> Option<Self> {
        if numbers.is_empty() || numbers.len() > OBJECTS || objects.moves() {
            return None;
        }
        let balls = numbers.iter().map(|&number| objects.around(number)).collect::<Option<_>>()?;
        Some(Self { numbers: numbers.to_vec(), balls })
    }

    /// A bit mask per ray, for at most sixteen rays, of the objects that it may hit.
    pub fn ask(&self, level: Level, rays: &[Ray], may_meet: &mut [u32; LANES]) {
        let mut origin = [[0.0; LANES]; 3];
        let mut direction = [[0.0; LANES]; 3];
        let (mut t_min, mut t_max) = ([0.0; LANES], [0.0; LANES]);
        for (lane, ray) in rays.iter().enumerate().take(LANES) {
            for axis in 0..3 {
                (origin[axis][lane], direction[axis][lane]) = (ray.origin[axis], ray.direction[axis]);
            }
            (t_min[lane], t_max[lane]) = (ray.t_min, ray.t_max);
        }
        *may_meet = [0; LANES];
        let mut passes = [0; LANES];
        for (bit, ball) in self.balls.iter().enumerate() {
            pass(level, ball, &origin, &direction, &t_min, &t_max, &mut passes);
            for (may_meet, passes) in may_meet.iter_mut().zip(passes) {
                *may_meet |= u32::from(passes == 0) << bit;
            }
        }
    }

    /// The numbers of the objects in a bit mask.
    #[inline(always)]
    pub fn numbers(&self, mut bits: u32) -> impl Iterator<Item = u32> {
        std::iter::from_fn(move || {
            let bit = (bits != 0).then(|| bits.trailing_zeros() as usize)?;
            bits &= bits - 1;
            Some(self.numbers[bit])
        })
    }

    /// Memory use in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice()) + size_of_val(self.balls.as_slice())
    }
}

loops! {
    /// Test which rays certainly miss a sphere: 1 for those.
    ///
    /// With w the vector from the center to the origin, a line of direction d has distance |w × d| / |d|. All compared
    /// terms err by less than 2⁻⁴⁸ of |w|² |d|², or of |w| |d|; 2⁻³⁶ of these is allowed, in the absence of underflow.
    /// With underflow or NaN nothing is certain.
    fn pass(
        ball: &Ball,
        origin: &[[f64; LANES]; 3],
        direction: &[[f64; LANES]; 3],
        t_min: &[f64; LANES],
        t_max: &[f64; LANES],
        passes: &mut [u64; LANES],
    ) {
        const SLACK: f64 = 1.0 / (1u64 << 36) as f64;
        const LEAST: f64 = f64::from_bits((1023 - 400) << 52);
        let square = ball.radius * ball.radius;
        for i in 0..LANES {
            let [x, y, z] = [
                origin[0][i] - ball.center.x,
                origin[1][i] - ball.center.y,
                origin[2][i] - ball.center.z,
            ];
            let [u, v, w] = [direction[0][i], direction[1][i], direction[2][i]];
            let length = u * u + v * v + w * w;
            let far = x * x + y * y + z * z;
            let [a, b, c] = [y * w - z * v, z * u - x * w, x * v - y * u];
            let moment = a * a + b * b + c * c;
            let level = square * length;
            let is_plain = (length >= LEAST) & (level >= LEAST);
            let is_beside = moment > level + SLACK * (far * length + level);
            // A ray that starts outside and heads away only recedes.
            let along = x * u + y * v + z * w;
            let is_outside = far > square + SLACK * (far + square);
            let is_behind = (along >= 0.0) & is_outside & (t_min[i] >= 0.0);
            // The closest approach is at −along / |d|², and the entry at most one radius earlier.
            let size = (far * length).sqrt();
            let entry = -along - (level.sqrt() + SLACK * (size + level.sqrt()));
            let is_beyond = is_outside & (entry > t_max[i] * length);
            passes[i] = u64::from(is_plain & (is_beside | is_behind | is_beyond));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Wanted;
    use proptest::prelude::*;
    use raywright_base::math::DVec3;
    use raywright_shapes::{Bounds, Candidate, Shape, Sphere};

    struct One(Sphere);

    impl UserGeometry for One {
        fn bounds(&self, _: u32) -> Option<Bounds> {
            Some(self.0.bounds())
        }

        fn around(&self, _: u32) -> Option<Ball> {
            Some(self.0.around())
        }

        fn meet(&self, _: u32, _: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
            self.0.meet(ray, met)
        }
    }

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            -4.0..4.0f64,
            (-1.0..1.0f64, -200i32..200).prop_map(|(x, e)| x * 2f64.powi(e)),
            Just(0.0),
            Just(f64::INFINITY),
            Just(f64::NAN),
        ]
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        [number(), number(), number()].prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        /// Rays of all kinds, half of them aimed at or near the rim, from near and far.
        #[test]
        fn what_is_passed_is_not_met(
            center in prop::array::uniform3(-3.0..3.0f64),
            bits in -60i32..60,
            origin in vector(),
            direction in vector(),
            aimed: bool,
            (part, off) in (0.0..1.0f64, -40i32..-1),
            (t_min, t_max) in (prop_oneof![Just(0.0), number()], prop_oneof![Just(f64::INFINITY), number()]),
        ) {
            let sphere = Sphere { center: center.into(), radius: 2f64.powi(bits) };
            let one = One(sphere.clone());
            let way = sphere.center - origin;
            let across = way.cross(DVec3::new(part, 1.0 - part, 0.3)).normalize_or_zero();
            let rim = way + across * sphere.radius * (1.0 + (part - 0.5) * 2f64.powi(off));
            let ray = Ray { t_min, t_max, ..Ray::new(origin, if aimed { rim } else { direction }) };
            let few = Few::new(&[7], &one).unwrap();
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let mut may_meet = [0; LANES];
                few.ask(level, &[ray], &mut may_meet);
                if may_meet[0] == 0 {
                    prop_assert!(!sphere.meet(&ray, &mut |_| true), "{ray:?}");
                }
            }
        }
    }

    #[test]
    fn most_rays_that_miss_are_told_so() {
        let one = One(Sphere { center: DVec3::ZERO, radius: 1.0 });
        let few = Few::new(&[0], &one).unwrap();
        let ray = |origin: DVec3, direction: DVec3| Ray::new(origin, direction);
        let rays = [
            ray(DVec3::X * 3.0, DVec3::Y),
            ray(DVec3::X * 3.0, DVec3::X),
            ray(DVec3::X * 1e9, DVec3::new(1.0, 1e-3, 0.0)),
            Ray { t_max: 1.9, ..ray(DVec3::X * 3.0, DVec3::NEG_X) },
            ray(DVec3::X * 3.0, DVec3::NEG_X),
            ray(DVec3::ZERO, DVec3::Z),
        ];
        let mut may_meet = [9; LANES];
        few.ask(Level::current().unwrap(), &rays, &mut may_meet);
        assert_eq!(may_meet[..6], [0, 0, 0, 0, 1, 1]);
        assert_eq!(few.numbers(0b1).collect::<Vec<_>>(), [0]);
    }
}
