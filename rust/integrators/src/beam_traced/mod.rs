//! Beam tracing.

mod beam;
mod beam_tree;
mod face_shading;
mod hidden_surfaces;
mod next_beams;
mod shadow_polygons;

use super::{CameraSample, Integrator, Job, Session, Worker};
use beam_tree::BeamTree;
use raywright_accel::Primitives;
use raywright_base::math::convex::{HalfPlane, area, clip};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Camera, Scene, SurfaceInteraction};

/// Beam tracing (Heckbert and Hanrahan, "Beam Tracing Polygonal Objects", 1984): the whole view is one beam instead of
/// rays. The faces in it divide it into polygons. Flat mirrors reflect these as beams from the mirror image of the eye,
/// and flat glass refracts them. Beams from lights divide them into lit and shadowed parts. Each pixel is the mean over
/// its square: the area of each polygon in it times its radiance, by three-point quadrature over triangles. So edges
/// are exact, and the picture has no noise.
///
/// It renders meshes with Whitted's model: only specular reflection and transmission are followed, and lights have no
/// extent. Its time is quadratic in the number of visible faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamTraced {
    /// Maximum number of surfaces on a path of light, counted from the light.
    pub max_depth: u32,
    /// Uniform incident radiance that replaces light not followed. Surfaces reflect their ambient share of it
    /// ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
    /// Maximum error of refracted rays, in pixels, as seen from afar; refracted beams are split until they satisfy it.
    /// Infinite never splits, as in the paper.
    pub tolerance: f64,
}

impl Default for BeamTraced {
    fn default() -> Self {
        Self { max_depth: 8, ambient: Rgb::ZERO, tolerance: 0.25 }
    }
}

/// Maximum number of lights, one bit each in a piece of the film.
const MOST_LIGHTS: usize = u64::BITS as usize;

impl Integrator for BeamTraced {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let tree = job.camera.as_perspective().map(|camera| BeamTree::new(&job, camera, self, cancel));
        let size = [job.camera.width(), job.camera.height()];
        let blocks = tree.as_ref().map_or_else(Vec::new, |tree| tree.by_block(size, Film::SIDE));
        Box::new(Film { job, ambient: self.ambient, tree, blocks })
    }

    fn objection(&self, scene: &Scene, _: bool) -> Option<String> {
        let (geometry, lights) = (scene.geometry(), scene.lights());
        if let Some(shape) = geometry.first_other() {
            return Some(format!("beams support only meshes, and shape {shape} is none: use Whitted"));
        }
        let mut shapes = 0..geometry.shapes() as u32;
        if let Some((shape, why)) = shapes.find_map(|shape| Some((shape, unsuited(scene, shape)?))) {
            return Some(format!("shape {shape} {why}: use Whitted"));
        }
        if let Some([a, b]) = nested(scene) {
            return Some(format!(
                "shapes {a} and {b} are of glass and may overlap, and beams do not support nested glass: use Whitted"
            ));
        }
        if scene.plan().needs().standing.sheets {
            return Some(
                "an open surface is in or on glass, and beams shade open surfaces as in air: use Whitted".into(),
            );
        }
        if lights.others().any(|light| light.place().is_none()) {
            return Some(
                "beams support only point and directional lights, and the scene has an environment: use Whitted".into(),
            );
        }
        let count = lights.others().count();
        (count > MOST_LIGHTS).then(|| format!("beams support at most {MOST_LIGHTS} lights, got {count}: use Whitted"))
    }

    fn view_objection(&self, camera: &dyn Camera, filter_radius: f64) -> Option<String> {
        if camera.as_perspective().is_none() {
            return Some("beams support only a pinhole camera that does not move: use a Camera, or Whitted".into());
        }
        (filter_radius != 0.5).then(|| "beams average each pixel over its square: use BoxFilter()".into())
    }
}

/// Return what beam tracing does not support about a shape.
fn unsuited(scene: &Scene, shape: u32) -> Option<&'static str> {
    let material = scene.material(shape);
    if scene.lights().shines(shape) {
        Some("is emissive, and beams support only point and directional lights")
    } else if !material.is_opaque() {
        Some("has a mask, which beams do not support")
    } else {
        is_unlike_paper(scene, shape)
    }
}

/// Return what beam tracing does not support about the delta directions of a shape's faces, tested at their centers.
fn is_unlike_paper(scene: &Scene, shape: u32) -> Option<&'static str> {
    scene.geometry().primitives_of(shape).find_map(|face| is_face_unlike_paper(scene, face))
}

