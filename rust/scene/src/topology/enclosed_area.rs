//! The area enclosed by closed curves in a plane.

use raywright_base::math::DVec2;

/// Fill rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Points with non-zero winding number; their area is negative if the number is.
    Winding,
    /// Points surrounded by an odd number of curves.
    EvenOdd,
}

/// A segment of a curve, from its lower end to its upper.
#[derive(Clone, Copy, Debug)]
struct Rising {
    low: DVec2,
    high: DVec2,
    /// Change of the winding number from its left to its right.
    step: i32,
}

impl Rising {
    fn at(&self, y: f64) -> f64 {
        if y <= self.low.y {
            self.low.x
        } else if y >= self.high.y {
            self.high.x
        } else {
            self.low.x + (self.high.x - self.low.x) * ((y - self.low.y) / (self.high.y - self.low.y))
        }
    }
}

/// The area enclosed by the segments of closed curves.
///
/// The plane is cut into slabs at the heights of all ends and crossings. Within a slab segments do not cross, and the
/// region between two adjacent ones is a trapezoid.
pub fn covered(segments: &[[DVec2; 2]], rule: Rule) -> f64 {
    let mut rising: Vec<Rising> = segments
        .iter()
        .filter(|[a, b]| a.y != b.y)
        .map(
            |&[a, b]| {
                if a.y < b.y { Rising { low: a, high: b, step: -1 } } else { Rising { low: b, high: a, step: 1 } }
            },
        )
        .collect();
    rising.sort_unstable_by(|a, b| a.low.y.total_cmp(&b.low.y));
    let mut heights: Vec<f64> = rising.iter().flat_map(|r| [r.low.y, r.high.y]).collect();
    heights.sort_unstable_by(f64::total_cmp);
    heights.dedup();
    let (mut open, mut next, mut area) = (Vec::<Rising>::new(), 0, 0.0);
    for ends in heights.windows(2) {
        let &[bottom, top] = ends else { continue };
        open.retain(|r| r.high.y > bottom);
        while next < rising.len() && rising[next].low.y <= bottom {
            open.push(rising[next]);
            next += 1;
        }
        area += slab(&open, bottom, top, rule);
    }
    area
}

/// Area within a slab that no segment ends in.
fn slab(open: &[Rising], bottom: f64, top: f64, rule: Rule) -> f64 {
    let mut spans: Vec<(f64, f64, i32)> = open.iter().map(|r| (r.at(bottom), r.at(top), r.step)).collect();
    spans.sort_unstable_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
    if spans.windows(2).all(|pair| pair[0].0 <= pair[1].0 && pair[0].1 <= pair[1].1) {
        return between(&spans, 0.0, 1.0, rule) * (top - bottom);
    }
    let mut cuts = vec![0.0, 1.0];
    for (i, a) in spans.iter().enumerate() {
        for b in &spans[i + 1..] {
            let (low, high) = (a.0 - b.0, a.1 - b.1);
            if low * high < 0.0 {
                cuts.push(low / (low - high));
            }
        }
    }
    cuts.sort_unstable_by(f64::total_cmp);
    let parts = cuts.windows(2).map(|ends| {
        let &[from, to] = ends else { return 0.0 };
        let middle = |span: &(f64, f64, i32)| span.0 + (span.1 - span.0) * 0.5 * (from + to);
        spans.sort_unstable_by(|a, b| middle(a).total_cmp(&middle(b)));
        between(&spans, from, to, rule)
    });
    parts.sum::<f64>() * (top - bottom)
}

/// Mean enclosed width times relative height, between two relative heights.
fn between(spans: &[(f64, f64, i32)], from: f64, to: f64, rule: Rule) -> f64 {
    let middle = |span: &(f64, f64, i32)| span.0 + (span.1 - span.0) * 0.5 * (from + to);
    let (mut number, mut width) = (0, 0.0);
    for pair in spans.windows(2) {
        number += pair[0].2;
        let sign = match rule {
            Rule::Winding => f64::from(number.signum()),
            Rule::EvenOdd => f64::from(number.rem_euclid(2)),
        };
        if sign != 0.0 {
            width += sign * (middle(&pair[1]) - middle(&pair[0]));
        }
    }
    width * (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(from: f64, to: f64, turns: bool) -> Vec<[DVec2; 2]> {
        let corners = [[from, from], [to, from], [to, to], [from, to]].map(DVec2::from_array);
        (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).map(|[a, b]| if turns { [b, a] } else { [a, b] }).collect()
    }

    #[test]
    fn squares_cover_what_either_rule_says() {
        for (parts, winding, even_odd) in [
            (vec![square(0.0, 1.0, false)], 1.0, 1.0),
            (vec![square(0.0, 1.0, true)], -1.0, 1.0),
            (vec![square(0.0, 3.0, false), square(1.0, 2.0, true)], 8.0, 8.0),
            (vec![square(0.0, 3.0, false), square(1.0, 2.0, false)], 9.0, 8.0),
            (vec![square(0.0, 2.0, false), square(1.0, 3.0, false)], 7.0, 6.0),
            (vec![square(0.0, 1.0, false), square(0.0, 1.0, false)], 1.0, 0.0),
        ] {
            let all = parts.concat();
            // Rotated, so that segments cross within slabs.
            for angle in [0.0, 0.3, 1.9] {
                let turned: Vec<_> = all.iter().map(|e| e.map(|p| DVec2::from_angle(angle).rotate(p))).collect();
                for (rule, wanted) in [(Rule::Winding, winding), (Rule::EvenOdd, even_odd)] {
                    let area = covered(&turned, rule);
                    assert!((area - wanted).abs() < 1e-12, "{area} for {wanted}, {rule:?} at {angle}");
                }
            }
        }
    }
}
