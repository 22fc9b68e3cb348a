//! Solids enclosed by surfaces.

use super::Geometry;
use super::front::is_front_of;
use crate::topology::{FaceKind, NONE, Topology, rounding};
use raywright_accel::{Accelerator, BoxTree, Exit, Exits, Primitives, Side};
use raywright_base::math::{DVec3, Ray};
use raywright_shapes::Bounds;

/// Marks a primitive that is not a face and encloses a solid by itself.
const OBJECT: u32 = NONE - 1;
/// Maximum number of corners tested to decide whether a mesh is the wall of a cavity.
const LOOKED_AT: usize = 256;
/// A direction that avoids special positions relative to man-made geometry; its largest coordinate is between 1 and 2.
const WAY: DVec3 = DVec3::new(1.289_430_857_193_402_8, 0.371_920_584_301_275_66, 0.587_109_384_750_921_3);

/// Options of solid queries. Corners within a tolerance are merged; the default is [`crate::topology::rounding`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Enclosing {
    /// One flag per shape: true if it counts. `None` counts all shapes.
    pub shapes: Option<Vec<bool>>,
    /// Distance in the scene's unit.
    pub tolerance: Option<f64>,
    /// Treats all surfaces, closed or not, as one under the even-odd rule: a point is inside if rays from it cross an
    /// odd number of surfaces.
    pub is_even_odd: bool,
}

/// The solids enclosed by closed shapes: a point is inside if it is in one of them.
///
/// A mesh is split into connected components. A component without open edges encloses the points with non-zero winding
/// number or, if its faces are not consistently oriented, with an odd number of crossings. So cavities of a mesh are
/// outside, and overlaps of its parts inside. Meshes that close only together, such as the walls of a room, are merged.
/// A mesh with inward normals is the wall of a cavity if it lies within another solid, and a solid otherwise.
#[derive(Debug, Default)]
pub struct Solids {
    /// The body of each face; [`NONE`] for ignored faces, [`OBJECT`] for other shapes.
    of: Vec<u32>,
    bodies: Vec<SolidBody>,
    groups: Vec<Group>,
    /// Shapes whose normals all point inwards and that are not cavities of others.
    inverted: Vec<u32>,
    /// True if all surfaces close to the last bit.
    is_exact: bool,
    /// The boxes of the bodies and other shapes; `None` if a point outside all of them may be inside.
    boxes: Option<SolidBoxes>,
}

#[derive(Debug, Default)]
struct SolidBoxes {
    all: Vec<Bounds>,
    tree: BoxTree,
}

#[derive(Clone, Copy, Debug)]
struct SolidBody {
    group: u32,
    is_oriented: bool,
    /// 1, or −1 if normals point inwards.
    sign: i32,
}

/// Bodies whose winding numbers are summed.
#[derive(Clone, Debug)]
struct Group {
    /// The mesh; `None` if the bodies span several.
    shape: Option<u32>,
    volume: f64,
    /// True if all of its bodies are oriented.
    is_oriented: bool,
    is_cavity: bool,
}

impl Solids {
    /// Finds the closed parts of a geometry.
    pub fn new(geometry: &Geometry, accelerator: &dyn Accelerator, enclosing: &Enclosing) -> Self {
        let mut solids = Self { of: vec![NONE; geometry.count()], is_exact: true, ..Self::default() };
        let counts = |shape: u32| {
            enclosing.shapes.as_ref().is_none_or(|all| all.get(shape as usize).is_some_and(|&counts| counts))
        };
        if enclosing.is_even_odd {
            for shape in (0..geometry.shapes() as u32).filter(|&shape| counts(shape)) {
                let primitives = geometry.primitives_of(shape);
                solids.of[primitives.start as usize..primitives.end as usize].fill(0);
            }
            solids.bodies.push(SolidBody { group: 0, is_oriented: false, sign: 1 });
            solids.groups.push(Group { shape: None, volume: 0.0, is_oriented: false, is_cavity: false });
            solids.is_exact = false;
            return solids;
        }
        let mut open: Vec<(Mesh, Vec<bool>)> = Vec::new();
        for shape in (0..geometry.shapes() as u32).filter(|&shape| counts(shape)) {
            let primitives = geometry.primitives_of(shape);
            if primitives.is_empty() {
                continue;
            }
            let object = geometry.shape(primitives.start);
            if object.is_some() || geometry.instances_of(shape).is_some() {
                if object.is_none_or(|object| object.is_closed()) {
                    solids.of[primitives.start as usize..primitives.end as usize].fill(OBJECT);
                    solids.is_exact = false;
                }
                continue;
            }
            let mesh = Mesh::new(geometry, shape);
            let topology = Topology::new(&mesh.points, &mesh.faces, enclosing.tolerance);
            solids.add(&mesh.primitives, &topology, Some(shape));
            let is_open: Vec<bool> = topology.faces.iter().map(|&kind| kind == FaceKind::Open).collect();
            if is_open.contains(&true) {
                open.push((mesh, is_open));
            }
        }
        if open.len() > 1 {
            let mut all = Mesh::default();
            for (mesh, is_open) in &open {
                all.extend(mesh, is_open);
            }
            // Meshes may differ greatly in size; the smallest rounding is used, because that of a large mesh may exceed
            // a small mesh.
            let least = || open.iter().map(|(mesh, _)| rounding(&mesh.points, &mesh.faces)).fold(f64::MAX, f64::min);
            let tolerance = enclosing.tolerance.unwrap_or_else(least);
            let topology = Topology::new(&all.points, &all.faces, Some(tolerance));
            solids.add(&all.primitives, &topology, None);
        }
        solids.find_cavities(geometry, accelerator);
        solids.find_inverted(geometry);
        solids.boxes = Some(solids.boxes(geometry));
        solids
    }

