//! Optical depths along rays.

use super::current_medium::{Filled, around};
use super::distance_sampling::MediumSegment;
use crate::nesting::{MediumStack, crossed};
use raywright_base::math::Ray;
use raywright_optics::Rgb;
use raywright_scene::Scene;
use raywright_scene::media::Content;

/// Write the optical depth of all media along each ray up to its `t_max`. Rays pass straight through all surfaces.
pub fn optical_depths(scene: &Scene, rays: &[Ray], depths: &mut [Rgb]) {
    assert_eq!(rays.len(), depths.len(), "a depth for each ray");
    depths.fill(Rgb::ZERO);
    let mut media = Vec::new();
    let whole: Vec<Ray> = rays.iter().map(|ray| Ray { t_max: f64::INFINITY, ..*ray }).collect();
    MediumStack::<Filled>::at(scene, &whole, &mut media);
    let crossings = scene.crossings(rays);
    for (i, (ray, mut media)) in rays.iter().zip(media).enumerate() {
        let mut start = ray.t_min;
        for hit in crossed(crossings.of_ray(i)) {
            depths[i] += along(scene, ray, &media, [start, hit.t]);
            media.pass(scene, ray, hit, false);
            start = hit.t;
        }
        depths[i] += along(scene, ray, &media, [start, ray.t_max]);
    }
}

/// Return the optical depth between two `t` of a ray in given media.
fn along(scene: &Scene, ray: &Ray, media: &MediumStack<Filled>, span: [f64; 2]) -> Rgb {
    let Some((medium, within)) = around(scene, media, ray).filter(|_| span[0] < span[1]) else { return Rgb::ZERO };
    let length = ray.direction.length();
    MediumSegment { medium, ray: within, span, length, scatters: false, roulette: false, waves: None }.optical_depth()
}

impl MediumSegment<'_> {
    /// Return the total optical depth: in closed form, unless the medium is heterogeneous with extinction that is not
    /// cubic.
    fn optical_depth(&self) -> Rgb {
        let mut start = self.span[0];
        let mut sum = Rgb::ZERO;
        for stretch in self.medium.closed_stretches(&self.ray, self.span) {
            let span = [start, stretch.end];
            sum += match stretch.content {
                Content::Even(here) => {
                    let way = (stretch.end - start) * self.length;
                    // 0 times infinity is NaN.
                    here.extinction.map(|sigma| if sigma == 0.0 { 0.0 } else { sigma * way })
                }
                Content::Cubic => self.cubic_depth(span),
                Content::Varies([_, most]) => self.summed(most, span),
            };
            start = stretch.end;
        }
        sum
    }

    /// Return the optical depth of a stretch with only an upper bound of the extinction. It is a sum over so many parts
    /// that each has an optical depth of at most a tenth.
    fn summed(&self, most: Rgb, [start, end]: [f64; 2]) -> Rgb {
        const LEAST: f64 = 64.0;
        let parts = (10.0 * most.max() * (end - start) * self.length).clamp(LEAST, 1e6).ceil();
        let step = (end - start) / parts;
        (0..parts as u32).map(|i| start + f64::from(i) * step).map(|t| self.cubic_depth([t, t + step])).sum()
    }
}
