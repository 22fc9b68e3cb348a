//! Tests of every shape's points: positions, derivatives and sampling densities.

use super::*;
use raywright_base::math::{Affine, DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// One shape of each kind, none aligned with the axes.
fn shapes() -> Vec<Arc<dyn Shape>> {
    let (a, b) = (DVec3::new(0.3, -0.2, 0.5), DVec3::new(1.1, 0.9, -0.4));
    let mut shapes: Vec<Arc<dyn Shape>> = vec![
        Arc::new(Sphere { center: a, radius: 0.8 }),
        Arc::new(Disk { center: a, normal: b, radius: 1.2, inner_radius: 0.0 }),
        Arc::new(Disk { center: a, normal: b, radius: 1.2, inner_radius: 0.5 }),
        Arc::new(Cuboid { min: a - DVec3::ONE, max: b + DVec3::ONE }),
        Arc::new(Ellipsoid { center: a, semi_axes: DVec3::new(0.5, 1.5, 0.8) }),
    ];
    for capped in [false, true] {
        shapes.push(Arc::new(Revolution::cylinder(a, b, 0.6, capped)));
        shapes.push(Arc::new(Revolution::cone(a, b, [0.9, 0.4], capped)));
        shapes.push(Arc::new(Revolution::cone(a, b, [0.0, 0.7], capped)));
        shapes.push(Arc::new(Revolution::paraboloid(a, b, 0.8, capped)));
    }
    let map = skew();
    let placed: Vec<Arc<dyn Shape>> = shapes
        .iter()
        .map(|shape| Arc::new(Placed::new(shape.clone(), map.clone()).unwrap()) as Arc<dyn Shape>)
        .collect();
    shapes.extend(placed);
    shapes
}

/// A map that mirrors, shears and stretches.
fn skew() -> Affine {
    let rows = [DVec3::new(0.7, 0.4, -0.1), DVec3::new(0.2, -1.3, 0.3), DVec3::new(-0.3, 0.1, 0.9)];
    Affine::new(rows, DVec3::new(0.4, -0.3, 0.2))
}

fn at(shape: &dyn Shape, uv: [f64; 2]) -> Point {
    shape.point(&Ray::new(DVec3::ZERO, DVec3::X), 0.0, uv)
}

/// Parameters over the whole unit square, off the borders of faces and caps.
fn places() -> impl Iterator<Item = [f64; 2]> {
    (0..29).flat_map(|i| (0..31).map(move |j| [(f64::from(i) + 0.37) / 29.0, (f64::from(j) + 0.41) / 31.0]))
}

#[test]
fn derivatives_are_those_of_positions_and_normals() {
    for shape in shapes() {
        let mut smooth = 0;
        for uv in places() {
            let point = at(&*shape, uv);
            assert!((point.normal.length() - 1.0).abs() < 1e-14);
            let across = point.dp[0].cross(point.dp[1]);
            assert!(across.normalize().dot(point.normal).abs() > 1.0 - 1e-10, "{shape:?} {uv:?}");
            for i in 0..2 {
                const STEP: f64 = 1e-6;
                let [less, more] = [-STEP, STEP].map(|step| {
                    let mut uv = uv;
                    uv[i] += step;
                    at(&*shape, uv)
                });
                if (less.normal - more.normal).length() > 0.1 {
                    // A rim or an edge separates the two samples.
                    continue;
                }
                smooth += 1;
                let (dp, dn) =
                    ((more.position - less.position) / (2.0 * STEP), (more.normal - less.normal) / (2.0 * STEP));
                assert!((dp - point.dp[i]).length() < 1e-6 * (1.0 + dp.length()), "{shape:?} {uv:?} {i}");
                assert!((dn - point.dn[i]).length() < 1e-6 * (1.0 + dn.length()), "{shape:?} {uv:?} {i}");
            }
        }
        assert!(smooth > 1700);
    }
}

#[test]
fn a_ray_to_a_point_finds_it_and_its_coordinates() {
    for shape in shapes() {
        let bounds = shape.bounds();
        for uv in places() {
            let wanted = at(&*shape, uv);
            assert!(wanted.position.cmpge(bounds.min).all() && wanted.position.cmple(bounds.max).all());
            let ray = Ray::new(wanted.position + wanted.normal * 1e-3, -wanted.normal * 2.0);
            let mut found = None;
            shape.meet(&ray, &mut |met| {
                found = Some(met);
                true
            });
            let met = found.unwrap();
            assert!((met.t - 5e-4).abs() < 1e-14, "{shape:?} {uv:?} {met:?}");
            for (x, y) in met.uv.iter().zip(uv) {
                assert!((x - y).abs() < 1e-12, "{shape:?} {uv:?} {met:?}");
            }
            let point = shape.point(&ray, met.t, met.uv);
            assert!((point.position - wanted.position).length() < 1e-14 * 4.0);
            assert!(point.error < 1e-14);
        }
    }
}

#[test]
fn points_lie_on_the_surface_to_within_their_error() {
    for shape in shapes() {
        for uv in places() {
            let shorter = shape.site(&Ray::new(DVec3::ZERO, DVec3::X), 0.0, uv);
            for point in [at(&*shape, uv).site(), shorter] {
                // The distance to the surface along the normal is computed exactly.
                let mut least = f64::INFINITY;
                let ray = Ray { t_min: -1.0, ..Ray::new(point.position, point.normal) };
                shape.meet(&ray, &mut |met| {
                    least = least.min(met.t.abs());
                    false
                });
                assert!(least <= point.error * 3f64.sqrt(), "{shape:?} {uv:?}: {least:e} {:e}", point.error);
            }
            let (own, near) = (at(&*shape, uv).site(), 4.0 * (at(&*shape, uv).error + shorter.error));
            assert!((own.position - shorter.position).length() <= near, "{shape:?} {uv:?}");
            assert!((own.normal - shorter.normal).length() < 1e-14, "{shape:?} {uv:?}");
        }
    }
}

#[test]
fn boxes_touch_the_surface_on_all_sides() {
    for shape in shapes() {
        let bounds = shape.bounds();
        // A fine grid of points approaches the box on every side.
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for i in 0..=400 {
            for j in 0..=400 {
                let p = at(&*shape, [f64::from(i) / 400.0, f64::from(j) / 400.0]).position;
                (min, max) = (min.min(p), max.max(p));
            }
        }
        assert!(
            (min - bounds.min).abs().max_element() < 1e-2 && (max - bounds.max).abs().max_element() < 1e-2,
            "{shape:?}"
        );
        assert!(bounds.min.cmple(min).all() && bounds.max.cmpge(max).all(), "{shape:?}");
    }
    let plane = Plane { point: DVec3::new(1.0, 2.0, 3.0), normal: DVec3::new(0.0, 0.0, -2.0) };
    let bounds = plane.bounds();
    assert_eq!((bounds.min.z, bounds.max.z, bounds.min.x), (3.0, 3.0, f64::NEG_INFINITY));
    let moved = Placed::new(Arc::new(plane), Affine::translation(DVec3::Z)).unwrap().bounds();
    assert!(moved.min.z <= 4.0 && moved.max.z >= 4.0 && moved.max.z - moved.min.z < 1e-14);
}

/// The integral of |dp/du × dp/dv| over a cell of the unit square, weighted by a map's area stretch.
fn integral([u, v]: [f64; 2], [du, dv]: [f64; 2], shape: &dyn Shape, of: impl Fn(&Point) -> f64) -> f64 {
    let (columns, rows) = (12, 240);
    let mut sum = 0.0;
    for i in 0..columns {
        for j in 0..rows {
            let uv =
                [u + du * (f64::from(i) + 0.5) / f64::from(columns), v + dv * (f64::from(j) + 0.5) / f64::from(rows)];
            let point = at(shape, uv);
            sum += point.dp[0].cross(point.dp[1]).length() * of(&point);
        }
    }
    sum * du * dv / f64::from(columns * rows)
}

#[test]
fn areas_are_the_integrals_of_their_elements() {
    let cells = || (0..6).flat_map(|i| (0..6).map(move |j| [f64::from(i) / 6.0, f64::from(j) / 6.0]));
    for shape in shapes() {
        let whole: f64 = cells().map(|cell| integral(cell, [1.0 / 6.0; 2], &*shape, |_| 1.0)).sum();
        // A step of the integrand falls between two of 1440 rows.
        assert!((whole / shape.area() - 1.0).abs() < 1e-3, "{shape:?}: {whole} {}", shape.area());
    }
}

#[test]
fn areas_have_their_closed_forms() {
    let close = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-13, "{x} {y}");
    let top = DVec3::new(2.0, 4.0, 4.0);
    close(Revolution::cylinder(DVec3::ZERO, top, 0.5, false).area(), 6.0 * PI);
    close(Revolution::cylinder(DVec3::ZERO, top, 0.5, true).area(), 6.5 * PI);
    close(Revolution::cone(DVec3::ZERO, DVec3::Z * 4.0, [3.0, 0.0], true).area(), 24.0 * PI);
    // z = ρ² up to 2: π/6 (27 − 1).
    close(Revolution::paraboloid(DVec3::ZERO, DVec3::Z * 2.0, 2f64.sqrt(), false).area(), PI / 6.0 * 26.0);
    close(Cuboid { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.0) }.area(), 22.0);
    // A uniformly scaling map, and one that maps an ellipsoid back to a sphere.
    let turn =
        Affine::new([DVec3::new(0.0, 0.0, 2.0), DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0)], DVec3::ONE);
    for shape in shapes() {
        // Areas of the rotated paraboloid and cone are sums around the axis.
        let (moved, area) = (Placed::new(shape.clone(), turn.clone()).unwrap().area(), shape.area());
        assert!((moved / (4.0 * area) - 1.0).abs() < 1e-9, "{shape:?}");
    }
    let axes = DVec3::new(1.0, 1e-4, 1e4);
    let ellipsoid = Arc::new(Ellipsoid { center: DVec3::X, semi_axes: axes });
    let round = Placed::new(ellipsoid, Affine::scale(axes.recip())).unwrap();
    close(round.area(), 4.0 * PI);
    // A flattened cylinder approaches two rectangles.
    let flat = Affine::scale(DVec3::new(1.0, 1e-9, 1.0));
    let pressed = Placed::new(Arc::new(Revolution::cylinder(DVec3::ZERO, DVec3::Z * 3.0, 2.0, false)), flat).unwrap();
    assert!((pressed.area() / 24.0 - 1.0).abs() < 1e-8);
}

