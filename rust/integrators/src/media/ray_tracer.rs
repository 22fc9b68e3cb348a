//! Ray intersection as asynchronous calls.
//!
//! A path is written as sequential code that awaits its ray queries. For a single path the result is immediate
//! ([`ImmediateQueries`]). For a batch of paths (`batch_executor.rs`), the pending queries of all are traced together.

use raywright_base::math::{Hit, Ray};
use raywright_scene::Scene;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Ray queries. All implementations return the same results.
pub(crate) trait TraceRays: Copy {
    /// Return the first hit of a ray.
    async fn first(self, ray: &Ray) -> Hit;

    /// Pass all hits of a ray to a function.
    async fn crossed<T>(self, ray: &Ray, told: impl FnOnce(&[Hit]) -> T) -> T;
}

/// Trace each query immediately.
#[derive(Clone, Copy)]
pub(crate) struct ImmediateQueries<'a>(pub &'a Scene);

impl TraceRays for ImmediateQueries<'_> {
    async fn first(self, ray: &Ray) -> Hit {
        self.0.intersect_one(ray)
    }

    async fn crossed<T>(self, ray: &Ray, told: impl FnOnce(&[Hit]) -> T) -> T {
        told(&self.0.crossings(std::slice::from_ref(ray)).hits)
    }
}

/// Run a path that uses [`ImmediateQueries`].
///
/// # Panics
/// If it awaits anything else.
pub(crate) fn at_once<T>(path: impl Future<Output = T>) -> T {
    match pin!(path).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(found) => found,
        Poll::Pending => unreachable!("a path that is alone has its answers at once"),
    }
}
