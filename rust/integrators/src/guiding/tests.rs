//! Cones, images and cells, against closed forms.

use super::Guide;
use super::cells::Cells;
use super::lobe::Lobe;
use super::photon::Photon;
use super::photon_tracing::photons;
use super::portals::Portals;
use super::training::Visit;
use raywright_base::math::DVec3;
use raywright_base::sampling::{Sampler, warp};
use raywright_base::simd::Level;
use raywright_base::workers::Cancel;
use raywright_scene::fixtures::{cornell, rectangle, scene, shape};
use raywright_scene::materials::MirrorMaterial;
use raywright_scene::{PointLight, Scene, SceneDescription, Shape};
use std::f64::consts::TAU;
use std::sync::Arc;

fn photon(position: DVec3, target: DVec3) -> Photon {
    Photon { position, normal: DVec3::Z, target, flux: 1.0, chain: 0 }
}

/// Return photons on the plane z = 0 in a square of this size, from the image of a lamp in the mirror x = 1.
fn mirrored(lamp: DVec3, size: f64, count: u32) -> Vec<Photon> {
    let image = DVec3::new(2.0 - lamp.x, lamp.y, lamp.z);
    (0..count)
        .map(|number| {
            let [u, v] = Sampler::new(3, 0, number).two(0);
            let position = DVec3::new(size * (u - 0.5), size * (v - 0.5), 0.0);
            photon(position, position + (image - position) * ((1.0 - position.x) / (image.x - position.x)))
        })
        .collect()
}

#[test]
fn cones_have_the_density_of_their_solid_angle() {
    for (distance, radius) in [(1.0, 1.0), (3.0, 0.5), (0.1, 2.0), (1.0, 1e-3), (1e6, 100.0)] {
        let middle = DVec3::new(0.3, -0.4, 1.2).normalize() * distance;
        let apart = radius / 2.0;
        let lobe = Lobe::around(
            &[photon(DVec3::ZERO, middle - apart * DVec3::X), photon(DVec3::ZERO, middle + apart * DVec3::X)],
            0.0,
        );
        // The extent of two photons is enlarged by a factor of two.
        let angle = radius.atan2(distance);
        let solid = 2.0 * TAU * (angle / 2.0).sin().powi(2);
        let axis = middle / distance;
        for number in 0..1000 {
            let direction = lobe.drawn(0.25).sample(DVec3::ZERO, Sampler::new(1, 0, number).two(0));
            assert!((direction.length() - 1.0).abs() < 1e-14);
            assert!(axis.cross(direction).length().atan2(axis.dot(direction)) <= angle * (1.0 + 1e-6));
            let pdf = lobe.drawn(0.25).pdf(DVec3::ZERO, axis + (direction - axis) * 0.99);
            assert!((pdf * solid / 0.25 - 1.0).abs() < 1e-9, "{distance} {radius}: {pdf}");
        }
        let beside = (axis * angle.cos() + axis.any_orthonormal_vector() * angle.sin() * 1.01).normalize();
        assert_eq!(lobe.pdf(DVec3::ZERO, beside), 0.0);
    }
}

#[test]
fn an_image_is_followed_where_it_goes() {
    let lamp = DVec3::new(0.2, 0.1, 2.0);
    let lobe = Lobe::around(&mirrored(lamp, 0.1, 64), 0.1);
    // From places without photons; the remaining error is of second order.
    for place in [DVec3::new(0.02, -0.03, 0.0), DVec3::new(-0.03, 0.02, 0.0)] {
        let image = DVec3::new(1.8, 0.1, 2.0) - place;
        let seen = place + image * ((1.0 - place.x) / image.x);
        assert!(lobe.target(place).distance(seen) < 2e-3);
        assert!(lobe.pdf(place, image.normalize()) > 1e3);
    }
}

#[test]
fn two_lamps_are_told_apart() {
    let mut both = mirrored(DVec3::new(0.2, 0.3, 2.0), 0.1, 40);
    both.extend(mirrored(DVec3::new(0.2, -0.3, 2.0), 0.1, 20));
    let mut each = Vec::new();
    Lobe::divide(&mut both, 0.1, 3, &mut each);
    let light_from = |side: f64| -> f64 {
        let of_side = |lobe: &Lobe| lobe.target(DVec3::ZERO).y * side > 0.1;
        each.iter().filter(|(lobe, _)| of_side(lobe)).map(|(_, light)| light).sum()
    };
    assert_eq!([light_from(1.0), light_from(-1.0)], [40.0, 20.0]);
}

