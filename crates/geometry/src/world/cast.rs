// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many rays at once: the single queries, spread over the threads of the caller's pool.

use rayon::prelude::*;

use super::{Hit, World};
use crate::ray::Ray;

/// Rays that one thread takes in a row: neighbours in a batch tend to meet the same things.
const RUN: usize = 1024;

impl World {
    /// The nearest hit of every ray, as [`World::closest`] finds it for each alone, in the order of the rays.
    ///
    /// Uses the pool of threads that it is called in, if any; the answer is the same for any number of
    /// threads.
    #[must_use]
    pub fn cast(&self, rays: &[Ray]) -> Vec<Option<Hit>> {
        let mut hits = vec![None; rays.len()];
        each(rays, &mut hits, |ray| self.closest(ray, f64::INFINITY, None));
        hits
    }

    /// Whether each ray hits anything, as [`World::occluded`] finds it; much faster than [`Self::cast`].
    #[must_use]
    pub fn cast_any(&self, rays: &[Ray]) -> Vec<bool> {
        let mut hits = vec![false; rays.len()];
        each(rays, &mut hits, |ray| self.occluded(ray, f64::INFINITY, None));
        hits
    }
}

/// Fills `answers` with one answer for each question, in runs over the threads of the pool that this is called
/// in, if any. For queries of one's own over many rays in whatever form they are kept.
pub fn each<Q: Sync, A: Send>(questions: &[Q], answers: &mut [A], ask: impl Fn(&Q) -> A + Sync) {
    let run = |(questions, answers): (&[Q], &mut [A])| {
        questions.iter().zip(answers).for_each(|(q, a)| *a = ask(q));
    };
    // Without a pool of the caller's, rayon would start one of its own.
    if rayon::current_thread_index().is_some() {
        questions.par_chunks(RUN).zip(answers.par_chunks_mut(RUN)).for_each(run);
    } else {
        run((questions, answers));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{AnyShape, sphere::Sphere};
    use crate::world::WorldBuilder;
    use dioptric_math::random::Random;
    use dioptric_math::{DAffine3, DVec3};

    #[test]
    fn batches_answer_as_single_rays_on_any_number_of_threads() {
        let mut builder = WorldBuilder::new();
        let mut random = Random::new(4);
        let mut point = |size: f64| DVec3::from([(); 3].map(|()| random.uniform(-size, size)));
        for _ in 0..50 {
            let ball = Sphere::new(point(2.0), 0.4);
            builder.object(AnyShape::Sphere(ball), DAffine3::IDENTITY).unwrap();
        }
        let world = builder.build();
        let mut rays: Vec<Ray> = (0..5000).map(|_| Ray::new(point(4.0), point(1.0))).collect();
        rays.push(Ray::new(DVec3::NAN, DVec3::X));
        let alone = world.cast(&rays);
        assert!(alone.iter().flatten().count() > 500 && alone.last() == Some(&None));
        for (ray, hit) in rays.iter().zip(&alone) {
            assert_eq!(world.closest(ray, f64::INFINITY, None), *hit);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let (hits, any) = pool.install(|| (world.cast(&rays), world.cast_any(&rays)));
        assert_eq!(hits, alone);
        assert!(any.iter().zip(&alone).all(|(any, hit)| *any == hit.is_some()));
        assert_eq!(world.cast_any(&rays), any);
    }
}
