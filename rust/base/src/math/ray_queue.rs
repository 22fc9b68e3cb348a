//! A queue of rays in SoA layout.

use super::{DVec3, LANES, Numbers, Ray, RayColumns, VectorLanes, Vectors};

/// A queue of rays in SoA layout, in f64, since rays that leave a surface must not be rounded.
#[derive(Clone, Debug, Default)]
pub struct RayQueue {
    origin: [Vec<f64>; 3],
    direction: [Vec<f64>; 3],
    t_min: Vec<f64>,
    t_max: Vec<f64>,
    time: Vec<f64>,
    misses: Vec<[u32; 2]>,
    /// Scratch space for the same rays in row layout; its content is that of the last call.
    rows: Vec<Ray>,
}

/// Rays to be queued, one per lane, with a `t_min` of 0.
#[derive(Clone, Debug)]
pub struct RayLanes {
    /// The origins.
    pub origin: VectorLanes,
    /// The directions.
    pub direction: VectorLanes,
    /// The greatest `t`.
    pub t_max: [f64; LANES],
    /// The times.
    pub time: [f64; LANES],
    /// Triangles that they are known to miss.
    pub misses: [[u32; 2]; LANES],
}

/// The selected lanes, in order.
struct QueuedRay {
    lanes: [u8; LANES],
    count: usize,
}

impl QueuedRay {
    #[inline(always)]
    fn of(mask: u32) -> Self {
        let (mut lanes, mut count) = ([0; LANES], 0);
        for lane in 0..LANES {
            lanes[count & (LANES - 1)] = lane as u8;
            count += (mask >> lane & 1) as usize;
        }
        Self { lanes, count }
    }

    /// Append the values of the selected lanes.
    #[inline(always)]
    fn append<T: Copy>(&self, column: &mut Vec<T>, all: &[T; LANES]) {
        if self.count == LANES {
            return column.extend_from_slice(all);
        }
        let mut picked = *all;
        for (picked, lane) in picked.iter_mut().zip(self.lanes) {
            *picked = all[usize::from(lane) & (LANES - 1)];
        }
        column.extend_from_slice(&picked[..self.count]);
    }
}

impl RayQueue {
    /// The number of rays.
    #[inline]
    pub fn len(&self) -> usize {
        self.t_max.len()
    }

