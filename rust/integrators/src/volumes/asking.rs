//! What paths ask of a scene on their way, and who answers.
//!
//! A path is written as if it were alone, one thing after the other. Where it has to know what a ray hits it waits for
//! the answer: of one path alone that is there at once ([`Alone`]); of many that are followed side by side
//! (`together.rs`) the rays of all that wait are asked about in one go.

use raywright_base::math::{Hit, Ray};
use raywright_scene::Scene;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Who answers. Whoever it is, the answers are the same.
pub(crate) trait Asks: Copy {
    /// The first hit of a ray.
    async fn first(self, ray: &Ray) -> Hit;

    /// Tells all that a ray crosses.
    async fn crossed<T>(self, ray: &Ray, told: impl FnOnce(&[Hit]) -> T) -> T;
}

/// The scene itself, each time it is asked.
#[derive(Clone, Copy)]
pub(crate) struct Alone<'a>(pub &'a Scene);

impl Asks for Alone<'_> {
    async fn first(self, ray: &Ray) -> Hit {
        self.0.intersect_one(ray)
    }

    async fn crossed<T>(self, ray: &Ray, told: impl FnOnce(&[Hit]) -> T) -> T {
        told(&self.0.crossings(std::slice::from_ref(ray)).hits)
    }
}

/// What comes of a path that asks [`Alone`].
///
/// # Panics
/// If it waits for anybody else.
pub(crate) fn at_once<T>(path: impl Future<Output = T>) -> T {
    match pin!(path).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(found) => found,
        Poll::Pending => unreachable!("a path that is alone has its answers at once"),
    }
}
