//! Camera descriptions of the Python package, read by attribute, and camera rays.

use numpy::{Element, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Numbers, Row, unwritten, vectors};
use super::kinds::Kinds;
use super::rays::{answer, share};
use raywright::math::DVec3;
use raywright::scene::cameras::{
    Aperture, Body, Camera, CameraError, Fisheye, Mapping, Measured, Orthographic, Panorama, Perspective, ThinLens,
    Viewpoint, Window,
};

/// Reads a camera from its description and the common parts.
type ReadCamera = fn(&Bound<'_, PyAny>, Body) -> PyResult<Box<dyn Camera>>;

static KINDS: Kinds<ReadCamera> = Kinds::new(
    "camera must be a raywright camera",
    &[
        ("cameras.perspective", "Camera", perspective),
        ("cameras.thin_lens", "ThinLens", thin_lens),
        ("cameras.orthographic", "Orthographic", orthographic),
        ("cameras.fisheye", "Fisheye", fisheye),
        ("cameras.panorama", "Panorama", panorama),
    ],
);

/// Any camera, read from its attributes.
pub struct AnyCamera(pub Box<dyn Camera>);

/// `raywright.Pose`.
#[derive(FromPyObject)]
struct Pose {
    position: [f64; 3],
    target: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    up: [f64; 3],
}

/// Attributes of all cameras.
#[derive(FromPyObject)]
struct Common {
    width: u32,
    height: u32,
    shutter: [f64; 2],
    end_pose: Option<Pose>,
}

impl FromPyObject<'_, '_> for AnyCamera {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let read = KINDS.reader(&object)?;
        let (common, pose): (Common, Pose) = (object.extract()?, object.extract()?);
        let mut body =
            Body::new(pose.viewpoint()?, common.width, common.height).and_then(|b| b.with_shutter(common.shutter));
        if let Some(end) = common.end_pose {
            let end = end.viewpoint()?;
            body = body.map(|body| body.moved_to(end));
        }
        Ok(Self(read(&object, body.map_err(refused)?)?))
    }
}

impl Pose {
    fn viewpoint(self) -> PyResult<Viewpoint> {
        let [position, up] = [self.position, self.up].map(DVec3::from_array);
        match (self.target, self.direction) {
            (Some(target), None) => Viewpoint::look_at(position, DVec3::from_array(target), up),
            (None, Some(direction)) => Viewpoint::towards(position, DVec3::from_array(direction), up),
            _ => return Err(PyValueError::new_err("a camera must have either a target or a direction")),
        }
        .map_err(refused)
    }
}

fn refused(error: CameraError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn made<C: Camera + 'static>(camera: Result<C, CameraError>) -> PyResult<Box<dyn Camera>> {
    camera.map(|camera| Box::new(camera) as Box<dyn Camera>).map_err(refused)
}

/// The axis of an angle of view or a scale.
struct Axis(Measured);

impl FromPyObject<'_, '_> for Axis {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        Ok(Self(match object.extract::<&str>()? {
            "x" => Measured::Width,
            "y" => Measured::Height,
            "smaller" => Measured::Smaller,
            "larger" => Measured::Larger,
            "diagonal" => Measured::Diagonal,
            other => {
                return Err(PyValueError::new_err(format!(
                    "axis is {other:?}, expected \"x\", \"y\", \"larger\", \"smaller\" or \"diagonal\""
                )));
            }
        }))
    }
}

/// `raywright.Camera`.
#[derive(FromPyObject)]
struct PyPerspective {
    fov: Option<f64>,
    fov_axis: Axis,
    focal_length_px: Option<[f64; 2]>,
    principal_point: Option<[f64; 2]>,
    skew: f64,
}

fn perspective(camera: &Bound<'_, PyAny>, body: Body) -> PyResult<Box<dyn Camera>> {
    let PyPerspective { fov, fov_axis, focal_length_px, principal_point, skew } = camera.extract()?;
    let size = body.size();
    let window = match (fov, focal_length_px) {
        (None, Some(focal_length_px)) => {
            Window::of_matrix(focal_length_px, principal_point.unwrap_or(size.map(|n| 0.5 * n)), skew, size)
        }
        (Some(fov), None) => of_view((fov, fov_axis), principal_point, size),
        _ => return Err(PyValueError::new_err("a camera must have either fov or focal_length_px")),
    };
    made(window.map(|window| Perspective::new(body, window)))
}

/// Creates a window from an angle of view and the film position of the view's center.
fn of_view(
    (fov, along): (f64, Axis),
    principal_point: Option<[f64; 2]>,
    size: [f64; 2],
) -> Result<Window, CameraError> {
    let centred = Window::of_view(fov, along.0, size)?;
    principal_point.map_or(Ok(centred), |principal_point| centred.seen_from(principal_point, size))
}

/// `raywright.ThinLens`.
#[derive(FromPyObject)]
struct PyThinLens {
    #[pyo3(attribute("_view"))]
    view: (f64, Axis),
    lens_radius: f64,
    focused_distance: f64,
    blades: u32,
    blade_rotation: f64,
    principal_point: Option<[f64; 2]>,
}

fn thin_lens(camera: &Bound<'_, PyAny>, body: Body) -> PyResult<Box<dyn Camera>> {
    let lens: PyThinLens = camera.extract()?;
    let window = of_view(lens.view, lens.principal_point, body.size()).map_err(refused)?;
    let aperture = Aperture::new(lens.lens_radius, lens.blades, lens.blade_rotation.to_radians()).map_err(refused)?;
    made(ThinLens::new(body, window, aperture, lens.focused_distance))
}

/// `raywright.Orthographic`.
#[derive(FromPyObject)]
struct PyOrthographic {
    scale: f64,
    scale_axis: Axis,
}

