//! Floor 4: radiative exchange between surfaces, as numbers instead of pictures: view factors and radiosity.

mod radiosity;
mod view_factors;

pub use radiosity::{Enclosure, Shots, Sides};
pub use view_factors::{
    Aim, Facet, Fronts, Matrix, Quadrature, Sampled, SharedPlane, Sparse, areas, matrix, pair, shared_planes, sparse,
};
