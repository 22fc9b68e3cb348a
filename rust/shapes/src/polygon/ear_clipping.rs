//! Triangulation of one ring by ear clipping (Meisters, "Polygons have ears", 1975), with exact decisions.

use super::outline::orientation;
use glam::DVec2;
use raywright_base::math::DVec3;
use std::collections::VecDeque;

/// Maximum number of corner tests, in total and per corner, after which ears are no longer tested. A huge polygon would
/// need its squared number of corners.
const EFFORT: u64 = 1 << 30;
const EFFORT_PER_CORNER: u64 = 1 << 16;
/// After this many corners without an ear, the ring intersects itself, and any corner is cut off.
const MOST_CROSSINGS: u32 = 64;

/// Triangulate polygons given by their numbers of corners. `corners` holds their corners in sequence as indices into
/// `points`. A polygon of n corners yields n − 2 triangles, of indices into `corners`; one with fewer than three yields
/// none.
///
/// A polygon becomes a fan from its first corner if all triangles of the fan have the polygon's orientation, as for
/// convex ones. All others are projected along the largest coordinate of their Newell normal, which keeps two
/// coordinates unchanged. A simple polygon in a plane is covered exactly once, and so is one whose holes are connected
/// to its outline by edges traversed twice. Corners on the edge between their neighbors get triangles with a nonzero
/// area if possible. Polygons that are not finite or have no area become fans.
pub fn triangulate(points: &[[f64; 3]], corners: &[i64], counts: &[usize]) -> Vec<[i64; 3]> {
    let corner = |i: usize| DVec3::from_array(points[corners[i] as usize]);
    let mut triangles = Vec::with_capacity(corners.len());
    let mut ring = Vec::new();
    let mut effort = EFFORT + EFFORT_PER_CORNER * corners.len() as u64;
    let mut first = 0;
    for &count in counts {
        let start = first as i64;
        // Most polygons are quads, which need no ring.
        if count == 4 {
            let (a, b, c, d) = (corner(first), corner(first + 1), corner(first + 2), corner(first + 3));
            let (front, back) = ((b - a).cross(c - a), (c - a).cross(d - a));
            let total = front + back;
            if front.dot(total) > 0.0 && back.dot(total) > 0.0 {
                triangles.push([start, start + 1, start + 2]);
                triangles.push([start, start + 2, start + 3]);
                first += 4;
                continue;
            }
        }
        ring.clear();
        ring.extend((first..first + count).map(corner));
        let clipped = if is_fan(&ring) { None } else { projected(&ring) };
        match clipped {
            Some(flat) => Ring::new(&flat)
                .clip(&mut effort, |[a, b, c]| triangles.push([start + a as i64, start + b as i64, start + c as i64])),
            None => triangles.extend((2..count as i64).map(|i| [start, start + i - 1, start + i])),
        }
        first += count;
    }
    triangles
}

/// Return whether all triangles from the first corner have the orientation of their sum, which is the polygon's
/// (Newell).
fn is_fan(ring: &[DVec3]) -> bool {
    if ring.len() <= 3 {
        return true;
    }
    let normals = || ring[1..].windows(2).map(|pair| (pair[0] - ring[0]).cross(pair[1] - ring[0]));
    let total: DVec3 = normals().sum();
    normals().all(|normal| normal.dot(total) > 0.0)
}

/// The corners projected along an axis so that they are anticlockwise; `None` if they are not finite or have no area.
fn projected(ring: &[DVec3]) -> Option<Vec<DVec2>> {
    let size = ring.iter().fold(0.0f64, |most, p| most.max(p.abs().max_element()));
    if !ring.iter().all(|p| p.is_finite()) || size == 0.0 {
        return None;
    }
    let anchor = ring[0] / size;
    let next = ring.iter().cycle().skip(1);
    let normal: DVec3 = ring.iter().zip(next).map(|(&p, &q)| (p / size - anchor).cross(q / size - anchor)).sum();
    let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
    let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] == 0.0 {
        return None;
    }
    if normal[axis] < 0.0 {
        (x, y) = (y, x);
    }
    Some(ring.iter().map(|p| DVec2::new(p[x], p[y])).collect())
}

/// The queue state of a corner.
#[derive(Clone, Copy, PartialEq)]
enum Waits {
    No,
    Queued,
    /// To be queued at the end once more.
    Postponed,
    Gone,
}

/// The remaining corners of a ring.
struct Ring<'a> {
    points: &'a [DVec2],
    before: Vec<usize>,
    after: Vec<usize>,
    /// Corners that do not turn anticlockwise. Only these need testing: of all corners inside an ear, the one farthest
    /// from its base is reflex.
    reflex: Vec<bool>,
    /// The initially reflex corners by x, and those that became reflex later.
    by_x: Vec<usize>,
    late: Vec<usize>,
}