    /// Return whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.t_max.is_empty()
    }

    /// Remove all rays.
    #[inline]
    pub fn clear(&mut self) {
        self.origin.iter_mut().chain(&mut self.direction).for_each(Vec::clear);
        [&mut self.t_min, &mut self.t_max, &mut self.time].into_iter().for_each(Vec::clear);
        self.misses.clear();
    }

    /// Adds a ray.
    #[inline]
    pub fn push(&mut self, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis].push(ray.origin[axis]);
            self.direction[axis].push(ray.direction[axis]);
        }
        self.t_min.push(ray.t_min);
        self.t_max.push(ray.t_max);
        self.time.push(ray.time);
        self.misses.push(ray.misses);
    }

    /// Add the rays of the lanes in a mask.
    #[inline]
    pub fn push_lanes(&mut self, rays: &RayLanes, mask: u32) {
        let chosen = QueuedRay::of(mask);
        for (columns, lanes) in [(&mut self.origin, &rays.origin), (&mut self.direction, &rays.direction)] {
            for (column, lanes) in columns.iter_mut().zip(lanes.by_axis()) {
                chosen.append(column, lanes);
            }
        }
        chosen.append(&mut self.t_min, &[0.0; LANES]);
        chosen.append(&mut self.t_max, &rays.t_max);
        chosen.append(&mut self.time, &rays.time);
        chosen.append(&mut self.misses, &rays.misses);
    }

    /// Gather sixteen rays.
    ///
    /// # Panics
    ///
    /// If an index is out of range.
    #[inline]
    pub fn gather(&self, which: &[u32; LANES], rays: &mut [Ray; LANES]) {
        // Equal lengths are established here once, which avoids bounds checks per lane.
        let count = self.len();
        let [ox, oy, oz] = self.origin.each_ref().map(|column| &column[..count]);
        let [dx, dy, dz] = self.direction.each_ref().map(|column| &column[..count]);
        let [t_min, t_max, time] = [&self.t_min[..count], &self.t_max[..count], &self.time[..count]];
        let misses = &self.misses[..count];
        for lane in 0..LANES {
            let i = which[lane] as usize;
            assert!(i < count, "a ray that is there");
            rays[lane] = Ray {
                origin: DVec3::new(ox[i], oy[i], oz[i]),
                direction: DVec3::new(dx[i], dy[i], dz[i]),
                t_min: t_min[i],
                t_max: t_max[i],
                time: time[i],
                misses: misses[i],
            };
        }
    }

    /// One of the rays.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        let at = |columns: &[Vec<f64>; 3]| [columns[0][i], columns[1][i], columns[2][i]].into();
        Ray {
            origin: at(&self.origin),
            direction: at(&self.direction),
            t_min: self.t_min[i],
            t_max: self.t_max[i],
            time: self.time[i],
            misses: self.misses[i],
        }
    }

    /// Change the `t_min` of a ray.
    pub fn set_t_min(&mut self, i: usize, t_min: f64) {
        self.t_min[i] = t_min;
    }

    /// All rays as columns, for static scenes.
    pub fn columns(&self) -> RayColumns<'_> {
        let [origin, direction] = [&self.origin, &self.direction].map(|columns| {
            let [x, y, z] = columns;
            Vectors::Double([x, y, z])
        });
        RayColumns::new(origin, direction, Numbers::Each(&self.t_min), Numbers::Each(&self.t_max)).missing(&self.misses)
    }

    /// All rays as rows.
    pub fn rows(&mut self) -> &[Ray] {
        let mut rows = std::mem::take(&mut self.rows);
        rows.clear();
        rows.extend((0..self.len()).map(|i| self.get(i)));
        self.rows = rows;
        &self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DVec3, RayBatch};

    fn ray(i: u32) -> Ray {
        let x = f64::from(i);
        let ray = Ray::new(DVec3::new(x, -x, 0.5 * x), DVec3::new(1.0, x, 3.0 - x));
        Ray { t_max: x + 1.0, time: 0.01 * x, misses: [i, i + 1], ..ray }
    }

    #[test]
    fn rays_come_out_as_they_went_in_one_by_one_and_by_lanes() {
        let mut queue = RayQueue::default();
        let mut wanted = Vec::new();
        for (start, mask) in [(0, 0xffff), (16, 0), (32, 0b1010_0000_0000_0001), (48, 0x7ffe), (64, 0xffff)] {
            queue.push(&ray(1000 + start));
            wanted.push(ray(1000 + start));
            let mut lanes = RayLanes {
                origin: VectorLanes::ZERO,
                direction: VectorLanes::ZERO,
                t_max: [0.0; LANES],
                time: [0.0; LANES],
                misses: [[0; 2]; LANES],
            };
            for lane in 0..LANES {
                let ray = ray(start + lane as u32);
                lanes.origin.set(lane, ray.origin);
                lanes.direction.set(lane, ray.direction);
                (lanes.t_max[lane], lanes.time[lane], lanes.misses[lane]) = (ray.t_max, ray.time, ray.misses);
                if mask >> lane & 1 == 1 {
                    wanted.push(ray);
                }
            }
            queue.push_lanes(&lanes, mask);
        }
        queue.set_t_min(2, 0.25);
        wanted[2].t_min = 0.25;
        assert_eq!(queue.rows(), wanted);
        let columns = RayBatch::Columns(queue.columns());
        assert_eq!((queue.len(), columns.len(), queue.is_empty()), (wanted.len(), wanted.len(), false));
        for (i, &ray) in wanted.iter().enumerate() {
            let mut gathered = [Ray::new(DVec3::ZERO, DVec3::X); LANES];
            queue.gather(&[i as u32; LANES], &mut gathered);
            assert_eq!(gathered, [ray; LANES]);
            assert_eq!((queue.get(i), columns.get(i)), (ray, Ray { time: 0.0, ..ray }));
            assert!(columns.misses(i, ray.misses[1]) && !columns.misses(i, ray.misses[1] + 1));
        }
        queue.clear();
        assert!(queue.is_empty() && queue.rows().is_empty());
    }
}
