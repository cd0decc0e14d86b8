// SPDX-License-Identifier: MIT OR Apache-2.0
//! A football of twelve black pentagons and twenty white hexagons, painted for two mappings of a sphere.

use crate::noise::smoothstep;
use dioptric_image::{Encoding, Image, ImageError};
use dioptric_math::{DVec3, asin, cos, exp, sin};
use std::f64::consts::PI;

/// Samples along each side of a pixel.
const GRID: u32 = 4;

/// The ball for `u = asin(n.x) / pi + 0.5`, `v = asin(n.y) / pi + 0.5`, v upwards, n the unit normal.
///
/// That mapping can tell no front from a back, so the picture is the half with n.z >= 0. It reaches the diamond
/// where n.x and n.y fit on a sphere; outside, the colour of the rim goes on.
///
/// # Errors
/// Sizes of zero.
pub fn football_asin(width: u32, height: u32) -> Result<Image, ImageError> {
    paint(width, height, |u, v| {
        let (x, y) = (sin((u - 0.5) * PI), sin((v - 0.5) * PI));
        DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()).normalize_or(DVec3::Z)
    })
}

/// The ball for longitude and latitude: `u = atan2(n.x, n.z) / (2 pi) + 0.5`, `v = asin(n.y) / pi + 0.5`, v upwards.
///
/// # Errors
/// Sizes of zero.
pub fn football_lonlat(width: u32, height: u32) -> Result<Image, ImageError> {
    paint(width, height, |u, v| {
        let (longitude, latitude) = ((u - 0.5) * 2.0 * PI, (v - 0.5) * PI);
        DVec3::new(sin(longitude) * cos(latitude), sin(latitude), cos(longitude) * cos(latitude))
    })
}

/// Averages the ball's colour over each pixel's samples; `direction` gives the normal for u and v.
fn paint(
    width: u32,
    height: u32,
    direction: impl Fn(f64, f64) -> DVec3,
) -> Result<Image, ImageError> {
    let ball = Ball::new();
    Image::from_fn(width, height, Encoding::Srgb, |px, py| {
        let mut sum = DVec3::ZERO;
        for (i, j) in (0..GRID).flat_map(|i| (0..GRID).map(move |j| (i, j))) {
            let place = |p: u32, k: u32, n: u32| {
                (f64::from(p) + (f64::from(k) + 0.5) / f64::from(GRID)) / f64::from(n)
            };
            sum += ball.color(direction(place(px, i, width), 1.0 - place(py, j, height)));
        }
        (sum / f64::from(GRID * GRID)).to_array().map(|c| c as f32)
    })
}

/// A face of the ball: its outward unit normal over its distance from the centre, and whether it is black.
struct Face {
    normal: DVec3,
    black: bool,
}

/// A truncated icosahedron blown up to a sphere.
struct Ball {
    faces: Vec<Face>,
}

impl Ball {
    fn new() -> Self {
        // The corners of an icosahedron: even permutations of (0, +-1, +-golden ratio).
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let mut corners = Vec::new();
        for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
            corners.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
        }
        // Turned so that one black pentagon is whole in front, a little up and to the right, and rolled off the upright.
        let turn = |p: DVec3| {
            let (sx, cx) = (sin(0.40), cos(0.40));
            let (sy, cy) = (sin(0.13), cos(0.13));
            let (sz, cz) = (sin(0.22), cos(0.22));
            let p = DVec3::new(p.x, cx * p.y - sx * p.z, sx * p.y + cx * p.z);
            let p = DVec3::new(cy * p.x + sy * p.z, p.y, cy * p.z - sy * p.x);
            DVec3::new(cz * p.x - sz * p.y, sz * p.x + cz * p.y, p.z)
        };
        let corners: Vec<DVec3> =
            corners.into_iter().map(|p| turn(p.normalize_or(DVec3::Z))).collect();

