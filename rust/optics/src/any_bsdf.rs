//! What scatters light at a point: one type for all kinds.

use super::one_of::one_of;
use super::{
    Beckmann, BlinnPhong, Coated, CoatedOnce, Conductor, Dielectric, Diffuse, Faceted, Filmed, Ggx, LayeredPrincipled,
    LayeredPrincipledThin, MetallicRough, Mirror, Null, Once, OrenNayar, Phong, Principled, PrincipledThin, SoapFilm,
    ThinDielectric, Tinted, Transparent,
};

one_of! {
    /// A bidirectional scattering distribution function of any kind.
    ///
    /// A kind is one file and one line of this list. A batch calls it through a `match`, which predicts well and
    /// inlines, rather than through a pointer.
    AnyBsdf, inline,
    /// What is known of functions of all kinds, a lane each, and of a direction that light goes to.
    AnyBsdfLanes, {
        /// Lambert's: equally bright from everywhere.
        Diffuse(Diffuse),
        /// Rough and matt: brighter towards the light.
        OrenNayar(OrenNayar),
        /// Reflects into one direction.
        Mirror(Mirror),
        /// Metal, smooth or rough.
        Conductor(Conductor),
        /// Glass or water, smooth or rough: reflects and refracts.
        Dielectric(Dielectric),
        /// A pane of glass without thickness.
        ThinDielectric(ThinDielectric),
        /// Diffuse under a dielectric coat: plastic, varnish, glaze.
        Coated(Coated),
        /// Diffuse and a lobe about the mirror direction.
        Phong(Phong),
        /// Diffuse and a lobe about the half vector.
        BlinnPhong(BlinnPhong),
        /// The metallic-roughness model of glTF.
        MetallicRough(MetallicRough),
        /// Rough surfaces of other facets, or of facets that scatter once only, principled ones, and thin films.
        Faceted(Faceted),
        /// Lets light straight through.
        Transparent(Transparent),
        /// Scatters nothing.
        Null(Null),
    }
}

impl AnyBsdf {
    /// The kind of [`Diffuse`], the first.
    pub const DIFFUSE: usize = 0;

    /// How many kinds there are, with those of [`Faceted`].
    pub const KINDS: usize = Self::VARIANTS + Faceted::VARIANTS;

    /// The number of its kind among all.
    #[inline]
    pub fn kind(&self) -> usize {
        match self {
            Self::Faceted(faceted) => Self::VARIANTS + faceted.variant(),
            _ => self.variant(),
        }
    }
}

/// Makes [`AnyBsdf`] of less common facets too.
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
