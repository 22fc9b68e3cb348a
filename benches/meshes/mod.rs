//! Meshes and rays of the benchmarks, the same on every run.
#![allow(dead_code, reason = "each bench takes what it needs")]

use raywright::accel::bvh::{self, Options};
use raywright::accel::{Accelerator, BruteForce, Primitives};
use raywright::math::{DVec3, Frame, Hit, Ray, Vec3};
use raywright::sampling::{philox4x32, warp};
use raywright::simd::Level;
use std::fmt;

/// Triangles by corners.
pub struct Triangles(pub Vec<[Vec3; 3]>);

impl Primitives for Triangles {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0[primitive as usize].map(Vec3::as_dvec3)
    }

    fn is_single(&self) -> bool {
        true
    }
}

/// The same triangles, for BVHs that store f64.
pub struct Doubles<'a>(pub &'a Triangles);

impl Primitives for Doubles<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0.corners(primitive)
    }

    fn is_single(&self) -> bool {
        false
    }
}

/// Return four numbers from 0 to 1 for an index and a purpose.
fn random(i: usize, purpose: u32) -> [f64; 4] {
    philox4x32([i as u32, (i >> 32) as u32, 0, 0], [purpose, 0]).map(|x| f64::from(x) / 2f64.powi(32))
}

/// A mesh with its camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mesh {
    /// The unit sphere in 81,920 triangles of about equal size, on a floor of two.
    Icosphere,
    /// A torus of about as many triangles, displaced by a tenth of its radius.
    NoisyTorus,
    /// A room of 3,000 slats, four hundred times as long as they are wide, seen from inside.
    Slats,
}

impl fmt::Display for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Icosphere => "icosphere",
            Self::NoisyTorus => "noisy torus",
            Self::Slats => "slats",
        })
    }
}

impl Mesh {
    /// All meshes.
    pub const ALL: [Self; 3] = [Self::Icosphere, Self::NoisyTorus, Self::Slats];

    /// Return the triangles.
    pub fn triangles(self) -> Triangles {
        match self {
            Self::Icosphere => on_floor(icosphere(6)),
            Self::NoisyTorus => noisy_torus(81_920),
            Self::Slats => slats(3_000),
        }
    }

    /// Return the eye, the target and the tangent of half the field of view.
    fn view(self) -> (DVec3, DVec3, f64) {
        match self {
            Self::Icosphere => (DVec3::new(1.0, 1.5, 2.5), DVec3::ZERO, 0.35),
            Self::NoisyTorus => (DVec3::new(1.0, -2.5, 2.0), DVec3::ZERO, 0.45),
            Self::Slats => (DVec3::new(0.8, -0.7, 0.6), DVec3::new(-1.0, 1.0, -0.5), 0.8),
        }
    }

    /// Return the position of the light.
    fn light(self) -> DVec3 {
        match self {
            Self::Icosphere | Self::NoisyTorus => DVec3::new(-2.0, -1.0, 5.0),
            Self::Slats => DVec3::new(0.1, 0.2, 0.9),
        }
    }
}

/// Return the unit sphere in 20 · 4ⁿ faces: an icosahedron, whose corners are the cyclic permutations of (0, ±1, ±φ),
/// subdivided and projected n times.
fn icosphere(divisions: u32) -> Triangles {
    let phi = (1.0 + 5f64.sqrt()) / 2.0;
    let mut corners = Vec::new();
    for (a, b) in [(1.0, phi), (1.0, -phi), (-1.0, phi), (-1.0, -phi)] {
        corners.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    // Three corners form a face if all are neighbors, 2 apart.
    let near = |a: DVec3, b: DVec3| (a.distance(b) - 2.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [a, b, c] = [corners[i], corners[j], corners[k]];
                if near(a, b) && near(b, c) && near(c, a) {
                    let outwards = (b - a).cross(c - a).dot(a) > 0.0;
                    faces.push(if outwards { [a, b, c] } else { [a, c, b] }.map(DVec3::normalize));
                }
            }
        }
    }
    for _ in 0..divisions {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [(a + b), (b + c), (c + a)].map(DVec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Triangles(faces.into_iter().map(|t| t.map(|c| c.as_vec3())).collect())
}

/// Add a square below the mesh: otherwise, rays that leave a sphere would hit nothing.
fn on_floor(mut mesh: Triangles) -> Triangles {
    let [a, b, c, d] = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)].map(|(x, y)| Vec3::new(x, y, -1.0));
    mesh.0.extend([[a, b, c], [a, c, d]]);
    mesh
}

