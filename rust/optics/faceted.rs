//! Rough surfaces that are not of GGX's facets, or not with all of the light, and principled ones.

use super::one_of::one_of;
use super::{Beckmann, Coated, CoatedOnce, Conductor, Dielectric, Ggx, Once, Principled, PrincipledThin};

one_of! {
    /// A rough surface of less common facets, or of many parts: one of its kinds.
    ///
    /// They are kept apart from the kinds of [`super::AnyBsdf`], and not inlined, so that these do not share their code
    /// with what most scenes do not have.
    Faceted, inline(never), {
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
        /// The principled model.
        Principled(Principled),
        /// That of a sheet.
        PrincipledThin(PrincipledThin),
    }
}
