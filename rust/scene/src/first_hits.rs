//! First hits of a camera by rasterization: a z-buffer of primitives (Catmull, "A subdivision algorithm for computer
//! display of curved surfaces", 1974). Every pixel's decision equals that of its ray.
//!
//! Each triangle is projected once, to a rectangle of pixels that contains all rays that can hit it
//! (`pixel_bounds.rs`). The picture is cut into tiles, and the triangles of a tile are processed nearest first. A
//! conservative test rejects pixels that an edge certainly misses, or that are certainly hidden by an earlier hit. For
//! the others the exact ray-triangle test ([`EdgeRay`]) decides the hit and its `t`, so hits equal those of
//! [`Scene::intersect`](super::Scene::intersect) bit for bit.
//!
//! A tile falls back to the BVH if its triangles are so many or so large that rasterizing them takes longer. The whole
//! picture falls back if there are too many triangles for its pixels, if a shape is not a mesh, or if the camera is not
//! a pinhole at rest.

use super::Scene;
use super::cameras::{Camera, Perspective};
use super::pixel_bounds::{Pixels, View};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray, RayBatch, Tiling};
use raywright_base::parallel::{self, CHUNK};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd};
use raywright_shapes::triangle::{ALL, Column, EdgeRay, EdgeRays, RAYS, bits};
use std::ops::Range;

/// Pixels along a tile's side: the rays of a row are tested together.
const SIDE: usize = RAYS;

/// Pixels of a tile.
const TILE: usize = SIDE * SIDE;

/// Projecting all triangles pays off from this number of pixels per triangle.
const PIXELS: usize = 4;

/// A triangle that may be hit.
#[derive(Clone, Copy, Debug)]
struct Projected {
    primitive: u32,
    /// Lower bound on its distance along the view.
    depth: f32,
    pixels: Pixels,
}

/// Prepares a camera's picture to find its first hits band by band.
pub struct FirstHits<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    /// Position in the pixel: one for all pixels, or one each.
    offsets: &'a [[f64; 2]],
    /// A pinhole at rest and its view; other cameras use the BVH.
    view: Option<(&'a Perspective, View)>,
    projected: Vec<Projected>,
    /// Triangle indices of each band of tiles, and the start of each band's list.
    in_band: Vec<u32>,
    splits: Vec<usize>,
    /// True if tiles may be rasterized.
    is_plain: bool,
    level: Level,
}

impl<'a> FirstHits<'a> {
    /// Projects all triangles of a scene on the current thread pool. `offsets` are ray positions in the pixel, (0, 0)
    /// at its upper left: one for all pixels, or one each.
    ///
    /// # Panics
    /// If there is another number of offsets.
    pub fn new(scene: &'a Scene, camera: &'a dyn Camera, offsets: &'a [[f64; 2]], level: Level) -> Self {
        let (width, height) = (camera.width() as usize, camera.height() as usize);
        assert!(offsets.len() == 1 || offsets.len() == width * height, "an offset for all pixels, or for each");
        let (geometry, region) = (scene.geometry(), scene.region());
        let view = camera.as_perspective().map(|pinhole| {
            let reach = (pinhole.viewpoint().position - region.centre).abs().max_element() + region.radius;
            (pinhole, View::new(pinhole, offsets, reach, EdgeRay::T_ERROR))
        });
        // Rows and columns are u16.
        let is_plain = view.is_some()
            && geometry.first_other().is_none()
            && width.max(height) <= 1 << 16
            && geometry.count().saturating_mul(PIXELS) <= width * height;
        let count = if is_plain { geometry.count() } else { 0 };
        let project = |primitive: u32| {
            let corners = geometry.corners(primitive);
            if !corners.iter().all(|c| c.is_finite()) {
                return None;
            }
            let (_, view) = view.as_ref()?;
            let seen = view.see(corners)?;
            let pixels = view.pixels(&seen)?;
            Some(Projected { primitive, depth: (seen.depth as f32).next_down(), pixels })
        };
        let project = |some: Range<usize>| (some.start as u32..some.end as u32).filter_map(project).collect();
        let projected: Vec<Vec<_>> = parallel::map_chunks(count, CHUNK, project);
        let projected: Vec<_> = projected.into_iter().flatten().collect();
        let bands = |p: &Projected| usize::from(p.pixels.y[0]) / SIDE..=usize::from(p.pixels.y[1]) / SIDE;
        let (splits, in_band) = lists(height.div_ceil(SIDE), projected.len(), |i| bands(&projected[i]));
        Self { scene, camera, offsets, view, projected, in_band, splits, is_plain, level }
    }

