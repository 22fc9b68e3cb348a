//! The surfaces of a scene: every mesh's corners and faces, one after the other, and shapes among them.

mod facets;
mod front;
mod instance_ray;
mod instances;
mod lanes;
mod motion;
mod near;
mod objects;
mod per_vertex;
mod plane_point;
mod pose;
mod prototype;
mod rounding;
mod shading;
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

/// One triangle mesh as it is described.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Corners.
    pub vertices: Vertices,
    /// What rounding them to f32 did to the mesh, or would have done; nothing where nobody looked.
    pub rounding: Rounding,
    /// Three indices into `vertices` a face.
    pub faces: Vec<[u32; 3]>,
    /// Shading normals, one a vertex.
    pub normals: Option<Vec<Vec3>>,
    /// Texture coordinates, a pair a vertex.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Colours, one a vertex.
    pub colours: Option<Vec<[f32; 3]>>,
}

impl Mesh {
    /// The mesh without what nobody asks of its vertices.
    pub fn with_only(mut self, needs: Needs) -> Self {
        self.uvs = self.uvs.filter(|_| needs.uv);
        self.colours = self.colours.filter(|_| needs.colours);
        self
    }
}

/// What rays can hit.
#[derive(Clone, Debug)]
pub enum Surface {
    /// Triangles.
    Mesh(Mesh),
    /// Anything else.
    Shape(Arc<dyn Shape>),
    /// Other surfaces, put to many places.
    Instances(Instances),
}

impl Default for Surface {
    fn default() -> Self {
        Self::Mesh(Mesh::default())
    }
}

impl Surface {
    /// The surface without what nobody asks of it.
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

/// Primitives that have no entry among the faces: instances, which are many.
#[derive(Clone, Copy, Debug)]
struct Gap {
    /// The first of them, and the first after them.
    primitives: [u32; 2],
    /// How many primitives before its end have no entry.
    before: u32,
}

/// Bound on the error of each coordinate of a point that is computed from a triangle's corners and weights.
#[inline(always)]
pub(crate) fn error_among([a, b, c]: [DVec3; 3]) -> f64 {
    // Weights carry up to 3 roundings, products and sums 3 more: 6 u of each term in all (pbrt 6.8.5 calls it γ₇).
    8.0 * f64::EPSILON * a.abs().max(b.abs()).max(c.abs()).max_element()
}

/// The face that stands for a shape that is no mesh.
const NO_FACE: [u32; 3] = [u32::MAX; 3];

/// All surfaces of a scene in one: a primitive is a face, or a shape that is no mesh, numbered through from the first
/// shape to the last.
#[derive(Debug, Default)]
pub struct Geometry {
    vertices: Vertices,
    /// Indices into `vertices`, for all shapes; [`NO_FACE`] for what is no mesh.
    faces: Vec<[u32; 3]>,
    /// Where primitives have no entry in `faces`, by their numbers.
    gaps: Vec<Gap>,
    /// What is no mesh; none if all are.
    others: Option<Arc<Objects>>,
    /// Shading normals.
    normals: PerVertex<Vec3>,
    /// Texture coordinates.
    uvs: PerVertex<[f32; 2]>,
    /// Colours.
    colours: PerVertex<[f32; 3]>,
    /// The first primitive of each shape, and the number of all at the end.
    first: Vec<u32>,
    /// What is asked of a face at every hit, where there are few.
    facets: Facets,
    /// Corners of the same faces, if vertices have more digits than facets hold.
    few_corners: Vec<[DVec3; 3]>,
    dropped: usize,
    /// Of the mesh that it does most to.
    rounding: Rounding,
    /// Where all of it lies, once that was asked.
    region: OnceLock<Region>,
    /// What is no mesh, and all of it, by how far it is, once that was asked.
    near_others: OnceLock<BoxTree>,
    near_all: OnceLock<BoxTree>,
}

/// Twice the area of a triangle along its unit normal, as the winding gives it.
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
        // Which floats they are is asked once, so that the corners need not pass through memory.
        match &self.vertices {
            Vertices::Single(v) => face.map(|i| v[i as usize].as_dvec3()),
            Vertices::Double(v) => face.map(|i| v[i as usize]),
        }
    }

    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        self.others.clone().map(|others| others as _)
    }

    fn region(&self) -> Region {
        // Not within the lock: threads that wait for others take up work of theirs, which may come here too.
        let region = self.region.get().copied().unwrap_or_else(|| region(self.count(), &|p| self.bounds(p)));
        let _ = self.region.set(region);
        region
    }

    fn is_single(&self) -> bool {
        matches!(self.vertices, Vertices::Single(_))
    }
}

