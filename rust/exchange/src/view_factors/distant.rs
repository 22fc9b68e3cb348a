//! View factors of distant triangles by cubature over both.

use super::facet::Facet;
use raywright_base::math::DVec3;
use raywright_base::simd::{Level, loops};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Maximum number of points of a rule.
const MOST: usize = 48;

/// Points of a triangle, as weights of its second and third corner, and their weights, which sum to 1. Padded to whole
/// vectors with weights of 0.
struct Rule {
    points: usize,
    second: [f64; MOST],
    third: [f64; MOST],
    weight: [f64; MOST],
}

impl Rule {
    fn new(of: &[([f64; 2], f64)]) -> Self {
        let mut rule =
            Self { points: of.len().next_multiple_of(8), second: [0.0; MOST], third: [0.0; MOST], weight: [0.0; MOST] };
        for (i, &([second, third], weight)) in of.iter().enumerate() {
            (rule.second[i], rule.third[i], rule.weight[i]) = (second, third, weight);
        }
        rule
    }

    /// A rule exact to degree 5 with 7 points (Radon 1948).
    fn seven() -> Self {
        let root = 15f64.sqrt();
        let mut of = vec![([1.0 / 3.0; 2], 9.0 / 40.0)];
        for sign in [1.0, -1.0] {
            let (a, weight) = ((6.0 - sign * root) / 21.0, (155.0 - sign * root) / 1200.0);
            of.extend([[a, a], [a, 1.0 - 2.0 * a], [1.0 - 2.0 * a, a]].map(|point| (point, weight)));
        }
        Self::new(&of)
    }

    /// A symmetric rule given by orbits about the center. Each has a weight and one or two of the barycentric
    /// coordinates; with one, the other two are equal. The remaining weight is at the center.
    fn of_orbits(pairs: &[[f64; 2]], triples: &[[f64; 3]]) -> Self {
        let mut of = Vec::with_capacity(MOST);
        for &[weight, a] in pairs {
            let b = 0.5 * (1.0 - a);
            of.extend([[a, b], [b, a], [b, b]].map(|point| (point, weight)));
        }
        for &[weight, a, b] in triples {
            let c = 1.0 - a - b;
            of.extend([[a, b], [a, c], [b, a], [b, c], [c, a], [c, b]].map(|point| (point, weight)));
        }
        let rest = 1.0 - of.iter().map(|point| point.1).sum::<f64>();
        if rest > 1e-9 {
            of.push(([1.0 / 3.0; 2], rest));
        }
        Self::new(&of)
    }

    /// A rule exact to degree 8 with 16 points (Lyness and Jespersen 1975).
    fn sixteen() -> Self {
        Self::of_orbits(
            &[
                [0.095_091_634_267_284_62, 0.081_414_823_414_553_7],
                [0.103_217_370_534_718_25, 0.658_861_384_496_479_6],
                [0.032_458_497_623_198_08, 0.898_905_543_365_938],
            ],
            &[[0.027_230_314_174_434_994, 0.008_394_777_409_957_605, 0.263_112_829_634_638_1]],
        )
    }

    /// A rule exact to degree 10 with 25 points (Dunavant 1985).
    fn twenty_five() -> Self {
        Self::of_orbits(
            &[
                [0.036_725_957_756_466_7, 0.028_844_733_232_685_245],
                [0.045_321_059_435_527_94, 0.781_036_849_029_925_9],
            ],
            &[
                [0.072_757_916_845_420_11, 0.141_707_219_414_879_95, 0.307_939_838_764_120_95],
                [0.028_327_242_531_057_485, 0.025_003_534_762_686_386, 0.246_672_560_639_902_7],
                [0.009_421_666_963_732_823, 0.009_540_815_400_299_458, 0.066_803_251_012_200_27],
            ],
        )
    }

