//! Bounds for the distances to the triangles of a leaf, in f32 and in parallel.
//!
//! For any vector w, a triangle is at least as far as the minimum of w · (corner − point) / |w|. For any point of the
//! triangle, it is at most as far as that point. With w toward the closest point, both are tight. So an approximate
//! closest point gives certain bounds.
//!
//! The bounds. Let ε = 2⁻²⁴ and L bound |point| + |corner| in every coordinate. The point errs by εL, a corner by up to
//! 4εL if it is stored as an edge in box units, and their difference by εL. The dot product with w has three terms with
//! at most three roundings each. So it errs by 9εL·(|w₁| + |w₂| + |w₃|) and the distance by 9√3·εL < 15.6εL. 16εL is
//! allowed, and in box units 32εL. The vector w is exact by definition; squares err by 8ε of themselves, for which 16ε
//! are allowed.
//!
//! As a point of the triangle, w errs by the 6εL of the first corner; by 2εL for the edges, whose weights add up to at
//! most 1; by 4εL for products and sums; and by 4εL since the first weight, 1 − u − v, may be as low as −2ε. In all
//! that is 16√3·εL < 27.8εL in distance, and twice 16εL is allowed. Squares that underflow err by less than
//! 8·`f32::MIN_POSITIVE`.

use super::{ROOM, Search, limit};
use raywright_base::math::{DVec3, Region};
use raywright_base::simd::Simd;

/// Bounds for the distances to the triangles of leaves, in one search.
#[derive(Clone, Copy, Debug)]
pub struct LeafBounds {
    /// In the units of the leaves.
    point: [f32; 3],
    /// The error allowed for.
    slack: f64,
    /// The factor from the scene's units to those of leaves.
    scale: f64,
    /// The factor from the units of leaves to those of boxes.
    to_boxes: f64,
    /// An upper bound of the nearest distance.
    most: f64,
    /// The squared distance beyond which boxes are rejected ([`Search::squares`]).
    pub box_limit: f32,
    /// The squared distance beyond which triangles are rejected.
    limit: f32,
}

/// Lower bounds of the squared distances to the triangles of a leaf: `ends` / `squares`.
#[derive(Clone, Copy, Debug)]
pub struct Brackets<const N: usize> {
    /// The minimum of w · (corner − point), squared.
    ends: [f32; N],
    /// The squares of w.
    squares: [f32; N],
}

impl<const N: usize> Brackets<N> {
    /// No triangles.
    pub const NONE: Self = Self { ends: [0.0; N], squares: [0.0; N] };
}

impl LeafBounds {
    const STEP: f64 = 1.0 / (1u32 << 20) as f64;

    /// Prepare a search for leaves with corners in the scene's units (`as_they_are`) or in box units.
    #[inline(always)]
    pub fn new(search: &Search, region: &Region, as_they_are: bool) -> Self {
        let (point, extent, scale, step) = if as_they_are {
            (search.point, region.extent, 1.0, Self::STEP)
        } else {
            (region.to_box(search.point), 2.0, region.scale, 2.0 * Self::STEP)
        };
        let slack = step * (point.abs().max_element() + extent);
        let point = [point.x as f32, point.y as f32, point.z as f32];
        let to_boxes = search.scale / scale;
        let mut bounds =
            Self { point, slack, scale, to_boxes, most: f64::INFINITY, box_limit: f32::INFINITY, limit: f32::INFINITY };
        bounds.shorten(search.distance * scale);
        bounds
    }

    /// Set an upper bound of the nearest distance, in the units of leaves, if it is less than the current one.
    #[inline(always)]
    fn shorten(&mut self, most: f64) {
        if most < self.most {
            let (of_box, padded) = (limit(most * self.to_boxes), most + self.slack);
            self.most = most;
            self.box_limit = (of_box * f64::from(1.0 + ROOM)) as f32;
            self.limit = (padded * padded * (1.0 + Self::STEP)) as f32;
        }
    }

    /// Use the current result of a search as an upper bound.
    #[inline(always)]
    pub fn follow(&mut self, search: &Search) {
        self.shorten(search.distance * self.scale);
    }

    /// Use a point of some triangle, rounded to f64, as an upper bound.
    #[inline(always)]
    pub fn toward(&mut self, search: &Search, position: DVec3) {
        let way = position - search.point;
        // Squares of tiny coordinates vanish.
        let largest = way.abs().max_element().max(f64::MIN_POSITIVE);
        let distance = (way / largest).length() * largest;
        if distance.is_finite() {
            self.shorten(distance * (1.0 + Self::STEP) * self.scale + self.slack);
        }
    }

