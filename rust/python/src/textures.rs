//! Textures as the package describes them, read by attribute.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use super::spectra::{self, Meaning};
use raywright::optics::Rgb;
use raywright::optics::spectra::Role;
use raywright::scene::textures::{
    Between, Checker, Domain, Fbm, Filter, ImageTexture, Marble, MixTexture, Noise, ObjectTransform, Octaves, Pattern,
    Picture, ProductTexture, Spectral, Stripes, Texels, Texture, Upsampled, UvTransform, Value, VertexColours, Wood,
    Wrap,
};

/// What has been made of an object, which stays alive beside it so that no other can have its address.
struct Known<T> {
    _object: Py<PyAny>,
    made: T,
}

/// What has been made of objects, by their addresses: one that many share is read once.
pub struct Cache<T>(RefCell<HashMap<usize, Known<T>>>);

impl<T> Default for Cache<T> {
    fn default() -> Self {
        Self(RefCell::default())
    }
}

impl<T: Clone> Cache<T> {
    /// What has been made of an object before, or is made of it now.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn of(&self, object: &Bound<'_, PyAny>, make: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
        let address = object.as_ptr() as usize;
        if let Some(known) = self.0.borrow().get(&address) {
            return Ok(known.made.clone());
        }
        let made = make()?;
        self.0.borrow_mut().insert(address, Known { _object: object.clone().unbind(), made: made.clone() });
        Ok(made)
    }
}

/// What makes two pictures the same: where their numbers are, which channel is taken, whether it is decoded, and
/// whether there are smaller ones.
type PictureKey = (usize, Option<usize>, bool, bool);

/// Width, height, and the points of a picture: of one channel, or of three.
type Taken<T> = (usize, usize, Result<Vec<T>, Vec<[T; 3]>>);

/// Reads textures.
pub struct Textures {
    /// Whether colours are told by wavelength.
    waves: bool,
    /// By what their numbers stand for.
    textures: [Cache<Arc<dyn Texture>>; 4],
    pictures: RefCell<HashMap<PictureKey, Known<Arc<Picture>>>>,
}

/// `raywright.UvTransform` or `raywright.ObjectTransform`.
#[derive(FromPyObject)]
enum PyTransform {
    #[pyo3(transparent)]
    Uv(PyUvTransform),
    #[pyo3(transparent)]
    Object(PyObjectTransform),
}

/// `raywright.UvTransform`.
#[derive(FromPyObject)]
struct PyUvTransform {
    matrix: [[f64; 3]; 2],
}

/// `raywright.ObjectTransform`.
#[derive(FromPyObject)]
struct PyObjectTransform {
    matrix: [[f64; 4]; 3],
}

impl From<PyTransform> for Domain {
    fn from(transform: PyTransform) -> Self {
        match transform {
            PyTransform::Uv(map) => Self::Uv(UvTransform(map.matrix)),
            PyTransform::Object(map) => Self::Object(ObjectTransform(map.matrix)),
        }
    }
}

/// What all sums of noises have.
#[derive(FromPyObject)]
struct PyOctaves {
    octaves: u32,
    lacunarity: f64,
    gain: f64,
    seed: u32,
}

impl From<PyOctaves> for Octaves {
    fn from(octaves: PyOctaves) -> Self {
        let PyOctaves { octaves: count, lacunarity, gain, seed } = octaves;
        Self { count, lacunarity, gain, seed }
    }
}

/// `raywright.ImageTexture`.
#[derive(FromPyObject)]
struct PyImage<'py> {
    image: Bound<'py, PyAny>,
    channels: Vec<usize>,
    decoded: bool,
    filter: String,
    wrap: [String; 2],
    transform: PyUvTransform,
}

impl Textures {
    /// Those of a scene that needs wavelengths, or none.
    pub fn new(waves: bool) -> Self {
        Self { waves, textures: Default::default(), pictures: RefCell::default() }
    }

    /// Whether colours are told by wavelength.
    pub fn has_waves(&self) -> bool {
        self.waves
    }

