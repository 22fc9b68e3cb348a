//! Trapezoidal decomposition of a polygon, for uniform sampling.

use super::outline::{is_before, orientation};
use glam::DVec2;

/// The region between two edges over an interval of heights.
#[derive(Clone, Copy, Debug)]
pub struct Trapezoid {
    bottom: f64,
    top: f64,
    /// The horizontal intervals at the bottom and at the top.
    spans: [[f64; 2]; 2],
}

impl Trapezoid {
    /// Its area.
    pub fn area(&self) -> f64 {
        let [low, high] = self.widths();
        0.5 * (low + high) * (self.top - self.bottom)
    }

    /// Its corners: left and right at the bottom, right and left at the top.
    pub fn corners(&self) -> [DVec2; 4] {
        let [[left, right], [top_left, top_right]] = self.spans;
        let (low, high) = (self.bottom, self.top);
        [DVec2::new(left, low), DVec2::new(right, low), DVec2::new(top_right, high), DVec2::new(top_left, high)]
    }

    /// Sample a point uniformly by area.
    pub fn sample(&self, u: [f64; 2]) -> DVec2 {
        let [low, high] = self.widths();
        let root = ((1.0 - u[1]) * low * low + u[1] * high * high).sqrt();
        // The fraction of the height below which a fraction u of the area lies.
        let share = if low + root > 0.0 { u[1] * (low + high) / (low + root) } else { u[1] };
        let mix = |a: f64, b: f64, s: f64| a + (b - a) * s;
        let [left, right] = [0, 1].map(|side| mix(self.spans[0][side], self.spans[1][side], share));
        DVec2::new(mix(left, right, u[0]), mix(self.bottom, self.top, share))
    }

    fn widths(&self) -> [f64; 2] {
        self.spans.map(|[left, right]| right - left)
    }
}

/// Decompose the inside of rings that neither cross nor touch into disjoint trapezoids, at most three per point.
///
/// A horizontal sweep line moves upward over the points and keeps the edges it crosses from left to right. The inside
/// is between the first and the second, between the third and the fourth, and so on. A trapezoid ends where an edge of
/// its pair ends. Points of equal height are ordered from left to right, as in an infinitesimally sheared plane, so
/// horizontal edges need no special case.
pub fn trapezoids(rings: &[Vec<DVec2>]) -> Vec<Trapezoid> {
    let mut events: Vec<[DVec2; 3]> = Vec::new();
    for ring in rings {
        let count = ring.len();
        events.extend((0..count).map(|i| [ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count]]));
    }
    events.sort_by(|a, b| (a[1].y, a[1].x).partial_cmp(&(b[1].y, b[1].x)).expect("coordinates are finite"));
    let mut sweep = Sweep::default();
    for [before, point, after] in events {
        sweep.pass(point, [before, after]);
    }
    sweep.done
}

/// An edge, lower end first.
type Rising = [DVec2; 2];

#[derive(Default)]
struct Sweep {
    /// From left to right.
    edges: Vec<Rising>,
    /// The height at which the current trapezoid of each pair begins.
    since: Vec<f64>,
    done: Vec<Trapezoid>,
}

impl Sweep {
    fn pass(&mut self, point: DVec2, neighbours: [DVec2; 2]) {
        let place = self.edges.partition_point(|&[low, high]| orientation(low, high, point) < 0);
        let pair = place / 2;
        let splits = place % 2 == 1;
        match neighbours.map(|n| is_before(point, n)) {
            [true, true] => {
                let [a, b] = neighbours;
                let [left, right] = if orientation(point, b, a) > 0 { [a, b] } else { [b, a] };
                if splits {
                    self.close(pair, point.y);
                }
                self.since.insert(pair + usize::from(splits), point.y);
                self.edges.splice(place..place, [[point, left], [point, right]]);
            }
            [false, false] => {
                self.close(pair, point.y);
                if splits {
                    self.close(pair + 1, point.y);
                }
                self.since.remove(pair + usize::from(splits));
                self.edges.drain(place..place + 2);
            }
            [rises, _] => {
                self.close(pair, point.y);
                self.edges[place] = [point, neighbours[usize::from(!rises)]];
            }
        }
    }

    /// End a pair's trapezoid at a height, where its next one begins.
    fn close(&mut self, pair: usize, top: f64) {
        let bottom = std::mem::replace(&mut self.since[pair], top);
        if bottom < top {
            let spans = [bottom, top].map(|y| {
                let [left, right] = [0, 1].map(|side| at(self.edges[2 * pair + side], y));
                [left, right.max(left)]
            });
            self.done.push(Trapezoid { bottom, top, spans });
        }
    }
}

/// The position of an edge at a height within its range.
fn at([low, high]: Rising, y: f64) -> f64 {
    if high.y <= low.y || y >= high.y {
        return high.x;
    }
    low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y))
}

#[cfg(test)]
mod tests {
    use super::super::outline::{check, edges, is_inside};
    use super::*;
    use proptest::prelude::*;

    fn area(ring: &[DVec2]) -> f64 {
        edges(ring).map(|(a, b)| 0.5 * a.perp_dot(b)).sum::<f64>().abs()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn trapezoids_fill_the_polygon_and_nothing_else(
            radii in prop::collection::vec(2..9i32, 3..30), hole in prop::collection::vec(0.1..0.9f64, 3..9),
            u in [0.0..1.0f64, 0.0..1.0f64],
        ) {
            let star = |radii: Vec<f64>| -> Vec<DVec2> {
                let count = radii.len() as f64;
                let at = |(i, r): (usize, f64)| DVec2::from_angle(i as f64 * std::f64::consts::TAU / count) * r;
                radii.into_iter().enumerate().map(at).collect()
            };
            // On a grid, so that points share heights and edges are horizontal.
            let outer = star(radii.into_iter().map(f64::from).collect());
            let outer: Vec<DVec2> = outer.iter().map(|p| p.round()).collect();
            let mut rings = vec![outer, star(hole)];
            if check(&rings).is_err() {
                rings.truncate(1);
            }
            prop_assume!(check(&rings).is_ok());
            let parts = trapezoids(&rings);
            prop_assert!(parts.len() <= 3 * rings.iter().map(Vec::len).sum::<usize>());
            let sum: f64 = parts.iter().map(Trapezoid::area).sum();
            let wanted = area(&rings[0]) - rings[1..].iter().map(|r| area(r)).sum::<f64>();
            prop_assert!((sum - wanted).abs() < 1e-12 * wanted, "{sum} of {wanted}");
            for part in parts.iter().filter(|p| p.area() > 1e-6) {
                // Away from the border, which rounding may cross.
                let p = part.sample(u.map(|x| 0.01 + 0.98 * x));
                prop_assert!(is_inside(p, &rings[0]) && !rings[1..].iter().any(|r| is_inside(p, r)));
            }
        }
    }
}
