//! The largest ball that touches a surface at a point and has nothing of it inside.
//!
//! All balls that touch a plane at a point p, with their middles along w from there, lie within each other. So the
//! largest one that is empty is the least that any triangle allows, and one walk of a tree finds it: what is passed by
//! for a ball is passed by for smaller ones (Ma, Bae and Choi, "3D Medial Axis Point Approximation Using Nearest
//! Neighbors and the Normal Field", 2012, shrink the ball by one nearest point after the other).
//!
//! From the middle of a ball or a rod all of its surface is about as far, and boxes tell nothing of it apart: the box of
//! a slanted patch reaches inwards by half of the patch's size. The slab between two planes that holds a patch reaches
//! by its sagitta only, the square of that. So each node has a slab too, across the mean normal of its triangles.

use raywright_base::math::DVec3;
use raywright_shapes::triangle::{nearest_point, point_of};

/// What a leaf holds at most.
const LEAF: usize = 4;

/// To how much of itself the radius is found: what would shrink it by less is passed by.
const EXACT: f64 = 1e-6;

/// What is nearer than the radius by less of it, or by less than rounding, touches the ball.
const TOUCH: f64 = 1e-9;

/// What is nearer to each other than this of the largest coordinate is not told apart.
const ROUNDED: f64 = 16.0 * f64::EPSILON;

/// The ball shrinks towards a triangle geometrically; so many steps are more than any took that was tried.
const STEPS: usize = 60;

#[derive(Clone, Copy, Debug)]
struct Node {
    min: DVec3,
    max: DVec3,
    /// The mean normal, and between which heights along it all lies.
    normal: DVec3,
    low: f64,
    high: f64,
    /// Of a leaf what it holds of the triangles; of others, which hold nothing, the first child, beside which the
    /// second is.
    first: u32,
    count: u32,
}

/// Triangles, for the balls that touch them.
#[derive(Clone, Debug, Default)]
pub struct TangentBalls {
    nodes: Vec<Node>,
    triangles: Vec<[DVec3; 3]>,
}

/// A ball: where it touches the surface, in which direction its middle lies, and how large it is.
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

    /// The least radius of a ball that reaches a slab.
    fn least(&self, node: &Node) -> f64 {
        let (height, rise) = (node.normal.dot(self.touch), node.normal.dot(self.way));
        let (gap, slope) =
            if height < node.low { (node.low - height, 1.0 + rise) } else { (height - node.high, 1.0 - rise) };
        if gap > 0.0 { gap / slope.max(f64::MIN_POSITIVE) } else { 0.0 }
    }

    /// Whether it may be shrunk by what a node holds.
    fn may_meet(&self, node: &Node) -> bool {
        let middle = self.middle();
        let near = middle.clamp(node.min, node.max);
        (near - middle).length_squared() < self.radius * self.radius && self.least(node) < self.radius * (1.0 - EXACT)
    }

    /// Shrinks it until a triangle is not inside.
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
            // The ball through the point that also touches the nearest one: |q - p|^2 / 2 w·(q - p).
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
    /// Of some triangles; those with corners that are not finite are left out.
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
        let size = self.nodes[node].max - self.nodes[node].min;
        let axis = size.max_position();
        let middle = (start + end) / 2;
        let at = |corners: &[DVec3; 3]| corners[0][axis] + corners[1][axis] + corners[2][axis];
        self.triangles[start..end].select_nth_unstable_by(middle - start, |a, b| at(a).total_cmp(&at(b)));
        let first = self.nodes.len();
        (self.nodes[node].first, self.nodes[node].count) = (first as u32, 0);
        for (from, to) in [(start, middle), (middle, end)] {
            self.nodes.push(around(&self.triangles[from..to], from));
        }
        self.split(first, start, middle);
        self.split(first + 1, middle, end);
    }

    /// The radius of the largest ball, of at most `radius`, that touches the surface at a point of it, has its middle in
    /// a direction of length one, and nothing inside: to within 1e-6 of itself.
    pub fn radius(&self, touch: DVec3, way: DVec3, radius: f64) -> f64 {
        let mut ball = Ball { touch, way, radius };
        let mut open = vec![];
        if !self.nodes.is_empty() {
            open.push(0);
        }
        while let Some(number) = open.pop() {
            let node: &Node = &self.nodes[number];
            if !ball.may_meet(node) {
                continue;
            }
            let first = node.first as usize;
            if node.count > 0 {
                self.triangles[first..][..node.count as usize].iter().for_each(|corners| ball.shrink(corners));
                continue;
            }
            // What is nearer to the point shrinks the ball most.
            let [a, b] = [first, first + 1].map(|child| {
                let Node { min, max, .. } = self.nodes[child];
                (touch.clamp(min, max) - touch).length_squared()
            });
            open.extend(if a <= b { [first + 1, first] } else { [first, first + 1] });
        }
        ball.radius
    }
}

/// The leaf of some triangles, the first of which has this number.
fn around(triangles: &[[DVec3; 3]], first: usize) -> Node {
    let corners = || triangles.iter().flatten().copied();
    let (min, max) = corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
    let normal = triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a)).sum::<DVec3>().normalize_or(DVec3::Z);
    let (low, high) = corners()
        .map(|corner| normal.dot(corner))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    Node { min, max, normal, low, high, first: first as u32, count: triangles.len() as u32 }
}
