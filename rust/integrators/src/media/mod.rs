//! Media along rays: lookup, distances to scattering events, transmittance, and reuse of paths.

mod cubic_segments;
pub(super) mod current_medium;
pub(super) mod distance_sampling;
pub(super) mod equiangular;
pub(super) mod hit_classification;
pub(super) mod optical_depth;
pub(super) mod path_numbers;
pub(super) mod path_reuse;
mod point_pairs;
pub(super) mod scattering;
pub(super) mod spectral_mis;
mod transmittance;
