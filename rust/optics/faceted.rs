//! Rough surfaces that are not of GGX's facets, or not with all of the light.

use super::{Beckmann, BsdfSample, Coated, CoatedOnce, Conductor, Dielectric, Ggx, Once, Rgb, Scatter};
use crate::math::DVec3;

/// Makes [`Faceted`] of its kinds.
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident($of:ty),)+) => {
        /// A rough surface of less common facets: one of its kinds.
        ///
        /// They are kept apart from the kinds of [`super::Bsdf`], so that these do not share their code with what most
        /// scenes do not have.
        #[derive(Clone, Copy, Debug)]
        pub enum Faceted {
            $($(#[$doc])* $kind($of),)+
        }

        $(impl From<$of> for Faceted {
            fn from(kind: $of) -> Self {
                Self::$kind(kind)
            }
        })+

        impl Scatter for Faceted {
            #[inline(never)]
            fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
                match self {
                    $(Self::$kind(kind) => kind.evaluate(wo, wi),)+
                }
            }

            #[inline(never)]
            fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
                match self {
                    $(Self::$kind(kind) => kind.sample(wo, choice, u),)+
                }
            }

            fn prepare(&mut self, wo: DVec3) {
                match self {
                    $(Self::$kind(kind) => kind.prepare(wo),)+
                }
            }

            fn albedo(&self) -> Rgb {
                match self {
                    $(Self::$kind(kind) => kind.albedo(),)+
                }
            }

            fn again(&self) -> Rgb {
                match self {
                    $(Self::$kind(kind) => kind.again(),)+
                }
            }

            fn is_delta(&self) -> bool {
                match self {
                    $(Self::$kind(kind) => kind.is_delta(),)+
                }
            }

            fn transmits(&self) -> bool {
                match self {
                    $(Self::$kind(kind) => kind.transmits(),)+
                }
            }

            fn roughness(&self) -> f64 {
                match self {
                    $(Self::$kind(kind) => kind.roughness(),)+
                }
            }
        }
    };
}

kinds! {
    /// Metal of Beckmann's facets.
    BeckmannConductor(Conductor<Beckmann>),
    /// Glass of Beckmann's facets.
    BeckmannDielectric(Dielectric<Beckmann>),
    /// Plastic with a coat of Beckmann's facets.
    BeckmannCoated(Coated<Beckmann>),
    /// Metal, scattering once.
    ConductorOnce(Conductor<Once<Ggx>>),
    /// Metal of Beckmann's facets, scattering once.
    BeckmannConductorOnce(Conductor<Once<Beckmann>>),
    /// Glass, scattering once.
    DielectricOnce(Dielectric<Once<Ggx>>),
    /// Glass of Beckmann's facets, scattering once.
    BeckmannDielectricOnce(Dielectric<Once<Beckmann>>),
    /// Plastic, its coat scattering once.
    CoatedOnce(CoatedOnce<Ggx>),
    /// Plastic with a coat of Beckmann's facets, scattering once.
    BeckmannCoatedOnce(CoatedOnce<Beckmann>),
}