impl Geometry {
    /// Joins surfaces; the index of one becomes its shape number.
    ///
    /// # Panics
    /// If a face names a vertex that its mesh does not have, there is not a value for each vertex, or there are 2³¹
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
                // The only mesh of many scenes, which may be large.
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
        // Instances are many, and each shall be small.
        let faces = if all.gaps.is_empty() { all.count() } else { 0 };
        all.facets = Facets::new(faces, |primitive| all.facet(primitive));
        if matches!(all.vertices, Vertices::Double(_)) && !all.facets.is_empty() {
            all.few_corners = (0..faces as u32).map(|primitive| all.corners(primitive)).collect();
        }
        all
    }

    /// What is kept of a face where there are few.
    fn facet(&self, primitive: u32) -> Facet {
        let corners = match &self.vertices {
            Vertices::Single(_) => self.corners(primitive).map(|corner| corner.as_vec3()),
            Vertices::Double(_) => [Vec3::NAN; 3],
        };
        Facet { normal: self.computed_normal(primitive), corners, shape: self.located(primitive).0 }
    }

    /// Gives memory back that was reserved for more.
    fn shrink_to_fit(&mut self) {
        self.vertices.shrink_to_fit();
        self.faces.shrink_to_fit();
        self.first.shrink_to_fit();
        self.normals.shrink_to_fit();
        self.uvs.shrink_to_fit();
        self.colours.shrink_to_fit();
    }

    /// The first shape that is no mesh, by its number among shapes.
    pub fn first_other(&self) -> Option<u32> {
        self.others.as_ref()?.first().map(|first| self.locate(first).0)
    }

    /// Whether there is a mesh that has vertices.
    pub(crate) fn has_vertices(&self) -> bool {
        !self.vertices.is_empty()
    }

    /// How many shapes there are.
    pub fn shapes(&self) -> usize {
        self.first.len() - 1
    }

    /// How many faces have a corner that is NaN or infinite: no ray can hit them.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// What rounding to f32 did to vertices, or would have done: of the mesh to which that is most.
    pub fn rounding(&self) -> Rounding {
        self.rounding
    }

    /// The corners of a primitive's face.
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

    /// Whether a mesh among them has shading normals.
    pub fn is_smooth(&self) -> bool {
        !self.normals.is_empty()
    }

    /// Whether a shape is a mesh that has shading normals.
    pub fn has_normals(&self, shape: u32) -> bool {
        self.is_smooth() && self.primitives_of(shape).any(|primitive| self.normals_of(primitive).is_some())
    }

    /// Whether there are instances of prototypes.
    pub fn has_instances(&self) -> bool {
        self.others.as_ref().is_some_and(|others| others.has_instances())
    }

    /// The instances that a shape is, if it is.
    #[inline]
    pub fn instances_of(&self, shape: u32) -> Option<&Instances> {
        self.others.as_ref()?.instance(self.first[shape as usize]).map(|(instances, _)| instances)
    }

    /// Whether anything moves while the shutter is open.
    pub fn moves(&self) -> bool {
        self.others.as_ref().is_some_and(|others| others.moves())
    }

    /// The memory held, what is reserved for more included.
    pub fn bytes(&self) -> usize {
        self.bytes_but(&mut Vec::new())
    }

    /// The memory held, without prototypes that were `seen`; those in it count as seen from then on.
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

    /// Says that a primitive will be asked about, and, if its `corners` are wanted, that this was said before: what is
    /// kept of it is fetched meanwhile. Of few primitives all is at hand.
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

    /// Which shape a primitive belongs to, and its index there.
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

    /// The primitives of a shape, as numbered among all.
    pub fn primitives_of(&self, shape: u32) -> std::ops::Range<u32> {
        self.first[shape as usize]..self.first[shape as usize + 1]
    }

    /// Which instance of what a primitive is, if it is one.
    #[inline]
    pub fn instance(&self, primitive: u32) -> Option<(&Instances, u32)> {
        self.others.as_ref()?.instance(primitive)
    }

    /// A ray in the space in which the shape was described that a primitive belongs to, and of an instance the
    /// primitive in it of a flattened number: the world's, or that of a prototype. The same `t` are the same points.
    /// None at a moment when there is no such place.
    pub fn entered(&self, ray: &Ray, primitive: u32, inner: u32) -> Option<Ray> {
        let Some((instances, number)) = self.instance(primitive) else { return Some(*ray) };
        let (within, inner) = instances.prototype().split(inner);
        instances.prototype().geometry().entered(&instances.pose(number, ray.time)?.enter(ray), within, inner)
    }

    /// The first primitive of the same shape, and of an instance of the same shape in the same copy: what stands for
    /// the whole.
    pub fn first_alike(&self, primitive: u32, inner: u32) -> (u32, u32) {
        match self.instance(primitive) {
            Some((instances, _)) => (primitive, instances.prototype().first_alike(inner)),
            None => (self.first[self.locate(primitive).0 as usize], 0),
        }
    }

    /// A primitive that is no triangle.
    #[inline]
    pub fn shape(&self, primitive: u32) -> Option<&dyn Shape> {
        self.others.as_ref()?.get(primitive)
    }

    /// The area of a primitive; no finite number if nothing can hit it, or it has no end.
    pub fn area(&self, primitive: u32) -> f64 {
        match self.shape(primitive) {
            Some(shape) => shape.area(),
            None => 0.5 * self.area_vector(primitive).length(),
        }
    }

    /// The point of a triangle with weights `uv` for its second and third corner.
    pub fn position(&self, primitive: u32, uv: [f64; 2]) -> DVec3 {
        let [a, b, c] = self.corners(primitive);
        a * (1.0 - uv[0] - uv[1]) + b * uv[0] + c * uv[1]
    }

    /// Bound on the error of each coordinate of a point of a triangle, as [`SurfacePoint::error`].
    pub fn error(&self, primitive: u32) -> f64 {
        error_among(self.corners(primitive))
    }

    /// Twice the area of a triangle along its unit normal, as the winding gives it. Exact but for the f64 roundings.
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

    /// All that shading needs at a hit of a ray.
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

    /// A point of a shape, as shading needs it.
    pub fn on_shape(&self, primitive: u32, site: &Site) -> SurfacePoint {
        let Site { position, error, normal } = *site;
        SurfacePoint { position, error, normal, shading_normal: normal, shape: self.locate(primitive).0, inner: None }
    }

    /// A point of a triangle, as shading needs it.
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

    /// The shading normals of a triangle's corners, if there are any.
    fn normals_of(&self, primitive: u32) -> Option<[DVec3; 3]> {
        self.normals.of(self.face(primitive)).map(|corners| corners.map(Vec3::as_dvec3))
    }

    /// The texture coordinates of a triangle's corners, if there are any.
    fn uvs_of(&self, primitive: u32) -> Option<[[f32; 2]; 3]> {
        // Those that are NaN are none.
        self.uvs.of(self.face(primitive)).filter(|corners| !corners.as_flattened().iter().any(|x| x.is_nan()))
    }

    /// The colours of a triangle's corners, if there are any.
    fn colours_of(&self, primitive: u32) -> Option<[[f32; 3]; 3]> {
        self.colours.of(self.face(primitive))
    }

    /// The interpolated normal of the vertices, on the side of `normal`; `normal` where there is none to be had.
    fn shading_normal(&self, primitive: u32, weights: [f64; 3], normal: DVec3) -> DVec3 {
        let Some([i, j, k]) = self.normals_of(primitive) else { return normal };
        match (i * weights[0] + j * weights[1] + k * weights[2]).try_normalize() {
            Some(n) if n.dot(normal) < 0.0 => -n,
            Some(n) => n,
            None => normal,
        }
    }
}
