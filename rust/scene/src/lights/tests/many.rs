//! Light selection among many lights.

use super::super::choice::{Choice, Strength};
use super::super::{Light, LightBounds, LightSampleContext, LightTree, PointLight, Reach, Sides, SpotLight};
use super::white;
use raywright_base::math::{DVec3, LANES, SingleLanes, VectorLanes};
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;
use raywright_base::sampling::warp::{uniform_sphere, uniform_triangle};

/// Small panels, points and spots at random in a room, with strengths that differ by factors of thousands.
fn strengths(count: u32) -> Vec<Strength> {
    (0..count)
        .map(|number| {
            let mut sampler = Sampler::new(12, 0, number);
            let at = DVec3::new(sampler.one(0), sampler.one(1), sampler.one(2)) * DVec3::new(20.0, 10.0, 3.0);
            let way = uniform_sphere(sampler.two(3));
            let strong = 10f64.powf(3.0 * sampler.one(4));
            match number % 4 {
                0 => {
                    let light = PointLight { position: at, intensity: white(strong) };
                    inside(&light)
                }
                1 => inside(&SpotLight::new(at, way, white(strong), 0.7, 0.2)),
                kind => {
                    let side = way.any_orthonormal_vector() * 0.3;
                    Strength::of_triangle(
                        [at, at + side, at + side.cross(way)],
                        false,
                        strong,
                        if kind == 2 { Sides::Both } else { Sides::Front },
                    )
                }
            }
        })
        .collect()
}

fn inside(light: &dyn Light) -> Strength {
    match light.reach() {
        Reach::Finite { power, bounds } => Strength { power, bounds },
        Reach::Infinite { .. } => panic!("a light inside"),
    }
}

fn receivers() -> Vec<LightSampleContext> {
    (0..20)
        .map(|number| {
            let mut sampler = Sampler::new(13, 0, number);
            let position = DVec3::new(sampler.one(0), sampler.one(1), sampler.one(2)) * DVec3::new(30.0, 15.0, 5.0);
            let normal = if number % 4 == 0 { DVec3::ZERO } else { uniform_sphere(sampler.two(3)) };
            LightSampleContext { position, normal, waves: None }
        })
        .collect()
}

#[test]
fn probabilities_are_those_of_draws_and_add_up_to_one() {
    for count in [1, 2, 3, 40, 300] {
        let lights = strengths(count);
        let choice = Choice::by_tree(&lights).unwrap();
        for (name, receiver) in (0u32..).zip(receivers()) {
            let probabilities: Vec<f64> = (0..lights.len()).map(|i| choice.probability(i, &receiver)).collect();
            let sum: f64 = probabilities.iter().sum();
            // If all lights of a subtree face away, its probability is lost.
            assert!(sum < 1.0 + 1e-12 && probabilities.iter().all(|p| *p >= 0.0), "{sum}");
            let (mut counts, mut none) = (vec![0; lights.len()], 0);
            for number in 0..4000 {
                match choice.sample(&receiver, Sampler::new(14, name, number).one(0)) {
                    Some((light, probability)) => {
                        counts[light] += 1;
                        assert!((probability / probabilities[light] - 1.0).abs() < 1e-12);
                    }
                    None => none += 1,
                }
            }
            counts.push(none);
            let expected: Vec<f64> = probabilities.into_iter().chain([(1.0 - sum).max(0.0)]).collect();
            let frequent = expected.iter().filter(|p| **p * 4000.0 >= 5.0).count();
            if frequent > 1 {
                // A probability below rounding error is never drawn.
                let expected: Vec<f64> = expected.iter().map(|&p| if p < 1e-12 { 0.0 } else { p }).collect();
                if counts.iter().zip(&expected).all(|(&c, &p)| p > 0.0 || c == 0) {
                    assert_frequencies(&counts, &expected);
                }
            }
        }
    }
}

#[test]
fn sixteen_receivers_choose_as_each_alone() {
    let receivers = receivers();
    let (mut position, mut normal) = (VectorLanes::ZERO, SingleLanes::ZERO);
    for lane in 0..LANES {
        position.set(lane, receivers[lane].position);
        normal.set(lane, receivers[lane].normal.as_vec3());
    }
    for count in [1, 2, 3, 8, 40] {
        let lights = strengths(count);
        for choice in [Choice::by_tree(&lights), Choice::by_power(&lights)].map(Option::unwrap) {
            let mut some = 0;
            for number in 0..200 {
                let u = std::array::from_fn(|lane| Sampler::new(16, lane as u32, number).one(0));
                for (lane, together) in choice.sample_lanes(&position, &normal, &u).into_iter().enumerate() {
                    let receiver = LightSampleContext { normal: normal.get(lane).as_dvec3(), ..receivers[lane] };
                    assert_eq!(together, choice.sample(&receiver, u[lane]), "{count} lights, lane {lane}");
                    some += usize::from(together.is_some());
                }
            }
            assert!(some > 200, "{count} lights: {some} were chosen");
        }
    }
}

/// Returns whether a light may contribute to a receiver.
fn brings(strength: &Strength, receiver: &LightSampleContext, number: u32) -> bool {
    let bounds = &strength.bounds;
    let mut sampler = Sampler::new(15, 0, number);
    // A point of a triangle is inside its box; the whole box is tested.
    let [x, y] = uniform_triangle(sampler.two(0));
    let at = bounds.min + (bounds.max - bounds.min) * DVec3::new(x, y, sampler.one(1));
    let way = (receiver.position - at).normalize();
    let angle = bounds.axis.dot(way).clamp(-1.0, 1.0).acos();
    let reach = bounds.cos_cone.acos() + bounds.cos_reach.acos();
    angle < reach - 1e-5 && (receiver.is_free() || receiver.normal.dot(-way) > 1e-9)
}