#[test]
fn points_are_drawn_by_area_with_their_density() {
    let shapes = shapes();
    let (own, back) = (shapes.len() / 2, skew().inverse().unwrap());
    for (name, shape) in shapes.iter().enumerate() {
        let mut counts = vec![0; 64];
        for i in 0..50_000 {
            let drawn = shape.sample(Sampler::new(3, name as u32, i).two(0)).unwrap();
            let [x, y] = drawn.point.uv.map(|x| ((x * 8.0) as usize).min(7));
            counts[8 * x + y] += 1;
        }
        // A uniformly sampled shape has a density of 1 / area. The ellipsoid samples the unit sphere uniformly and maps
        // the point. A placed shape keeps its samples: the inverse map undoes the area stretch.
        let (area, round) = (shapes[name % own].area(), format!("{shape:?}").contains("Ellipsoid"));
        let density = |point: &Point| {
            if round {
                let element = point.dp[0].cross(point.dp[1]).length();
                return TAU * PI * (PI * point.uv[1]).sin() / (4.0 * PI) / element;
            }
            if name < own { 1.0 / area } else { back.cofactors(point.normal).length() / area }
        };
        let cell = |i: usize| [(i / 8) as f64 / 8.0, (i % 8) as f64 / 8.0];
        let expected: Vec<f64> = (0..64).map(|i| integral(cell(i), [0.125; 2], &**shape, density)).collect();
        assert!((expected.iter().sum::<f64>() - 1.0).abs() < 2e-3, "{shape:?} {}", expected.iter().sum::<f64>());
        assert_frequencies(&counts, &expected);
        let drawn = shape.sample([0.3, 0.6]).unwrap();
        assert!((drawn.pdf / density(&drawn.point) - 1.0).abs() < 1e-9, "{shape:?}");
    }
}

