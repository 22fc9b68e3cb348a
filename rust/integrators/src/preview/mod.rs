//! Previews: a ray and at most one shadow ray a pixel, shaded by Lambert's law. The stages of a tile follow upon each
//! other while its rays and hits are in a near cache.

mod pixel;
mod shadow_rays;
mod tile_buffers;

pub use pixel::Pixel;
pub use shadow_rays::PreviewLight;

use raywright_accel::ByColumns;
use raywright_base::math::{Hit, HitColumns, LANES, Ray, gather};
use raywright_base::simd::Level;
use raywright_optics::Bsdf;
use raywright_scene::{Camera, CameraRayLanes, RayOrigin, Scene, ShadingPoint};
use shadow_rays::{towards_eye, towards_point, towards_sun};
use std::cell::Cell;
use tile_buffers::{HitBlock, TileBuffers};

/// Pixels of a tile: some columns of a band.
const TILE: usize = 1024;

/// Pixels on the side of a block, whose rays share a packet.
const SIDE: usize = 4;

/// What is known of a shape beforehand.
#[derive(Clone, Copy)]
enum Look {
    /// It gives off light: it is white.
    Shines,
    /// What it reflects at all of its points, on the front and on the back.
    Constant([[f32; 3]; 2]),
    /// The material has to be asked.
    Asked,
}

/// A picture of a scene that is drawn in bands of rows.
pub struct Preview<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    light: PreviewLight,
    ambient: f32,
    background: [f32; 3],
    level: Level,
    /// What is known of each shape.
    looks: Vec<Look>,
    /// What takes rays by columns, if all are triangles.
    triangles: Option<&'a dyn ByColumns>,
}

thread_local! {
    static ROOM: Cell<Option<Box<TileBuffers>>> = const { Cell::new(None) };
}

fn single(color: raywright_optics::Rgb) -> [f32; 3] {
    color.to_array().map(|value| value as f32)
}

impl<'a> Preview<'a> {
    /// Rows of a band, whose pixels are drawn together.
    pub const ROWS: usize = 2 * SIDE;

    /// A picture by a light; of its light the share `ambient`, from 0 to 1, reaches every point.
    pub fn new(
        scene: &'a Scene,
        camera: &'a dyn Camera,
        light: PreviewLight,
        ambient: f32,
        background: [f32; 3],
        level: Level,
    ) -> Self {
        let constant = |shape: u32, is_front| Some(single(scene.plan().constant(shape, is_front)?.albedo()));
        let both = |shape: u32| Some([constant(shape, true)?, constant(shape, false)?]);
        let look = |shape: u32| match both(shape) {
            _ if scene.lights().shines(shape) => Look::Shines,
            Some(both) => Look::Constant(both),
            None => Look::Asked,
        };
        Self {
            scene,
            camera,
            light,
            ambient,
            background,
            level,
            looks: (0..scene.geometry().shapes() as u32).map(look).collect(),
            triangles: scene.accelerator().by_columns().filter(|_| scene.geometry().first_other().is_none()),
        }
    }

    /// Draws the rows from `first` on, of which there are as many as there is room for: at most a band.
    pub fn draw<P: Pixel>(&self, first: usize, rows: &mut [[P; 3]]) {
        let mut room = ROOM.take().unwrap_or_else(|| Box::new(TileBuffers::new()));
        let width = self.camera.width() as usize;
        let (columns, encoder) = (TILE / Self::ROWS, P::encoder());
        for left in (0..width).step_by(columns) {
            let blocks = (width - left).min(columns).div_ceil(2 * SIDE) * 4;
            self.see(left, first, blocks, &mut room);
            self.shade(&mut room);
            self.cast(&mut room);
            for (i, colors) in room.colors[..blocks * LANES].as_chunks::<SIDE>().0.iter().enumerate() {
                let [x, y] = place(i * SIDE);
                let some = SIDE.min(width.saturating_sub(left + x));
                let start = y * width + left + x;
                if let Some(pixels) = rows.get_mut(start..start + some) {
                    for (pixel, &color) in pixels.iter_mut().zip(colors) {
                        *pixel = P::of(color, encoder);
                    }
                }
            }
        }
        ROOM.set(Some(room));
    }

