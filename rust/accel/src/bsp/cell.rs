//! Convex cells of a BSP tree, whose surface area is proportional to the probability of a ray hitting them.

use super::plane::BspPlane;
use raywright_base::math::{Aabb, DVec3};

/// A convex polyhedron, given by its faces. It is used only for expected costs, which tolerate rounding.
#[derive(Clone, Debug)]
pub struct BspCell {
    faces: Vec<Vec<DVec3>>,
    /// The area times the normal of each face, in either orientation.
    areas: Vec<DVec3>,
}

impl BspCell {
    /// A box.
    pub fn new(aabb: &Aabb) -> Self {
        let corners = [aabb.min.as_dvec3(), aabb.max.as_dvec3()];
        let face = |k: usize| {
            let (axis, side) = (k / 2, k % 2);
            let turn = [[0, 0], [0, 1], [1, 1], [1, 0]].map(|[u, v]| {
                let mut corner = corners[side];
                corner[(axis + 1) % 3] = corners[u][(axis + 1) % 3];
                corner[(axis + 2) % 3] = corners[v][(axis + 2) % 3];
                corner
            });
            turn.to_vec()
        };
        Self::of((0..6).map(face).collect())
    }

    fn of(faces: Vec<Vec<DVec3>>) -> Self {
        let areas = faces.iter().map(|face| area(face)).collect();
        Self { faces, areas }
    }

    /// The surface area.
    pub fn area(&self) -> f64 {
        self.areas.iter().map(|area| area.length()).sum()
    }

    /// The least and the greatest height over a plane.
    pub fn range(&self, plane: &BspPlane) -> [f64; 2] {
        let ranges = self.faces.iter().map(|face| plane.range(face));
        ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [least, greatest]| [a.min(least), b.max(greatest)])
    }

    /// Estimate the surface area on either side of a plane. The cell is modeled as a prism normal to the plane, as
    /// wide as the cell's projection: each side has two ends, and its fraction of the lateral surface.
    ///
    /// None if the cell extends less than `least` on a side.
    pub fn guessed_areas(&self, plane: &BspPlane, least: f64) -> Option<[f64; 2]> {
        let [lowest, highest] = self.range(plane);
        let back = -lowest / (highest - lowest);
        // Every ray along the normal that hits the cell crosses its surface twice.
        let ends: f64 =
            self.areas.iter().map(|area| plane.normal.dot(*area).abs()).sum::<f64>() / plane.normal.length();
        let around = (self.area() - ends).max(0.0);
        (lowest < -least && highest > least).then(|| [back, 1.0 - back].map(|share| ends + share * around))
    }

    /// The parts behind and in front of a plane.
    pub fn halved(&self, plane: &BspPlane) -> [Self; 2] {
        let mut cuts = Vec::new();
        let mut halves = [Vec::with_capacity(self.faces.len() + 1), Vec::with_capacity(self.faces.len() + 1)];
        for face in &self.faces {
            for (half, face) in halves.iter_mut().zip(plane.cut(face, &mut cuts)) {
                if face.len() >= 3 {
                    half.push(face);
                }
            }
        }
        let cap = around(cuts, plane.normal);
        halves.map(|mut faces| {
            if cap.len() >= 3 {
                faces.push(cap.clone());
            }
            Self::of(faces)
        })
    }
}

/// The area of a convex outline times its normal.
fn area(outline: &[DVec3]) -> DVec3 {
    let Some(&first) = outline.first() else { return DVec3::ZERO };
    let twice: DVec3 = outline.windows(2).map(|p| (p[0] - first).cross(p[1] - first)).sum();
    0.5 * twice
}

/// Sort the points of a convex outline by angle about a direction.
fn around(mut points: Vec<DVec3>, normal: DVec3) -> Vec<DVec3> {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let u = normal.any_orthogonal_vector();
    let v = normal.cross(u);
    let turn = |p: &DVec3| f64::atan2(v.dot(p - middle), u.dot(p - middle) * normal.length());
    points.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    points.dedup();
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::Vec3;

    fn cube() -> BspCell {
        BspCell::new(&Aabb { min: Vec3::ZERO, max: Vec3::ONE })
    }

    #[test]
    fn a_cube_has_six_squares_and_its_halves_five_sixths_of_them_together_with_two_cuts() {
        assert_eq!(cube().area(), 6.0);
        let halves = cube().halved(&BspPlane::across(1, 0.25));
        assert_eq!(halves.each_ref().map(BspCell::area), [3.0, 5.0]);
        let [back, front] = cube().halved(&BspPlane::across(2, -0.5));
        assert_eq!((back.area(), front.area()), (0.0, 6.0));
    }

    #[test]
    fn a_corner_is_a_tetrahedron_and_the_rest_has_what_it_lacks() {
        let plane = BspPlane::through(DVec3::new(0.5, 0.0, 0.0), DVec3::ONE).unwrap();
        let [corner, rest] = cube().halved(&plane);
        let (legs, cut) = (3.0 / 8.0, 3f64.sqrt() / 8.0);
        assert!((corner.area() - (legs + cut)).abs() < 1e-15);
        assert!((rest.area() - (6.0 - legs + cut)).abs() < 1e-14);
    }

    #[test]
    fn through_the_middle_across_the_diagonal_the_cut_is_a_hexagon() {
        let plane = BspPlane::through(DVec3::splat(0.5), DVec3::ONE).unwrap();
        let hexagon = 0.75 * 3f64.sqrt();
        for half in cube().halved(&plane) {
            assert!((half.area() - (3.0 + hexagon)).abs() < 1e-14);
        }
    }

    #[test]
    fn halves_of_a_prism_are_guessed_right() {
        let plane = BspPlane::across(1, 0.25);
        let halves = cube().halved(&plane);
        assert_eq!(cube().guessed_areas(&plane, 0.0), Some(halves.each_ref().map(BspCell::area)));
        assert_eq!(cube().guessed_areas(&plane, 0.3), None);
    }

    #[test]
    fn a_plane_through_corners_counts_them_once() {
        let plane = BspPlane::through(DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0)).unwrap();
        for half in cube().halved(&plane) {
            assert!((half.area() - (3.0 + 2f64.sqrt())).abs() < 1e-14);
        }
    }
}
