//! The features a scene needs.

use super::materials::BsdfMix;
use super::media::Medium;
use super::nested_shapes::Standing;
use super::textures::Needs;
use super::{Emission, Geometry, Lights, LoneShapes, Material, Rounding};
use raywright_accel::Primitives;
use raywright_optics::{AnyBsdf, Bsdf, Rgb};
use std::borrow::Cow;
use std::ops::BitOr;
use std::sync::Arc;

/// Features of a scene that make shading more expensive, found at compilation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneNeeds {
    /// Union of the lookup data of materials and lights.
    pub points: Needs,
    /// A material other than one diffuse BSDF per shape.
    pub scattering: bool,
    /// A material with partial opacity.
    pub masks: bool,
    /// A closed shape with its own index of refraction.
    pub interiors: bool,
    /// Interiors that may overlap or touch, or one that may contain a sheet whose BSDF depends on its surroundings.
    pub nested: bool,
    /// Shapes that may overlap interiors, by their boxes.
    pub standing: Standing,
    /// A participating medium.
    pub media: bool,
    /// A homogeneous medium that scatters.
    pub even_media: bool,
    /// An emissive medium.
    pub glow: bool,
    /// Emission that varies over a surface.
    pub patterned_lights: bool,
    /// Shading normals.
    pub smooth: bool,
    /// Shapes that are not meshes.
    pub shapes: bool,
    /// Instances of prototypes.
    pub instances: bool,
    /// Motion while the shutter is open.
    pub motion: bool,
    /// Vertices that f32 cannot represent.
    pub double: bool,
    /// Any light.
    pub light: bool,
    /// Spectral rendering instead of RGB.
    pub waves: bool,
}

/// Returns whether a medium is homogeneous and scatters.
fn scatters_evenly(medium: &dyn Medium) -> bool {
    medium.is_even() && medium.scatters()
}

impl BitOr for SceneNeeds {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self {
            points: self.points | other.points,
            scattering: self.scattering | other.scattering,
            masks: self.masks | other.masks,
            interiors: self.interiors | other.interiors,
            nested: self.nested | other.nested,
            standing: self.standing | other.standing,
            media: self.media | other.media,
            even_media: self.even_media | other.even_media,
            glow: self.glow | other.glow,
            patterned_lights: self.patterned_lights | other.patterned_lights,
            smooth: self.smooth | other.smooth,
            shapes: self.shapes | other.shapes,
            instances: self.instances | other.instances,
            motion: self.motion | other.motion,
            double: self.double | other.double,
            light: self.light | other.light,
            waves: self.waves | other.waves,
        }
    }
}

/// The features a scene needs, and data derived from them.
#[derive(Clone, Debug)]
pub struct Plan {
    needs: SceneNeeds,
    /// Greatest loss of a mesh by rounding to f32, prototypes included.
    rounding: Rounding,
    /// Number of lights sampled one by one at glossy surfaces; 0 if one light is selected instead.
    few: u32,
    /// Constant BSDFs of each shape, front and back ([`Material::constant_sides`]).
    constants: Vec<Option<[BsdfMix; 2]>>,
    /// Reflectances of each diffuse shape.
    diffuse: Vec<Option<[Rgb; 2]>>,
    /// BSDF kinds of each shape, front and back.
    kinds: Vec<[u8; 2]>,
    /// Closed shapes that nothing else is near.
    lone: LoneShapes,
    /// True if shading normals are used as given.
    as_given: bool,
}

/// Upper bound on the roughness of a glossy, non-delta BSDF. On rougher surfaces, sampling each of a few lights costs
/// as much time as it saves.
const GLOSS: f64 = 0.35;

/// Treatment of shading normals, unless they are used as given.
const FADED: &str = "interpolated, and faded at the terminator";

/// A row of the plan's table: the feature, whether the scene has it, and its effect.
pub type PlanRow = (&'static str, bool, Cow<'static, str>);