    /// Pixels of a band, in whole rows; the last band may have fewer.
    pub fn band(&self) -> usize {
        SIDE * self.camera.width() as usize
    }

    /// Finds the first hits of a band, row by row. Returns the number of pixels that used the BVH.
    pub fn answer(&self, band: usize, hits: &mut [Hit]) -> usize {
        let width = self.camera.width() as usize;
        let rows = hits.len() / width;
        let mine = &self.in_band[self.splits[band]..self.splits[band + 1]];
        let columns = |&i: &u32| {
            let [first, last] = self.projected[i as usize].pixels.x.map(usize::from);
            first / SIDE..=last / SIDE
        };
        let (splits, in_tile) = lists(width.div_ceil(SIDE), mine.len(), |i| columns(&mine[i]));
        let mut tile = Tile::default();
        let mut by_tree = 0;
        for (column, ends) in splits.windows(2).enumerate() {
            let (x, y) = (column * SIDE, band * SIDE);
            let across = SIDE.min(width - x);
            let pixels = Pixels { x: [x as u16, (x + across - 1) as u16], y: [y as u16, (y + rows - 1) as u16] };
            let triangles = in_tile[ends[0]..ends[1]].iter().map(|&i| self.projected[mine[i as usize] as usize]);
            by_tree += tile.answer(self, pixels, triangles);
            for row in 0..rows {
                hits[row * width + x..][..across].copy_from_slice(&tile.hits[row * across..][..across]);
            }
        }
        by_tree
    }
}

/// Sorts `count` items into lists; an item may be in several. Returns the indices list by list, and the start of each
/// list.
fn lists(lists: usize, count: usize, of: impl Fn(usize) -> std::ops::RangeInclusive<usize>) -> (Vec<usize>, Vec<u32>) {
    let mut splits = vec![0; lists + 1];
    for i in 0..count {
        for list in of(i) {
            splits[list + 1] += 1;
        }
    }
    for list in 0..lists {
        splits[list + 1] += splits[list];
    }
    let mut next = splits.clone();
    let mut all = vec![0; splits[lists]];
    for i in 0..count {
        for list in of(i) {
            all[next[list]] = i as u32;
            next[list] += 1;
        }
    }
    (splits, all)
}

/// A tile of the picture.
struct Tile {
    /// The rays, row by row.
    rays: Vec<Ray>,
    /// The hits, row by row. During rasterization their `t` is along the scaled direction.
    hits: Vec<Hit>,
    triangles: Vec<Projected>,
    rows: Vec<Row>,
}

/// The rays of a row.
#[derive(Clone)]
struct Row {
    edges: EdgeRays,
    /// True if they can be tested together.
    is_plain: bool,
    /// Their film positions.
    film: [Column<f64>; 2],
    /// Distance along the view beyond which no triangle can replace the current hit.
    beyond: Column<f64>,
    /// Factor from `t` along the scaled direction to `t` of the ray.
    scale: Column<f64>,
}

impl Default for Tile {
    fn default() -> Self {
        let none = [0.0; RAYS];
        let row =
            Row { edges: EdgeRays::default(), is_plain: false, film: [none; 2], beyond: none, scale: [1.0; RAYS] };
        Self { rays: Vec::new(), hits: Vec::new(), triangles: Vec::new(), rows: vec![row; SIDE] }
    }
}

