//! Nested, adjacent and overlapping dielectrics.

use super::assert_radiance;
use crate::Path;
use raywright_base::cases;
use raywright_base::math::{DVec3, Ray, Vec3};
use raywright_optics::{Dielectric, Rgb};
use raywright_scene::fixtures::{rectangle, scene, shape};
use raywright_scene::materials::{BsdfMix, Interior};
use raywright_scene::textures::Needs;
use raywright_scene::{ConstantEnvironment, Material, Mesh, Scene, SceneDescription, ShadingPoint, Shape};
use std::sync::Arc;

/// Smooth or rough glass.
#[derive(Clone, Copy, Debug)]
struct Glass(Interior, f64);

impl Material for Glass {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        Dielectric::new(self.0.ior / at.outside, self.1).into()
    }
    fn needs(&self) -> Needs {
        Needs::NONE
    }
    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
    fn interior(&self) -> Option<Interior> {
        Some(self.0)
    }
}

/// A box from `low` to `high` with outward faces.
fn block(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let corner = |i: usize| Vec3::from([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] }));
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        vertices: (0..8).map(corner).collect(),
        faces: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

fn glass(mesh: Mesh, ior: f64, priority: i32, alpha: f64) -> Shape {
    Shape { material: Arc::new(Glass(Interior::new(ior, priority), alpha)), ..shape(mesh, [0.0; 3], 0.0) }
}

/// A slab from one height to another.
fn slab(low: f32, high: f32, ior: f64, priority: i32) -> Shape {
    glass(block([-1.0, -1.0, low], [1.0, 1.0, high]), ior, priority, 0.0)
}

