// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight boxes or triangles with what the program was compiled for: loops that compilers turn into SSE2 or NEON.

use super::{Aim, BallRay, Balls, BoxRay, Entries, Node, Packet, Test, WIDTH, eight};
use crate::bvh::balls::BALLS;
use crate::bvh::triangles::{SIDE_BY_SIDE, Sight};

pub(crate) struct Plain;

impl Test for Plain {
    type Spread = BoxRay;
    type Eight = eight::Halves;

    #[inline(always)]
    unsafe fn spread(ray: &BoxRay, _: &[Node]) -> BoxRay {
        *ray
    }

    #[inline(always)]
    unsafe fn enter(nodes: &[Node], index: usize, ray: &BoxRay, limit: f32) -> (Entries, u32) {
        // SAFETY: the caller answers for the index.
        let node = unsafe { nodes.get_unchecked(index) };
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

    #[inline(always)]
    unsafe fn triangles(packet: &Packet, aim: &Aim, margin: f32, depths: [f32; 2]) -> Sight {
        let [x, y, z] = aim.axes;
        let mut seen = [[[0.0_f32; SIDE_BY_SIDE]; 3]; 3];
        for (seen, corner) in seen.iter_mut().zip(&packet.corners) {
            for lane in 0..SIDE_BY_SIDE {
                let depth = corner[z][lane] - aim.origin[2];
                seen[0][lane] = corner[x][lane] - aim.origin[0] - aim.slope[0] * depth;
                seen[1][lane] = corner[y][lane] - aim.origin[1] - aim.slope[1] * depth;
                seen[2][lane] = depth;
            }
        }
        let [a, b, c] = &seen;
        let mut sight = Sight::unknown(0);
        for lane in 0..SIDE_BY_SIDE {
            let u = c[0][lane] * b[1][lane] - c[1][lane] * b[0][lane];
            let v = a[0][lane] * c[1][lane] - a[1][lane] * c[0][lane];
            let w = b[0][lane] * a[1][lane] - b[1][lane] * a[0][lane];
            let within = (u >= -margin && v >= -margin && w >= -margin)
                || (u <= margin && v <= margin && w <= margin);
            let [i, j, k] = [a[2][lane], b[2][lane], c[2][lane]];
            let starts = i <= depths[0] || j <= depths[0] || k <= depths[0];
            let ends = i >= depths[1] || j >= depths[1] || k >= depths[1];
            if within && starts && ends {
                closer(aim, [u, v, w], &seen, lane, &mut sight);
            }
        }
        sight
    }

    #[inline(always)]
    unsafe fn balls(balls: &Balls, ray: &BallRay, limit: f32) -> Sight {
        let [dx, dy, dz] = ray.direction;
        let mut sight = Sight::unknown(0);
        for lane in 0..BALLS {
            let x = balls.centers[0][lane] - ray.origin[0];
            let y = balls.centers[1][lane] - ray.origin[1];
            let z = balls.centers[2][lane] - ray.origin[2];
            let along = (x * dx + y * dy + z * dz) * ray.inverse;
            let (x, y, z) = (x - along * dx, y - along * dy, z - along * dz);
            let room = balls.radii[lane] + ray.slack;
            let (square, rooms) = (x * x + y * y + z * z, room * room);
            let chord = (rooms * (1.0 + BallRay::SQUARES) - square).max(0.0) * ray.inverse;
            let from = along - chord.sqrt() * (1.0 + BallRay::CHORD) - ray.slack;
            let hit = square <= rooms && from <= limit && along >= -room;
            sight.kept |= u32::from(hit) << lane;
            let less = (balls.radii[lane] * BallRay::RADII - ray.slack).max(0.0);
            let chord = (less * less * (1.0 - BallRay::SQUARES) - square) * ray.inverse;
            let to = along - chord.max(0.0).sqrt() * (1.0 - BallRay::CHORD) + ray.slack;
            (sight.from[lane], sight.to[lane]) = (from, to);
            sight.sure |= u32::from(hit && chord > 0.0 && from > ray.slack) << lane;
        }
        sight
    }
}

/// The second look at a triangle, with margins of its own.
#[inline(always)]
fn closer(
    aim: &Aim,
    [u, v, w]: [f32; 3],
    seen: &[[[f32; SIDE_BY_SIDE]; 3]; 3],
    lane: usize,
    sight: &mut Sight,
) {
    let mut across = 0.0_f32;
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for [x, y, z] in seen {
        across = across.max(x[lane].abs()).max(y[lane].abs());
        (low, high) = (low.min(z[lane]), high.max(z[lane]));
    }
    let along = high.max(-low);
    let error = Aim::ACROSS * across + Aim::ALONG * along + aim.error;
    let margin = Aim::EDGES * error * (across + error) + f32::MIN_POSITIVE;
    let depth = u * seen[0][2][lane] + v * seen[1][2][lane] + w * seen[2][2][lane];
    let depth = if aim.forward { depth } else { -depth };
    let sum = u.abs() + v.abs() + w.abs();
    let slack = Aim::DEPTHS * margin * along + sum * error + f32::MIN_POSITIVE;
    let positive = u >= -margin && v >= -margin && w >= -margin;
    let negative = u <= margin && v <= margin && w <= margin;
    // Not `>=`: NaN is no reason to reject.
    let kept = (positive && !(depth < -slack)) || (negative && !(depth > slack));
    if !kept {
        return;
    }
    sight.kept |= 1 << lane;
    let twice = margin + margin;
    let sure =
        (u >= twice && v >= twice && w >= twice) || (u <= -twice && v <= -twice && w <= -twice);
    let inverse = 1.0 / (u + v + w);
    let off = Aim::ERRORS * error + margin * (Aim::RANGES * (high - low)) * inverse.abs();
    let depth = depth * inverse;
    (sight.from[lane], sight.to[lane]) = (depth - off, depth + off);
    sight.sure |= u32::from(sure && depth - off > aim.certain) << lane;
}
