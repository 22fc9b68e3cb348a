//! Light descriptions of the Python package, one dataclass per kind, read by attribute; and emission of surfaces.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::Arc;

use super::arrays::vectors;
use super::kinds::{Class, Kinds};
use super::spectra::{self, Meaning};
use super::textures::Textures;
use raywright::math::DVec3;
use raywright::optics::Rgb;
use raywright::scene::{
    ConstantEnvironment, DirectionalLight, Emission, EnvironmentMap, Light, Picture, PointLight, Profile, Projector,
    Sides, SpotLight, SunSky, Waved,
};

/// `raywright.PointLight`.
#[derive(FromPyObject)]
struct PyPoint<'py> {
    position: [f64; 3],
    intensity: Bound<'py, PyAny>,
}

/// `raywright.SpotLight`.
#[derive(FromPyObject)]
struct PySpot<'py> {
    position: [f64; 3],
    target: [f64; 3],
    intensity: Bound<'py, PyAny>,
    angle: f64,
    falloff: f64,
    profile: String,
}

/// `raywright.DirectionalLight`.
#[derive(FromPyObject)]
struct PyDirectional<'py> {
    direction: [f64; 3],
    irradiance: Bound<'py, PyAny>,
}

/// `raywright.ProjectorLight`.
#[derive(FromPyObject)]
struct PyProjector<'py> {
    image: PyReadonlyArrayDyn<'py, f32>,
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov: f64,
    intensity: Bound<'py, PyAny>,
}

/// `raywright.ConstantEnvironment`.
#[derive(FromPyObject)]
struct PyConstant<'py> {
    radiance: Bound<'py, PyAny>,
}

/// `raywright.EnvironmentMap`.
#[derive(FromPyObject)]
struct PyMap<'py> {
    image: PyReadonlyArrayDyn<'py, f32>,
    to_world: PyReadonlyArrayDyn<'py, f64>,
    scale: f64,
}

/// `raywright.SunSky`.
#[derive(FromPyObject)]
struct PySunSky {
    sun: [f64; 3],
    turbidity: f64,
    ground_albedo: [f64; 3],
    up: [f64; 3],
    sun_scale: f64,
    sky_scale: f64,
}

/// `raywright.Emission`.
#[derive(FromPyObject)]
struct PyEmission<'py> {
    radiance: Bound<'py, PyAny>,
    side: String,
}