/// A grid of equal cells of directions.
const ROWS: usize = 5;
const COLUMNS: usize = 6;

fn direction(z: f64, turn: f64) -> DVec3 {
    let (sin, cos) = (TAU * turn).sin_cos();
    let out = ((1.0 - z) * (1.0 + z)).sqrt();
    DVec3::new(out * cos, out * sin, z)
}

/// In each cell of directions the shape covers a solid angle. That angle is the mean of 1 / pdf over the sampled
/// directions in the cell if and only if they follow the reported density. Five standard errors are allowed, and three
/// of the grid that measures the solid angle. Frequencies are tested as well where the density has no poles, as it has
/// for a curved surface seen edge-on.
#[test]
fn directions_are_drawn_with_their_density() {
    const FINE: usize = 48;
    const DRAWS: u32 = 8000;
    let places = [DVec3::new(2.2, 1.4, 1.9), DVec3::new(0.6, 0.35, 0.1)];
    let shapes = shapes();
    let own = shapes.len() / 2;
    // All shapes in object space, and every third placed shape.
    for (name, shape) in (0..).zip(&shapes).filter(|(name, _)| (*name as usize) < own || name % 3 == 0) {
        let place = places[name as usize % 2];
        let mut counts = vec![0; ROWS * COLUMNS];
        let mut inverse = vec![(0.0, 0.0); ROWS * COLUMNS];
        for i in 0..DRAWS {
            // None is possible if rounding makes the ray miss its sample; it does not occur for these seeds.
            let drawn = shape.sample_from(place, Sampler::new(4, name, i).two(0)).unwrap();
            let way = drawn.point.position - place;
            let pdf = shape.pdf_from(place, way * 3.0);
            // Rounding the direction moves a point seen at grazing angle by 1 / cos of the rounding. The density is
            // proportional to 1 / cos, so its relative change is 1 / cos² of the rounding.
            let limit = 1e-9 + 1e-15 * pdf * pdf;
            assert!((pdf / drawn.pdf - 1.0).abs() < limit, "{shape:?}: {pdf} {}", drawn.pdf);
            let d = way.normalize();
            let row = (((d.z + 1.0) / 2.0 * ROWS as f64) as usize).min(ROWS - 1);
            let column = ((d.y.atan2(d.x) / TAU).rem_euclid(1.0) * COLUMNS as f64) as usize;
            let cell = row * COLUMNS + column.min(COLUMNS - 1);
            counts[cell] += 1;
            inverse[cell].0 += 1.0 / pdf;
            inverse[cell].1 += 1.0 / (pdf * pdf);
        }
        let fine = |i: usize, cells: usize| (i as f64 + 0.5) / (cells * FINE) as f64;
        let element = 4.0 * PI / (ROWS * COLUMNS * FINE * FINE) as f64;
        // Probability, solid angle, and the number of silhouette crossings on the grid.
        let mut seen = vec![(0.0, 0.0, 0.0); ROWS * COLUMNS];
        for i in 0..ROWS * FINE {
            let mut last = false;
            for j in 0..COLUMNS * FINE {
                let pdf = shape.pdf_from(place, direction(2.0 * fine(i, ROWS) - 1.0, fine(j, COLUMNS)));
                let cell = &mut seen[i / FINE * COLUMNS + j / FINE];
                cell.0 += pdf * element;
                cell.1 += if pdf > 0.0 { element } else { 0.0 };
                cell.2 += f64::from(u8::from(last != (pdf > 0.0)));
                last = pdf > 0.0;
            }
        }
        // Merge cells with few samples, whose variance estimate is unreliable.
        let mut cells: Vec<[f64; 5]> = vec![[0.0; 5]];
        for (&(sum, squares), &(probability, angle, border)) in inverse.iter().zip(&seen) {
            let cell = [sum, squares, probability, angle, border];
            if probability * f64::from(DRAWS) < 20.0 {
                cells[0] = std::array::from_fn(|i| cells[0][i] + cell[i]);
            } else {
                cells.push(cell);
            }
        }
        for [sum, squares, probability, angle, border] in cells {
            let (mean, square) = (sum / f64::from(DRAWS), squares / f64::from(DRAWS));
            let spread = 5.0 * ((square - mean * mean) / f64::from(DRAWS)).sqrt();
            let rough = 3.0 * element * f64::sqrt(border + 4.0);
            let told = probability * f64::from(DRAWS) >= 20.0;
            assert!(!told || (mean - angle).abs() <= spread + rough, "{shape:?}: {mean} {angle}, ±{spread} ±{rough}");
        }
        if name >= 5 {
            continue;
        }
        let mut expected: Vec<f64> = seen.iter().map(|cell| cell.0).collect();
        let sum: f64 = expected.iter().sum();
        assert!((sum - 1.0).abs() < 0.01, "{shape:?}: {sum}");
        // Merge cells with tiny probabilities into the smallest other cell: their integrals are inaccurate.
        let more = (0..expected.len()).filter(|&i| expected[i] >= 0.02);
        let least = more.min_by(|&i, &j| expected[i].total_cmp(&expected[j])).unwrap();
        for i in (0..expected.len()).filter(|&i| i != least) {
            if expected[i] < 0.02 {
                expected[least] += std::mem::take(&mut expected[i]);
                counts[least] += std::mem::take(&mut counts[i]);
            }
        }
        assert_frequencies(&counts, &expected);
    }
}