        // Distances of the faces from the centre for edges of length 1 (Coxeter, "Regular Polytopes", 8.1).
        let root5 = 5.0_f64.sqrt();
        let pentagon = 0.5 * ((125.0 + 41.0 * root5) / 10.0).sqrt();
        let hexagon = 0.5 * (1.5 * (7.0 + 3.0 * root5)).sqrt();
        let mut faces: Vec<Face> =
            corners.iter().map(|c| Face { normal: *c / pentagon, black: true }).collect();
        // Hexagons lie over the icosahedron's triangles: three corners, each two of them neighbours (63.4 degrees).
        let near = |a: &DVec3, b: &DVec3| a.dot(*b) > 0.4;
        for (i, a) in corners.iter().enumerate() {
            for (j, b) in corners.iter().enumerate().skip(i + 1).filter(|(_, b)| near(a, b)) {
                for c in corners.iter().skip(j + 1).filter(|c| near(a, c) && near(b, c)) {
                    faces.push(Face {
                        normal: (*a + *b + *c).normalize_or(DVec3::Z) / hexagon,
                        black: false,
                    });
                }
            }
        }
        Self { faces }
    }

    /// The stored colour at a point of the sphere.
    fn color(&self, n: DVec3) -> DVec3 {
        // The face in front of a point is the one whose plane the ray from the centre leaves first.
        let mut best: Option<(f64, &Face)> = None;
        for face in &self.faces {
            let reach = n.dot(face.normal);
            if best.is_none_or(|(most, _)| reach > most) {
                best = Some((reach, face));
            }
        }
        let Some((reach, face)) = best else { return DVec3::ZERO };
        // The seam to another face lies on a great circle; the angle to the nearest of them.
        let mut nearest = f64::INFINITY;
        let mut to_black = false;
        for other in self.faces.iter().filter(|f| !std::ptr::eq(*f, face)) {
            let across = face.normal - other.normal;
            let sine = (reach - n.dot(other.normal)) / across.length();
            if sine < nearest {
                (nearest, to_black) = (sine, other.black);
            }
        }
        let seam = asin(nearest.clamp(0.0, 1.0));
        // Panels bulge: they darken a little towards their seams, which are thin grey grooves.
        let bulge = 1.0 - 0.20 * exp(-(seam / 0.055) * (seam / 0.055));
        let panel = if face.black {
            DVec3::new(0.055, 0.055, 0.065) * bulge
        } else {
            DVec3::new(0.97, 0.97, 0.96) * bulge
        };
        let groove = if face.black || to_black { 0.012 } else { 0.016 };
        let line = 1.0 - smoothstep(groove - 0.005, groove + 0.003, seam);
        panel + (DVec3::new(0.36, 0.36, 0.38) - panel) * line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ball_has_twelve_pentagons_and_twenty_hexagons() {
        let ball = Ball::new();
        assert_eq!(ball.faces.iter().filter(|f| f.black).count(), 12);
        assert_eq!(ball.faces.len(), 32);
    }

    #[test]
    fn black_covers_its_share_of_the_sphere() {
        // Solid angle of a pentagon by the share of random directions: on the ball 12 pentagons take 28.4 %.
        let ball = Ball::new();
        let mut random = dioptric_math::random::Random::new(3);
        let mut black = 0;
        for _ in 0..20_000 {
            let (z, angle) = (random.uniform(-1.0, 1.0), random.uniform(0.0, 2.0 * PI));
            let r = (1.0 - z * z).sqrt();
            let n = DVec3::new(r * cos(angle), r * sin(angle), z);
            black += u32::from(ball.color(n).x < 0.2);
        }
        let share = f64::from(black) / 20_000.0;
        assert!((0.24..0.30).contains(&share), "{share}");
    }

    #[test]
    fn both_mappings_paint_the_same_ball() {
        let (flat, globe) = (football_asin(256, 256).unwrap(), football_lonlat(512, 256).unwrap());
        let value = |image: &Image, u: f64, v: f64| {
            let (w, h) = (f64::from(image.width()), f64::from(image.height()));
            image.get((u * w) as u32, ((1.0 - v) * h) as u32).unwrap()[0]
        };
        let mut apart = 0;
        let mut random = dioptric_math::random::Random::new(5);
        for _ in 0..1000 {
            let (x, y) = (random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6));
            let n = DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
            let a = value(&flat, asin(n.x) / PI + 0.5, asin(n.y) / PI + 0.5);
            let b = value(
                &globe,
                dioptric_math::atan2(n.x, n.z) / (2.0 * PI) + 0.5,
                asin(n.y) / PI + 0.5,
            );
            apart += u32::from((a - b).abs() > 0.3);
        }
        // Only pixels at seams may differ.
        assert!(apart < 60, "{apart} of 1000");
    }
}
