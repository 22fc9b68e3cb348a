//! The combinations of media that points of a scene are in, each once: a path holds their number.

use crate::media::current_medium::Filled;
use crate::nesting::MediumStack;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::spectra::Waves;
use raywright_scene::Scene;
use raywright_scene::media::{Coefficients, Medium};
use std::collections::HashMap;

/// The combinations of media that points of a scene are in, each once.
pub(super) struct MediumStacks<'a> {
    scene: &'a Scene,
    /// True if media scatter light; else they only dim it.
    pub scatters: bool,
    all: Vec<KnownStack<'a>>,
    numbers: HashMap<[(u32, u32); MediumStack::<Filled>::MOST], u32>,
}

/// A combination of media.
#[derive(Clone, Copy)]
pub(super) struct KnownStack<'a> {
    pub media: MediumStack<Filled>,
    /// The medium that exists there, `None` in empty space; and the shape that it fills, `None` around everything.
    pub medium: Option<&'a dyn Medium>,
    shape: Option<(u32, u32)>,
    /// Coefficients of a homogeneous medium that scatters.
    even: Option<Coefficients>,
}

impl<'a> MediumStacks<'a> {
    pub fn new(scene: &'a Scene, scatters: bool) -> Self {
        Self { scene, scatters, all: Vec::new(), numbers: HashMap::new() }
    }

    pub fn get(&self, number: u32) -> &KnownStack<'a> {
        &self.all[number as usize]
    }

    /// Forget all if there are many, and return whether there were.
    pub fn forget_many(&mut self) -> bool {
        const MANY: usize = 4096;
        let are_many = self.all.len() > MANY;
        if are_many {
            self.all.clear();
            self.numbers.clear();
        }
        are_many
    }

    /// Return the number of a combination.
    pub fn number(&mut self, media: &MediumStack<Filled>) -> u32 {
        let mut shapes = [(u32::MAX, u32::MAX); MediumStack::<Filled>::MOST];
        for (to, filled) in shapes.iter_mut().zip(media.interiors()) {
            *to = filled.shape();
        }
        *self.numbers.entry(shapes).or_insert_with(|| {
            self.all.push(KnownStack::of(self.scene, *media, self.scatters));
            self.all.len() as u32 - 1
        })
    }
}

impl<'a> KnownStack<'a> {
    fn of(scene: &'a Scene, media: MediumStack<Filled>, scatters: bool) -> Self {
        let shape = media.top().map(Filled::shape);
        let medium = match shape {
            None => scene.surrounding(),
            Some((primitive, inner)) => {
                scene.material_of(&Hit { primitive, inner, ..Hit::MISS }).medium().map(|medium| &**medium)
            }
        };
        let even = medium
            .filter(|medium| scatters && medium.is_even() && medium.scatters())
            .map(|medium| medium.at(DVec3::ZERO));
        Self { media, medium, shape, even }
    }

    /// Return the coefficients of a homogeneous medium that scatters at some wavelengths.
    #[inline]
    pub fn even(&self, waves: Option<&Waves>) -> Option<Coefficients> {
        let here = match (self.even, self.medium, waves) {
            (Some(here), Some(medium), Some(waves)) => medium.by_waves(here, waves),
            (here, ..) => here?,
        };
        Some(here).filter(|here| !here.scattering.is_black())
    }

    /// Return the medium of a ray, and the ray in the medium's space.
    #[inline]
    pub fn around(&self, scene: &Scene, ray: &Ray) -> Option<(&'a dyn Medium, Ray)> {
        let medium = self.medium?;
        match self.shape {
            None => Some((medium, *ray)),
            Some((primitive, inner)) => Some((medium, scene.geometry().entered(ray, primitive, inner)?)),
        }
    }
}