    /// A rule exact to degree 14 with 42 points (Dunavant, "High Degree Efficient Symmetrical Gaussian Quadrature Rules
    /// for the Triangle", 1985).
    fn forty_two() -> Self {
        Self::of_orbits(
            &[
                [0.021_883_581_369_428_89, 0.022_072_179_275_642_723],
                [0.032_788_353_544_125_35, 0.164_710_561_319_092_15],
                [0.051_774_104_507_291_586, 0.453_044_943_382_322_7],
                [0.042_162_588_736_993_02, 0.645_588_935_174_913_1],
                [0.014_433_699_669_776_668, 0.876_400_233_818_254_8],
                [0.004_923_403_602_400_082, 0.961_218_077_502_597_9],
            ],
            &[
                [0.024_665_753_212_563_674, 0.057_124_757_403_647_94, 0.172_266_687_821_355_58],
                [0.038_571_510_787_060_68, 0.092_916_249_356_971_82, 0.336_861_459_796_345],
                [0.014_436_308_113_533_84, 0.014_646_950_055_654_41, 0.298_372_882_136_257_75],
                [0.005_010_228_838_500_672, 0.001_268_330_932_872_025, 0.118_974_497_696_956_85],
            ],
        )
    }
}

/// The rules, and the maximum ratio of both radii to the distance for each.
static RULES: OnceLock<[Rule; 4]> = OnceLock::new();
const RATIOS: [f64; 4] = [0.05, 0.18, 0.35, 0.7];

/// Points of a triangle, with their weights times their heights above the other's plane.
struct PatchPoints {
    x: [f64; MOST],
    y: [f64; MOST],
    z: [f64; MOST],
    weight: [f64; MOST],
}

impl PatchPoints {
    const NONE: Self = Self { x: [0.0; MOST], y: [0.0; MOST], z: [0.0; MOST], weight: [0.0; MOST] };
}

loops! {
    fn place(rule: &Rule, corners: &[DVec3; 3], heights: &[f64; 3], to: &mut PatchPoints) {
        let [a, b, c] = *corners;
        let (ab, ac) = (b - a, c - a);
        for i in 0..rule.points {
            let (second, third) = (rule.second[i], rule.third[i]);
            to.x[i] = a.x + ab.x * second + ac.x * third;
            to.y[i] = a.y + ab.y * second + ac.y * third;
            to.z[i] = a.z + ab.z * second + ac.z * third;
            let height = heights[0] * (1.0 - second - third) + heights[1] * second + heights[2] * third;
            to.weight[i] = rule.weight[i] * height;
        }
    }
}

loops! {
    fn sum(points: usize, one: &PatchPoints, other: &PatchPoints, to: &mut f64) {
        let mut sums = [0.0; 8];
        // Divisions dominate the time: one for four points, in whole vectors.
        for four in (0..points).step_by(4) {
            for start in (0..points).step_by(8) {
                let [xs, ys, zs, weights] =
                    [&other.x, &other.y, &other.z, &other.weight].map(|of| &of[start..start + 8]);
                for lane in 0..8 {
                    let fraction = |i: usize| {
                        let (dx, dy, dz) = (xs[lane] - one.x[i], ys[lane] - one.y[i], zs[lane] - one.z[i]);
                        let square = dx * dx + dy * dy + dz * dz;
                        (one.weight[i], square * square)
                    };
                    let (a, b) = added(fraction(four), fraction(four + 1));
                    let (c, d) = added(fraction(four + 2), fraction(four + 3));
                    let (above, below) = added((a, b), (c, d));
                    sums[lane] += weights[lane] * above / below;
                }
            }
        }
        *to = sums.iter().sum();
    }
}

/// The sum of two fractions whose numbers are near 1, in units of the distance.
#[inline(always)]
fn added((a, b): (f64, f64), (c, d): (f64, f64)) -> (f64, f64) {
    (a * d + c * b, b * d)
}

/// Cubature over two triangles, with its scratch space.
pub struct Quadrature {
    level: Level,
    rules: &'static [Rule; 4],
    from: PatchPoints,
    to: PatchPoints,
}

impl Quadrature {
    /// For a SIMD level.
    pub fn new(level: Level) -> Self {
        let rules = RULES.get_or_init(|| [Rule::seven(), Rule::sixteen(), Rule::twenty_five(), Rule::forty_two()]);
        Self { level, rules, from: PatchPoints::NONE, to: PatchPoints::NONE }
    }

