//! Less common BSDFs: other facet distributions, single-scattering facets, principled models and thin films.

use super::bsdf_enum::one_of;
use super::{
    Beckmann, Coated, CoatedOnce, Conductor, Dielectric, Filmed, Ggx, LayeredPrincipled, LayeredPrincipledThin, Once,
    Principled, PrincipledThin, SoapFilm, ThinDielectric, Tinted,
};

one_of! {
    /// A less common BSDF: one of its kinds.
    ///
    /// They are separate from [`super::AnyBsdf`] and not inlined, so that the common kinds do not share their code.
    Faceted, inline(never),
    /// Less common BSDFs in structure-of-arrays form.
    FacetedLanes, {
        /// Conductor with Beckmann facets.
        BeckmannConductor(Conductor<Beckmann>),
        /// Dielectric with Beckmann facets.
        BeckmannDielectric(Dielectric<Beckmann>),
        /// Plastic with a coat of Beckmann facets.
        BeckmannCoated(Coated<Beckmann>),
        /// Conductor with single scattering.
        ConductorOnce(Conductor<Once<Ggx>>),
        /// Conductor with Beckmann facets and single scattering.
        BeckmannConductorOnce(Conductor<Once<Beckmann>>),
        /// Dielectric with single scattering.
        DielectricOnce(Dielectric<Once<Ggx>>),
        /// Dielectric with Beckmann facets and single scattering.
        BeckmannDielectricOnce(Dielectric<Once<Beckmann>>),
        /// Plastic with a single-scattering coat.
        CoatedOnce(CoatedOnce<Ggx>),
        /// Plastic with a single-scattering coat of Beckmann facets.
        BeckmannCoatedOnce(CoatedOnce<Beckmann>),
        /// The principled model.
        LayeredPrincipled(LayeredPrincipled),
        /// The principled model of a thin sheet.
        LayeredPrincipledThin(LayeredPrincipledThin),
        /// The principled model as published, which does not conserve energy.
        Principled(Principled),
        /// The principled model of a thin sheet, as published.
        PrincipledThin(PrincipledThin),
        /// A free film.
        SoapFilm(SoapFilm),
        /// A film on a dielectric.
        FilmedDielectric(Dielectric<Ggx, Filmed>),
        /// A film on a dielectric with Beckmann facets.
        BeckmannFilmedDielectric(Dielectric<Beckmann, Filmed>),
        /// A film on a dielectric with single scattering.
        FilmedDielectricOnce(Dielectric<Once<Ggx>, Filmed>),
        /// A film on a dielectric with Beckmann facets and single scattering.
        BeckmannFilmedDielectricOnce(Dielectric<Once<Beckmann>, Filmed>),
        /// A tinted dielectric.
        TintedDielectric(Tinted<Dielectric<Ggx>>),
        /// A tinted dielectric with Beckmann facets.
        BeckmannTintedDielectric(Tinted<Dielectric<Beckmann>>),
        /// A tinted dielectric with single scattering.
        TintedDielectricOnce(Tinted<Dielectric<Once<Ggx>>>),
        /// A tinted dielectric with Beckmann facets and single scattering.
        BeckmannTintedDielectricOnce(Tinted<Dielectric<Once<Beckmann>>>),
        /// A tinted pane.
        TintedThinDielectric(Tinted<ThinDielectric>),
    }
}
