//! The diffuse part of the energy-conserving principled BSDFs.

use super::Look;
use crate::{Rgb, fresnel};
use raywright_base::math::DVec3;

impl Look {
    /// Color of the diffuse part between two directions above, relative to the mean over azimuths at the same
    /// elevations.
    ///
    /// This is Burley's diffuse reflection, partly flattened, over its mean over azimuths. So it has the same
    /// retroreflection, and a white base under a coat stays white. At grazing facet angles sheen replaces the base.
    #[inline(always)]
    pub(super) fn spread(&self, wo: DVec3, wi: DVec3) -> Rgb {
        let turned = (1.0 + wo.dot(wi)).max(0.0);
        let [o, i] = [wo.z, wi.z].map(fresnel::schlick_weight);
        let (both, either, sum) = (o * i, o + i, wo.z + wi.z);
        // Polynomials in 2 r cos² θd = r (1 + wo · wi): Burley's, and the flat one.
        let edges = [(1.0 - 0.5 * i) * (1.0 - 0.5 * o), either - both, both];
        let flat = 1.25 * (sum.recip() - 0.5);
        let flat = [0.625 + flat * (1.0 - o) * (1.0 - i), flat * 0.5 * (either - 2.0 * both), flat * 0.25 * both];
        let [a, b, c] = [0, 1, 2].map(|k| edges[k] + (flat[k] - edges[k]) * self.flatness);
        let rough = self.roughness;
        let retro = rough * turned;
        let even = rough * (1.0 + wo.z * wi.z);
        let square = rough * rough * (1.0 - wo.z * wo.z) * (1.0 - wi.z * wi.z);
        let mean = a + b * even + c * (even * even + 0.5 * square);
        let grazing = self.sheen * std::f64::consts::PI * fresnel::schlick_weight((0.5 * turned).sqrt());
        let cloth = grazing / (1.0 + grazing);
        (self.base_color * (1.0 - cloth) + self.sheen_color() * cloth) * ((a + retro * (b + retro * c)) / mean)
    }

    /// Color of the sheen: white, or the base color normalized to its greatest channel.
    #[inline(always)]
    fn sheen_color(&self) -> Rgb {
        let greatest = self.base_color.max();
        let tint = if greatest > 0.0 { self.base_color / greatest } else { Rgb::ONE };
        Rgb::ONE + (tint - Rgb::ONE) * self.sheen_tint
    }
}
