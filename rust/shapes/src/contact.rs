//! Intersection candidates and their kind of contact.

/// An intersection of a ray with a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The parameter along the query's direction; of triangles along the scaled one.
    pub t: f64,
    /// Coordinates on the primitive; of a triangle the barycentric weights of the second and third corners.
    pub uv: [f64; 2],
    /// The kind of contact.
    pub contact: Contact,
    /// The primitive within an instance; 0 for other primitives.
    pub inner: u32,
}

/// The kind of contact between a ray and a primitive.
///
/// A ray through a shared edge or corner meets all triangles there. Symbolic perturbation decides which of them it
/// crosses: the ray is moved by an infinitesimal amount along one fixed direction (Edelsbrunner and Mücke, "Simulation
/// of Simplicity", 1990). The perturbed ray passes through no edge exactly unless it lies in the triangle's plane. It
/// enters a closed surface as often as it leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// In the interior.
    Inside,
    /// Exactly on an edge or corner; the perturbed ray crosses the primitive.
    Crossing,
    /// Exactly on an edge or corner, and the perturbed ray misses; or tangent to a curved shape.
    Touching,
}
