//! Spatial subdivisions: bounded size on any input, deterministic for any number of threads, and no primitive tested
//! twice.

use super::triangles::{Random, Triangles, agreed, hits, levels};
use raywright::accel::kdtree::{Builder, Traversal};
use raywright::accel::walk::{Input, Lists, Mailbox, Structure};
use raywright::accel::{Accelerator, Cost, bsp, kdtree, octree, walked};
use raywright::math::{DVec3, Ray, Vec3};
use raywright::workers;

type Build = Box<dyn Fn(&Input) -> (Box<dyn Structure>, Lists) + Sync>;

/// All builders.
fn builds() -> Vec<(String, Build)> {
    let mut builds: Vec<(String, Build)> = Vec::new();
    for builder in Builder::ALL {
        let options = kdtree::Options { builder, ..kdtree::Options::DEFAULT };
        builds.push((format!("kD-tree, {}", builder.name()), Box::new(move |input| kdtree::build(input, &options))));
    }
    builds.push(("octree".into(), Box::new(|input| octree::build(input, &octree::Options::DEFAULT))));
    builds.push(("BSP tree".into(), Box::new(|input| bsp::build(input, &bsp::Options::DEFAULT))));
    builds
}

fn over(triangles: &Triangles, build: &Build) -> Box<dyn Accelerator> {
    walked(triangles, levels().last().unwrap(), Mailbox::Stamps, build)
}

fn costs(accelerator: &dyn Accelerator, rays: &[Ray]) -> Vec<Cost> {
    let mut costs = vec![Cost::default(); rays.len()];
    accelerator.cost(rays, &mut costs);
    costs
}

#[test]
fn many_copies_of_one_triangle_are_not_parted_for_ever() {
    let one = [Vec3::ZERO, Vec3::new(1.0, 0.3, 0.7), Vec3::new(-0.3, 1.0, 0.1)];
    let triangles = Triangles(vec![one; 200_000]);
    for (name, build) in builds() {
        let tree = over(&triangles, &build);
        tree.validate(&triangles).unwrap();
        assert!(tree.info().leaves <= 8, "{name}: {:?}", tree.info());
    }
}

#[test]
fn a_spray_of_needles_through_one_point_stays_bounded() {
    let mut random = Random(21);
    // All of them straddle every plane near the center.
    let needle = |_| {
        let (way, across) = (random.point(1.0), random.point(1e-3));
        [-way - across, -way + across, way].map(|p| p.as_vec3())
    };
    let triangles = Triangles((0..3000).map(needle).collect());
    let rays: Vec<_> = (0..100).map(|_| Ray::new(random.point(2.0), random.point(1.0))).collect();
    for (name, build) in builds() {
        let tree = over(&triangles, &build);
        tree.validate(&triangles).unwrap();
        let info = tree.info();
        // In blocks, a primitive takes 40 bytes per slot, with 9 slots per primitive and 64 more; leaves and nodes are
        // extra.
        let most = (9 * 3000 + 64) * 40 + 60 * info.leaves + 48 * info.nodes + 4096;
        assert!(info.bytes < most, "{name}: {info:?}");
        // No primitive is tested twice.
        assert!(costs(&*tree, &rays).iter().all(|cost| cost.primitives <= 3000), "{name}");
    }
    agreed(&triangles, &rays);
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let mut random = Random(22);
    let triangles = random.soup(20_000, 0.05);
    let rays = random.aimed(&triangles, 500, 2.0);
    for (name, build) in builds() {
        let on = |threads| {
            let pool = workers::pool(Some(threads)).unwrap();
            let tree = pool.install(|| over(&triangles, &build));
            let info = tree.info();
            let shape = (info.nodes, info.leaves, info.depth, info.bytes, info.sah_cost.to_bits());
            (shape, costs(&*tree, &rays))
        };
        assert_eq!(on(1), on(3), "{name}");
    }
}

