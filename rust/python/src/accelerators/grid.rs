//! Grids.

use pyo3::prelude::*;

use super::{Build, structure, unknown};
use raywright::accel::grid::{self, Resolution};
use raywright::accel::walk::Mailbox;
use raywright::simd::Level;

/// Resolution of a grid: along its longest side, or along each axis.
#[derive(FromPyObject)]
enum Cells {
    Longest(u32),
    Each([u32; 3]),
}

/// `raywright.accelerators.Grid`.
#[derive(FromPyObject)]
pub struct Grid {
    resolution: Option<Cells>,
    density: f32,
    mailbox: String,
}

/// `raywright.accelerators.NestedGrid`.
#[derive(FromPyObject)]
pub struct NestedGrid {
    resolution: Option<Cells>,
    density: f32,
    leaf: u32,
    depth: u32,
    mailbox: String,
}

impl Grid {
    /// Reads the build options.
    pub fn build(self, level: Level) -> PyResult<Build> {
        let options = grid::uniform::Options { resolution: resolution(self.resolution, self.density) };
        let mailbox = mailbox(&self.mailbox)?;
        Ok(structure(level, mailbox, move |input| grid::uniform::build(input, &options)))
    }
}

impl NestedGrid {
    /// Reads the build options.
    pub fn build(self, level: Level) -> PyResult<Build> {
        let Self { density, leaf, depth, .. } = self;
        let options = grid::nested::Options { resolution: resolution(self.resolution, density), density, leaf, depth };
        let mailbox = mailbox(&self.mailbox)?;
        Ok(structure(level, mailbox, move |input| grid::nested::build(input, &options)))
    }
}

fn resolution(cells: Option<Cells>, density: f32) -> Resolution {
    match cells {
        None => Resolution::Density(density),
        Some(Cells::Longest(cells)) => Resolution::Longest(cells),
        Some(Cells::Each(cells)) => Resolution::Each(cells),
    }
}

fn mailbox(name: &str) -> PyResult<Mailbox> {
    match name {
        "stamps" => Ok(Mailbox::Stamps),
        "cache" => Ok(Mailbox::Cache),
        "none" => Ok(Mailbox::None),
        other => Err(unknown("mailbox", other, &["stamps", "cache", "none"])),
    }
}
