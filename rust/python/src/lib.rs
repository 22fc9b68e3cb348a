//! Floor 6: the bindings. They convert arrays and map errors, and hold no algorithms.

mod accelerators;
mod all_hits;
mod arrays;
mod broadcast;
mod builds;
mod cameras;
mod columns;
mod cones;
mod denoise;
mod describe;
mod exr_codecs;
mod first_hits;
mod flat;
mod freeform;
mod grid_blocks;
mod held_rows;
mod hit_parts;
mod hits;
mod info;
mod instances;
mod integrators;
mod interactions;
mod job;
mod kinds;
mod lights;
mod materials;
mod media;
mod photons;
mod points;
mod polygons;
mod preview;
mod python_integrator;
mod query;
mod radiosity;
mod random;
mod rays;
mod render;
mod report;
mod samplers;
mod shapes;
mod sight;
mod signals;
mod spawn_rays;
mod spectra;
mod text_numbers;
mod textures;
mod topology;
mod tree_boxes;
mod view_factors;
mod watcher;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use raywright::simd::Level;
use raywright::workers;

/// The SIMD level of the kernels, or a `ValueError` if the requested one is invalid.
fn level() -> PyResult<Level> {
    Level::current().map_err(PyValueError::new_err)
}

/// Return the SIMD level that kernels run at; ``RAYWRIGHT_SIMD`` forces one.
///
/// Returns
/// -------
/// str
///     "scalar", "neon", "sse2", "avx2" or "avx512".
///
/// Raises
/// ------
/// ValueError
///     If ``RAYWRIGHT_SIMD`` names no level that the processor has.
///
/// Examples
/// --------
/// >>> rw.simd() in ("scalar", "neon", "sse2", "avx2", "avx512")
/// True
#[pyfunction]
fn simd() -> PyResult<&'static str> {
    Ok(level()?.name())
}

/// The number of threads that are used where none is given.
#[pyfunction]
fn cores() -> usize {
    workers::cores()
}

// Free-threaded interpreters keep their lock off: what threads share is frozen, behind a mutex, or borrowed at
// run time, and no unsafe code relies on the lock.
#[pymodule(gil_used = false)]
mod _core {
    use pyo3::prelude::*;
    use raywright::workers;

    /// Has the interpreter's own limit respected, which `-X cpu_count` and `PYTHON_CPU_COUNT` set.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let os = module.py().import("os")?;
        // From Python 3.13 on.
        if let Some(count) = os.getattr_opt("process_cpu_count")?
            && let Some(most) = count.call0()?.extract::<Option<usize>>()?
        {
            workers::limit_cores(most);
        }
        Ok(())
    }

    #[pymodule_export]
    use super::cameras::{camera_rays, camera_rays_through};
    #[pymodule_export]
    use super::cones::{cone_coverage, cones};
    #[pymodule_export]
    use super::cores;
    #[pymodule_export]
    use super::denoise::{denoise_candidates, denoise_settle};
    #[pymodule_export]
    use super::exr_codecs::{exr_huffman, exr_integrate, exr_piz, exr_run_lengths};
    #[pymodule_export]
    use super::first_hits::first_hits;
    #[pymodule_export]
    use super::flat::FlatScene;
    #[pymodule_export]
    use super::freeform::{implicit_trouble, polygon_trouble};
    #[pymodule_export]
    use super::grid_blocks::GridBlocks;
    #[pymodule_export]
    use super::info::AcceleratorInfo;
    #[pymodule_export]
    use super::instances::singular_transform;
    #[pymodule_export]
    use super::integrators::{aovs, plan};
    #[pymodule_export]
    use super::interactions::{Interactions, interactions};
    #[pymodule_export]
    use super::job::Job;
    #[pymodule_export]
    use super::materials::{metal_index, metals};
    #[pymodule_export]
    use super::photons::photons;
    #[pymodule_export]
    use super::points::points;
    #[pymodule_export]
    use super::polygons::triangulate_polygons;
    #[pymodule_export]
    use super::preview::preview;
    #[pymodule_export]
    use super::query::CompiledScene;
    #[pymodule_export]
    use super::radiosity::RadiosityShots;
    #[pymodule_export]
    use super::random::random_numbers;
    #[cfg(feature = "timing")]
    #[pymodule_export]
    use super::render::timing;
    #[pymodule_export]
    use super::render::{Rendering, chances, pilot, student};
    #[pymodule_export]
    use super::report::KernelContest;
    #[pymodule_export]
    use super::samplers::batch_for;
    #[pymodule_export]
    use super::shapes::{matrix_trouble, shape_area, shape_bounds};
    #[pymodule_export]
    use super::sight::Sight;
    #[pymodule_export]
    use super::simd;
    #[pymodule_export]
    use super::spawn_rays::spawn_rays;
    #[pymodule_export]
    use super::spectra::{daylight_power, film_reflectance, smooth_spectrum, spectrum_luminance, spectrum_rgb};
    #[pymodule_export]
    use super::text_numbers::leading_numbers;
    #[pymodule_export]
    use super::topology::{MeshTopology, mesh_topology, sections, weld, weld_rounding};
    #[pymodule_export]
    use super::tree_boxes::tree_boxes;
    #[pymodule_export]
    use super::view_factors::{coincident_faces, view_factor_matrix, view_factor_rows};
    /// Maximum number of samples of a pilot per variant.
    #[pymodule_export]
    const PILOT: u32 = raywright::render::PILOT;
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
