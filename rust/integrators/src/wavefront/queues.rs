//! Paths and shadow rays that wait for their next stage.

use crate::media::spectral_mis::Weights;
use raywright_base::math::{DVec3, LANES, PathRays, Ray, SingleLanes, Vec3, VectorLanes};
use raywright_base::simd::{Column, Level, pack};
use raywright_optics::Rgb;

/// Paths on their way, each number in a column.
pub(super) struct PathQueue {
    /// The ray that each is about to follow.
    pub rays: PathRays,
    /// Throughput by channel: the factor from radiance along its ray to that of its sample.
    pub throughput: [Vec<f32>; 3],
    /// Density with which its direction was drawn; infinite for a camera's ray.
    pub pdf: Vec<f32>,
    /// The normal where it was scattered last, if light is chosen or drawn by that.
    pub normal: [Vec<f32>; 3],
    /// Whose sample it is.
    pub sample: Vec<u32>,
    /// Where it was scattered last, if its ray may start elsewhere: behind boundaries that are no surfaces.
    vertex: [Vec<f64>; 3],
    /// The ratio of radiance at its start to radiance here due to the index of refraction alone, and [`Flags`]; in
    /// scenes that have more than matte surfaces.
    pub scale: Vec<f32>,
    pub flags: Vec<u32>,
    /// Ratio of the density of its directions to that of BSDF sampling ([`super::guided`]); where paths are guided.
    pub aimed: Vec<f32>,
    /// The bundle of neighboring rays at the origin of its ray: how wide it is, and how much wider it gets by length;
    /// where textures are filtered.
    pub width: Vec<f32>,
    pub spread: Vec<f32>,
}

/// Flags of a path.
pub(super) struct Flags;

impl Flags {
    /// Each of few lights was asked where it was scattered last.
    pub const ASKED_EACH: u32 = 1;
    /// It has come to a surface that reflects more than arrives, in a channel.
    pub const HAS_GAMUT_EXCESS: u32 = 2;
    /// Dispersion has ended all of its wavelengths but one.
    pub const SINGLE: u32 = 4;
    /// It is a final gather ray, or goes on from one.
    pub const IS_GATHERED: u32 = 8;
    /// Emission at its end was part of the look-up that its final gather ray started from.
    pub const IS_LIT: u32 = 16;
}

/// The columns that few scenes need.
#[derive(Clone, Copy)]
pub(super) struct Extra {
    /// Normals.
    pub normal: bool,
    /// Scales and flags.
    pub state: bool,
    /// Aims of guided paths.
    pub aimed: bool,
    /// Widths and spreads.
    pub width: bool,
    /// Times.
    pub time: bool,
    /// All of the hits of rays, not their primitives alone.
    pub hits: bool,
    /// Media of shadow rays.
    pub media: bool,
}

/// Shadow rays, and their light if nothing blocks it.
#[derive(Default)]
pub(super) struct ShadowQueue {
    pub rays: PathRays,
    /// By channel.
    pub arriving: [Vec<f32>; 3],
    /// At whose sample.
    pub sample: Vec<u32>,
    /// Media at its start, and the density of scattering over that of light sampling; in scenes with media.
    pub media: Vec<u32>,
    pub ratio: Vec<f32>,
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
    pub scale: &'a [f32; LANES],
    pub flags: &'a [u32; LANES],
    pub aimed: &'a [f32; LANES],
    pub width: &'a [f32; LANES],
    pub spread: &'a [f32; LANES],
    pub time: &'a [f64; LANES],
}

/// Shadow rays, a lane each.
pub(super) struct ShadowLanes<'a> {
    pub origin: &'a VectorLanes,
    pub direction: &'a SingleLanes,
    pub t_max: &'a [f64; LANES],
    pub misses: &'a [[u32; 2]; LANES],
    pub arriving: &'a SingleLanes,
    pub sample: &'a [u32; LANES],
    pub time: &'a [f64; LANES],
    pub media: &'a [u32; LANES],
    pub ratio: &'a [f32; LANES],
}

