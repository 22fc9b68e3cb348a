//! Emission aimed at specular objects.

use crate::is_matt;
use raywright_base::math::{DVec3, Region};
use raywright_base::sampling::Sampler;
use raywright_optics::AnyBsdf;
use raywright_scene::materials::BsdfMix;
use raywright_scene::{Aim, Emitters, Geometry, Scene};

/// Maximum number of bounding spheres; each direction is tested against all.
const BALLS: usize = 16;

/// Maximum radius relative to the scene's. Larger objects are hit without aiming.
const LARGE: f64 = 0.5;

/// Approximate number of primitives that locate a shape.
const POINTS: usize = 4096;

/// Enlargement of spheres around sampled points, as other points may be farther out.
const BEYOND: f64 = 1.05;

/// Return the scene's emission, aimed at small specular objects. Their caustics are hardly found by camera paths, and
/// only by the few light paths that hit these objects. Return `None` if no light can be sampled.
pub(crate) fn emitters(scene: &Scene) -> Option<Emitters<'_>> {
    let aim = scene.kept(|| Some(Aim::at(balls(scene)))).map_or_else(Aim::default, |aim| (*aim).clone());
    scene.emitters().map(|emitters| emitters.aimed(aim))
}

/// Return bounding spheres of the specular shapes.
fn balls(scene: &Scene) -> Vec<(DVec3, f64)> {
    let mut groups: Vec<Vec<DVec3>> = Vec::new();
    for shape in 0..scene.geometry().shapes() as u32 {
        if let Some(instances) = scene.geometry().instances_of(shape) {
            let mut materials = instances.prototype().appearances().filter_map(|(material, _)| material.constant());
            if materials.any(|bsdf| is_sharp(&bsdf)) {
                let copies = (0..instances.count() as u32).filter_map(|copy| instances.bounds(copy));
                groups.extend(copies.map(|bounds| vec![bounds.min, bounds.max]));
            }
        } else if [true, false].iter().any(|&side| scene.plan().constant(shape, side).is_some_and(is_sharp_alone)) {
            groups.push(points(scene.geometry(), shape));
        }
    }
    groups.retain(|points| !points.is_empty() && points.iter().all(|point| point.is_finite()));
    let mut balls = Vec::new();
    divide(&mut groups, BALLS, &mut |groups| {
        let points = || groups.iter().flatten().copied();
        let middle = Region::around(points()).centre;
        let radius = points().map(|point| point.distance(middle)).fold(0.0, f64::max);
        if radius > 0.0 && radius < LARGE * scene.region().radius {
            balls.push((middle, radius * BEYOND));
        }
    });
    balls
}

/// Return whether a BSDF is specular and not just a gap.
fn is_sharp(bsdf: &AnyBsdf) -> bool {
    !is_matt(bsdf) && !matches!(bsdf, AnyBsdf::Transparent(_) | AnyBsdf::Null(_))
}

/// Return whether a mixture is a single specular BSDF.
fn is_sharp_alone(bsdf: &BsdfMix) -> bool {
    matches!(bsdf, BsdfMix::One(bsdf) if is_sharp(bsdf))
}

/// Return some points of a shape, which locate it approximately.
fn points(geometry: &Geometry, shape: u32) -> Vec<DVec3> {
    let primitives = geometry.primitives_of(shape);
    let each = (primitives.len() / POINTS).max(1);
    primitives
        .step_by(each)
        .flat_map(|primitive| match geometry.shape(primitive) {
            Some(shape) => (0..64)
                .filter_map(|number| shape.sample(Sampler::new(0, number, 0).two(0)))
                .map(|drawn| drawn.point.position)
                .collect(),
            None => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|uv| geometry.position(primitive, uv)).to_vec(),
        })
        .collect()
}

/// Split point groups along the longest side of their bounding box, as evenly as possible, into at most `most` groups.
fn divide(groups: &mut [Vec<DVec3>], most: usize, each: &mut impl FnMut(&[Vec<DVec3>])) {
    if groups.is_empty() {
        return;
    }
    if most < 2 || groups.len() == 1 {
        return each(groups);
    }
    let of_all = Region::around(groups.iter().map(|points| points[0]));
    let size = of_all.max - of_all.min;
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    groups.sort_unstable_by(|a, b| a[0][axis].total_cmp(&b[0][axis]));
    let (one, other) = groups.split_at_mut(groups.len() / 2);
    divide(one, most / 2, each);
    divide(other, most - most / 2, each);
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_scene::fixtures::{rectangle, scene, shape};
    use raywright_scene::materials::{DielectricMaterial, Interior, MirrorMaterial};
    use raywright_scene::{SceneDescription, Shape};
    use raywright_shapes::Sphere;
    use std::sync::Arc;

    fn ball(middle: [f64; 3], radius: f64) -> Shape {
        let surface = Arc::new(Sphere { center: middle.into(), radius }) as Arc<dyn raywright_shapes::Shape>;
        let material =
            Arc::new(DielectricMaterial { interior: Interior::new(1.5, 0), roughness: 0.0.into(), medium: None });
        Shape { surface: surface.into(), material, ..Shape::default() }
    }

    #[test]
    fn balls_are_about_what_is_small_and_sharp() {
        let floor = |is_mirror: bool| {
            let mut floor = shape(rectangle([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]), [0.5; 3], 0.0);
            if is_mirror {
                floor.material = Arc::new(MirrorMaterial { reflectance: raywright_optics::Rgb::ONE.into() });
            }
            floor
        };
        let of = |shapes: Vec<Shape>| balls(&scene(SceneDescription { shapes, lights: Vec::new() }));
        assert!(of(vec![floor(false)]).is_empty());
        // A mirror as large as the scene is hit without aiming.
        let found = of(vec![floor(true), ball([0.0, 1.0, 0.0], 0.5)]);
        assert_eq!(found.len(), 1);
        let (middle, radius) = found[0];
        assert!(middle.distance(DVec3::Y) < 0.1 && (0.45..0.6).contains(&radius), "{found:?}");
        // Many spheres are grouped.
        let many = (0..100).map(|k| ball([f64::from(k % 10) - 5.0, 1.0, f64::from(k / 10) - 5.0], 0.1));
        let found = of([floor(false)].into_iter().chain(many).collect());
        assert_eq!(found.len(), BALLS);
    }
}
