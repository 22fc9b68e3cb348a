//! Floor 3: what a scene is made of, compiled for rays.

pub mod cameras;
mod caustics;
mod compiled;
mod copies;
mod description;
mod facets;
mod first_hits;
#[cfg(test)]
pub(crate) mod fixtures;
mod geometry;
mod group;
mod interaction;
pub mod lights;
mod mapped;
pub mod materials;
pub mod media;
mod motion;
mod per_vertex;
mod plan;
mod points;
mod pose;
mod rounding;
mod shading;
mod spawn;
mod surfaces;
pub mod textures;
mod vertices;
mod view;

pub use cameras::{Camera, CameraError, CameraRay, Perspective};
pub use caustics::{Aim, Caustics, is_matt};
pub use compiled::Scene;
pub use copies::{BadTransform, Copies, Matrix, check_transforms};
pub use description::{DescriptionError, SceneDescription, Shape};
pub use first_hits::FirstHits;
pub use geometry::{Geometry, Mesh, Surface, SurfacePoint};
pub use group::Group;
pub use interaction::{Interaction, Scattered, Scatters, fading};
pub use lights::{
    ConstantEnvironment, DirectionalLight, Emission, EnvironmentMap, Light, LightBounds, LightSample, Lights, Picture,
    PointLight, Profile, Projector, Reach, Receiver, SpotLight, SunSky,
};
pub use materials::{DiffuseMaterial, Material};
pub use plan::{Kernel, Plan, PlanRow, SceneNeeds};
pub use points::HitPoint;
pub use rounding::{Precision, Rounding, rounded};
pub use shading::{Footprint, ShadingPoint};
pub use spawn::Departure;
pub use surfaces::Surfaces;
pub use vertices::Vertices;
