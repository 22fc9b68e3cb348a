//! Space partitions by planes: k-d trees, octrees and BSP trees.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::{Build, structure};
use raywright::accel::kdtree::{Builder, Traversal};
use raywright::accel::walk::Mailbox;
use raywright::accel::{bsp, kdtree, octree};
use raywright::simd::Level;

/// `raywright.accelerators.KdTree`.
#[derive(FromPyObject)]
pub struct KdTree {
    builder: String,
    traversal: String,
    traversal_cost: f32,
    intersection_cost: f32,
    empty_bonus: f32,
    max_depth: Option<usize>,
    leaf_size: usize,
}

/// `raywright.accelerators.Octree`.
#[derive(FromPyObject)]
pub struct Octree {
    max_depth: usize,
    leaf_size: usize,
}

/// `raywright.accelerators.BSP`.
#[derive(FromPyObject)]
pub struct Bsp {
    candidates: usize,
    traversal_cost: f32,
    intersection_cost: f32,
    max_depth: Option<usize>,
    leaf_size: usize,
}

impl KdTree {
    /// Reads the build options.
    pub fn build(self, level: Level) -> PyResult<Build> {
        let options = self.options()?;
        Ok(structure(level, Mailbox::Stamps, move |input| kdtree::build(input, &options)))
    }

    fn options(self) -> PyResult<kdtree::Options> {
        let Self { builder, traversal, traversal_cost, intersection_cost, empty_bonus, max_depth, leaf_size } = self;
        let Some(builder) = Builder::ALL.into_iter().find(|b| b.name() == builder) else {
            return refused(format!("builder is {builder:?}, expected \"sah\", \"median\", \"middle\" or \"cycle\""));
        };
        let Some(traversal) = Traversal::ALL.into_iter().find(|t| t.name() == traversal) else {
            return refused(format!("traversal is {traversal:?}, expected \"stack\" or \"restart\""));
        };
        if !(0.0..=1.0).contains(&empty_bonus) {
            return refused(format!("empty_bonus is {empty_bonus}, expected 0 to 1"));
        }
        costs(traversal_cost, intersection_cost)?;
        limits(max_depth, kdtree::MAX_DEPTH, leaf_size)?;
        let options = kdtree::Options {
            builder,
            traversal,
            traversal_cost,
            intersection_cost,
            empty_bonus,
            max_depth,
            leaf_size,
        };
        Ok(options)
    }
}

impl Octree {
    /// Reads the build options.
    pub fn build(self, level: Level) -> PyResult<Build> {
        let options = self.options()?;
        Ok(structure(level, Mailbox::Stamps, move |input| octree::build(input, &options)))
    }

    fn options(self) -> PyResult<octree::Options> {
        let Self { max_depth, leaf_size } = self;
        limits(Some(max_depth), octree::MAX_DEPTH, leaf_size)?;
        Ok(octree::Options { max_depth, leaf_size })
    }
}

impl Bsp {
    /// Reads the build options.
    pub fn build(self, level: Level) -> PyResult<Build> {
        let options = self.options()?;
        Ok(structure(level, Mailbox::Stamps, move |input| bsp::build(input, &options)))
    }

    fn options(self) -> PyResult<bsp::Options> {
        let Self { candidates, traversal_cost, intersection_cost, max_depth, leaf_size } = self;
        let most = bsp::MAX_CANDIDATES;
        if !(1..=most).contains(&candidates) {
            return refused(format!("candidates is {candidates}, expected 1 to {most}"));
        }
        costs(traversal_cost, intersection_cost)?;
        limits(max_depth, bsp::MAX_DEPTH, leaf_size)?;
        Ok(bsp::Options { candidates, traversal_cost, intersection_cost, max_depth, leaf_size })
    }
}

fn refused<T>(why: String) -> PyResult<T> {
    Err(PyValueError::new_err(why))
}

/// Rejects costs that are not positive in single precision.
fn costs(traversal_cost: f32, intersection_cost: f32) -> PyResult<()> {
    for (name, cost) in [("traversal_cost", traversal_cost), ("intersection_cost", intersection_cost)] {
        if !(cost > 0.0 && cost.is_finite()) {
            return refused(format!("{name} is {cost} in single precision, expected a finite number greater than 0"));
        }
    }
    Ok(())
}

/// Rejects excessive depths and empty leaves.
fn limits(max_depth: Option<usize>, most: usize, leaf_size: usize) -> PyResult<()> {
    if let Some(depth) = max_depth.filter(|&depth| depth > most) {
        return refused(format!("max_depth is {depth}, expected 0 to {most}"));
    }
    if leaf_size == 0 {
        return refused("leaf_size is 0, expected at least 1".into());
    }
    Ok(())
}
