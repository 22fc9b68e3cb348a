//! Optimisers of the binary tree: what a builder, which looks at one node at a time, has left to gain.

pub mod reinsertion;
mod tree;