/// A lamp of radiance 1 at the height −1 below slabs, seen vertically from above.
fn over_a_lamp(slabs: Vec<Shape>) -> Scene {
    let lamp = rectangle([-1.0, -1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let shapes = slabs.into_iter().chain([shape(lamp, [0.0; 3], 1.0)]).collect();
    scene(SceneDescription { shapes, ..Default::default() })
}

const DOWN: Ray = Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z);

/// Return the transmittance at normal incidence of consecutive interfaces between media of these indices, with all
/// interreflections (Stokes, 1862): for two stacks, T = T₁T₂ / (1 − R₁R₂).
fn transmitted(indices: &[f64]) -> f64 {
    let (mut through, mut back) = (1.0, 0.0);
    for pair in indices.windows(2) {
        let r = ((pair[0] - pair[1]) / (pair[0] + pair[1])).powi(2);
        let between = 1.0 - back * r;
        // Radiance over the squared index is conserved.
        (through, back) = (through * (1.0 - r) / between, r + (1.0 - r) * (1.0 - r) * back / between);
    }
    through
}

#[test]
fn slabs_let_through_what_stokes_says_whether_they_touch_or_nearly_do_or_overlap() {
    let a = |low, high| slab(low, high, 1.5, 0);
    let b = |low, high| slab(low, high, 2.0, 1);
    let c = |low, high| slab(low, high, 1.5, 1);
    let cases: [(Vec<Shape>, &[f64]); 10] = [
        (vec![a(0.0, 1.0)], &[1.0, 1.5, 1.0]),
        // A gap of a millionth is air. Touching slabs have no gap, in any order of description and with any priorities.
        (vec![a(0.0, 1.0), a(1.000_001, 2.0)], &[1.0, 1.5, 1.0, 1.5, 1.0]),
        (vec![a(0.0, 1.0), a(1.0, 2.0)], &[1.0, 1.5, 1.0]),
        (vec![a(0.0, 1.0), c(1.0, 2.0)], &[1.0, 1.5, 1.0]),
        (vec![c(0.0, 1.0), a(1.0, 2.0)], &[1.0, 1.5, 1.0]),
        (vec![a(0.0, 1.0), b(1.0, 2.0)], &[1.0, 2.0, 1.5, 1.0]),
        (vec![b(0.0, 1.0), a(1.0, 2.0)], &[1.0, 1.5, 2.0, 1.0]),
        // One inside the other, and partial overlap.
        (vec![a(0.0, 3.0), b(1.0, 2.0)], &[1.0, 1.5, 2.0, 1.5, 1.0]),
        (vec![b(0.0, 3.0), a(1.0, 2.0)], &[1.0, 2.0, 1.0]),
        (vec![a(0.0, 2.0), b(1.0, 3.0)], &[1.0, 2.0, 1.5, 1.0]),
    ];
    for (number, (slabs, indices)) in cases.into_iter().enumerate() {
        println!("case {number}");
        let scene = over_a_lamp(slabs);
        assert_eq!(scene.plan().needs().nested, number >= 2, "only what touches is told apart");
        assert_radiance(&scene, &Path::default(), DOWN, 20_000, transmitted(indices));
    }
}

#[test]
fn the_index_may_be_one_or_nearly_or_ten() {
    for ior in [1.0, 1.0 + 1e-7, 1.0001, 10.0, 0.5] {
        let (expected, count) = (transmitted(&[1.0, ior, 1.0]), 60_000);
        let (mean, error) = super::radiance(&over_a_lamp(vec![slab(0.0, 1.0, ior, 0)]), &Path::default(), DOWN, count);
        // At 1.0001 the reflectance is 5e-9, so no reflected ray is sampled here.
        assert!((mean - expected).abs() < 4.0 * error + 1e-8, "{ior}: {mean} ± {error}, not {expected}");
        assert!(error < 0.01 * expected);
    }
}

#[test]
fn glass_in_an_even_light_cannot_be_seen_from_outside_or_inside() {
    // Radiance over the squared index is uniform. Cameras are outside, inside one block, and inside both. Along none of
    // these rays does total internal reflection trap light forever.
    let ways = [DVec3::new(0.3, 0.2, 0.93), DVec3::new(-0.2, -0.96, 0.25), DVec3::new(0.01, -0.999_95, 0.0)];
    for alpha in [0.0, 0.3] {
        for gap in cases::every(2, usize::from(alpha > 0.0), [0.0, 1e-6, 0.25]) {
            let outer = glass(block([-1.0; 3], [1.0; 3]), 1.5, 0, alpha);
            let inner = glass(block([gap - 1.0; 3], [0.5; 3]), 1.8, 1, alpha);
            let shapes = vec![outer, inner];
            let scene =
                scene(SceneDescription { shapes, lights: vec![Arc::new(ConstantEnvironment { radiance: Rgb::ONE })] });
            for way in ways {
                let way = way.normalize();
                // Rough glass loses up to half a percent on average. In smooth glass roulette terminates about one of
                // these paths, and more than ten with a probability of 1e-7.
                let slack = if alpha == 0.0 { 5e-4 } else { 0.005 };
                for (origin, index) in
                    [(-3.0 * way, 1.0f64), (DVec3::new(0.75, 0.8, 0.7), 1.5), (DVec3::new(0.1, 0.2, -0.1), 1.8)]
                {
                    let (mean, error) = super::radiance(&scene, &Path::default(), Ray::new(origin, way), 20_000);
                    let off = (mean / (index * index) - 1.0).abs();
                    assert!(off < 4.0 * error / (index * index) + slack, "{alpha} {gap} {index}: {mean} ± {error}");
                }
            }
        }
    }
}

#[test]
fn shadow_rays_pass_surfaces_that_are_none() {
    // A floor and a lamp in one glass, which does not refract between them, and a glass of lower priority inside it: as
    // in empty space.
    let floor = rectangle([-0.5, -0.5, 0.1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let lamp = rectangle([-0.5, -0.5, 1.1], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    let all = |more: Vec<Shape>| {
        let shapes = [shape(floor.clone(), [0.5; 3], 0.0), shape(lamp.clone(), [0.0; 3], 1.0)];
        scene(SceneDescription { shapes: shapes.into_iter().chain(more).collect(), ..Default::default() })
    };
    let ray = Ray::new(DVec3::new(0.2, 0.1, 0.4), DVec3::new(-0.48, -0.36, -0.8));
    let path = Path { max_depth: Some(1), ..Path::default() };
    let (expected, error) = super::radiance(&all(vec![]), &path, ray, 50_000);
    let around = glass(block([-2.0; 3], [2.0; 3]), 1.5, 1, 0.0);
    let between = glass(block([-1.0, -1.0, 0.5], [1.0, 1.0, 0.9]), 1.3, 0, 0.0);
    let (mean, other) = super::radiance(&all(vec![around, between]), &path, ray, 50_000);
    assert!((mean - expected).abs() < 4.0 * error.hypot(other), "{mean} ± {other}, not {expected} ± {error}");
}