    /// Finds the closest hits of the rays of a tile. What lies beyond the picture has the rays of its edge.
    fn see(&self, left: usize, top: usize, blocks: usize, room: &mut TileBuffers) {
        let TileBuffers { rays, t, uv, primitive, hits, which, seen, colors, .. } = room;
        rays.len = 0;
        let (mut film, mut lanes) = ([[0.0; LANES]; 2], CameraRayLanes::NONE);
        let last = [self.camera.width(), self.camera.height()].map(|count| f64::from(count) - 0.5);
        for block in 0..blocks {
            for lane in 0..LANES {
                let [x, y] = place(block * LANES + lane);
                film[0][lane] = ((left + x) as f64 + 0.5).min(last[0]);
                film[1][lane] = ((top + y) as f64 + 0.5).min(last[1]);
            }
            self.camera.rays(self.level, &film, &[[0.5; LANES]; 2], &[0.0; LANES], &mut lanes);
            rays.push(lanes.origin(), lanes.direction(), lanes.time(), u32::MAX);
        }
        let count = rays.len;
        let (t, uv, primitive) = (&mut t[..count], &mut uv[..count], &mut primitive[..count]);
        match self.triangles {
            Some(tree) => tree.intersect(&rays.columns(), HitColumns { t, uv, primitive }),
            None => {
                hits.clear();
                hits.resize(count, Hit::MISS);
                self.scene.intersect(rays.in_rows(), hits);
                for (to, hit) in primitive.iter_mut().zip(hits) {
                    *to = hit.primitive as i32;
                }
            }
        }
        colors[..count].fill(self.background);
        *seen = 0;
        for (i, &primitive) in (0..).zip(&*primitive) {
            which[*seen] = i;
            *seen += usize::from(primitive >= 0);
        }
    }

    /// Shades the hits of a tile by ambient light, and queues shadow rays where more may come.
    fn shade(&self, room: &mut TileBuffers) {
        room.shadow_rays.len = 0;
        room.lit.clear();
        let direct = 1.0 - self.ambient;
        for from in (0..room.seen).step_by(LANES) {
            let count = LANES.min(room.seen - from);
            self.look_up(from, room);
            self.look_at_light(&mut room.block);
            let TileBuffers { colors, shadow_rays, lit, block, .. } = &mut *room;
            let mut mask = 0;
            for lane in 0..count {
                let color = &mut colors[block.which[lane] as usize];
                let albedo = match self.looks[block.surfaces.shape(lane) as usize] {
                    Look::Shines => {
                        *color = [1.0; 3];
                        continue;
                    }
                    Look::Constant(sides) => sides[usize::from(block.front[lane] < 0.0)],
                    Look::Asked => self.looked_up(block, lane),
                };
                let factor = direct * block.cosine[lane] as f32;
                // Not where it is NaN, on a light.
                let is_towards = factor > 0.0;
                if is_towards && self.light != PreviewLight::Headlight {
                    mask |= 1 << lane;
                    lit.push((block.which[lane], [factor * albedo[0], factor * albedo[1], factor * albedo[2]]));
                }
                let is_lit = is_towards && self.light == PreviewLight::Headlight;
                let factor = self.ambient + if is_lit { factor } else { 0.0 };
                *color = [factor * albedo[0], factor * albedo[1], factor * albedo[2]];
            }
            if mask != 0 {
                shadow_rays.push(&block.origin, &block.direction, &block.time, mask);
            }
        }
    }