    /// A number, three of them, a spectrum, or a texture.
    ///
    /// # Errors
    /// A `TypeError` for what is none of these, and what reading a texture raises.
    pub fn value(&self, given: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<Value> {
        if let Ok(number) = given.extract::<f64>() {
            return Ok(number.into());
        }
        if let Ok(colour) = given.extract::<[f64; 3]>() {
            return Ok(self.colour(Rgb::from_array(colour), meaning));
        }
        self.textures[meaning as usize].of(given, || self.read(given, meaning)).map(Value::Texture)
    }

    /// The same for what stands for no colour.
    ///
    /// # Errors
    /// As [`Textures::value`].
    pub fn plain(&self, given: &Bound<'_, PyAny>) -> PyResult<Value> {
        self.value(given, Meaning::Numbers)
    }

    /// An attribute that is a number, three of them, a spectrum, or a texture.
    ///
    /// # Errors
    /// As [`Textures::value`].
    pub fn attribute(&self, object: &Bound<'_, PyAny>, name: &str, meaning: Meaning) -> PyResult<Value> {
        self.value(&object.getattr(name)?, meaning)
    }

    /// An attribute that is a number or a texture, of whose channels the mean counts.
    ///
    /// # Errors
    /// As [`Textures::value`].
    pub fn number(&self, object: &Bound<'_, PyAny>, name: &str) -> PyResult<Value<f64>> {
        Ok(self.plain(&object.getattr(name)?)?.number())
    }

    /// What colours stand for by wavelength; none where they are told in red, green and blue.
    fn role(&self, meaning: Meaning) -> Option<Role> {
        match meaning {
            Meaning::Share if self.waves => Some(Role::Share),
            Meaning::Light | Meaning::Amount if self.waves => Some(Role::Amount),
            _ => None,
        }
    }

    fn colour(&self, colour: Rgb, meaning: Meaning) -> Value {
        match self.role(meaning) {
            Some(role) if colour.is_radiance() => Spectral::of(colour, role),
            _ => colour.into(),
        }
    }

    /// A texture that has colours of its own.
    fn coloured(&self, colours: impl Texture + 'static, meaning: Meaning) -> Arc<dyn Texture> {
        let colours = Arc::new(colours);
        match self.role(meaning) {
            Some(role) => Arc::new(Upsampled { colours, role }),
            None => colours,
        }
    }

    /// The texture of a description, by the name of its class.
    fn read(&self, given: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<Arc<dyn Texture>> {
        let name = given.get_type().name()?;
        let domain = || given.getattr("transform")?.extract::<PyTransform>().map(Domain::from);
        let octaves = || given.extract::<PyOctaves>().map(Octaves::from);
        let float = |name: &str| given.getattr(name)?.extract::<f64>();
        Ok(match name.to_str()? {
            "Checker" => self.between(given, meaning, Checker(domain()?))?,
            "Stripes" => self.between(given, meaning, Stripes { domain: domain()?, fraction: float("fraction")? })?,
            "Noise" => {
                let seed = given.getattr("seed")?.extract()?;
                self.between(given, meaning, Noise { domain: domain()?, seed })?
            }
            "FBm" => self.between(given, meaning, Fbm { domain: domain()?, octaves: octaves()? })?,
            "Marble" => {
                let distortion = float("distortion")?;
                self.between(given, meaning, Marble { domain: domain()?, distortion, octaves: octaves()? })?
            }
            "Wood" => {
                let distortion = float("distortion")?;
                self.between(given, meaning, Wood { domain: domain()?, distortion, octaves: octaves()? })?
            }
            "MixTexture" => {
                let [a, b] = ["a", "b"].map(|name| self.attribute(given, name, meaning));
                // A share of the one and of the other.
                let amount = if meaning == Meaning::Numbers { meaning } else { Meaning::Share };
                let amount = self.attribute(given, "amount", amount);
                Arc::new(MixTexture { a: a?, b: b?, amount: amount? })
            }
            "ProductTexture" => {
                let [a, b] = ["a", "b"].map(|name| self.attribute(given, name, meaning));
                Arc::new(ProductTexture { a: a?, b: b? })
            }
            "VertexColors" => self.coloured(VertexColours, meaning),
            "ImageTexture" => self.coloured(self.image(given.extract()?)?, meaning),
            "Spectrum" | "Blackbody" => Arc::new(Spectral::new(spectra::table(given, meaning)?)),
            other => return Err(PyTypeError::new_err(format!("expected a number, 3 or a texture, got {other}"))),
        })
    }

    fn between(
        &self,
        given: &Bound<'_, PyAny>,
        meaning: Meaning,
        pattern: impl Pattern + 'static,
    ) -> PyResult<Arc<dyn Texture>> {
        let [a, b] = ["a", "b"].map(|name| self.attribute(given, name, meaning));
        Ok(Arc::new(Between { a: a?, b: b?, pattern }))
    }

    fn image(&self, given: PyImage<'_>) -> PyResult<ImageTexture> {
        let unknown = |what: &str| PyValueError::new_err(format!("{what} is no way to read an image"));
        let filter = match given.filter.as_str() {
            "nearest" => Filter::Nearest,
            "bilinear" => Filter::Bilinear,
            "trilinear" => Filter::Trilinear,
            other => return Err(unknown(other)),
        };
        let wrap = |word: &str| match word {
            "repeat" => Ok(Wrap::Repeat),
            "clamp" => Ok(Wrap::Clamp),
            "mirror" => Ok(Wrap::Mirror),
            other => Err(unknown(other)),
        };
        let wrap = [wrap(&given.wrap[0])?, wrap(&given.wrap[1])?];
        let one = match given.channels[..] {
            [channel] => Some(channel),
            _ => None,
        };
        let smaller = filter == Filter::Trilinear;
        let key = (given.image.as_ptr() as usize, one, given.decoded, smaller);
        let known = self.pictures.borrow().get(&key).map(|known| known.made.clone());
        let picture = match known {
            Some(picture) => picture,
            None => {
                let made = Arc::new(picture(&given.image, one, given.decoded, smaller)?);
                let known = Known { _object: given.image.clone().unbind(), made: made.clone() };
                self.pictures.borrow_mut().insert(key, known);
                made
            }
        };
        Ok(ImageTexture { picture, uv: UvTransform(given.transform.matrix), wrap, filter })
    }
}

/// A picture of one channel of an (H, W, C) array, or of its first three.
fn picture(image: &Bound<'_, PyAny>, one: Option<usize>, decoded: bool, smaller: bool) -> PyResult<Picture> {
    fn taken<T: numpy::Element + Copy>(array: &PyReadonlyArrayDyn<'_, T>, one: Option<usize>) -> PyResult<Taken<T>> {
        use numpy::PyUntypedArrayMethods;
        let &[height, width, count] = array.shape() else {
            return Err(PyValueError::new_err(format!("image has shape {:?}, expected (H, W, C)", array.shape())));
        };
        let all = array.as_slice().map_err(|_| PyValueError::new_err("image must be C-contiguous"))?;
        if one.unwrap_or(2) >= count {
            return Err(PyValueError::new_err(format!("image has {count} channels, expected more")));
        }
        let rows = all.chunks_exact(count);
        let texels = match one {
            Some(channel) => Ok(rows.map(|texel| texel[channel]).collect()),
            None => Err(rows.map(|texel| [texel[0], texel[1], texel[2]]).collect()),
        };
        Ok((width, height, texels))
    }
    let (width, height, texels) = if let Ok(bytes) = image.extract::<PyReadonlyArrayDyn<'_, u8>>() {
        let (width, height, texels) = taken(&bytes, one)?;
        let texels = texels.map_or_else(|all| Texels::Colour8(all, decoded), |all| Texels::Grey8(all, decoded));
        (width, height, texels)
    } else {
        let (width, height, texels) = taken(&image.extract::<PyReadonlyArrayDyn<'_, f32>>()?, one)?;
        (width, height, texels.map_or_else(Texels::Colour, Texels::Grey))
    };
    Picture::new(width, height, texels, smaller).map_err(|e| PyValueError::new_err(e.to_string()))
}