/// Return a torus around the z axis, of radii 1 and 0.4, in about `count` triangles with random displacement.
pub fn noisy_torus(count: usize) -> Triangles {
    let around = (count as f64).sqrt() as usize;
    let across = count / 2 / around;
    let point = |i: usize, j: usize| {
        let (i, j) = (i % around, j % across);
        let (u, v) =
            (i as f64 / around as f64 * std::f64::consts::TAU, j as f64 / across as f64 * std::f64::consts::TAU);
        let r = 0.4 * (0.9 + 0.2 * random(i * across + j, 1)[0]);
        DVec3::new((1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin()).as_vec3()
    };
    let mut triangles = Vec::with_capacity(2 * around * across);
    for i in 0..around {
        for j in 0..across {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Triangles(triangles)
}

/// Return slats across a room from -1 to 1, each a triangle of any direction near its walls, and the walls, two
/// triangles each.
fn slats(count: usize) -> Triangles {
    let mut triangles = Vec::with_capacity(count + 12);
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |x: f64, y: f64| {
                let mut p = DVec3::splat(side);
                p[(axis + 1) % 3] = x;
                p[(axis + 2) % 3] = y;
                p.as_vec3()
            };
            let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            triangles.extend([[a, b, c], [a, c, d]]);
            for i in 0..count / 6 {
                let place = random(i, 2 + 2 * axis as u32 + u32::from(side > 0.0));
                let turn = place[3] * std::f64::consts::TAU;
                let (along, half) = (DVec3::new(0.0, turn.cos(), turn.sin()) * 0.4, 0.001);
                let across = DVec3::new(0.0, -turn.sin(), turn.cos()) * half;
                let depth = side * (0.99 - 0.1 * place[2]);
                let middle = DVec3::new(depth, place[0] * 1.2 - 0.6, place[1] * 1.2 - 0.6);
                // Rotated from x to the wall's axis.
                let turned = |p: DVec3| {
                    let mut q = DVec3::ZERO;
                    (q[axis], q[(axis + 1) % 3], q[(axis + 2) % 3]) = (p.x, p.y, p.z);
                    q.as_vec3()
                };
                triangles.push([middle - along - across, middle - along + across, middle + along].map(turned));
            }
        }
    }
    Triangles(triangles)
}

/// Ray types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Purpose {
    /// From the eye through the pixels of a square picture, row by row.
    Primary,
    /// From the first hit to the light.
    Shadow,
    /// From the first hit, scattered as by a matte surface.
    Diffuse,
}

/// Pixels per side.
const SIDE: usize = 128;

/// Return rays for a mesh. Rays from surfaces start slightly off them.
pub fn rays(mesh: Mesh, triangles: &Triangles, tree: &dyn Accelerator, purpose: Purpose) -> Vec<Ray> {
    let (eye, target, tangent) = mesh.view();
    let ahead = (target - eye).normalize();
    let right = ahead.cross(DVec3::Z).normalize();
    let up = right.cross(ahead);
    let at = |i: usize| 2.0 * (i as f64 + 0.5) / SIDE as f64 - 1.0;
    let primary: Vec<_> =
        (0..SIDE * SIDE).map(|i| Ray::new(eye, ahead + (right * at(i % SIDE) - up * at(i / SIDE)) * tangent)).collect();
    if purpose == Purpose::Primary {
        return primary;
    }
    let mut seen = vec![Hit::MISS; primary.len()];
    tree.intersect(&primary, &mut seen);
    let leave = |(i, (ray, hit)): (usize, (&Ray, &Hit))| {
        let [a, b, c] = triangles.corners(hit.primitive);
        let normal = (b - a).cross(c - a).normalize();
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let start = ray.at(hit.t) + normal * 1e-4;
        match purpose {
            Purpose::Shadow => Ray::segment(start, mesh.light()),
            _ => {
                let [u, v, ..] = random(i, 9);
                Ray::new(start, Frame::new(normal).to_world(warp::cosine_hemisphere([u, v])))
            }
        }
    };
    primary.iter().zip(&seen).enumerate().filter(|(_, (_, hit))| hit.is_hit()).map(leave).collect()
}

