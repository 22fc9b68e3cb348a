//! Conservative projection of triangles to pixels.
//!
//! In view space a point relative to the camera has coordinates (X, Y, W) along the picture's width, its height and the
//! view. A ray through (x, y), each from −1 to 1 across the picture, has direction (x, y, 1).
//!
//! Error bound. Let u = 2⁻⁵³ and |q| the distance of the farthest corner. Let s be the greatest of 1 and the inverse
//! half width and half height of the picture at distance 1, or more if the picture is not centered on the view
//! ([`super::cameras::Window::onto_film`]). A relative corner has an error of u|q|, and its dot product with an axis
//! 4u|q| more. Axes are orthogonal to within 4u. So the error of each coordinate is at most 16us|q|. A ray's direction
//! takes three sums, a normalization and three divisions, and passes through a point displaced by less than 16us. For
//! both together 64us|q| is allowed, called the slack.

use super::cameras::{Camera, Perspective};
use raywright_base::math::DVec3;
use raywright_base::math::robust::{greater, lesser};

/// A camera's picture, and the ray offsets in its pixels.
#[derive(Clone, Debug)]
pub(super) struct View {
    position: DVec3,
    forward: DVec3,
    /// Linear forms of the first two coordinates.
    right: DVec3,
    up: DVec3,
    size: [f64; 2],
    /// Minimum and maximum offset in a pixel, by axis.
    offsets: [[f64; 2]; 2],
    /// Bound on all three forms, as a multiple of the distance; see
    /// [`Window::onto_film`](super::cameras::Window::onto_film).
    stretch: f64,
    /// Distance behind the camera at which a triangle may still be hit, because of rounding in `t`.
    behind: f64,
}

/// A triangle in view space.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProjectedTriangle {
    pub corners: [DVec3; 3],
    /// Error bound of each coordinate, or of a ray's passing point.
    pub slack: f64,
    /// Distance of the farthest corner times the picture's stretch; bounds every coordinate.
    pub reach: f64,
    /// Lower bound of a hit's distance along the view; −∞ if the triangle may reach behind the camera.
    pub depth: f64,
}

/// A rectangle of pixels: first and last column, first and last row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pixels {
    pub x: [u16; 2],
    pub y: [u16; 2],
}