    /// Bound the distances of the triangles in some lanes of a leaf, use these as upper bounds, and return the lanes
    /// with triangles that may be near enough.
    // Written out axis by axis: closures between here and the kernel's entry are not always compiled for its SIMD
    // level.
    #[inline(always)]
    pub fn visit<const N: usize, S: Simd<N>>(
        &mut self,
        simd: S,
        corners: [[S::F32; 3]; 3],
        lanes: u32,
        brackets: &mut Brackets<N>,
    ) -> u32 {
        let (zero, one, two) = (simd.splat(0.0), simd.splat(1.0), simd.splat(2.0));
        let tiny = simd.splat(f32::MIN_POSITIVE);
        let point = [simd.splat(self.point[0]), simd.splat(self.point[1]), simd.splat(self.point[2])];
        let a = difference(simd, corners[0], point);
        let b = difference(simd, corners[1], point);
        let c = difference(simd, corners[2], point);
        // Most leaves are rejected with w toward the triangles' centers.
        let way = [
            simd.add(simd.add(a[0], b[0]), c[0]),
            simd.add(simd.add(a[1], b[1]), c[1]),
            simd.add(simd.add(a[2], b[2]), c[2]),
        ];
        let lanes = lanes & self.near(simd, end(simd, way, [a, b, c]), dot(simd, way, way));
        if lanes == 0 {
            return 0;
        }
        let (e, f) = (difference(simd, b, a), difference(simd, c, a));
        // |a + u e + v f|² = |a|² + u² ee + 2 u v ef + v² ff − 2 u ea − 2 v fa.
        let (ee, ef, ff) = (dot(simd, e, e), dot(simd, e, f), dot(simd, f, f));
        let (ea, fa) = (simd.neg(dot(simd, e, a)), simd.neg(dot(simd, f, a)));
        // The plane's closest point. Where the determinant vanishes, comparisons with the result are false or harmless.
        let inverse = simd.div(one, simd.mul_sub(ee, ff, simd.mul(ef, ef)));
        let u = simd.mul(simd.mul_sub(ff, ea, simd.mul(ef, fa)), inverse);
        let v = simd.mul(simd.mul_sub(ee, fa, simd.mul(ef, ea)), inverse);
        let inside = simd.le(zero, u) & simd.le(zero, v) & simd.le(simd.add(u, v), one);
        // The edges' closest points, and their squared distances less |a|².
        let u_e = clamp(simd, simd.div(ea, simd.max(ee, tiny)));
        let v_f = clamp(simd, simd.div(fa, simd.max(ff, tiny)));
        let gg = simd.add(simd.sub(ee, ef), simd.sub(ff, ef));
        let ga = simd.add(simd.sub(fa, ea), simd.sub(ee, ef));
        let v_g = clamp(simd, simd.div(ga, simd.max(gg, tiny)));
        let at_e = simd.mul(u_e, simd.mul_sub(u_e, ee, simd.mul(two, ea)));
        let at_f = simd.mul(v_f, simd.mul_sub(v_f, ff, simd.mul(two, fa)));
        let at_g =
            simd.mul_add(v_g, simd.mul_sub(v_g, gg, simd.mul(two, ga)), simd.mul_sub(one, ee, simd.mul(two, ea)));
        let f_first = simd.gt(at_e, at_f);
        let (u_edge, v_edge) = (simd.select(f_first, zero, u_e), simd.select(f_first, v_f, zero));
        let g_first = simd.gt(simd.min(at_e, at_f), at_g);
        let (u_edge, v_edge) = (simd.select(g_first, simd.sub(one, v_g), u_edge), simd.select(g_first, v_g, v_edge));
        let (u, v) = (simd.select(inside, u, u_edge), simd.select(inside, v, v_edge));
        let way = [
            simd.mul_add(v, f[0], simd.mul_add(u, e[0], a[0])),
            simd.mul_add(v, f[1], simd.mul_add(u, e[1], a[1])),
            simd.mul_add(v, f[2], simd.mul_add(u, e[2], a[2])),
        ];
        let squares = dot(simd, way, way);
        let known = lanes & simd.le(squares, simd.splat(f32::MAX));
        let square = simd.least(simd.select(known, squares, simd.splat(f32::INFINITY)));
        let square = f64::from(square) * (1.0 + Self::STEP) + 8.0 * f64::from(f32::MIN_POSITIVE);
        self.shorten(square.sqrt() + 2.0 * self.slack);
        let ends = end(simd, way, [a, b, c]);
        let near = lanes & self.near(simd, ends, squares);
        if near != 0 {
            simd.store(ends, &mut brackets.ends);
            simd.store(squares, &mut brackets.squares);
        }
        near
    }

    /// The lanes of a leaf with triangles that may be near enough by now.
    #[inline(always)]
    pub fn still_near<const N: usize, S: Simd<N>>(&self, simd: S, brackets: &Brackets<N>) -> u32 {
        self.near(simd, simd.load(&brackets.ends), simd.load(&brackets.squares))
    }

    #[inline(always)]
    fn near<const N: usize, S: Simd<N>>(&self, simd: S, ends: S::F32, squares: S::F32) -> u32 {
        // Tiny distances, which underflow, are not rejected.
        !simd.gt(ends, simd.mul_add(squares, simd.splat(self.limit), simd.splat(f32::MIN_POSITIVE)))
    }
}

