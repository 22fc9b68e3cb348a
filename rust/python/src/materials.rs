//! Material descriptions of the Python package, read by attribute.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

use super::kinds::Kinds;
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
use raywright::scene::textures::Value;

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
        self.materials.of(given, || KINDS.reader(given)?(&Description { all: self, given }))
    }
}

/// The description of a material, and the cache of others.
struct Description<'a, 'py> {
    all: &'a Appearances,
    given: &'a Bound<'py, PyAny>,
}

/// Reads a material, or a part made from one.
type ReadDescription<T> = fn(&Description<'_, '_>) -> PyResult<T>;

static KINDS: Kinds<ReadDescription<Arc<dyn Material>>> = Kinds::new(
    "material must be a raywright material",
    &[
        ("materials.diffuse", "Diffuse", |of| Ok(Arc::new(DiffuseMaterial { reflectance: of.value("reflectance")? }))),
        ("materials.oren_nayar", "OrenNayar", |of| {
            Ok(Arc::new(OrenNayarMaterial {
                reflectance: of.value("reflectance")?,
                roughness: of.number("roughness")?,
            }))
        }),
        ("materials.mirror", "Mirror", |of| Ok(Arc::new(MirrorMaterial { reflectance: of.value("reflectance")? }))),
        ("materials.conductor", "Conductor", |of| Ok(Arc::new(of.conductor()?))),
        ("materials.dielectric", "Dielectric", |of| Ok(Arc::new(of.dielectric()?))),
        ("materials.thin_film", "ThinFilm", |of| {
            Ok(Arc::new(ThinFilmMaterial {
                thickness: of.number("thickness")?,
                ior: of.float("ior")?,
                base: of.base(&FILM_BASES)?,
                by_wave: of.waves(),
            }))
        }),
        ("materials.tinted", "Tinted", |of| {
            Ok(Arc::new(TintedMaterial {
                base: of.base(&TINTED_BASES)?,
                reflectance: of.value("reflectance")?,
                transmittance: of.value("transmittance")?,
            }))
        }),
        ("materials.thin_film", "SoapFilm", |of| {
            Ok(Arc::new(SoapFilmMaterial {
                thickness: of.number("thickness")?,
                ior: of.float("ior")?,
                by_wave: of.waves(),
            }))
        }),
        ("materials.medium_interface", "MediumInterface", |of| {
            let medium = of.medium()?.ok_or_else(|| PyTypeError::new_err("interior must be a medium"))?;
            Ok(Arc::new(BoundaryMaterial { medium, priority: of.given.getattr("priority")?.extract()? }))
        }),
        ("materials.thin_dielectric", "ThinDielectric", |of| {
            let priority = of.given.getattr("priority")?.extract()?;
            let within = of.medium()?.map(|medium| (medium, priority));
            Ok(Arc::new(ThinDielectricMaterial { ior: of.float("ior")?, within }))
        }),
        ("materials.plastic", "Plastic", |of| {
            Ok(Arc::new(PlasticMaterial {
                reflectance: of.value("reflectance")?,
                ior: of.float("ior")?,
                roughness: of.roughness()?,
                coats: Arc::default(),
            }))
        }),
        ("materials.phong", "Phong", |of| {
            Ok(Arc::new(PhongMaterial {
                diffuse: of.value("diffuse")?,
                specular: of.value("specular")?,
                exponent: of.number("exponent")?,
                ambient: of.value("ambient")?,
            }))
        }),
        ("materials.blinn_phong", "BlinnPhong", |of| {
            Ok(Arc::new(BlinnPhongMaterial {
                diffuse: of.value("diffuse")?,
                specular: of.value("specular")?,
                exponent: of.number("exponent")?,
                ambient: of.value("ambient")?,
            }))
        }),
        ("materials.metallic_rough", "MetallicRough", |of| {
            Ok(Arc::new(MetallicRoughMaterial {
                base_colour: of.value("base_color")?,
                metallic: of.number("metallic")?,
                roughness: of.number("roughness")?,
            }))
        }),
        ("materials.principled", "Principled", |of| {
            Ok(Arc::new(PrincipledMaterial {
                looks: of.looks()?,
                interior: of.interior()?,
                metallic: of.number("metallic")?,
                clearcoat: of.number("clearcoat")?,
                clearcoat_gloss: of.number("clearcoat_gloss")?,
            }))
        }),
        ("materials.principled", "PrincipledThin", |of| {
            Ok(Arc::new(PrincipledThinMaterial {
                looks: of.looks()?,
                ior: of.float("ior")?,
                diffuse_transmission: of.number("diffuse_transmission")?,
            }))
        }),
        ("materials.mix", "Mix", |of| {
            Ok(Arc::new(MixMaterial { a: of.inner("a")?, b: of.inner("b")?, amount: of.number("amount")? }))
        }),
        ("materials.mask", "Mask", |of| {
            Ok(Arc::new(Mask { material: of.inner("material")?, opacity: of.number("opacity")? }))
        }),
        ("materials.bump_map", "BumpMap", |of| {
            Ok(Arc::new(BumpMap {
                material: of.inner("material")?,
                height: of.number("height")?,
                scale: of.float("scale")?,
            }))
        }),
        ("materials.normal_map", "NormalMap", |of| {
            Ok(Arc::new(NormalMap {
                material: of.inner("material")?,
                normals: of.all.textures.attribute(of.given, "normals", Meaning::Numbers)?,
                scale: of.float("scale")?,
            }))
        }),
        ("materials.two_sided", "TwoSided", |of| {
            Ok(Arc::new(TwoSided { front: of.inner("front")?, back: of.inner("back")? }))
        }),
    ],
);

