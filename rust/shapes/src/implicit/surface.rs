//! The area of an implicit surface, and sampling by area.
//!
//! With the unit normal n, the parts n_k² of an area element dA sum to dA (a partition of unity). Projected along axis
//! k, dA covers |n_k| dA. So the area is the sum over the axes of the integral of |n_k| over all axis-parallel lines
//! and their intersections (in the manner of Cauchy and Crofton). The integrand is bounded, and zero where a line is
//! tangent, so a plain grid of lines suffices. The lines form a lattice that is aligned with no border (Roberts's
//! sequence), refined until two successive results agree.
//!
//! Sampling follows the same scheme. A line is chosen uniformly, then one of as many slots as any line has roots. The
//! point in that slot is accepted with probability |n_k|; otherwise all is sampled again. The density by area is then
//! the sum of |n_k| · |n_k|, a constant.

use super::{Implicit, line::Along, roots::roots};
use crate::Contact;
use raywright_base::math::{DVec3, Interval};
use raywright_base::parallel;
use raywright_base::sampling::philox4x32;

/// Columns per side, and the initial number of lines per side.
const COLUMNS: usize = 64;

/// The area is accepted when four times as many lines change it by less than this fraction.
const ACCURACY: f64 = 1e-3;

/// The lattice increments: the inverse of the plastic number, and its square.
const LATTICE: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// Lines per parallel task.
const CHUNK: usize = 256;

/// Maximum refinement of lines per side.
const FINEST: usize = 4;

/// Maximum number of rejections per sample.
const TRIES: u32 = 1 << 16;

/// Data about the whole surface.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its area.
    pub area: f64,
    /// The columns along each axis that may contain surface.
    columns: [Vec<[usize; 2]>; 3],
    /// Cumulative fractions of the columns' area by axis.
    shares: [f64; 3],
    /// The maximum number of roots on a line.
    most: usize,
}

impl Surface {
    /// Measure a surface in parallel.
    pub fn new(shape: &Implicit) -> Self {
        let columns = occupied(shape);
        let faces = faces(shape);
        let (area, most) = measured(shape, &columns, &|_| 1.0);
        let all: [f64; 3] = std::array::from_fn(|k| columns[k].len() as f64 * faces[k]);
        let sum: f64 = all.iter().sum();
        let shares = [all[0] / sum, (all[0] + all[1]) / sum, 1.0];
        Self { area, columns, shares, most }
    }

    /// Integrate a function of the unit normal over the surface.
    pub fn integral(&self, shape: &Implicit, of: &(dyn Fn(DVec3) -> f64 + Sync)) -> f64 {
        measured(shape, &self.columns, of).0
    }

    /// Sample a point uniformly by area, with its unit normal. The two numbers seed the rejection sampling.
    pub fn sample(&self, shape: &Implicit, u: [f64; 2]) -> Option<DVec3> {
        if self.area <= 0.0 || !self.area.is_finite() {
            return None;
        }
        let [a, b] = u.map(f64::to_bits);
        for attempt in 0..TRIES {
            let words = philox4x32([attempt, 0, b as u32, (b >> 32) as u32], [a as u32, (a >> 32) as u32]);
            let [choice, x, y, slot] = words.map(|w| (f64::from(w) + 0.5) * 2f64.powi(-32));
            let axis = self.shares.iter().position(|&s| choice < s).unwrap_or(2);
            let before = if axis > 0 { self.shares[axis - 1] } else { 0.0 };
            let count = self.columns[axis].len();
            let index = (choice - before) / (self.shares[axis] - before) * count as f64;
            let Some(&column) = self.columns[axis].get(index as usize) else { continue };
            let slot = slot * self.most as f64;
            let met = shape.meet_column(axis, column, [x, y]);
            if let Some((position, normal)) = met.get(slot as usize)
                && slot.fract() < normal[axis].abs()
            {
                return Some(*position);
            }
        }
        None
    }
}

/// The area of the box's faces normal to each axis.
fn faces(shape: &Implicit) -> [f64; 3] {
    let size = shape.bounds.max - shape.bounds.min;
    [0, 1, 2].map(|k| size[(k + 1) % 3] * size[(k + 2) % 3])
}

/// Integrate a function of the normal, refined until it is stable. Return the maximum number of roots on a line, too.
fn measured(shape: &Implicit, columns: &[Vec<[usize; 2]>; 3], of: &(dyn Fn(DVec3) -> f64 + Sync)) -> (f64, usize) {
    let (mut fine, mut found) = (1, lattice(shape, columns, of, 1));
    while fine < FINEST {
        fine *= 2;
        let (sum, most) = lattice(shape, columns, of, fine);
        let change = (sum - found.0).abs();
        found = (sum, most.max(found.1));
        if change <= ACCURACY * sum.abs() {
            break;
        }
    }
    found
}