    /// The area of `one` times its view factor to `other`, if each is wholly in front of the other. None if they are
    /// too near. `heights` are those of the other's corners above the plane of `one`, and vice versa.
    #[inline]
    pub fn distant(&mut self, one: &Facet, other: &Facet, heights: [[f64; 3]; 2]) -> Option<f64> {
        let reach = one.radius + other.radius;
        let square = one.centre.distance_squared(other.centre);
        let rule = RATIOS.iter().position(|&most| reach * reach <= most * most * square)?;
        Some(self.by_rule(rule, one, other, heights))
    }

    fn by_rule(&mut self, rule: usize, one: &Facet, other: &Facet, [to_other, to_one]: [[f64; 3]; 2]) -> f64 {
        let (level, rule) = (self.level, &self.rules[rule]);
        // In units of the distance, relative to the center of `one`.
        let unit = 1.0 / other.centre.distance(one.centre);
        let near = |facet: &Facet| facet.corners.map(|corner| (corner - one.centre) * unit);
        place(level, rule, &near(one), &to_one.map(|h| h * unit), &mut self.from);
        place(level, rule, &near(other), &to_other.map(|h| h * unit), &mut self.to);
        let mut total = 0.0;
        sum(level, rule.points, &self.from, &self.to, &mut total);
        total * (one.area * unit) * (other.area * unit) / PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view_factors::contour::contour;
    use raywright_base::sampling::Sampler;

    #[test]
    fn rules_integrate_polynomials() {
        // The mean of x^p y^q over the triangle is 2 p! q! / (p + q + 2)!.
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        for (rule, degree) in
            [(Rule::seven(), 5), (Rule::sixteen(), 8), (Rule::twenty_five(), 10), (Rule::forty_two(), 14)]
        {
            for p in 0..=degree {
                for q in 0..=degree - p {
                    let term = |i: usize| rule.weight[i] * rule.second[i].powi(p as i32) * rule.third[i].powi(q as i32);
                    let truth = 2.0 * factorial(p) * factorial(q) / factorial(p + q + 2);
                    let sum: f64 = (0..rule.points).map(term).sum();
                    assert!((sum / truth - 1.0).abs() < 1e-12, "{degree} {p} {q}: {sum} for {truth}");
                }
            }
        }
    }

    /// Two triangles with corners in unit boxes at some distance.
    fn drawn(number: u32) -> [Facet; 2] {
        let mut sampler = Sampler::new(1, number, 0);
        let mut dimension = 0;
        let mut next = || {
            dimension += 1;
            sampler.one(dimension)
        };
        let away = 0.5 * 100f64.powf(next());
        let mut corner = || DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5);
        let at = corner().normalize() * away;
        let one = Facet::new([corner(), corner(), corner()]);
        [one, Facet::new([at + corner(), at + corner(), at + corner()])]
    }

    #[test]
    fn points_agree_with_quarters_and_with_contours() {
        let mut quadrature = Quadrature::new(Level::current().unwrap());
        let mut asked = [0; 2];
        for number in 0..4000 {
            let [one, other] = drawn(number);
            let heights = [one.heights(&other), other.heights(&one)];
            if heights.iter().flatten().any(|&h| h <= 0.0) {
                continue;
            }
            let Some(found) = quadrature.distant(&one, &other, heights) else { continue };
            let mut truth = 0.0;
            for a in one.quarters() {
                for b in other.quarters() {
                    truth += quadrature.by_rule(3, &a, &b, [a.heights(&b), b.heights(&a)]);
                }
            }
            assert!((found / truth - 1.0).abs() < 1e-9, "{number}: {found} for {truth}");
            asked[0] += 1;
            // The terms of the contour integrals are of the order of the radii's product.
            let around = contour(&one, &other);
            let cancelled = 3e-13 * one.radius.max(other.radius).powi(2);
            assert!((around - truth).abs() < 1e-10 * truth + cancelled, "{number}: {around} for {truth}");
            asked[1] += usize::from(cancelled < 1e-9 * truth);
        }
        assert!(asked[0] > 300 && asked[1] > 50, "{asked:?}");
    }
}
