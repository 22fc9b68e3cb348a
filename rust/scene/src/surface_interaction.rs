//! A path's encounter with a surface.

mod as_given;
mod lanes;

pub use lanes::SurfaceInteractionLanes;

use super::materials::BsdfMix;
use super::textures::Needs;
use super::{Encounter, Gaze, LightSampleContext, RayOrigin, Scene, ShadingPoint, SurfacePoint};
use raywright_base::math::{DVec3, Frame, Hit, Ray, select};
use raywright_optics::{Bsdf, BsdfSample, Rgb};

/// Where a ray has met a surface.
///
/// Scattering is computed in the shading frame, whose z is on the side of the winding's normal, so that what transmits
/// knows by the sign of a direction on which side it lies. Which side that is in truth is the geometric normal's to
/// say: otherwise light leaks through wherever the two normals disagree (Veach, "Robust Monte Carlo Methods for Light
/// Transport Simulation", 1997, 5.3). What is cut off so would show the facets of a coarse mesh as hard steps where
/// light grazes them; it fades out before instead (see `fading`).
#[derive(Clone, Debug)]
pub struct SurfaceInteraction<B = BsdfMix> {
    surface: SurfacePoint,
    /// Shading frame.
    frame: Frame,
    bsdf: B,
    /// Back along the ray, in the shading frame.
    wo: DVec3,
    /// 1 where the ray comes from the side of the winding's normal, −1 on the other.
    side: f64,
    /// Whether the two normals are one.
    is_flat: bool,
    /// Whether the shading normal was bent towards the ray.
    is_bent: bool,
    /// Whether the shading normal is taken as it is given ([`Plan::normals_as_given`](super::Plan::normals_as_given)).
    as_given: bool,
    /// Mean curvature, positive where the surface bulges towards the ray; 0 unless it was asked for.
    curvature: f64,
}

impl SurfaceInteraction {
    /// What a ray of unit direction meets at a hit, by how it is looked at; `outside` is the index of refraction on the
    /// other side of what the surface encloses.
    #[inline]
    pub fn new(
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
        surface: SurfacePoint,
        gaze: impl Into<Gaze>,
        outside: f64,
    ) -> Self {
        let gaze = gaze.into();
        if outside == 1.0
            && gaze.width == 0.0
            && let Some(bsdf) = scene.plan().constant(surface.shape, surface.is_front(ray))
        {
            let shading = surface.shading_normal;
            return Self::with(ray, surface, (shading, None), bsdf.clone());
        }
        Self::mapped(scene, ray, hit, surface, gaze, outside)
    }

    /// The same where the material has to be asked.
    fn mapped(scene: &Scene, ray: &Ray, hit: &Hit, surface: SurfacePoint, gaze: Gaze, outside: f64) -> Self {
        let material = scene.material_at(&surface);
        let mut needs = material.needs();
        needs.tangents |= gaze.width > 0.0;
        let point = shading_point(scene, ray, hit, surface, needs, gaze, outside);
        let shading = material.normal(&point).unwrap_or(surface.shading_normal);
        let normal = (shading, material.tangent(&point));
        let mut here = if point.as_given && shading != surface.normal {
            Self::as_given(ray, surface, normal, material.bsdf(&point))
        } else {
            Self::with(ray, surface, normal, material.bsdf(&point))
        };
        if gaze.width > 0.0 {
            here.curvature = here.side * mean_curvature(&point);
        }
        here
    }

    /// Looks up a hit and what is there.
    #[inline]
    pub fn at(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        Self::new(scene, ray, hit, scene.geometry().surface(ray, hit), 0.0, 1.0)
    }
}

impl<B: Bsdf> SurfaceInteraction<B> {
    /// The smallest cosine between shading normal and view. Beyond the horizon of the shading normal a surface would
    /// turn black though it faces the viewer, so there the normal is bent towards the viewer until it just faces him.
    pub const GRAZING: f64 = 1e-3;

