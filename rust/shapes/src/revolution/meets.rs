//! Exact intersection of a line with a surface of revolution.

use super::{BASE, ProfileCurve, Revolution, SIDE, TIP};
use crate::Contact;
use crate::line::Line;
use crate::meeting::{Root, roots};
use crate::solid::{Meet, Meets};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Number, Ray, Triple};
use std::cmp::Ordering;

impl Revolution {
    /// The intersections of a line given relative to the foot of the axis.
    ///
    /// On the line the surface is `a t² + 2 b t + c = 0`, and the left side is at most 0 inside a sufficiently long
    /// shape. Between the two planes the closed shape is convex, so the line is inside it from the first to the last
    /// intersection with side and caps. The signs of the left side and of its derivative at the two planes decide which
    /// root lies between the planes and which plane is hit within its disk. No root is compared with anything.
    #[inline]
    pub(crate) fn meets_from_foot<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        let Line { origin: w, direction: d, unit } = line;
        let v = Triple::between(self.base, self.tip);
        let vv = v.dot(&v);
        let (across, away) = (d.cross(&v), w.cross(&v));
        let (climb, height) = (d.dot(&v), w.dot(&v));
        let top = vv.times(unit);
        let moment = d.cross(w);
        let [a, b, c, discriminant] = self.polynomial(line, &v, [&vv, &climb, &height], [&across, &away, &moment]);
        let a_sign = a.sign()?;
        if a_sign == Ordering::Greater && discriminant.sign()? == Ordering::Less {
            return Some(Meets::new(self.capped));
        }
        let climbs = climb.sign()?;
        // The line intersects a plane at p / climb.
        let planes = [height.negated(), top.minus(&height)];
        if climbs == Ordering::Equal && (planes[0].sign()? == Ordering::Greater || planes[1].sign()? == Ordering::Less)
        {
            return Some(Meets::new(self.capped));
        }
        let mut side = EndSide::of(a_sign, &b, || discriminant.sign())?;
        let mut caps = [false; 2];
        if climbs != Ordering::Equal {
            for (i, p) in planes.iter().enumerate() {
                let square = climb.squared();
                let there = a
                    .times(&p.squared())
                    .plus(&b.times(&p.times(&climb)).times(&N::of(2.0)))
                    .plus(&c.times(&square))
                    .sign()?;
                caps[i] = self.capped && there != Ordering::Greater;
                let slope = a.times(p).plus(&b.times(&climb)).sign()?;
                let slope = if climbs == Ordering::Less { slope.reverse() } else { slope };
                // An ascending line crosses the base plane first.
                let base_side = (i == 0) == (climbs == Ordering::Greater);
                side.clip(base_side, a_sign, there, slope, i);
            }
        }
        let mut met = Meets::new(self.capped);
        let plane = |i: usize| Root { t: planes[i].over(&climb), slope: climb.clone() };
        for i in 0..2 {
            if caps[i] {
                // A cap of radius 0 is a point of the side.
                let part = if self.radii()[i] == 0.0 { SIDE } else { [BASE, TIP][i] };
                met = met.with(meet(plane(i), N::of(0.0), [BASE, TIP][i], part, Contact::Inside));
            }
        }
        // A root on a plane is computed from the plane.
        let on_side = |root: &Root<N>, on_plane: Option<usize>, contact: Contact| match on_plane {
            Some(i) => meet(plane(i), N::of(0.0), [BASE, TIP][i], SIDE, contact),
            None => meet(root.clone(), a.clone(), SIDE, SIDE, contact),
        };
        match side {
            EndSide::None => {}
            EndSide::Two { keep, on_plane } => {
                if keep.contains(&true) {
                    let both = roots(&a, &b, &c, &discriminant)?;
                    for i in 0..2 {
                        if keep[i] {
                            met = met.with(on_side(&both[i], on_plane[i], Contact::Inside));
                        }
                    }
                }
            }
            EndSide::One { keep, on_plane, double } => {
                if keep {
                    let slope = if double { N::of(0.0) } else { b.plus(&b) };
                    let t = if double { b.over(&a).negated() } else { c.over(&slope).negated() };
                    // Through the apex of a cone and inside before or after: the perturbed line crosses once.
                    let through = if a_sign == Ordering::Less { Contact::Crossing } else { Contact::Touching };
                    let contact = if double { through } else { Contact::Inside };
                    met = met.with(on_side(&Root { t, slope }, on_plane, contact));
                }
            }
        }
        Some(met)
    }

    /// Return whether a ray's line is certainly farther from the axis' line than any point of the surface: |(d × w) ·
    /// v| > r |d × v|. It rejects most near misses.
    ///
    /// Let u = [`UNIT`], and w and v the rounded vectors. A cross product errs by 3√2 u of the product of its factors'
    /// lengths, and the triple product by (3√2 + 4) u of |d| |w| |v|. The limits on lengths exclude underflow.
    #[inline]
    pub(crate) fn is_passed_by(&self, ray: &Ray) -> bool {
        const LEAST: f64 = f64::from_bits((1023 - 200) << 52);
        let (d, w, v) = (ray.direction, ray.origin - self.base, self.tip - self.base);
        let (d_length, w_length, v_length) = (d.length(), w.length(), v.length());
        let [base, tip] = self.radii();
        let radius = base.max(tip);
        let usual = |x: f64| (LEAST..1.0 / LEAST).contains(&x);
        let plane = d_length * v_length;
        let volume = d.cross(w).dot(v).abs() - 9.0 * UNIT * plane * w_length;
        let reach = radius * (d.cross(v).length() + 5.0 * UNIT * plane);
        usual(d_length) && usual(w_length) && usual(v_length) && usual(radius) && volume > reach * (1.0 + 16.0 * UNIT)
    }

    /// The implicit function of a part's whole surface, at a point in units relative to the foot of the axis. On a line
    /// it equals the polynomial of [`Revolution::meets`].
    #[inline]
    pub(crate) fn zero_on<N: Number>(&self, part: usize, point: &Triple<N>, unit: &N) -> N {
        let v = Triple::between(self.base, self.tip);
        let height = point.dot(&v);
        let top = || v.dot(&v).times(unit);
        let away = || point.cross(&v);
        match (part, self.profile) {
            (BASE, _) => height,
            (TIP, _) => height.minus(&top()),
            (_, ProfileCurve::Straight { base, tip }) if base == tip => {
                let away = away();
                away.dot(&away).minus(&N::of(base).times(unit).squared().times(&v.dot(&v)))
            }
            (_, ProfileCurve::Straight { base, tip }) => {
                let (vv, away) = (v.dot(&v), away());
                let widening = N::of(tip).minus(&N::of(base)).times(&height);
                let width = N::of(base).times(&vv).times(unit).plus(&widening);
                vv.times(&away.dot(&away)).minus(&width.squared())
            }
            (_, ProfileCurve::Parabola { tip }) => {
                let away = away();
                away.dot(&away).minus(&N::of(tip).squared().times(unit).times(&height))
            }
        }
    }

    /// The coefficients a, b, c along the line, and b² − a c up to a positive factor. The latter is in closest-approach
    /// form, without the terms that always cancel.
    ///
    /// Let P = d × v, R = w × v, m = d × w, and A, B the axial parts along the line. (P·R)² − P² R² is −|P × R|² = −v²
    /// (m · v)² (Lagrange). B P − A R = (B d − A w) × v with (w · v) d − (d · v) w = v × m.
    fn polynomial<N: Number>(
        &self,
        line: &Line<N>,
        v: &Triple<N>,
        [vv, climb, height]: [&N; 3],
        [across, away, moment]: [&Triple<N>; 3],
    ) -> [N; 4] {
        let volume = moment.dot(v);
        match self.profile {
            // A cylinder has its own polynomial, smaller by a factor of v².
            ProfileCurve::Straight { base, tip } if base == tip => {
                let square = N::of(base).times(&line.unit).squared().times(vv);
                let a = across.dot(across);
                let discriminant = square.times(&a).minus(&vv.times(&volume.squared()));
                [a, across.dot(away), away.dot(away).minus(&square), discriminant]
            }
            ProfileCurve::Straight { base, tip } => {
                let k = N::of(tip).minus(&N::of(base));
                let foot = N::of(base).times(vv).times(&line.unit);
                let (widening, width) = (k.times(climb), foot.plus(&k.times(height)));
                let turned = v.cross(moment);
                let reach = line.direction.times(&foot).plus(&turned.times(&k)).cross(v);
                [
                    vv.times(&across.dot(across)).minus(&widening.squared()),
                    vv.times(&across.dot(away)).minus(&widening.times(&width)),
                    vv.times(&away.dot(away)).minus(&width.squared()),
                    vv.times(&reach.dot(&reach).minus(&vv.times(&volume).squared())),
                ]
            }
            ProfileCurve::Parabola { tip } => {
                let square = N::of(tip).squared().times(&line.unit);
                let turned = v.cross(moment);
                let half = square.times(climb).times(&N::of(0.5));
                [
                    across.dot(across),
                    across.dot(away).minus(&half),
                    away.dot(away).minus(&square.times(height)),
                    half.squared()
                        .plus(&square.times(&across.dot(&turned.cross(v))))
                        .minus(&vv.times(&volume.squared())),
                ]
            }
        }
    }
}

