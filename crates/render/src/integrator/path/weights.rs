// SPDX-License-Identifier: MIT OR Apache-2.0
//! What counts how much: light that two ways could have found, and paths that chance lets go on.

use super::Path;
use crate::sampling::stream::Stream;
use crate::setting::render::LightSampling;

/// Bounces before chance may end a path.
pub(super) const SURE: u32 = 3;
/// What a path carries is worth so much more than that of its first ray: ending it saves less work than it took to get
/// there. (By measurement: docs/performance.md.)
pub(super) const WORTH: f64 = 2.0;
/// Who carries nearly all of its light goes on for sure but for this share: in a white room nothing else would end it.
pub(super) const MOST: f64 = 0.98;

/// The share of the first of two ways to find the same light, by their densities: the power heuristic with exponent 2
/// (Veach and Guibas 1995, equation 14).
#[inline(always)]
pub(super) fn share(own: f64, other: f64) -> f64 {
    // A ratio: squares of densities may be too large for numbers.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// What light counts that a path has met, by the densities with which its last surface sent it there and with which a
/// question would have found it.
pub(super) fn share_of_path(how: LightSampling, path: f64, question: impl FnOnce() -> f64) -> f64 {
    // Sharp surfaces ask nobody, and some light can't be asked for.
    if path == f64::INFINITY {
        return 1.0;
    }
    let question = question();
    if question == 0.0 {
        return 1.0;
    }
    match how {
        LightSampling::Both => share(path, question),
        LightSampling::Lights => 0.0,
        LightSampling::Surfaces => 1.0,
    }
}

/// The same for light that a question has found. Sharp lights are found by nothing else.
pub(super) fn share_of_question(how: LightSampling, question: f64, path: f64) -> f64 {
    if question == f64::INFINITY {
        return 1.0;
    }
    match how {
        LightSampling::Both => share(question, path),
        LightSampling::Lights => 1.0,
        LightSampling::Surfaces => 0.0,
    }
}

/// Whether a path goes on that carries little: the chance of that, which its throughput is divided by.
pub(super) fn carries_on<I>(next: &mut Path<I>, stream: &mut Stream) -> Option<f64> {
    if next.depth <= SURE {
        return Some(1.0);
    }
    let [chance, _] = stream.next_2d();
    let goes_on = (next.throughput.max_element() / next.squeezed * WORTH).min(MOST);
    if chance >= goes_on {
        return None;
    }
    next.throughput /= goes_on;
    Some(goes_on)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ways_to_find_light_add_up_to_one() {
        for how in [LightSampling::Both, LightSampling::Lights, LightSampling::Surfaces] {
            for (path, question) in [(1.0, 1.0), (1e-3, 5.0), (1e200, 1e-200), (3.0, 1e300)] {
                let sum =
                    share_of_path(how, path, || question) + share_of_question(how, question, path);
                assert!((sum - 1.0).abs() < 1e-12, "{how:?} {path} {question}: {sum}");
            }
            assert_eq!(share_of_path(how, f64::INFINITY, || 2.0), 1.0);
            assert_eq!(share_of_path(how, 2.0, || 0.0), 1.0);
            assert_eq!(share_of_question(how, f64::INFINITY, 2.0), 1.0);
        }
        assert!(share_of_path(LightSampling::Both, 10.0, || 1.0) > 0.99);
    }
}