impl Pixels {
    /// The intersection of two rectangles; `None` if it is empty.
    pub fn shared(self, other: Self) -> Option<Self> {
        let within = |a: [u16; 2], b: [u16; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        let both = Self { x: within(self.x, other.x), y: within(self.y, other.y) };
        (both.x[0] <= both.x[1] && both.y[0] <= both.y[1]).then_some(both)
    }

    /// Number of pixels.
    pub fn count(self) -> usize {
        let length = |[first, last]: [u16; 2]| usize::from(last - first) + 1;
        length(self.x) * length(self.y)
    }
}

const SLACK: f64 = 1.0 / (1u64 << 47) as f64;

impl View {
    /// The view of a camera with these ray offsets. `reach` bounds the distance of the scene, and `t_error` is the
    /// error of `t` relative to it.
    pub fn new(camera: &Perspective, offsets: &[[f64; 2]], reach: f64, t_error: f64) -> Self {
        let position = camera.viewpoint().position;
        let ([right, up, forward], stretch) = camera.window().onto_film(camera.viewpoint());
        // Rays through non-finite offsets hit nothing.
        let finite = || offsets.iter().filter(|o| o[0].is_finite() && o[1].is_finite());
        let range = |axis: usize| {
            finite().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], o| [lesser(o[axis], a), greater(o[axis], b)])
        };
        Self {
            position,
            forward,
            right,
            up,
            size: [f64::from(camera.width()), f64::from(camera.height())],
            offsets: [range(0), range(1)],
            stretch,
            behind: 4.0 * t_error * reach,
        }
    }

    /// Transforms a triangle to view space; `None` if all of it is behind the camera.
    #[inline]
    pub fn see(&self, corners: [DVec3; 3]) -> Option<ProjectedTriangle> {
        let to = corners.map(|c| c - self.position);
        let square = greater(to[0].length_squared(), greater(to[1].length_squared(), to[2].length_squared()));
        let reach = square.sqrt() * self.stretch;
        let slack = SLACK * reach;
        let corners = to.map(|q| DVec3::new(q.dot(self.right), q.dot(self.up), q.dot(self.forward)));
        let [a, b, c] = corners.map(|c| c.z);
        if greater(greater(a, b), c) < -(self.behind + slack) {
            return None;
        }
        let least = lesser(lesser(a, b), c);
        let is_before = least > 2.0 * (self.behind + slack);
        let depth = if is_before { least - slack } else { f64::NEG_INFINITY };
        Some(ProjectedTriangle { corners, slack, reach, depth })
    }

    /// Converts a pixel position to film coordinates from −1 to 1, x to the right and y up, as in
    /// [`Perspective::ray_through`].
    #[inline(always)]
    pub fn film(&self, x: f64, y: f64) -> [f64; 2] {
        [2.0 * x / self.size[0] - 1.0, 1.0 - 2.0 * y / self.size[1]]
    }

    /// Range of film positions of rays through some pixels, by axis.
    pub fn window(&self, pixels: Pixels) -> [[f64; 2]; 2] {
        let [x, y] = [pixels.x, pixels.y].map(|p| p.map(f64::from));
        let [ox, oy] = self.offsets;
        let [left, top] = self.film(x[0] + ox[0], y[0] + oy[0]);
        let [right, bottom] = self.film(x[1] + ox[1], y[1] + oy[1]);
        [[left, right], [bottom, top]]
    }

    /// Returns whether no ray through a window of the film can hit a triangle, because it lies beyond one of the four
    /// planes through the window's sides.
    #[inline]
    pub fn is_beside(&self, seen: &ProjectedTriangle, window: &[[f64; 2]; 2]) -> bool {
        let behind = if seen.depth > 0.0 { 0.0 } else { self.behind };
        (0..2).any(|axis| {
            let [low, high] = window[axis];
            let room = 4.0 * (seen.slack + behind) * (1.0 + greater(low.abs(), high.abs()));
            let all = |past: &dyn Fn(DVec3) -> f64| seen.corners.iter().all(|&c| past(c) > room);
            all(&|c| low * c.z - c[axis]) || all(&|c| c[axis] - high * c.z)
        })
    }

    /// The pixels whose rays may hit a triangle; `None` if there are none.
    #[inline]
    pub fn pixels(&self, seen: &ProjectedTriangle) -> Option<Pixels> {
        let whole = Pixels { x: [0, (self.size[0] - 1.0) as u16], y: [0, (self.size[1] - 1.0) as u16] };
        if self.is_beside(seen, &self.window(whole)) {
            return None;
        }
        if seen.depth <= 0.0 {
            return Some(whole);
        }
        let mut found = whole;
        for axis in 0..2 {
            let at = seen.corners.map(|c| c[axis] / c.z);
            let (low, high) = (lesser(lesser(at[0], at[1]), at[2]), greater(greater(at[0], at[1]), at[2]));
            let farthest = 1.0 + greater(low.abs(), high.abs());
            let room = farthest * (4.0 * seen.slack / seen.depth + 2.0 * SLACK);
            // Rows are counted from the top.
            let (low, high) = if axis == 0 { (low, high) } else { (-high, -low) };
            let half = 0.5 * self.size[axis];
            let first = (half * (1.0 + low - room) - self.offsets[axis][1]).ceil();
            let last = (half * (1.0 + high + room) - self.offsets[axis][0]).floor();
            // Overflow to infinity or NaN rules out no pixel.
            if first > last || last < 0.0 || first > self.size[axis] - 1.0 {
                return None;
            }
            let to = if axis == 0 { &mut found.x } else { &mut found.y };
            *to = [to[0].max(first as u16), if last < f64::from(to[1]) { last as u16 } else { to[1] }];
        }
        Some(found)
    }
}

impl ProjectedTriangle {
    /// For each edge, a vector whose dot product with a ray's (x, y, 1) has the sign of the side on which the ray
    /// passes.
    #[inline(always)]
    pub fn sides(&self) -> [DVec3; 3] {
        let [a, b, c] = self.corners;
        [b.cross(c), c.cross(a), a.cross(b)]
    }

    /// Error bound of such a dot product, for x and y with |x| + |y| ≤ `most`. Let Q be the reach, which includes the
    /// stretch s. A coordinate has an error of 64uQ, a side vector 4·65uQ² + 4uQ², and its dot product with (x, y, 1)
    /// 300uQ² times 1 + `most`. The ray is displaced by 16us in each of x and y, which adds 2·16us·2Q².
    #[inline(always)]
    pub fn side_error(&self, view: &View, most: f64) -> f64 {
        const ERROR: f64 = 1.0 / (1u64 << 43) as f64;
        ERROR * self.reach * self.reach * (1.0 + most) * view.stretch
    }
}
