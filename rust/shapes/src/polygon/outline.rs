//! Exact predicates on rings of 2D points: orientation, and whether rings cross or touch.

use glam::DVec2;
use raywright_base::math::robust::UNIT;
use raywright_base::math::{DVec3, exact_edges};

/// The side of the line from `a` to `b` on which `c` lies: 1 left, −1 right, 0 on it. Exact for finite numbers.
///
/// The error bound is that of Shewchuk ("Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
/// Predicates", 1997). Products that may have underflowed or overflowed are decided exactly.
pub fn orientation(a: DVec2, b: DVec2, c: DVec2) -> i32 {
    let left = (b.x - a.x) * (c.y - a.y);
    let right = (b.y - a.y) * (c.x - a.x);
    let (area, size) = (left - right, left.abs() + right.abs());
    if size > 1e-280 && area.abs() > 4.0 * UNIT * size {
        return if area > 0.0 { 1 } else { -1 };
    }
    let [a, b, c] = [a, b, c].map(|p| p.extend(0.0));
    let [volume, ..] = exact_edges(a, DVec3::Z, [a, b, c]);
    i32::from(volume > 0.0) - i32::from(volume < 0.0)
}

/// Return whether `a` is lower than `b`, or as high and farther left. This is the order by height in an infinitesimally
/// sheared plane, where no two points have equal height.
pub fn is_before(a: DVec2, b: DVec2) -> bool {
    a.y < b.y || (a.y == b.y && a.x < b.x)
}

/// Return whether a point that lies on no edge of a ring is inside it.
pub fn is_inside(point: DVec2, ring: &[DVec2]) -> bool {
    let crossed = edges(ring).filter(|&(a, b)| {
        let (low, high) = if is_before(a, b) { (a, b) } else { (b, a) };
        !is_before(point, low) && is_before(point, high) && orientation(low, high, point) > 0
    });
    crossed.count() % 2 == 1
}