#[test]
fn what_brings_light_is_drawn() {
    let lights = strengths(400);
    let choice = Choice::by_tree(&lights).unwrap();
    let mut bright = 0;
    for receiver in receivers() {
        for (number, light) in (0u32..).zip(&lights) {
            if brings(light, &receiver, number) {
                bright += 1;
                assert!(choice.probability(number as usize, &receiver) > 0.0, "{light:?} {receiver:?}");
            }
        }
    }
    assert!(bright > 2000, "{bright}");
}

#[test]
fn bounds_hold_both_that_they_are_of() {
    let lights = strengths(200);
    for pair in lights.windows(2) {
        let [a, b] = [pair[0].bounds, pair[1].bounds];
        let both = a.union(&b);
        for part in [a, b] {
            assert!(both.min.cmple(part.min).all() && both.max.cmpge(part.max).all());
            let own = part.cos_cone.acos();
            let between = both.axis.dot(part.axis).clamp(-1.0, 1.0).acos();
            assert!(own + between <= both.cos_cone.acos() + 1e-12 || both.cos_cone == -1.0, "{own} {between}");
            assert!(both.cos_reach <= part.cos_reach);
        }
        assert!((both.intensity - a.intensity - b.intensity).abs() < 1e-9 * both.intensity);
    }
    let opposite = |axis: DVec3| LightBounds::surface([DVec3::ZERO; 2], Some(axis), 1.0);
    let both = opposite(DVec3::X).union(&opposite(DVec3::NEG_X));
    assert!(both.cos_cone < 1e-5, "half of all directions at least");
}

/// Mean and variance of the irradiance of point lights at a receiver, over a regular grid of choices, hence
/// deterministic.
fn estimate(choice: &Choice, lights: &[PointLight], receiver: &LightSampleContext) -> (f64, f64) {
    const DRAWS: u32 = 200_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..DRAWS {
        let Some((light, probability)) = choice.sample(receiver, (f64::from(i) + 0.5) / f64::from(DRAWS)) else {
            continue;
        };
        let sample = lights[light].sample(receiver, [0.5; 2]).unwrap();
        let x = sample.weight[1] * sample.direction.dot(receiver.normal).max(0.0) / probability;
        sum += x / f64::from(DRAWS);
        squares += x * x / f64::from(DRAWS);
    }
    (sum, squares - sum * sum)
}

#[test]
fn in_a_hall_of_lamps_a_tree_leaves_a_small_part_of_the_variance() {
    // A thousand lamps over a long floor: selection by power wastes nearly all samples on distant lamps.
    let lamp = |i: u32| PointLight {
        position: DVec3::new(f64::from(i % 100), f64::from(i / 100), 1.0 + f64::from(i % 7) / 7.0),
        intensity: white(1.0 + f64::from(i % 5)),
    };
    let lamps: Vec<PointLight> = (0..1000).map(lamp).collect();
    let strengths: Vec<Strength> = lamps.iter().map(|lamp| inside(lamp)).collect();
    let (tree, power) = (Choice::by_tree(&strengths).unwrap(), Choice::by_power(&strengths).unwrap());
    for (x, y) in [(0.0, 0.0), (50.3, 5.1), (99.0, 2.0)] {
        let receiver = LightSampleContext { position: DVec3::new(x, y, 0.0), normal: DVec3::Z, waves: None };
        let exact: f64 = lamps
            .iter()
            .map(|lamp| lamp.sample(&receiver, [0.5; 2]).map_or(0.0, |s| s.weight[1] * s.direction.z))
            .sum();
        let (mean, variance) = estimate(&tree, &lamps, &receiver);
        let (flat, more) = estimate(&power, &lamps, &receiver);
        assert!((mean / exact - 1.0).abs() < 1e-3 && (flat / exact - 1.0).abs() < 1e-3, "{mean} {flat} {exact}");
        assert!(variance < 0.02 * more, "{variance} {more}");
    }
}

#[test]
fn degenerate_lights_have_a_tree() {
    // Thousands at one position, in a row, with extreme ratios of strength, and none at all.
    let point = |x: f64, strong: f64| inside(&PointLight { position: DVec3::X * x, intensity: white(strong) });
    let same: Vec<_> = (0..3000).map(|_| point(1.0, 1.0)).collect();
    let row: Vec<_> = (0..3000).map(|i| point(f64::from(i).exp2().min(1e100), 1.0)).collect();
    let uneven: Vec<_> = (0..100).map(|i| point(f64::from(i), if i == 7 { 1e30 } else { 1e-30 })).collect();
    for lights in [same, row, uneven] {
        let choice = Choice::by_tree(&lights).unwrap();
        let place = LightSampleContext::free(DVec3::Y);
        let sum: f64 = (0..lights.len()).map(|i| choice.probability(i, &place)).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        let (light, probability) = choice.sample(&place, 1.0 - f64::EPSILON / 2.0).unwrap();
        assert!(probability > 0.0 && light < lights.len());
    }
    assert!(LightTree::new(&[]).is_none() && LightTree::new(&[None, Some(Strength::NONE.bounds)]).is_none());
}
