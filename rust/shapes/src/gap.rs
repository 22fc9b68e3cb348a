//! A lower bound on the distance to a bounding box.

use super::Bounds;
use super::triangle::length;
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3};

/// A lower bound on the distance from a point to the image of a box: the distance to the box around that image.
pub fn gap_under(map: Option<&Affine>, bounds: &Bounds, place: DVec3) -> f64 {
    let Some(map) = map else {
        return length((bounds.min - place).max(place - bounds.max).max(DVec3::ZERO));
    };
    let (middle, half) = (0.5 * bounds.min + 0.5 * bounds.max, 0.5 * bounds.max - 0.5 * bounds.min);
    let gaps = [0, 1, 2].map(|k| {
        let (row, size) = (map.rows[k], map.rows[k].abs());
        let reach = size.dot(half);
        let rounded = 8.0 * UNIT * (size.dot(middle.abs()) + reach + map.shift[k].abs());
        let away = (row.dot(middle) + (map.shift[k] - place[k])).abs();
        (away - (reach + rounded)).max(0.0)
    });
    length(DVec3::from_array(gaps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_of_a_box_is_nearer_than_its_gap() {
        let bounds = Bounds { min: DVec3::new(-1.0, 0.5, 2.0), max: DVec3::new(2.0, 1.0, 2.5) };
        let rows = [DVec3::new(1.5, 0.4, 0.0), DVec3::new(0.0, 0.5, 0.2), DVec3::new(0.1, 0.0, -2.0)];
        let map = Affine::new(rows, DVec3::new(3.0, -1.0, 0.5));
        for i in 0..500 {
            let of = |by: f64| (f64::from(i) * by).sin();
            let place = DVec3::new(of(1.1), of(2.3), of(3.7)) * 6.0;
            let share = DVec3::new(of(0.7), of(1.9), of(2.9)) * 0.5 + 0.5;
            let inside = bounds.min + share * (bounds.max - bounds.min);
            assert!(gap_under(None, &bounds, place) <= (inside - place).length());
            assert!(gap_under(Some(&map), &bounds, place) <= (map.point(inside) - place).length());
        }
        let plain = Affine::translation(DVec3::ZERO);
        let place = DVec3::new(5.0, 0.7, 2.0);
        assert_eq!(gap_under(None, &bounds, place), 3.0);
        assert!((gap_under(Some(&plain), &bounds, place) - 3.0).abs() < 1e-14);
    }
}