    /// What a ray of unit direction meets at a point of a surface, given the shading normal there, the direction that
    /// the frame's x should have if that matters, and how the surface scatters.
    #[inline(always)]
    pub fn with(ray: &Ray, surface: SurfacePoint, (shading, tangent): (DVec3, Option<DVec3>), bsdf: B) -> Self {
        let back = -ray.direction;
        let side = 1f64.copysign(back.dot(surface.normal));
        let other = surface.normal;
        let is_flat = (shading.x == other.x) & (shading.y == other.y) & (shading.z == other.z);
        // Both are computed, and one is taken: lanes have no branches.
        let cosine = shading.dot(back) * side;
        let is_bent = !is_flat & (cosine < Self::GRAZING);
        let bent = (shading + back * (side * (Self::GRAZING - cosine))).normalize();
        let shading = select(is_bent, bent, shading);
        let frame = match tangent {
            Some(tangent) => Frame::along(shading, tangent),
            None => Frame::new(shading),
        };
        let wo = frame.to_local(back);
        Self { surface, frame, bsdf, wo, side, is_flat, is_bent, as_given: false, curvature: 0.0 }
    }

    /// The same as somebody meets it whose rays come back along a direction; `None` where more than that would differ:
    /// on the other side, and where a normal is bent for the one or the other.
    pub fn met_from(&self, direction: DVec3) -> Option<SurfaceInteraction<&B>> {
        if self.as_given {
            return self.met_as_given(direction);
        }
        let &Self { surface, frame, ref bsdf, side, is_flat, is_bent, as_given, .. } = self;
        let wo = frame.to_local(direction);
        let is_bent = is_bent || !is_flat && wo.z * side < Self::GRAZING;
        let is_same_side = surface.normal.dot(direction) * side > 0.0;
        let met = SurfaceInteraction { surface, frame, bsdf, wo, side, is_flat, is_bent, as_given, curvature: 0.0 };
        (is_same_side && !is_bent).then_some(met)
    }

    /// The share of ambient light that is reflected here ([`Material::ambient`](super::Material::ambient)); the other
    /// arguments are those that [`SurfaceInteraction::new`] was given.
    pub fn ambient(&self, scene: &Scene, ray: &Ray, hit: &Hit, gaze: impl Into<Gaze>, outside: f64) -> Rgb {
        let material = scene.material_at(&self.surface);
        material.ambient(&shading_point(scene, ray, hit, self.surface, material.needs(), gaze, outside))
    }

    /// The geometric normal on the side that the ray came from.
    #[inline(always)]
    pub fn normal(&self) -> DVec3 {
        self.surface.normal * self.side
    }

    /// What is known of the point.
    #[inline(always)]
    pub fn surface(&self) -> &SurfacePoint {
        &self.surface
    }

    /// The shading normal on the side that the ray came from.
    #[inline(always)]
    pub fn shading_normal(&self) -> DVec3 {
        self.frame.normal * self.shading_side()
    }

    /// The cosine between the ray, back along it, and the shading normal on its side.
    #[inline(always)]
    pub fn cosine(&self) -> f64 {
        self.wo.z * self.shading_side()
    }

    /// On which side of the shading normal the ray is taken to have come: from that of the geometric one, or where it
    /// is given from whichever it does.
    #[inline(always)]
    fn shading_side(&self) -> f64 {
        if self.as_given { 1f64.copysign(self.wo.z) } else { self.side }
    }

    /// Whether the shading normal is taken as it is given: no light fades.
    #[inline(always)]
    pub fn is_as_given(&self) -> bool {
        self.as_given
    }

    /// Whether the two normals are one.
    #[inline(always)]
    pub fn is_flat(&self) -> bool {
        self.is_flat
    }

    /// Whether the shading normal was bent towards the ray, and is another for rays of other directions.
    #[inline(always)]
    pub fn is_bent(&self) -> bool {
        self.is_bent
    }

    /// How the point scatters, and nothing else.
    pub fn into_bsdf(self) -> B {
        self.bsdf
    }

    /// How the point scatters.
    #[inline(always)]
    pub fn bsdf(&self) -> &B {
        &self.bsdf
    }

    /// Back along the ray, in the shading frame.
    #[inline(always)]
    pub fn wo(&self) -> DVec3 {
        self.wo
    }

    /// Mean curvature, positive where the surface bulges towards the ray; 0 unless a width was given.
    #[inline(always)]
    pub fn curvature(&self) -> f64 {
        self.curvature
    }

    /// Whether a direction points to the other side of the surface than the ray came from.
    #[inline(always)]
    pub fn is_through(&self, direction: DVec3) -> bool {
        self.surface.normal.dot(direction) * self.side < 0.0
    }

