//! Interaction of a path with a surface.

mod as_given;
mod interaction_lanes;

pub use interaction_lanes::SurfaceInteractionLanes;

use super::materials::BsdfMix;
use super::textures::{Needs, TexturePoint};
use super::{Interaction, LightSampleContext, LookupContext, RayOrigin, Scene, ShadingPoint, SurfacePoint};
use raywright_base::math::{DVec3, Frame, Hit, Ray, select};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, BsdfSample, Rgb};

/// A surface interaction: the hit point with its BSDF.
///
/// Scattering is computed in the shading frame, with z on the side of the winding's normal. So the sign of a
/// direction's z tells a transmissive BSDF the side. The geometric normal decides the true side; otherwise light leaks
/// where the two normals disagree (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.3). A
/// hard cut there would show the facets of a coarse mesh at the terminator, so light fades out before it (see
/// `fading`).
#[derive(Clone, Debug)]
pub struct SurfaceInteraction<B = BsdfMix> {
    surface: SurfacePoint,
    /// Shading frame.
    frame: Frame,
    bsdf: B,
    /// Direction back along the ray, in the shading frame.
    wo: DVec3,
    /// 1 if the ray arrives on the side of the winding's normal, otherwise −1.
    side: f64,
    /// True if shading and geometric normal are equal.
    is_flat: bool,
    /// True if the shading normal was bent towards the ray.
    is_bent: bool,
    /// True if the shading normal is used as given ([`Plan::normals_as_given`](super::Plan::normals_as_given)).
    as_given: bool,
    /// Mean curvature, positive where the surface is convex towards the ray; 0 unless a footprint was given.
    curvature: f64,
}

impl SurfaceInteraction {
    /// The interaction of a ray of unit direction at a hit, for a lookup context. `outside` is the index of refraction
    /// on the side opposite to the surface's interior.
    #[inline]
    pub fn new(
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
        surface: SurfacePoint,
        gaze: impl Into<LookupContext>,
        outside: f64,
    ) -> Self {
        let gaze = gaze.into();
        let constant = if outside == 1.0 { scene.plan().constant(surface.shape, surface.is_front(ray)) } else { None };
        match constant {
            Some(bsdf) if gaze.width == 0.0 => Self::with(ray, surface, (surface.shading_normal, None), bsdf.clone()),
            _ => Self::mapped(scene, ray, hit, surface, (gaze, outside), constant),
        }
    }

    /// The interaction for a material that must be evaluated at the point, unless its BSDF is `constant`.
    fn mapped(
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
        surface: SurfacePoint,
        (gaze, outside): (LookupContext, f64),
        constant: Option<&BsdfMix>,
    ) -> Self {
        let material = scene.material_at(&surface);
        let mut needs = material.needs();
        needs.tangents |= gaze.width > 0.0;
        let point = shading_point(scene, ray, hit, surface, needs, gaze, outside);
        let shading = material.normal(&point).unwrap_or(surface.shading_normal);
        let normal = (shading, material.tangent(&point));
        let bsdf = constant.cloned().unwrap_or_else(|| material.bsdf(&point));
        let mut here = if point.as_given && shading != surface.normal {
            Self::as_given(ray, surface, normal, bsdf)
        } else {
            Self::with(ray, surface, normal, bsdf)
        };
        if gaze.width > 0.0 {
            here.curvature = here.side * mean_curvature(&point);
        }
        here
    }

    /// The BSDF at a surface point, if its material needs no more than wavelengths and changes no frame.
    pub fn bsdf_by_waves(
        scene: &Scene,
        surface: SurfacePoint,
        is_front: bool,
        waves: Waves,
        outside: f64,
    ) -> Option<BsdfMix> {
        let material = scene.material_at(&surface);
        if material.needs().of_place() || scene.plan().normals_as_given() {
            return None;
        }
        let point = ShadingPoint::plain(surface);
        let texture = TexturePoint { waves: Some(waves), ..point.texture };
        let point = ShadingPoint { texture, is_front, outside, ..point };
        let changes = material.normal(&point).is_some() || material.tangent(&point).is_some();
        (!changes).then(|| material.bsdf(&point))
    }