/// The place of a sample in its batch. Shared radiance has numbers of its own, after those of all samples.
#[inline(always)]
pub(super) fn own(sample: u32, samples: u32) -> u32 {
    sample.min(sample.wrapping_sub(samples)).min(sample.wrapping_sub(samples.wrapping_mul(2)))
}

fn three(room: usize) -> [Vec<f32>; 3] {
    [0; 3].map(|_| vec![0.0; room])
}

/// Makes a column longer, if there is one.
fn lengthen<T: Copy + Default>(column: &mut Vec<T>, room: usize) {
    if !column.is_empty() {
        column.resize(room, T::default());
    }
}

impl PathQueue {
    /// Room for so many paths.
    pub fn with_room(most: usize, extra: Extra) -> Self {
        let room = most + LANES;
        let rays = PathRays::with_room(most, true);
        Self {
            rays: if extra.time { rays.with_times() } else { rays },
            throughput: three(room),
            pdf: vec![0.0; room],
            normal: three(if extra.normal { room } else { 0 }),
            sample: vec![0; room],
            vertex: [0; 3].map(|_| vec![0.0; if extra.media { room } else { 0 }]),
            scale: vec![1.0; if extra.state { room } else { 0 }],
            flags: vec![0; if extra.state { room } else { 0 }],
            aimed: vec![1.0; if extra.aimed { room } else { 0 }],
            width: vec![0.0; if extra.width { room } else { 0 }],
            spread: vec![0.0; if extra.width { room } else { 0 }],
        }
    }

    /// Makes room for so many paths, and keeps those that are there.
    #[inline]
    pub fn make_room(&mut self, most: usize) {
        if self.sample.len() < most + LANES {
            self.grow(2 * (most + LANES));
        }
    }

    #[cold]
    fn grow(&mut self, room: usize) {
        self.rays.make_room(room);
        self.vertex.iter_mut().for_each(|column| lengthen(column, room));
        self.throughput.iter_mut().chain(&mut self.normal).for_each(|column| lengthen(column, room));
        for column in [&mut self.pdf, &mut self.scale, &mut self.aimed, &mut self.width, &mut self.spread] {
            lengthen(column, room);
        }
        lengthen(&mut self.sample, room);
        lengthen(&mut self.flags, room);
    }

    /// Appends the paths of the lanes in a mask.
    #[inline]
    pub fn push(&mut self, level: Level, mask: u32, paths: &PathLanes<'_>) {
        let at = self.rays.len;
        self.make_room(at);
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
        if !self.flags.is_empty() {
            let columns =
                [Column::new(paths.scale, &mut self.scale[at..]), Column::new(paths.flags, &mut self.flags[at..])];
            pack(level, mask, &columns);
        }
        if !self.aimed.is_empty() {
            pack(level, mask, &[Column::new(paths.aimed, &mut self.aimed[at..])]);
        }
        if !self.rays.time.is_empty() {
            pack(level, mask, &[Column::new(paths.time, &mut self.rays.time[at..])]);
        }
        if !self.width.is_empty() {
            let columns =
                [Column::new(paths.width, &mut self.width[at..]), Column::new(paths.spread, &mut self.spread[at..])];
            pack(level, mask, &columns);
        }
        self.rays.len += mask.count_ones() as usize;
    }
}

impl PathQueue {
    /// Appends a path that starts along a ray.
    pub fn start(&mut self, sample: u32, ray: &Ray, throughput: Vec3) {
        let to = self.rays.len;
        for axis in 0..3 {
            self.rays.origin[axis][to] = ray.origin[axis];
            self.rays.direction[axis][to] = ray.direction[axis] as f32;
            self.throughput[axis][to] = throughput[axis];
        }
        (self.rays.misses[to], self.sample[to], self.pdf[to]) = (ray.misses, sample, f32::INFINITY);
        if let (Some(scale), Some(flags)) = (self.scale.get_mut(to), self.flags.get_mut(to)) {
            (*scale, *flags) = (1.0, 0);
        }
        if let Some(time) = self.rays.time.get_mut(to) {
            *time = ray.time;
        }
        self.rays.len += 1;
    }

