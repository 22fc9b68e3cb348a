//! The surfaces of a scene: corners and faces of all meshes, one after the other, and other shapes among them.

mod facets;
mod front;
mod geometry_lanes;
mod instance_ray;
mod instances;
mod motion;
mod near;
mod objects;
mod per_vertex;
mod plane_point;
mod pose;
mod prototype;
mod rounding;
mod shading;
mod shape_block;
mod solids;
mod surface_block;
mod vertices;
mod watched;

pub(crate) use front::{is_front_of, scaled};
pub use instances::{BadTransform, Instances, Matrix, check_transforms};
pub use objects::Objects;
pub use prototype::Prototype;
pub use rounding::{Precision, Rounding, rounded};
pub use solids::{Enclosing, Solids};
pub use surface_block::SurfaceBlock;
pub use vertices::Vertices;
pub(crate) use watched::Watched;

use super::SurfacePoint;
use super::textures::Needs;
use facets::{Facet, Facets};
use per_vertex::PerVertex;
use raywright_accel::{BoxTree, Primitives, UserGeometry, region};
use raywright_base::math::{DVec3, Hit, Ray, Region, Vec3};
use raywright_base::parallel::{self, CHUNK};
use raywright_base::simd::ask_for;
use raywright_shapes::{Bounds, Shape, Site};
use std::ops::Range;
use std::ptr;
use std::sync::{Arc, OnceLock};

/// A triangle mesh as described by the user.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Corners.
    pub vertices: Vertices,
    /// Changes that rounding to f32 made to the vertices, or would make; zero if not measured.
    pub rounding: Rounding,
    /// Three indices into `vertices` per face.
    pub faces: Vec<[u32; 3]>,
    /// Shading normals, one per vertex.
    pub normals: Option<Vec<Vec3>>,
    /// Texture coordinates, a pair per vertex.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Colors, one per vertex.
    pub colours: Option<Vec<[f32; 3]>>,
}

impl Mesh {
    /// Removes vertex attributes that are not needed.
    pub fn with_only(mut self, needs: Needs) -> Self {
        self.uvs = self.uvs.filter(|_| needs.uv);
        self.colours = self.colours.filter(|_| needs.colours);
        self
    }
}

/// Geometry that rays can hit.
#[derive(Clone, Debug)]
pub enum Surface {
    /// Triangles.
    Mesh(Mesh),
    /// Another shape.
    Shape(Arc<dyn Shape>),
    /// Instances of a prototype.
    Instances(Instances),
}

impl Default for Surface {
    fn default() -> Self {
        Self::Mesh(Mesh::default())
    }
}

impl Surface {
    /// Removes vertex attributes that are not needed.
    pub fn with_only(self, needs: Needs) -> Self {
        match self {
            Self::Mesh(mesh) => Self::Mesh(mesh.with_only(needs)),
            other => other,
        }
    }
}

impl From<Mesh> for Surface {
    fn from(mesh: Mesh) -> Self {
        Self::Mesh(mesh)
    }
}

impl From<Arc<dyn Shape>> for Surface {
    fn from(shape: Arc<dyn Shape>) -> Self {
        Self::Shape(shape)
    }
}

impl From<Instances> for Surface {
    fn from(instances: Instances) -> Self {
        Self::Instances(instances)
    }
}

/// A range of primitives without entries in `faces`: instances, which may be many.
#[derive(Clone, Copy, Debug)]
struct Gap {
    /// First primitive, and one past the last.
    primitives: [u32; 2],
    /// Number of primitives without entry up to its end.
    before: u32,
}

/// Bound on the error of each coordinate of a point that is computed from a triangle's corners and weights.
#[inline(always)]
pub(crate) fn error_among([a, b, c]: [DVec3; 3]) -> f64 {
    // Weights carry up to 3 roundings, products and sums 3 more: 6 u of each term in all (pbrt 6.8.5 calls it γ₇).
    8.0 * f64::EPSILON * a.abs().max(b.abs()).max(c.abs()).max_element()
}

/// Marks the entry of a shape that is not a mesh.
const NO_FACE: [u32; 3] = [u32::MAX; 3];

