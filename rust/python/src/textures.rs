//! Texture descriptions of the Python package, read by attribute.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use super::kinds::Kinds;
use super::spectra::{self, Meaning};
use raywright::optics::Rgb;
use raywright::optics::spectra::Role;
use raywright::scene::textures::{
    Between, Checker, Domain, Fbm, ImageTexture, Marble, MixTexture, Noise, ObjectTransform, Octaves, Pattern, Picture,
    ProductTexture, Spectral, Stripes, TexelFilter, Texels, Texture, Upsampled, UvTransform, Value, VertexColours,
    Wood, Wrap,
};

/// A converted object; the original stays alive so that its address is not reused.
struct CachedObject<T> {
    _object: Py<PyAny>,
    made: T,
}

/// Cache of converted objects by address; a shared one is read once.
pub struct Cache<T>(RefCell<HashMap<usize, CachedObject<T>>>);

impl<T> Default for Cache<T> {
    fn default() -> Self {
        Self(RefCell::default())
    }
}

impl<T: Clone> Cache<T> {
    /// The converted object, cached or made now.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn of(&self, object: &Bound<'_, PyAny>, make: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
        let address = object.as_ptr() as usize;
        if let Some(known) = self.0.borrow().get(&address) {
            return Ok(known.made.clone());
        }
        let made = make()?;
        self.0.borrow_mut().insert(address, CachedObject { _object: object.clone().unbind(), made: made.clone() });
        Ok(made)
    }
}

/// Cache key of a picture: address of its data, selected channel, whether it is decoded, and whether it has mipmaps.
type PictureKey = (usize, Option<usize>, bool, bool);

/// Width, height, and texels of a picture: of one channel, or of three.
type Taken<T> = (usize, usize, Result<Vec<T>, Vec<[T; 3]>>);

/// Reads textures.
pub struct Textures {
    /// True for spectral rendering.
    waves: bool,
    /// Caches by the quantity of their numbers.
    textures: [Cache<Arc<dyn Texture>>; 4],
    pictures: RefCell<HashMap<PictureKey, CachedObject<Arc<Picture>>>>,
}

/// `raywright.textures.UvTransform` or `raywright.textures.ObjectTransform`.
#[derive(FromPyObject)]
enum PyTransform {
    #[pyo3(transparent)]
    Uv(PyUvTransform),
    #[pyo3(transparent)]
    Object(PyObjectTransform),
}

/// `raywright.textures.UvTransform`.
#[derive(FromPyObject)]
struct PyUvTransform {
    matrix: [[f64; 3]; 2],
}

/// `raywright.textures.ObjectTransform`.
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