/// Return the same for one face, if it has an area.
fn is_face_unlike_paper(scene: &Scene, face: u32) -> Option<&'static str> {
    let geometry = scene.geometry();
    let third = [1.0 / 3.0; 2];
    let (at, normal) = (geometry.position(face, third), geometry.normal(face));
    if !normal.is_finite() {
        return None;
    }
    let ray = Ray::new(at + normal, -normal);
    let hit = Hit { t: 1.0, uv: third, primitive: face, inner: 0 };
    let here = SurfaceInteraction::at(scene, &ray, &hit);
    let (mut singles, mut etas) = (0, Vec::new());
    here.bsdf().delta_lobes(here.wo(), |single| {
        singles += 1;
        if single.is_through && !etas.contains(&single.eta) {
            etas.push(single.eta);
        }
    });
    if singles > 0 && !here.is_flat() {
        return Some("reflects or refracts with shading normals, and beams need flat normals");
    }
    (etas.len() > 1).then_some("refracts in several directions, and beams support one")
}

/// Return two glass shapes with overlapping bounding boxes.
fn nested(scene: &Scene) -> Option<[u32; 2]> {
    let geometry = scene.geometry();
    let of = |shape: u32| {
        let corners = geometry.primitives_of(shape).flat_map(|face| geometry.corners(face));
        let whole = |(low, high): (DVec3, DVec3), corner: DVec3| (low.min(corner), high.max(corner));
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), whole)
    };
    let is_glass = |&shape: &u32| scene.material(shape).interior().is_some();
    let boxes: Vec<_> = (0..geometry.shapes() as u32).filter(is_glass).map(|shape| (shape, of(shape))).collect();
    let overlap = |a: &(DVec3, DVec3), b: &(DVec3, DVec3)| a.0.cmplt(b.1).all() && b.0.cmplt(a.1).all();
    boxes.iter().enumerate().find_map(|(i, (a, box_a))| {
        let (b, _) = boxes[i + 1..].iter().find(|(_, box_b)| overlap(box_a, box_b))?;
        Some([*a, *b])
    })
}

/// The film, divided into pieces.
struct Film<'a> {
    job: Job<'a>,
    ambient: Rgb,
    /// `None` for cameras that beams do not support.
    tree: Option<BeamTree>,
    /// Pieces in each block of pixels.
    blocks: Vec<Vec<u32>>,
}

impl Film<'_> {
    /// Side of a block, in pixels.
    const SIDE: u32 = 8;

    /// Return the mean radiance of a pixel.
    fn pixel(&self, pixel: u32) -> Rgb {
        let width = self.job.camera.width();
        let [x, y] = [pixel % width, pixel / width];
        let block = y / Self::SIDE * width.div_ceil(Self::SIDE) + x / Self::SIDE;
        let (Some(tree), Some(pieces)) = (&self.tree, self.blocks.get(block as usize)) else { return Rgb::ZERO };
        let [x, y] = [x, y].map(f64::from);
        let lines = [[1.0, 0.0, -x], [-1.0, 0.0, x + 1.0], [0.0, 1.0, -y], [0.0, -1.0, y + 1.0]];
        let square = lines.map(|line| HalfPlane { line: DVec3::from_array(line), slack: 0.0 });
        let mut light = Rgb::ZERO;
        for &number in pieces {
            let piece = &tree.pieces[number as usize];
            let [low, high] = piece.bounds;
            if low.x >= x + 1.0 || low.y >= y + 1.0 || high.x <= x || high.y <= y {
                continue;
            }
            let here = clip(&piece.outline, &square);
            for i in 2..here.len() {
                let corners = [here[0], here[i - 1], here[i]];
                let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                // Exact for radiance that is quadratic over the triangle.
                for corner in corners {
                    let at = middle + (corner - middle) * 0.5;
                    light += tree.radiance(&self.job, self.ambient, piece, at) * (area(&corners) / 3.0);
                }
            }
        }
        light
    }
}

impl Session for Film<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(BeamWorker(self))
    }
}

/// The worker that shades pixels.
struct BeamWorker<'a>(&'a Film<'a>);

impl Worker for BeamWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        for (sample, radiance) in samples.iter().zip(radiance) {
            if cancel.is_raised() {
                return;
            }
            *radiance = self.0.pixel(sample.sampler.pixel());
        }
    }
}