/// A mesh as a type, to group benchmarks by.
pub trait Subject {
    /// The mesh.
    const MESH: Mesh;
}

/// [`Mesh::Icosphere`].
pub struct Icosphere;
/// [`Mesh::NoisyTorus`].
pub struct NoisyTorus;
/// [`Mesh::Slats`].
pub struct Slats;

impl Subject for Icosphere {
    const MESH: Mesh = Mesh::Icosphere;
}

impl Subject for NoisyTorus {
    const MESH: Mesh = Mesh::NoisyTorus;
}

impl Subject for Slats {
    const MESH: Mesh = Mesh::Slats;
}

/// A BVH of some width, traversed at some SIMD level, that stores f32 or f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    width: usize,
    level: Level,
    is_single: bool,
}

impl Kernel {
    /// Return all available SIMD levels, each with its native BVH width.
    pub fn all() -> Vec<Self> {
        let available = Level::ALL.into_iter().filter(|level| level.is_available());
        available.map(|level| Self { width: level.lanes(), level, is_single: true }).collect()
    }

    /// Return the same, and the best level with f64.
    pub fn all_and_double() -> Vec<Self> {
        let mut all = Self::all();
        all.extend(all.last().map(|&best| Self { is_single: false, ..best }));
        all
    }

    /// Build the BVH.
    pub fn build(self, triangles: &Triangles, options: &Options) -> Box<dyn Accelerator> {
        if self.is_single {
            bvh::wide(self.width, triangles, options, self.level)
        } else {
            bvh::wide(self.width, &Doubles(triangles), options, self.level)
        }
    }

    /// Build the BVH of a mesh and rays for it, and compare their hits with brute force.
    pub fn prepare(self, mesh: Mesh, purpose: Purpose) -> (Box<dyn Accelerator>, Vec<Ray>) {
        let triangles = mesh.triangles();
        let tree = self.build(&triangles, &Options::DEFAULT);
        let rays = rays(mesh, &triangles, tree.as_ref(), purpose);
        validate(&triangles, tree.as_ref(), &rays);
        (tree, rays)
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}, {} wide{}", self.level.name(), self.width, if self.is_single { "" } else { ", f64" })
    }
}

/// Panic unless the hits of some rays equal those of brute force bit for bit, so that timings are of correct code.
pub fn validate(triangles: &Triangles, tree: &dyn Accelerator, rays: &[Ray]) {
    const SOME: usize = 200;
    let sample: Vec<Ray> = rays.iter().step_by(rays.len() / SOME + 1).copied().collect();
    let brute = BruteForce::over(triangles, Level::current().expect("a level of this processor"));
    let (mut wanted, mut found) = (vec![Hit::MISS; sample.len()], vec![Hit::MISS; sample.len()]);
    let mut occluded = vec![false; sample.len()];
    brute.intersect(&sample, &mut wanted);
    tree.intersect(&sample, &mut found);
    tree.occluded(&sample, &mut occluded);
    assert!(wanted.iter().any(Hit::is_hit), "no ray hits");
    for (i, ray) in sample.iter().enumerate() {
        assert_eq!(found[i], wanted[i], "the tree disagrees with brute force on {ray:?}");
        assert_eq!(occluded[i], wanted[i].is_hit(), "the tree disagrees with brute force on {ray:?}");
    }
}
