//! Rounding of a mesh's vertices to f32, and a test for loss.

use super::Vertices;
use raywright_base::math::{DVec3, Vec3};

/// Precision of stored vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// f32 if that changes no vertex of any mesh, f64 otherwise.
    #[default]
    Auto,
    /// f32.
    Single,
    /// f64.
    Double,
}

impl Precision {
    /// Returns whether vertices stay f64, given the rounding of one mesh.
    pub fn is_double(self, rounding: Rounding) -> bool {
        match self {
            Self::Auto => rounding.moved > 0.0,
            Self::Single => false,
            Self::Double => true,
        }
    }
}

/// Effect of rounding a mesh's vertices to f32; zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// Greatest change of a vertex coordinate; infinite if it overflows f32.
    pub moved: f64,
    /// Longest side of the bounds of the vertices as given.
    pub extent: f64,
}

impl Rounding {
    /// Relative change above which storing a mesh as f32 causes a warning. f32 rounds by 2⁻²⁵ to 2⁻²⁴ of a number. That
    /// is 6e-8 of the extent of a mesh that reaches the origin, and more than this bound if the mesh is two or three of
    /// its extents away.
    pub const MOST: f64 = 1e-7;

    /// Returns whether the change deserves a warning.
    pub fn is_loss(self) -> bool {
        self.share() > Self::MOST
    }

    /// Greatest change over the extent.
    pub fn share(self) -> f64 {
        if self.moved == 0.0 { 0.0 } else { self.moved / self.extent }
    }

    /// The greater of two relative changes.
    pub fn worst(self, other: Self) -> Self {
        // The relative change may underflow to zero.
        if (other.share(), other.moved) > (self.share(), self.moved) { other } else { self }
    }
}

