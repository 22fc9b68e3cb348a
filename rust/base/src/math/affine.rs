//! Affine maps of space.

use super::number::{Number, Triple};
use super::robust::{UNIT, normalising_scale};
use super::{DVec3, Double, Dyadic};
use std::cmp::Ordering;

/// A linear map and a translation: `p ↦ L p + s`, with the rows of `L` and its adjugate.
#[derive(Clone)]
pub struct Affine {
    /// The rows of the linear part.
    pub rows: [DVec3; 3],
    /// The image of the origin.
    pub shift: DVec3,
    /// The adjugate and the determinant of the linear part, scaled by the same power of two: the inverse is their
    /// quotient. The scaling prevents underflow.
    adjugate: ([Triple<Double>; 3], Double),
    /// One over that power of two's square root.
    scale: f64,
}

/// The reason why a map has no inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Singular {
    /// A number is infinite or NaN.
    NotFinite,
    /// The determinant is zero, exactly.
    ZeroDeterminant,
    /// The inverse overflows f64.
    OutOfRange,
    /// The condition number, and the maximum that is allowed.
    IllConditioned(f64, f64),
}

impl std::fmt::Display for Singular {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite => f.write_str("it has a non-finite number"),
            Self::ZeroDeterminant => f.write_str("its determinant is 0"),
            Self::OutOfRange => f.write_str("its inverse overflows float64"),
            Self::IllConditioned(condition, most) => {
                write!(f, "its condition number is {condition:.1e}, expected at most {most:.1e}")
            }
        }
    }
}

/// Shows rows and shift only.
impl std::fmt::Debug for Affine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Affine").field("rows", &self.rows).field("shift", &self.shift).finish()
    }
}

/// Maps are equal if their rows and shifts are.
impl PartialEq for Affine {
    fn eq(&self, other: &Self) -> bool {
        self.rows == other.rows && self.shift == other.shift
    }
}

impl Affine {
    /// The map with the given rows and shift.
    pub fn new(rows: [DVec3; 3], shift: DVec3) -> Self {
        let largest = rows.iter().map(|row| row.abs().max_element()).fold(0.0, f64::max);
        let (up, scale) = if largest.is_normal() { normalising_scale(largest) } else { (1.0, 1.0) };
        let scaled = rows.map(|row| {
            Triple(row.to_array().map(|x| {
                let y = x * up;
                // Subnormal results are rounded.
                Double { error: if y / up == x { 0.0 } else { f64::MIN_POSITIVE }, ..Double::of(y) }
            }))
        });
        let (adjugate, determinant) = adjugate(scaled);
        Self { rows, shift, adjugate: (adjugate, determinant.times(&Double::of(scale))), scale }
    }

    /// The map of a matrix that acts on columns (x, y, z, 1), given without its last row (0, 0, 0, 1).
    pub fn from_matrix(matrix: [[f64; 4]; 3]) -> Self {
        Self::new(matrix.map(|[x, y, z, _]| DVec3::new(x, y, z)), DVec3::from_array(matrix.map(|row| row[3])))
    }

    /// A translation.
    pub fn translation(shift: DVec3) -> Self {
        Self::new([DVec3::X, DVec3::Y, DVec3::Z], shift)
    }

    /// A scaling along the axes.
    pub fn scale(by: DVec3) -> Self {
        Self::new([DVec3::X * by.x, DVec3::Y * by.y, DVec3::Z * by.z], DVec3::ZERO)
    }

    /// The composition: `first`, then this map. Each number is rounded once from double-double.
    pub fn compose(&self, first: &Self) -> Self {
        let columns: [Triple<Double>; 3] =
            [0, 1, 2].map(|i| Triple::of(DVec3::from_array(first.rows.map(|row| row[i]))));
        let rows = self.rows.map(|row| {
            let row = Triple::of(row);
            DVec3::from_array(std::array::from_fn(|i| row.dot(&columns[i]).high))
        });
        Self::new(rows, self.point(first.shift))
    }

