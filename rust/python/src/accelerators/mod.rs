//! Accelerator descriptions of the Python package: one dataclass per kind, read by attribute.

mod bvh;
mod grid;
mod space;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::fmt::Display;
use std::ops::RangeInclusive;

use super::level;
use raywright::accel::bvh::Options;
use raywright::accel::walk::{Built, Input, Mailbox};
use raywright::accel::{Accelerator, BruteForce, Primitives, walked};
use raywright::simd::Level;

/// Builds an accelerator in the current thread pool.
pub type Build = Box<dyn FnOnce(&dyn Primitives) -> Box<dyn Accelerator> + Send>;

/// Reads an accelerator by the name of its class; `quality` sets the build effort.
pub fn read(choice: &Bound<'_, PyAny>, quality: &str) -> PyResult<Build> {
    let (name, level) = (choice.get_type().name()?, level()?);
    match name.to_str()? {
        "BVH" => choice.extract::<bvh::Bvh>()?.build(quality, level),
        "Grid" => choice.extract::<grid::Grid>()?.build(level),
        "NestedGrid" => choice.extract::<grid::NestedGrid>()?.build(level),
        "KdTree" => choice.extract::<space::KdTree>()?.build(level),
        "Octree" => choice.extract::<space::Octree>()?.build(level),
        "BSP" => choice.extract::<space::Bsp>()?.build(level),
        "BruteForce" => Ok(Box::new(move |geometry| BruteForce::over(geometry, level))),
        other => Err(PyTypeError::new_err(format!("accelerator is a {other}, expected one of raywright's"))),
    }
}

/// Build options of a binary tree if the accelerator is one, otherwise the defaults.
pub fn tree_options(choice: &Bound<'_, PyAny>, quality: &str) -> PyResult<Options> {
    match choice.get_type().name()?.to_str()? {
        "BVH" => choice.extract::<bvh::Bvh>()?.options(quality),
        _ => Ok(Options::DEFAULT),
    }
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
