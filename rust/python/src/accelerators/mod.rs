//! Accelerator descriptions of the Python package: one dataclass per kind, read by attribute.

mod bvh;
mod grid;
mod space;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fmt::Display;
use std::ops::RangeInclusive;

use super::kinds::{Class, Kinds};
use super::level;
use raywright::accel::bvh::Options;
use raywright::accel::walk::{Built, Input, Mailbox};
use raywright::accel::{Accelerator, BruteForce, Primitives, walked};
use raywright::simd::Level;

/// Builds an accelerator in the current thread pool.
pub type Build = Box<dyn FnOnce(&dyn Primitives) -> Box<dyn Accelerator> + Send>;

/// Reads an accelerator, given the build effort and the level of its kernels.
type ReadAccelerator = fn(&Bound<'_, PyAny>, &str, Level) -> PyResult<Build>;

static KINDS: Kinds<ReadAccelerator> = Kinds::new(
    "accelerator must be one of raywright's",
    &[
        ("accelerators.bvh", "BVH", |of, quality, level| of.extract::<bvh::Bvh>()?.build(quality, level)),
        ("accelerators.grid", "Grid", |of, _, level| of.extract::<grid::Grid>()?.build(level)),
        ("accelerators.grid", "NestedGrid", |of, _, level| of.extract::<grid::NestedGrid>()?.build(level)),
        ("accelerators.space", "KdTree", |of, _, level| of.extract::<space::KdTree>()?.build(level)),
        ("accelerators.space", "Octree", |of, _, level| of.extract::<space::Octree>()?.build(level)),
        ("accelerators.space", "BSP", |of, _, level| of.extract::<space::Bsp>()?.build(level)),
        ("accelerators.brute", "BruteForce", |_, _, level| {
            Ok(Box::new(move |geometry| BruteForce::over(geometry, level)))
        }),
    ],
);

static BVH: Class = Class::new("accelerators.bvh", "BVH");

/// Reads an accelerator; `quality` sets the build effort.
pub fn read(choice: &Bound<'_, PyAny>, quality: &str) -> PyResult<Build> {
    KINDS.reader(choice)?(choice, quality, level()?)
}

/// Build options of a binary tree if the accelerator is one, otherwise the defaults.
pub fn tree_options(choice: &Bound<'_, PyAny>, quality: &str) -> PyResult<Options> {
    if BVH.has(choice)? { choice.extract::<bvh::Bvh>()?.options(quality) } else { Ok(Options::DEFAULT) }
}

/// Builds a structure that is traversed one ray at a time.
fn structure(level: Level, mailbox: Mailbox, build: impl Fn(&Input) -> Built + Send + 'static) -> Build {
    Box::new(move |geometry| walked(geometry, level, mailbox, &build))
}

fn unknown(name: &str, came: &str, expected: &[&str]) -> PyErr {
    PyValueError::new_err(format!("{name} is {came:?}, expected one of {}", expected.join(", ")))
}

fn within<T: PartialOrd + Display>(name: &str, came: Option<T>, range: RangeInclusive<T>) -> PyResult<()> {
    match came.filter(|came| !range.contains(came)) {
        Some(came) => {
            Err(PyValueError::new_err(format!("{name} is {came}, expected {} to {}", range.start(), range.end())))
        }
        None => Ok(()),
    }
}
