//! Floor 3: scenes and their compilation for ray tracing.

pub mod cameras;
mod compiled;
mod coverage;
mod description;
mod emission;
mod filter;
mod first_hits;
mod interaction;
// For the tests of dependent crates; unused code is not linked.
#[doc(hidden)]
pub mod fixtures;
mod geometry;
pub mod lights;
mod lone_shapes;
mod lookup_context;
pub mod materials;
pub mod media;
mod nested_shapes;
mod opacity;
mod patches;
mod pixel_bounds;
mod plan;
mod ray_origin;
mod shading;
mod surface_interaction;
mod surface_lanes;
mod surface_point;
pub mod textures;
pub mod topology;

pub use cameras::{Camera, CameraConnection, CameraError, CameraRay, CameraRayLanes, Perspective};
pub use compiled::Scene;
pub use coverage::{ConeFilter, Coverage, Covering};
pub use description::{DescriptionError, SceneDescription, Shape};
pub use emission::{Emission, Sides};
pub use filter::Filter;
pub use first_hits::FirstHits;
pub use geometry::SurfaceBlock;
pub use geometry::{
    BadTransform, Enclosing, Geometry, Instances, Matrix, Mesh, Objects, Precision, Prototype, Rounding, Solids,
    Surface, Vertices, check_transforms, rounded,
};
pub use interaction::Interaction;
pub use lights::SeenTriangle;
pub use lights::{
    Aim, ConstantEnvironment, DirectionalLight, EmissionDensity, EmissionNumbers, EmissionPdf, EmissionSample,
    Emitters, EnvironmentMap, Light, LightBounds, LightSample, LightSampleContext, Lights, Picture, Place,
    PointEmission, PointLight, Profile, Projector, Reach, Source, SpotLight, SunSky, Waved,
};
pub use lights::{LightBlock, ReceiverBlock};
pub use lone_shapes::LoneShapes;
pub use lookup_context::LookupContext;
pub use materials::{DiffuseMaterial, Material};
pub use opacity::opacity_at;
pub use patches::{Cell, Patches};
pub use plan::{Plan, PlanRow, SceneNeeds};
pub use ray_origin::RayOrigin;
pub use shading::{Footprint, ShadingPoint};
pub use surface_interaction::fading;
pub use surface_interaction::{SurfaceInteraction, SurfaceInteractionLanes};
pub use surface_lanes::SurfaceLanes;
pub use surface_point::SurfacePoint;