/// The same by one lattice of lines.
fn lattice(
    shape: &Implicit,
    columns: &[Vec<[usize; 2]>; 3],
    of: &(dyn Fn(DVec3) -> f64 + Sync),
    fine: usize,
) -> (f64, usize) {
    let (mut integral, mut most, count, faces) = (0.0, 0, (COLUMNS * fine).pow(2), faces(shape));
    for axis in 0..3 {
        let mut held = vec![false; COLUMNS * COLUMNS];
        columns[axis].iter().for_each(|&[i, j]| held[i * COLUMNS + j] = true);
        let part = |chunk: usize| {
            let (mut sum, mut most) = (0.0, 0);
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                let at = LATTICE.map(|step| (0.5 + step * (i as f64 + 1.0)).fract() * COLUMNS as f64);
                let column = at.map(|x| x as usize);
                if held[column[0] * COLUMNS + column[1]] {
                    let met = shape.meet_column(axis, column, at.map(f64::fract));
                    sum += met.iter().map(|(_, normal)| normal[axis].abs() * of(*normal)).sum::<f64>();
                    most = most.max(met.len());
                }
            }
            (sum, most)
        };
        // Summed in order, so that the result does not depend on the number of threads.
        let parts: Vec<(f64, usize)> = parallel::map(count.div_ceil(CHUNK), part);
        integral += parts.iter().map(|p| p.0).sum::<f64>() * faces[axis] / count as f64;
        most = parts.iter().map(|p| p.1).fold(most, usize::max);
    }
    (integral, most)
}

/// The columns along each axis that may contain surface. The box is bisected along its longest side, and cells
/// certainly off the surface are discarded.
fn occupied(shape: &Implicit) -> [Vec<[usize; 2]>; 3] {
    let mut cells = vec![([0usize; 3], [0u32; 3])];
    let size = shape.bounds.max - shape.bounds.min;
    let mut work = Vec::new();
    for _ in 0..18 {
        let depth = cells.first().map_or([0; 3], |c| c.1);
        let side = |k: usize| if depth[k] < 6 { size[k] / f64::from(1u32 << depth[k]) } else { 0.0 };
        let axis = (0..3).fold(0, |best, k| if side(k) > side(best) { k } else { best });
        let mut next = Vec::with_capacity(2 * cells.len());
        for (mut place, mut depth) in cells {
            depth[axis] += 1;
            place[axis] *= 2;
            for _ in 0..2 {
                let held = std::array::from_fn(|k| {
                    let at = |i: usize| shape.bounds.min[k] + size[k] * (i as f64 / f64::from(1u32 << depth[k]));
                    // Padded by some ulps, since the lines' coordinates are rounded differently.
                    let room = 4.0 * f64::EPSILON * shape.extent;
                    Interval::new(at(place[k]) - room, at(place[k] + 1) + room)
                });
                let value: Interval = shape.tape.value(&held, &mut work);
                if value.contains(0.0) {
                    next.push((place, depth));
                }
                place[axis] += 1;
            }
        }
        cells = next;
    }
    std::array::from_fn(|k| {
        let mut all: Vec<[usize; 2]> = cells.iter().map(|(p, _)| [p[(k + 1) % 3], p[(k + 2) % 3]]).collect();
        all.sort_unstable();
        all.dedup();
        all
    })
}

impl Implicit {
    /// The intersections on an axis-parallel line through a column, with their unit normals. `part` gives the line's
    /// position within the column.
    fn meet_column(&self, axis: usize, column: [usize; 2], part: [f64; 2]) -> Vec<(DVec3, DVec3)> {
        let (min, size) = (self.bounds.min, self.bounds.max - self.bounds.min);
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut start = min;
        for (k, (column, part)) in [(i, (column[0], part[0])), (j, (column[1], part[1]))] {
            start[k] = (min[k] + size[k] * ((column as f64 + part) / COLUMNS as f64)).min(self.bounds.max[k]);
        }
        let mut along = Along::new(&self.tape, start.to_array().map(Interval::point), DVec3::AXES[axis]);
        let span = Interval::new(0.0, size[axis]);
        let mut found = Vec::new();
        roots(&mut along, span, span, self.shortest(), &mut |root| {
            if root.contact != Contact::Touching {
                let mut position = start;
                position[axis] = (start[axis] + root.place).min(self.bounds.max[axis]);
                if let Some(normal) = self.gradient(position).0.try_normalize() {
                    found.push((position, normal));
                }
            }
            false
        });
        found
    }
}