    /// What was drawn in the shading frame, in the world.
    #[inline(always)]
    pub fn to_world(&self, drawn: BsdfSample) -> Option<BsdfSample> {
        let (wi, fading) = self.goes_to(drawn.wi, drawn.is_delta());
        (fading > 0.0).then(|| BsdfSample { wi, weight: drawn.weight * fading, ..drawn })
    }

    /// Where a direction of the shading frame goes in the world, and how much of what is drawn there counts.
    #[inline(always)]
    pub fn goes_to(&self, wi: DVec3, is_delta: bool) -> (DVec3, f64) {
        let direction = self.frame.to_world(wi);
        let fading = self.fading(wi, direction);
        // A single direction is not cut off along a line, and need not fade.
        (direction, if is_delta & (fading > 0.0) & !self.as_given { 1.0 } else { fading })
    }

    /// A direction of the world in the shading frame, and how much light from there counts: 0 where it is not seen.
    #[inline(always)]
    pub fn seen_from(&self, direction: DVec3) -> (DVec3, f64) {
        let wi = self.frame.to_local(direction);
        (wi, self.fading(wi, direction))
    }

    /// How much light from a direction counts as that nears the horizon of either normal: 0 where it lies above the one
    /// and below the other.
    ///
    /// Where the normals differ, and light comes from the ray's side, it fades by −G³ + G² + G with G = min(1, (ng·ω) /
    /// ((ns·ω) (ng·ns))), and so reaches 0 at the geometric horizon with a slope, not a step (Chiang, Li and Burley,
    /// "Taming the Shadow Terminator", 2019). It is 1 exactly on what is flat, where nothing is biased, and at most 1,
    /// so that energy is never made. Reciprocity is lost where the normals differ, as it is by any shading normal.
    /// Moving the origin of shadow rays instead (Hanika, "Hacking the Shadow Terminator", 2021) lets light through near
    /// contacts, and needs the light that the geometric horizon cuts off.
    #[inline(always)]
    fn fading(&self, wi: DVec3, direction: DVec3) -> f64 {
        if self.as_given {
            return self.unfaded(wi, direction);
        }
        let geometric = self.surface.normal.dot(direction);
        if wi.z * geometric <= 0.0 {
            return 0.0;
        }
        if self.is_flat || wi.z * self.wo.z < 0.0 {
            return 1.0;
        }
        let between = self.frame.normal.dot(self.surface.normal);
        fading(geometric, wi.z, between)
    }
}

impl<B: Bsdf> Encounter for SurfaceInteraction<B> {
    #[inline(always)]
    fn position(&self) -> DVec3 {
        self.surface.position
    }

    #[inline(always)]
    fn ray_origin(&self) -> RayOrigin {
        RayOrigin::new(&self.surface)
    }

    /// For the side that the ray came from, or both where light goes through.
    ///
    /// A side is asked for where rays to it leave from. On the wall of a hollow ball that shines, nothing else tells
    /// whether light is asked for inside of it or outside, and the density of rays that meet the wall is asked from
    /// there too.
    #[inline(always)]
    fn light_context(&self) -> LightSampleContext {
        if self.bsdf.transmits() {
            return LightSampleContext::free(self.surface.position);
        }
        let position = self.ray_origin().ray(self.normal()).origin;
        LightSampleContext { position, normal: self.shading_normal(), waves: None }
    }

    #[inline(always)]
    fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        let (wi, fading) = self.seen_from(direction);
        if fading <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (value, pdf) = self.bsdf.evaluate(self.wo, wi);
        (value * fading, pdf)
    }

    #[inline(always)]
    fn sample(&self, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        self.to_world(self.bsdf.sample(self.wo, choice, u)?)
    }
}

/// How much light counts near the horizon of the geometric normal, as [`SurfaceInteraction`] has it: by its cosines to
/// the geometric and to the shading normal, both positive and up to the same factor, and that between the two.
#[inline(always)]
pub fn fading(geometric: f64, shading: f64, between: f64) -> f64 {
    let g = geometric / (shading * between);
    // A shading normal of the other side, as a bump may have, has no such horizon.
    if between <= 0.0 || g >= 1.0 { 1.0 } else { ((1.0 - g) * g + 1.0) * g }
}