#[test]
fn normals_outlive_any_scale() {
    for scale in [1e-200, 1e-30, 1e30, 1e200] {
        let map = Affine::scale(DVec3::new(scale, 2.0 * scale, scale));
        let shape = Placed::new(Arc::new(Sphere::UNIT), map).unwrap();
        let ray = Ray::new(DVec3::new(0.0, -3.0, 0.0) * scale, DVec3::Y * 1e-10 * scale);
        let mut found = None;
        shape.meet(&ray, &mut |met| {
            found = Some(met);
            true
        });
        let met = found.unwrap();
        assert!((met.t / 1e10 - 1.0).abs() < 1e-14, "{scale:e} {met:?}");
        let point = shape.point(&ray, met.t, met.uv);
        assert!((point.normal + DVec3::Y).length() < 1e-15, "{scale:e} {point:?}");
        assert!(point.error < 1e-14 * scale, "{scale:e} {point:?}");
        assert!((point.position / scale + 2.0 * DVec3::Y).length() < 1e-14);
    }
}

/// Solid angle sampling of spheres is uniform to the last digits at any distance: tiny, far, on the surface and inside.
#[test]
fn spheres_are_drawn_from_at_any_distance() {
    for (radius, distance) in [(1e-3, 1e4), (1e-8, 1e8), (1e6, 1e6), (1.0, 1.0 + 1e-12), (1.0, 0.5), (1.0, 0.0)] {
        let sphere = Sphere { center: DVec3::new(1.0, 2.0, 3.0) * distance, radius };
        let place = sphere.center - DVec3::new(2.0, -1.0, 2.0) / 3.0 * distance;
        for i in 0..2000 {
            let Some(drawn) = sphere.sample_from(place, Sampler::new(5, 1, i).two(0)) else { continue };
            let way = drawn.point.position - place;
            assert!(drawn.pdf.is_finite() && drawn.pdf > 0.0);
            if distance > radius * 1.001 {
                // The sample faces the reference point, and the cone has half-angle asin(r / d), with solid angle π r²
                // / d² for small angles.
                assert!(way.dot(drawn.point.normal) < 1e-12 * way.length());
                let angle = (radius / distance).powi(2) * PI;
                assert!((drawn.pdf * angle - 1.0).abs() < 1e-7);
            }
        }
    }
}

/// Sampling without surface parameters returns the same point.
#[test]
fn sights_are_what_is_drawn_without_coordinates() {
    for (name, shape) in (0..).zip(&shapes()) {
        for place in [DVec3::new(2.2, 1.4, 1.9), DVec3::new(0.6, 0.35, 0.1)] {
            for i in 0..200 {
                let u = Sampler::new(6, name, i).two(0);
                let (Some(seen), Some(drawn)) = (shape.sight_from(place, u), shape.sample_from(place, u)) else {
                    continue;
                };
                let site = drawn.point.site();
                assert!((seen.site.position - site.position).abs().max_element() <= seen.site.error + site.error);
                assert!((seen.site.normal - site.normal).length() < 1e-14 && seen.pdf == drawn.pdf, "{shape:?}");
                // The direction hits the shape, except for rounding at a rim.
                let way = site.position - place;
                let (met, any) = (shape.pdf_of_met(place, way), shape.pdf_from(place, way));
                assert!(any == 0.0 || met == any, "{shape:?}");
            }
        }
    }
}