/// The edges of a ring, from each point to the next.
pub fn edges(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

/// Check that the first ring is a valid outline and the others are valid holes. Rejected are two equal points in a row,
/// rings that cross or touch themselves or each other, and holes outside the outline or inside other holes. The error
/// says what is wrong and where.
pub fn check(rings: &[Vec<DVec2>]) -> Result<(), String> {
    for (r, ring) in rings.iter().enumerate() {
        if let Some(i) = edges(ring).position(|(a, b)| a == b) {
            let next = (i + 1) % ring.len();
            return Err(format!("points {i} and {next} of {} are the same", name(r)));
        }
    }
    if let Some((one, other)) = first_meeting(rings) {
        let place = |e: &Edge| format!("edge {} of {}", e.index, name(e.ring));
        return Err(format!("{} crosses or touches {}", place(&one), place(&other)));
    }
    for (h, hole) in rings.iter().enumerate().skip(1) {
        if !is_inside(hole[0], &rings[0]) {
            return Err(format!("{} is outside the outline", name(h)));
        }
        if let Some(other) = (1..rings.len()).find(|&other| other != h && is_inside(hole[0], &rings[other])) {
            return Err(format!("{} is inside {}", name(h), name(other)));
        }
    }
    Ok(())
}

/// The name of a ring in error messages.
pub fn name(ring: usize) -> String {
    if ring == 0 { "the outline".to_owned() } else { format!("hole {}", ring - 1) }
}

/// An edge and its position in its ring.
#[derive(Clone, Copy)]
struct Edge {
    ring: usize,
    index: usize,
    count: usize,
    from: DVec2,
    to: DVec2,
}

impl Edge {
    fn least(&self) -> DVec2 {
        self.from.min(self.to)
    }

    fn greatest(&self) -> DVec2 {
        self.from.max(self.to)
    }

    /// Return whether `other` starts where this one ends.
    fn precedes(&self, other: &Self) -> bool {
        self.ring == other.ring && (self.index + 1) % self.count == other.index
    }

    /// Return whether two edges share a point, other than the common corner of neighbors.
    fn meets(&self, other: &Self) -> bool {
        if self.least().cmpgt(other.greatest()).any() || other.least().cmpgt(self.greatest()).any() {
            return false;
        }
        if other.precedes(self) {
            return other.meets(self);
        }
        if self.precedes(other) {
            let (a, corner, b) = (self.from, self.to, other.to);
            // Folded back along the same line.
            return orientation(a, corner, b) == 0 && is_before(a, corner) == is_before(b, corner);
        }
        let side = |edge: &Self, p| orientation(edge.from, edge.to, p);
        // Collinear edges meet if their bounding boxes do.
        side(other, self.from) * side(other, self.to) <= 0 && side(self, other.from) * side(self, other.to) <= 0
    }
}

/// Two edges that meet but must not. A sweep by least x compares only edges that overlap in x.
fn first_meeting(rings: &[Vec<DVec2>]) -> Option<(Edge, Edge)> {
    let mut all: Vec<Edge> = Vec::new();
    for (ring, points) in rings.iter().enumerate() {
        let count = points.len();
        all.extend(edges(points).enumerate().map(|(index, (from, to))| Edge { ring, index, count, from, to }));
    }
    all.sort_by(|a, b| a.least().x.total_cmp(&b.least().x));
    let mut active: Vec<Edge> = Vec::new();
    for edge in all {
        active.retain(|other| other.greatest().x >= edge.least().x);
        if let Some(&other) = active.iter().find(|other| other.meets(&edge)) {
            let first = (other.ring, other.index) < (edge.ring, edge.index);
            return Some(if first { (other, edge) } else { (edge, other) });
        }
        active.push(edge);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    fn ring(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().map(|&p| DVec2::from_array(p)).collect()
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];

    fn refusal(rings: &[&[[f64; 2]]]) -> String {
        check(&rings.iter().map(|r| ring(r)).collect::<Vec<_>>()).unwrap_err()
    }

    proptest! {
        #[test]
        fn sides_are_exact(
            a in [-9i64..9, -9..9], b in [-9i64..9, -9..9], k in -9i64..9, ulps in -2i64..=2, power in -60i32..60,
        ) {
            // On the line, or a few ulps beside it, in units of 2⁻⁵⁰.
            let unit = 1i64 << 48;
            let at = |i: usize| a[i] * unit + k * (b[i] - a[i]) * (unit / 16);
            let c = [at(0), at(1) + ulps];
            let (a, b) = (a.map(|x| x * unit), b.map(|x| x * unit));
            let big = |x: i64| BigInt::from(x);
            let wanted = (big(b[0]) - a[0]) * (big(c[1]) - a[1]) - (big(b[1]) - a[1]) * (big(c[0]) - a[0]);
            let place = |p: [i64; 2]| DVec2::from_array(p.map(|x| x as f64 * 2f64.powi(power)));
            let sign = wanted.cmp(&BigInt::ZERO) as i32;
            prop_assert_eq!(orientation(place(a), place(b), place(c)), sign);
            prop_assert_eq!(orientation(place(b), place(a), place(c)), -sign);
        }

        #[test]
        fn stars_are_outlines_and_swapped_points_are_not(
            radii in prop::collection::vec(0.5..2.0f64, 4..40), swap in 0usize..40,
        ) {
            let count = radii.len();
            let at = |(i, r): (usize, &f64)| DVec2::from_angle(i as f64 * std::f64::consts::TAU / count as f64) * *r;
            let mut star: Vec<DVec2> = radii.iter().enumerate().map(at).collect();
            prop_assert_eq!(check(&[star.clone()]), Ok(()));
            star.swap(swap % count, (swap + 1) % count);
            let crossed = |s: &[DVec2]| {
                let e: Vec<_> = edges(s).collect();
                let beyond = |i: usize, j: usize| {
                    let ((a, b), (c, d)) = (e[i], e[j]);
                    orientation(a, b, c) * orientation(a, b, d) <= 0 && orientation(c, d, a) * orientation(c, d, b) <= 0
                };
                (0..count).any(|i| (i + 2..count).any(|j| (i, j) != (0, count - 1) && beyond(i, j)))
            };
            prop_assert_eq!(check(&[star.clone()]).is_err(), crossed(&star));
        }
    }

    #[test]
    fn what_is_no_outline_is_told() {
        assert_eq!(check(&[ring(&SQUARE)]), Ok(()));
        assert_eq!(check(&[ring(&SQUARE), ring(&[[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]])]), Ok(()));
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(refusal(&[&bow]), "edge 0 of the outline crosses or touches edge 2 of the outline");
        let spike = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(refusal(&[&spike]).starts_with("edge 0 of the outline crosses or touches"));
        let back = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.5, 0.5]];
        assert!(refusal(&[&back]).starts_with("edge 1 of the outline crosses or touches edge"));
        let twice = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
        assert_eq!(refusal(&[&twice]), "points 1 and 2 of the outline are the same");
        let corner = [[2.0, 2.0], [4.0, 4.0], [2.0, 3.0]];
        assert!(refusal(&[&SQUARE, &corner]).contains("touches"));
        assert_eq!(refusal(&[&SQUARE, &[[5.0, 5.0], [6.0, 5.0], [5.0, 6.0]]]), "hole 0 is outside the outline");
        let (wide, small) = ([[1.0, 1.0], [3.0, 1.0], [1.0, 3.0]], [[1.2, 1.2], [1.4, 1.2], [1.2, 1.4]]);
        assert_eq!(refusal(&[&SQUARE, &wide, &small]), "hole 1 is inside hole 0");
    }
}
