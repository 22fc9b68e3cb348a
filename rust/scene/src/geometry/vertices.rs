//! Corners of triangles, in f32 or f64.

use raywright_base::math::{DVec3, Vec3};

/// Corners of triangles in their stored precision.
#[derive(Clone, Debug)]
pub enum Vertices {
    /// f32.
    Single(Vec<Vec3>),
    /// f64.
    Double(Vec<DVec3>),
}

impl Default for Vertices {
    fn default() -> Self {
        Self::Single(Vec::new())
    }
}

impl From<Vec<Vec3>> for Vertices {
    fn from(vertices: Vec<Vec3>) -> Self {
        Self::Single(vertices)
    }
}

impl FromIterator<Vec3> for Vertices {
    fn from_iter<I: IntoIterator<Item = Vec3>>(vertices: I) -> Self {
        Self::Single(vertices.into_iter().collect())
    }
}

impl Vertices {
    /// Number of vertices.
    pub fn len(&self) -> usize {
        match self {
            Self::Single(v) => v.len(),
            Self::Double(v) => v.len(),
        }
    }

    /// Returns whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A vertex in f64.
    #[inline]
    pub fn get(&self, i: u32) -> DVec3 {
        match self {
            Self::Single(v) => v[i as usize].as_dvec3(),
            Self::Double(v) => v[i as usize],
        }
    }

    /// Converts to f32 if that is lossless. It halves the memory, and hits stay exact.
    pub(super) fn shortened(self) -> Self {
        // NaN has no value to lose.
        let fits = |x: f64| f64::from(x as f32) == x || x.is_nan();
        match self {
            Self::Double(v) if v.iter().all(|p| p.to_array().into_iter().all(fits)) => {
                Self::Single(v.into_iter().map(|p| p.as_vec3()).collect())
            }
            other => other,
        }
    }

    /// Concatenates both; the result is f64 if either is.
    pub(super) fn joined(self, more: Self) -> Self {
        let widened = |v: Vec<Vec3>| v.into_iter().map(Vec3::as_dvec3);
        match (self, more) {
            (all, more) if more.is_empty() => all,
            (all, more) if all.is_empty() => more,
            (Self::Single(mut all), Self::Single(more)) => {
                all.extend(more);
                Self::Single(all)
            }
            (Self::Single(all), Self::Double(more)) => Self::Double(widened(all).chain(more).collect()),
            (Self::Double(mut all), more) => {
                match more {
                    Self::Single(more) => all.extend(widened(more)),
                    Self::Double(more) => all.extend(more),
                }
                Self::Double(all)
            }
        }
    }

    /// Frees unused capacity.
    pub(super) fn shrink_to_fit(&mut self) {
        match self {
            Self::Single(v) => v.shrink_to_fit(),
            Self::Double(v) => v.shrink_to_fit(),
        }
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Single(v) => v.capacity() * size_of::<Vec3>(),
            Self::Double(v) => v.capacity() * size_of::<DVec3>(),
        }
    }
}
