//! Medium descriptions of the Python package, read by attribute.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use super::grid_blocks::{GridBlocks, Kept};
use super::kinds::{Kinds, Read};
use super::spectra::{self, Meaning};
use raywright::optics::spectra::{Role, Smooth, Spectrum};
use raywright::optics::{HenyeyGreenstein, Phase, Rgb};
use raywright::scene::media::{
    At, Blocks, Coefficients, Field, Glow, GridMedium, Homogeneous, Medium, Values, WavedGrid, WavedMedium,
};

/// Attributes of all media.
#[derive(FromPyObject)]
struct PyMedium<'py> {
    absorption: Bound<'py, PyAny>,
    scattering: Bound<'py, PyAny>,
    phase: Bound<'py, PyAny>,
}

/// The parts of all media, read.
struct MediumParts {
    absorbs: Tinted,
    scatters: Tinted,
    phase: Phase,
}

/// Reads a medium; spectral if the flag is set.
type ReadMedium = fn(&Bound<'_, PyAny>, bool, MediumParts) -> PyResult<Arc<dyn Medium>>;

static KINDS: Kinds<ReadMedium> = Kinds::new(
    "medium must be a raywright medium",
    &[("media.homogeneous", "Homogeneous", homogeneous), ("media.grid", "GridMedium", grid)],
);

/// Reads a medium; spectral if `waves`.
///
/// # Errors
/// A `TypeError` if it is not a medium, a `ValueError` if it is invalid.
pub fn read(given: &Bound<'_, PyAny>, waves: bool) -> PyResult<Arc<dyn Medium>> {
    let read = KINDS.reader(given)?;
    let PyMedium { absorption, scattering, phase } = given.extract()?;
    let absorbs = tint(&absorption, Meaning::Amount, waves)?;
    let scatters = tint(&scattering, Meaning::Amount, waves)?;
    read(given, waves, MediumParts { absorbs, scatters, phase: read_phase(&phase)? })
}

/// A medium that is the same everywhere.
fn homogeneous(given: &Bound<'_, PyAny>, waves: bool, parts: MediumParts) -> PyResult<Arc<dyn Medium>> {
    let MediumParts { absorbs, scatters, phase } = parts;
    let emission = tint(&given.getattr("emission")?, Meaning::Light, waves)?;
    let medium = Homogeneous::new(absorbs.1, scatters.1, emission.1, phase);
    let medium = Arc::new(medium.ok_or_else(|| PyValueError::new_err("a medium must be finite and not negative"))?);
    Ok(if waves { Arc::new(WavedMedium::new(medium, [absorbs, scatters], Some(emission))) } else { medium })
}

/// A spectrum, used only if spectral, and the RGB color that represents it.
fn tint(told: &Bound<'_, PyAny>, meaning: Meaning, waves: bool) -> PyResult<Tinted> {
    if waves { spectra::tint(told, meaning) } else { Ok((flat(), Rgb::from_array(told.extract()?))) }
}

fn flat() -> Arc<Spectrum> {
    Arc::new(Spectrum::Smooth(Smooth::of(Rgb::ONE, Role::Amount)))
}

/// A spectrum, and the RGB color that represents it.
type Tinted = (Arc<Spectrum>, Rgb);

/// A medium on a grid.
fn grid(given: &Bound<'_, PyAny>, waves: bool, parts: MediumParts) -> PyResult<Arc<dyn Medium>> {
    let MediumParts { absorbs, scatters, phase } = parts;
    let told = [absorbs, scatters];
    let at = match given.getattr("at")?.extract::<String>()?.as_str() {
        "centers" => At::Centres,
        _ => At::Corners,
    };
    let some = |name: &'static str| -> PyResult<Option<Field>> {
        let numbers = given.getattr(name)?;
        (!numbers.is_none()).then(|| field(name, &numbers, at)).transpose()
    };
    let density = field("density", &given.getattr("density")?, at)?;
    let albedo = some("albedo")?;
    let light = given.getattr("emission")?;
    let has_grid = light.hasattr("shape")?;
    let glow = match some("temperature")? {
        Some(Field::Grey(kelvin)) => Some(Glow::Heat { kelvin, brightness: given.getattr("brightness")?.extract()? }),
        Some(Field::Coloured(_)) => return Err(PyValueError::new_err("temperature must have one number a point")),
        None if has_grid => Some(Glow::Radiance(field("emission", &light, at)?)),
        None => None,
    };
    let shines = if has_grid { None } else { Some(tint(&light, Meaning::Light, waves)?) };
    let emission = shines.as_ref().map_or(Rgb::ZERO, |shines| shines.1);
    let matrix = given.call_method0("_place")?.extract()?;
    let told = match albedo {
        None => told,
        // With an albedo grid, the extinction replaces the absorption.
        Some(_) => [tint(&given.getattr("extinction")?, Meaning::Amount, waves)?, (flat(), Rgb::ZERO)],
    };
    let is_heat = matches!(glow, Some(Glow::Heat { .. }));
    let is_apart = density.is_coloured() || albedo.is_some() || is_heat;
    let of = |why: String| PyValueError::new_err(format!("medium {why}"));
    if waves && is_apart {
        let one = |colour: Rgb| if colour.is_black() { Rgb::ZERO } else { Rgb::ONE };
        let [absorbs, scatters] = told;
        let coefficients = Coefficients { extinction: Rgb::ONE, scattering: one(scatters.1), emission: one(emission) };
        let grid = GridMedium::new(density, albedo, glow, coefficients, phase, matrix).map_err(of)?;
        return Ok(Arc::new(WavedGrid::new(grid, [absorbs, scatters], shines.map(|shines| shines.0))));
    }
    let coefficients = Coefficients::new(told[0].1, told[1].1, emission);
    let medium = Arc::new(GridMedium::new(density, albedo, glow, coefficients, phase, matrix).map_err(of)?);
    Ok(if waves { Arc::new(WavedMedium::new(medium, told, shines)) } else { medium })
}

