//! Rays to hits: every accelerator gives the same answers, and these are the exact ones.

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