    /// The inverse, each of its numbers within an ulp of the exact inverse's.
    ///
    /// # Errors
    ///
    /// If the map is singular, decided exactly, or f64 cannot hold its inverse.
    pub fn inverse(&self) -> Result<Self, Singular> {
        if !(self.rows.iter().all(|row| row.is_finite()) && self.shift.is_finite()) {
            return Err(Singular::NotFinite);
        }
        let inverse = self.inverse_in::<Double>();
        let inverse = match inverse {
            Some(found) => Some(found),
            None => self.inverse_in::<Dyadic>(),
        };
        let (rows, shift) = inverse.ok_or(Singular::ZeroDeterminant)?;
        if rows.iter().all(|row| row.is_finite()) && shift.is_finite() {
            Ok(Self::new(rows, shift))
        } else {
            Err(Singular::OutOfRange)
        }
    }

    /// The inverse, if this number type is certain of each entry.
    fn inverse_in<N: Number>(&self) -> Option<([DVec3; 3], DVec3)> {
        let (rows, determinant) = self.adjugate_in::<N>();
        if determinant.sign()? == Ordering::Equal {
            return None;
        }
        let shift = Triple::of(self.shift);
        let quotient = |x: &N| x.over(&determinant).rounded();
        let mut result = ([DVec3::ZERO; 3], DVec3::ZERO);
        for i in 0..3 {
            for j in 0..3 {
                result.0[i][j] = quotient(&rows[i].0[j])?;
            }
            result.1[i] = quotient(&rows[i].dot(&shift).negated())?;
        }
        Some(result)
    }

    /// The rows of the adjugate, and the determinant, up to a common factor that makes the determinant positive. The
    /// inverse is their quotient.
    #[inline]
    pub fn adjugate_in<N: Number>(&self) -> ([Triple<N>; 3], N) {
        let (rows, determinant) = &self.adjugate;
        let known = |x: &Double| N::of_sum(x.high, x.low, x.error);
        let kept = || {
            let mut result: [Option<Triple<N>>; 3] = [const { None }; 3];
            for (to, Triple([x, y, z])) in result.iter_mut().zip(rows) {
                *to = Some(Triple([known(x)?, known(y)?, known(z)?]));
            }
            let [x, y, z] = result;
            Some(([x?, y?, z?], known(determinant)?))
        };
        let (rows, determinant) = kept().unwrap_or_else(|| adjugate(self.rows.map(Triple::of)));
        if determinant.seems_negative() {
            (rows.map(|Triple(row)| Triple(row.map(|x| x.negated()))), determinant.negated())
        } else {
            (rows, determinant)
        }
    }

    /// The approximate determinant of the linear part: the volume scale, negative if the map mirrors.
    pub fn determinant(&self) -> f64 {
        self.adjugate.1.high * self.scale * self.scale
    }

    /// Map a point, rounded once from double-double.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        let point = Triple::<Double>::of(p);
        DVec3::from_array(std::array::from_fn(|i| {
            Triple::of(self.rows[i]).dot(&point).plus(&Double::of(self.shift[i])).high
        }))
    }

    /// Map a vector.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.rows.map(|row| row.dot(v)))
    }

    /// Map an area vector along its normal: the cofactor matrix times a vector.
    pub fn cofactors(&self, v: DVec3) -> DVec3 {
        let [a, b, c] = self.adjugate.0.each_ref().map(|Triple(row)| DVec3::from_array(row.map(|x| x.high)));
        (a * v.x + b * v.y + c * v.z) * self.scale * self.scale
    }

    /// Map a normal: the result is orthogonal to the images of the tangents, and on the same side. Not normalized.
    pub fn normal(&self, n: DVec3) -> DVec3 {
        self.cofactors(n) * 1f64.copysign(self.adjugate.1.high)
    }

    /// The transpose of the linear part times a vector: `(Lᵀ d) · p = d · (L p)`.
    pub fn transposed(&self, d: DVec3) -> DVec3 {
        self.rows[0] * d.x + self.rows[1] * d.y + self.rows[2] * d.z
    }

    /// A bound, per coordinate, on the distance of the images of two points that differ by at most `error` per
    /// coordinate.
    pub fn spread(&self, error: f64) -> f64 {
        let most = self.rows.iter().map(|row| row.abs().element_sum()).fold(0.0, f64::max);
        most * error * (1.0 + 8.0 * UNIT)
    }

    /// The factor by which it scales all lengths, to within 2⁻⁴⁸; None if the scaling is not uniform.
    pub fn uniform_scale(&self) -> Option<f64> {
        let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.vector(axis));
        let square = columns[0].length_squared();
        let close = |x: f64, y: f64| (x - y).abs() <= square * 32.0 * UNIT;
        let even = (0..3)
            .all(|i| close(columns[i].length_squared(), square) && close(columns[i].dot(columns[(i + 1) % 3]), 0.0));
        even.then(|| self.determinant().abs().cbrt())
    }
}