/// All surfaces of a scene. A primitive is a face, or a shape that is not a mesh, numbered from the first shape to the
/// last.
#[derive(Debug, Default)]
pub struct Geometry {
    vertices: Vertices,
    /// Indices into `vertices`, for all shapes; [`NO_FACE`] for shapes that are not meshes.
    faces: Vec<[u32; 3]>,
    /// Ranges of primitives without entries in `faces`, in order.
    gaps: Vec<Gap>,
    /// Shapes that are not meshes; `None` if all are.
    others: Option<Arc<Objects>>,
    /// Shading normals.
    normals: PerVertex<Vec3>,
    /// Texture coordinates.
    uvs: PerVertex<[f32; 2]>,
    /// Colors.
    colours: PerVertex<[f32; 3]>,
    /// The first primitive of each shape, and the total number at the end.
    first: Vec<u32>,
    /// Per-face data of every hit, if there are few faces.
    facets: Facets,
    /// Corners of the same faces, if vertices are f64 and facets hold only f32.
    few_corners: Vec<[DVec3; 3]>,
    dropped: usize,
    /// The rounding of the mesh that changes most.
    rounding: Rounding,
    /// Bounds of everything, computed on first use.
    region: OnceLock<Region>,
    /// Box trees for nearest-point queries over shapes that are not meshes, and over everything; built on first use.
    near_others: OnceLock<BoxTree>,
    near_all: OnceLock<BoxTree>,
}

/// Twice the area of a triangle along its unit normal, by the winding.
#[inline(always)]
fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// The unit normal of a triangle; NaN for one without area.
#[inline(always)]
fn unit_normal(corners: [DVec3; 3]) -> DVec3 {
    let n = area_vector(corners);
    // Scaling by the largest component first keeps the squares of tiny and huge triangles in range.
    let n = n / n.abs().max_element();
    n / n.length()
}

impl Primitives for Geometry {
    fn count(&self) -> usize {
        self.first[self.first.len() - 1] as usize
    }

    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        let [a, b, c] = self.corners(primitive);
        if a.is_finite() && b.is_finite() && c.is_finite() {
            return Some(Bounds { min: a.min(b).min(c), max: a.max(b).max(c) });
        }
        self.others.as_ref()?.bounds(primitive)
    }

    #[inline]
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        let face = self.face(primitive);
        if face == NO_FACE {
            return [DVec3::NAN; 3];
        }
        // Branching on the precision once keeps the corners in registers.
        match &self.vertices {
            Vertices::Single(v) => face.map(|i| v[i as usize].as_dvec3()),
            Vertices::Double(v) => face.map(|i| v[i as usize]),
        }
    }

    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        self.others.clone().map(|others| others as _)
    }

    fn region(&self) -> Region {
        // Computed outside the lock: a thread that waits for others may take up their tasks, and those may call this
        // function.
        let region = self.region.get().copied().unwrap_or_else(|| region(self.count(), &|p| self.bounds(p)));
        let _ = self.region.set(region);
        region
    }

    fn is_single(&self) -> bool {
        matches!(self.vertices, Vertices::Single(_))
    }
}

impl Geometry {
    /// Return whether f32 may not hold the products of two lengths, also where a triangle is a thousandth of the scene.
    pub fn is_extreme(&self) -> bool {
        let size = self.region().radius;
        // Infinite planes tell no size.
        size > 0.0 && size.is_finite() && !(1e-14..1e16).contains(&size)
    }