/// Attributes of all fractal noises.
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
    /// Creates a reader; spectral if `waves`.
    pub fn new(waves: bool) -> Self {
        Self { waves, textures: Default::default(), pictures: RefCell::default() }
    }

    /// Returns whether rendering is spectral.
    pub fn has_waves(&self) -> bool {
        self.waves
    }

    /// Reads a number, three numbers, a spectrum, or a texture.
    ///
    /// # Errors
    /// A `TypeError` if it is none of these, and errors of reading a texture.
    pub fn value(&self, given: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<Value> {
        if let Ok(number) = given.extract::<f64>() {
            return Ok(number.into());
        }
        if let Ok(colour) = given.extract::<[f64; 3]>() {
            return Ok(self.colour(Rgb::from_array(colour), meaning));
        }
        self.textures[meaning as usize].of(given, || self.read(given, meaning)).map(Value::Texture)
    }

    /// Reads a value that is not a color.
    ///
    /// # Errors
    /// As [`Textures::value`].
    pub fn plain(&self, given: &Bound<'_, PyAny>) -> PyResult<Value> {
        self.value(given, Meaning::Numbers)
    }

    /// Reads an attribute that is a number, three numbers, a spectrum, or a texture.
    ///
    /// # Errors
    /// As [`Textures::value`].
    pub fn attribute(&self, object: &Bound<'_, PyAny>, name: &str, meaning: Meaning) -> PyResult<Value> {
        self.value(&object.getattr(name)?, meaning)
    }

    /// Reads an attribute that is a number or a texture; the mean of its channels is used.
    ///
    /// # Errors
    /// As [`Textures::value`].
    pub fn number(&self, object: &Bound<'_, PyAny>, name: &str) -> PyResult<Value<f64>> {
        Ok(self.plain(&object.getattr(name)?)?.number())
    }

    /// Role of colors in spectral rendering; `None` for red, green and blue.
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

    /// A texture with its own colors.
    fn coloured(&self, colours: impl Texture + 'static, meaning: Meaning) -> Arc<dyn Texture> {
        let colours = Arc::new(colours);
        match self.role(meaning) {
            Some(role) => Arc::new(Upsampled { colours, role }),
            None => colours,
        }
    }

    /// Reads a texture.
    fn read(&self, given: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<Arc<dyn Texture>> {
        KINDS.reader(given)?(self, given, meaning)
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
        let unknown = |what: &str| PyValueError::new_err(format!("{what} is unknown for reading an image"));
        let filter = match given.filter.as_str() {
            "nearest" => TexelFilter::Nearest,
            "bilinear" => TexelFilter::Bilinear,
            "trilinear" => TexelFilter::Trilinear,
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
        let smaller = filter == TexelFilter::Trilinear;
        let key = (given.image.as_ptr() as usize, one, given.decoded, smaller);
        let known = self.pictures.borrow().get(&key).map(|known| known.made.clone());
        let picture = match known {
            Some(picture) => picture,
            None => {
                let made = Arc::new(picture(&given.image, one, given.decoded, smaller)?);
                let known = CachedObject { _object: given.image.clone().unbind(), made: made.clone() };
                self.pictures.borrow_mut().insert(key, known);
                made
            }
        };
        Ok(ImageTexture { picture, uv: UvTransform(given.transform.matrix), wrap, filter })
    }
}

/// Reads a texture, given the quantity of its numbers.
type ReadTexture = fn(&Textures, &Bound<'_, PyAny>, Meaning) -> PyResult<Arc<dyn Texture>>;

static KINDS: Kinds<ReadTexture> = Kinds::new(
    "expected a number, 3 or a texture",
    &[
        ("textures.checker", "Checker", |all, of, meaning| all.between(of, meaning, Checker(domain(of)?))),
        ("textures.stripes", "Stripes", |all, of, meaning| {
            let fraction = of.getattr("fraction")?.extract()?;
            all.between(of, meaning, Stripes { domain: domain(of)?, fraction })
        }),
        ("textures.noise", "Noise", |all, of, meaning| {
            let seed = of.getattr("seed")?.extract()?;
            all.between(of, meaning, Noise { domain: domain(of)?, seed })
        }),
        ("textures.fbm", "FBm", |all, of, meaning| {
            all.between(of, meaning, Fbm { domain: domain(of)?, octaves: octaves(of)? })
        }),
        ("textures.marble", "Marble", |all, of, meaning| {
            let distortion = of.getattr("distortion")?.extract()?;
            all.between(of, meaning, Marble { domain: domain(of)?, distortion, octaves: octaves(of)? })
        }),
        ("textures.wood", "Wood", |all, of, meaning| {
            let distortion = of.getattr("distortion")?.extract()?;
            all.between(of, meaning, Wood { domain: domain(of)?, distortion, octaves: octaves(of)? })
        }),
        ("textures.mix", "MixTexture", |all, of, meaning| {
            let [a, b] = ["a", "b"].map(|name| all.attribute(of, name, meaning));
            // Blend weights are shares.
            let amount = if meaning == Meaning::Numbers { meaning } else { Meaning::Share };
            let amount = all.attribute(of, "amount", amount);
            Ok(Arc::new(MixTexture { a: a?, b: b?, amount: amount? }))
        }),
        ("textures.product", "ProductTexture", |all, of, meaning| {
            let [a, b] = ["a", "b"].map(|name| all.attribute(of, name, meaning));
            Ok(Arc::new(ProductTexture { a: a?, b: b? }))
        }),
        ("textures.vertex_colors", "VertexColors", |all, _, meaning| Ok(all.coloured(VertexColours, meaning))),
        ("textures.image", "ImageTexture", |all, of, meaning| Ok(all.coloured(all.image(of.extract()?)?, meaning))),
        ("textures.spectrum", "Spectrum", spectrum),
        ("textures.blackbody", "Blackbody", spectrum),
    ],
);

fn spectrum(_: &Textures, of: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<Arc<dyn Texture>> {
    Ok(Arc::new(Spectral::new(spectra::table(of, meaning)?)))
}

fn domain(of: &Bound<'_, PyAny>) -> PyResult<Domain> {
    of.getattr("transform")?.extract::<PyTransform>().map(Domain::from)
}

fn octaves(of: &Bound<'_, PyAny>) -> PyResult<Octaves> {
    of.extract::<PyOctaves>().map(Octaves::from)
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