impl<'a> Ring<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let count = points.len();
        let mut ring = Self {
            points,
            before: (0..count).map(|i| (i + count - 1) % count).collect(),
            after: (0..count).map(|i| (i + 1) % count).collect(),
            reflex: vec![false; count],
            by_x: Vec::new(),
            late: Vec::new(),
        };
        for i in 0..count {
            ring.reflex[i] = ring.turn(i) <= 0;
        }
        ring.by_x = (0..count).filter(|&i| ring.reflex[i]).collect();
        ring.by_x.sort_by(|&i, &j| points[i].x.total_cmp(&points[j].x));
        ring
    }

    fn turn(&self, i: usize) -> i32 {
        let [a, b, c] = self.around(i).map(|i| self.points[i]);
        orientation(a, b, c)
    }

    fn around(&self, i: usize) -> [usize; 3] {
        [self.before[i], i, self.after[i]]
    }

    /// Cut off ears until none is left. Cutting one changes the ear status of its neighbors only: if a corner inside
    /// some triangle stops being reflex, another reflex corner remains there.
    fn clip(mut self, effort: &mut u64, mut take: impl FnMut([usize; 3])) {
        let count = self.points.len();
        let mut queue: VecDeque<usize> = (1..count).chain([0]).collect();
        let mut waits = vec![Waits::Queued; count];
        let mut left = count;
        // A remaining corner, and the number of forced cuts.
        let (mut at, mut crossings) = (0, 0);
        while left > 3 {
            let (i, was_flat) = match queue.pop_front() {
                Some(i) if waits[i] == Waits::Postponed => {
                    waits[i] = Waits::Queued;
                    queue.push_back(i);
                    continue;
                }
                Some(i) if waits[i] == Waits::Gone => continue,
                Some(i) => {
                    waits[i] = Waits::No;
                    if self.reflex[i] || !self.is_clear(i, effort) {
                        continue;
                    }
                    (i, false)
                }
                None if crossings < MOST_CROSSINGS => {
                    let found = self.forced(at);
                    crossings += u32::from(!found.1);
                    found
                }
                None => (at, false),
            };
            take(self.around(i));
            self.cut(i);
            left -= 1;
            at = self.before[i];
            waits[i] = Waits::Gone;
            // Continuing elsewhere yields fewer slivers. A triangle of no area may have blocked any other ear.
            let ends = [self.before[i], self.after[i]];
            let again = if was_flat { count } else { 0 };
            for j in ends.into_iter().chain(0..again) {
                match waits[j] {
                    Waits::No => {
                        waits[j] = Waits::Queued;
                        queue.push_back(j);
                    }
                    Waits::Queued if !was_flat => waits[j] = Waits::Postponed,
                    _ => {}
                }
            }
        }
        take(self.around(at));
    }

    /// The corner to cut off if none is an ear, and whether its triangle has no area, so that the cut changes nothing.
    /// Without such a corner the ring intersects itself, and any convex corner will do.
    fn forced(&self, start: usize) -> (usize, bool) {
        let mut convex = start;
        let mut i = start;
        loop {
            let turn = self.turn(i);
            if turn == 0 {
                return (i, true);
            }
            if turn > 0 {
                convex = i;
            }
            i = self.after[i];
            if i == start {
                return (convex, false);
            }
        }
    }

    fn cut(&mut self, i: usize) {
        let [before, _, after] = self.around(i);
        (self.after[before], self.before[after]) = (after, before);
        self.reflex[i] = false;
        for end in [before, after] {
            let reflex = self.turn(end) <= 0;
            if reflex && !self.reflex[end] {
                self.late.push(end);
            }
            self.reflex[end] = reflex;
        }
    }

    /// Return whether no part of the ring lies inside the triangle of a corner.
    fn is_clear(&self, i: usize, effort: &mut u64) -> bool {
        let corners = self.around(i);
        let [a, b, c] = corners.map(|i| self.points[i]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let from = self.by_x.partition_point(|&j| self.points[j].x < low.x);
        let near = self.by_x[from..].iter().take_while(|&&j| self.points[j].x <= high.x);
        if *effort == 0 {
            return true;
        }
        near.chain(&self.late).all(|&j| {
            *effort = effort.saturating_sub(1);
            let p = self.points[j];
            if !self.reflex[j] || corners.contains(&j) || p.cmplt(low).any() || p.cmpgt(high).any() {
                return true;
            }
            // Edges from the ends of the base can leave the triangle only through a corner inside it.
            if p == a || p == c {
                return true;
            }
            if p == b {
                let is_within = |q: usize| {
                    let q = self.points[q];
                    orientation(a, b, q) > 0 && orientation(b, c, q) > 0
                };
                return !is_within(self.before[j]) && !is_within(self.after[j]);
            }
            orientation(a, b, p) < 0 || orientation(b, c, p) < 0 || orientation(c, a, p) < 0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    /// Twice the signed area of an integer triangle.
    fn doubled([a, b, c]: [[i64; 2]; 3]) -> BigInt {
        let big = |x: i64| BigInt::from(x);
        (big(b[0]) - a[0]) * (big(c[1]) - a[1]) - (big(b[1]) - a[1]) * (big(c[0]) - a[0])
    }

    fn alone(ring: &[[f64; 3]]) -> Vec<[usize; 3]> {
        let all: Vec<_> = (0..ring.len() as i64).collect();
        triangulate(ring, &all, &[ring.len()]).into_iter().map(|t| t.map(|i| i as usize)).collect()
    }

    /// Assert that triangles cover a ring once. None is inverted, their areas sum to the ring's, and inner edges are
    /// traversed once in each direction.
    fn assert_covers(ring: &[[i64; 2]]) {
        let corners: Vec<_> = ring.iter().map(|p| [p[0] as f64, p[1] as f64, 0.0]).collect();
        let triangles = alone(&corners);
        assert_eq!(triangles.len(), ring.len() - 2);
        let areas: Vec<_> = triangles.iter().map(|t| doubled(t.map(|i| ring[i]))).collect();
        let area: BigInt = (1..ring.len() - 1).map(|i| doubled([ring[0], ring[i], ring[i + 1]])).sum();
        let none = BigInt::from(0);
        assert!(areas.iter().all(|a| if area < none { *a <= none } else { *a >= none }), "{ring:?} {triangles:?}");
        assert_eq!(areas.iter().sum::<BigInt>(), area);
        let mut passed = std::collections::BTreeMap::new();
        for t in &triangles {
            for k in 0..3 {
                *passed.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        for (&(a, b), &times) in &passed {
            assert_eq!(times, 1);
            assert!(b == (a + 1) % ring.len() || passed.contains_key(&(b, a)), "edge {a} {b} of {ring:?}");
        }
    }

    proptest! {
        #[test]
        fn stars_are_covered_once(radii in prop::collection::vec(1i64..1000, 3..60), turned in any::<bool>()) {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let at = |(i, r): (usize, &i64)| {
                let p = DVec2::from_angle(i as f64 * step) * *r as f64 * 1e6;
                [p.x as i64, p.y as i64]
            };
            let mut ring: Vec<_> = radii.iter().enumerate().map(at).collect();
            if turned {
                ring.reverse();
            }
            assert_covers(&ring);
        }

        #[test]
        fn combs_of_steps_are_covered_once(heights in prop::collection::vec(0i64..4, 1..40), at in 0usize..80) {
            // Collinear corners, teeth of no height, and walls that touch no others.
            let mut ring = vec![[heights.len() as i64, -1], [0, -1]];
            ring.reverse();
            for (x, &height) in heights.iter().enumerate().rev() {
                ring.extend([[x as i64 + 1, height], [x as i64, height]]);
            }
            ring.dedup();
            let at = at % ring.len();
            ring.rotate_left(at);
            assert_covers(&ring);
        }

        #[test]
        fn holes_on_bridges_are_left_open(count in 1i64..6, at in 0usize..80) {
            // A row of square holes, each entered and left along one edge from the outline's lower edge.
            let mut ring = vec![[4 * count, 0], [4 * count, 4], [0, 4], [0, 0]];
            for k in 0..count {
                let (x, y) = (4 * k + 1, 1);
                ring.extend([[x, 0], [x, y], [x, y + 2], [x + 2, y + 2], [x + 2, y], [x, y], [x, 0]]);
            }
            let at = at % ring.len();
            ring.rotate_left(at);
            assert_covers(&ring);
        }
    }

    #[test]
    fn holes_that_touch_the_outline_are_left_open() {
        assert_covers(&[[0, 0], [8, 0], [8, 8], [0, 8], [0, 0], [2, 4], [4, 2]]);
        assert_covers(&[[0, 0], [4, 0], [2, 2], [6, 2], [4, 0], [8, 0], [8, 8], [0, 8]]);
        assert_covers(&[[0, 0], [4, 1], [0, 2], [1, 1]]);
        assert_covers(&[[0, 0], [0, 0], [4, 0], [4, 4], [4, 4]]);
    }

    #[test]
    fn every_corner_of_a_straight_edge_gets_an_area() {
        let corners = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [1.0, 2.0, 1.0]];
        let triangles = alone(&corners);
        let area = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| DVec3::from_array(corners[i]));
            (b - a).cross(c - a).z
        };
        assert!(triangles.iter().all(|t| area(t) > 0.0), "{triangles:?}");
    }

    #[test]
    fn rings_that_cross_themselves_everywhere_end() {
        let place = |i: u64| ((i * 7919 % 3001) as f64, (i * i * 104_729 % 2999) as f64);
        let ring: Vec<_> = (0..3000).map(|i| [place(i).0, place(i).1, 0.0]).collect();
        let triangles = alone(&ring);
        assert_eq!(triangles.len(), 2998);
        assert!((0..3000).all(|i| triangles.iter().any(|t| t.contains(&i))));
    }

    #[test]
    fn what_crosses_itself_or_has_no_area_still_has_its_triangles() {
        let bow = [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(alone(&bow).len(), 2);
        let line = [[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3], [f64::NAN; 3]];
        assert_eq!(triangulate(&line, &[0, 1, 2, 3, 4], &[2, 0, 3]), [[2, 3, 4]]);
        assert_eq!(alone(&line[..4]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(alone(&[[1e308, -1e308, 0.0], [0.0; 3], [1e308, 1e308, 0.0], [9e307, 0.0, 0.0]]).len(), 2);
    }
}
