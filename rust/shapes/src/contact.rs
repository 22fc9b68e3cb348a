//! Where and how a ray meets what can be hit.

/// A primitive that a ray meets.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Along the direction that was asked with: of triangles the scaled one.
    pub t: f64,
    /// Coordinates on the primitive; of a triangle the weights of the second and the third corner.
    pub uv: [f64; 2],
    /// How.
    pub contact: Contact,
    /// Of an instance, which primitive in it; 0 for what is no instance.
    pub inner: u32,
}

/// How a ray meets a primitive.
///
/// Of the triangles that share an edge or a corner, a ray through it meets all. To know which it crosses, it is moved
/// by next to nothing, along the same direction (Edelsbrunner and Mücke, "Simulation of Simplicity", 1990): then it
/// passes no edge of a triangle exactly unless it lies in the triangle's plane, and it crosses a closed surface as
/// often in as out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Strictly within.
    Inside,
    /// Exactly on an edge or a corner, and across it if moved by next to nothing.
    Crossing,
    /// Exactly on an edge or a corner, and past it if moved by next to nothing; of a curved shape, a tangent.
    Touching,
}
