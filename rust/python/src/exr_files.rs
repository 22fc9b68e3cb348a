//! EXR files, read by the crate of that name.

use exr::prelude::{ReadChannels, ReadLayers, read};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Numbers by name.
type Channels<'py> = Vec<(String, Bound<'py, PyArray1<f32>>)>;

/// The channels of the first part of an EXR file, from its bytes: width and height of its data, and by name the numbers
/// of each from the top row on, as f32. Whoever calls has looked at the header: this reads what it promises.
///
/// # Errors
/// A `ValueError` for what is broken, is of depths, has channels of fewer points than the picture, or is compressed by
/// a method that is not read.
#[pyfunction]
pub fn exr_channels<'py>(py: Python<'py>, data: &[u8]) -> PyResult<(usize, usize, Channels<'py>)> {
    let found = py.detach(|| {
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(std::io::Cursor::new(data))
    });
    let image = found.map_err(|error| PyValueError::new_err(error.to_string()))?;
    let (width, height) = (image.layer_data.size.0, image.layer_data.size.1);
    let channels = image.layer_data.channel_data.list.into_iter().map(|channel| {
        let name = channel.name.to_string();
        let numbers: Vec<f32> = channel.sample_data.values_as_f32().collect();
        if numbers.len() != width * height {
            return Err(PyValueError::new_err(format!("its channel {name} has fewer points than the picture")));
        }
        Ok((name, PyArray1::from_vec(py, numbers)))
    });
    Ok((width, height, channels.collect::<PyResult<_>>()?))
}
