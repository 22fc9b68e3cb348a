//! Where a line meets a surface of revolution.

use super::{BASE, Profile, Revolution, SIDE, TIP};
use crate::math::{Number, Triple};
use crate::shapes::Contact;
use crate::shapes::line::Line;
use crate::shapes::meeting::{Meet, Meets, ends, roots};
use std::cmp::Ordering;

impl Revolution {
    /// Where a line meets it, with the foot of the axis as the line's origin of space.
    ///
    /// On the line the surface is `a t² + 2 b t + c = 0`. Inside it is the left side at most 0, if the axis is long enough; between
    /// the two planes the closed shape is convex, so that the line lies within from the first to the last of its meetings
    /// with side and caps. Which root lies between the planes, and which plane is met within its disk, follows from the signs of
    /// the left side and of its derivative where the line meets the planes: no root is compared with anything.
    pub fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets> {
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
            return Some(Meets::default());
        }
        let climbs = climb.sign()?;
        // The line meets a plane at p / climb.
        let planes = [height.negated(), top.minus(&height)];
        if climbs == Ordering::Equal && (planes[0].sign()? == Ordering::Greater || planes[1].sign()? == Ordering::Less)
        {
            return Some(Meets::default());
        }
        let mut side = Side::of(a_sign, &b, || discriminant.sign())?;
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
                // A line that climbs must meet the base plane first.
                let base_side = (i == 0) == (climbs == Ordering::Greater);
                side.clip(base_side, a_sign, there, slope, i);
            }
        }
        let mut met = Ends::default();
        for i in 0..2 {
            if caps[i] {
                // A cap without a radius is the side's own point.
                let part = if self.radii()[i] == 0.0 { SIDE } else { [BASE, TIP][i] };
                met.add(planes[i].over(&climb).rounded()?, part);
            }
        }
        let contact = match side {
            Side::None => None,
            Side::Two { keep, on_plane } => {
                if keep.contains(&true) {
                    // A root is zero only if c is.
                    c.sign()?;
                    let both = roots(&a, &b, &c, &discriminant)?;
                    for i in 0..2 {
                        if keep[i] {
                            met.add(self.value(&both[i], on_plane[i], &planes, &climb)?, SIDE);
                        }
                    }
                }
                Some(Contact::Inside)
            }
            Side::One { keep, on_plane, double } => {
                if keep {
                    let root = if double { b.over(&a).negated() } else { c.over(&b.plus(&b)).negated() };
                    c.sign()?;
                    met.add(self.value(&root, on_plane, &planes, &climb)?, SIDE);
                }
                // Through the point of a cone, and within it before or after: moved by next to nothing it crosses once.
                let through = if a_sign == Ordering::Less { Contact::Crossing } else { Contact::Touching };
                Some(if double { through } else { Contact::Inside })
            }
        };
        Some(met.told(self.capped, contact.unwrap_or(Contact::Inside)))
    }

    /// The f64 of a root: that of the plane's, where it lies on one.
    fn value<N: Number>(&self, root: &N, on_plane: Option<usize>, planes: &[N; 2], climb: &N) -> Option<f64> {
        match on_plane {
            Some(i) => planes[i].over(climb).rounded(),
            None => root.rounded(),
        }
    }

    /// The coefficients a, b, c along the line, and b² − a c up to a positive factor of exactly 1 in closest-approach form, that is
    /// without the terms that always cancel.
    ///
    /// With P = d × v, R = w × v, m = d × w, and A, B what the axis adds along the line: P·R squared less P² R² is
    /// −|P × R|² = −v² (m · v)² (Lagrange), and B P − A R = (B d − A w) × v with (w · v) d − (d · v) w = v × m.
    fn polynomial<N: Number>(
        &self,
        line: &Line<N>,
        v: &Triple<N>,
        [vv, climb, height]: [&N; 3],
        [across, away, moment]: [&Triple<N>; 3],
    ) -> [N; 4] {
        let volume = moment.dot(v);
        let turned = v.cross(moment);
        match self.profile {
            Profile::Straight { base, tip } => {
                let k = N::of(tip).minus(&N::of(base));
                let foot = N::of(base).times(vv).times(&line.unit);
                let (widening, width) = (k.times(climb), foot.plus(&k.times(height)));
                let reach = line.direction.times(&foot).plus(&turned.times(&k)).cross(v);
                [
                    vv.times(&across.dot(across)).minus(&widening.squared()),
                    vv.times(&across.dot(away)).minus(&widening.times(&width)),
                    vv.times(&away.dot(away)).minus(&width.squared()),
                    vv.times(&reach.dot(&reach).minus(&vv.times(&volume).squared())),
                ]
            }
            Profile::Parabola { tip } => {
                let square = N::of(tip).squared().times(&line.unit);
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

/// The meetings with the infinite side, and which of them lie between the planes.
enum Side {
    None,
    /// The only root; of a tangent, or through a cone's point, double.
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

impl Side {
    fn of<N: Number>(a: Ordering, b: &N, discriminant: impl FnOnce() -> Option<Ordering>) -> Option<Self> {
        if a == Ordering::Equal {
            // With no linear term either the line runs along the surface, and so meets it edge-on, or never meets it.
            let none = b.sign()? == Ordering::Equal;
            return Some(if none { Self::None } else { Self::One { keep: true, on_plane: None, double: false } });
        }
        Some(match discriminant()? {
            Ordering::Less => Self::None,
            Ordering::Equal => Self::One { keep: true, on_plane: None, double: true },
            Ordering::Greater => Self::Two { keep: [true; 2], on_plane: [None; 2] },
        })
    }

    /// Drops the roots that lie before the line's meeting with plane `i` (`first`), or after it, by the signs of the polynomial and
    /// of half its derivative there.
    fn clip(&mut self, first: bool, a: Ordering, there: Ordering, slope: Ordering, i: usize) {
        // How a root compares with the plane's t.
        let against = |greater: bool, linear: bool| {
            if linear {
                // Half the derivative is b everywhere.
                return if slope == Ordering::Greater { there.reverse() } else { there };
            }
            // Right of the middle between the roots?
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

/// Up to four meetings.
#[derive(Default)]
struct Ends {
    all: [(f64, usize); 4],
    count: usize,
}

impl Ends {
    fn add(&mut self, t: f64, part: usize) {
        self.all[self.count] = (t, part);
        self.count += 1;
    }

    /// The first and the last of a closed shape; all of an open one.
    fn told(&mut self, capped: bool, contact: Contact) -> Meets {
        let all = &mut self.all[..self.count];
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        match all {
            [] => Meets::default(),
            [near, .., far] if capped => ends(*near, *far),
            [only] if capped => ends(*only, *only),
            all => {
                let mut meets = Meets::default();
                for (to, &mut (t, part)) in meets.iter_mut().zip(all) {
                    *to = Some(Meet { t, part, contact });
                }
                meets
            }
        }
    }
}
