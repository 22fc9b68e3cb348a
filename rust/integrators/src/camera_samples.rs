//! Samples of pixels, as a camera has taken them.

use raywright_base::math::{LANES, Ray};
use raywright_base::sampling::{Sampler, SamplerColumns, SamplerLanes};
use raywright_base::simd::{Column, Level, pack};
use raywright_scene::CameraRayLanes;

/// One sample of one pixel: the ray that the camera sends, and the numbers for what follows.
#[derive(Clone, Debug)]
pub struct CameraSample {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// Its numbers; the camera has used the first [`raywright_base::sampling::CAMERA_DIMENSIONS`].
    pub sampler: Sampler,
}

/// Samples of one picture, by columns. Each has room for sixteen more than there are samples.
#[derive(Debug, Default)]
pub struct CameraSamples {
    /// Number of samples.
    pub len: usize,
    /// Origins of their rays, by axis.
    pub origin: [Vec<f64>; 3],
    /// Unit directions, by axis.
    pub direction: [Vec<f64>; 3],
    /// When each sees the scene, from 0 to 1 while the shutter is open.
    pub time: Vec<f64>,
    /// Their numbers; none before there is a sample.
    pub samplers: Option<SamplerColumns>,
}

impl CameraSamples {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.len = 0;
        if let Some(samplers) = &mut self.samplers {
            samplers.clear();
        }
    }

    /// Appends those of the lanes in a mask; `number` is the number of each among the samples of its pixel.
    pub fn push(
        &mut self,
        level: Level,
        mask: u32,
        rays: &CameraRayLanes,
        samplers: &SamplerLanes,
        number: &[u32; LANES],
    ) {
        let (at, room) = (self.len, self.len + LANES);
        for column in self.origin.iter_mut().chain(&mut self.direction).chain([&mut self.time]) {
            if column.len() < room {
                column.resize(2 * room, 0.0);
            }
        }
        let ([ox, oy, oz], [dx, dy, dz]) = (&mut self.origin, &mut self.direction);
        let ([from_ox, from_oy, from_oz], [from_dx, from_dy, from_dz]) =
            (rays.origin().by_axis(), rays.direction().by_axis());
        let columns = [
            Column::new(from_ox, &mut ox[at..]),
            Column::new(from_oy, &mut oy[at..]),
            Column::new(from_oz, &mut oz[at..]),
            Column::new(from_dx, &mut dx[at..]),
            Column::new(from_dy, &mut dy[at..]),
            Column::new(from_dz, &mut dz[at..]),
            Column::new(rays.time(), &mut self.time[at..]),
        ];
        pack(level, mask, &columns);
        self.samplers.get_or_insert_with(|| SamplerColumns::like(samplers)).push(level, mask, samplers, number);
        self.len += (mask & 0xffff).count_ones() as usize;
    }

    /// Samples that stand one after the other.
    pub fn of(rows: &[CameraSample]) -> Self {
        let mut all = Self { len: rows.len(), ..Self::default() };
        for CameraSample { ray, .. } in rows {
            for axis in 0..3 {
                all.origin[axis].push(ray.origin[axis]);
                all.direction[axis].push(ray.direction[axis]);
            }
            all.time.push(ray.time);
        }
        all.samplers = rows.first().map(|first| {
            let mut samplers = SamplerColumns::new(&first.sampler);
            samplers.take(rows.iter().map(|sample| &sample.sampler));
            samplers
        });
        all
    }

    /// The same one after the other.
    pub fn rows(&self, rows: &mut Vec<CameraSample>) {
        rows.clear();
        let Some(samplers) = &self.samplers else { return };
        rows.extend((0..self.len).map(|i| {
            let [origin, direction] =
                [&self.origin, &self.direction].map(|columns| [columns[0][i], columns[1][i], columns[2][i]].into());
            CameraSample { ray: Ray { time: self.time[i], ..Ray::new(origin, direction) }, sampler: samplers.get(i) }
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::{BatchSize, SamplerKind};
    use raywright_scene::{Camera, Perspective};

    #[test]
    fn rows_are_what_was_pushed_and_become_the_same_columns() {
        let camera =
            Perspective::looking_at([0.0; 3].into(), [0.0, 0.0, -1.0].into(), [0.0, 1.0, 0.0].into(), 60.0, 8, 8);
        let camera = camera.expect("a camera");
        for kind in [SamplerKind::Independent, SamplerKind::Sobol(BatchSize::new(16).unwrap())] {
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let mut samples = CameraSamples::default();
                let mut wanted = Vec::new();
                for (turn, mask) in [(0, 0xffff), (1, 0x8421), (2, 0), (3, 0x7ffe)] {
                    let pixel = std::array::from_fn(|lane| 16 * turn + lane as u32);
                    let number = std::array::from_fn(|lane| 5 * lane as u32 + turn);
                    let samplers = SamplerLanes::of(kind, level, 9, &pixel, &number);
                    let film =
                        [[0; 2]; 2].map(|_: [u32; 2]| std::array::from_fn(|lane| 0.4 * lane as f64 + f64::from(turn)));
                    let mut rays = CameraRayLanes::NONE;
                    camera.rays(level, &film, &[[0.5; LANES]; 2], &[0.25; LANES], &mut rays);
                    samples.push(level, mask, &rays, &samplers, &number);
                    for lane in (0..LANES).filter(|lane| mask >> lane & 1 == 1) {
                        let ray = camera.ray([film[0][lane], film[1][lane]], [0.5; 2], 0.25).ray;
                        wanted.push((ray, kind.sampler(9, pixel[lane], number[lane])));
                    }
                }
                let mut rows = Vec::new();
                samples.rows(&mut rows);
                assert_eq!(rows.len(), wanted.len());
                let mut again = Vec::new();
                CameraSamples::of(&rows).rows(&mut again);
                for ((row, same), (ray, sampler)) in rows.iter_mut().zip(&mut again).zip(&mut wanted) {
                    assert_eq!((row.ray, same.ray), (*ray, *ray));
                    let numbers = (sampler.one(4), sampler.two(5), sampler.number(), sampler.pixel());
                    for row in [row, same] {
                        let got = (row.sampler.one(4), row.sampler.two(5), row.sampler.number(), row.sampler.pixel());
                        assert_eq!(got, numbers, "{kind:?} {level:?}");
                    }
                }
            }
        }
    }
}