fn adjugate<N: Number>([a, b, c]: [Triple<N>; 3]) -> ([Triple<N>; 3], N) {
    let columns = [b.cross(&c), c.cross(&a), a.cross(&b)];
    let determinant = a.dot(&columns[0]);
    let [x, y, z] = [0, 1, 2].map(|i| Triple(columns.each_ref().map(|column| column.0[i].clone())));
    ([x, y, z], determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(prop_oneof![-2.0..2.0f64, (-2i32..=2).prop_map(f64::from)]).prop_map(DVec3::from_array)
    }

    fn map() -> impl Strategy<Value = Affine> {
        (prop::array::uniform3(vector()), vector()).prop_map(|(rows, shift)| Affine::new(rows, shift))
    }

    proptest! {
        #[test]
        fn inverses_undo(map in map(), p in vector()) {
            let [a, b, c] = map.rows.map(Triple::<Dyadic>::of);
            let singular = a.dot(&b.cross(&c)).sign() == Some(Ordering::Equal);
            match map.inverse() {
                Err(why) => prop_assert!(singular && why == Singular::ZeroDeterminant),
                Ok(inverse) => {
                    prop_assert!(!singular);
                    // The effect on a point of an ulp in each number of the inverse.
                    let size = inverse.spread(map.point(p).abs().max_element()) + inverse.shift.abs().max_element();
                    prop_assert!((inverse.point(map.point(p)) - p).abs().max_element() <= 16.0 * UNIT * size);
                    prop_assert!((inverse.determinant() * map.determinant() - 1.0).abs() < 1e-9 || size > 1e3);
                }
            }
        }

        #[test]
        fn maps_compose_and_carry_normals(f in map(), g in map(), p in vector(), v in vector(), w in vector()) {
            let both = f.compose(&g);
            prop_assert!((both.point(p) - f.point(g.point(p))).length() < 1e-13);
            // Cofactors map cross products as the map does vectors.
            prop_assert!((f.cofactors(v.cross(w)) - f.vector(v).cross(f.vector(w))).length() < 1e-12);
            prop_assert!((f.transposed(v).dot(w) - v.dot(f.vector(w))).abs() < 1e-13);
            let n = v.cross(w);
            prop_assert!(f.normal(n).dot(f.vector(v)).abs() < 1e-12);
            prop_assert!(f.normal(n).dot(f.vector(n)) >= -1e-12);
        }
    }

    #[test]
    fn a_singular_map_is_known_however_nearly_it_is_not() {
        let rows = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.2, 0.4, 0.6), DVec3::Z];
        assert_eq!(Affine::new(rows, DVec3::ZERO).inverse(), Err(Singular::ZeroDeterminant));
        let mut nearly = rows;
        nearly[1].x = nearly[1].x.next_up();
        assert!(Affine::new(nearly, DVec3::ZERO).inverse().is_ok());
        assert_eq!(Affine::scale(DVec3::splat(f64::NAN)).inverse(), Err(Singular::NotFinite));
        assert_eq!(Affine::scale(DVec3::splat(f64::from_bits(1))).inverse(), Err(Singular::OutOfRange));
        let small = Affine::scale(DVec3::splat(1e-300)).inverse().unwrap();
        assert_eq!(small.vector(DVec3::X).x, 1.0 / 1e-300);
        assert_eq!(Affine::translation(DVec3::X).uniform_scale(), Some(1.0));
        assert_eq!(Affine::scale(DVec3::new(1.0, 1.0, 1.0 + 1e-9)).uniform_scale(), None);
    }
}
