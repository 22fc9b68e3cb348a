//! Kernels: each gives the hits of brute force at each level, for single rays, small batches, coherent and incoherent
//! ones.

use super::super::fans::{Soup, fans, soup, soups, sticks};
use super::triangles::levels;
use raywright::accel::bvh::{self, Options};
use raywright::accel::{Accelerator, BruteForce};
use raywright::math::{Hit, HitColumns, Numbers, Ray, RayColumns, Vectors};

/// The same rays in an incoherent order.
fn scattered(rays: &[Ray]) -> Vec<Ray> {
    let mut rays = rays.to_vec();
    rays.sort_by_key(|r| (r.direction.x.to_bits() ^ r.origin.y.to_bits()).wrapping_mul(0x9e37_79b9));
    rays
}

/// Trace rays in batches of a size, and compare closest hits and occlusion.
fn agrees(tree: &dyn Accelerator, rays: &[Ray], wanted: &[Hit], at_once: usize) {
    for (rays, wanted) in rays.chunks(at_once).zip(wanted.chunks(at_once)) {
        let mut hits = vec![Hit::MISS; rays.len()];
        tree.intersect(rays, &mut hits);
        assert_eq!(hits, wanted, "{}, {at_once} at once", tree.info().kind);
        let mut any = vec![false; rays.len()];
        tree.occluded(rays, &mut any);
        assert!(any.iter().zip(wanted).all(|(&any, hit)| any == hit.is_hit()), "{}", tree.info().kind);
    }
}

#[test]
fn kernels_agree_with_brute_force_bit_for_bit() {
    let mut met = 0;
    for triangles in soups().into_iter().chain([sticks()]) {
        for is_single in [true, false] {
            let soup = Soup { triangles: triangles.clone(), is_single };
            let brute = BruteForce::over(&soup, levels().last().unwrap());
            let trees: Vec<_> = levels()
                .flat_map(|level| [4, 8].map(|width| (level, width)))
                .filter(|(level, width)| *width <= level.lanes())
                .map(|(level, width)| bvh::wide(width, &soup, &Options::DEFAULT, level))
                .collect();
            for fan in fans() {
                let scattered = scattered(&fan);
                for rays in [fan, scattered] {
                    let mut wanted = vec![Hit::MISS; rays.len()];
                    brute.intersect(&rays, &mut wanted);
                    met += wanted.iter().filter(|h| h.is_hit()).count();
                    for tree in &trees {
                        agrees(&**tree, &rays, &wanted, rays.len());
                        agrees(&**tree, &rays[..70], &wanted, 7);
                        agrees(&**tree, &rays[..40], &wanted, 1);
                    }
                }
            }
        }
    }
    assert!(met > 50_000, "{met} rays hit anything");
}

/// Pass rays as columns, in f32 if possible.
fn by_columns(rays: &[Ray], single: bool, ask: impl FnOnce(&RayColumns<'_>)) {
    let column = |of: fn(&Ray) -> f64| rays.iter().map(of).collect::<Vec<f64>>();
    let origin = [column(|r| r.origin.x), column(|r| r.origin.y), column(|r| r.origin.z)];
    let direction = [column(|r| r.direction.x), column(|r| r.direction.y), column(|r| r.direction.z)];
    let (t_min, t_max) = (column(|r| r.t_min), column(|r| r.t_max));
    let small = |columns: &[Vec<f64>; 3]| columns.each_ref().map(|c| c.iter().map(|&x| x as f32).collect::<Vec<_>>());
    let (small_origin, small_direction) = (small(&origin), small(&direction));
    let (origin, direction) = if single {
        (
            Vectors::Single(small_origin.each_ref().map(Vec::as_slice)),
            Vectors::Single(small_direction.each_ref().map(Vec::as_slice)),
        )
    } else {
        (
            Vectors::Double(origin.each_ref().map(Vec::as_slice)),
            Vectors::Double(direction.each_ref().map(Vec::as_slice)),
        )
    };
    ask(&RayColumns::new(origin, direction, Numbers::Each(&t_min), Numbers::Each(&t_max)));
}

#[test]
fn rays_by_columns_are_answered_as_the_same_rays_one_after_the_other() {
    let soup = Soup { triangles: soup(), is_single: true };
    for level in levels() {
        let tree = bvh::widest(&soup, &Options::DEFAULT, level);
        let columns = tree.by_columns().expect("a tree over triangles");
        for (which, mut rays) in fans().into_iter().enumerate() {
            let single = which % 2 == 1;
            if single {
                for ray in &mut rays {
                    (ray.origin, ray.direction) = (ray.origin.as_vec3().as_dvec3(), ray.direction.as_vec3().as_dvec3());
                }
            }
            // Incoherent as well, in batches of every remainder.
            if which % 3 == 2 {
                rays.sort_by_key(|r| (r.direction.x.to_bits() ^ r.origin.y.to_bits()).wrapping_mul(0x9e37_79b9));
            }
            rays.truncate(640 - 37 * which);
            let mut wanted = vec![Hit::MISS; rays.len()];
            tree.intersect(&rays, &mut wanted);
            let (mut t, mut uv, mut primitive) =
                (vec![0.0; rays.len()], vec![[0.0; 2]; rays.len()], vec![0; rays.len()]);
            let mut any = vec![false; rays.len()];
            by_columns(&rays, single, |rays| {
                let hits = HitColumns { t: &mut t, uv: &mut uv, primitive: &mut primitive };
                columns.intersect(rays, hits);
                columns.occluded(rays, &mut any);
            });
            for (i, hit) in wanted.iter().enumerate() {
                assert_eq!((t[i], uv[i], primitive[i]), (hit.t, hit.uv, hit.primitive as i32), "{:?}", rays[i]);
                assert_eq!(any[i], hit.is_hit());
            }
        }
    }
}