/// The intersections with the infinite side surface, and whether they lie between the planes.
enum EndSide {
    None,
    /// The only root; double if the line is tangent or passes through the apex.
    One {
        keep: bool,
        on_plane: Option<usize>,
        double: bool,
    },
    /// The lesser and the greater root.
    Two {
        keep: [bool; 2],
        on_plane: [Option<usize>; 2],
    },
}

impl EndSide {
    fn of<N: Number>(a: Ordering, b: &N, discriminant: impl FnOnce() -> Option<Ordering>) -> Option<Self> {
        if a == Ordering::Equal {
            // Without a linear term the line is either contained in the surface, and so edge-on, or misses it.
            let none = b.sign()? == Ordering::Equal;
            return Some(if none { Self::None } else { Self::One { keep: true, on_plane: None, double: false } });
        }
        Some(match discriminant()? {
            Ordering::Less => Self::None,
            Ordering::Equal => Self::One { keep: true, on_plane: None, double: true },
            Ordering::Greater => Self::Two { keep: [true; 2], on_plane: [None; 2] },
        })
    }

    /// Discard the roots before the intersection with plane `i` if `first`, else those after it. The signs of the
    /// polynomial and of half its derivative at the plane decide.
    fn clip(&mut self, first: bool, a: Ordering, there: Ordering, slope: Ordering, i: usize) {
        // The order of a root and the plane's t.
        let against = |greater: bool, linear: bool| {
            if linear {
                // Half the derivative is constant, b.
                return if slope == Ordering::Greater { there.reverse() } else { there };
            }
            // Whether the plane's t exceeds the midpoint of the roots.
            let right = if a == Ordering::Greater { slope } else { slope.reverse() };
            let outside = if a == Ordering::Greater { there } else { there.reverse() };
            match (outside, right) {
                (Ordering::Less, _) => {
                    if greater {
                        Ordering::Greater
                    } else {
                        Ordering::Less
                    }
                }
                (Ordering::Equal, Ordering::Greater) => {
                    if greater {
                        Ordering::Equal
                    } else {
                        Ordering::Less
                    }
                }
                (Ordering::Equal, Ordering::Less) => {
                    if greater {
                        Ordering::Greater
                    } else {
                        Ordering::Equal
                    }
                }
                (Ordering::Equal, Ordering::Equal) => Ordering::Equal,
                (Ordering::Greater, right) => right.reverse(),
            }
        };
        let apply = |keep: &mut bool, on_plane: &mut Option<usize>, order: Ordering| {
            *keep &= order != if first { Ordering::Less } else { Ordering::Greater };
            if order == Ordering::Equal {
                *on_plane = Some(i);
            }
        };
        match self {
            Self::None => {}
            Self::One { keep, on_plane, double } => apply(keep, on_plane, against(true, !*double)),
            Self::Two { keep, on_plane } => {
                apply(&mut keep[0], &mut on_plane[0], against(false, false));
                apply(&mut keep[1], &mut on_plane[1], against(true, false));
            }
        }
    }
}

fn meet<N>(Root { t, slope }: Root<N>, bend: N, surface: usize, part: usize, contact: Contact) -> Meet<N> {
    Meet { t, slope, bend, surface, part, contact }
}
