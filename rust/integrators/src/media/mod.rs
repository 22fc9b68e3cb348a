//! Media along rays: which one is where, the way to a scattering event, and what is left of light.

mod cubic_segments;
pub(super) mod current_medium;
pub(super) mod distance_sampling;
pub(super) mod equiangular;
pub(super) mod hit_classification;
pub(super) mod medium_traversal;
pub(super) mod optical_depth;
pub(super) mod path_numbers;
pub(super) mod path_reuse;
mod point_pairs;
pub(super) mod scattering;
pub(super) mod spectral_mis;
mod transmittance;
