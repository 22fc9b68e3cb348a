//! Rotated bounding boxes: the same bits, and correct ones.

use super::super::cases;
use super::triangles::{Random, Triangles, agreed, bits, hits, levels};
use super::{cones, nearest};
use raywright::accel::bvh::{self, Options};
use raywright::accel::{Accelerator, BruteForce};
use raywright::math::{DVec3, Hit, Ray, Vec3};

/// Return orthonormal axes.
fn axes(random: &mut Random) -> [DVec3; 3] {
    let x = random.point(1.0).normalize();
    let y = x.cross(random.point(1.0)).normalize();
    [x, y, x.cross(y)]
}

/// Return the triangles of long thin boxes along some axes.
fn beams(random: &mut Random, axes: &[DVec3; 3], count: usize, place: impl Fn(DVec3) -> DVec3) -> Triangles {
    let mut all = Vec::new();
    for _ in 0..count {
        let (middle, way) = (random.point(1.0), random.below(3));
        let half = [0, 1, 2].map(|i| random.between(0.5, 1.5) * if i == way { 0.4 } else { 0.004 });
        let corner = |signs: usize| {
            let sides = [0, 1, 2].map(|i| axes[i] * half[i] * if signs >> i & 1 == 1 { 1.0 } else { -1.0 });
            place(middle + sides[0] + sides[1] + sides[2]).as_vec3()
        };
        for axis in 0..3 {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            for side in [0, 1 << axis] {
                let [a, b, c, d] = [side, side | u, side | u | v, side | v].map(corner);
                all.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Triangles(all)
}

/// Assert that the default tree has rotated boxes.
fn assert_turned(tree: &dyn Accelerator) {
    assert!(tree.info().kind.contains(", turned, "), "{}", tree.info().kind);
}

fn widest(triangles: &Triangles) -> Box<dyn Accelerator> {
    bvh::widest(triangles, &Options::DEFAULT, levels().last().unwrap())
}

#[test]
fn rays_at_any_distance_and_size() {
    let mut random = Random(61);
    for (scale, shift) in [(1.0, 0.0), (1e-20, 0.0), (1e15, 0.0), (1.0, 300.0)] {
        let axes = axes(&mut random);
        let shift = random.point(shift);
        let beams = beams(&mut random, &axes, 40, |p| p * scale + shift);
        assert_turned(widest(&beams).as_ref());
        let mut rays = random.aimed(&beams, cases(400) as usize, 3.0 * scale);
        for ray in &mut rays {
            ray.origin += shift;
        }
        // Along the axes of the boxes, exactly and nearly; in the planes of faces, from near and far.
        for _ in 0..cases(400) {
            let way = random.of(&axes) * random.of(&[1.0, -1.0]);
            let way = way + random.of(&[0.0, 1e-9, 1e-6, 1e-3]) * random.point(1.0);
            let target = random.target(&beams);
            let distance = random.of(&[0.0, 0.3, 3.0, 40.0, 1e3, 1e6]) * scale;
            rays.push(Ray::new(target - way * distance, way));
        }
        assert!(hits(&agreed(&beams, &rays)) > rays.len() / 4);
    }
}

#[test]
fn points_find_their_nearest() {
    let mut random = Random(62);
    let axes = axes(&mut random);
    let beams = beams(&mut random, &axes, 25, |p| p);
    assert_turned(widest(&beams).as_ref());
    let reach = |i: u32| [1.0, 3.0, 1e4, 1e7][i as usize % 4];
    let mut points: Vec<_> = (0..cases(200)).map(|i| random.point(reach(i))).collect();
    // Equidistant from two triangles: next to a shared vertex or edge.
    points.extend((0..cases(200)).map(|_| random.target(&beams) + random.of(&[0.0, 1e-3, 0.1]) * random.of(&axes)));
    nearest::assert_right(&(&beams).into(), &points);
    // So far away that only the comparison of all triangles finds the nearest.
    let far: Vec<_> = (0..cases(60)).map(|i| random.point([1e9, 1e30, 1e300][i as usize % 3])).collect();
    nearest::agreed(&(&beams).into(), &far, &[f64::INFINITY]);
}

#[test]
fn cones_touch_what_they_touch() {
    let mut random = Random(63);
    let axes = axes(&mut random);
    let beams = beams(&mut random, &axes, 40, |p| p);
    assert_turned(widest(&beams).as_ref());
    for reach in [1.0, 3.0, 1e4] {
        let cones = cones::cones(&mut random, &beams, cases(120) as usize, reach);
        cones::agreed(&beams, &cones);
    }
}

#[test]
fn what_moves_keeps_its_axes() {
    let mut random = Random(64);
    let axes = axes(&mut random);
    let before = beams(&mut random, &axes, 40, |p| p);
    let tree = widest(&before);
    assert_turned(tree.as_ref());
    let after =
        Triangles(before.0.iter().map(|corners| corners.map(|c| c * 3.0 + Vec3::new(c.y, c.z, c.x) * 0.2)).collect());
    let tree = tree.refitted(&after).unwrap();
    tree.validate(&after).unwrap();
    assert!(tree.validate(&before).is_err());
    let rays = random.aimed(&after, cases(1000) as usize, 5.0);
    let (mut found, mut wanted) = (vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]);
    tree.intersect(&rays, &mut found);
    BruteForce::over(&after, levels().last().unwrap()).intersect(&rays, &mut wanted);
    assert!(found.iter().map(bits).eq(wanted.iter().map(bits)) && hits(&found) > rays.len() / 2);
}
