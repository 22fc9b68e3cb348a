//! Floor 3: what a scene is made of, compiled for rays.

pub mod cameras;
mod compiled;
mod copies;
mod description;
mod first_hits;
#[cfg(test)]
pub(crate) mod fixtures;
mod geometry;
mod group;
mod interaction;
mod light;
mod lights;
mod material;
mod points;
mod pose;
mod spawn;
mod surfaces;
mod view;

pub use cameras::{Camera, CameraError, CameraRay, Perspective};
pub use compiled::Scene;
pub use copies::{BadTransform, Copies, Matrix, check_transforms};
pub use description::{DescriptionError, SceneDescription, Shape};
pub use first_hits::FirstHits;
pub use geometry::{Geometry, Mesh, Surface, SurfacePoint, Vertices};
pub use group::Group;
pub use interaction::{Interaction, Scattered};
pub use light::{LightSample, PointLight};
pub use lights::Lights;
pub use material::Material;
pub use points::HitPoint;
pub use spawn::Departure;
pub use surfaces::Surfaces;
