//! The largest empty ball tangent to a surface at a point.
//!
//! All balls tangent to a plane at a point p, with centers along w from there, are nested. So the largest empty one is
//! the minimum over the triangles, and one tree traversal finds it: a node culled for a ball is culled for all smaller
//! ones (Ma, Bae and Choi, "3D Medial Axis Point Approximation Using Nearest Neighbors and the Normal Field", 2012,
//! shrink the ball by one nearest point after another).
//!
//! From the center of a ball or a rod all of its surface is about equally far, so boxes cull nothing: the box of a
//! slanted patch extends inward by half of the patch's size. The slab between two planes around a patch extends inward
//! by its sagitta only, which is quadratic in that size. So each node has a slab, too, normal to the mean normal of its
//! triangles.

use raywright_base::math::DVec3;
use raywright_shapes::triangle::{nearest_point, point_of};

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;

/// Relative accuracy of the radius: nodes that would shrink it by less are culled.
const EXACT: f64 = 1e-6;

/// A triangle inside the ball by less than this fraction of the radius, or by rounding, counts as tangent.
const TOUCH: f64 = 1e-9;

/// Points closer than this fraction of the largest coordinate are not distinguished.
const ROUNDED: f64 = 16.0 * f64::EPSILON;

/// Maximum number of iterations. The ball shrinks geometrically, and no tested case took as many.
const STEPS: usize = 60;

#[derive(Clone, Copy, Debug)]
struct Node {
    min: DVec3,
    max: DVec3,
    /// The mean normal, and the interval of heights along it.
    normal: DVec3,
    low: f64,
    high: f64,
    /// Of a leaf, the index of its first triangle. Of an inner node, which has a count of 0, the first child; the
    /// second one follows it.
    first: u32,
    count: u32,
}

/// A tree of triangles for tangent-ball queries.
#[derive(Clone, Debug, Default)]
pub struct TangentBalls {
    nodes: Vec<Node>,
    triangles: Vec<[DVec3; 3]>,
}

/// A ball, given by its tangent point, the direction of its center, and its radius.
#[derive(Clone, Copy)]
struct Ball {
    touch: DVec3,
    way: DVec3,
    radius: f64,
}

impl Ball {
    fn middle(&self) -> DVec3 {
        self.touch + self.way * self.radius
    }

    /// The least radius for which the ball reaches the node's slab.
    fn least(&self, node: &Node) -> f64 {
        let (height, rise) = (node.normal.dot(self.touch), node.normal.dot(self.way));
        let (gap, slope) =
            if height < node.low { (node.low - height, 1.0 + rise) } else { (height - node.high, 1.0 - rise) };
        if gap > 0.0 { gap / slope.max(f64::MIN_POSITIVE) } else { 0.0 }
    }

    /// Return whether a node lies on or behind the tangent plane to within rounding, as coplanar faces do.
    fn is_behind(&self, node: &Node) -> bool {
        let rise = node.normal.dot(self.way);
        let (side, high) = if rise > 0.0 { (1.0, node.high) } else { (-1.0, -node.low) };
        let askew = (self.way - side * node.normal).length();
        if askew > 1e-9 {
            return false;
        }
        let reach = (self.touch - node.min).abs().max((self.touch - node.max).abs()).length();
        let depth = high - side * node.normal.dot(self.touch) + askew * reach;
        depth <= 0.5 * ROUNDED * self.touch.abs().max_element()
    }

    /// Return whether the content of a node may shrink the ball.
    fn may_meet(&self, node: &Node) -> bool {
        let middle = self.middle();
        let near = middle.clamp(node.min, node.max);
        (near - middle).length_squared() < self.radius * self.radius
            && self.least(node) < self.radius * (1.0 - EXACT)
            && !self.is_behind(node)
    }

    /// Shrink the ball until the triangle is not inside.
    fn shrink(&mut self, corners: &[DVec3; 3]) {
        let Self { touch, way, .. } = *self;
        let mut least = None;
        for _ in 0..STEPS {
            let near = nearest_point(*corners, self.middle());
            if near.distance >= self.radius * (1.0 - TOUCH) {
                return;
            }
            let least = *least.get_or_insert_with(|| {
                let [a, b, c] = corners.map(DVec3::abs);
                ROUNDED * a.max(b).max(c).max(touch.abs()).max_element()
            });
            if near.distance >= self.radius - least {
                return;
            }
            // The ball through the tangent point that also touches the nearest point q: |q - p|^2 / 2 w·(q - p).
            let away = point_of(*corners, near.uv) - touch;
            let depth = away.dot(way);
            let smaller = away.length_squared() / (2.0 * depth);
            if !(depth > 0.0 && smaller < self.radius * (1.0 - TOUCH)) {
                return;
            }
            self.radius = smaller;
        }
    }
}