#[test]
fn with_and_without_a_stack_rays_come_to_the_same_leaves() {
    let mut random = Random(23);
    let triangles = random.soup(3000, 0.1);
    let mut rays = random.aimed(&triangles, 500, 2.0);
    rays.extend((0..100).map(|_| Ray::new(random.grid(2), random.of(&[DVec3::X, -DVec3::Y, DVec3::Z, DVec3::ONE]))));
    for builder in Builder::ALL {
        let with = |traversal| -> Vec<u32> {
            let options = kdtree::Options { builder, traversal, ..kdtree::Options::DEFAULT };
            let build: Build = Box::new(move |input| kdtree::build(input, &options));
            costs(&*over(&triangles, &build), &rays).iter().map(|cost| cost.primitives).collect()
        };
        assert_eq!(with(Traversal::Stack), with(Traversal::Restart), "{builder:?}");
    }
}

#[test]
fn flat_scenes_and_few_triangles() {
    let mut random = Random(24);
    for axis in 0..3 {
        for count in [1, 2, 3, 400] {
            let mut triangles = random.soup(count, 0.3);
            // In one axis-aligned plane, which also contains rays along it.
            triangles.0.iter_mut().flatten().for_each(|p| p[axis] = 0.25);
            let mut rays = random.aimed(&triangles, 60, 2.0);
            let mut along = random.aimed(&triangles, 20, 1.0);
            along.iter_mut().for_each(|ray| (ray.origin[axis], ray.direction[axis]) = (0.25, 0.0));
            rays.extend(along);
            assert!(hits(&agreed(&triangles, &rays)) > 30);
        }
    }
}

#[test]
fn depths_and_leaves_are_as_asked_for() {
    let mut random = Random(25);
    let triangles = random.soup(2000, 0.1);
    for depth in [0, 1, 5] {
        let kd = kdtree::Options { max_depth: Some(depth), ..kdtree::Options::DEFAULT };
        let oct = octree::Options { max_depth: depth, leaf_size: 1 };
        let free = bsp::Options { max_depth: Some(depth), ..bsp::Options::DEFAULT };
        let builds: [Build; 3] = [
            Box::new(move |input| kdtree::build(input, &kd)),
            Box::new(move |input| octree::build(input, &oct)),
            Box::new(move |input| bsp::build(input, &free)),
        ];
        for build in builds {
            assert_eq!(over(&triangles, &build).info().depth, depth);
        }
    }
    let whole = kdtree::Options { leaf_size: 2000, ..kdtree::Options::DEFAULT };
    let tree = over(&triangles, &(Box::new(move |input: &Input| kdtree::build(input, &whole)) as Build));
    assert_eq!((tree.info().nodes, tree.info().leaves, tree.info().sah_cost), (0, 1, 2000.0));
}

#[test]
fn other_triangles_are_not_valid_and_are_not_refitted() {
    let mut random = Random(26);
    let triangles = random.soup(500, 0.1);
    let moved = Triangles(triangles.0.iter().map(|t| t.map(|p| p * Vec3::new(1.0, -0.5, 1.0))).collect());
    for (name, build) in builds() {
        let tree = over(&triangles, &build);
        assert!(tree.validate(&moved).is_err(), "{name}");
        assert!(tree.refitted(&moved).is_err(), "{name}");
    }
}

#[test]
fn free_planes_part_slanted_needles_at_less_cost() {
    // In one slanted plane, in any direction: axis-aligned planes cut many of them, and planes along them few.
    let mut random = Random(27);
    let mut needle = || {
        let [x, y] = [0; 2].map(|_| random.below(2048) as i32 - 1024);
        let [u, v] = [0; 2].map(|_| random.below(401) as i32 - 200);
        // Multiples of 1/1024: all are exactly in the plane.
        let at = |[u, v]: [i32; 2]| Vec3::from([x + u, y + v, -x - u - y - v].map(|k| k as f32 / 1024.0));
        [[0, 0], [u, v], [u - 4, v + 4]].map(at)
    };
    let triangles = Triangles((0..2000).map(|_| needle()).collect());
    let cost = |build: Build| over(&triangles, &build).info().sah_cost;
    let free = cost(Box::new(|input| bsp::build(input, &bsp::Options::DEFAULT)));
    let across_axes = cost(Box::new(|input| kdtree::build(input, &kdtree::Options::DEFAULT)));
    assert!(free < 0.8 * across_axes, "{free} and {across_axes}");
}