static FILM_BASES: Kinds<ReadDescription<FilmBase>> = Kinds::new(
    "base must be a Dielectric or a Conductor",
    &[
        ("materials.dielectric", "Dielectric", |of| Ok(FilmBase::Dielectric(of.dielectric()?))),
        ("materials.conductor", "Conductor", |of| Ok(FilmBase::Conductor(of.conductor()?, FilmedMetals::default()))),
    ],
);

static TINTED_BASES: Kinds<ReadDescription<TintedBase>> = Kinds::new(
    "base must be a Dielectric or a ThinDielectric",
    &[
        ("materials.dielectric", "Dielectric", |of| Ok(TintedBase::Dielectric(of.dielectric()?))),
        ("materials.thin_dielectric", "ThinDielectric", |of| Ok(TintedBase::Pane(of.float("ior")?))),
    ],
);

impl Description<'_, '_> {
    fn value(&self, name: &str) -> PyResult<Value> {
        self.all.textures.attribute(self.given, name, Meaning::Share)
    }

    fn number(&self, name: &str) -> PyResult<Value<f64>> {
        self.all.textures.number(self.given, name)
    }

    fn float(&self, name: &str) -> PyResult<f64> {
        self.given.getattr(name)?.extract()
    }

    /// Returns whether rendering is spectral.
    fn waves(&self) -> bool {
        self.all.textures.has_waves()
    }

    /// The material that an attribute is.
    fn inner(&self, name: &str) -> PyResult<Arc<dyn Material>> {
        self.all.material(&self.given.getattr(name)?)
    }

    fn conductor(&self) -> PyResult<ConductorMaterial> {
        let index = match self.given.getattr("metal")?.extract::<Option<String>>()? {
            Some(name) => Index::Measured(metal(&name).ok_or_else(|| unknown(&name))?, self.waves()),
            None => {
                let value = |name: &str| self.all.textures.attribute(self.given, name, Meaning::Amount);
                Index::Constants { eta: value("eta")?, k: value("k")? }
            }
        };
        Ok(ConductorMaterial { index, roughness: self.roughness()? })
    }

    fn dielectric(&self) -> PyResult<DielectricMaterial> {
        let interior = self.interior()?;
        Ok(DielectricMaterial { interior, roughness: self.roughness()?, medium: self.medium()? })
    }

    /// Reads the base of a film or a tint, one of several materials.
    fn base<T>(&self, kinds: &Kinds<ReadDescription<T>>) -> PyResult<T> {
        let base = self.given.getattr("base")?;
        kinds.reader(&base)?(&Description { all: self.all, given: &base })
    }

    /// Reads the interior of a solid.
    fn interior(&self) -> PyResult<Interior> {
        let (ior, dispersion) = spectra::index(&self.given.getattr("ior")?)?;
        Ok(Interior { ior, dispersion, priority: self.given.getattr("priority")?.extract()? })
    }

    /// Reads the participating medium inside a material.
    fn medium(&self) -> PyResult<Option<Arc<dyn Medium>>> {
        let interior = self.given.getattr("interior")?;
        if interior.is_none() {
            Ok(None)
        } else {
            self.all.media.of(&interior, || media::read(&interior, self.waves())).map(Some)
        }
    }

    /// Reads the parameters that the principled materials share.
    fn looks(&self) -> PyResult<LookTextures> {
        let number = |name: &str| self.number(name);
        Ok(LookTextures {
            base_color: self.value("base_color")?,
            roughness: number("roughness")?,
            anisotropic: number("anisotropic")?,
            transmission: number("transmission")?,
            specular_tint: number("specular_tint")?,
            sheen: number("sheen")?,
            sheen_tint: number("sheen_tint")?,
            flatness: number("flatness")?,
            conserves: self.given.getattr("energy_conserving")?.extract()?,
        })
    }

    /// Reads roughness, or alpha if given, isotropic or anisotropic, and the facet distribution.
    fn roughness(&self) -> PyResult<Roughness> {
        let alpha = self.given.getattr("alpha")?;
        let is_alpha = !alpha.is_none();
        let told = if is_alpha { alpha } else { self.given.getattr("roughness")? };
        let along = match told.extract::<[Bound<'_, PyAny>; 2]>() {
            Ok([u, v]) => [self.all.textures.plain(&u)?.number(), self.all.textures.plain(&v)?.number()],
            Err(_) => {
                let both = self.all.textures.plain(&told)?.number();
                [both.clone(), both]
            }
        };
        let distribution: String = self.given.getattr("distribution")?.extract()?;
        let facets = match (distribution.as_str(), self.given.getattr("multiple_scattering")?.extract()?) {
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
    PyValueError::new_err(format!("metal must be a known one, got '{name}'"))
}
