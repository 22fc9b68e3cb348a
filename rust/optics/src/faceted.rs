//! Rough surfaces that are not of GGX's facets, or not with all of the light, principled ones, and thin films.

use super::one_of::one_of;
use super::{
    Beckmann, Coated, CoatedOnce, Conductor, Dielectric, Filmed, Ggx, LayeredPrincipled, LayeredPrincipledThin, Once,
    Principled, PrincipledThin, SoapFilm, ThinDielectric, Tinted,
};

one_of! {
    /// A rough surface of less common facets, of many parts, or with a film on it: one of its kinds.
    ///
    /// They are kept apart from the kinds of [`super::AnyBsdf`], and not inlined, so that these do not share their code
    /// with what most scenes do not have.
    Faceted, inline(never),
    /// What is known of sixteen of them, a lane each.
    FacetedLanes, {
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
        LayeredPrincipled(LayeredPrincipled),
        /// That of a sheet.
        LayeredPrincipledThin(LayeredPrincipledThin),
        /// The principled model as it was published, with what it gains and loses.
        Principled(Principled),
        /// That of a sheet.
        PrincipledThin(PrincipledThin),
        /// A film by itself.
        SoapFilm(SoapFilm),
        /// A film on glass.
        FilmedDielectric(Dielectric<Ggx, Filmed>),
        /// A film on glass of Beckmann's facets.
        BeckmannFilmedDielectric(Dielectric<Beckmann, Filmed>),
        /// A film on glass, scattering once.
        FilmedDielectricOnce(Dielectric<Once<Ggx>, Filmed>),
        /// A film on glass of Beckmann's facets, scattering once.
        BeckmannFilmedDielectricOnce(Dielectric<Once<Beckmann>, Filmed>),
        /// Glass with a colour at its surface.
        TintedDielectric(Tinted<Dielectric<Ggx>>),
        /// The same of Beckmann's facets.
        BeckmannTintedDielectric(Tinted<Dielectric<Beckmann>>),
        /// The same, scattering once.
        TintedDielectricOnce(Tinted<Dielectric<Once<Ggx>>>),
        /// The same of Beckmann's facets, scattering once.
        BeckmannTintedDielectricOnce(Tinted<Dielectric<Once<Beckmann>>>),
        /// A pane with a colour at its surface.
        TintedThinDielectric(Tinted<ThinDielectric>),
    }
}
