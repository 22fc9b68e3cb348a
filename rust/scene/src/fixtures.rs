//! Scenes shared by tests.

use super::{DiffuseMaterial, Mesh, Perspective, Scene, SceneDescription, Shape};
use raywright_accel::bvh::Options;
use raywright_accel::trees;
use raywright_base::math::{DVec3, Vec3};
use raywright_base::simd::Level;
use raywright_optics::Rgb;
use std::sync::Arc;

/// Builds a scene on the default accelerator.
pub fn scene(description: SceneDescription) -> Scene {
    let level = Level::current().expect("a level");
    let compiled = Scene::new(description, |geometry| trees::over(geometry, &Options::default(), level));
    compiled.expect("a scene that can be")
}

/// A parallelogram with a corner and two sides; its normal is along their cross product.
pub fn rectangle(corner: [f32; 3], side: [f32; 3], other: [f32; 3]) -> Mesh {
    let [corner, side, other] = [corner, side, other].map(Vec3::from);
    Mesh {
        vertices: vec![corner, corner + side, corner + side + other, corner + other].into(),
        faces: vec![[0, 1, 2], [0, 2, 3]],
        normals: None,
        ..Mesh::default()
    }
}

/// A diffuse surface of one color that may emit.
pub fn shape(mesh: Mesh, reflectance: impl Into<[f64; 3]>, emission: f64) -> Shape {
    let reflectance = Rgb::from_array(reflectance.into()).into();
    let material = Arc::new(DiffuseMaterial { reflectance });
    Shape { surface: mesh.into(), material, emission: Rgb::splat(emission).into() }
}

/// A box from −1 to 1 whose faces point inwards, with one reflectance and emission.
pub fn furnace(reflectance: f64, emission: f64) -> Scene {
    let shapes = inward_box([-1.0; 3], [2.0; 3]).map(|mesh| shape(mesh, [reflectance; 3], emission)).into();
    scene(SceneDescription { shapes, ..Default::default() })
}

/// The six sides of a box seen from inside: left, right, floor, ceiling, back (−z), front.
pub fn inward_box(low: [f32; 3], size: [f32; 3]) -> [Mesh; 6] {
    let [x, y, z] = low;
    let [w, h, d] = size;
    [
        rectangle(low, [0.0, h, 0.0], [0.0, 0.0, d]),
        rectangle([x + w, y, z], [0.0, 0.0, d], [0.0, h, 0.0]),
        rectangle(low, [0.0, 0.0, d], [w, 0.0, 0.0]),
        rectangle([x, y + h, z], [w, 0.0, 0.0], [0.0, 0.0, d]),
        rectangle(low, [w, 0.0, 0.0], [0.0, h, 0.0]),
        rectangle([x, y, z + d], [0.0, h, 0.0], [w, 0.0, 0.0]),
    ]
}

/// A box that stands on the floor, rotated about y, with its faces outwards.
fn standing_box(centre: [f32; 2], half: f32, height: f32, degrees: f32) -> Mesh {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let corner = |i: usize| {
        let (x, z) = (if i & 1 == 0 { -half } else { half }, if i & 4 == 0 { -half } else { half });
        let y = if i & 2 == 0 { 0.0 } else { height };
        Vec3::new(centre[0] + cos * x + sin * z, y, centre[1] - sin * x + cos * z)
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        vertices: (0..8).map(corner).collect(),
        faces: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        normals: None,
        ..Mesh::default()
    }
}

/// A Cornell box: red and green walls, two blocks, a small area light at the ceiling, open towards the camera.
pub fn cornell(width: u32, height: u32) -> (Scene, Perspective) {
    let white = [0.73, 0.73, 0.73];
    let [left, right, floor, ceiling, back, _] = inward_box([0.0; 3], [1.0; 3]);
    let light = rectangle([0.35, 0.999, 0.35], [0.3, 0.0, 0.0], [0.0, 0.0, 0.3]);
    let shapes = vec![
        shape(left, [0.63, 0.065, 0.05], 0.0),
        shape(right, [0.14, 0.45, 0.091], 0.0),
        shape(floor, white, 0.0),
        shape(ceiling, white, 0.0),
        shape(back, white, 0.0),
        shape(light, [0.0; 3], 15.0),
        shape(standing_box([0.33, 0.35], 0.15, 0.6, 18.0), white, 0.0),
        shape(standing_box([0.67, 0.67], 0.15, 0.3, -17.0), white, 0.0),
    ];
    let camera =
        Perspective::looking_at(DVec3::new(0.5, 0.5, 2.4), DVec3::new(0.5, 0.5, 0.0), DVec3::Y, 39.0, width, height);
    (scene(SceneDescription { shapes, ..Default::default() }), camera.expect("a camera"))
}

#[test]
fn the_boxes_face_where_they_should() {
    let (scene, _) = cornell(8, 8);
    let geometry = scene.geometry();
    let centre = DVec3::splat(0.5);
    for shape in 0..6 {
        for primitive in geometry.primitives_of(shape) {
            let inwards = centre - geometry.position(primitive, [0.3, 0.3]);
            assert!(geometry.normal(primitive).dot(inwards) > 0.0, "shape {shape}");
        }
    }
    for (shape, centre) in [(6, DVec3::new(0.33, 0.3, 0.35)), (7, DVec3::new(0.67, 0.15, 0.67))] {
        for primitive in geometry.primitives_of(shape) {
            let outwards = geometry.position(primitive, [0.3, 0.3]) - centre;
            assert!(geometry.normal(primitive).dot(outwards) > 0.0, "shape {shape}");
        }
    }
    let furnace = furnace(0.5, 1.0);
    for primitive in 0..12 {
        let surface = furnace.geometry().position(primitive, [0.3, 0.3]);
        assert!(furnace.geometry().normal(primitive).dot(surface) < 0.0);
    }
}
