//! Rays and hits in SoA layout: any sixteen neighbors form vectors.

use super::{DVec3, Ray};

/// Three coordinates of each ray, by axis, in their original precision.
#[derive(Clone, Copy, Debug)]
pub enum Vectors<'a> {
    /// f32.
    Single([&'a [f32]; 3]),
    /// f64.
    Double([&'a [f64]; 3]),
}

/// One number per ray.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// The same number for all rays.
    One(f64),
    /// One number each.
    Each(&'a [f64]),
}

/// Rays in SoA layout, all columns of the same length; [`Ray`] explains the fields. They have no time, so they are for
/// static scenes.
#[derive(Clone, Copy, Debug)]
pub struct RayColumns<'a> {
    origin: Vectors<'a>,
    direction: Vectors<'a>,
    t_min: Numbers<'a>,
    t_max: Numbers<'a>,
    /// None if no triangles are known to be missed.
    misses: Option<&'a [[u32; 2]]>,
}

/// Rays in the layout of the caller.
#[derive(Clone, Copy, Debug)]
pub enum RayBatch<'a> {
    /// Array of structures.
    Rows(&'a [Ray]),
    /// Structure of arrays.
    Columns(RayColumns<'a>),
}

/// The output for closest hits in SoA layout, all columns of the same length; [`super::Hit`] explains the fields.
#[derive(Debug)]
pub struct HitColumns<'a> {
    /// Distance in lengths of the ray's direction; infinite for a miss.
    pub t: &'a mut [f64],
    /// Weights of the triangle's second and third corner.
    pub uv: &'a mut [[f64; 2]],
    /// Index among all primitives of the scene; −1 for a miss.
    pub primitive: &'a mut [i32],
}

/// The output for closest hits of runs of four rays, each with a place of its own in longer columns.
#[derive(Debug)]
pub struct PlacedHits<'a> {
    /// See [`HitColumns`].
    pub t: &'a mut [f64],
    /// See [`HitColumns`].
    pub uv: &'a mut [[f64; 2]],
    /// See [`HitColumns`].
    pub primitive: &'a mut [i32],
    /// The shape in a scene of one, if it is wanted: 0, or −1 for a miss.
    pub shape: Option<&'a mut [i32]>,
    /// The place of the first ray of each run.
    pub places: &'a [usize],
}

impl PlacedHits<'_> {
    /// Rays per run.
    pub const RUN: usize = 4;

    /// Store one hit, or a miss, whose primitive is −1.
    #[inline(always)]
    pub fn put(&mut self, i: usize, t: f64, uv: [f64; 2], primitive: i32) {
        let place = self.places[i / Self::RUN] + i % Self::RUN;
        (self.t[place], self.uv[place], self.primitive[place]) = (t, uv, primitive);
        if let Some(shape) = &mut self.shape {
            shape[place] = primitive >> 31;
        }
    }

    /// Store a run.
    #[inline(always)]
    pub fn put_run(&mut self, run: usize, t: &[f64; 4], uv: &[[f64; 2]; 4], primitive: &[i32; 4]) {
        let place = self.places[run];
        self.t[place..][..Self::RUN].copy_from_slice(t);
        self.uv[place..][..Self::RUN].copy_from_slice(uv);
        self.primitive[place..][..Self::RUN].copy_from_slice(primitive);
        if let Some(shape) = &mut self.shape {
            shape[place..][..Self::RUN].copy_from_slice(&primitive.map(|number| number >> 31));
        }
    }
}

impl Vectors<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        match self {
            Self::Single([x, ..]) => x.len(),
            Self::Double([x, ..]) => x.len(),
        }
    }

    fn are_columns_alike(&self) -> bool {
        match self {
            Self::Single([x, y, z]) => x.len() == y.len() && y.len() == z.len(),
            Self::Double([x, y, z]) => x.len() == y.len() && y.len() == z.len(),
        }
    }

    #[inline(always)]
    fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::Single([x, y, z]) => DVec3::new(x[i].into(), y[i].into(), z[i].into()),
            Self::Double([x, y, z]) => DVec3::new(x[i], y[i], z[i]),
        }
    }

    /// Read up to K vectors as f64, by axis. The last one fills missing places.
    #[inline(always)]
    pub fn read<const K: usize>(&self, from: usize, to: &mut [[f64; K]; 3]) {
        for axis in 0..3 {
            match self {
                Self::Single(columns) => read_column(columns[axis], from, &mut to[axis]),
                Self::Double(columns) => read_column(columns[axis], from, &mut to[axis]),
            }
        }
    }
}

impl Numbers<'_> {
    #[inline(always)]
    fn get(&self, i: usize) -> f64 {
        match self {
            Self::One(number) => *number,
            Self::Each(numbers) => numbers[i],
        }
    }

    /// Read up to K numbers. The last one fills missing places.
    #[inline(always)]
    pub fn read<const K: usize>(&self, from: usize, to: &mut [f64; K]) {
        match self {
            Self::One(number) => *to = [*number; K],
            Self::Each(numbers) => read_column(numbers, from, to),
        }
    }
}