impl Plan {
    /// Computes the plan of a scene.
    pub(super) fn new(geometry: &Geometry, materials: &[Arc<dyn Material>], lights: &Lights) -> Self {
        let mut needs = SceneNeeds {
            smooth: geometry.is_smooth(),
            shapes: geometry.first_other().is_some_and(|first| geometry.instances_of(first).is_none()),
            instances: geometry.has_instances(),
            motion: geometry.moves(),
            double: !geometry.is_single(),
            light: !lights.is_dark(),
            waves: lights.others().any(|light| light.has_waves()),
            ..SceneNeeds::default()
        };
        let mut rounding = geometry.rounding();
        let mut constants = Vec::with_capacity(materials.len());
        let mut kinds = Vec::with_capacity(materials.len());
        for (shape, material) in materials.iter().enumerate() {
            let shape = shape as u32;
            match geometry.instances_of(shape) {
                Some(instances) => {
                    needs = needs | Self::of_copies(instances.prototype(), &mut rounding);
                    constants.push(None);
                    kinds.push([Self::MIXED as u8; 2]);
                }
                None => {
                    needs = needs | Self::of(material.as_ref(), lights.emission(shape));
                    constants.push(material.constant_sides().map(|sides| sides.map(BsdfMix::One)));
                    kinds.push(material.kinds().unwrap_or([Self::MIXED; 2]).map(|kind| kind as u8));
                }
            }
        }
        needs.waves |= needs.points.waves;
        if needs.interiors {
            needs.standing = Standing::of(geometry, materials.iter().map(|material| &**material));
            needs.nested |= needs.standing.sheets | needs.standing.glass;
        }
        let encloses = |shape: u32| {
            let material = &materials[shape as usize];
            material.interior().is_some() || material.boundary().is_some()
        };
        let lone = LoneShapes::of(geometry, encloses);
        let few = if needs.scattering { lights.few() } else { 0 };
        let colour = |sides: &Option<[BsdfMix; 2]>| {
            let [front, back] = sides.as_ref()?;
            Some([front.diffuse()?, back.diffuse()?])
        };
        let diffuse = constants.iter().map(colour).collect();
        Self { needs, rounding, few, constants, diffuse, kinds, lone, as_given: false }
    }

    fn of(material: &dyn Material, emission: &Emission) -> SceneNeeds {
        let is_dark = emission.is_dark();
        SceneNeeds {
            points: if is_dark { material.needs() } else { material.needs() | emission.needs() },
            scattering: !matches!(material.constant_sides(), Some([AnyBsdf::Diffuse(_), AnyBsdf::Diffuse(_)])),
            masks: !material.is_opaque(),
            interiors: material.interior().is_some(),
            media: material.medium().is_some(),
            even_media: material.medium().is_some_and(|medium| scatters_evenly(&**medium)),
            glow: material.medium().is_some_and(|medium| medium.glows()),
            waves: material.medium().is_some_and(|medium| medium.has_waves()),
            patterned_lights: !is_dark && emission.needs().of_place(),
            light: !is_dark,
            ..SceneNeeds::default()
        }
    }

    /// Features of a prototype.
    fn of_copies(prototype: &super::Prototype, rounding: &mut Rounding) -> SceneNeeds {
        let geometry = prototype.geometry();
        *rounding = rounding.worst(geometry.rounding());
        let (smooth, double) = (geometry.is_smooth(), !geometry.is_single());
        let mut needs = SceneNeeds { smooth, double, ..SceneNeeds::default() };
        for (shape, (material, emission)) in prototype.appearances().enumerate() {
            needs = needs
                | match geometry.instances_of(shape as u32) {
                    Some(instances) => Self::of_copies(instances.prototype(), rounding),
                    None => Self::of(material, emission),
                };
        }
        needs
    }

    /// Returns the plan with a medium around everything, or none.
    pub(super) fn with_medium_around(&self, medium: Option<&dyn Medium>) -> Self {
        let (media, glow) = (medium.is_some(), medium.is_some_and(Medium::glows));
        let (even_media, waves) = (medium.is_some_and(scatters_evenly), medium.is_some_and(Medium::has_waves));
        let around = SceneNeeds { media, even_media, glow, waves, ..SceneNeeds::default() };
        Self { needs: self.needs | around, ..self.clone() }
    }

