//! Floor 3: what a scene is made of, compiled for rays.

mod camera;
mod compiled;
mod description;
#[cfg(test)]
pub(crate) mod fixtures;
mod geometry;
mod interaction;
mod light;
mod lights;
mod material;
mod spawn;

pub use camera::{Camera, CameraError};
pub use compiled::Scene;
pub use description::{DescriptionError, SceneDescription, Shape};
pub use geometry::{Geometry, Mesh, SurfacePoint, Vertices};
pub use interaction::{Interaction, Scattered};
pub use light::{LightSample, PointLight};
pub use lights::Lights;
pub use material::Material;
pub use spawn::Departure;