/// The minimum of w · (corner − point), squared.
#[inline(always)]
fn end<const N: usize, S: Simd<N>>(simd: S, way: [S::F32; 3], [a, b, c]: [[S::F32; 3]; 3]) -> S::F32 {
    let least = simd.min(simd.min(dot(simd, way, a), dot(simd, way, b)), dot(simd, way, c));
    let least = simd.max(least, simd.splat(0.0));
    simd.mul(least, least)
}

/// Clamp to [0, 1].
#[inline(always)]
fn clamp<const N: usize, S: Simd<N>>(simd: S, x: S::F32) -> S::F32 {
    simd.max(simd.min(x, simd.splat(1.0)), simd.splat(0.0))
}

#[inline(always)]
fn difference<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

#[inline(always)]
fn dot<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> S::F32 {
    simd.mul_add(a[2], b[2], simd.mul_add(a[1], b[1], simd.mul(a[0], b[0])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::simd::{Dispatch, Kernel, Level};
    use raywright_shapes::triangle::{DoubleLeaves, Leaves, SingleLeaves, nearest_point};

    /// Visits a leaf, and returns the lanes and the bound.
    struct Visit<'a, L> {
        leaves: &'a L,
        bounds: LeafBounds,
        count: u32,
    }

    impl<const N: usize, L: Leaves<N>> Kernel<N> for Visit<'_, L> {
        type Output = (u32, u32, f64);

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) -> (u32, u32, f64) {
            let Self { leaves, mut bounds, count } = self;
            let mut brackets = Brackets::NONE;
            let corners = leaves.nearly(simd, 0, count);
            let lanes = bounds.visit(simd, corners, (1 << count) - 1, &mut brackets);
            let still = if lanes == 0 { 0 } else { lanes & bounds.still_near(simd, &brackets) };
            (lanes, still, bounds.most / bounds.scale)
        }
    }

    /// Assert that the nearest triangles are found to be near, whether or not their distance is known, and that no
    /// bound is below that distance.
    fn bounds_hold<const N: usize, L: Leaves<N>>(point: DVec3, triangles: &[[DVec3; 3]]) -> Result<(), TestCaseError>
    where
        Level: Dispatch<N>,
    {
        let region = Region::around(triangles.iter().flatten().copied());
        let count = triangles.len() as u32;
        let order: Vec<u32> = (0..count).collect();
        let leaves = L::new(&region, &order, &[count], |p| triangles[p as usize]);
        let mut search = Search::new(point, f64::INFINITY, &region).unwrap();
        // A distant point has been moved.
        let distances: Vec<_> = triangles.iter().map(|&t| nearest_point(t, search.point).distance).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let nearest = (0..triangles.len()).filter(|&i| distances[i] == least).fold(0, |lanes, i| lanes | 1 << i);
        for is_known in [false, true] {
            let mut bounds = LeafBounds::new(&search, &region, !L::EDGES);
            if is_known {
                for (&t, &p) in triangles.iter().zip(&order) {
                    search.offer(p, t);
                }
                bounds.toward(&search, search.position());
                bounds.follow(&search);
            }
            for level in Level::ALL.into_iter().filter(|l| l.is_available() && l.lanes() >= N) {
                let (lanes, still, most) = level.dispatch(Visit { leaves: &leaves, bounds, count });
                prop_assert!(lanes & still & nearest == nearest, "{:?}: {:?} of {:?}", level, point, triangles);
                prop_assert!(most >= least, "{:?}: {} of {}", level, most, least);
            }
        }
        Ok(())
    }

    fn vector(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    /// Triangles of any shape and size, and a point somewhere, or within roundings of the first one.
    fn near_a_point() -> impl Strategy<Value = (DVec3, Vec<[DVec3; 3]>)> {
        let triangle = (vector(1.0), [vector(1.0), vector(1.0), vector(1.0)], 0i32..24, 0i32..24);
        let triangles = prop::collection::vec(triangle, 1..=4);
        let point = (vector(1.0), (0.0..1.0f64, 0.0..1.0f64), -26i32..6, -60i32..60);
        (triangles, point).prop_map(|(triangles, (away, (v, w), far, scale))| {
            let triangles: Vec<_> = triangles
                .into_iter()
                .map(|(at, ways, small, thin)| {
                    let mut corners = ways.map(|way| at + way * 2f64.powi(-small));
                    corners[2] = corners[1] + (corners[2] - corners[1]) * 2f64.powi(-thin);
                    corners.map(|c| (c * 2f64.powi(scale)).as_vec3().as_dvec3())
                })
                .collect();
            let [a, b, c] = triangles[0];
            let (v, w) = (v, w * (1.0 - v));
            (a * (1.0 - v - w) + b * v + c * w + away * 2f64.powi(far + scale), triangles)
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn no_nearest_triangle_is_passed((point, triangles) in near_a_point()) {
            bounds_hold::<4, SingleLeaves<4>>(point, &triangles)?;
            bounds_hold::<8, SingleLeaves<8>>(point, &triangles)?;
            bounds_hold::<4, DoubleLeaves<4>>(point, &triangles)?;
            bounds_hold::<8, DoubleLeaves<8>>(point, &triangles)?;
        }
    }
}