impl TangentBalls {
    /// Build a tree of triangles, skipping those with non-finite corners.
    pub fn new(triangles: impl Iterator<Item = [DVec3; 3]>) -> Self {
        let triangles = triangles.filter(|corners| corners.iter().all(|c| c.is_finite())).collect();
        let mut tree = Self { nodes: Vec::new(), triangles };
        if !tree.triangles.is_empty() {
            let count = tree.triangles.len();
            tree.nodes.push(around(&tree.triangles, 0));
            tree.split(0, 0, count);
        }
        tree
    }

    fn split(&mut self, node: usize, start: usize, end: usize) {
        if end - start <= LEAF {
            return;
        }
        // Split by centroids rather than boxes: triangles on the side of a rod are as long as the rod.
        let at = |[a, b, c]: &[DVec3; 3]| *a + *b + *c;
        let (min, max) = self.triangles[start..end]
            .iter()
            .map(at)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), at| (min.min(at), max.max(at)));
        let (axis, middle) = ((max - min).max_position(), (start + end) / 2);
        self.triangles[start..end].select_nth_unstable_by(middle - start, |a, b| at(a)[axis].total_cmp(&at(b)[axis]));
        let first = self.nodes.len();
        (self.nodes[node].first, self.nodes[node].count) = (first as u32, 0);
        for (from, to) in [(start, middle), (middle, end)] {
            self.nodes.push(around(&self.triangles[from..to], from));
        }
        self.split(first, start, middle);
        self.split(first + 1, middle, end);
    }

    /// The radius of the largest empty ball, up to `radius`, tangent to the surface at `touch` with its center along
    /// the unit vector `way`. Its relative error is 1e-6.
    pub fn radius(&self, touch: DVec3, way: DVec3, radius: f64) -> f64 {
        self.walk(touch, way, radius).0
    }

    /// The radius and the number of visited nodes.
    fn walk(&self, touch: DVec3, way: DVec3, radius: f64) -> (f64, usize) {
        let (mut ball, mut visits) = (Ball { touch, way, radius }, 0);
        let mut open = vec![];
        if !self.nodes.is_empty() {
            open.push(0);
        }
        while let Some(number) = open.pop() {
            let node: &Node = &self.nodes[number];
            visits += 1;
            if !ball.may_meet(node) {
                continue;
            }
            let first = node.first as usize;
            if node.count > 0 {
                self.triangles[first..][..node.count as usize].iter().for_each(|corners| ball.shrink(corners));
                continue;
            }
            // The child nearer to the tangent point shrinks the ball most.
            let [a, b] = [first, first + 1].map(|child| {
                let Node { min, max, .. } = self.nodes[child];
                (touch.clamp(min, max) - touch).length_squared()
            });
            open.extend(if a <= b { [first + 1, first] } else { [first, first + 1] });
        }
        (ball.radius, visits)
    }
}

