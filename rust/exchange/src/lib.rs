//! Floor 4: what surfaces send each other, as numbers instead of pictures.

mod radiosity;
mod view_factors;

pub use radiosity::{Enclosure, Shots, Sides};
pub use view_factors::{
    Aim, Facet, Fronts, Matrix, Quadrature, Sampled, SharedPlane, Sparse, areas, matrix, pair, shared_planes, sparse,
};
