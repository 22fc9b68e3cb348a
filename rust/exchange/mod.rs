//! Floor 4: diffuse exchange between surfaces.

mod view_factors;

pub use view_factors::{Aim, Facet, Matrix, Quadrature, Sampled, Sparse, areas, matrix, pair, sparse};
