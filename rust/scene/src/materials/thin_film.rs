//! Thin films on dielectrics and conductors.

use super::checks::{number, within};
use super::{BsdfMix, ConductorMaterial, DielectricMaterial, FacetKind, Index, Interior, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_base::parallel;
use raywright_optics::conductors::{FilmedCurve, FilmedMetal, Metal, Reflectance};
use raywright_optics::{AnyBsdf, Beckmann, Dielectric, Facets, Filmed, Ggx, Once};
use std::sync::{Arc, PoisonError, RwLock};

/// A thin film with interference colors on a base: oil on water, a lens coating, oxide on metal. Where the thickness
/// is 0 the base is bare.
#[derive(Debug)]
pub struct ThinFilmMaterial {
    /// Thickness in nm.
    pub thickness: Value<f64>,
    /// Index of refraction of the film.
    pub ior: f64,
    /// The base.
    pub base: FilmBase,
    /// True if paths are spectral.
    pub by_wave: bool,
}

/// The base of a film.
#[derive(Debug)]
pub enum FilmBase {
    /// A dielectric, on its outside.
    Dielectric(DielectricMaterial),
    /// A conductor, on both sides of a sheet; a measured one has precomputed data.
    Conductor(ConductorMaterial, FilmedMetals),
}

impl FilmBase {
    fn material(&self) -> &dyn Material {
        match self {
            Self::Dielectric(glass) => glass,
            Self::Conductor(metal, _) => metal,
        }
    }
}

/// Measured metals under a film of varying thickness, precomputed for each surrounding index of refraction that occurs.
#[derive(Debug, Default)]
pub struct FilmedMetals {
    ready: RwLock<Vec<FilmedIn>>,
}

/// A surrounding index of refraction, and the data precomputed for it.
type FilmedIn = (f64, Arc<[&'static FilmedCurve]>);

impl FilmedMetals {
    /// Reflectance under a film of index `film` and a thickness in nm within `range`, which must be the same in all
    /// calls.
    fn at(&self, metal: &'static Metal, thickness: f64, range: [f64; 2], film: f64, outside: f64) -> FilmedMetal {
        let all = self.of(metal, range, film, outside);
        let step = FilmedMetal::step(film);
        let [first, _] = steps(range, step);
        match all[..] {
            [one] => FilmedMetal::One(one),
            _ => {
                let at = (thickness / step - first).clamp(0.0, (all.len() - 1) as f64);
                let before = (at as usize).clamp(1, all.len() - 3);
                FilmedMetal::Between([0, 1, 2, 3].map(|k| all[before + k - 1]), at - before as f64)
            }
        }
    }

    /// All entries for a range: a single one for constant thickness, equal steps otherwise.
    fn of(&self, metal: &'static Metal, range: [f64; 2], film: f64, outside: f64) -> Arc<[&'static FilmedCurve]> {
        let find = |ready: &[FilmedIn]| ready.iter().find(|(index, _)| *index == outside).map(|(_, all)| all.clone());
        // A poisoned lock is safe: a panic cannot leave a partial entry.
        if let Some(all) = find(&self.ready.read().unwrap_or_else(PoisonError::into_inner)) {
            return all;
        }
        let step = FilmedMetal::step(film);
        let [first, last] = steps(range, step);
        let all: Arc<[_]> = if range[0] == range[1] {
            [FilmedCurve::of(metal, range[0], film, outside)].into()
        } else {
            let count = (last - first) as usize + 1;
            let each = |k: usize| FilmedCurve::of(metal, (first + k as f64) * step, film, outside);
            parallel::map(count, each).into()
        };
        let mut ready = self.ready.write().unwrap_or_else(PoisonError::into_inner);
        find(&ready).unwrap_or_else(|| {
            ready.push((outside, all.clone()));
            all
        })
    }
}

/// First and last step for a range with cubic interpolation through four entries: one step before it, if there is one,
/// and one after. A film too thick for visible fringes is clamped.
fn steps(range: [f64; 2], step: f64) -> [f64; 2] {
    let [low, high] = range.map(|thickness| (thickness / step).min(FilmedMetal::MOST));
    let first = (low.floor() - 1.0).max(0.0);
    [first, (high.ceil() + 1.0).max(first + 3.0)]
}

impl ThinFilmMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let thickness = self.thickness.at(point).max(0.0);
        match &self.base {
            FilmBase::Dielectric(glass) if thickness == 0.0 => glass.bare(point, outside),
            FilmBase::Conductor(metal, _) if thickness == 0.0 => metal.bare(point, outside),
            FilmBase::Dielectric(glass) => {
                let [alpha, _] = glass.roughness.alpha(point);
                let within = glass.interior.ior_at(point.waves.as_ref());
                let film = Filmed::new(thickness, [outside, self.ior, within]).at(point.waves);
                let eta = within / outside;
                match glass.roughness.facets {
                    FacetKind::Ggx => Dielectric::with(eta, Ggx::rough([alpha; 2]), film).into(),
                    FacetKind::Beckmann => Dielectric::with(eta, Beckmann::rough([alpha; 2]), film).into(),
                    FacetKind::GgxOnce => Dielectric::with(eta, Once::<Ggx>::rough([alpha; 2]), film).into(),
                    FacetKind::BeckmannOnce => Dielectric::with(eta, Once::<Beckmann>::rough([alpha; 2]), film).into(),
                }
            }
            FilmBase::Conductor(metal, filmed) => {
                let reflectance = match &metal.index {
                    Index::Constants { eta, k } => Reflectance::Filmed {
                        thickness,
                        layers: [outside, self.ior],
                        index: (eta.at(point), k.at(point)),
                        waves: point.waves,
                    },
                    Index::Measured(index, _) => match &point.waves {
                        Some(waves) => Reflectance::Filmed {
                            thickness,
                            layers: [outside, self.ior],
                            index: (waves.lanes(|nm| index.index_at(nm).0), waves.lanes(|nm| index.index_at(nm).1)),
                            waves: point.waves,
                        },
                        None => {
                            let range = self.thickness.range().map(|end| end.max(0.0));
                            Reflectance::FilmedMetal(filmed.at(index, thickness, range, self.ior, outside))
                        }
                    },
                };
                metal.reflecting(reflectance, point)
            }
        }
    }
}

impl Material for ThinFilmMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.bsdf(&at.texture, at.outside).into()
    }

    fn constant(&self) -> Option<AnyBsdf> {
        (!self.needs().any()).then(|| self.bsdf(&TexturePoint::default(), 1.0))
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        // A bare dielectric has another kind. Precomputes the data of metals.
        let is_one = matches!(self.base, FilmBase::Conductor(..)) || self.thickness.range()[0] > 0.0;
        is_one.then(|| [self.bsdf(&TexturePoint::default(), 1.0).kind(); 2])
    }

    fn needs(&self) -> Needs {
        Needs { waves: self.by_wave, ..Needs::NONE } | self.thickness.needs() | self.base.material().needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("thickness", &self.thickness, 0.0, f64::MAX)?;
        number("ior", self.ior, f64::MIN_POSITIVE, f64::MAX)?;
        self.base.material().validate()
    }

    fn minds_outside(&self) -> bool {
        self.interior().is_none()
    }

    fn transmits(&self) -> bool {
        self.base.material().transmits()
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.base.material().tangent(at)
    }

    fn interior(&self) -> Option<Interior> {
        self.base.material().interior()
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.base.material().medium()
    }
}