/// Reads a light or an environment; spectral if the flag is set.
type ReadLight = fn(&Bound<'_, PyAny>, bool) -> PyResult<Arc<dyn Light>>;

static KINDS: Kinds<ReadLight> = Kinds::new(
    "expected a raywright light",
    &[
        ("lights.point", "PointLight", |light, waves| {
            let PyPoint { position, intensity } = light.extract()?;
            let position = vector(position);
            shining(&intensity, waves, false, |intensity| Ok(Arc::new(PointLight { position, intensity })))
        }),
        ("lights.spot", "SpotLight", |light, waves| {
            let PySpot { position, target, intensity, angle, falloff, profile } = light.extract()?;
            let position = vector(position);
            let (angle, falloff) = (angle.to_radians(), falloff.to_radians());
            let profile = if profile == "linear" { Profile::Linear } else { Profile::Smooth };
            shining(&intensity, waves, false, |intensity| {
                let spot = SpotLight::new(position, vector(target) - position, intensity, angle, falloff);
                Ok(Arc::new(spot.with_profile(profile)))
            })
        }),
        ("lights.directional", "DirectionalLight", |light, waves| {
            let PyDirectional { direction, irradiance } = light.extract()?;
            let new = |irradiance| -> PyResult<Arc<dyn Light>> {
                Ok(Arc::new(DirectionalLight::new(vector(direction), irradiance)))
            };
            shining(&irradiance, waves, false, new)
        }),
        ("lights.projector", "ProjectorLight", |light, waves| {
            let PyProjector { image, position, target, up, fov, intensity } = light.extract()?;
            let places = [position, target, up].map(vector);
            let image = picture(&image)?;
            shining(&intensity, waves, true, |intensity| {
                let projector = Projector::new(image, places, fov.to_radians(), intensity);
                Ok(Arc::new(projector.map_err(PyValueError::new_err)?))
            })
        }),
        ("lights.constant", "ConstantEnvironment", |light, waves| {
            let PyConstant { radiance } = light.extract()?;
            shining(&radiance, waves, false, |radiance| Ok(Arc::new(ConstantEnvironment { radiance })))
        }),
        ("lights.environment_map", "EnvironmentMap", |light, waves| {
            let PyMap { image, to_world, scale } = light.extract()?;
            let rows = vectors::<f64, 3>("to_world", &to_world)?;
            let &[x, y, z] = rows else {
                return Err(PyValueError::new_err(format!("to_world has {} rows, expected 3", rows.len())));
            };
            Ok(coloured(EnvironmentMap::new(picture(&image)?, [x, y, z].map(vector), scale), waves))
        }),
        ("lights.sun_sky", "SunSky", |light, waves| {
            let PySunSky { sun, turbidity, ground_albedo, up, sun_scale, sky_scale } = light.extract()?;
            let (ways, ground) = ([sun, up].map(vector), Rgb::from_array(ground_albedo));
            Ok(coloured(SunSky::new(ways, turbidity, ground, [sun_scale, sky_scale]), waves))
        }),
    ],
);

/// Reads a light or an environment; spectral if `waves`.
pub fn read(light: &Bound<'_, PyAny>, waves: bool) -> PyResult<Arc<dyn Light>> {
    KINDS.reader(light)?(light, waves)
}

fn vector(row: [f64; 3]) -> DVec3 {
    DVec3::from_array(row)
}

/// A light with its RGB colors or, if `waves`, with their smooth spectra.
fn coloured(light: impl Light + 'static, waves: bool) -> Arc<dyn Light> {
    let light = Arc::new(light);
    if waves { Arc::new(Waved::coloured(light)) } else { light }
}

/// A light scaled by three numbers or a `raywright.Spectrum`; `has_colours` tells whether it has colors besides.
fn shining(
    given: &Bound<'_, PyAny>,
    waves: bool,
    has_colours: bool,
    make: impl FnOnce(Rgb) -> PyResult<Arc<dyn Light>>,
) -> PyResult<Arc<dyn Light>> {
    if let Ok(colour) = given.extract::<[f64; 3]>() {
        let colour = Rgb::from_array(colour);
        let is_grey = colour == Rgb::splat(colour[0]);
        // Negative and NaN values are reported elsewhere.
        if !waves || has_colours || is_grey || !colour.is_radiance() {
            let light = make(colour)?;
            return Ok(if waves && has_colours { Arc::new(Waved::coloured(light)) } else { light });
        }
    }
    let tint = spectra::tint(given, Meaning::Light)?;
    Ok(Arc::new(Waved::tinted(tint, has_colours, |mean| make(Rgb::splat(mean)))?))
}

/// Reads the environment: none, one, or a tuple of several.
pub fn read_environment(environment: Option<Bound<'_, PyAny>>, waves: bool) -> PyResult<Vec<Arc<dyn Light>>> {
    match environment {
        None => Ok(Vec::new()),
        Some(several) if several.is_instance_of::<PyTuple>() => {
            several.cast::<PyTuple>()?.iter().map(|one| read(&one, waves)).collect()
        }
        Some(one) => Ok(vec![read(&one, waves)?]),
    }
}

static EMISSION: Class = Class::new("lights.emission", "Emission");

/// Reads the emission of a shape: a radiance, or a `raywright.Emission`.
pub fn read_emission(emission: &Bound<'_, PyAny>, textures: &Textures) -> PyResult<Emission> {
    if !EMISSION.has(emission)? {
        return Ok(Emission { radiance: textures.value(emission, Meaning::Light)?, ..Emission::default() });
    }
    let PyEmission { radiance, side } = emission.extract()?;
    let sides = match side.as_str() {
        "back" => Sides::Back,
        "both" => Sides::Both,
        _ => Sides::Front,
    };
    Ok(Emission { radiance: textures.value(&radiance, Meaning::Light)?, sides })
}

/// An (H, W, 3) array as a picture.
fn picture(image: &PyReadonlyArrayDyn<'_, f32>) -> PyResult<Arc<Picture>> {
    let texels = vectors::<f32, 3>("image", image)?;
    let width = image.as_array().shape().get(1).copied().unwrap_or(0);
    Picture::new(width, texels.to_vec()).map(Arc::new).map_err(PyValueError::new_err)
}