fn orthographic(camera: &Bound<'_, PyAny>, body: Body) -> PyResult<Box<dyn Camera>> {
    let PyOrthographic { scale, scale_axis } = camera.extract()?;
    made(Orthographic::new(body, scale, scale_axis.0))
}

/// `raywright.Fisheye`.
#[derive(FromPyObject)]
struct PyFisheye {
    fov: f64,
    fov_axis: Axis,
    mapping: String,
}

fn fisheye(camera: &Bound<'_, PyAny>, body: Body) -> PyResult<Box<dyn Camera>> {
    let PyFisheye { fov, fov_axis, mapping } = camera.extract()?;
    let mapping = match mapping.as_str() {
        "equidistant" => Mapping::Equidistant,
        "equisolid" => Mapping::Equisolid,
        "stereographic" => Mapping::Stereographic,
        "orthographic" => Mapping::Orthographic,
        other => return Err(PyValueError::new_err(format!("fisheye mapping {other:?} is unknown"))),
    };
    made(Fisheye::new(body, fov, mapping, fov_axis.0))
}

fn panorama(_: &Bound<'_, PyAny>, body: Body) -> PyResult<Box<dyn Camera>> {
    Ok(Box::new(Panorama::new(body)))
}

/// Origins and directions, of one array type.
type CameraRays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Film points, lens points and times, each one for all rays or one per ray.
struct FilmPoints<'a> {
    film: &'a [[f64; 2]],
    /// Width of the picture if film points are relative to the upper left of each pixel.
    pixels: Option<usize>,
    lens: &'a [[f64; 2]],
    time: &'a [f64],
}

impl FilmPoints<'_> {
    fn check(&self, count: usize) -> PyResult<()> {
        let lengths = [("points", self.film.len()), ("lens", self.lens.len()), ("time", self.time.len())];
        match lengths.into_iter().find(|&(_, n)| n != 1 && n != count) {
            Some((name, n)) => Err(PyValueError::new_err(format!("{name} are {n}, expected 1 or {count}"))),
            None => Ok(()),
        }
    }

    /// Generates rays of either type on all threads.
    fn rays<'py, T: Element + Send>(
        &self,
        py: Python<'py>,
        camera: &dyn Camera,
        lead: &[usize],
    ) -> PyResult<CameraRays<'py>>
    where
        [T; 3]: Row,
    {
        let count = lead.iter().product();
        self.check(count)?;
        let (origins, directions) = (unwritten::<T>(py, lead, Some(3))?, unwritten::<T>(py, lead, Some(3))?);
        {
            let (mut origins, mut directions) = (origins.readwrite(), directions.readwrite());
            let parts = (origins.as_slice_mut()?.as_chunks_mut().0, directions.as_slice_mut()?.as_chunks_mut().0);
            answer(py, count, share(count), None, parts, |start, (origins, directions)| {
                // Pixel position of the ray; counted, because a division takes as long as the ray.
                let width = self.pixels.unwrap_or(usize::MAX);
                let (mut column, mut row) = if self.pixels.is_some() { (start % width, start / width) } else { (0, 0) };
                for (i, (origin, direction)) in (start..).zip(origins.iter_mut().zip(directions)) {
                    let [x, y] = of(self.film, i);
                    let film = [column as f64 + x, row as f64 + y];
                    if self.pixels.is_some() {
                        column += 1;
                        if column == width {
                            (column, row) = (0, row + 1);
                        }
                    }
                    let ray = camera.ray(film, of(self.lens, i), of(self.time, i)).ray;
                    (*origin, *direction) = (Row::of(ray.origin), Row::of(ray.direction));
                }
            })?;
        }
        Ok((origins.into_any(), directions.into_any()))
    }
}

/// The value of ray `i`: its own, or one for all.
#[inline(always)]
fn of<T: Copy>(all: &[T], i: usize) -> T {
    if all.len() == 1 { all[0] } else { all[i] }
}

/// Origins and directions (H,W,3) through the pixels, as float32 if `single`, else float64; row 0 is the top. `offsets`
/// are positions in the pixel, `lens` points of the lens, and `time` times of the shutter: one for all, or one per ray.
#[pyfunction]
pub fn camera_rays<'py>(
    py: Python<'py>,
    camera: AnyCamera,
    offsets: PyReadonlyArrayDyn<'py, f64>,
    single: bool,
    lens: PyReadonlyArrayDyn<'py, f64>,
    time: Numbers<'py>,
) -> PyResult<CameraRays<'py>> {
    let camera = &*camera.0;
    let lead = [camera.height() as usize, camera.width() as usize];
    let points = FilmPoints {
        film: vectors("offsets", &offsets)?,
        pixels: Some(lead[1]),
        lens: vectors("lens", &lens)?,
        time: time.slice("time")?,
    };
    if single { points.rays::<f32>(py, camera, &lead) } else { points.rays::<f64>(py, camera, &lead) }
}

/// Origins and directions (N,3) through `points` (N,2) of the film, in pixels from its left and top. `lens` and `time`
/// are one for all, or one per ray.
#[pyfunction]
pub fn camera_rays_through<'py>(
    py: Python<'py>,
    camera: AnyCamera,
    points: PyReadonlyArrayDyn<'py, f64>,
    lens: PyReadonlyArrayDyn<'py, f64>,
    time: Numbers<'py>,
) -> PyResult<CameraRays<'py>> {
    let film = vectors("points", &points)?;
    let points = FilmPoints { film, pixels: None, lens: vectors("lens", &lens)?, time: time.slice("time")? };
    points.rays::<f64>(py, &*camera.0, &[film.len()])
}