impl Tile {
    /// Finds the first hits of some pixels. Returns the number of pixels that used the BVH.
    fn answer(&mut self, of: &FirstHits, pixels: Pixels, triangles: impl Iterator<Item = Projected>) -> usize {
        let count = pixels.count();
        self.hits.clear();
        self.hits.resize(count, Hit::MISS);
        self.triangles.clear();
        // Cost model: preparing a triangle for the tile and rasterizing one row of it take about as long. A ray in the
        // BVH takes slightly longer than either.
        let most = count + count / 4;
        let mut work = if of.is_plain { 0 } else { most + 1 };
        for triangle in triangles {
            work += 1 + triangle.pixels.shared(pixels).map_or(0, |p| usize::from(p.y[1] - p.y[0]) + 1);
            if work > most {
                break;
            }
            self.triangles.push(triangle);
        }
        if work > most {
            self.aim(of, pixels);
            self.ask_tree(of, usize::from(pixels.x[1] - pixels.x[0]) + 1);
            return count;
        }
        if !self.triangles.is_empty() {
            self.triangles.sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth).then(a.primitive.cmp(&b.primitive)));
            self.aim(of, pixels);
            of.level.dispatch(Rasterise { tile: self, of, pixels });
        }
        0
    }

    /// Generates the rays of some pixels.
    fn aim(&mut self, of: &FirstHits, pixels: Pixels) {
        let width = of.camera.width() as usize;
        self.rays.clear();
        for (y, to) in (pixels.y[0]..=pixels.y[1]).zip(&mut self.rows) {
            for x in pixels.x[0]..=pixels.x[1] {
                let pixel = usize::from(y) * width + usize::from(x);
                let [right, down] = of.offsets[if of.offsets.len() == 1 { 0 } else { pixel }];
                let at = [f64::from(x) + right, f64::from(y) + down];
                self.rays.push(match &of.view {
                    Some((pinhole, view)) => {
                        let column = usize::from(x - pixels.x[0]);
                        [to.film[0][column], to.film[1][column]] = view.film(at[0], at[1]);
                        pinhole.ray_through(at[0], at[1])
                    }
                    None => of.camera.ray(at, [0.5; 2], 0.0).ray,
                });
            }
        }
    }

    /// Intersects the rays with the BVH, in blocks of adjacent pixels.
    fn ask_tree(&mut self, of: &FirstHits, across: usize) {
        let count = self.rays.len();
        let mut places = [0; TILE];
        let places = &mut places[..count];
        Tiling::new(count, across).places(0, count, places);
        let rays: Vec<_> = places.iter().map(|&place| self.rays[place]).collect();
        let mut hits = vec![Hit::MISS; count];
        of.scene.intersect(&rays, &mut hits);
        for (hit, &place) in hits.iter().zip(&*places) {
            self.hits[place] = *hit;
        }
    }
}

/// Rasterizes the triangles of a tile one by one.
struct Rasterise<'a, 'b> {
    tile: &'a mut Tile,
    of: &'a FirstHits<'b>,
    pixels: Pixels,
}

impl Kernel<4> for Rasterise<'_, '_> {
    type Output = ();

