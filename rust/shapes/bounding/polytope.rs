//! A convex body by its faces, cut by planes: for the surface and the volume of what several slabs leave.

use crate::math::DVec3;

/// Faces, each a ring of corners about a normal that points outwards.
#[derive(Clone, Debug)]
pub struct Polytope {
    faces: Vec<(DVec3, Vec<DVec3>)>,
}

impl Polytope {
    /// A box.
    pub fn from_box(min: DVec3, max: DVec3) -> Self {
        let mut faces = Vec::with_capacity(6);
        for axis in 0..3 {
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            for (at, sign) in [(min, -1.0), (max, 1.0)] {
                let mut normal = DVec3::ZERO;
                normal[axis] = sign;
                let corner = |[u, v]: [bool; 2]| {
                    let mut p = at;
                    p[j] = if u { max[j] } else { min[j] };
                    p[k] = if v { max[k] } else { min[k] };
                    p
                };
                let ring = [[false, false], [true, false], [true, true], [false, true]].map(corner);
                faces.push((normal, ring.to_vec()));
            }
        }
        Self { faces }
    }

    /// Keeps what lies at `normal · p ≤ height`.
    pub fn clip(&mut self, normal: DVec3, height: f64) {
        let mut cut: Vec<DVec3> = Vec::new();
        let beyond = |p: DVec3| normal.dot(p) - height;
        if !self.faces.iter().flat_map(|f| &f.1).any(|&p| beyond(p) > 0.0) {
            return;
        }
        for (_, ring) in &mut self.faces {
            let mut kept = Vec::with_capacity(ring.len() + 1);
            for i in 0..ring.len() {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                let (x, y) = (beyond(a), beyond(b));
                if x <= 0.0 {
                    kept.push(a);
                }
                if (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0) {
                    let p = a + (b - a) * (x / (x - y));
                    kept.push(p);
                    cut.push(p);
                } else if x == 0.0 {
                    cut.push(a);
                }
            }
            *ring = kept;
        }
        self.faces.retain(|f| f.1.len() > 2);
        // The new face: the cut's points, in order about their middle.
        if cut.len() > 2 {
            let middle = cut.iter().sum::<DVec3>() / cut.len() as f64;
            let unit = normal.normalize();
            let (x, y) = unit.any_orthonormal_pair();
            let angle = |p: &DVec3| y.dot(*p - middle).atan2(x.dot(*p - middle));
            cut.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            self.faces.push((unit, cut));
        }
    }

    fn areas(&self) -> impl Iterator<Item = (DVec3, DVec3, f64)> {
        self.faces.iter().map(|(normal, ring)| {
            let first = ring[0];
            let doubled: DVec3 = ring.windows(2).map(|w| (w[0] - first).cross(w[1] - first)).sum();
            (*normal, first, 0.5 * doubled.length())
        })
    }

    /// Half of its surface.
    pub fn half_area(&self) -> f64 {
        0.5 * self.areas().map(|(.., area)| area).sum::<f64>()
    }

    /// Its volume.
    pub fn volume(&self) -> f64 {
        let Some((_, ring)) = self.faces.first() else { return 0.0 };
        // A corner's own faces add nothing.
        let apex = ring[0];
        self.areas().map(|(normal, corner, area)| area * normal.dot(corner - apex) / 3.0).sum::<f64>().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_cut_to_an_octahedron() {
        let mut body = Polytope::from_box(DVec3::NEG_ONE, DVec3::ONE);
        assert_eq!((body.half_area(), body.volume()), (12.0, 8.0));
        for i in 0..8 {
            let sign = |bit: i32| if i & bit == 0 { 1.0 } else { -1.0 };
            body.clip(DVec3::new(sign(1), sign(2), sign(4)), 1.0);
        }
        assert!((body.half_area() - 2.0 * 3f64.sqrt()).abs() < 1e-12);
        assert!((body.volume() - 4.0 / 3.0).abs() < 1e-12);
        let mut corner = Polytope::from_box(DVec3::ZERO, DVec3::ONE);
        corner.clip(DVec3::ONE, 1.0);
        assert!((corner.volume() - 1.0 / 6.0).abs() < 1e-15);
        assert!((corner.half_area() - (1.5 + 0.75f64.sqrt()) / 2.0).abs() < 1e-15);
        corner.clip(DVec3::ONE, -1.0);
        assert_eq!((corner.volume(), corner.half_area()), (0.0, 0.0));
    }
}
