//! Emissive surfaces in instances.

use super::super::{Emission, LightSampleContext, Sides};
use super::{FLOOR, assert_near, draw, irradiance_at, white};
use crate::fixtures::{rectangle, scene, shape};
use crate::{Instances, Matrix, Mesh, Prototype, Scene, SceneDescription, Shape};
use raywright_accel::BruteForce;
use raywright_base::math::{Affine, DVec3, Hit, Ray};
use raywright_base::simd::Level;
use raywright_shapes::{Placed, Sphere};
use std::sync::Arc;

pub(super) const STRETCHED: Matrix = [[1.5, 0.2, 0.0, 0.3], [-0.4, 0.8, 0.3, -0.2], [0.1, 0.2, -0.5, 2.0]];
pub(super) const MOVED: Matrix = [[1.0, 0.0, 0.0, -1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.2]];

fn panel() -> Mesh {
    rectangle([-0.5, -0.5, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
}

fn ball() -> Arc<dyn raywright_shapes::Shape> {
    Arc::new(Sphere { center: DVec3::new(0.2, 0.5, 0.1), radius: 0.3 })
}

fn shining(mut shape: Shape) -> Shape {
    shape.emission = Emission { sides: Sides::Both, ..white(2.0).into() };
    shape
}

fn of_shape(surface: Arc<dyn raywright_shapes::Shape>) -> Shape {
    shining(Shape { surface: surface.into(), ..Shape::default() })
}

/// Instances of a dark panel, a bright one and a sphere.
fn copied(matrices: &[Matrix]) -> Scene {
    let inner = vec![
        shape(rectangle([0.0, 0.0, 9.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.5; 3], 0.0),
        shining(shape(panel(), [0.0; 3], 0.0)),
        of_shape(ball()),
    ];
    let prototype = Prototype::new(inner, |geometry| BruteForce::over(geometry, Level::Scalar)).unwrap();
    let instances = Instances::new(Arc::new(prototype), matrices).unwrap();
    let shapes = vec![shape(rectangle([9.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.5; 3], 0.0)];
    let shapes = shapes.into_iter().chain([Shape { surface: instances.into(), ..Shape::default() }]).collect();
    scene(SceneDescription { shapes, ..Default::default() })
}

/// The same scene without instances.
fn flat(matrices: &[Matrix]) -> Scene {
    let mut shapes = Vec::new();
    for matrix in matrices {
        let map = Affine::from_matrix(*matrix);
        let mut mesh = panel();
        mesh.vertices = crate::Vertices::Double((0..4).map(|i| map.point(mesh.vertices.get(i))).collect());
        shapes.push(shining(shape(mesh, [0.0; 3], 0.0)));
        shapes.push(of_shape(Arc::new(Placed::new(ball(), map).unwrap())));
    }
    scene(SceneDescription { shapes, ..Default::default() })
}

#[test]
fn copies_light_as_what_they_are_copies_of() {
    let matrices = [STRETCHED, MOVED];
    for receiver in [FLOOR, LightSampleContext { position: DVec3::new(0.3, 0.2, 1.0), normal: DVec3::X, waves: None }] {
        let expected = irradiance_at(&flat(&matrices), &receiver, 100_000);
        let found = irradiance_at(&copied(&matrices), &receiver, 100_000);
        let error = 5.0 * expected.1.hypot(found.1);
        assert!((found.0 - expected.0).abs() < error, "{found:?} {expected:?}");
        assert!(found.1 < 0.02 * found.0);
    }
}

#[test]
fn a_draw_has_the_density_that_a_hit_of_a_copy_is_told() {
    let lit = copied(&[MOVED, STRETCHED, MOVED.map(|[x, y, z, w]| [x, y, z, w + 2.0])]);
    let mut found = 0;
    for number in 0..2000 {
        let Some(light) = draw(&lit, &FLOOR, number) else { continue };
        let ray = Ray::new(DVec3::ZERO, light.direction);
        let mut hits = [Hit::MISS];
        lit.intersect(&[ray], &mut hits);
        let surface = lit.geometry().surface(&ray, &hits[0]);
        let cosine = -surface.normal.dot(light.direction);
        let pdf = lit.lights().surface_pdf(lit.geometry(), &FLOOR, &ray, &hits[0], cosine);
        // Only if the sampled point is visible; otherwise the ray hits another light first.
        if (pdf / light.pdf - 1.0).abs() < 1e-9 / cosine.abs() {
            found += 1;
        }
    }
    // The panels hide parts of each other and of the spheres.
    assert!(found > 1000, "{found}");
}

#[test]
fn too_many_copies_are_left_to_chance() {
    let many: Vec<Matrix> = (0..2000).map(|i| MOVED.map(|[x, y, z, w]| [x, y, z, w + f64::from(i)])).collect();
    assert!(copied(&many).lights().is_dark());
    assert!(!copied(&many[..1000]).lights().is_dark());
    assert_near(irradiance_at(&copied(&[]), &FLOOR, 10), 0.0, 1.0);
}