    /// Looks up the points of up to sixteen hits; the last stands in the lanes that are left.
    #[inline(always)]
    fn look_up(&self, from: usize, room: &mut TileBuffers) {
        /// Hits ahead of those that are shaded, whose faces and corners are fetched meanwhile.
        const AHEAD: usize = 48;
        let TileBuffers { rays, uv, primitive, hits, which, seen, block, .. } = room;
        let (geometry, count) = (self.scene.geometry(), *seen);
        for (ahead, corners) in [(2 * AHEAD, false), (AHEAD, true)] {
            for &i in which.get(from + ahead..count.min(from + ahead + LANES)).unwrap_or_default() {
                geometry.expect(primitive[i as usize] as u32, corners);
            }
        }
        for lane in 0..LANES {
            block.which[lane] = which[(from + lane).min(count - 1)];
        }
        for axis in 0..3 {
            gather(&rays.direction[axis], &block.which, block.view.axis_mut(axis));
        }
        gather(&rays.time, &block.which, &mut block.time);
        if self.triangles.is_some() {
            for lane in 0..LANES {
                let i = block.which[lane] as usize;
                block.primitive[lane] = primitive[i] as u32;
                [block.uv[0][lane], block.uv[1][lane]] = uv[i];
            }
            return geometry.triangle_lanes(self.level, &block.primitive, &block.uv, &mut block.surfaces);
        }
        for lane in 0..LANES {
            let i = block.which[lane] as usize;
            (block.rays[lane], block.hits[lane]) = (rays.rows[i], hits[i]);
        }
        geometry.surface_lanes(self.level, &block.rays, &block.hits, &mut block.surfaces);
    }

    /// Computes shadow rays, cosines and sides of a block.
    #[inline(always)]
    fn look_at_light(&self, block: &mut HitBlock) {
        let HitBlock { surfaces, view, origin, direction, cosine, front, .. } = block;
        let (position, error, normal) = (surfaces.position(), surfaces.error(), surfaces.normal());
        match self.light {
            PreviewLight::Headlight => towards_eye(self.level, normal, view, cosine, front),
            PreviewLight::Sun(sun) => {
                towards_sun(self.level, position, error, normal, view, sun, origin, direction, cosine, front);
            }
            PreviewLight::Point(point) => {
                towards_point(self.level, position, error, normal, view, point, origin, direction, cosine, front);
            }
        }
    }

    /// What a surface reflects where it was hit, by its material.
    #[inline(never)]
    fn looked_up(&self, block: &HitBlock, lane: usize) -> [f32; 3] {
        let surface = block.surfaces.get(lane);
        let (ray, hit) = match self.triangles {
            // The point of a triangle is known by its weights, wherever the ray starts.
            Some(_) => (
                Ray { time: block.time[lane], ..Ray::new(surface.position, block.view.get(lane)) },
                Hit {
                    t: 0.0,
                    uv: [block.uv[0][lane], block.uv[1][lane]],
                    primitive: block.primitive[lane],
                    ..Hit::MISS
                },
            ),
            None => (block.rays[lane], block.hits[lane]),
        };
        let material = self.scene.material_at(&surface);
        let point = ShadingPoint::new(self.scene.geometry(), &ray, &hit, surface, material.needs(), 0.0);
        single(material.bsdf(&point).albedo())
    }

    /// Adds the light of the rays that nothing blocks.
    fn cast(&self, room: &mut TileBuffers) {
        let TileBuffers { colors, shadow_rays, lit, occluded, .. } = room;
        if lit.is_empty() {
            return;
        }
        shadow_rays.t_max = if matches!(self.light, PreviewLight::Point(_)) { RayOrigin::END } else { f64::INFINITY };
        let occluded = &mut occluded[..lit.len()];
        match self.triangles {
            Some(tree) => tree.occluded(&shadow_rays.columns(), occluded),
            None => self.scene.occluded(shadow_rays.in_rows(), occluded),
        }
        for (&(i, added), &is_occluded) in lit.iter().zip(&*occluded) {
            if !is_occluded {
                let color = &mut colors[i as usize];
                *color = [color[0] + added[0], color[1] + added[1], color[2] + added[2]];
            }
        }
    }
}

/// Where in a tile its `i`-th pixel lies: blocks of 4 × 4 in fours.
#[inline(always)]
fn place(i: usize) -> [usize; 2] {
    let (block, lane) = (i / LANES, i % LANES);
    let (four, quarter) = (block / 4, block % 4);
    [(2 * four + quarter % 2) * SIDE + lane % SIDE, quarter / 2 * SIDE + lane / SIDE]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_a_tile_once() {
        let mut seen = [[false; TILE / Preview::ROWS]; Preview::ROWS];
        for i in 0..TILE {
            let [x, y] = place(i);
            assert!(!std::mem::replace(&mut seen[y][x], true));
        }
    }
}
