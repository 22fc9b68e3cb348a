//! Subdivision of faces into patches.

/// A subdivision of a scene's primitives into patches. A triangle is cut by lines parallel to its sides into n² similar
/// triangles; other shapes stay whole. The patch of a hit depends only on its coordinates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patches {
    /// Number of strips of each primitive.
    cuts: Vec<u32>,
    /// First patch of each primitive, and the total number at the end.
    first: Vec<u32>,
}

/// A patch of a triangle: its corners as barycentric coordinates of the triangle's second and third corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Primitive number.
    pub primitive: u32,
    /// Corners in the triangle's order; inner patches are rotated by 180 degrees.
    pub corners: [[f64; 2]; 3],
}

impl Cell {
    /// Maps barycentric coordinates of the patch to those of the triangle.
    #[inline]
    pub fn at(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.corners;
        [0, 1].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]))
    }
}

impl Patches {
    /// Maximum number of patches.
    const MOST: u64 = 1 << 30;

    /// Cuts each primitive into a number of strips, at least one.
    ///
    /// # Errors
    /// If there are more than 2³⁰ patches in total.
    pub fn new(cuts: Vec<u32>) -> Result<Self, String> {
        let mut first = vec![0];
        let mut count = 0u64;
        for &cut in &cuts {
            count += u64::from(cut.max(1)).pow(2);
            if count > Self::MOST {
                return Err("the scene has more than 2^30 patches: give a larger patch_size".into());
            }
            first.push(count as u32);
        }
        Ok(Self { cuts, first })
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.first[self.cuts.len()] as usize
    }

    /// Number of primitives.
    pub fn primitives(&self) -> usize {
        self.cuts.len()
    }

    /// The patch at a point of a primitive, and the barycentric coordinates within it.
    #[inline]
    pub fn find(&self, primitive: u32, [u, v]: [f64; 2]) -> (u32, [f64; 2]) {
        let (n, first) = (self.cuts[primitive as usize], self.first[primitive as usize]);
        if n <= 1 {
            return (first, [u, v]);
        }
        // Rounding may move a point on the border slightly beyond it.
        let (x, y) = (u * f64::from(n), v * f64::from(n));
        let i = (x as u32).min(n - 1);
        let j = (y as u32).min(n - 1 - i);
        let (a, b) = (x - f64::from(i), y - f64::from(j));
        let is_turned = a + b > 1.0 && i + j + 2 <= n;
        // A strip with k upright patches has k − 1 rotated ones between them, so 2 n i − i² patches precede strip i.
        let patch = first + 2 * n * i - i * i + 2 * j + u32::from(is_turned);
        (patch, if is_turned { [1.0 - a, 1.0 - b] } else { [a, b] })
    }

    /// Geometry of a patch within its primitive.
    pub fn cell(&self, patch: u32) -> Cell {
        let primitive = self.first.partition_point(|&first| first <= patch) - 1;
        let (n, k) = (u64::from(self.cuts[primitive].max(1)), u64::from(patch - self.first[primitive]));
        // From strip i on there are (n − i)² patches.
        let left = n * n - k;
        let root = left.isqrt();
        let i = n - if root * root < left { root + 1 } else { root };
        let within = k - (2 * n * i - i * i);
        let (j, is_turned) = (within / 2, within % 2 == 1);
        let corner = |x: u64, y: u64| [x as f64 / n as f64, y as f64 / n as f64];
        let corners = if is_turned {
            [corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j)]
        } else {
            [corner(i, j), corner(i + 1, j), corner(i, j + 1)]
        };
        Cell { primitive: primitive as u32, corners }
    }

    /// Area of a patch relative to its primitive.
    pub fn share(&self, primitive: u32) -> f64 {
        1.0 / f64::from(self.cuts[primitive as usize].max(1)).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::{Sampler, warp};

    #[test]
    fn each_patch_is_found_at_its_own_points() {
        let patches = Patches::new(vec![1, 3, 2, 7, 1]).unwrap();
        assert_eq!((patches.count(), patches.primitives()), (1 + 9 + 4 + 49 + 1, 5));
        for patch in 0..patches.count() as u32 {
            let cell = patches.cell(patch);
            for draw in 0..20 {
                let place = warp::uniform_triangle(Sampler::new(1, patch, draw).two(0));
                let (found, within) = patches.find(cell.primitive, cell.at(place));
                assert_eq!(found, patch);
                assert!((0..2).all(|k| (within[k] - place[k]).abs() < 1e-12), "{within:?} is not {place:?}");
            }
        }
    }

    #[test]
    fn patches_of_a_face_have_equal_areas_and_its_winding() {
        let patches = Patches::new(vec![5]).unwrap();
        for patch in 0..25 {
            let [a, b, c] = patches.cell(patch).corners;
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!((twice - patches.share(0)).abs() < 1e-15);
        }
    }

    #[test]
    fn borders_belong_to_some_patch() {
        let patches = Patches::new(vec![1, 4]).unwrap();
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.25, 0.75], [1.0 + 1e-16, -0.0], [0.3, 0.7]] {
            let (patch, within) = patches.find(1, uv);
            assert!((1..17).contains(&patch) && within.iter().all(|w| (-1e-9..=1.0 + 1e-9).contains(w)));
        }
        assert!(Patches::new(vec![1 << 15, 1]).unwrap_err().contains("patch_size"));
    }
}
