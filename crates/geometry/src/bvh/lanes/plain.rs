// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight boxes with what the program was compiled for: loops that compilers turn into SSE2 or NEON.

use super::{BoxRay, Entries, Node, Test, WIDTH};

pub(in super::super) struct Plain;

impl Test for Plain {
    type Spread = BoxRay;

    #[inline(always)]
    unsafe fn spread(ray: &BoxRay) -> BoxRay {
        *ray
    }

    #[inline(always)]
    unsafe fn enter(node: &Node, ray: &BoxRay, limit: f32) -> (Entries, u32) {
        let mut near = [0.0_f32; WIDTH];
        let mut far = [limit; WIDTH];
        for axis in 0..3 {
            let side = ray.negative[axis];
            let (low, high) = (&node.planes[2 * axis + side], &node.planes[2 * axis + 1 - side]);
            for lane in 0..WIDTH {
                // No NaN: the inverse is finite and at least 1, and at most one of the two is infinite.
                let t0 = low[lane] * ray.inverse[axis] - ray.near[axis];
                let t1 = high[lane] * ray.inverse[axis] - ray.far[axis];
                near[lane] = if t0 > near[lane] { t0 } else { near[lane] };
                far[lane] = if t1 < far[lane] { t1 } else { far[lane] };
            }
        }
        let mut entered = 0;
        for lane in 0..WIDTH {
            entered |= u32::from(near[lane] <= far[lane]) << lane;
        }
        (near, entered)
    }
}
