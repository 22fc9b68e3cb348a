//! What a scene needs, what is left out, and which variant of shading it takes.

use super::materials::BsdfMix;
use super::media::Medium;
use super::standing::Standing;
use super::textures::Needs;
use super::{Emission, Geometry, Lights, Material, Rounding};
use raywright_accel::Primitives;
use raywright_optics::{AnyBsdf, Bsdf, Rgb};
use std::borrow::Cow;
use std::ops::BitOr;
use std::sync::Arc;

/// What there is in a scene that costs something to those who shade it. Found once, when it is compiled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneNeeds {
    /// What materials and lights must know of a point, all together.
    pub points: Needs,
    /// Materials that are not the same diffuse one at every point of a shape.
    pub scattering: bool,
    /// Materials that some rays pass as if nothing were there.
    pub masks: bool,
    /// Shapes that enclose a medium with an index of refraction of its own.
    pub interiors: bool,
    /// Several of those, which may lie in one another, or one with something in it that scatters by what is around it.
    pub nested: bool,
    /// Which of them share space, as far as their boxes tell.
    pub standing: Standing,
    /// What dims or scatters light between surfaces.
    pub media: bool,
    /// What is the same everywhere, of that, and scatters light.
    pub even_media: bool,
    /// What glows between surfaces.
    pub glow: bool,
    /// Emission that varies over a surface.
    pub patterned_lights: bool,
    /// Shading normals.
    pub smooth: bool,
    /// Shapes that are no meshes.
    pub shapes: bool,
    /// Instances of prototypes.
    pub instances: bool,
    /// What moves while the shutter is open.
    pub motion: bool,
    /// Vertices with more digits than f32 has.
    pub double: bool,
    /// Anything that shines.
    pub light: bool,
    /// Wavelengths in place of red, green and blue.
    pub waves: bool,
}

/// Whether a medium is the same everywhere, and scatters.
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
            // Two of what encloses something may overlap.
            nested: self.nested | other.nested | (self.interiors & other.interiors),
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

/// A loop over a batch of paths, compiled with what some scenes need and no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShadingVariant {
    /// One diffuse colour a shape: no material is asked, and nothing is passed through.
    Plain,
    /// Any material and any texture that is asked for points: no masks, no media in one another, no widths of rays.
    Open,
    /// All that can be.
    General,
}

impl ShadingVariant {
    /// Every one, from the one that can do least on.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Open, Self::General];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Open => "open",
            Self::General => "general",
        }
    }
}

/// What a scene needs, and what follows from it.
#[derive(Clone, Debug)]
pub struct Plan {
    needs: SceneNeeds,
    /// What rounding to f32 did to vertices, or would have done: of the mesh, in prototypes too, to which that is most.
    rounding: Rounding,
    /// How many lights are asked one by one where light is scattered sharply; 0 where one of all is asked.
    few: u32,
    /// How each shape scatters on either side, if it does so alike everywhere ([`Material::constant_sides`]).
    constants: Vec<Option<[BsdfMix; 2]>>,
    /// Of those that are diffuse, what each reflects.
    diffuse: Vec<Option<[Rgb; 2]>>,
    /// By which kinds of functions each scatters, on the front and on the back.
    kinds: Vec<[u8; 2]>,
    /// Whether shading normals are taken as they are given.
    as_given: bool,
}

/// What has less than this roughness, but does not scatter into single directions, counts as glossy. Over rougher
/// surfaces, asking each of a few lights costs as much time as it saves.
const GLOSS: f64 = 0.35;

/// What becomes of shading normals unless they are taken as given.
const FADED: &str = "interpolated, and faded at the terminator";

/// A line of a plan: what it is about, whether the scene has it, and what that means.
pub type PlanRow = (&'static str, bool, Cow<'static, str>);

