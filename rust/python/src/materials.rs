//! Material descriptions of the Python package, read by attribute.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

use super::media;
use super::spectra::{self, Meaning};
use super::textures::{Cache, Textures};
use raywright::optics::conductors::{METALS, metal};
use raywright::scene::Material;
use raywright::scene::materials::{
    BlinnPhongMaterial, BoundaryMaterial, BumpMap, ConductorMaterial, DielectricMaterial, DiffuseMaterial, FacetKind,
    FilmBase, FilmedMetals, Index, Interior, LookTextures, Mask, MetallicRoughMaterial, MirrorMaterial, MixMaterial,
    NormalMap, OrenNayarMaterial, PhongMaterial, PlasticMaterial, PrincipledMaterial, PrincipledThinMaterial,
    Roughness, SoapFilmMaterial, ThinDielectricMaterial, ThinFilmMaterial, TintedBase, TintedMaterial, TwoSided,
};
use raywright::scene::media::Medium;

/// Reads materials and textures; a shared one is read once.
pub struct Appearances {
    materials: Cache<Arc<dyn Material>>,
    media: Cache<Arc<dyn Medium>>,
    /// Textures of materials and lights.
    pub textures: Textures,
}

impl Appearances {
    /// Creates a reader; spectral if `waves`.
    pub fn new(waves: bool) -> Self {
        Self { materials: Cache::default(), media: Cache::default(), textures: Textures::new(waves) }
    }