/// The numbers of a grid: an array, (X, Y, Z) or (X, Y, Z, 3), or blocks held by the package.
fn field(name: &str, given: &Bound<'_, PyAny>, at: At) -> PyResult<Field> {
    if let Ok(blocks) = given.getattr("_blocks") {
        let blocks = blocks.cast_into::<GridBlocks>()?;
        return Ok(match &blocks.get().0 {
            Kept::Grey(blocks) => Field::Grey(Values::new(blocks.clone(), at)),
            Kept::Coloured(blocks) => Field::Coloured(Values::new(blocks.clone(), at)),
        });
    }
    let array: PyReadonlyArrayDyn<'_, f32> = given.extract()?;
    let numbers = array.as_slice().map_err(|_| PyValueError::new_err(format!("{name} must be C-contiguous")))?;
    let of = |why: String| PyValueError::new_err(format!("{name} {why}"));
    match *array.shape() {
        [x, y, z] => {
            let blocks = Blocks::new([x, y, z], numbers.as_chunks::<1>().0).map_err(of)?;
            Ok(Field::Grey(Values::new(Arc::new(blocks), at)))
        }
        [x, y, z, 3] => {
            let blocks = Blocks::new([x, y, z], numbers.as_chunks::<3>().0).map_err(of)?;
            Ok(Field::Coloured(Values::new(Arc::new(blocks), at)))
        }
        _ => Err(PyValueError::new_err(format!("{name} must have shape (X, Y, Z) or (X, Y, Z, 3)"))),
    }
}

static PHASES: Kinds<Read<Phase>> = Kinds::new(
    "phase must be a raywright phase function",
    &[
        ("media.phases", "Isotropic", |_| Ok(Phase::Isotropic)),
        ("media.phases", "Rayleigh", |_| Ok(Phase::Rayleigh)),
        ("media.phases", "HenyeyGreenstein", |of| {
            let by = HenyeyGreenstein::new(of.getattr("g")?.extract()?);
            by.map(Phase::HenyeyGreenstein).ok_or_else(|| PyValueError::new_err("g must be between -1 and 1"))
        }),
    ],
);

/// Reads a phase function.
fn read_phase(given: &Bound<'_, PyAny>) -> PyResult<Phase> {
    PHASES.reader(given)?(given)
}
