//! The zeros of a function of one number, in order, none skipped.
//!
//! What is known of the function is an enclosure of its values and first two derivatives over any interval. An interval
//! whose values exclude zero has no root. Where the slope excludes zero there is one if the signs at the ends differ,
//! else none. Where the second derivative excludes it the slope has at most one zero, which splits the interval into
//! two of that kind. What is left is halved (Moore 1966; Mitchell, "Robust Ray Intersection with Interval Arithmetic",
//! 1990).
//!
//! At single points f64 leaves a sign open where the value is zero to within rounding. Such points, and intervals too
//! short to halve, make a *zone*. When the next sign is certain, the zone is told once: as a crossing if it differs
//! from the last one, as a touch if not. So roots that rounding cannot tell apart count as one, or as none that is
//! crossed, and signs always alternate between crossings.
//!
//! Where the function is not continuous, or not defined everywhere, short intervals count only if a point in them may
//! be zero itself: so a pole or a jump is no root.

use super::jet::Jet;
use crate::Contact;
use raywright_base::math::Interval;

/// The most intervals that are looked at on one line. Beyond it, those that are left are taken as they are.
pub const WORK: usize = 4096;

/// A function on a line.
pub trait Function {
    /// Bounds of the values and derivatives over an interval.
    fn enclosure(&mut self, over: Interval) -> Jet<Interval>;
    /// Bounds of the value at a point.
    fn at(&mut self, s: f64) -> Interval;
    /// Value and derivatives, rounded.
    fn roughly(&mut self, s: f64) -> Jet<f64>;
}

/// Where and how the function is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Where.
    pub place: f64,
    /// Whether it changes its sign.
    pub contact: Contact,
}

/// The sign of a function at a point: certain, open, or the function is not defined there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    Certain(i32),
    Open,
    Undefined,
}

impl Sign {
    fn of(value: Interval) -> Self {
        match value.sign() {
            _ if value.is_empty() => Self::Undefined,
            0 => Self::Open,
            sign => Self::Certain(sign),
        }
    }

    /// Whether both are certain and differ.
    fn differs(self, other: Self) -> bool {
        matches!((self, other), (Self::Certain(a), Self::Certain(b)) if a != b)
    }
}

/// Points that follow each other and may all be zeros.
#[derive(Clone, Copy, Debug)]
struct Zone {
    start: f64,
    end: f64,
    /// The point that is told of a touch.
    place: f64,
}

struct Search<'a, F> {
    function: &'a mut F,
    /// Shorter intervals are not halved.
    shortest: f64,
    met: &'a mut dyn FnMut(Root) -> bool,
    /// The last certain sign and where it was found; none at the beginning and where the function is not defined.
    last: Option<(i32, f64)>,
    zone: Option<Zone>,
    stopped: bool,
}

/// Calls `met` with every root from `span.low` to `span.high` that is not certainly outside of `wanted`, in order,
/// until it says true, and says whether it did.
///
/// Which roots there are does not depend on `wanted`, which only saves work. Places are told to within some units of
/// `shortest`.
pub fn roots<F: Function>(
    function: &mut F,
    span: Interval,
    wanted: Interval,
    shortest: f64,
    met: &mut dyn FnMut(Root) -> bool,
) -> bool {
    let mut search = Search { function, shortest, met, last: None, zone: None, stopped: false };
    let ends = [span.low, span.high].map(|s| (s, search.function.at(s)));
    let mut stack = vec![ends];
    let mut work = 0;
    while let Some([(a, at_a), (b, at_b)]) = stack.pop() {
        if search.stopped || (a > wanted.high && search.zone.is_none()) {
            return search.stopped;
        }
        if let (true, Sign::Certain(sign)) = (b < wanted.low, Sign::of(at_b)) {
            (search.last, search.zone) = (Some((sign, b)), None);
            continue;
        }
        work += 1;
        if !search.settle((a, at_a), (b, at_b), work > WORK) {
            let middle = 0.5 * (a + b);
            let at_middle = search.function.at(middle);
            stack.push([(middle, at_middle), (b, at_b)]);
            stack.push([(a, at_a), (middle, at_middle)]);
        }
    }
    // A zone at the very end: the surface reaches it.
    search.undefined();
    search.stopped
}