    /// Returns the plan with shading normals as given. Shapes that may have shading normals are evaluated at each
    /// point.
    pub(super) fn with_normals_as_given(mut self, geometry: &Geometry) -> Self {
        // Bump and normal maps need tangents.
        self.as_given = self.needs.smooth || self.needs.points.tangents;
        if !self.as_given {
            return self;
        }
        for shape in 0..self.constants.len() {
            if geometry.has_normals(shape as u32) {
                self.constants[shape] = None;
            }
            // The loops for constant diffuse surfaces only support faded normals.
            if self.constants[shape].is_none() {
                self.diffuse[shape] = None;
                self.kinds[shape] = [Self::MIXED as u8; 2];
                self.needs.scattering = true;
            }
        }
        self
    }

    /// Returns whether shading normals are used as given and there are any: no fading at horizons, no bending.
    #[inline]
    pub fn normals_as_given(&self) -> bool {
        self.as_given
    }

    /// The closed shapes that nothing else is near.
    #[inline]
    pub fn lone_shapes(&self) -> &LoneShapes {
        &self.lone
    }

    /// The features the scene needs.
    pub fn needs(&self) -> SceneNeeds {
        self.needs
    }

    /// Rounding of vertices to f32, if it is a loss.
    pub fn loss(&self) -> Option<Rounding> {
        (!self.needs.double && self.rounding.is_loss()).then_some(self.rounding)
    }