    /// Joins surfaces; their index becomes the shape number.
    ///
    /// # Panics
    /// If a face names a vertex that its mesh lacks, an attribute has not one value per vertex, or there are 2³¹
    /// primitives or 2³² vertices in all.
    pub fn new<S: Into<Surface>>(surfaces: impl IntoIterator<Item = S>) -> Self {
        let mut all = Self { first: vec![0], ..Self::default() };
        let mut others = Objects::default();
        for surface in surfaces {
            let mesh = match surface.into() {
                Surface::Mesh(mesh) => mesh,
                Surface::Shape(shape) => {
                    let number = all.count() as u32;
                    others.push(number, shape);
                    all.faces.push(NO_FACE);
                    all.first.push(number + 1);
                    continue;
                }
                Surface::Instances(instances) => {
                    let number = all.count();
                    let end = number + instances.count();
                    assert!(end < 1 << 31, "fewer than 2^31 primitives");
                    let before = all.gaps.last().map_or(0, |gap| gap.before) + instances.count() as u32;
                    all.gaps.push(Gap { primitives: [number as u32, end as u32], before });
                    others.push_instances(number as u32, instances);
                    all.first.push(end as u32);
                    continue;
                }
            };
            let base = u32::try_from(all.vertices.len()).expect("fewer than 2^32 vertices");
            let end = mesh.vertices.len() as u32;
            let has_all = |count: Option<usize>| count.is_none_or(|n| n == end as usize);
            assert!(
                has_all(mesh.normals.as_ref().map(Vec::len))
                    && has_all(mesh.uvs.as_ref().map(Vec::len))
                    && has_all(mesh.colours.as_ref().map(Vec::len)),
                "a value for each vertex"
            );
            all.normals.extend(base, mesh.normals);
            all.uvs.extend(base, mesh.uvs);
            all.colours.extend(base, mesh.colours);
            all.rounding = all.rounding.worst(mesh.rounding);
            all.vertices = std::mem::take(&mut all.vertices).joined(mesh.vertices.shortened());
            let number = all.count() + mesh.faces.len();
            let names_own = |face: &[u32; 3]| face.iter().all(|&v| v < end);
            let all_own = parallel::map_chunks(mesh.faces.len(), CHUNK, |some| mesh.faces[some].iter().all(names_own));
            assert!(!all_own.contains(&false), "a face names a vertex that its mesh has");
            if all.faces.is_empty() && base == 0 {
                // The first mesh is moved, not copied: it may be large and the only one.
                all.faces = mesh.faces;
            } else {
                all.faces.extend(mesh.faces.into_iter().map(|face| face.map(|v| v + base)));
            }
            assert!(number < 1 << 31, "fewer than 2^31 primitives");
            all.first.push(number as u32);
        }
        all.shrink_to_fit();
        all.others = (!others.is_empty()).then(|| Arc::new(others));
        let is_finite = |v: u32| all.vertices.get(v).is_finite();
        let is_dropped = |face: &&[u32; 3]| **face != NO_FACE && !face.iter().all(|&v| is_finite(v));
        let dropped = |some: Range<usize>| all.faces[some].iter().filter(is_dropped).count();
        all.dropped = parallel::map_chunks(all.faces.len(), CHUNK, dropped).into_iter().sum();
        // Instances may be many, and each should take little memory, so a geometry with instances has no facets.
        let faces = if all.gaps.is_empty() { all.count() } else { 0 };
        all.facets = Facets::new(faces, |primitive| all.facet(primitive));
        if matches!(all.vertices, Vertices::Double(_)) && !all.facets.is_empty() {
            all.few_corners = (0..faces as u32).map(|primitive| all.corners(primitive)).collect();
        }
        all
    }

    /// Computes the facet of a primitive.
    fn facet(&self, primitive: u32) -> Facet {
        let corners = match &self.vertices {
            Vertices::Single(_) => self.corners(primitive).map(|corner| corner.as_vec3()),
            Vertices::Double(_) => [Vec3::NAN; 3],
        };
        Facet { normal: self.computed_normal(primitive), corners, shape: self.located(primitive).0 }
    }

    /// Frees unused capacity.
    fn shrink_to_fit(&mut self) {
        self.vertices.shrink_to_fit();
        self.faces.shrink_to_fit();
        self.first.shrink_to_fit();
        self.normals.shrink_to_fit();
        self.uvs.shrink_to_fit();
        self.colours.shrink_to_fit();
    }

    /// Shape number of the first shape that is not a mesh.
    pub fn first_other(&self) -> Option<u32> {
        self.others.as_ref()?.first().map(|first| self.locate(first).0)
    }

    /// Returns whether any mesh has vertices.
    pub(crate) fn has_vertices(&self) -> bool {
        !self.vertices.is_empty()
    }

    /// Number of shapes.
    pub fn shapes(&self) -> usize {
        self.first.len() - 1
    }

    /// Number of faces with a NaN or infinite corner; rays never hit them.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Changes that rounding to f32 made to vertices, or would make, for the mesh with the greatest loss.
    pub fn rounding(&self) -> Rounding {
        self.rounding
    }

    /// The vertex indices of a primitive.
    #[inline]
    fn face(&self, primitive: u32) -> [u32; 3] {
        if self.gaps.is_empty() {
            return self.faces[primitive as usize];
        }
        let behind = self.gaps.partition_point(|gap| gap.primitives[1] <= primitive);
        if self.gaps.get(behind).is_some_and(|gap| gap.primitives[0] <= primitive) {
            return NO_FACE;
        }
        let before = if behind == 0 { 0 } else { self.gaps[behind - 1].before };
        self.faces[(primitive - before) as usize]
    }

    /// Returns whether any mesh has shading normals.
    pub fn is_smooth(&self) -> bool {
        !self.normals.is_empty()
    }

    /// Returns whether a primitive has shading normals.
    pub fn has_normal_at(&self, primitive: u32) -> bool {
        self.is_smooth() && self.normals_of(primitive).is_some()
    }

    /// Returns whether a shape is a mesh with shading normals.
    pub fn has_normals(&self, shape: u32) -> bool {
        self.is_smooth() && self.primitives_of(shape).any(|primitive| self.normals_of(primitive).is_some())
    }