/// Read up to K numbers of a column. The last one fills missing places.
#[inline(always)]
pub fn read_column<const K: usize, T: Copy + Into<U>, U>(column: &[T], from: usize, to: &mut [U; K]) {
    let rest = &column[from..];
    if let Some(some) = rest.first_chunk::<K>() {
        for i in 0..K {
            to[i] = some[i].into();
        }
    } else {
        for i in 0..K {
            to[i] = rest[if i < rest.len() { i } else { rest.len() - 1 }].into();
        }
    }
}

impl<'a> RayColumns<'a> {
    /// Create rays from columns.
    ///
    /// # Panics
    ///
    /// If the columns differ in length.
    pub fn new(origin: Vectors<'a>, direction: Vectors<'a>, t_min: Numbers<'a>, t_max: Numbers<'a>) -> Self {
        assert!(origin.are_columns_alike() && direction.are_columns_alike(), "three columns of one length");
        let count = origin.len();
        assert_eq!(direction.len(), count, "a direction for each origin");
        for numbers in [t_min, t_max] {
            assert!(!matches!(numbers, Numbers::Each(each) if each.len() != count), "a number for each ray");
        }
        Self { origin, direction, t_min, t_max, misses: None }
    }

    /// Add two triangles that each ray is known to miss.
    ///
    /// # Panics
    ///
    /// If the column differs in length.
    pub fn missing(self, misses: &'a [[u32; 2]]) -> Self {
        assert_eq!(misses.len(), self.len(), "two triangles for each ray");
        Self { misses: Some(misses), ..self }
    }

    /// The number of rays.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.origin.len()
    }

    /// Return whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Origin, direction, `t_min` and `t_max`.
    #[inline(always)]
    pub fn parts(&self) -> (&Vectors<'a>, &Vectors<'a>, &Numbers<'a>, &Numbers<'a>) {
        (&self.origin, &self.direction, &self.t_min, &self.t_max)
    }

    /// One of the rays.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        let (t_min, t_max) = (self.t_min.get(i), self.t_max.get(i));
        let misses = self.misses.map_or([Ray::NO_TRIANGLE; 2], |misses| misses[i]);
        Ray { t_min, t_max, misses, ..Ray::new(self.origin.get(i), self.direction.get(i)) }
    }
}

impl RayBatch<'_> {
    /// The number of rays.
    #[inline(always)]
    pub fn len(&self) -> usize {
        match self {
            Self::Rows(rays) => rays.len(),
            Self::Columns(columns) => columns.len(),
        }
    }

    /// Return whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Return whether a ray is known to miss a triangle.
    #[inline(always)]
    pub fn misses(&self, i: usize, triangle: u32) -> bool {
        match self {
            Self::Rows(rays) => rays[i].misses.contains(&triangle),
            Self::Columns(columns) => columns.misses.is_some_and(|misses| misses[i].contains(&triangle)),
        }
    }

    /// One of the rays.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        match self {
            Self::Rows(rays) => rays[i],
            Self::Columns(columns) => columns.get(i),
        }
    }
}

impl HitColumns<'_> {
    /// The number of hits that fit.
    ///
    /// # Panics
    ///
    /// If the columns differ in length.
    #[inline(always)]
    pub fn len(&self) -> usize {
        let count = self.t.len();
        assert!(self.uv.len() == count && self.primitive.len() == count, "columns of one length");
        count
    }

    /// Return whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_are_read_from_anywhere_and_the_last_stands_for_what_is_missing() {
        let numbers: Vec<f64> = (0..40).map(f64::from).collect();
        let single: Vec<f32> = (0..40).map(|i| i as f32 / 3.0).collect();
        for (count, from) in [(40, 0), (40, 7), (40, 24), (40, 30), (1, 0), (5, 3)] {
            let (numbers, single) = (&numbers[..count], &single[..count]);
            let (doubles, singles) = (Vectors::Double([numbers; 3]), Vectors::Single([single; 3]));
            let rays = RayColumns::new(singles, doubles, Numbers::One(0.5), Numbers::Each(numbers));
            let (mut o, mut d, mut near, mut far) = ([[0.0; 16]; 3], [[0.0; 16]; 3], [0.0; 16], [0.0; 16]);
            singles.read(from, &mut o);
            doubles.read(from, &mut d);
            rays.t_min.read(from, &mut near);
            rays.t_max.read(from, &mut far);
            for i in 0..16 {
                let ray = rays.get((from + i).min(count - 1));
                assert_eq!(ray.origin, DVec3::new(o[0][i], o[1][i], o[2][i]));
                assert_eq!(ray.direction, DVec3::new(d[0][i], d[1][i], d[2][i]));
                assert_eq!((ray.t_min, ray.t_max, ray.time), (near[i], far[i], 0.0));
            }
            assert_eq!((rays.len(), RayBatch::Columns(rays).len()), (count, count));
        }
    }

    #[test]
    #[should_panic(expected = "a direction for each origin")]
    fn columns_have_one_length() {
        let number = [0.0];
        let (two, one) = ([0.0; 2], Vectors::Double([&number; 3]));
        let _ = RayColumns::new(Vectors::Double([&two; 3]), one, Numbers::One(0.0), Numbers::One(1.0));
    }
}
