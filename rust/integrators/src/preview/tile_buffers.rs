//! What a thread needs for a tile of a preview; kept, since to make it anew takes as long as many rays.

use super::TILE;
use raywright_base::math::{DVec3, Hit, LANES, Numbers, Ray, RayColumns, VectorLanes, Vectors};
use raywright_base::sampling::Pairs;
use raywright_scene::SurfaceLanes;

/// Rays by columns, with room for sixteen more than a tile has.
pub(super) struct TileRays {
    pub len: usize,
    pub origin: [Vec<f64>; 3],
    pub direction: [Vec<f64>; 3],
    pub time: Vec<f64>,
    pub t_max: f64,
    /// The same one after the other, where something is no triangle.
    pub rows: Vec<Ray>,
}

impl TileRays {
    pub fn new() -> Self {
        let column = || vec![0.0; TILE + LANES];
        Self {
            len: 0,
            origin: [column(), column(), column()],
            direction: [column(), column(), column()],
            time: column(),
            t_max: f64::INFINITY,
            rows: Vec::new(),
        }
    }

    /// Adds the rays of those lanes that are in a mask.
    #[inline(always)]
    pub fn push(&mut self, origin: &VectorLanes, direction: &VectorLanes, time: &[f64; LANES], mask: u32) {
        let (mut lanes, mut count) = ([0; LANES], 0);
        for lane in 0..LANES {
            lanes[count & (LANES - 1)] = lane;
            count += (mask >> lane & 1) as usize;
        }
        let from = self.len;
        let append = |column: &mut [f64], all: &[f64; LANES]| {
            let to = &mut column[from..from + LANES];
            if count == LANES {
                to.copy_from_slice(all);
            } else {
                for i in 0..LANES {
                    to[i] = all[lanes[i] & (LANES - 1)];
                }
            }
        };
        for axis in 0..3 {
            append(&mut self.origin[axis], origin.by_axis()[axis]);
            append(&mut self.direction[axis], direction.by_axis()[axis]);
        }
        append(&mut self.time, time);
        self.len += count;
    }

    pub fn columns(&self) -> RayColumns<'_> {
        let [origin, direction] = [&self.origin, &self.direction].map(|columns| {
            Vectors::Double([&columns[0][..self.len], &columns[1][..self.len], &columns[2][..self.len]])
        });
        RayColumns::new(origin, direction, Numbers::One(0.0), Numbers::One(self.t_max))
    }

    pub fn in_rows(&mut self) -> &[Ray] {
        let mut rows = std::mem::take(&mut self.rows);
        let at = |columns: &[Vec<f64>; 3], i: usize| DVec3::new(columns[0][i], columns[1][i], columns[2][i]);
        let ray = |i| Ray::new(at(&self.origin, i), at(&self.direction, i));
        rows.clear();
        rows.extend((0..self.len).map(|i| Ray { t_max: self.t_max, time: self.time[i], ..ray(i) }));
        self.rows = rows;
        &self.rows
    }
}

/// What a thread needs for a tile.
pub(super) struct TileBuffers {
    pub rays: TileRays,
    pub t: Vec<f64>,
    pub uv: Vec<[f64; 2]>,
    /// −1 for a miss.
    pub primitive: Vec<i32>,
    /// The hits, where something is no triangle.
    pub hits: Vec<Hit>,
    /// Which rays hit something: the first so many.
    pub which: Vec<u32>,
    pub seen: usize,
    pub colors: Vec<[f32; 3]>,
    pub shadow_rays: TileRays,
    /// The ray of each shadow ray, and what its light adds.
    pub lit: Vec<(u32, [f32; 3])>,
    pub occluded: Vec<bool>,
    pub block: Box<HitBlock>,
}

/// Sixteen hits on their way.
pub(super) struct HitBlock {
    pub which: [u32; LANES],
    pub rays: [Ray; LANES],
    pub hits: [Hit; LANES],
    pub primitive: [u32; LANES],
    pub uv: Pairs,
    pub surfaces: SurfaceLanes,
    pub view: VectorLanes,
    pub time: [f64; LANES],
    pub origin: VectorLanes,
    pub direction: VectorLanes,
    pub cosine: [f64; LANES],
    pub front: [f64; LANES],
}

impl TileBuffers {
    pub fn new() -> Self {
        const NO_RAY: Ray = Ray::new(DVec3::ZERO, DVec3::NAN);
        let block = HitBlock {
            which: [0; LANES],
            rays: [NO_RAY; LANES],
            hits: [Hit::MISS; LANES],
            primitive: [0; LANES],
            uv: [[0.0; LANES]; 2],
            surfaces: SurfaceLanes::NONE,
            view: VectorLanes::ZERO,
            time: [0.0; LANES],
            origin: VectorLanes::ZERO,
            direction: VectorLanes::ZERO,
            cosine: [0.0; LANES],
            front: [0.0; LANES],
        };
        Self {
            rays: TileRays::new(),
            t: vec![0.0; TILE],
            uv: vec![[0.0; 2]; TILE],
            primitive: vec![0; TILE],
            hits: Vec::new(),
            which: vec![0; TILE],
            seen: 0,
            colors: vec![[0.0; 3]; TILE],
            shadow_rays: TileRays::new(),
            lit: Vec::new(),
            occluded: vec![false; TILE],
            block: Box::new(block),
        }
    }
}