    /// Returns whether there are instances of prototypes.
    pub fn has_instances(&self) -> bool {
        self.others.as_ref().is_some_and(|others| others.has_instances())
    }

    /// The instances of a shape, if it is instances.
    #[inline]
    pub fn instances_of(&self, shape: u32) -> Option<&Instances> {
        self.others.as_ref()?.instance(self.first[shape as usize]).map(|(instances, _)| instances)
    }

    /// Returns whether anything moves while the shutter is open.
    pub fn moves(&self) -> bool {
        self.others.as_ref().is_some_and(|others| others.moves())
    }

    /// Memory in bytes, including unused capacity.
    pub fn bytes(&self) -> usize {
        self.bytes_but(&mut Vec::new())
    }

    /// Memory in bytes, excluding prototypes in `seen`; prototypes found here are added to it.
    pub fn bytes_but(&self, seen: &mut Vec<*const Prototype>) -> usize {
        self.vertices.bytes()
            + self.normals.bytes()
            + self.uvs.bytes()
            + self.colours.bytes()
            + self.faces.capacity() * size_of::<[u32; 3]>()
            + self.first.capacity() * size_of::<u32>()
            + self.gaps.capacity() * size_of::<Gap>()
            + self.facets.bytes()
            + size_of_val(self.few_corners.as_slice())
            + [&self.near_others, &self.near_all]
                .iter()
                .filter_map(|tree| tree.get())
                .map(BoxTree::bytes)
                .sum::<usize>()
            + self.others.as_ref().map_or(0, |others| others.bytes(seen))
    }

    /// Prefetches the data of a primitive. The second call, with `corners`, loads the corners through the indices that
    /// the first call fetched. With facets, all data is in cache.
    #[inline]
    pub fn expect(&self, primitive: u32, corners: bool) {
        if !self.facets.is_empty() || !self.gaps.is_empty() {
            return;
        }
        let Some(face) = self.faces.get(primitive as usize) else { return };
        if !corners {
            return ask_for(ptr::from_ref(face).cast());
        }
        for &vertex in face {
            match &self.vertices {
                Vertices::Single(v) => {
                    v.get(vertex as usize).map_or((), |vertex| ask_for(ptr::from_ref(vertex).cast()))
                }
                Vertices::Double(v) => {
                    v.get(vertex as usize).map_or((), |vertex| ask_for(ptr::from_ref(vertex).cast()))
                }
            }
        }
    }

    /// Shape number of a primitive, and its index within the shape.
    #[inline]
    pub fn locate(&self, primitive: u32) -> (u32, u32) {
        match self.facets.get(primitive) {
            Some(facet) => (facet.shape, primitive - self.first[facet.shape as usize]),
            None => self.located(primitive),
        }
    }

    #[inline(always)]
    fn located(&self, primitive: u32) -> (u32, u32) {
        if self.shapes() == 1 {
            return (0, primitive);
        }
        // The last shape that starts at or before the primitive; empty shapes before it start there too.
        let shape = self.first.partition_point(|&f| f <= primitive) - 1;
        (shape as u32, primitive - self.first[shape])
    }

    /// Range of primitive numbers of a shape.
    pub fn primitives_of(&self, shape: u32) -> std::ops::Range<u32> {
        self.first[shape as usize]..self.first[shape as usize + 1]
    }

    /// The instances that a primitive belongs to, and its number among them, if it is an instance.
    #[inline]
    pub fn instance(&self, primitive: u32) -> Option<(&Instances, u32)> {
        self.others.as_ref()?.instance(primitive)
    }

    /// Transforms a ray into the space where the shape of a primitive was described: the world's, or a prototype's for
    /// the primitive with flattened number `inner` of an instance. Equal `t` are the same points. Returns `None` at a
    /// time when a transform has no inverse.
    pub fn entered(&self, ray: &Ray, primitive: u32, inner: u32) -> Option<Ray> {
        let Some((instances, number)) = self.instance(primitive) else { return Some(*ray) };
        let (within, inner) = instances.prototype().split(inner);
        instances.prototype().geometry().entered(&instances.pose(number, ray.time)?.enter(ray), within, inner)
    }

    /// A representative of the whole object: the first primitive of the same shape, or of the same shape in the same
    /// instance.
    pub fn first_alike(&self, primitive: u32, inner: u32) -> (u32, u32) {
        match self.instance(primitive) {
            Some((instances, _)) => (primitive, instances.prototype().first_alike(inner)),
            None => (self.first[self.locate(primitive).0 as usize], 0),
        }
    }

