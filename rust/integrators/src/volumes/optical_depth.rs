//! Optical depths along rays.

use super::filled::{Filled, around};
use super::flight::Flight;
use crate::nesting::{MediumStack, crossed};
use raywright_base::math::Ray;
use raywright_optics::Rgb;
use raywright_scene::Scene;
use raywright_scene::media::Content;

/// Writes the optical depth of the media along each ray, up to its `t_max`: they go straight, through all surfaces.
pub fn optical_depths(scene: &Scene, rays: &[Ray], depths: &mut [Rgb]) {
    assert_eq!(rays.len(), depths.len(), "a depth for each ray");
    depths.fill(Rgb::ZERO);
    if !scene.plan().needs().media {
        return;
    }
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

/// The optical depth between two `t` of a ray in some media.
fn along(scene: &Scene, ray: &Ray, media: &MediumStack<Filled>, span: [f64; 2]) -> Rgb {
    let Some((medium, within)) = around(scene, media, ray).filter(|_| span[0] < span[1]) else { return Rgb::ZERO };
    let length = ray.direction.length();
    Flight { medium, ray: within, span, length, scatters: false, roulette: false, waves: None }.optical_depth()
}

impl Flight<'_> {
    /// The optical depth of all of it: closed, but where neither the medium is even nor its extinction a cubic.
    fn optical_depth(&self) -> Rgb {
        let mut start = self.span[0];
        let mut sum = Rgb::ZERO;
        for stretch in self.medium.closed_stretches(&self.ray, self.span) {
            let span = [start, stretch.end];
            sum += match stretch.content {
                Content::Even(here) => {
                    let way = (stretch.end - start) * self.length;
                    // 0 times infinity is no number.
                    here.extinction.map(|sigma| if sigma == 0.0 { 0.0 } else { sigma * way })
                }
                Content::Cubic => self.cubic_depth(span),
                Content::Varies([_, most]) => self.summed(most, span),
            };
            start = stretch.end;
        }
        sum
    }

    /// The optical depth of a part of which only the most is known: the sum over so many parts that none is deeper than
    /// a tenth.
    fn summed(&self, most: Rgb, [start, end]: [f64; 2]) -> Rgb {
        const LEAST: f64 = 64.0;
        let parts = (10.0 * most.max() * (end - start) * self.length).clamp(LEAST, 1e6).ceil();
        let step = (end - start) / parts;
        (0..parts as u32).map(|i| start + f64::from(i) * step).map(|t| self.cubic_depth([t, t + step])).sum()
    }
}