/// Rounds vertices to f32 and measures the change of those that are finite and in use. Unused vertices do not affect
/// the extent.
///
/// # Panics
/// If a face names a vertex that does not exist.
pub fn rounded(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> (Vertices, Rounding) {
    let mut is_used = vec![false; vertices.len()];
    for &v in faces.as_flattened() {
        is_used[v as usize] = true;
    }
    let (mut moved, mut min, mut max) = (DVec3::ZERO, DVec3::INFINITY, DVec3::NEG_INFINITY);
    let one = |(&given, &is_used): (&[f64; 3], &bool)| {
        let given = DVec3::from_array(given);
        let single: Vec3 = given.as_vec3();
        if is_used && given.is_finite() {
            moved = moved.max((single.as_dvec3() - given).abs());
            (min, max) = (min.min(given), max.max(given));
        }
        single
    };
    let single: Vec<_> = vertices.iter().zip(&is_used).map(one).collect();
    // Without vertices the extent is negative infinity, and with the largest numbers it overflows.
    let extent = (max - min).max_element().clamp(0.0, f64::MAX);
    (Vertices::Single(single), Rounding { moved: moved.max_element(), extent })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACE: [[u32; 3]; 1] = [[0, 1, 2]];

    /// A triangle of this extent with f32 corners, except one that is displaced by `by`.
    fn off(extent: f64, by: f64) -> Rounding {
        rounded(&[[0.0; 3], [extent, 0.0, 0.0], [0.5, 1.0 + by, 0.0]], &FACE).1
    }

    #[test]
    fn the_bound_is_met_from_both_sides() {
        // A corner at 4 that is displaced by half the f32 step there, 2⁻²², in a mesh of an extent about 2⁻²² / 1e-7.
        let step = f64::from(f32::EPSILON) * 4.0;
        for (factor, is_loss) in [(1.0 + 1e-12, false), (1.0 - 1e-12, true)] {
            let far = 4.0 + step / 2.0;
            let near = far - step / 2.0 / Rounding::MOST * factor;
            let rounding = rounded(&[[far, 0.0, 0.0], [near, 0.0, 0.0], [3.0, 1.0, 0.0]], &FACE).1;
            assert_eq!((rounding.moved, rounding.is_loss()), (step / 2.0, is_loss));
            assert!(Precision::Auto.is_double(rounding));
            assert!(Precision::Double.is_double(rounding) && !Precision::Single.is_double(rounding));
        }
    }

    #[test]
    fn the_most_that_a_corner_moves_is_told() {
        let ulp = f64::from(f32::EPSILON);
        assert_eq!(off(4.0, ulp / 2.0), Rounding { moved: ulp / 2.0, extent: 4.0 });
        assert_eq!(off(4.0, ulp / 4.0).moved, ulp / 4.0);
        assert_eq!(off(4.0, ulp), Rounding { moved: 0.0, extent: 4.0 });
        assert!(!Precision::Auto.is_double(off(4.0, ulp)) && Precision::Auto.is_double(off(4.0, ulp / 4.0)));
        // Not even if the mesh is so large that the relative change underflows.
        let tiny = Rounding { moved: f64::from_bits(1), extent: 1e300 };
        assert!(Precision::Auto.is_double(Rounding::default().worst(tiny)));
    }

    #[test]
    fn what_is_rounded_is_what_is_told() {
        let given = [[0.1, 1e30, -0.3], [1.0 / 3.0, 5e29, 7.7], [1e-50, -2.5e28, 0.0]];
        let (vertices, rounding) = rounded(&given, &FACE);
        let mut moved = 0.0f64;
        for (i, given) in given.iter().enumerate() {
            let kept = vertices.get(i as u32);
            assert_eq!(kept, DVec3::from_array(given.map(|x| f64::from(x as f32))));
            moved = moved.max((kept - DVec3::from_array(*given)).abs().max_element());
        }
        assert_eq!(rounding, Rounding { moved, extent: 1e30 + 2.5e28 });
    }

    #[test]
    fn what_is_not_used_or_not_finite_does_not_count() {
        let mesh = [[1e7 + 0.1, 0.0, 0.0], [1e7 + 1.0, 0.0, 0.0], [1e7, 1.0, 0.0]];
        let alone = rounded(&mesh, &FACE).1;
        assert!(alone.is_loss() && (alone.moved - 0.1).abs() < 1e-8 && alone.extent == 1.0);
        for stray in [[0.0; 3], [0.1, 2e9, 0.0], [f64::NAN, 0.0, 0.0]] {
            let with = [mesh[0], mesh[1], mesh[2], stray];
            assert_eq!(rounded(&with, &FACE).1, alone);
        }
        let broken = [mesh[0], mesh[1], mesh[2], [f64::INFINITY, 0.0, f64::NAN]];
        assert_eq!(rounded(&broken, &[[0, 1, 2], [0, 1, 3]]).1, alone);
    }

    #[test]
    fn nothing_and_the_largest_and_least_numbers() {
        assert_eq!(rounded(&[], &[]).1, Rounding::default());
        assert!(!Rounding::default().is_loss() && Rounding::default().share() == 0.0);
        // The coordinate overflows f32.
        let huge = rounded(&[[-1.7e308, 0.0, 0.0], [1.7e308, 0.0, 0.0], [0.0, 1.0, 0.0]], &FACE).1;
        assert!(huge.is_loss() && huge.share() == f64::INFINITY);
        // The coordinate underflows f32.
        let tiny = rounded(&[[0.0; 3], [1e-60, 0.0, 0.0], [0.0, 1e-60, 0.0]], &FACE).1;
        assert_eq!((tiny.is_loss(), tiny.share()), (true, 1.0));
        // A point has no extent to compare with.
        let point = rounded(&[[0.1; 3]; 3], &FACE).1;
        assert!(point.is_loss() && point.share() == f64::INFINITY);
        assert!(!rounded(&[[0.5; 3]; 3], &FACE).1.is_loss());
    }

    #[test]
    fn the_worst_is_that_of_the_greatest_share() {
        let [small, large] = [Rounding { moved: 1e-3, extent: 1.0 }, Rounding { moved: 1.0, extent: 1e6 }];
        assert_eq!((small.worst(large), large.worst(small)), (small, small));
        assert_eq!(Rounding::default().worst(large), large);
    }
}