    /// The shape of a primitive that is not a triangle.
    #[inline]
    pub fn shape(&self, primitive: u32) -> Option<&dyn Shape> {
        self.others.as_ref()?.get(primitive)
    }

    /// Area of a primitive; not finite if rays cannot hit it or it is unbounded.
    pub fn area(&self, primitive: u32) -> f64 {
        match self.shape(primitive) {
            Some(shape) => shape.area(),
            None => 0.5 * self.area_vector(primitive).length(),
        }
    }

    /// Point of a triangle with barycentric coordinates `uv` for its second and third corner.
    pub fn position(&self, primitive: u32, uv: [f64; 2]) -> DVec3 {
        let [a, b, c] = self.corners(primitive);
        a * (1.0 - uv[0] - uv[1]) + b * uv[0] + c * uv[1]
    }

    /// Bound on the error of each coordinate of a point on a triangle, as [`SurfacePoint::error`].
    pub fn error(&self, primitive: u32) -> f64 {
        error_among(self.corners(primitive))
    }

    /// Twice the area of a triangle along its unit normal, by the winding, to within f64 roundings.
    pub fn area_vector(&self, primitive: u32) -> DVec3 {
        area_vector(self.corners(primitive))
    }

    /// The unit normal of a triangle; NaN for one without area.
    pub fn normal(&self, primitive: u32) -> DVec3 {
        self.facets.get(primitive).map_or_else(|| self.computed_normal(primitive), |facet| facet.normal)
    }

    #[inline(always)]
    fn computed_normal(&self, primitive: u32) -> DVec3 {
        unit_normal(self.corners(primitive))
    }

    /// The surface point of a hit.
    ///
    /// # Panics
    /// If it is a miss.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let Some(others) = &self.others else { return self.on_triangle(hit.primitive, hit.uv) };
        if let Some((instances, instance)) = others.instance(hit.primitive) {
            let point = instances.surface(instance, ray, hit);
            return SurfacePoint { shape: self.locate(hit.primitive).0, inner: Some(hit.inner), ..point };
        }
        match others.get(hit.primitive) {
            Some(shape) => self.on_shape(hit.primitive, &shape.site(ray, hit.t, hit.uv)),
            None => self.on_triangle(hit.primitive, hit.uv),
        }
    }

    /// The surface point at a site of a shape.
    pub fn on_shape(&self, primitive: u32, site: &Site) -> SurfacePoint {
        let Site { position, error, normal } = *site;
        SurfacePoint { position, error, normal, shading_normal: normal, shape: self.locate(primitive).0, inner: None }
    }

    /// The surface point of a triangle at barycentric coordinates.
    pub fn on_triangle(&self, primitive: u32, uv: [f64; 2]) -> SurfacePoint {
        let [a, b, c] = self.corners(primitive);
        let weights = [1.0 - uv[0] - uv[1], uv[0], uv[1]];
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        let error = error_among([a, b, c]);
        let (normal, shape) = match self.facets.get(primitive) {
            Some(facet) => (facet.normal, facet.shape),
            None => (self.computed_normal(primitive), self.located(primitive).0),
        };
        let shading_normal = self.shading_normal(primitive, weights, normal);
        SurfacePoint { position, error, normal, shading_normal, shape, inner: None }
    }

    /// Shading normals of a triangle's corners, if it has any.
    fn normals_of(&self, primitive: u32) -> Option<[DVec3; 3]> {
        self.normals.of(self.face(primitive)).map(|corners| corners.map(Vec3::as_dvec3))
    }

    /// Texture coordinates of a triangle's corners, if it has any.
    fn uvs_of(&self, primitive: u32) -> Option<[[f32; 2]; 3]> {
        // NaN marks missing coordinates.
        self.uvs.of(self.face(primitive)).filter(|corners| !corners.as_flattened().iter().any(|x| x.is_nan()))
    }

    /// Colors of a triangle's corners, if it has any.
    fn colours_of(&self, primitive: u32) -> Option<[[f32; 3]; 3]> {
        self.colours.of(self.face(primitive))
    }

    /// The interpolated vertex normal on the side of `normal`; `normal` itself if there is none.
    fn shading_normal(&self, primitive: u32, weights: [f64; 3], normal: DVec3) -> DVec3 {
        let Some([i, j, k]) = self.normals_of(primitive) else { return normal };
        match (i * weights[0] + j * weights[1] + k * weights[2]).try_normalize() {
            Some(n) if n.dot(normal) < 0.0 => -n,
            Some(n) => n,
            None => normal,
        }
    }
}
