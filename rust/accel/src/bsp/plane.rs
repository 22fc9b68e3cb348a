//! Planes of arbitrary orientation.

use raywright_base::math::DVec3;

/// The points `p` with `normal · p = offset`, in box units.
///
/// The absolute coordinates of the normal sum to 1. So moving each coordinate of a point by at most e changes its
/// height by at most e.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BspPlane {
    pub normal: DVec3,
    pub offset: f64,
}

/// The position of an object relative to a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneSide {
    Back,
    Front,
    /// In the plane to within the tolerance: it may go to either side.
    Within,
    Both,
}

impl BspPlane {
    /// The plane through a point; None if the normal is too short.
    pub fn through(point: DVec3, normal: DVec3) -> Option<Self> {
        let size = normal.abs().element_sum();
        (size > 1e-30).then(|| {
            let normal = normal / size;
            Self { normal, offset: normal.dot(point) }
        })
    }

    /// An axis-aligned plane.
    pub fn across(axis: usize, at: f64) -> Self {
        Self { normal: DVec3::AXES[axis], offset: at }
    }

    /// The signed height of a point, in lengths of the normal.
    #[inline(always)]
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The least and the greatest height of points.
    pub fn range(&self, points: &[DVec3]) -> [f64; 2] {
        let heights = points.iter().map(|&p| self.height(p));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], h| [least.min(h), greatest.max(h)])
    }

    /// The same for a box.
    pub fn range_of_box(&self, [min, max]: [DVec3; 2]) -> [f64; 2] {
        let (middle, reach) = (self.height(0.5 * (min + max)), self.normal.abs().dot(0.5 * (max - min)));
        [middle - reach, middle + reach]
    }

    /// The axis of an axis-aligned plane.
    pub fn axis(&self) -> Option<usize> {
        (0..3).find(|&axis| self.normal == DVec3::AXES[axis])
    }

    /// Classify an object by its range of heights; crossing the plane by at most `tolerance` is ignored.
    pub fn side([least, greatest]: [f64; 2], tolerance: f64) -> PlaneSide {
        match (greatest <= tolerance, least >= -tolerance) {
            (true, true) => PlaneSide::Within,
            (true, false) => PlaneSide::Back,
            (false, true) => PlaneSide::Front,
            (false, false) => PlaneSide::Both,
        }
    }

    /// Split a convex outline into the parts behind and in front, and append the cut points (Sutherland and Hodgman,
    /// "Reentrant Polygon Clipping", 1974).
    pub fn cut(&self, outline: &[DVec3], cuts: &mut Vec<DVec3>) -> [Vec<DVec3>; 2] {
        let [mut back, mut front] = [Vec::with_capacity(outline.len() + 1), Vec::with_capacity(outline.len() + 1)];
        let Some(&(mut from)) = outline.last() else { return [back, front] };
        let mut start = self.height(from);
        for &p in outline {
            let end = self.height(p);
            if (start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0) {
                let cut = from + (p - from) * (start / (start - end));
                back.push(cut);
                front.push(cut);
                cuts.push(cut);
            }
            if end == 0.0 {
                cuts.push(p);
            }
            if end <= 0.0 {
                back.push(p);
            }
            if end >= 0.0 {
                front.push(p);
            }
            (from, start) = (p, end);
        }
        [back, front]
    }
}
