use raywright::math::DVec3;
use raywright::optics::{Bsdf, Diffuse, Mirror, Rgb};
use raywright::scene::materials::BsdfMix;
use raywright::scene::textures::{Needs, Value};
use raywright::scene::{Material, ShadingPoint, SurfacePoint};

/// A color under a lacquer that mirrors an even share of the light.
#[derive(Debug)]
struct Lacquer {
    /// Of the light that the lacquer lets through; a constant or a texture.
    color: Value,
    gloss: f64,
}

impl Material for Lacquer {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        let base = Diffuse { reflectance: self.color.at(&at.texture) };
        let gloss = Mirror { reflectance: Rgb::ONE };
        BsdfMix::mixed((Rgb::splat(1.0 - self.gloss), base.into()), (Rgb::splat(self.gloss), gloss.into()))
    }

    // Scenes compute texture inputs at a hit only if some texture needs them.
    fn needs(&self) -> Needs {
        self.color.needs()
    }

    fn validate(&self) -> Result<(), String> {
        let is_share = (0.0..=1.0).contains(&self.gloss);
        is_share.then_some(()).ok_or_else(|| format!("gloss must be from 0 to 1, got {}", self.gloss))
    }
}

#[test]
fn a_lacquer_gives_back_no_more_than_it_gets() {
    let lacquer = |gloss| Lacquer { color: Rgb::splat(0.5).into(), gloss };
    assert_eq!(lacquer(0.2).validate(), Ok(()));
    assert!(lacquer(1.2).validate().is_err());
    let point = SurfacePoint {
        position: DVec3::ZERO,
        error: 0.0,
        normal: DVec3::Z,
        shading_normal: DVec3::Z,
        shape: 0,
        inner: None,
    };
    let bsdf = lacquer(0.2).bsdf(&ShadingPoint::plain(point));
    assert!((bsdf.albedo().mean() - (0.8 * 0.5 + 0.2)).abs() < 1e-12);
}