    /// The interaction at a hit, without context and in vacuum.
    #[inline]
    pub fn at(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        Self::new(scene, ray, hit, scene.geometry().surface(ray, hit), 0.0, 1.0)
    }
}

impl<B: Bsdf> SurfaceInteraction<B> {
    /// Minimum cosine between shading normal and view. Beyond the horizon of the shading normal a surface would be
    /// black although it faces the viewer. There the normal is bent towards the viewer until it just faces him.
    pub const GRAZING: f64 = 1e-3;

    /// The interaction of a ray of unit direction at a surface point, from its shading normal, the x axis of the frame
    /// if it matters, and the BSDF.
    #[inline(always)]
    pub fn with(ray: &Ray, surface: SurfacePoint, (shading, tangent): (DVec3, Option<DVec3>), bsdf: B) -> Self {
        let back = -ray.direction;
        let side = 1f64.copysign(back.dot(surface.normal));
        let other = surface.normal;
        let is_flat = (shading.x == other.x) & (shading.y == other.y) & (shading.z == other.z);
        // Both are computed and one is selected, because lanes have no branches.
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

    /// The same interaction for another outgoing direction. Returns `None` if more than that would differ: on the other
    /// side, or if a normal is bent for either direction.
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

    /// The same interaction, with a reference to its BSDF.
    pub fn by_ref(&self) -> SurfaceInteraction<&B> {
        let &Self { surface, frame, ref bsdf, wo, side, is_flat, is_bent, as_given, curvature } = self;
        SurfaceInteraction { surface, frame, bsdf, wo, side, is_flat, is_bent, as_given, curvature }
    }

    /// Reflectance of ambient light ([`Material::ambient`](super::Material::ambient)); the other arguments are those of
    /// [`SurfaceInteraction::new`].
    pub fn ambient(&self, scene: &Scene, ray: &Ray, hit: &Hit, gaze: impl Into<LookupContext>, outside: f64) -> Rgb {
        let material = scene.material_at(&self.surface);
        material.ambient(&shading_point(scene, ray, hit, self.surface, material.needs(), gaze, outside))
    }

    /// The geometric normal on the ray's side.
    #[inline(always)]
    pub fn normal(&self) -> DVec3 {
        self.surface.normal * self.side
    }

    /// The surface point.
    #[inline(always)]
    pub fn surface(&self) -> &SurfacePoint {
        &self.surface
    }

    /// The shading normal on the ray's side.
    #[inline(always)]
    pub fn shading_normal(&self) -> DVec3 {
        self.frame.normal * self.shading_side()
    }

    /// Cosine of the outgoing direction to the shading normal on its side.
    #[inline(always)]
    pub fn cosine(&self) -> f64 {
        self.wo.z * self.shading_side()
    }

    /// The side of the shading normal that the ray counts on: that of the geometric normal, or its own side if normals
    /// are used as given.
    #[inline(always)]
    fn shading_side(&self) -> f64 {
        if self.as_given { 1f64.copysign(self.wo.z) } else { self.side }
    }

    /// Returns whether the shading normal is used as given, without fading.
    #[inline(always)]
    pub fn is_as_given(&self) -> bool {
        self.as_given
    }

    /// Returns whether shading and geometric normal are equal.
    #[inline(always)]
    pub fn is_flat(&self) -> bool {
        self.is_flat
    }

    /// Returns whether the shading normal was bent towards the ray, so that it depends on the ray's direction.
    #[inline(always)]
    pub fn is_bent(&self) -> bool {
        self.is_bent
    }

    /// Extracts the BSDF.
    pub fn into_bsdf(self) -> B {
        self.bsdf
    }

    /// The BSDF.
    #[inline(always)]
    pub fn bsdf(&self) -> &B {
        &self.bsdf
    }

    /// Direction back along the ray, in the shading frame.
    #[inline(always)]
    pub fn wo(&self) -> DVec3 {
        self.wo
    }

    /// Mean curvature, positive where the surface is convex towards the ray; 0 unless a width was given.
    #[inline(always)]
    pub fn curvature(&self) -> f64 {
        self.curvature
    }

    /// Returns whether a direction is on the opposite side of the surface from the ray.
    #[inline(always)]
    pub fn is_through(&self, direction: DVec3) -> bool {
        self.surface.normal.dot(direction) * self.side < 0.0
    }

    /// Transforms a sample from the shading frame to the world.
    #[inline(always)]
    pub fn to_world(&self, drawn: BsdfSample) -> Option<BsdfSample> {
        let (wi, fading) = self.goes_to(drawn.wi, drawn.is_delta());
        (fading > 0.0).then(|| BsdfSample { wi, weight: drawn.weight * fading, ..drawn })
    }

    /// Transforms a direction of the shading frame to the world; also returns its fading factor.
    #[inline(always)]
    pub fn goes_to(&self, wi: DVec3, is_delta: bool) -> (DVec3, f64) {
        let direction = self.frame.to_world(wi);
        let fading = self.fading(wi, direction);
        // A delta direction produces no visible cut, so it need not fade.
        (direction, if is_delta & (fading > 0.0) & !self.as_given { 1.0 } else { fading })
    }

    /// Transforms a direction to the shading frame; also returns its fading factor, 0 below a horizon.
    #[inline(always)]
    pub fn seen_from(&self, direction: DVec3) -> (DVec3, f64) {
        let wi = self.frame.to_local(direction);
        (wi, self.fading(wi, direction))
    }

    /// Fading factor of a direction near the horizon of either normal: 0 if it is above one and below the other.
    ///
    /// If the normals differ and light comes from the ray's side, the factor is −G³ + G² + G with G = min(1, (ng·ω) /
    /// ((ns·ω) (ng·ns))). It reaches 0 at the geometric horizon with a slope, not a step (Chiang, Li and Burley,
    /// "Taming the Shadow Terminator", 2019). It is exactly 1 on flat surfaces, which adds no bias, and at most 1, so
    /// energy is never created. Reciprocity is lost where the normals differ, as with any shading normal. The
    /// alternative of moving the origin of shadow rays (Hanika, "Hacking the Shadow Terminator", 2021) leaks light near
    /// contacts, and needs the light beyond the geometric horizon.
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

impl<B: Bsdf> Interaction for SurfaceInteraction<B> {
    #[inline(always)]
    fn position(&self) -> DVec3 {
        self.surface.position
    }

    #[inline(always)]
    fn ray_origin(&self) -> RayOrigin {
        RayOrigin::new(&self.surface)
    }

    /// The receiver has the normal of the ray's side, or none if light is transmitted.
    ///
    /// Its position is offset to that side, as are ray origins. On the inner wall of an emissive hollow sphere only the
    /// offset tells whether the receiver is inside, and the density of rays that hit the wall must use the same
    /// position.
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

/// Fading factor near the geometric horizon, as in [`SurfaceInteraction`]. `geometric` and `shading` are a direction's
/// cosines to the two normals, positive and up to a common factor; `between` is the cosine between the normals.
#[inline(always)]
pub fn fading(geometric: f64, shading: f64, between: f64) -> f64 {
    let g = geometric / (shading * between);
    // A shading normal on the other side, as a bump map may produce, has no such horizon.
    if between <= 0.0 || g >= 1.0 { 1.0 } else { ((1.0 - g) * g + 1.0) * g }
}

/// Input of material evaluation at the point.
fn shading_point(
    scene: &Scene,
    ray: &Ray,
    hit: &Hit,
    surface: SurfacePoint,
    needs: Needs,
    gaze: impl Into<LookupContext>,
    outside: f64,
) -> ShadingPoint {
    let point = ShadingPoint::new(scene.geometry(), ray, hit, surface, needs, gaze);
    if scene.plan().normals_as_given() {
        // The visible side is that of the shading normal.
        let is_front = ray.direction.dot(surface.shading_normal) <= 0.0;
        return ShadingPoint { outside, is_front, as_given: true, ..point };
    }
    ShadingPoint { outside, ..point }
}

/// Mean curvature, positive where the surface is convex on the side of its normal; 0 if its derivatives are unknown.
fn mean_curvature(point: &ShadingPoint) -> f64 {
    let ([u, v], [du, dv]) = (point.dp, point.dn);
    // Half the trace of the shape operator, from both fundamental forms.
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
        // Views from beyond the horizon of the shading normal, on both sides.
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
