//! Rays in SoA layout, tested against one box in vectors.

use crate::SlabRay;
use crate::bvh::Node;
use raywright_base::simd::Simd;

/// The near plane of the rays along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NearPlane {
    /// The same for all: 0 the lower, 1 the upper.
    All(usize),
    /// Different planes.
    Mixed,
}

/// `R` rays; results of unused lanes are arbitrary.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Columns<const R: usize> {
    inverse: [[f32; R]; 3],
    near: [[f32; R]; 3],
    far: [[f32; R]; 3],
    t_min: [f32; R],
    first: [NearPlane; 3],
}

impl<const R: usize> Columns<R> {
    /// No rays.
    pub const NONE: Self = Self {
        inverse: [[1.0; R]; 3],
        near: [[0.0; R]; 3],
        far: [[0.0; R]; 3],
        t_min: [0.0; R],
        first: [NearPlane::Mixed; 3],
    };

    /// Load rays, at least one and at most `R`.
    pub fn fill(&mut self, rays: &[SlabRay]) {
        for (i, ray) in rays.iter().enumerate() {
            for axis in 0..3 {
                self.inverse[axis][i] = ray.inverse[axis];
                self.near[axis][i] = ray.near[axis];
                self.far[axis][i] = ray.far[axis];
            }
            self.t_min[i] = ray.t_min;
        }
        for axis in 0..3 {
            let first = rays[0].first[axis];
            let same = rays.iter().all(|ray| ray.first[axis] == first);
            self.first[axis] = if same { NearPlane::All(first) } else { NearPlane::Mixed };
        }
    }

    /// Return whether a ray's direction is positive along an axis.
    pub fn goes_up(&self, ray: usize, axis: usize) -> bool {
        self.inverse[axis][ray] > 0.0
    }

    /// The near plane along an axis.
    pub fn first(&self, axis: usize) -> NearPlane {
        self.first[axis]
    }

    /// The `t` at which a group of `N` rays enters a nonempty box, and the mask of rays that do so no later than they
    /// leave it and than `limits`: [`SlabRay::passes`] lane by lane.
    ///
    /// If the rays' signs differ along an axis, the lesser of both products belongs to each ray's near plane.
    #[inline(always)]
    pub fn meet<const N: usize, S: Simd<N>>(
        &self,
        simd: S,
        group: usize,
        node: &Node,
        limits: &[f32; R],
    ) -> (S::F32, u32) {
        let planes = [node.min.to_array(), node.max.to_array()];
        let mut enter = part(simd, &self.t_min, group);
        let mut leave = part(simd, limits, group);
        for axis in 0..3 {
            let inverse = part(simd, &self.inverse[axis], group);
            let near = part(simd, &self.near[axis], group);
            let far = part(simd, &self.far[axis], group);
            let plane = |which: usize| simd.splat(planes[which][axis]);
            let (first, last) = match self.first[axis] {
                NearPlane::All(first) => {
                    (simd.mul_add(plane(first & 1), inverse, near), simd.mul_add(plane(first & 1 ^ 1), inverse, far))
                }
                NearPlane::Mixed => {
                    let (a, b) = (simd.mul(plane(0), inverse), simd.mul(plane(1), inverse));
                    (simd.add(simd.min(a, b), near), simd.add(simd.max(a, b), far))
                }
            };
            enter = simd.max(enter, first);
            leave = simd.min(leave, last);
        }
        (enter, simd.le(enter, leave))
    }
}

/// One vector of a column.
#[inline(always)]
fn part<const N: usize, const R: usize, S: Simd<N>>(simd: S, column: &[f32; R], group: usize) -> S::F32 {
    simd.load(&column.as_chunks::<N>().0[group])
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::{Aabb, DVec3, Ray, Region, Vec3};
    use raywright_base::sampling::philox4x32;
    use raywright_base::simd::{Dispatch, Kernel, Level};

    struct Meet<'a> {
        columns: &'a Columns<8>,
        node: &'a Node,
        limits: &'a [f32; 8],
    }

    impl<const N: usize> Kernel<N> for Meet<'_> {
        type Output = u32;

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) -> u32 {
            let groups =
                (0..8 / N).map(|group| self.columns.meet::<N, S>(simd, group, self.node, self.limits).1 << (group * N));
            groups.fold(0, |a, b| a | b)
        }
    }

    #[test]
    fn lanes_meet_what_rays_meet_at_every_level() {
        let region = Region::around([DVec3::splat(-1.0), DVec3::ONE]);
        let triple = |i: u32, k: u32| {
            let [x, y, z, _] = philox4x32([i, k, 0, 0], [9, 9]).map(|b| f64::from(b) / f64::from(1u32 << 31) - 1.0);
            DVec3::new(x, y, z)
        };
        let mut met = [0; 2];
        for i in 0..500u32 {
            let ahead = if i % 2 == 0 { DVec3::ZERO } else { DVec3::splat(2.0) };
            let rays: Vec<_> = (0..8)
                .map(|k| {
                    let ray = Ray::new(1.5 * triple(i, k), triple(i, k + 20) + ahead);
                    SlabRay::prepare(None, &Ray { t_min: -0.5, ..ray }, &region).unwrap().1
                })
                .collect();
            let (a, b) = (triple(i, 40).as_vec3(), triple(i, 41).as_vec3());
            let node = Node::leaf(Aabb { min: Vec3::min(a, b), max: Vec3::max(a, b) }, 0, 1);
            let limits = std::array::from_fn(|k| triple(i, k as u32 + 60).x as f32 + 1.0);
            let mut columns = Columns::NONE;
            columns.fill(&rays);
            let wanted: u32 = (0..8).map(|k| u32::from(rays[k].passes(&node.aabb(), limits[k]).is_some()) << k).sum();
            met[usize::from(wanted != 0)] += 1;
            let ask = || Meet { columns: &columns, node: &node, limits: &limits };
            for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
                assert_eq!(Dispatch::<4>::dispatch(level, ask()), wanted, "{level:?}");
                if level.lanes() >= 8 {
                    assert_eq!(Dispatch::<8>::dispatch(level, ask()), wanted, "{level:?}");
                }
            }
        }
        assert!(met[0] > 50 && met[1] > 50, "{met:?}");
    }
}
