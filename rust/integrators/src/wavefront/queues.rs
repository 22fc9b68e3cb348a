//! Paths and shadow rays that wait for their next stage.

use raywright_base::math::{LANES, PathRays, SingleLanes, VectorLanes};
use raywright_base::simd::{Column, Level, pack};

/// Paths on their way, each number in a column.
pub(super) struct PathQueue {
    /// The ray that each is about to follow.
    pub rays: PathRays,
    /// What of the radiance along its ray reaches its sample, by channel.
    pub throughput: [Vec<f32>; 3],
    /// Density with which its direction was drawn; infinite for a camera's ray.
    pub pdf: Vec<f32>,
    /// The normal where it was scattered last, if light is chosen or drawn by that.
    pub normal: [Vec<f32>; 3],
    /// Whose sample it is.
    pub sample: Vec<u32>,
}

/// Shadow rays, and what they bring if nothing blocks them.
pub(super) struct ShadowQueue {
    pub rays: PathRays,
    /// By channel.
    pub arriving: [Vec<f32>; 3],
    /// At whose sample.
    pub sample: Vec<u32>,
}

/// Paths that go on, a lane each.
pub(super) struct PathLanes<'a> {
    pub origin: &'a VectorLanes,
    pub direction: &'a SingleLanes,
    /// The triangles that their rays miss.
    pub misses: &'a [[u32; 2]; LANES],
    pub throughput: &'a SingleLanes,
    pub pdf: &'a [f32; LANES],
    pub normal: &'a SingleLanes,
    pub sample: &'a [u32; LANES],
}

/// Shadow rays, a lane each.
pub(super) struct ShadowLanes<'a> {
    pub origin: &'a VectorLanes,
    pub direction: &'a SingleLanes,
    pub t_max: &'a [f64; LANES],
    pub misses: &'a [[u32; 2]; LANES],
    pub arriving: &'a SingleLanes,
    pub sample: &'a [u32; LANES],
}

fn three(room: usize) -> [Vec<f32>; 3] {
    [0; 3].map(|_| vec![0.0; room])
}

impl PathQueue {
    /// Room for so many paths.
    pub fn with_room(most: usize, has_normals: bool) -> Self {
        let room = most + LANES;
        Self {
            rays: PathRays::with_room(most, true),
            throughput: three(room),
            pdf: vec![0.0; room],
            normal: three(if has_normals { room } else { 0 }),
            sample: vec![0; room],
        }
    }

    /// Appends the paths of the lanes in a mask.
    #[inline]
    pub fn push(&mut self, level: Level, mask: u32, paths: &PathLanes<'_>) {
        let at = self.rays.len;
        let [ox, oy, oz] = &mut self.rays.origin;
        let [dx, dy, dz] = &mut self.rays.direction;
        let [r, g, b] = &mut self.throughput;
        let [from_x, from_y, from_z] = paths.origin.by_axis();
        let columns = [
            Column::new(from_x, &mut ox[at..]),
            Column::new(from_y, &mut oy[at..]),
            Column::new(from_z, &mut oz[at..]),
            Column::new(&paths.direction.0[0], &mut dx[at..]),
            Column::new(&paths.direction.0[1], &mut dy[at..]),
            Column::new(&paths.direction.0[2], &mut dz[at..]),
            Column::new(paths.misses, &mut self.rays.misses[at..]),
            Column::new(&paths.throughput.0[0], &mut r[at..]),
            Column::new(&paths.throughput.0[1], &mut g[at..]),
            Column::new(&paths.throughput.0[2], &mut b[at..]),
            Column::new(paths.pdf, &mut self.pdf[at..]),
            Column::new(paths.sample, &mut self.sample[at..]),
        ];
        pack(level, mask, &columns);
        if !self.normal[0].is_empty() {
            let [x, y, z] = &mut self.normal;
            let columns = [
                Column::new(&paths.normal.0[0], &mut x[at..]),
                Column::new(&paths.normal.0[1], &mut y[at..]),
                Column::new(&paths.normal.0[2], &mut z[at..]),
            ];
            pack(level, mask, &columns);
        }
        self.rays.len += mask.count_ones() as usize;
    }
}

impl ShadowQueue {
    /// Room for so many rays.
    pub fn with_room(most: usize) -> Self {
        let room = most + LANES;
        Self { rays: PathRays::with_room(most, false), arriving: three(room), sample: vec![0; room] }
    }

    /// Appends the rays of the lanes in a mask.
    #[inline]
    pub fn push(&mut self, level: Level, mask: u32, shadows: &ShadowLanes<'_>) {
        let at = self.rays.len;
        let [ox, oy, oz] = &mut self.rays.origin;
        let [dx, dy, dz] = &mut self.rays.direction;
        let [r, g, b] = &mut self.arriving;
        let [from_x, from_y, from_z] = shadows.origin.by_axis();
        let columns = [
            Column::new(from_x, &mut ox[at..]),
            Column::new(from_y, &mut oy[at..]),
            Column::new(from_z, &mut oz[at..]),
            Column::new(&shadows.direction.0[0], &mut dx[at..]),
            Column::new(&shadows.direction.0[1], &mut dy[at..]),
            Column::new(&shadows.direction.0[2], &mut dz[at..]),
            Column::new(shadows.t_max, &mut self.rays.t_max[at..]),
            Column::new(shadows.misses, &mut self.rays.misses[at..]),
            Column::new(&shadows.arriving.0[0], &mut r[at..]),
            Column::new(&shadows.arriving.0[1], &mut g[at..]),
            Column::new(&shadows.arriving.0[2], &mut b[at..]),
            Column::new(shadows.sample, &mut self.sample[at..]),
        ];
        pack(level, mask, &columns);
        self.rays.len += mask.count_ones() as usize;
    }
}
