//! The stages of surfaces that scatter flux ([`crate::path_vertices`]), sixteen at a time.

use super::bsdf_block::{BsdfBlock, Scattered};
use super::worker::WavefrontWorker;
use crate::path_vertices::Onward;
use raywright_base::math::LANES;
use raywright_optics::{Bsdf, BsdfSample, Rgb};

impl BsdfBlock<'_> {
    /// Return the reflectance of a lane that is Lambertian and has no shading normal.
    pub fn diffuse_and_flat(&self, lane: usize) -> Option<Rgb> {
        self.get(lane).diffuse().filter(|_| self.is_flat(lane))
    }

    /// Return the direction of flux that the sample of a lane gives, `None` if flux needs a sample of its own. Delta
    /// lobes and Lambertian surfaces scatter flux as they scatter radiance, but for the factor 1 / η² of refracted
    /// radiance. Shading normals differ.
    pub fn onward(&self, next: &Scattered, lane: usize) -> Option<Option<Onward>> {
        if !self.is_flat(lane) {
            return None;
        }
        let Some(drawn) = self.drawn(lane) else { return Some(None) };
        let is_single = drawn.is_delta();
        if !is_single && self.get(lane).diffuse().is_none() {
            return None;
        }
        let (direction, weight) = (next.direction.get(lane).as_dvec3().normalize(), drawn.weight * drawn.eta.powi(2));
        Some(Some(Onward { direction, weight, pdf: drawn.pdf, is_through: drawn.is_through, is_single }))
    }
}

impl BsdfBlock<'_> {
    /// Return the direction of radiance that the sample of a lane gives.
    pub fn continuation(&self, next: &Scattered, lane: usize) -> Option<Onward> {
        let drawn = self.drawn(lane)?;
        let direction = next.direction.get(lane).as_dvec3().normalize();
        let (weight, pdf, is_through, is_single) = (drawn.weight, drawn.pdf, drawn.is_through, drawn.is_delta());
        Some(Onward { direction, weight, pdf, is_through, is_single })
    }
}

impl WavefrontWorker<'_> {
    /// Stage: flux leaves sixteen surfaces in given directions; the others end. `most` are the maximum probabilities of
    /// surviving Russian roulette.
    pub(super) fn scatter_flux(&mut self, onward: &[Option<Onward>; LANES], most: &[f64; LANES]) {
        let block = &mut *self.block;
        let next = &mut block.next;
        for lane in 0..block.surfaces.count {
            let Some(onward) = &onward[lane] else {
                next.pdf[lane] = 0.0;
                block.bsdf.set_drawn(lane, None);
                continue;
            };
            let throughput = block.throughput.get(lane) * onward.weight.as_vec3();
            next.throughput.set(lane, throughput);
            next.direction.set(lane, onward.direction.as_vec3());
            next.pdf[lane] = onward.pdf as f32;
            let surfaces = &block.surfaces;
            let side = if onward.is_through { surfaces.origin_behind(lane) } else { surfaces.origin.get(lane) };
            next.origin.set(lane, side);
            // Flux has no other factor of the index of refraction. The survival is the root of this product.
            next.scale[lane] = (most[lane].powi(2) as f32 / throughput.max_element()).min(1.0);
            let drawn = BsdfSample::new(onward.direction, onward.weight, onward.pdf);
            block.bsdf.set_drawn(lane, Some(BsdfSample { is_through: onward.is_through, ..drawn }));
        }
    }
}
