//! Spectral grid media with a color per point.

use super::block_walk::Spectra;
use super::grid::Here;
use super::{Coefficients, Cubic, GridMedium, Medium, Stretches};
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::{Role, Smooth, Spectrum, Waves};
use raywright_optics::{Phase, Rgb};
use std::sync::Arc;

/// A spectral medium on a grid. Its spectra are constant and, where the grid has RGB values, multiplied by the smooth
/// spectra of these.
#[derive(Clone, Debug)]
pub struct WavedGrid {
    /// The density alone: coefficients are 1, or 0 for effects that are absent.
    grid: GridMedium,
    /// Absorption, scattering and emission spectra at unit density. With an albedo grid, `absorption` holds the whole
    /// extinction.
    absorption: Arc<Spectrum>,
    scattering: Arc<Spectrum>,
    emission: Option<Arc<Spectrum>>,
    /// RGB color of the extinction.
    colour: Rgb,
}

impl WavedGrid {
    /// Creates a spectral medium from a grid with coefficients of 1, or 0 for absent effects. Each 1 stands for a
    /// spectrum, given with its RGB color.
    pub fn new(
        grid: GridMedium,
        [absorption, scattering]: [(Arc<Spectrum>, Rgb); 2],
        emission: Option<Arc<Spectrum>>,
    ) -> Self {
        let colour = absorption.1 + scattering.1;
        Self { grid, absorption: absorption.0, scattering: scattering.0, emission, colour }
    }

    /// Extinction and scattering at unit density.
    fn plain(&self, waves: &Waves, has_albedo: bool) -> [Rgb; 2] {
        let absorbed = self.absorption.lanes(waves);
        let scattered = if has_albedo { Rgb::ZERO } else { self.scattering.lanes(waves) };
        [absorbed + scattered, scattered]
    }
}

impl Medium for WavedGrid {
    fn phase(&self) -> Phase {
        self.grid.phase()
    }

    fn scatters(&self) -> bool {
        self.grid.scatters()
    }

    fn glows(&self) -> bool {
        self.grid.glows()
    }

    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        let spectra = if self.grid.is_coloured() { Spectra::OfColours } else { Spectra::OfDensity };
        self.grid.stretches_by(spectra, ray, span)
    }

    fn closed_stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.grid.closed_stretches(ray, span)
    }

    fn extinction(&self, point: DVec3) -> Rgb {
        self.grid.extinction(point) * self.colour
    }

    fn cubic(&self, ends: [DVec3; 2]) -> Cubic {
        self.grid.cubic(ends).times(self.colour)
    }

    fn at(&self, point: DVec3) -> Coefficients {
        self.grid.at(point)
    }

    fn at_waves(&self, point: DVec3, waves: &Waves) -> Coefficients {
        let within = self.grid.within(point);
        let Here { density, albedo } = self.grid.here(within);
        let density = Smooth::looked_up(density, Role::Amount).lanes(waves);
        let [dimmed, scattered] = self.plain(waves, albedo.is_some());
        let extinction = dimmed * density;
        let scattering = match albedo {
            Some(albedo) => extinction * Smooth::looked_up(albedo, Role::Share).lanes(waves).at_most(Rgb::ONE),
            None => scattered * density,
        };
        let absorbed = || (extinction - scattering).at_least(Rgb::ZERO);
        let emission = self.emission.as_ref().map_or(Rgb::ZERO, |spectrum| spectrum.lanes(waves) * density);
        let beside = self.grid.glow().map_or(Rgb::ZERO, |glow| glow.at_waves(within, absorbed, waves));
        Coefficients { extinction, scattering, emission: emission + beside }
    }

    fn most_by_waves(&self, most: Rgb, waves: &Waves) -> Rgb {
        let [dimmed, _] = self.plain(waves, self.grid.has_albedo());
        // The smooth spectrum of a color never exceeds twice its greatest channel.
        let more = if self.grid.is_coloured() { 2.0 } else { 1.0 };
        let most = dimmed * (most.max() * more * (1.0 + 1e-12));
        if self.glows() { most.at_least(Rgb::splat(1.0 / self.grid.across())) } else { most }
    }

    fn has_waves(&self) -> bool {
        true
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.grid.bytes()
    }
}
