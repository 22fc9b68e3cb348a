//! Lights as the package describes them: a dataclass a kind, read by attribute; and how surfaces shine.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::Arc;

use super::arrays::vectors;
use super::textures::Textures;
use crate::math::DVec3;
use crate::optics::Rgb;

use crate::scene::{
    ConstantEnvironment, DirectionalLight, Emission, EnvironmentMap, Light, Picture, PointLight, Profile, Projector,
    Sides, SpotLight, SunSky,
};

/// `raywright.PointLight`.
#[derive(FromPyObject)]
struct PyPoint {
    position: [f64; 3],
    intensity: [f64; 3],
}

/// `raywright.SpotLight`.
#[derive(FromPyObject)]
struct PySpot {
    position: [f64; 3],
    target: [f64; 3],
    intensity: [f64; 3],
    angle: f64,
    falloff: f64,
    profile: String,
}

/// `raywright.DirectionalLight`.
#[derive(FromPyObject)]
struct PyDirectional {
    direction: [f64; 3],
    irradiance: [f64; 3],
}

/// `raywright.ProjectorLight`.
#[derive(FromPyObject)]
struct PyProjector<'py> {
    image: PyReadonlyArrayDyn<'py, f32>,
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov: f64,
    intensity: [f64; 3],
}

/// `raywright.ConstantEnvironment`.
#[derive(FromPyObject)]
struct PyConstant {
    radiance: [f64; 3],
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

/// Reads a light, or an environment, by the name of its class.
pub fn read(light: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Light>> {
    let (vector, rgb) = (DVec3::from_array, Rgb::from_array);
    let name = light.get_type().name()?;
    Ok(match name.to_str()? {
        "PointLight" => {
            let PyPoint { position, intensity } = light.extract()?;
            Arc::new(PointLight { position: vector(position), intensity: rgb(intensity) })
        }
        "SpotLight" => {
            let PySpot { position, target, intensity, angle, falloff, profile } = light.extract()?;
            let position = vector(position);
            let (angle, falloff) = (angle.to_radians(), falloff.to_radians());
            let spot = SpotLight::new(position, vector(target) - position, rgb(intensity), angle, falloff);
            Arc::new(spot.with_profile(if profile == "linear" { Profile::Linear } else { Profile::Smooth }))
        }
        "DirectionalLight" => {
            let PyDirectional { direction, irradiance } = light.extract()?;
            Arc::new(DirectionalLight::new(vector(direction), rgb(irradiance)))
        }
        "ProjectorLight" => {
            let PyProjector { image, position, target, up, fov, intensity } = light.extract()?;
            let places = [position, target, up].map(vector);
            let projector = Projector::new(picture(&image)?, places, fov.to_radians(), rgb(intensity));
            Arc::new(projector.map_err(PyValueError::new_err)?)
        }
        "ConstantEnvironment" => {
            let PyConstant { radiance } = light.extract()?;
            Arc::new(ConstantEnvironment { radiance: rgb(radiance) })
        }
        "EnvironmentMap" => {
            let PyMap { image, to_world, scale } = light.extract()?;
            let rows = vectors::<f64, 3>("to_world", &to_world)?;
            let &[x, y, z] = rows else {
                return Err(PyValueError::new_err(format!("to_world has {} rows, expected 3", rows.len())));
            };
            Arc::new(EnvironmentMap::new(picture(&image)?, [x, y, z].map(vector), scale))
        }
        "SunSky" => {
            let PySunSky { sun, turbidity, ground_albedo, up, sun_scale, sky_scale } = light.extract()?;
            let ways = [sun, up].map(vector);
            Arc::new(SunSky::new(ways, turbidity, rgb(ground_albedo), [sun_scale, sky_scale]))
        }
        other => return Err(PyTypeError::new_err(format!("expected a raywright light, got {other}"))),
    })
}

/// What surrounds a scene: nothing, one environment, or a tuple of them.
pub fn read_environment(environment: Option<Bound<'_, PyAny>>) -> PyResult<Vec<Arc<dyn Light>>> {
    match environment {
        None => Ok(Vec::new()),
        Some(several) if several.is_instance_of::<PyTuple>() => {
            several.cast::<PyTuple>()?.iter().map(|one| read(&one)).collect()
        }
        Some(one) => Ok(vec![read(&one)?]),
    }
}

/// How a shape shines: a radiance, or a `raywright.Emission`.
pub fn read_emission(emission: &Bound<'_, PyAny>, textures: &Textures) -> PyResult<Emission> {
    if emission.get_type().name()?.to_str()? != "Emission" {
        return Ok(Emission { radiance: textures.value(emission)?, ..Emission::default() });
    }
    let PyEmission { radiance, side } = emission.extract()?;
    let sides = match side.as_str() {
        "back" => Sides::Back,
        "both" => Sides::Both,
        _ => Sides::Front,
    };
    Ok(Emission { radiance: textures.value(&radiance)?, sides })
}

/// An (H, W, 3) array as a picture.
fn picture(image: &PyReadonlyArrayDyn<'_, f32>) -> PyResult<Arc<Picture>> {
    let texels = vectors::<f32, 3>("image", image)?;
    let width = image.as_array().shape().get(1).copied().unwrap_or(0);
    Picture::new(width, texels.to_vec()).map(Arc::new).map_err(PyValueError::new_err)
}