#[test]
fn cells_are_found_and_their_densities_integrate_to_one() {
    let photons: Vec<Photon> = (0..3000)
        .map(|number| {
            let mut sampler = Sampler::new(5, 0, number);
            let ([u, v], far) = (sampler.two(0), warp::uniform_sphere(sampler.two(1)));
            Photon { chain: u64::from(number % 5), ..photon(DVec3::new(u * u, v, 0.0), DVec3::Z + far) }
        })
        .collect();
    let guide = Guide { cells: Cells::of_photons(photons.clone(), 1.0) };
    assert!(photons.iter().all(|photon| guide.at(photon.position).is_some()));
    assert!(guide.at(DVec3::new(0.5, 0.5, 3.0)).is_none());
    for place in [DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.9, 0.6, 0.0)] {
        let local = guide.at(place).unwrap();
        assert!((0.1..=0.6).contains(&local.share()) && local.gain() >= 1.0);
        let count = 200_000;
        let evenly = |number| warp::uniform_sphere(Sampler::new(6, 0, number).two(0));
        let sum: f64 = (0..count).map(|number| local.pdf(Level::Scalar, evenly(number))).sum();
        // Cones are wide here: the standard deviation of the densities is below three times their mean.
        let integral = sum * 2.0 * TAU / f64::from(count);
        assert!((integral - 1.0).abs() < 4.0 * 3.0 / f64::from(count).sqrt(), "{integral}");
        for number in 0..1000 {
            let mut sampler = Sampler::new(7, 0, number);
            let drawn = local.sample(sampler.one(0), sampler.two(1));
            let density = local.pdf(Level::Scalar, drawn);
            assert!(density > 0.0);
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                assert_eq!(local.pdf(level, drawn), density, "{level:?}");
            }
        }
    }
}

/// A floor under a lamp, and a wall that is a mirror or not.
fn room(is_mirror: bool, lamp: f64, lights: Vec<Arc<dyn raywright_scene::Light>>) -> Scene {
    let wall = rectangle([1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]);
    let mut wall = shape(wall, [0.5; 3], 0.0);
    if is_mirror {
        wall.material = Arc::new(MirrorMaterial { reflectance: raywright_optics::Rgb::splat(0.8).into() });
    }
    let shapes: Vec<Shape> = vec![
        shape(rectangle([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]), [0.5; 3], 0.0),
        shape(rectangle([0.4, 1.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.1]), [0.0; 3], lamp),
        wall,
    ];
    scene(SceneDescription { shapes, lights })
}

fn guides(scene: &Scene) -> bool {
    Guide::of(scene, &Cancel::default()).is_some()
}

#[test]
fn there_are_none_where_none_can_be_found() {
    assert!(!guides(&cornell(4, 4).0));
    assert!(!guides(&room(false, 5.0, Vec::new())));
    assert!(!guides(&room(true, 0.0, Vec::new())));
    let point = || Arc::new(PointLight { position: DVec3::new(0.4, 1.0, 0.0), intensity: raywright_optics::Rgb::ONE });
    assert!(!guides(&room(true, 0.0, vec![point()])));
    assert!(guides(&room(true, 5.0, vec![point()])));
}

#[test]
fn threads_change_no_photon() {
    let scene = room(true, 5.0, Vec::new());
    let all = |threads| {
        let pool = raywright_base::workers::pool(Some(threads)).unwrap();
        let told = |p: &Photon| (p.position.to_array(), p.target.to_array(), p.flux, p.chain);
        pool.install(|| photons(&scene, &Cancel::default()).unwrap().iter().map(told).collect::<Vec<_>>())
    };
    let one = all(1);
    assert!(one.len() > 1000);
    assert_eq!(all(3), one);
}

#[test]
fn what_is_cancelled_is_not_kept() {
    let scene = room(true, 5.0, Vec::new());
    let cancel = Cancel::default();
    cancel.raise();
    assert!(Guide::of(&scene, &cancel).is_none());
    let found = Guide::of(&scene, &Cancel::default()).unwrap();
    // Later calls return the cached guide.
    assert!(Arc::ptr_eq(&Guide::of(&scene, &cancel).unwrap(), &found));
}