/// What a material is told of the point.
fn shading_point(
    scene: &Scene,
    ray: &Ray,
    hit: &Hit,
    surface: SurfacePoint,
    needs: Needs,
    gaze: impl Into<Gaze>,
    outside: f64,
) -> ShadingPoint {
    let point = ShadingPoint::new(scene.geometry(), ray, hit, surface, needs, gaze);
    if scene.plan().normals_as_given() {
        // What is seen is the side of the shading normal.
        let is_front = ray.direction.dot(surface.shading_normal) <= 0.0;
        return ShadingPoint { outside, is_front, as_given: true, ..point };
    }
    ShadingPoint { outside, ..point }
}

/// The mean curvature of a surface, positive where it bulges to the side of its normal; 0 where it is not known how it
/// lies.
fn mean_curvature(point: &ShadingPoint) -> f64 {
    let ([u, v], [du, dv]) = (point.dp, point.dn);
    // The trace of the shape operator, by the two fundamental forms.
    let (e, f, g) = (u.dot(u), u.dot(v), v.dot(v));
    let area = e * g - f * f;
    let sum = du.dot(u) * g - (du.dot(v) + dv.dot(u)) * f + dv.dot(v) * e;
    if area > 0.0 { 0.5 * sum / area } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{rectangle, scene, shape};
    use crate::{Mesh, SceneDescription};
    use raywright_base::math::Vec3;
    use raywright_base::sampling::{Sampler, warp};

    /// A floor with this shading normal.
    fn floor(normal: DVec3) -> Scene {
        let mesh = rectangle([-10.0, -10.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
        let mesh = Mesh { normals: Some(vec![normal.as_vec3(); 4]), ..mesh };
        scene(SceneDescription { shapes: vec![shape(mesh, [0.8; 3], 0.0)], ..Default::default() })
    }

    fn look(scene: &Scene, from: DVec3) -> SurfaceInteraction {
        let ray = Ray::new(from, -from.normalize());
        let mut hits = [Hit::MISS];
        scene.intersect(&[ray], &mut hits);
        SurfaceInteraction::at(scene, &ray, &hits[0])
    }

    #[test]
    fn nothing_goes_through_a_surface_and_nothing_is_nan() {
        for tilt in [0.0, 0.5, 1.0, 1.5, 1.57] {
            let floor = floor(DVec3::new(f64::sin(tilt), 0.0, f64::cos(tilt)));
            for draw in 0..1000 {
                let mut sampler = Sampler::new(1, 0, draw);
                let from = warp::uniform_sphere(sampler.two(0));
                let here = look(&floor, from);
                let other = warp::uniform_sphere(sampler.two(1));
                let (scattered, pdf) = here.evaluate(other);
                assert!(scattered.is_finite() && pdf.is_finite());
                assert!(scattered.is_black() || other.z * from.z > 0.0, "light leaks");
                if let Some(next) = here.sample(&mut || 0.5, sampler.two(2)) {
                    assert!(next.wi.z * from.z > 0.0, "a path leaks");
                    assert!((next.wi.length() - 1.0).abs() < 1e-12);
                    let (scattered, pdf) = here.evaluate(next.wi);
                    assert!((scattered - next.weight * next.pdf).abs().max() < 1e-12);
                    assert!((pdf - next.pdf).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_surface_that_faces_the_viewer_is_not_black() {
        // Seen from beyond the horizon of the shading normal, from either side.
        let floor = floor(DVec3::new(0.8, 0.0, 0.6));
        for side in [1.0, -1.0] {
            let here = look(&floor, DVec3::new(-side, 0.0, 0.2 * side));
            assert!(here.evaluate(DVec3::new(0.6 * side, 0.0, 0.8 * side)).0[0] > 0.1);
        }
    }

    #[test]
    fn both_sides_scatter_alike() {
        let floor = floor(Vec3::Z.as_dvec3());
        let towards = DVec3::new(0.6, 0.0, 0.8);
        let above = look(&floor, DVec3::new(0.1, 0.2, 1.0)).evaluate(towards);
        let below = look(&floor, DVec3::new(0.1, 0.2, -1.0)).evaluate(-towards);
        assert_eq!(above, below);
        assert!((above.0[0] - 0.8 * 0.8 / std::f64::consts::PI).abs() < 1e-12);
    }
}