    // The lane type is not used: the compiler vectorizes the row loops for the level, and the bits are the same at
    // every level.
    #[inline(always)]
    fn run<S: Simd<4>>(self, _: S) {
        /// This many rays or fewer are tested one by one.
        const FEW: u32 = 2;
        let Self { tile: Tile { rays, hits, triangles, rows }, of, pixels } = self;
        let Some((pinhole, view)) = &of.view else { return };
        let (geometry, region) = (of.scene.geometry(), of.scene.region());
        let forward = pinhole.viewpoint().forward;
        let across = usize::from(pixels.x[1] - pixels.x[0]) + 1;
        for (row, rays) in rows.iter_mut().zip(rays.chunks(across)) {
            row.edges.take(&RayBatch::Rows(rays), 0);
            row.is_plain = row.edges.prepare(region) == ALL;
            row.beyond = [f64::INFINITY; RAYS];
        }
        let window = view.window(pixels);
        let most = window[0][0].abs().max(window[0][1].abs()) + window[1][0].abs().max(window[1][1].abs());
        for triangle in triangles.iter() {
            let corners = geometry.corners(triangle.primitive);
            let (Some(seen), Some(shared)) = (view.see(corners), triangle.pixels.shared(pixels)) else { continue };
            if view.is_beside(&seen, &window) {
                continue;
            }
            let (sides, above) = (seen.sides(), seen.side_error(view, most));
            let (first, last) = (shared.x[0] - pixels.x[0], shared.x[1] - pixels.x[0]);
            let columns = (u32::MAX << first) & (u32::MAX >> (31 - last));
            for y in shared.y[0]..=shared.y[1] {
                let at = usize::from(y - pixels.y[0]) & (SIDE - 1);
                let row = &mut rows[at];
                let mut left = columns & row.not_passed(&sides, above, seen.depth);
                let rays = &rays[at * across..];
                let hits = &mut hits[at * across..];
                if left.count_ones() > FEW && row.is_plain {
                    let all = row.edges.meet(S::FUSED, corners, left);
                    left = all.open;
                    let mut met = all.met;
                    while met != 0 {
                        let i = met.trailing_zeros() as usize & (RAYS - 1);
                        met &= met - 1;
                        let hit = Hit {
                            t: all.t[i],
                            uv: [all.uv[0][i], all.uv[1][i]],
                            primitive: triangle.primitive,
                            inner: 0,
                        };
                        row.offer(i, hit, row.edges.scale[i], &rays[i], forward, &mut hits[i]);
                    }
                }
                while left != 0 {
                    let i = left.trailing_zeros() as usize & (RAYS - 1);
                    left &= left - 1;
                    let Some(ray) = EdgeRay::new(&rays[i], region) else { continue };
                    if let Some(met) = ray.meet(corners) {
                        let hit = Hit { t: met.t, uv: met.uv, primitive: triangle.primitive, inner: 0 };
                        row.offer(i, hit, ray.scale, &rays[i], forward, &mut hits[i]);
                    }
                }
            }
        }
        for (row, hits) in rows.iter().zip(hits.chunks_mut(across)) {
            for (hit, scale) in hits.iter_mut().zip(row.scale) {
                if hit.is_hit() {
                    hit.t *= scale;
                }
            }
        }
    }
}

impl Row {
    /// Mask of the rays that may hit a triangle, with one edge on their left and another on their right, and that have
    /// no certain hit nearer than this depth.
    #[inline(always)]
    fn not_passed(&self, sides: &[DVec3; 3], above: f64, depth: f64) -> u32 {
        let mut left = [0u32; RAYS];
        for i in 0..RAYS {
            let (x, y) = (self.film[0][i], self.film[1][i]);
            let u = sides[0].x * x + sides[0].y * y + sides[0].z;
            let v = sides[1].x * x + sides[1].y * y + sides[1].z;
            let w = sides[2].x * x + sides[2].y * y + sides[2].z;
            let passed = ((u > above) | (v > above) | (w > above)) & ((u < -above) | (v < -above) | (w < -above));
            left[i] = u32::from(!(passed | (self.beyond[i] < depth)));
        }
        bits(&left)
    }

