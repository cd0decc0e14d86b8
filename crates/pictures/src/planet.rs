// SPDX-License-Identifier: MIT OR Apache-2.0
//! A planet that nobody has been to: seas, deserts, forests, mountains, ice and clouds on a map of longitude and latitude.
//!
//! `u = atan2(n.x, n.z) / (2 pi) + 0.5`, `v = asin(n.y) / pi + 0.5`, v upwards. All is noise in space on the
//! unit sphere, so the map has no seam at its sides and no pinch at its poles.

use crate::noise::{fbm_3, smoothstep};
use dioptric_image::{Encoding, Image, ImageError};
use dioptric_math::{DVec3, asin, cos, sin};
use std::f64::consts::PI;

/// The planet; twice as many pixels across as down.
///
/// # Errors
/// Sizes of zero.
pub fn planet(width: u32, height: u32) -> Result<Image, ImageError> {
    Image::from_fn(width, height, Encoding::Srgb, |px, py| {
        let longitude = ((f64::from(px) + 0.5) / f64::from(width) - 0.5) * 2.0 * PI;
        let latitude = (0.5 - (f64::from(py) + 0.5) / f64::from(height)) * PI;
        let n = DVec3::new(
            sin(longitude) * cos(latitude),
            sin(latitude),
            cos(longitude) * cos(latitude),
        );
        let west = DVec3::new(-cos(longitude), 0.0, sin(longitude));
        let north = west.cross(n);
        cover(ground(n, (west + north) * 0.006), n).to_array().map(|c| c.clamp(0.0, 1.0) as f32)
    })
}

const SEA_LEVEL: f64 = 0.06;

/// Height of the ground, about -1 to 1; continents from a coarse noise, torn at their coasts by a finer one.
fn height(n: DVec3) -> f64 {
    let warp = DVec3::new(fbm_3(1, n * 1.7, 4), fbm_3(2, n * 1.7, 4), fbm_3(3, n * 1.7, 4));
    1.15 * fbm_3(4, n * 1.25 + warp * 0.42, 9)
}

/// The stored colour of land or sea, shaded as if the light came along `light`.
fn ground(n: DVec3, light: DVec3) -> DVec3 {
    let here = height(n);
    let above = here - SEA_LEVEL;
    let slope = here - height(n + light);
    let latitude = asin(n.y.clamp(-1.0, 1.0)).abs() / (PI / 2.0);
    let rough = fbm_3(7, n * 6.0, 6);
    let cold = latitude + 0.07 * rough + 0.45 * above.max(0.0);

    let sea = DVec3::new(0.010, 0.070, 0.200)
        .lerp(DVec3::new(0.030, 0.200, 0.370), smoothstep(-0.42, -0.05, above))
        .lerp(DVec3::new(0.150, 0.480, 0.540), smoothstep(-0.055, -0.002, above));

    // Dry belts where air sinks, a third of the way to the poles; wet ones at the equator and beyond.
    let belt = smoothstep(0.10, 0.24, latitude) * (1.0 - smoothstep(0.36, 0.52, latitude));
    let dry =
        smoothstep(0.22, 0.78, 0.62 * belt + 0.20 + 0.50 * fbm_3(8, n * 2.6, 6) + 0.25 * above);
    let lush = DVec3::new(0.10, 0.27, 0.09)
        .lerp(DVec3::new(0.24, 0.36, 0.15), smoothstep(-0.3, 0.4, rough));
    let desert = DVec3::new(0.78, 0.67, 0.47)
        .lerp(DVec3::new(0.64, 0.46, 0.31), smoothstep(-0.2, 0.4, rough));
    let steppe = DVec3::new(0.50, 0.47, 0.24);
    let plain =
        lush.lerp(steppe, smoothstep(0.0, 0.5, dry)).lerp(desert, smoothstep(0.45, 0.95, dry));
    let north = DVec3::new(0.36, 0.37, 0.27);
    let rock = DVec3::new(0.40, 0.34, 0.29);
    let land = plain
        .lerp(north, smoothstep(0.55, 0.78, cold))
        .lerp(rock, smoothstep(0.22, 0.42, above + 0.08 * rough));
    let land = land * (1.0 + 4.2 * slope).clamp(0.55, 1.22);
    let beach = DVec3::new(0.80, 0.74, 0.56);
    let land = beach.lerp(land, smoothstep(0.0, 0.012, above));

    let snow = DVec3::new(0.93, 0.95, 0.98) * (1.0 + 3.0 * slope).clamp(0.75, 1.05);
    let dry_ground = land
        .lerp(snow, smoothstep(0.84, 0.90, cold).max(smoothstep(0.50, 0.60, above + 0.10 * rough)));
    let open_sea =
        sea.lerp(DVec3::new(0.80, 0.88, 0.94), smoothstep(0.90, 0.93, cold + 0.05 * rough));
    // Coasts are a pixel or two wide, not stairs.
    open_sea.lerp(dry_ground, smoothstep(-0.003, 0.003, above))
}

/// Clouds over the ground, and their shadows on it.
fn cover(ground: DVec3, n: DVec3) -> DVec3 {
    let shadow = clouds(n + DVec3::new(0.006, -0.006, 0.0));
    let white = clouds(n);
    (ground * (1.0 - 0.45 * shadow)).lerp(DVec3::new(0.97, 0.98, 1.0), 0.95 * white)
}

/// How much a cloud hides, 0 to 1: noise drawn out along the parallels and stirred twice.
fn clouds(n: DVec3) -> f64 {
    let p = DVec3::new(n.x, 1.9 * n.y, n.z) * 1.6;
    let stir = DVec3::new(fbm_3(31, p, 4), fbm_3(32, p, 3), fbm_3(33, p, 4));
    let q = p + stir * 0.75;
    let swirl = DVec3::new(fbm_3(34, q * 2.1, 4), fbm_3(35, q * 2.1, 3), fbm_3(36, q * 2.1, 4));
    let amount = fbm_3(37, q * 1.5 + swirl * 0.45, 7);
    // Fewer of them over the dry belts.
    let latitude = n.y.abs();
    let belt = smoothstep(0.15, 0.35, latitude) * (1.0 - smoothstep(0.50, 0.70, latitude));
    smoothstep(0.03, 0.78, amount - 0.11 * belt)
}
