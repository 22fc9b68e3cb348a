//! Tests of intersection: all accelerators give the same, exact hits.

mod agreement;
mod boxes;
mod builders;
mod cones;
mod kernels;
mod nearest;
mod signs;
mod space;
mod stopped;
mod traversals;
mod triangles;
mod turned;
