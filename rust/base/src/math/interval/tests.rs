use super::*;
use crate::math::DoubleDouble;
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -3.0..3.0f64,
        (-4i32..=4).prop_map(f64::from),
        (-1.0..1.0f64, -60i32..60).prop_map(|(m, e)| m * 2f64.powi(e)),
    ]
}

/// An interval and a number in it.
fn inside() -> impl Strategy<Value = (Interval, f64)> {
    (number(), number(), prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64]).prop_map(|(a, b, part)| {
        let (low, high) = (a.min(b), a.max(b));
        (Interval::new(low, high), (low + (high - low) * part).clamp(low, high))
    })
}

/// Return whether an interval contains a double-double number.
fn holds(interval: Interval, x: DoubleDouble) -> bool {
    DoubleDouble::from(interval.low) <= x && x <= DoubleDouble::from(interval.high)
}

type Unary = (fn(Interval) -> Interval, fn(f64) -> f64);

const UNARY: [Unary; 15] = [
    (Interval::abs, f64::abs),
    (Interval::sqrt, f64::sqrt),
    (Interval::exp, f64::exp),
    (Interval::ln, f64::ln),
    (Interval::sin, f64::sin),
    (Interval::cos, f64::cos),
    (Interval::tan, f64::tan),
    (Interval::asin, f64::asin),
    (Interval::acos, f64::acos),
    (Interval::atan, f64::atan),
    (Interval::sinh, f64::sinh),
    (Interval::cosh, f64::cosh),
    (Interval::tanh, f64::tanh),
    (|x| x.power(3), |x| x * x * x),
    (|x| x.power(-2), |x| 1.0 / (x * x)),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]
    #[test]
    fn arithmetic_holds_the_exact_value((x, a) in inside(), (y, b) in inside()) {
        prop_assert!(holds(x.plus(y), DoubleDouble::difference(a, -b)));
        prop_assert!(holds(x.minus(y), DoubleDouble::difference(a, b)));
        prop_assert!(holds(x.times(y), DoubleDouble::product(a, b)));
        if b != 0.0 {
            let quotient = DoubleDouble::from(a) / DoubleDouble::from(b);
            prop_assert!(holds(x.over(y), quotient), "{x:?} / {y:?} = {:?}", x.over(y));
            prop_assert_eq!(x.over(y).whole, !y.contains(0.0));
        }
        if a >= 0.0 {
            prop_assert!(holds(x.sqrt(), DoubleDouble::from(a).sqrt()));
        }
        prop_assert!(x.least(y).contains(a.min(b)) && x.greatest(y).contains(a.max(b)));
        prop_assert!(x.hull(y).contains(a) && x.hull(y).contains(b));
    }

    #[test]
    fn what_is_exact_stays_exact(a in -1000i32..1000, b in -1000i32..1000) {
        let [x, y] = [a, b].map(f64::from);
        let [p, q] = [x, y].map(Interval::point);
        prop_assert_eq!(p.plus(q), Interval::point(x + y));
        prop_assert_eq!(p.times(q), Interval::point(x * y));
        prop_assert_eq!(p.power(2).sqrt(), Interval::point(x.abs()));
        if b != 0 {
            prop_assert_eq!(p.times(q).over(q), Interval::point(x));
        }
    }

    #[test]
    fn functions_hold_their_values((x, a) in inside()) {
        for (index, (interval, plain)) in UNARY.iter().enumerate() {
            let (image, value) = (interval(x), plain(a));
            if value.is_finite() {
                prop_assert!(image.contains(value), "function {index} of {x:?} at {a}: {image:?}, {value}");
            }
            if image.whole {
                // Defined everywhere, including both ends.
                prop_assert!(!plain(x.low).is_nan() && !plain(x.high).is_nan());
            }
        }
    }

    #[test]
    fn functions_of_two_hold_their_values((x, a) in inside(), (y, b) in inside()) {
        prop_assert!(y.atan2(x).contains(b.atan2(a)), "{:?}", y.atan2(x));
        if a > 0.0 && a.powf(b).is_finite() {
            prop_assert!(x.raised(y).contains(a.powf(b)), "{:?}", x.raised(y));
        }
    }

    #[test]
    fn a_point_is_nearly_a_point(a in -20.0..20.0f64) {
        let root = Interval::point(a.abs()).raised(Interval::point(0.3));
        prop_assert!(root.high - root.low <= 16.0 * f64::EPSILON * root.high);
        for interval in [Interval::sin, Interval::cos, Interval::exp, Interval::atan, Interval::tanh] {
            let image = interval(Interval::point(a));
            prop_assert!(image.high - image.low <= 16.0 * f64::EPSILON * image.magnitude());
        }
    }
}

#[test]
fn parts_of_a_domain() {
    assert!(Interval::new(-2.0, -1.0).sqrt().is_empty());
    assert!(Interval::new(2.0, 3.0).asin().is_empty());
    assert!(Interval::point(0.0).ln().is_empty());
    assert!(Interval::point(1.0).over(Interval::point(0.0)).is_empty());
    assert_eq!(Interval::new(-4.0, 9.0).sqrt(), Interval { low: 0.0, high: 3.0, whole: false });
    assert_eq!(
        Interval::new(1.0, 2.0).over(Interval::new(0.0, 4.0)),
        Interval { low: 0.25, high: f64::INFINITY, whole: false }
    );
    assert_eq!(
        Interval::new(1.0, 2.0).over(Interval::new(-4.0, 0.0)),
        Interval { low: f64::NEG_INFINITY, high: -0.25, whole: false }
    );
    assert_eq!(Interval::new(1.0, 2.0).over(Interval::new(-1.0, 4.0)), Interval::ANYTHING);
    assert_eq!(Interval::new(1.0, 2.0).tan(), Interval::ANYTHING);
    assert!(!Interval::new(-1.0, 1.0).atan2(Interval::new(-2.0, -1.0)).whole);
    assert!(Interval::new(0.0, 1.0).atan2(Interval::new(-2.0, -1.0)).whole);
    assert!(
        Interval::EMPTY.plus(Interval::point(1.0)).is_empty() && Interval::point(1.0).times(Interval::EMPTY).is_empty()
    );
    let huge = Interval::point(f64::MAX);
    assert_eq!(huge.plus(huge), Interval { low: f64::MAX, high: f64::INFINITY, whole: true });
    assert_eq!(huge.times(huge).low, f64::MAX);
}
