//! A hashed grid for fixed-radius queries.

use raywright_base::math::DVec3;

/// Points sorted into cells of twice the radius, by cell and then by index, so that their order is the same for any
/// number of threads. A query ball overlaps at most eight cells (Teschner et al., "Optimized Spatial Hashing for
/// Collision Detection of Deformable Objects", 2003).
#[derive(Debug)]
pub struct HashedGrid {
    radius: f64,
    origin: DVec3,
    /// Start of each bucket in `points`, and the end of the last. A bucket has the points of one cell, or of several
    /// cells with equal hashes.
    starts: Vec<u32>,
    points: Vec<(DVec3, u32)>,
}

impl HashedGrid {
    /// Build the grid for query radii up to a positive radius. Points are numbered in their order.
    pub fn new(points: impl ExactSizeIterator<Item = DVec3> + Clone, radius: f64) -> Self {
        let buckets = points.len().next_power_of_two();
        let origin = points.clone().fold(DVec3::INFINITY, DVec3::min);
        let mut this = Self { radius, origin, starts: vec![0; buckets + 1], points: Vec::new() };
        let of: Vec<u32> = points.clone().map(|point| this.bucket(this.cell(point))).collect();
        for &bucket in &of {
            this.starts[bucket as usize + 1] += 1;
        }
        for bucket in 0..buckets {
            this.starts[bucket + 1] += this.starts[bucket];
        }
        let mut next = this.starts.clone();
        this.points.resize(points.len(), (DVec3::ZERO, 0));
        for ((number, point), &bucket) in (0u32..).zip(points).zip(&of) {
            let place = &mut next[bucket as usize];
            this.points[*place as usize] = (point, number);
            *place += 1;
        }
        this
    }

    /// Return the maximum query radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    fn cell(&self, point: DVec3) -> [i64; 3] {
        // Cells beyond the integer range share the last one.
        ((point - self.origin) / (2.0 * self.radius)).floor().to_array().map(|x| x as i64)
    }

    fn bucket(&self, cell: [i64; 3]) -> u32 {
        let mixed = cell.into_iter().zip([0x9e37_79b9_7f4a_7c15, 0xc2b2_ae3d_27d4_eb4f, 0x1656_67b1_9e37_79f9]);
        let hash = mixed.fold(0u64, |hash, (x, by): (i64, u64)| (hash ^ x as u64).wrapping_mul(by).rotate_left(31));
        // The number of buckets is a power of two; `starts` has one entry more.
        hash as u32 & (self.starts.len() as u32 - 2)
    }

    /// Call a function for each point within the radius, in a fixed order, with its index and squared distance.
    pub fn within(&self, place: DVec3, mut visit: impl FnMut(u32, f64)) {
        if self.points.is_empty() {
            return;
        }
        let (low, high) = (self.cell(place - self.radius), self.cell(place + self.radius));
        // Two cells a side, or three where rounding errors are as large as a cell.
        let mut seen = [0; 27];
        let mut count = 0;
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let bucket = self.bucket([x, y, z]);
                    if count == seen.len() || seen[..count].contains(&bucket) {
                        continue;
                    }
                    seen[count] = bucket;
                    count += 1;
                    let range = self.starts[bucket as usize]..self.starts[bucket as usize + 1];
                    for &(point, number) in &self.points[range.start as usize..range.end as usize] {
                        let squared = point.distance_squared(place);
                        if squared < self.radius * self.radius {
                            visit(number, squared);
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    fn points(count: u32, scale: f64, at: f64) -> Vec<DVec3> {
        let point = |i| {
            let mut sampler = Sampler::new(1, i, 0);
            DVec3::new(sampler.one(0), sampler.one(1), sampler.one(2)) * scale + at
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn all_within_are_found_once() {
        for (count, scale, at, radius) in [
            (0, 1.0, 0.0, 0.1),
            (1, 1.0, 0.0, 2.0),
            (500, 1.0, 0.0, 0.2),
            (500, 1e-6, 1e4, 3e-7),
            (300, 1e9, -1e9, 2e8),
        ] {
            let points = points(count, scale, at);
            let grid = HashedGrid::new(points.iter().copied(), radius);
            for place in points.iter().map(|p| *p + 0.3 * radius).chain([DVec3::splat(at - 10.0 * scale)]) {
                let (mut found, mut last) = (Vec::new(), None);
                grid.within(place, |number, squared| {
                    assert_eq!(squared, points[number as usize].distance_squared(place));
                    found.push(number);
                });
                let again = {
                    let mut again = Vec::new();
                    grid.within(place, |number, _| again.push(number));
                    again
                };
                assert_eq!(found, again);
                found.sort_unstable();
                for &number in &found {
                    assert!(last < Some(number), "found twice");
                    last = Some(number);
                }
                let near = |i: &u32| points[*i as usize].distance_squared(place) < radius * radius;
                assert_eq!(found, (0..count).filter(near).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn cells_of_no_size_still_end() {
        let points = points(100, 1e300, 0.0);
        let grid = HashedGrid::new(points.iter().copied(), 1e-300);
        let mut found = 0;
        grid.within(points[7], |_, _| found += 1);
        // The square of this radius underflows to 0, and no squared distance is below it.
        assert_eq!(found, 0);
    }
}
