//! Test scenes and ray fans that exercise all kernels, shared by the tests of this crate and of the Python interface.

use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Ray, Vec3};
use raywright_base::sampling::philox4x32;

/// A triangle soup with f32 or f64 leaves.
pub struct Soup {
    /// The corners of each triangle.
    pub triangles: Vec<[Vec3; 3]>,
    /// True if leaves store f32.
    pub is_single: bool,
}

impl Primitives for Soup {
    fn count(&self) -> usize {
        self.triangles.len()
    }
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.triangles[primitive as usize].map(Vec3::as_dvec3)
    }
    fn is_single(&self) -> bool {
        self.is_single
    }
}

/// The `i`-th of a sequence of points in [−1, 1]³.
fn triple(i: u32) -> DVec3 {
    let [x, y, z, _] = philox4x32([i, 0, 0, 0], [7, 7]).map(|bits| f64::from(bits) / f64::from(1u32 << 31) - 1.0);
    DVec3::new(x, y, z)
}

/// Triangles of all sizes, and a few planes through them so that rays hit edges and tie.
pub fn soup() -> Vec<[Vec3; 3]> {
    let corner = |i: u32, size: f64| (triple(i) + size * triple(i + 10_000)).as_vec3();
    let mut all: Vec<_> = (0..1000)
        .map(|i| {
            let size = 0.3 * triple(i + 20_000).x.powi(4);
            [0, 1, 2].map(|k| (triple(i) + size * triple(3 * i + k + 30_000)).as_vec3())
        })
        .collect();
    all.extend((0..20).map(|i| [corner(i, 0.5), corner(i, 0.5), corner(i + 1, 0.5)]));
    for (x, y) in (-8..8).flat_map(|x| (-8..8).map(move |y| (x as f32 / 8.0, y as f32 / 8.0))) {
        let [a, b, c, d] =
            [(0.0, 0.0), (0.125, 0.0), (0.125, 0.125), (0.0, 0.125)].map(|(u, v)| Vec3::new(x + u, y + v, 0.25));
        all.extend([[a, b, c], [a, c, d], [a, c, d]]);
    }
    all
}

/// Fans of neighboring rays: through the pixels of near and distant cameras, parallel to the axes, and with gaps of
/// invalid rays.
pub fn fans() -> Vec<Vec<Ray>> {
    let mut fans = Vec::new();
    for camera in 0..12 {
        let distance = [0.0, 0.5, 3.0, 7.0, 100.0, 1e6][camera as usize % 6];
        let eye = triple(camera + 50_000).normalize() * distance;
        let at = 0.3 * triple(camera + 60_000);
        let spread = if distance > 0.0 { 1.0 / distance } else { 0.7 };
        let fan = (0..640u32).map(|i| {
            let (x, y) = (f64::from(i % 40) / 20.0 - 1.0, f64::from(i / 40) / 8.0 - 1.0);
            let forward = (at - eye).normalize();
            let side = forward.any_orthonormal_vector();
            let direction = forward + spread * (x * side + y * forward.cross(side));
            if i % 53 == 7 { Ray::new(eye, DVec3::NAN) } else { Ray::new(eye, direction * 10f64.powi(i as i32 % 5)) }
        });
        fans.push(fan.collect());
    }
    for axis in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(1.0, 1.0, 0.0)] {
        let side = axis.normalize().any_orthonormal_vector();
        let up = axis.normalize().cross(side);
        let grid = (0..640u32).map(|i| {
            let (x, y) = (f64::from(i % 32) / 16.0 - 1.0, f64::from(i / 32) / 16.0 - 0.5);
            let mut ray = Ray::new(-3.0 * axis + side * x + up * y, axis);
            ray.t_max = if i % 3 == 0 { f64::INFINITY } else { 3.25 };
            ray
        });
        fans.push(grid.collect());
    }
    fans
}

/// Long thin triangles along rotated axes, and in planes normal to these.
pub fn sticks() -> Vec<[Vec3; 3]> {
    let x = DVec3::new(0.48, 0.64, 0.6);
    let axes = [x, x.any_orthonormal_vector(), x.cross(x.any_orthonormal_vector())];
    let stick = |i: u32| {
        let (from, way) = (triple(i), i as usize % 3);
        [from, from + axes[way], from + 0.02 * axes[(way + 1) % 3]].map(DVec3::as_vec3)
    };
    (0..600).map(stick).collect()
}

/// Layers of squares, each square halved along one diagonal and again along the other. Rays hit pairs of triangles at
/// the same `t`, and more of them where layers of different directions cross.
fn touching() -> Vec<[Vec3; 3]> {
    let mut all = Vec::new();
    for k in 0..18 {
        let (axis, z) = (k % 3, (k / 3) as f32 / 8.0 - 0.3);
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i as f32 / 2.0 - 1.0, j as f32 / 2.0 - 1.0))) {
            let [a, b, c, d] = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5)].map(|(u, v)| {
                let mut corner = [z; 3];
                (corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (i + u, j + v);
                Vec3::from_array(corner)
            });
            all.extend([[a, b, c], [a, c, d], [b, c, d], [d, a, b]]);
        }
    }
    all
}

/// Soups of all sizes: many triangles, so few that one leaf holds all, large ones, a part of the planes, and
/// touching layers.
pub fn soups() -> Vec<Vec<[Vec3; 3]>> {
    let all = soup();
    let large = |i: u32| [0, 1, 2].map(|k| (1.2 * triple(3 * i + k + 70_000)).as_vec3());
    let few: Vec<_> = (0..12).map(large).collect();
    vec![all.clone(), few[..1].to_vec(), few, all[all.len() - 64..].to_vec(), touching()]
}
