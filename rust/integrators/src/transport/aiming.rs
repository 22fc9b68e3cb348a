//! Where guided paths go on to.

use super::block::Block;
use super::guided::density;
use raywright_base::math::{LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use raywright_optics::{BsdfSample, BsdfSampleLanes, Null, RgbLanes};
use raywright_scene::{Interaction, SurfaceInteractionLanes};
use std::array;

/// Which of the lanes that go on aim, by their choices; what is left of these is uniform again.
#[inline]
pub(super) fn aiming(block: &Block, goes: &[bool; LANES], choice: &mut [f64; LANES]) -> [bool; LANES] {
    let mut aims = [false; LANES];
    for lane in (0..LANES).filter(|&lane| goes[lane]) {
        if let Some(guide) = &block.guides[lane] {
            let (share, chosen) = (guide.share(), choice[lane]);
            aims[lane] = chosen < share;
            let left = if aims[lane] { chosen / share } else { (chosen - share) / (1.0 - share) };
            choice[lane] = left.min(1f64.next_down());
        }
    }
    aims
}

loops! {
    /// From directions to what they are in the shading frames, how much light from there counts, and the rays that
    /// leave along them.
    fn look(
        encounters: &SurfaceInteractionLanes,
        towards: &VectorLanes,
        wi: &mut VectorLanes,
        counts: &mut [f64; LANES],
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
    ) {
        for i in 0..LANES {
            let here = encounters.faded(i, Null);
            let (local, fading) = here.seen_from(towards.get(i));
            let ray = here.ray_origin().ray(towards.get(i));
            wi.set(i, local);
            counts[i] = fading;
            origin.set(i, ray.origin);
            direction.set(i, ray.direction);
        }
    }
}

/// Of some lanes that go on, directions of those that aim, and with all of them the density of aiming and scattering
/// together (Veach and Guibas, 1995: the one-sample model). What surfaces have drawn is there for the others, in the
/// world, and the rays that leave; in `denser`, how much denser it becomes. `numbers` are what is left of the choices
/// ([`aiming`]), and those for directions.
pub(super) fn aim(
    level: Level,
    block: &Block,
    (goes, aims): (&[bool; LANES], &[bool; LANES]),
    (choice, u): (&[f64; LANES], &Pairs),
    drawn: &mut BsdfSampleLanes,
    [origin, direction]: [&mut VectorLanes; 2],
    denser: &mut [f64; LANES],
) {
    let guided = |lane: usize| if goes[lane] { block.guides[lane].as_ref() } else { None };
    for lane in 0..LANES {
        let Some(guide) = guided(lane).filter(|_| !aims[lane] && drawn.pdf[lane] > 0.0) else { continue };
        let pdf = drawn.pdf[lane];
        if pdf == f64::INFINITY {
            denser[lane] = 1.0 - guide.share();
        } else {
            drawn.pdf[lane] = density(level, guide, pdf, drawn.wi.get(lane));
            denser[lane] = drawn.pdf[lane] / pdf;
        }
        drawn.weight.set(lane, drawn.weight.get(lane) / denser[lane]);
    }
    if !aims.contains(&true) {
        return;
    }
    let mut towards = VectorLanes::ZERO;
    for lane in (0..LANES).filter(|&lane| aims[lane]) {
        if let Some(guide) = guided(lane) {
            towards.set(lane, guide.sample(choice[lane], [u[0][lane], u[1][lane]]));
        }
    }
    let ([mut wi, mut from, mut along], mut counts) = ([VectorLanes::ZERO; 3], [0.0; LANES]);
    look(level, &block.encounters, &towards, &mut wi, &mut counts, &mut from, &mut along);
    for lane in (0..LANES).filter(|&lane| aims[lane] && block.encounters.is_as_given(lane)) {
        counts[lane] = block.encounters.get(lane, Null).seen_from(towards.get(lane)).1;
    }
    let seen = array::from_fn(|lane| aims[lane] && counts[lane] > 0.0);
    let (mut value, mut pdf) = (RgbLanes::ZERO, [0.0; LANES]);
    block.bsdf.evaluate(level, &seen, block.encounters.wo_lanes(), &wi, &mut value, &mut pdf);
    for lane in (0..LANES).filter(|&lane| aims[lane]) {
        let scattered = value.get(lane) * counts[lane];
        let Some(guide) = guided(lane).filter(|_| seen[lane] && !scattered.is_black() && pdf[lane] > 0.0) else {
            drawn.set(lane, None);
            continue;
        };
        let both = density(level, guide, pdf[lane], towards.get(lane));
        drawn.set(lane, Some(BsdfSample::new(towards.get(lane), scattered / both, both)));
        origin.set(lane, from.get(lane));
        direction.set(lane, along.get(lane));
        denser[lane] = both / pdf[lane];
    }
}