    /// The throughput of a path.
    #[inline]
    pub fn throughput_of(&self, path: usize) -> Rgb {
        Rgb::from_array(self.throughput.each_ref().map(|column| column[path].into()))
    }

    /// Where a path was scattered last.
    #[inline]
    pub fn vertex(&self, path: usize) -> DVec3 {
        let [x, y, z] = &self.vertex;
        if x.is_empty() { self.rays.origin(path) } else { DVec3::new(x[path], y[path], z[path]) }
    }

    /// All paths are where they were scattered last.
    pub fn set_vertices(&mut self) {
        let len = self.rays.len;
        for (to, from) in self.vertex.iter_mut().zip(&self.rays.origin) {
            to[..len].copy_from_slice(&from[..len]);
        }
    }

    /// A path has come to the end of a ray from an origin, with these weights, by its flight. Returns the density of
    /// the path for each color, relative to their mean. The density of its direction becomes that of the flight too,
    /// over what it is where light is drawn in place of the flight.
    #[inline]
    pub fn arrive(&mut self, path: usize, origin: DVec3, weights: &Weights) -> Rgb {
        let (drawn, throughput) = (weights.drawn.mean(), weights.throughput());
        for axis in 0..3 {
            self.rays.origin[axis][path] = origin[axis];
            self.throughput[axis][path] = throughput[axis] as f32;
        }
        self.pdf[path] *= (drawn / weights.asked.mean()) as f32;
        weights.drawn / drawn
    }
}

impl ShadowQueue {
    /// Room for so many rays.
    pub fn with_room(most: usize, extra: Extra) -> Self {
        let (room, rays) = (most + LANES, PathRays::with_room(most, false));
        let rays = if extra.time { rays.with_times() } else { rays };
        let of_media = if extra.media { room } else { 0 };
        let (media, ratio) = (vec![0; of_media], vec![0.0; of_media]);
        Self { rays, arriving: three(room), sample: vec![0; room], media, ratio }
    }

    #[cold]
    fn grow(&mut self, room: usize) {
        self.rays.make_room(room);
        self.arriving.iter_mut().chain([&mut self.ratio]).for_each(|column| lengthen(column, room));
        lengthen(&mut self.sample, room);
        lengthen(&mut self.media, room);
    }

    /// Appends a ray or segment of a sample in some media, whose light is 1. `ratio` is the density of scattering over
    /// that of light sampling.
    pub fn push_ray(&mut self, ray: &Ray, sample: u32, media: u32, ratio: f32) {
        let to = self.rays.len;
        if self.sample.len() < to + LANES {
            self.grow(2 * (to + LANES));
        }
        let length = ray.direction.length();
        for axis in 0..3 {
            self.rays.origin[axis][to] = ray.origin[axis];
            self.rays.direction[axis][to] = (ray.direction[axis] / length) as f32;
            self.arriving[axis][to] = 1.0;
        }
        let t_max = if ray.t_max == f64::INFINITY { f64::INFINITY } else { PathRays::END * length };
        (self.rays.t_max[to], self.rays.misses[to], self.sample[to]) = (t_max, ray.misses, sample);
        if let (Some(of), Some(to)) = (self.media.get_mut(to), self.ratio.get_mut(to)) {
            (*of, *to) = (media, ratio);
        }
        if let Some(time) = self.rays.time.get_mut(to) {
            *time = ray.time;
        }
        self.rays.len += 1;
    }

    /// Appends the rays of the lanes in a mask.
    #[inline]
    pub fn push(&mut self, level: Level, mask: u32, shadows: &ShadowLanes<'_>) {
        let at = self.rays.len;
        if self.sample.len() < at + LANES {
            self.grow(2 * (at + LANES));
        }
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
        if !self.media.is_empty() {
            let columns =
                [Column::new(shadows.media, &mut self.media[at..]), Column::new(shadows.ratio, &mut self.ratio[at..])];
            pack(level, mask, &columns);
        }
        if !self.rays.time.is_empty() {
            pack(level, mask, &[Column::new(shadows.time, &mut self.rays.time[at..])]);
        }
        self.rays.len += mask.count_ones() as usize;
    }
}