    /// Reads a material.
    ///
    /// # Errors
    /// A `TypeError` if it is not a material, and errors of reading its textures.
    pub fn material(&self, given: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Material>> {
        self.materials.of(given, || self.read(given))
    }

    /// Reads a material by the name of its class.
    fn read(&self, given: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Material>> {
        let name = given.get_type().name()?;
        let value = |name: &str| self.textures.attribute(given, name, Meaning::Share);
        let number = |name: &str| self.textures.number(given, name);
        let float = |name: &str| given.getattr(name)?.extract::<f64>();
        let inner = |name: &str| self.material(&given.getattr(name)?);
        let roughness = || self.roughness(given);
        Ok(match name.to_str()? {
            "Diffuse" => Arc::new(DiffuseMaterial { reflectance: value("reflectance")? }),
            "OrenNayar" => {
                Arc::new(OrenNayarMaterial { reflectance: value("reflectance")?, roughness: number("roughness")? })
            }
            "Mirror" => Arc::new(MirrorMaterial { reflectance: value("reflectance")? }),
            "Conductor" => Arc::new(self.conductor(given)?),
            "Dielectric" => Arc::new(self.dielectric(given)?),
            "ThinFilm" => Arc::new(ThinFilmMaterial {
                thickness: number("thickness")?,
                ior: float("ior")?,
                base: self.film_base(&given.getattr("base")?)?,
                by_wave: self.textures.has_waves(),
            }),
            "Tinted" => Arc::new(TintedMaterial {
                base: self.tinted_base(&given.getattr("base")?)?,
                reflectance: value("reflectance")?,
                transmittance: value("transmittance")?,
            }),
            "SoapFilm" => Arc::new(SoapFilmMaterial {
                thickness: number("thickness")?,
                ior: float("ior")?,
                by_wave: self.textures.has_waves(),
            }),
            "Boundary" => {
                let medium = self.medium(given)?.ok_or_else(|| PyTypeError::new_err("interior must be a medium"))?;
                Arc::new(BoundaryMaterial { medium, priority: given.getattr("priority")?.extract()? })
            }
            "ThinDielectric" => {
                let priority = given.getattr("priority")?.extract()?;
                let within = self.medium(given)?.map(|medium| (medium, priority));
                Arc::new(ThinDielectricMaterial { ior: float("ior")?, within })
            }
            "Plastic" => Arc::new(PlasticMaterial {
                reflectance: value("reflectance")?,
                ior: float("ior")?,
                roughness: roughness()?,
                coats: Arc::default(),
            }),
            "Phong" => Arc::new(PhongMaterial {
                diffuse: value("diffuse")?,
                specular: value("specular")?,
                exponent: number("exponent")?,
                ambient: value("ambient")?,
            }),
            "BlinnPhong" => Arc::new(BlinnPhongMaterial {
                diffuse: value("diffuse")?,
                specular: value("specular")?,
                exponent: number("exponent")?,
                ambient: value("ambient")?,
            }),
            "MetallicRough" => Arc::new(MetallicRoughMaterial {
                base_colour: value("base_color")?,
                metallic: number("metallic")?,
                roughness: number("roughness")?,
            }),
            "Principled" => Arc::new(PrincipledMaterial {
                looks: self.looks(given)?,
                interior: interior(given)?,
                metallic: number("metallic")?,
                clearcoat: number("clearcoat")?,
                clearcoat_gloss: number("clearcoat_gloss")?,
            }),
            "PrincipledThin" => Arc::new(PrincipledThinMaterial {
                looks: self.looks(given)?,
                ior: float("ior")?,
                diffuse_transmission: number("diffuse_transmission")?,
            }),
            "Mix" => Arc::new(MixMaterial { a: inner("a")?, b: inner("b")?, amount: number("amount")? }),
            "Mask" => Arc::new(Mask { material: inner("material")?, opacity: number("opacity")? }),
            "BumpMap" => {
                Arc::new(BumpMap { material: inner("material")?, height: number("height")?, scale: float("scale")? })
            }
            "NormalMap" => Arc::new(NormalMap {
                material: inner("material")?,
                normals: self.textures.attribute(given, "normals", Meaning::Numbers)?,
                scale: float("scale")?,
            }),
            "TwoSided" => Arc::new(TwoSided { front: inner("front")?, back: inner("back")? }),
            other => return Err(PyTypeError::new_err(format!("material must be a raywright material, got {other}"))),
        })
    }

    fn conductor(&self, given: &Bound<'_, PyAny>) -> PyResult<ConductorMaterial> {
        let index = match given.getattr("metal")?.extract::<Option<String>>()? {
            Some(name) => Index::Measured(metal(&name).ok_or_else(|| unknown(&name))?, self.textures.has_waves()),
            None => {
                let value = |name: &str| self.textures.attribute(given, name, Meaning::Amount);
                Index::Constants { eta: value("eta")?, k: value("k")? }
            }
        };
        Ok(ConductorMaterial { index, roughness: self.roughness(given)? })
    }

    fn dielectric(&self, given: &Bound<'_, PyAny>) -> PyResult<DielectricMaterial> {
        let interior = interior(given)?;
        Ok(DielectricMaterial { interior, roughness: self.roughness(given)?, medium: self.medium(given)? })
    }

    /// Reads the base of a film.
    fn film_base(&self, given: &Bound<'_, PyAny>) -> PyResult<FilmBase> {
        Ok(match given.get_type().name()?.to_str()? {
            "Dielectric" => FilmBase::Dielectric(self.dielectric(given)?),
            "Conductor" => FilmBase::Conductor(self.conductor(given)?, FilmedMetals::default()),
            other => {
                return Err(PyTypeError::new_err(format!("base must be a Dielectric or a Conductor, got {other}")));
            }
        })
    }

    /// Reads the base of a tint.
    fn tinted_base(&self, given: &Bound<'_, PyAny>) -> PyResult<TintedBase> {
        Ok(match given.get_type().name()?.to_str()? {
            "Dielectric" => TintedBase::Dielectric(self.dielectric(given)?),
            "ThinDielectric" => TintedBase::Pane(given.getattr("ior")?.extract()?),
            other => {
                return Err(PyTypeError::new_err(format!(
                    "base must be a Dielectric or a ThinDielectric, got {other}"
                )));
            }
        })
    }

    /// Reads the participating medium inside a material.
    fn medium(&self, given: &Bound<'_, PyAny>) -> PyResult<Option<Arc<dyn Medium>>> {
        let interior = given.getattr("interior")?;
        if interior.is_none() {
            Ok(None)
        } else {
            self.media.of(&interior, || media::read(&interior, self.textures.has_waves())).map(Some)
        }
    }

    /// Reads the parameters that the principled materials share.
    fn looks(&self, given: &Bound<'_, PyAny>) -> PyResult<LookTextures> {
        let number = |name: &str| self.textures.number(given, name);
        Ok(LookTextures {
            base_color: self.textures.attribute(given, "base_color", Meaning::Share)?,
            roughness: number("roughness")?,
            anisotropic: number("anisotropic")?,
            transmission: number("transmission")?,
            specular_tint: number("specular_tint")?,
            sheen: number("sheen")?,
            sheen_tint: number("sheen_tint")?,
            flatness: number("flatness")?,
            conserves: given.getattr("energy_conserving")?.extract()?,
        })
    }

    /// Reads roughness, or alpha if given, isotropic or anisotropic, and the facet distribution.
    fn roughness(&self, given: &Bound<'_, PyAny>) -> PyResult<Roughness> {
        let alpha = given.getattr("alpha")?;
        let is_alpha = !alpha.is_none();
        let told = if is_alpha { alpha } else { given.getattr("roughness")? };
        let along = match told.extract::<[Bound<'_, PyAny>; 2]>() {
            Ok([u, v]) => [self.textures.plain(&u)?.number(), self.textures.plain(&v)?.number()],
            Err(_) => {
                let both = self.textures.plain(&told)?.number();
                [both.clone(), both]
            }
        };
        let distribution: String = given.getattr("distribution")?.extract()?;
        let facets = match (distribution.as_str(), given.getattr("multiple_scattering")?.extract()?) {
            ("beckmann", true) => FacetKind::Beckmann,
            ("beckmann", false) => FacetKind::BeckmannOnce,
            (_, true) => FacetKind::Ggx,
            (_, false) => FacetKind::GgxOnce,
        };
        Ok(Roughness { along, is_alpha, facets })
    }
}

/// Symbols and names of the known metals.
#[pyfunction]
pub fn metals() -> Vec<(&'static str, &'static str)> {
    METALS.iter().map(|metal| (metal.symbol, metal.name)).collect()
}

/// Measurements of a metal: wavelength in nm, and real and imaginary part of the index of refraction.
///
/// # Errors
/// A `ValueError` for an unknown metal.
#[pyfunction]
pub fn metal_index(name: &str) -> PyResult<Vec<[f64; 3]>> {
    metal(name).map(|metal| metal.index.to_vec()).ok_or_else(|| unknown(name))
}

fn unknown(name: &str) -> PyErr {
    PyValueError::new_err(format!("metal must be one that is known, got '{name}'"))
}

/// Reads the interior of a solid.
fn interior(given: &Bound<'_, PyAny>) -> PyResult<Interior> {
    let (ior, dispersion) = spectra::index(&given.getattr("ior")?)?;
    Ok(Interior { ior, dispersion, priority: given.getattr("priority")?.extract()? })
}