impl Plan {
    /// The plan of a scene.
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
            needs.nested |= needs.standing.sheets;
        }
        let few = if needs.scattering { lights.few() } else { 0 };
        let colour = |sides: &Option<[BsdfMix; 2]>| {
            let [front, back] = sides.as_ref()?;
            Some([front.diffuse()?, back.diffuse()?])
        };
        let diffuse = constants.iter().map(colour).collect();
        Self { needs, rounding, few, constants, diffuse, kinds, as_given: false }
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

    /// Of a prototype: with an interior in it, its instances may overlap.
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
        SceneNeeds { nested: needs.nested | needs.interiors, ..needs }
    }

    /// The same plan of a scene that has a medium around all that is in it, or none.
    pub(super) fn with_medium_around(&self, medium: Option<&dyn Medium>) -> Self {
        let (media, glow) = (medium.is_some(), medium.is_some_and(Medium::glows));
        let (even_media, waves) = (medium.is_some_and(scatters_evenly), medium.is_some_and(Medium::has_waves));
        let around = SceneNeeds { media, even_media, glow, waves, ..SceneNeeds::default() };
        Self { needs: self.needs | around, ..self.clone() }
    }

    /// The same plan of a scene whose shading normals are taken as they are given. Shapes that may have any are asked
    /// at each point.
    pub(super) fn with_normals_as_given(mut self, geometry: &Geometry) -> Self {
        // Bumps and maps need to know of tangents.
        self.as_given = self.needs.smooth || self.needs.points.tangents;
        if !self.as_given {
            return self;
        }
        for shape in 0..self.constants.len() {
            if geometry.has_normals(shape as u32) {
                self.constants[shape] = None;
            }
            // What is diffuse everywhere has its own loops, which know of faded normals only.
            if self.constants[shape].is_none() {
                self.diffuse[shape] = None;
                self.kinds[shape] = [Self::MIXED as u8; 2];
                self.needs.scattering = true;
            }
        }
        self
    }

    /// Whether shading normals are taken as they are given, and there are any: light does not fade at horizons, and no
    /// normal is bent.
    #[inline]
    pub fn normals_as_given(&self) -> bool {
        self.as_given
    }

    /// What the scene needs.
    pub fn needs(&self) -> SceneNeeds {
        self.needs
    }

    /// What rounding to f32 has done to vertices, where that is a loss.
    pub fn loss(&self) -> Option<Rounding> {
        (!self.needs.double && self.rounding.is_loss()).then_some(self.rounding)
    }

    /// Which digits of vertices are kept, and why.
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

    /// Whether each of few lights is asked ([`Lights::sample_one`]), and one of them gets the shadow ray, at a point
    /// that scatters light with this roughness ([`raywright_optics::Bsdf::roughness`]). At a matt surface the positions
    /// of lights predict their contributions well enough to choose one of them ([`Lights::sample`]); at a glossy one
    /// only their evaluation does.
    #[inline]
    pub fn asks_each(&self, roughness: impl FnOnce() -> f64) -> bool {
        self.few > 0 && (f64::MIN_POSITIVE..=GLOSS).contains(&roughness())
    }

    /// How a shape scatters that is surrounded by nothing, if it does so alike everywhere; in a scene of
    /// [`ShadingVariant::Plain`] each does, and is diffuse.
    #[inline]
    pub fn constant(&self, shape: u32, is_front: bool) -> Option<&BsdfMix> {
        self.constants[shape as usize].as_ref().map(|[front, back]| if is_front { front } else { back })
    }

    /// What a shape reflects on the front and on the back, if each side scatters light by one diffuse colour.
    #[inline]
    pub fn diffuse(&self, shape: u32) -> Option<[Rgb; 2]> {
        self.diffuse[shape as usize]
    }

    /// How many kinds there are of what scatters: those of [`AnyBsdf`], and what is of no one of them.
    pub const KINDS: usize = AnyBsdf::KINDS + 1;

    /// The kind of what scatters by one colour at a point.
    pub const DIFFUSE: usize = AnyBsdf::DIFFUSE;

    /// In place of the kind of what is not known beforehand, or scatters by several.
    pub const MIXED: usize = AnyBsdf::KINDS;

    /// By which kind of function a shape scatters that is surrounded by nothing; it may be another on the back.
    #[inline]
    pub fn kind(&self, shape: u32, is_front: impl FnOnce() -> bool) -> usize {
        let [front, back] = self.kinds[shape as usize];
        (if front == back || is_front() { front } else { back }).into()
    }

    /// The variant of shading that has what the scene needs, and the least beyond.
    pub fn variant(&self) -> ShadingVariant {
        ShadingVariant::ALL.into_iter().find(|&variant| self.suits(variant)).unwrap_or(ShadingVariant::General)
    }

    /// Whether a variant has what the scene needs.
    pub fn suits(&self, variant: ShadingVariant) -> bool {
        let needs = &self.needs;
        match variant {
            ShadingVariant::Plain => {
                !(needs.scattering
                    || needs.instances
                    || needs.points.any()
                    || needs.masks
                    || needs.interiors
                    || needs.waves
                    || needs.media)
            }
            ShadingVariant::Open => !(needs.masks || needs.nested || needs.media || needs.points.width || needs.waves),
            ShadingVariant::General => true,
        }
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
        // Said of those only who have it.
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
            assert_eq!(scene.plan().variant(), ShadingVariant::Plain);
            assert!(ShadingVariant::ALL.into_iter().all(|variant| scene.plan().suits(variant)));
            let has: Vec<_> = scene.plan().rows().into_iter().filter(|row| row.1).map(|row| row.0).collect();
            assert_eq!(has, ["light"]);
        }
    }

    /// What encloses something, or may be passed.
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
        let sheet = |material: Odd| Shape {
            material: Arc::new(material),
            ..shape(rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.5; 3], 0.0)
        };
        let plan = |shapes| crate::fixtures::scene(SceneDescription { shapes, ..Default::default() }).plan().clone();
        assert_eq!(plan(vec![sheet(glass())]).variant(), ShadingVariant::Open);
        assert_eq!(plan(vec![sheet(glass()), sheet(glass())]).variant(), ShadingVariant::General);
        let mask = Odd { interior: None, is_opaque: false };
        assert_eq!(plan(vec![sheet(mask)]).variant(), ShadingVariant::General);
    }
}