impl<F: Function> Search<'_, F> {
    /// Tells the roots of an interval if it need not be halved, and whether that was so.
    fn settle(&mut self, (a, at_a): (f64, Interval), (b, at_b): (f64, Interval), must: bool) -> bool {
        let (sign_a, sign_b) = (Sign::of(at_a), Sign::of(at_b));
        let all = self.function.enclosure(Interval::new(a, b));
        let mut value = all.value;
        if value.whole {
            // By the mean value theorem, from either end.
            let width = Interval::point(b).minus(Interval::point(a));
            let (low, high) = (Interval { low: 0.0, ..width }, Interval { low: 0.0, ..width }.negated());
            value = value.intersection(at_a.plus(all.slope.times(low)));
            value = value.intersection(at_b.plus(all.slope.times(high)));
            if value.is_empty() {
                value = all.value;
            }
        }
        if value.is_empty() {
            self.undefined();
            return true;
        }
        if value.sign() != 0 {
            // Certain all along, except where it may not be defined.
            if !value.whole {
                self.undefined();
            }
            self.visit(b, Sign::Certain(value.sign()));
            return true;
        }
        if value.low == 0.0 && value.high == 0.0 && value.whole {
            self.widen(a, b, a);
            return true;
        }
        if value.whole && all.slope.sign() != 0 {
            self.between((a, sign_a), (b, sign_b));
            return true;
        }
        if value.whole && all.bend.sign() != 0 && all.bend.magnitude().is_finite() {
            let (left, right) = (self.function.roughly(a).slope, self.function.roughly(b).slope);
            if (left < 0.0) == (right < 0.0) {
                self.between((a, sign_a), (b, sign_b));
            } else {
                let turn = self.change((a, b), left < 0.0, |jet| (jet.slope, jet.bend));
                let sign = Sign::of(self.function.at(turn));
                self.between((a, sign_a), (turn, sign));
                self.between((turn, sign), (b, sign_b));
            }
            return true;
        }
        if b - a > self.shortest && !must {
            return false;
        }
        let middle = 0.5 * (a + b);
        if all.value.whole {
            self.widen(a, b, middle);
            return true;
        }
        for (place, at) in [(a, at_a), (middle, self.function.at(middle)), (b, at_b)] {
            match Sign::of(at) {
                Sign::Open if at.whole => self.visit(place, Sign::Open),
                // Beside a pole, or beyond a jump: whatever was before says nothing.
                _ => self.undefined(),
            }
        }
        if let Sign::Certain(sign) = sign_b {
            self.last = Some((sign, b));
        }
        true
    }

    /// An interval in which the function only rises or only falls.
    fn between(&mut self, (a, sign_a): (f64, Sign), (b, sign_b): (f64, Sign)) {
        self.visit(a, sign_a);
        if sign_a.differs(sign_b) && !self.stopped {
            let place = self.change((a, b), sign_a == Sign::Certain(-1), |jet| (jet.value, jet.slope));
            self.tell(place, Contact::Inside);
            self.last = None;
        }
        self.visit(b, sign_b);
    }

    /// Goes past a point of which the sign is known.
    fn visit(&mut self, s: f64, sign: Sign) {
        match sign {
            Sign::Open => self.widen(s, s, s),
            Sign::Undefined => self.undefined(),
            Sign::Certain(sign) => {
                if let Some(zone) = self.zone.take() {
                    match self.last {
                        Some((before, _)) if before == sign => self.tell(zone.place, Contact::Touching),
                        // A wide zone is a stretch where the function is zero: it begins at its start.
                        Some((before, from)) if zone.end - zone.start <= 64.0 * self.shortest => {
                            let place = self.change((from, s), before < 0, |jet| (jet.value, jet.slope));
                            self.tell(place, Contact::Inside);
                        }
                        _ => self.tell(zone.start, Contact::Inside),
                    }
                }
                self.last = Some((sign, s));
            }
        }
    }

    /// Goes past what is not defined: a zone before it ends there.
    fn undefined(&mut self) {
        if let Some(zone) = self.zone.take() {
            self.tell(zone.start, Contact::Inside);
        }
        self.last = None;
    }

    fn widen(&mut self, start: f64, end: f64, place: f64) {
        let zone = self.zone.get_or_insert(Zone { start, end, place });
        zone.end = end;
    }

    fn tell(&mut self, place: f64, contact: Contact) {
        self.stopped = self.stopped || (self.met)(Root { place, contact });
    }

    /// Where something of the function, told with its derivative, changes its sign, from below to above zero if it
    /// `rises`: by Newton's method, and by halving where that leaves the interval.
    fn change(&mut self, (mut a, mut b): (f64, f64), rises: bool, part: impl Fn(Jet<f64>) -> (f64, f64)) -> f64 {
        let mut place = 0.5 * (a + b);
        for _ in 0..200 {
            let (value, slope) = part(self.function.roughly(place));
            if value == 0.0 {
                return place;
            }
            if (value < 0.0) == rises {
                a = place
            } else {
                b = place
            }
            let next = place - value / slope;
            let next = if next > a && next < b { next } else { 0.5 * (a + b) };
            let step = (next - place).abs();
            place = next;
            if step <= 0.25 * self.shortest || b - a <= 0.25 * self.shortest || place <= a || place >= b {
                break;
            }
        }
        place
    }
}