#[test]
fn light_is_the_rarer_the_smaller_what_it_comes_from() {
    // From a sphere above the center of a square. The cell is twice as wide, and direct light is as bright.
    let from_ball = |radius: f64| {
        let photons: Vec<Photon> = (0..64)
            .map(|number| {
                let mut sampler = Sampler::new(9, 0, number);
                let [u, v] = sampler.two(0);
                let ball = DVec3::new(0.5, 0.5, 2.0) + radius * warp::uniform_sphere(sampler.two(1));
                Photon { flux: 1.0 / 64.0, ..photon(DVec3::new(u, v, 0.0), ball) }
            })
            .collect();
        Guide { cells: Cells::of_photons(photons, 0.25) }.at(DVec3::new(0.5, 0.5, 0.0)).unwrap().rarity()
    };
    for radius in [0.5, 0.05, 0.005] {
        // Half of the light, squared, over the share of directions that the sphere fills.
        let told = from_ball(radius) / (0.25 * 4.0 / (radius * radius));
        assert!((0.3..3.0).contains(&told), "{radius}: {told}");
    }
}

/// A visit from a point of a cube by a segment through another point, to one of the wall x = 3.
fn visit_through(number: u32, through: impl Fn(&mut Sampler) -> DVec3) -> Visit {
    let mut sampler = Sampler::new(11, 0, number);
    let ([y, z], x) = (sampler.two(0), sampler.one(1));
    let position = DVec3::new(x, y, z) - 0.5;
    let way = through(&mut sampler) - position;
    Visit { photon: photon(position, position + way * ((3.0 - position.x) / way.x)), direct: 0.0, throughput: 1.0 }
}

#[test]
fn a_hole_is_found_among_random_directions() {
    let wall = |sampler: &mut Sampler, size: f64| {
        let [y, z] = sampler.two(2);
        DVec3::new(1.0, size * (y - 0.5), size * (z - 0.5))
    };
    for hole in [0.2, 0.05, 0.01] {
        // Half of the light.
        let size = |number: u32| if number.is_multiple_of(2) { hole } else { 2.0 };
        let visits: Vec<Visit> =
            (0..2000).map(|number| visit_through(number, |sampler| wall(sampler, size(number)))).collect();
        let portals = Portals::of(&visits, 3.0);
        let (lobe, usual) = portals.lobe(0, DVec3::ZERO);
        let center = lobe.target(DVec3::new(0.3, 0.2, 0.1));
        assert!(center.distance(DVec3::X) < hole, "{hole}: {center}");
        // The sphere around a square of side 1 has a radius of 0.71.
        let radius = (lobe.fills() / (1.0 - lobe.fills())).sqrt() * center.length();
        assert!((0.6..2.5).contains(&(radius / hole)), "{hole}: {radius}");
        let through = visits.iter().step_by(2).filter(|visit| portals.crossed(&visit.photon) == Some(0)).count();
        assert!(through > 950 && (0.45..0.65).contains(&usual), "{hole}: {through} {usual}");
    }
}

#[test]
fn random_directions_have_no_hole() {
    for seed in 0..20 {
        let visits: Vec<Visit> = (0..600)
            .map(|number| {
                let mut sampler = Sampler::new(12, seed, number);
                let mut point = |first| {
                    let [x, y] = sampler.two(first);
                    DVec3::new(x, y, sampler.one(first + 1))
                };
                Visit { photon: photon(point(0), point(2)), direct: 0.0, throughput: 1.0 }
            })
            .collect();
        assert_eq!(Portals::of(&visits, 1.0).len(), 0, "{seed}");
    }
}

#[test]
fn a_camera_has_a_guide_of_its_own_that_threads_do_not_change() {
    let (scene, camera) = cornell(4, 4);
    let (other, cancel) = (cornell(5, 4).1, Cancel::default());
    let raised = Cancel::default();
    raised.raise();
    assert!(Guide::learned(&scene, &camera, &raised).is_none());
    let found = Guide::learned(&scene, &camera, &cancel).unwrap();
    assert!(Arc::ptr_eq(&Guide::learned(&scene, &camera, &raised).unwrap(), &found));
    assert!(!Arc::ptr_eq(&Guide::learned(&scene, &other, &cancel).unwrap(), &found));
    let densities = |threads| {
        let pool = raywright_base::workers::pool(Some(threads)).unwrap();
        let scene = cornell(4, 4).0;
        let guide = pool.install(|| Guide::learned(&scene, &camera, &Cancel::default())).unwrap();
        let density = |number| {
            let mut sampler = Sampler::new(13, 0, number);
            let ([x, y], z) = (sampler.two(0), sampler.one(1));
            let (low, size) = (scene.region().min, scene.region().max - scene.region().min);
            let local = guide.at(low + size * DVec3::new(x, y, z)).unwrap();
            local.pdf(Level::Scalar, warp::uniform_sphere(sampler.two(2)))
        };
        (0..200).map(density).collect::<Vec<_>>()
    };
    let one = densities(1);
    assert!(one.iter().filter(|&&density| density > 0.0).count() > 100);
    assert_eq!(densities(3), one);
}
