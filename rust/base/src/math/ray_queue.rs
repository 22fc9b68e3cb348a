//! A queue of rays in SoA layout.

use super::{Numbers, Ray, RayColumns, Vectors};

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
    fn rays_come_out_as_they_went_in() {
        let mut queue = RayQueue::default();
        let mut wanted: Vec<Ray> = (0..40).map(ray).collect();
        wanted.iter().for_each(|ray| queue.push(ray));
        queue.set_t_min(2, 0.25);
        wanted[2].t_min = 0.25;
        assert_eq!(queue.rows(), wanted);
        let columns = RayBatch::Columns(queue.columns());
        assert_eq!((queue.len(), columns.len(), queue.is_empty()), (wanted.len(), wanted.len(), false));
        for (i, &ray) in wanted.iter().enumerate() {
            assert_eq!((queue.get(i), columns.get(i)), (ray, Ray { time: 0.0, ..ray }));
            assert!(columns.misses(i, ray.misses[1]) && !columns.misses(i, ray.misses[1] + 1));
        }
        queue.clear();
        assert!(queue.is_empty() && queue.rows().is_empty());
    }
}