    /// Precision of vertices, with its reason.
    fn digits(&self) -> Cow<'static, str> {
        let Rounding { moved, .. } = self.rounding;
        let figure = || format!("{moved:.1e}, {:.1e} of its mesh's extent", self.rounding.share());
        match (self.needs.double, moved > 0.0) {
            (true, true) => format!("all digits kept: float32 would move one by {}", figure()).into(),
            (true, false) => "all digits kept, as asked for".into(),
            (false, true) => format!("kept as float32, which moves none by more than {}", figure()).into(),
            (false, false) => "kept as float32, which has all of their digits".into(),
        }
    }

    /// Returns whether a point with this roughness ([`raywright_optics::Bsdf::roughness`]) samples each of few lights
    /// ([`Lights::sample_one`]) and resamples one of them for the shadow ray. On a diffuse surface, light positions
    /// predict contributions well enough to select one ([`Lights::sample`]); on a glossy surface only the BSDF does.
    #[inline]
    pub fn asks_each(&self, roughness: impl FnOnce() -> f64) -> bool {
        self.few > 0 && (f64::MIN_POSITIVE..=GLOSS).contains(&roughness())
    }

    /// The BSDF of a shape in vacuum, if it is constant.
    #[inline]
    pub fn constant(&self, shape: u32, is_front: bool) -> Option<&BsdfMix> {
        self.constants[shape as usize].as_ref().map(|[front, back]| if is_front { front } else { back })
    }

    /// Reflectances of front and back, if both sides have one diffuse color.
    #[inline]
    pub fn diffuse(&self, shape: u32) -> Option<[Rgb; 2]> {
        self.diffuse[shape as usize]
    }

    /// Returns whether the BSDF of every shape is constant ([`Plan::constant`]).
    pub fn is_constant(&self) -> bool {
        self.constants.iter().all(Option::is_some)
    }

    /// Number of BSDF kinds: those of [`AnyBsdf`], and [`Plan::MIXED`].
    pub const KINDS: usize = AnyBsdf::KINDS + 1;

    /// Kind of a diffuse BSDF.
    pub const DIFFUSE: usize = AnyBsdf::DIFFUSE;

    /// Kind of a mixture, or of a BSDF that is not known in advance.
    pub const MIXED: usize = AnyBsdf::KINDS;

    /// Kind of both sides of a shape's BSDF in vacuum; [`Plan::MIXED`] if they differ.
    #[inline]
    pub fn kind_of_shape(&self, shape: u32) -> usize {
        let [front, back] = self.kinds[shape as usize];
        if front == back { front.into() } else { Self::MIXED }
    }

    /// The plan as a table.
    pub fn rows(&self) -> Vec<PlanRow> {
        let needs = &self.needs;
        let row =
            |what, has, with: &'static str, without: &'static str| (what, has, if has { with } else { without }.into());
        let smooth = if self.as_given { "interpolated, and taken as they are" } else { FADED };
        let mut rows = vec![
            row("light", needs.light, "a light is asked at each point", "no light is asked, no shadow ray sent"),
            row(
                "few lights",
                self.few > 0,
                "where it is glossy, each is asked, and one gets the shadow ray",
                "one of all is asked",
            ),
            row("materials", needs.scattering, "asked at each point", "one diffuse colour a shape, asked once"),
            row(
                "textures",
                needs.points.of_place(),
                "coordinates are computed where asked for",
                "no coordinates kept or computed",
            ),
            row("filtered textures", needs.points.width, "paths carry the width of their rays", "paths carry no width"),
            row("masks", needs.masks, "shadow rays are followed through", "the first hit ends a shadow ray"),
            row("media", needs.interiors, "surfaces have an outside", "no index of refraction kept"),
            row("nested media", needs.nested, "paths know what they are in", "paths carry no media"),
            row(
                "wavelengths",
                needs.waves,
                "paths carry three, and two end where glass parts them",
                "red, green and blue",
            ),
            row("smoke and haze", needs.media, "paths go one by one, and scatter on their way", "space is clear"),
            row(
                "patterned lights",
                needs.patterned_lights,
                "emission is asked at each point",
                "emission is one number a shape",
            ),
            row("shading normals", needs.smooth, smooth, "none kept or computed"),
            row("shapes", needs.shapes, "a tree of their own beside the triangles'", "no tree beside the triangles'"),
            row("instances", needs.instances, "rays are taken to each copy's space", "rays stay in the world"),
            row("motion", needs.motion, "rays are spread over the shutter's time", "all rays at one time"),
            ("float64 vertices", needs.double, self.digits()),
        ];
        // Only listed if the scene has them.
        if needs.standing.sheets || needs.standing.glass {
            rows.push(("shapes in glass", true, "surfaces scatter by the index around them".into()));
        }
        if self.as_given {
            rows.push(("normals as given", true, "no light fades, no normal is bent".into()));
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{cornell, furnace, rectangle, shape};
    use crate::materials::{BsdfMix, Interior};
    use crate::{SceneDescription, ShadingPoint, Shape};

    #[test]
    fn diffuse_rooms_are_plain() {
        for scene in [furnace(0.5, 1.0), cornell(8, 8).0] {
            let has: Vec<_> = scene.plan().rows().into_iter().filter(|row| row.1).map(|row| row.0).collect();
            assert_eq!(has, ["light"]);
        }
    }

    /// A material that may have an interior or partial opacity.
    #[derive(Debug)]
    struct Odd {
        interior: Option<Interior>,
        is_opaque: bool,
    }

    impl Material for Odd {
        fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
            raywright_optics::Diffuse { reflectance: raywright_optics::Rgb::ONE }.into()
        }
        fn needs(&self) -> Needs {
            Needs::NONE
        }
        fn validate(&self) -> Result<(), String> {
            Ok(())
        }
        fn is_opaque(&self) -> bool {
            self.is_opaque
        }
        fn interior(&self) -> Option<Interior> {
            self.interior
        }
    }

    #[test]
    fn what_lies_in_one_another_takes_two() {
        let glass = || Odd { interior: Some(Interior::new(1.5, 0)), is_opaque: true };
        let sheet_at = |material: Odd, height: f32| Shape {
            material: Arc::new(material),
            ..shape(rectangle([0.0, 0.0, height], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.5; 3], 0.0)
        };
        let sheet = |material: Odd| sheet_at(material, 0.0);
        let plan = |shapes| crate::fixtures::scene(SceneDescription { shapes, ..Default::default() }).plan().clone();
        assert!(!plan(vec![sheet(glass())]).needs().nested);
        assert!(plan(vec![sheet(glass()), sheet(glass())]).needs().nested);
        assert!(!plan(vec![sheet(glass()), sheet_at(glass(), 0.1)]).needs().nested);
        let mask = Odd { interior: None, is_opaque: false };
        assert!(plan(vec![sheet(mask)]).needs().masks);
    }
}
