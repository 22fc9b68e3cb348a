//! An enum over all kinds of BSDFs.

use super::bsdf_enum::one_of;
use super::{
    Beckmann, BlinnPhong, Coated, CoatedOnce, Conductor, Dielectric, Diffuse, Faceted, Filmed, Ggx, LayeredPrincipled,
    LayeredPrincipledThin, MetallicRough, Mirror, Null, Once, OrenNayar, Phong, Principled, PrincipledThin, SoapFilm,
    ThinDielectric, Tinted, Transparent,
};

one_of! {
    /// A bidirectional scattering distribution function of any kind.
    ///
    /// A kind is one file and one line of this list. Batches call it through a `match`, which predicts and inlines
    /// well, instead of a pointer.
    AnyBsdf, inline,
    /// BSDFs of all kinds in structure-of-arrays form, each with an outgoing direction.
    AnyBsdfLanes, {
        /// Lambertian reflection.
        Diffuse(Diffuse),
        /// Rough diffuse reflection, brighter towards the light.
        OrenNayar(OrenNayar),
        /// Specular reflection.
        Mirror(Mirror),
        /// A conductor, smooth or rough.
        Conductor(Conductor),
        /// A dielectric, smooth or rough.
        Dielectric(Dielectric),
        /// A thin dielectric pane.
        ThinDielectric(ThinDielectric),
        /// A diffuse base under a dielectric coat: plastic, varnish, glaze.
        Coated(Coated),
        /// Diffuse reflection and a lobe about the mirror direction.
        Phong(Phong),
        /// Diffuse reflection and a lobe about the half vector.
        BlinnPhong(BlinnPhong),
        /// The metallic-roughness model of glTF.
        MetallicRough(MetallicRough),
        /// Less common kinds: other facet distributions, single-scattering facets, principled models and thin films.
        Faceted(Faceted),
        /// Straight transmission.
        Transparent(Transparent),
        /// No scattering.
        Null(Null),
    }
}

impl AnyBsdf {
    /// Index of [`Diffuse`], the first kind.
    pub const DIFFUSE: usize = 0;

    /// Number of kinds, including those of [`Faceted`].
    pub const KINDS: usize = Self::VARIANTS + Faceted::VARIANTS;

    /// Index of its kind among all.
    #[inline]
    pub fn kind(&self) -> usize {
        match self {
            Self::Faceted(faceted) => Self::VARIANTS + faceted.variant(),
            _ => self.variant(),
        }
    }
}

/// Implements conversions to [`AnyBsdf`] for the less common kinds.
macro_rules! faceted {
    ($($of:ty,)+) => {
        $(impl From<$of> for AnyBsdf {
            fn from(kind: $of) -> Self {
                Self::Faceted(kind.into())
            }
        })+
    };
}

faceted! {
    Conductor<Beckmann>,
    Dielectric<Beckmann>,
    Coated<Beckmann>,
    Conductor<Once<Ggx>>,
    Conductor<Once<Beckmann>>,
    Dielectric<Once<Ggx>>,
    Dielectric<Once<Beckmann>>,
    CoatedOnce<Ggx>,
    CoatedOnce<Beckmann>,
    LayeredPrincipled,
    LayeredPrincipledThin,
    Principled,
    PrincipledThin,
    SoapFilm,
    Dielectric<Ggx, Filmed>,
    Dielectric<Beckmann, Filmed>,
    Dielectric<Once<Ggx>, Filmed>,
    Dielectric<Once<Beckmann>, Filmed>,
    Tinted<Dielectric<Ggx>>,
    Tinted<Dielectric<Beckmann>>,
    Tinted<Dielectric<Once<Ggx>>>,
    Tinted<Dielectric<Once<Beckmann>>>,
    Tinted<ThinDielectric>,
}
