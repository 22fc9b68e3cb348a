//! Bounding volume hierarchies.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::{Build, unknown, within};
use raywright::accel::bvh::build::morton::Bits;
use raywright::accel::bvh::build::split_rules::SplitRule;
use raywright::accel::bvh::build::{Builder, binned, ploc, spatial};
use raywright::accel::bvh::optimise::{Optimiser, Optimisers};
use raywright::accel::bvh::traverse::{Orders, PacketSize, Traversal};
use raywright::accel::bvh::{self, Quality};
use raywright::accel::flat;
use raywright::accel::trees;
use raywright::simd::Level;

/// `raywright.BVH`.
#[derive(FromPyObject)]
pub struct Bvh {
    builder: String,
    bins: Option<usize>,
    traversal_cost: f32,
    intersection_cost: f32,
    budget: Option<f32>,
    radius: Option<usize>,
    optimize: Option<Vec<String>>,
    traversal: String,
    orders: Option<u32>,
    bounds: String,
}

/// Tree layout and traversal.
enum TreeKind {
    /// With this number of children per node, or the best for the SIMD level.
    Wide(Option<usize>),
    Binary(Traversal),
    /// Pointer-free arrays.
    Flat(flat::FlatTraversal),
}

impl Bvh {
    /// Reads the build options; `quality` is the default of options that are not given.
    pub fn build(self, quality: &str, level: Level) -> PyResult<Build> {
        let options = self.options(quality)?;
        Ok(match self.tree(level)? {
            TreeKind::Wide(None) => Box::new(move |geometry| trees::over(geometry, &options, level)),
            TreeKind::Wide(Some(width)) => Box::new(move |geometry| trees::of_width(width, geometry, &options, level)),
            TreeKind::Flat(way) => Box::new(move |geometry| trees::flat(geometry, &options, way, level)),
            TreeKind::Binary(way) => Box::new(move |geometry| trees::binary(geometry, &options, way, level)),
        })
    }

    /// Reads the build options of the tree.
    pub fn options(&self, quality: &str) -> PyResult<bvh::Options> {
        let quality = match quality {
            "low" => Quality::FastBuild,
            "medium" => Quality::Balanced,
            "high" => Quality::FastRays,
            other => return Err(unknown("quality", other, &["low", "medium", "high"])),
        };
        Ok(bvh::Options {
            quality,
            builder: self.builder()?,
            optimisers: self.optimisers()?,
            traversal_cost: self.traversal_cost,
            intersection_cost: self.intersection_cost,
        })
    }

    fn tree(&self, level: Level) -> PyResult<TreeKind> {
        let orders = match self.orders {
            None | Some(8) => Orders::Eight,
            Some(6) => Orders::Six,
            Some(other) => return Err(PyValueError::new_err(format!("orders is {other}, expected 6 or 8"))),
        };
        Ok(match self.traversal.as_str() {
            "wide" => TreeKind::Wide(None),
            "wide4" => TreeKind::Wide(Some(4)),
            "wide8" if level.lanes() < 8 => {
                let name = level.name();
                return Err(PyValueError::new_err(format!(
                    "traversal \"wide8\" needs AVX2, and kernels run at {name}"
                )));
            }
            "wide8" => TreeKind::Wide(Some(8)),
            "stack" => TreeKind::Binary(match self.bounds.as_str() {
                "box" => Traversal::Stack(PacketSize::One),
                "oriented" => Traversal::Oriented,
                "slabs" => Traversal::Slabs,
                other => return Err(unknown("bounds", other, &["box", "oriented", "slabs"])),
            }),
            "packets4" => TreeKind::Binary(Traversal::Stack(PacketSize::Four)),
            "packets64" => TreeKind::Binary(Traversal::Stack(PacketSize::SixtyFour)),
            "flat" => TreeKind::Flat(flat::FlatTraversal::Stack),
            "stackless" => TreeKind::Flat(flat::FlatTraversal::Stackless),
            "threaded" => TreeKind::Binary(Traversal::Threaded(orders)),
            other => return Err(unknown("traversal", other, &TRAVERSALS)),
        })
    }

    fn builder(&self) -> PyResult<Builder> {
        let Self { bins, budget, radius, .. } = *self;
        within("bins", bins, 2..=binned::MAX_BINS)?;
        within("budget", budget, 0.0..=spatial::MAX_BUDGET)?;
        within("radius", radius, 1..=ploc::MAX_RADIUS)?;
        Ok(match self.builder.as_str() {
            "binned" => Builder::Binned { bins },
            "sweep" => Builder::Sweep,
            "spatial" => Builder::Spatial { bins, budget: budget.unwrap_or(spatial::BUDGET) },
            "morton" => Builder::Morton(Bits::default()),
            "ploc" => Builder::Ploc { radius: radius.unwrap_or(ploc::RADIUS) },
            "midpoint" => Builder::Halves(SplitRule::Midpoint),
            "median" => Builder::Halves(SplitRule::Median),
            "mean" => Builder::Halves(SplitRule::Mean),
            other => return Err(unknown("builder", other, &BUILDERS)),
        })
    }

    fn optimisers(&self) -> PyResult<Option<Optimisers>> {
        let Some(names) = &self.optimize else { return Ok(None) };
        let optimiser = |name: &String| match name.as_str() {
            "reinsertion" => Ok(Optimiser::Reinsertion),
            "treelet" => Ok(Optimiser::Treelet),
            other => Err(unknown("optimize", other, &["reinsertion", "treelet"])),
        };
        let optimisers = names.iter().map(optimiser).collect::<PyResult<Vec<_>>>()?;
        match Optimisers::new(optimisers) {
            Some(optimisers) => Ok(Some(optimisers)),
            None => Err(PyValueError::new_err(format!("optimize is {names:?}, expected each at most once"))),
        }
    }
}

const BUILDERS: [&str; 8] = ["binned", "sweep", "spatial", "morton", "ploc", "midpoint", "median", "mean"];

const TRAVERSALS: [&str; 9] =
    ["wide", "wide4", "wide8", "stack", "threaded", "packets4", "packets64", "flat", "stackless"];
