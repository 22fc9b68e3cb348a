//! Floor 1: geometric shapes and their exact intersection with rays.

mod closest_on_revolution;
mod closest_points;
mod cone;
mod contact;
mod cuboid;
mod cylinder;
mod disk;
mod ellipsoid;
#[cfg(test)]
mod exact_hits;
mod flat;
mod gap;
mod implicit;
mod line;
mod meeting;
mod newton;
#[cfg(test)]
mod oracle;
pub mod oriented_box;
mod paraboloid;
mod placed;
mod plane;
mod polygon;
mod revolution;
mod shape;
mod solid;
mod sphere;
#[cfg(test)]
mod surfaces;
mod torus;
pub mod triangle;

pub use closest_points::Closest;
pub use contact::{Candidate, Contact};
pub use cuboid::Cuboid;
pub use disk::Disk;
pub use ellipsoid::Ellipsoid;
pub use flat::Flat;
pub use gap::gap_under;
pub use implicit::Implicit;
pub use line::{Carried, Line};
pub use placed::Placed;
pub use plane::Plane;
pub use polygon::{Polygon, triangulate};
pub use revolution::Revolution;
pub use shape::{Ball, Bounds, Drawn, Point, Seen, Shape, Site};
pub use sphere::Sphere;
pub use torus::Torus;