    fn boxes(&self, geometry: &Geometry) -> SolidBoxes {
        let mut all = vec![Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY }; self.bodies.len()];
        for (primitive, &of) in self.of.iter().enumerate().filter(|(_, of)| **of != NONE) {
            let Some(bounds) = geometry.bounds(primitive as u32) else { continue };
            match all.get_mut(of as usize) {
                Some(body) => *body = Bounds { min: body.min.min(bounds.min), max: body.max.max(bounds.max) },
                None => all.push(bounds),
            }
        }
        let tree = BoxTree::new((0..).zip(all.iter().copied()));
        SolidBoxes { all, tree }
    }

    /// Returns whether a point is in the box of a solid; all others are outside.
    pub fn may_contain(&self, point: DVec3) -> bool {
        let is_in = |bounds: &Bounds| point.cmpge(bounds.min).all() && point.cmple(bounds.max).all();
        self.boxes.as_ref().is_none_or(|boxes| boxes.tree.any(is_in, |number| is_in(&boxes.all[number as usize])))
    }

    /// Adds a group: the bodies of faces with these primitive numbers.
    fn add(&mut self, primitives: &[u32], topology: &Topology, shape: Option<u32>) {
        if topology.bodies.is_empty() {
            return;
        }
        self.is_exact &= topology.is_exact;
        let (first, group) = (self.bodies.len() as u32, self.groups.len() as u32);
        let sign = |volume: f64| if volume < 0.0 { -1 } else { 1 };
        self.bodies.extend(topology.bodies.iter().map(|body| SolidBody {
            group,
            is_oriented: body.is_oriented,
            sign: sign(body.volume),
        }));
        for (&primitive, kind) in primitives.iter().zip(&topology.faces) {
            if let FaceKind::Closed(body) = kind {
                self.of[primitive as usize] = first + body;
            }
        }
        let volume = topology.bodies.iter().map(|body| body.volume).sum();
        let is_oriented = topology.bodies.iter().all(|body| body.is_oriented);
        self.groups.push(Group { shape, volume, is_oriented, is_cavity: false });
    }

    /// Finds meshes with inward normals that lie within solids whose normals point outwards.
    fn find_cavities(&mut self, geometry: &Geometry, accelerator: &dyn Accelerator) {
        let is_inverted: Vec<bool> = self.groups.iter().map(|group| group.volume < 0.0).collect();
        if !is_inverted.contains(&true) || (is_inverted.iter().all(|&is| is) && !self.of.contains(&OBJECT)) {
            return;
        }
        let body_counts = |body: u32| !is_inverted[self.bodies[body as usize].group as usize];
        let outer = Self {
            of: self.of.iter().map(|&of| if of >= OBJECT || body_counts(of) { of } else { NONE }).collect(),
            bodies: self.bodies.clone(),
            groups: self.groups.clone(),
            ..Self::default()
        };
        for (group, _) in is_inverted.iter().enumerate().filter(|(_, is_inverted)| **is_inverted) {
            let Some(shape) = self.groups[group].shape else { continue };
            let points = Mesh::new(geometry, shape).points;
            let points: Vec<DVec3> = points.into_iter().filter(|point| point.is_finite()).collect();
            let step = points.len().div_ceil(LOOKED_AT).max(1);
            let rays: Vec<Ray> = points.into_iter().step_by(step).map(|point| Ray::new(point, WAY)).collect();
            let sides = outer.sides(geometry, accelerator, &rays);
            self.groups[group].is_cavity = sides.contains(&Side::Inside) && !sides.contains(&Side::Outside);
        }
    }

    /// Finds meshes with inward normals, and instances of them.
    fn find_inverted(&mut self, geometry: &Geometry) {
        let is_inverted = |group: &&Group| group.volume < 0.0 && group.is_oriented && !group.is_cavity;
        self.inverted = self.groups.iter().filter(is_inverted).filter_map(|group| group.shape).collect();
        for shape in 0..geometry.shapes() as u32 {
            let primitives = geometry.primitives_of(shape);
            let counts = !primitives.is_empty() && self.of[primitives.start as usize] == OBJECT;
            // Transforms that mirror keep normals on their side of the surface.
            let instances = if counts { geometry.instances_of(shape) } else { None };
            if instances.is_some_and(|instances| !instances.prototype().solids().inverted.is_empty()) {
                self.inverted.push(shape);
            }
        }
        self.inverted.sort_unstable();
    }

    /// Shapes whose normals all point inwards and that are not cavities of others, and instances with such shapes.
    pub fn inverted(&self) -> &[u32] {
        &self.inverted
    }

    /// Returns whether every ray direction gives the same result: all surfaces are triangles whose shared edges have
    /// bit-identical ends.
    pub fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// Returns whether nothing is enclosed.
    pub fn is_empty(&self) -> bool {
        self.of.iter().all(|&of| of == NONE)
    }

    /// The side of the solids on which each ray's origin lies, by the surfaces that the ray crosses.
    pub fn sides(&self, geometry: &Geometry, accelerator: &dyn Accelerator, rays: &[Ray]) -> Vec<Side> {
        let counts = |primitive: u32| self.of[primitive as usize] != NONE;
        let Exits { crossed, on_surface } = accelerator.exits(&counts, rays);
        let of_origin = |on_surface| if on_surface { Side::Surface } else { Side::Outside };
        let mut sides: Vec<Side> = on_surface.into_iter().map(of_origin).collect();
        let mut wound = Vec::new();
        for exits in crossed.chunk_by(|a, b| a.ray == b.ray) {
            let ray = exits[0].ray as usize;
            if sides[ray] == Side::Outside && self.is_inside(geometry, &rays[ray], exits, &mut wound) {
                sides[ray] = Side::Inside;
            }
        }
        sides
    }

    /// Returns whether a ray with these crossings starts inside a solid and in fewer cavities.
    fn is_inside(&self, geometry: &Geometry, ray: &Ray, exits: &[Exit], wound: &mut Vec<(u64, u32, i32)>) -> bool {
        if let [exit] = exits {
            // The common case is one crossing; its orientation only tells which side counts as inner.
            let body = self.bodies.get(self.of[exit.primitive as usize] as usize);
            return body.is_none_or(|body| !self.groups[body.group as usize].is_cavity);
        }
        let first = self.of[exits[0].primitive as usize];
        if exits.len() % 2 == 1 && exits.iter().all(|exit| self.of[exit.primitive as usize] == first) {
            // An odd number of terms ±1 has a non-zero sum. [`OBJECT`] stands for many shapes, a body for one.
            if let Some(body) = self.bodies.get(first as usize) {
                return !self.groups[body.group as usize].is_cavity;
            }
        }
        wound.clear();
        wound.extend(exits.iter().map(|exit| {
            let of = self.of[exit.primitive as usize];
            if of == OBJECT {
                return (1 << 32 | u64::from(exit.primitive), NONE, 1);
            }
            let body = &self.bodies[of as usize];
            let is_in = body.is_oriented && is_front_of(geometry.corners(exit.primitive), ray);
            (u64::from(body.group), of, if is_in { -1 } else { 1 })
        }));
        wound.sort_unstable();
        let mut depth = 0;
        for group in wound.chunk_by(|a, b| a.0 == b.0) {
            let of_body = |body: &[(u64, u32, i32)]| match self.bodies.get(body[0].1 as usize) {
                Some(SolidBody { is_oriented: true, .. }) => body.iter().map(|(.., crossing)| crossing).sum(),
                Some(SolidBody { sign, .. }) => sign * (body.len() % 2) as i32,
                None => (body.len() % 2) as i32,
            };
            let number: i32 = group.chunk_by(|a, b| a.1 == b.1).map(of_body).sum();
            if number != 0 {
                depth += if self.groups.get(group[0].0 as usize).is_some_and(|group| group.is_cavity) { -1 } else { 1 };
            }
        }
        depth > 0
    }
}

/// Faces of meshes, with their primitive numbers.
#[derive(Debug, Default)]
struct Mesh {
    points: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    primitives: Vec<u32>,
}

impl Mesh {
    fn new(geometry: &Geometry, shape: u32) -> Self {
        let primitives: Vec<u32> = geometry.primitives_of(shape).collect();
        let faces: Vec<[u32; 3]> = primitives.iter().map(|&primitive| geometry.face(primitive)).collect();
        let used = || faces.iter().flatten().copied();
        let (first, end) = (used().min().unwrap_or(0), used().max().map_or(0, |last| last + 1));
        Self {
            points: (first..end).map(|vertex| geometry.vertices.get(vertex)).collect(),
            faces: faces.into_iter().map(|face| face.map(|vertex| vertex - first)).collect(),
            primitives,
        }
    }

    /// Adds some of another mesh's faces.
    fn extend(&mut self, other: &Self, counts: &[bool]) {
        let base = self.points.len() as u32;
        self.points.extend(&other.points);
        for ((face, &primitive), _) in other.faces.iter().zip(&other.primitives).zip(counts).filter(|(_, is)| **is) {
            self.faces.push(face.map(|vertex| vertex + base));
            self.primitives.push(primitive);
        }
    }
}
