//! Different materials on front and back.

use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::Needs;
use raywright_base::math::DVec3;
use raywright_optics::{AnyBsdf, Rgb};
use std::sync::Arc;

/// A sheet with one material on the side of its normals and another behind. Neither transmits light.
#[derive(Clone, Debug)]
pub struct TwoSided {
    /// Material on the side of the normals.
    pub front: Arc<dyn Material>,
    /// Material on the opposite side.
    pub back: Arc<dyn Material>,
}

impl TwoSided {
    fn side(&self, at: &ShadingPoint) -> &dyn Material {
        if at.is_front { &*self.front } else { &*self.back }
    }
}

impl Material for TwoSided {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.side(at).bsdf(at)
    }

    fn constant_sides(&self) -> Option<[AnyBsdf; 2]> {
        let ([front, _], [_, back]) = (self.front.constant_sides()?, self.back.constant_sides()?);
        Some([front, back])
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        Some([self.front.kinds()?[0], self.back.kinds()?[1]])
    }

    fn needs(&self) -> Needs {
        self.front.needs() | self.back.needs()
    }

    fn validate(&self) -> Result<(), String> {
        for (name, side) in [("front", &self.front), ("back", &self.back)] {
            side.validate().map_err(|why| format!("in {name}: {why}"))?;
            if side.transmits() {
                return Err(format!("{name} must not transmit light"));
            }
            if !side.is_opaque() {
                return Err(format!("{name} must not have a mask; give it to the whole material"));
            }
        }
        Ok(())
    }

    fn minds_outside(&self) -> bool {
        self.front.minds_outside() || self.back.minds_outside()
    }

    fn normal(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.side(at).normal(at)
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.side(at).tangent(at)
    }

    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.side(at).ambient(at)
    }
}
