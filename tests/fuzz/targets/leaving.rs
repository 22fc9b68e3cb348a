//! Any triangle that is no sliver, and a copy close by. A ray that leaves a surface does not hit it again, one towards
//! a surface stops short of it, and neither leaks through a plate as thin as 10⁻⁵ of its size.

use super::accelerators;
use super::numbers::{Range, double_point, one_of, single_point};
use super::triangles::Triangles;
use arbitrary::{Result, Unstructured};
use raywright::accel::bvh::Options;
use raywright::math::{DVec3, Ray};
use raywright::scene::{Geometry, Mesh, RayOrigin, SurfacePoint, Vertices};

/// Panics if a ray hits the surface that it leaves, or misses one in its way.
pub fn check(data: &[u8]) {
    let _ = plate(&mut Unstructured::new(data));
}

/// Weights of the second and third corner, anywhere or well within.
fn weights(u: &mut Unstructured, is_within: bool) -> Result<[f64; 2]> {
    let margin = u32::from(is_within);
    let v = u.int_in_range(margin..=8 - 2 * margin)?;
    let w = u.int_in_range(margin..=8 - margin - v)?;
    Ok([f64::from(v) / 8.0, f64::from(w) / 8.0])
}

/// The largest coordinate of some points.
fn largest(points: &[DVec3]) -> f64 {
    points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// A corner, often one that is an f32.
fn corner(u: &mut Unstructured) -> Result<DVec3> {
    if u.ratio(1, 3)? { double_point(u, Range::Moderate) } else { Ok(single_point(u, Range::Moderate)?.as_dvec3()) }
}

fn plate(u: &mut Unstructured) -> Result<()> {
    let place = if u.arbitrary()? { DVec3::ZERO } else { double_point(u, Range::Moderate)? };
    let [a, b, c] = [corner(u)? + place, corner(u)? + place, corner(u)? + place];
    let size = largest(&[b - a, c - b, a - c]);
    let twice_area = (b - a).cross(c - a);
    // Far from the origin numbers are too coarse for a copy, and the normal of a sliver is too uncertain to tell the
    // flattest directions that lead away.
    let is_near = largest(&[a, b, c]) < 2f64.powi(16) * size;
    if !is_near || twice_area.length() < 0.1 * size * size {
        return Ok(());
    }
    let thickness = size * one_of(u, &[1e-5, -1e-5, 1e-3, 0.5])?;
    let aside = twice_area.normalize() * thickness;
    let triangles = Triangles(vec![[a, b, c], [a, b, c].map(|p| p + aside)]);
    let geometry = Geometry::new([Mesh {
        vertices: Vertices::Double(triangles.0.concat()),
        faces: vec![[0, 1, 2], [3, 4, 5]],
        normals: None,
        ..Mesh::default()
    }]);
    let surface = |primitive, uv| geometry.on_triangle(primitive, uv);
    let (near, far) = (surface(0, weights(u, false)?), surface(1, weights(u, true)?));

    // Away from both, at any angle down to none.
    let along = double_point(u, Range::Moderate)?;
    let steepness = one_of(u, &[0.0, 1e-15, 1e-12, 1e-6, 1.0])?;
    let flat = along - near.normal * along.dot(near.normal);
    let away = flat - near.normal * 1f64.copysign(thickness) * largest(&[flat]).max(1.0) * steepness;
    let alone = Triangles(vec![triangles.0[0]]);
    let leaving = RayOrigin::new(&near).ray(away);
    let crossing = RayOrigin::new(&near).ray(-away);
    let answers = |triangles: &Triangles, rays: &[Ray], wanted: &[bool]| {
        for (name, accelerator) in accelerators::all(triangles, &Options::DEFAULT) {
            let mut occluded = vec![false; rays.len()];
            accelerator.occluded(rays, &mut occluded);
            assert_eq!(occluded, wanted, "{name}: {rays:?} at {triangles:?}");
        }
    };
    answers(&alone, &[leaving, crossing], &[false, false]);
    answers(&triangles, &between(&near, &far), &[true, false, false, true, true]);
    Ok(())
}

/// Rays from one side of a gap to the other, and through it: infinite, up to the other side, and beyond it.
fn between(near: &SurfacePoint, far: &SurfacePoint) -> [Ray; 5] {
    let (here, there) = (RayOrigin::new(near), RayOrigin::new(far));
    let across = far.position - near.position;
    let beyond = RayOrigin::free(far.position + across);
    [here.ray(across), here.segment(&there), there.segment(&here), here.segment(&beyond), beyond.segment(&here)]
}