    /// Records a hit of ray `i` if it is closer; at equal `t` the lowest primitive wins.
    ///
    /// Each `t` has an error of at most [`EdgeRay::T_ERROR`] of the largest coordinate, and the depth a few roundings.
    #[inline(always)]
    fn offer(&mut self, i: usize, hit: Hit, scale: f64, ray: &Ray, forward: DVec3, best: &mut Hit) {
        const ROOM: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;
        if hit.t < best.t || (hit.t == best.t && hit.primitive < best.primitive) {
            *best = hit;
            let t = hit.t + 4.0 * EdgeRay::T_ERROR * self.edges.largest[i];
            self.beyond[i] = t * scale * ray.direction.dot(forward) * ROOM;
            self.scale[i] = scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::Window;
    use crate::fixtures::{furnace, scene, shape};
    use crate::{Mesh, SceneDescription};
    use proptest::prelude::*;
    use raywright_base::math::Vec3;

    /// Rasterizes at every level and checks that hits equal those of rays bit for bit. Returns the number of pixels
    /// that used the BVH.
    fn agreed(scene: &Scene, camera: &dyn Camera, offsets: &[[f64; 2]]) -> usize {
        let (width, height) = (camera.width() as usize, camera.height() as usize);
        let ray = |i: usize| {
            let [x, y] = offsets[i % offsets.len()];
            camera.ray([(i % width) as f64 + x, (i / width) as f64 + y], [0.5; 2], 0.0).ray
        };
        let rays: Vec<_> = (0..width * height).map(ray).collect();
        let mut wanted = vec![Hit::MISS; rays.len()];
        scene.intersect(&rays, &mut wanted);
        let mut asked = 0;
        let best = Level::current().unwrap();
        for level in [Level::Scalar, best] {
            let picture = FirstHits::new(scene, camera, offsets, level);
            let mut found = vec![Hit { primitive: 0, ..Hit::MISS }; rays.len()];
            asked = found.chunks_mut(picture.band()).enumerate().map(|(band, hits)| picture.answer(band, hits)).sum();
            for (i, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                let bits = |h: &Hit| (h.t.to_bits(), h.uv.map(f64::to_bits), h.primitive, h.inner);
                assert_eq!(bits(found), bits(wanted), "pixel {i}");
            }
        }
        asked
    }

    #[test]
    fn a_room_from_within_hardly_needs_the_tree() {
        let room = furnace(0.5, 0.0);
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        for (position, target, fov) in [
            (at(0.1, 0.2, 0.3), at(0.9, 0.1, -0.8), 70.0),
            (at(0.0, 0.0, 0.0), at(1.0, 1.0, 1.0), 170.0),
            // Cameras on a wall, at a corner and outside.
            (at(-1.0, 0.0, 0.0), at(0.0, 0.0, 1.0), 100.0),
            (at(-1.0, -1.0, -1.0), at(0.0, 0.1, 0.0), 90.0),
            (at(5.0, 4.0, 3.0), at(0.0, 0.0, 0.0), 30.0),
            (at(5e8, 4e8, 3e8), at(0.0, 0.0, 0.0), 2e-7),
        ] {
            let camera = Perspective::looking_at(position, target, DVec3::Y, fov, 53, 37).unwrap();
            let asked = agreed(&room, &camera, &[[0.5, 0.5]]);
            // All tiles but the last of each row rasterize: those are five pixels wide, and their walls cost as much as
            // their pixels.
            assert!(asked <= 5 * 37, "{asked} pixels of the tree");
        }
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![-2.0f32..2.0, (-2i32..=2).prop_map(|x| x as f32)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn any_triangles_from_anywhere(
            corners in prop::collection::vec(prop::array::uniform3(coordinate()), 3..90),
            position in prop::array::uniform3(coordinate()), target in prop::array::uniform3(coordinate()),
            fov in prop_oneof![Just(90.0), 1.0..179.0f64],
            offset in prop::array::uniform2(prop_oneof![Just(0.0), Just(0.5), -1.0..2.0f64]),
            matrix in (
                prop_oneof![2.0..100.0f64, -100.0..-2.0f64], 2.0..100.0f64, prop_oneof![Just(0.0), -50.0..50.0f64],
                -50.0..90.0f64, -50.0..70.0f64,
            ).prop_map(<[f64; 5]>::from),
        ) {
            let vertices: Vec<_> = corners.iter().map(|&c| Vec3::from_array(c)).collect();
            let faces = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = Mesh { vertices: vertices.into(), faces, normals: None, ..Mesh::default() };
            let scene = scene(SceneDescription { shapes: vec![shape(mesh, [0.5; 3], 0.0)], ..Default::default() });
            let [position, target] = [position, target].map(|p| Vec3::from_array(p).as_dvec3());
            if let Ok(camera) = Perspective::looking_at(position, target, DVec3::new(0.1, 1.0, 0.2), fov, 35, 20) {
                agreed(&scene, &camera, &[offset]);
                let [across, down, skew, x, y] = matrix;
                let window = Window::of_matrix([across, down], [x, y], skew, camera.body().size()).unwrap();
                agreed(&scene, &Perspective::new(camera.body().clone(), window), &[offset]);
            }
        }
    }
}