/// A leaf of triangles, the first with the given index.
fn around(triangles: &[[DVec3; 3]], first: usize) -> Node {
    let corners = || triangles.iter().flatten().copied();
    let (min, max) = corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
    let normal = triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a)).sum::<DVec3>().normalize_or(DVec3::Z);
    let (low, high) = corners()
        .map(|corner| normal.dot(corner))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    Node { min, max, normal, low, high, first: first as u32, count: triangles.len() as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::{Sampler, warp};

    /// Triangles of a unit sphere around a point, 2 `count`² of them.
    fn globe(count: usize, middle: DVec3) -> Vec<[DVec3; 3]> {
        let at = |i: usize, j: usize| {
            let (high, turn) = (i as f64 / count as f64, j as f64 / count as f64);
            let (sine, cosine) = (std::f64::consts::PI * high).sin_cos();
            let (y, x) = (std::f64::consts::TAU * turn).sin_cos();
            middle + DVec3::new(sine * x, sine * y, cosine)
        };
        let quads = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        quads
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 1e-12)
            .collect()
    }

    #[test]
    fn a_ball_is_the_least_that_any_triangle_allows() {
        let triangles = globe(24, DVec3::new(3.0, -1.0, 2.0));
        let tree = TangentBalls::new(triangles.iter().copied());
        for [a, b, c] in triangles.iter().step_by(7) {
            let touch = (*a + *b + *c) / 3.0;
            let way = (*c - *a).cross(*b - *a).normalize();
            let found = tree.radius(touch, way, 1.0);
            let mut ball = Ball { touch, way, radius: 1.0 };
            triangles.iter().for_each(|corners| ball.shrink(corners));
            assert!((found / ball.radius - 1.0).abs() <= 1.1 * EXACT, "{found} {}", ball.radius);
            let nearest = triangles.iter().map(|corners| nearest_point(*corners, touch + way * found).distance);
            assert!(nearest.fold(f64::INFINITY, f64::min) >= found * (1.0 - 2.0 * EXACT));
        }
    }

    #[test]
    fn between_random_triangles_as_well() {
        for sample in 0..200 {
            let mut sampler = Sampler::new(3, 0, sample);
            let mut draw = 0;
            let mut point = || {
                draw += 1;
                warp::uniform_sphere(sampler.two(draw)) * sampler.one(draw + 1000)
            };
            let triangles: Vec<_> = (0..40)
                .map(|_| {
                    let place = point();
                    [place, place + 0.2 * point(), place + 0.2 * point()]
                })
                .collect();
            let (touch, way) = (point(), point().normalize());
            let mut ball = Ball { touch, way, radius: 2.0 };
            triangles.iter().for_each(|corners| ball.shrink(corners));
            let found = TangentBalls::new(triangles.into_iter()).radius(touch, way, 2.0);
            assert!((found / ball.radius - 1.0).abs() <= 1.1 * EXACT, "{found} {}", ball.radius);
        }
    }

    #[test]
    fn of_a_ball_few_nodes_are_visited() {
        // All points are equally far from the center: boxes alone would visit all nodes.
        for (count, most) in [(32, 0.5), (64, 0.25), (128, 0.12)] {
            let triangles = globe(count, DVec3::ZERO);
            let tree = TangentBalls::new(triangles.iter().copied());
            let points = triangles.iter().step_by(61);
            let visits = points.clone().map(|[a, b, c]| {
                let way = (*c - *a).cross(*b - *a).normalize();
                tree.walk((*a + *b + *c) / 3.0, way, 1.0).1
            });
            let mean = visits.sum::<usize>() as f64 / points.count() as f64;
            assert!(mean < most * tree.nodes.len() as f64, "{mean} of {}", tree.nodes.len());
        }
    }

    #[test]
    fn of_a_rod_few_nodes_are_visited() {
        // The side consists of triangles as long as the rod.
        let at = |i: usize, z: f64| {
            let (y, x) = (std::f64::consts::TAU * i as f64 / 1024.0).sin_cos();
            DVec3::new(x, y, z)
        };
        let side = |i: usize| {
            let [a, b, c, d] = [at(i, -9.0), at(i + 1, -9.0), at(i + 1, 9.0), at(i, 9.0)];
            [[a, b, c], [a, c, d]]
        };
        let triangles: Vec<_> = (0..1024).flat_map(side).collect();
        let tree = TangentBalls::new(triangles.iter().copied());
        for [a, b, c] in triangles.iter().step_by(61) {
            let way = (*c - *a).cross(*b - *a).normalize();
            let (radius, visits) = tree.walk((*a + *b + *c) / 3.0, way, 1.0);
            assert!((radius - 2.0 / 3.0).abs() < 1e-4 && visits < 400, "{radius} {visits}");
        }
    }

    #[test]
    fn what_is_coplanar_is_passed_by() {
        // The top of a prism is a fan about its center, whose boxes overlap.
        let (count, turned) = (512, DVec3::new(0.6, 0.0, 0.8));
        let (x, y) = (DVec3::Y, turned.cross(DVec3::Y));
        let at = |i: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
            x * cosine + y * sine + turned * 3.0
        };
        let fan = (0..count).map(|i| [turned * 3.0, at(i), at(i + 1)]);
        let far = [[-turned, x - turned, y - turned]];
        let tree = TangentBalls::new(fan.clone().chain(far));
        for [a, b, c] in fan.step_by(17) {
            let (radius, visits) = tree.walk((a + b + c) / 3.0, -turned, 5.0);
            assert!(radius > 2.0 - 1e-5 && visits < 40, "{radius} {visits}");
        }
    }

    #[test]
    fn of_nothing_it_is_as_large_as_it_may_be() {
        assert_eq!(TangentBalls::new(std::iter::empty()).radius(DVec3::ZERO, DVec3::X, 7.0), 7.0);
        assert_eq!(TangentBalls::new([[DVec3::NAN; 3]].into_iter()).radius(DVec3::ZERO, DVec3::X, 7.0), 7.0);
    }
}
