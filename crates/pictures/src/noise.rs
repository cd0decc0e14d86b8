// SPDX-License-Identifier: MIT OR Apache-2.0
//! Smooth noise over the plane and in space.

use dioptric_math::DVec3;
use dioptric_math::random::{join, mix};

/// Gradient noise (Perlin, "Improving Noise", SIGGRAPH 2002) with hashed gradients: about -0.7 to 0.7, mean 0.
pub fn gradient_noise(seed: u64, x: f64, y: f64) -> f64 {
    let (ix, iy) = (x.floor(), y.floor());
    let (fx, fy) = (x - ix, y - iy);
    let corner = |dx: f64, dy: f64| {
        let cell = join(join(mix(seed), (ix + dx) as i64 as u64), (iy + dy) as i64 as u64);
        // Eight directions, all of length sqrt(2) but the axes': cheap, and no direction stands out after fading.
        let (gx, gy) = match cell >> 61 {
            0 => (1.0, 1.0),
            1 => (-1.0, 1.0),
            2 => (1.0, -1.0),
            3 => (-1.0, -1.0),
            4 => (std::f64::consts::SQRT_2, 0.0),
            5 => (-std::f64::consts::SQRT_2, 0.0),
            6 => (0.0, std::f64::consts::SQRT_2),
            _ => (0.0, -std::f64::consts::SQRT_2),
        };
        gx * (fx - dx) + gy * (fy - dy)
    };
    let (u, v) = (fade(fx), fade(fy));
    lerp(
        v,
        lerp(u, corner(0.0, 0.0), corner(1.0, 0.0)),
        lerp(u, corner(0.0, 1.0), corner(1.0, 1.0)),
    )
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lerp(t: f64, a: f64, b: f64) -> f64 {
    a + (b - a) * t
}

/// The same in space, with Perlin's twelve gradients: the directions to the edges of a cube.
fn gradient_noise_3(seed: u64, p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let corner = |dx: f64, dy: f64, dz: f64| {
        let key = join(
            join(join(mix(seed), (cell.x + dx) as i64 as u64), (cell.y + dy) as i64 as u64),
            (cell.z + dz) as i64 as u64,
        );
        let sign = |bit: u32| if key >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let (x, y, z) = (f.x - dx, f.y - dy, f.z - dz);
        match (key >> 32) % 3 {
            0 => sign(60) * x + sign(61) * y,
            1 => sign(60) * y + sign(61) * z,
            _ => sign(60) * z + sign(61) * x,
        }
    };
    let (u, v) = (fade(f.x), fade(f.y));
    let layer = |dz: f64| {
        let near = lerp(u, corner(0.0, 0.0, dz), corner(1.0, 0.0, dz));
        lerp(v, near, lerp(u, corner(0.0, 1.0, dz), corner(1.0, 1.0, dz)))
    };
    lerp(fade(f.z), layer(0.0), layer(1.0))
}

/// [`fbm`] in space.
pub fn fbm_3(seed: u64, p: DVec3, octaves: u64) -> f64 {
    let (mut p, mut strength, mut sum) = (p, 1.0, 0.0);
    for octave in 0..octaves {
        sum += strength * gradient_noise_3(join(seed, octave), p);
        // Twice as fine, and turned about a slanted axis (a rational rotation matrix times 2).
        p = DVec3::new(
            2.0 * p.x - p.y * 2.0 + p.z,
            p.x + 2.0 * p.y + 2.0 * p.z,
            -2.0 * p.x - p.y + 2.0 * p.z,
        ) * (2.0 / 3.0);
        strength *= 0.5;
    }
    sum
}

/// A sum of `octaves` of noise, each twice as fine and half as strong as the one before: about -1 to 1.
pub fn fbm(seed: u64, x: f64, y: f64, octaves: u64) -> f64 {
    // A turn of each octave hides the lattice that all of them share.
    let (mut x, mut y, mut strength, mut sum) = (x, y, 1.0, 0.0);
    for octave in 0..octaves {
        sum += strength * gradient_noise(join(seed, octave), x, y);
        (x, y) = (1.6 * x - 1.2 * y, 1.2 * x + 1.6 * y);
        strength *= 0.5;
    }
    sum
}

/// Ridges: bright where the noise crosses 0, 0 to 1.
pub fn ridges(seed: u64, x: f64, y: f64, octaves: u64) -> f64 {
    let (mut x, mut y, mut strength, mut sum) = (x, y, 0.5, 0.0);
    for octave in 0..octaves {
        let ridge = 1.0 - (1.6 * gradient_noise(join(seed, octave), x, y)).abs().min(1.0);
        sum += strength * ridge * ridge;
        (x, y) = (1.6 * x - 1.2 * y, 1.2 * x + 1.6 * y);
        strength *= 0.5;
    }
    sum
}

/// 0 below `low`, 1 above `high`, smooth between.
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
