//! What scatters light at a point: one interface over all kinds.

use super::{
    Beckmann, BlinnPhong, BsdfSample, Coated, CoatedOnce, Conductor, Dielectric, Diffuse, Faceted, Ggx, MetallicRough,
    Mirror, Null, Once, OrenNayar, Phong, Rgb, Scatter, ThinDielectric, Transparent,
};
use glam::DVec3;

/// Makes [`Bsdf`] of its kinds: each a type of the same name that implements [`Scatter`].
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident,)+) => {
        /// The bidirectional scattering distribution function at a point of a surface: one of its kinds.
        ///
        /// A kind is one file and one line of the list in this one. A batch calls it through a `match`, which predicts
        /// well and inlines, rather than through a pointer. [`Scatter`] says what is asked of it, and in which frame.
        #[derive(Clone, Copy, Debug)]
        pub enum Bsdf {
            $($(#[$doc])* $kind($kind),)+
        }

        $(impl From<$kind> for Bsdf {
            fn from(kind: $kind) -> Self {
                Self::$kind(kind)
            }
        })+

        impl Bsdf {
            /// See [`Scatter::evaluate`].
            #[inline]
            pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
                match self {
                    $(Self::$kind(kind) => kind.evaluate(wo, wi),)+
                }
            }

            /// See [`Scatter::sample`].
            #[inline]
            pub fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
                match self {
                    $(Self::$kind(kind) => kind.sample(wo, choice, u),)+
                }
            }

            /// See [`Scatter::prepare`].
            #[inline]
            pub fn prepare(&mut self, wo: DVec3) {
                match self {
                    $(Self::$kind(kind) => kind.prepare(wo),)+
                }
            }

            /// See [`Scatter::albedo`].
            #[inline]
            pub fn albedo(&self) -> Rgb {
                match self {
                    $(Self::$kind(kind) => kind.albedo(),)+
                }
            }

            /// See [`Scatter::again`].
            #[inline]
            pub fn again(&self) -> Rgb {
                match self {
                    $(Self::$kind(kind) => kind.again(),)+
                }
            }

            /// See [`Scatter::is_delta`].
            #[inline]
            pub fn is_delta(&self) -> bool {
                match self {
                    $(Self::$kind(kind) => kind.is_delta(),)+
                }
            }

            /// See [`Scatter::transmits`].
            #[inline]
            pub fn transmits(&self) -> bool {
                match self {
                    $(Self::$kind(kind) => kind.transmits(),)+
                }
            }

            /// See [`Scatter::roughness`].
            #[inline]
            pub fn roughness(&self) -> f64 {
                match self {
                    $(Self::$kind(kind) => kind.roughness(),)+
                }
            }
        }
    };
}

kinds! {
    /// Lambert's: equally bright from everywhere.
    Diffuse,
    /// Rough and matt: brighter towards the light.
    OrenNayar,
    /// Reflects into one direction.
    Mirror,
    /// Metal, smooth or rough.
    Conductor,
    /// Glass or water, smooth or rough: reflects and refracts.
    Dielectric,
    /// A pane of glass without thickness.
    ThinDielectric,
    /// Diffuse under a dielectric coat: plastic, varnish, glaze.
    Coated,
    /// Diffuse and a lobe about the mirror direction.
    Phong,
    /// Diffuse and a lobe about the half vector.
    BlinnPhong,
    /// The metallic-roughness model of glTF.
    MetallicRough,
    /// Rough surfaces of other facets, or of facets that scatter once only.
    Faceted,
    /// Lets light straight through.
    Transparent,
    /// Scatters nothing.
    Null,
}

/// Makes [`Bsdf`] of less common facets too.
macro_rules! faceted {
    ($($of:ty,)+) => {
        $(impl From<$of> for Bsdf {
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
}
