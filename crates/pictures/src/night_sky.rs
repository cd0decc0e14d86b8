// SPDX-License-Identifier: MIT OR Apache-2.0
//! A night sky: the Milky Way with its dust, glowing nebulae, and thousands of stars in the colours of their heat.
//!
//! Light is added up linearly in the plane (x in 0..2, y in 0..1 from the bottom) and developed at the end, so bright
//! stars bleach to white and glow as they do on film.

use crate::noise::{fbm, ridges, smoothstep};
use dioptric_image::{Develop, Encoding, Image, ImageError, Tone};
use dioptric_math::random::Random;
use dioptric_math::{DVec3, cos, exp, pow, sin};

/// The sky at twice as many pixels across as down; other shapes stretch it.
///
/// # Errors
/// Sizes of zero.
pub fn night_sky(width: u32, height: u32) -> Result<Image, ImageError> {
    let mut film =
        Film { width, height, light: Vec::with_capacity(width as usize * height as usize) };
    for row in 0..height {
        for column in 0..width {
            let x = 2.0 * (f64::from(column) + 0.5) / f64::from(width);
            let y = 1.0 - (f64::from(row) + 0.5) / f64::from(height);
            film.light.push(glow(x, y));
        }
    }
    add_stars(&mut film);

    let develop = Develop { exposure: 1.75, tone: Tone::Aces, encoding: Encoding::Srgb };
    let mut light = film.light.iter();
    Image::from_fn(width, height, Encoding::Srgb, |_, _| {
        let color = light.next().map_or([0.0; 3], |c| c.to_array());
        develop.apply(color.map(|c| c as f32)).map(|c| c as f32)
    })
}

/// Linear light, rows from the top.
struct Film {
    width: u32,
    height: u32,
    light: Vec<DVec3>,
}

impl Film {
    fn add(&mut self, column: i64, row: i64, light: DVec3) {
        if (0..i64::from(self.width)).contains(&column)
            && (0..i64::from(self.height)).contains(&row)
        {
            let index = row as usize * self.width as usize + column as usize;
            if let Some(cell) = self.light.get_mut(index) {
                *cell += light;
            }
        }
    }
}

/// The Milky Way at a place: along and across its band, and what dust leaves of the light behind it.
struct Band {
    /// Along the band, 0 at its bulge.
    along: f64,
    /// Across the band, warped so that its edges are ragged.
    across: f64,
    /// The share of red, green and blue that passes the dust.
    dust: DVec3,
}

impl Band {
    fn at(x: f64, y: f64) -> Self {
        let (s, c) = (sin(0.46), cos(0.46));
        let (dx, dy) = (x - 1.02, y - 0.52);
        let along = c * dx + s * dy;
        let bent = -s * dx + c * dy + 0.10 * along * along;
        let across = bent + 0.055 * fbm(11, 2.1 * x, 2.1 * y, 5);

        // Dust lies in the middle plane, in clouds that trail off into threads.
        let (wx, wy) = (fbm(21, 3.0 * x, 3.0 * y, 4), fbm(22, 3.0 * x, 3.0 * y, 4));
        let cloud = fbm(23, 4.2 * along + 0.8 * wx, 7.5 * across + 0.8 * wy, 7);
        let threads = ridges(24, 3.6 * along + 0.6 * wy, 6.0 * across + 0.6 * wx, 6);
        let plane = exp(-(across / 0.085) * (across / 0.085));
        let rift = exp(-((across - 0.012) / 0.034) * ((across - 0.012) / 0.034));
        let depth = plane
            * (2.6 * smoothstep(-0.12, 0.62, cloud) + 1.5 * smoothstep(0.42, 0.85, threads))
            + 1.5 * rift * smoothstep(-0.35, 0.35, cloud + 0.25 * wx);
        // Dust dims blue most: what shines through is brown.
        let dust = DVec3::new(exp(-0.70 * depth), exp(-depth), exp(-1.36 * depth));
        Self { along, across, dust }
    }

    /// Starlight too fine to be seen as stars, 0 to about 1, before dust.
    fn density(&self) -> f64 {
        let profile = |w: f64| exp(-(self.across / w) * (self.across / w));
        let taper = 1.0 - 0.45 * smoothstep(0.2, 1.1, self.along.abs());
        let bulge = exp(-(self.along / 0.34) * (self.along / 0.34)) * profile(0.15);
        taper * (0.50 * profile(0.085) + 0.30 * profile(0.19)) + 0.42 * bulge
    }
}

/// All light that is not a star.
fn glow(x: f64, y: f64) -> DVec3 {
    // The bare sky: deep blue, and near the ground a breath of green airglow.
    let base =
        DVec3::new(0.0036, 0.0060, 0.0160) + DVec3::new(0.0015, 0.0060, 0.0068) * pow(1.0 - y, 3.0);
    let haze = 1.0 + 0.35 * fbm(31, 1.3 * x, 1.3 * y, 4);
    let mut light = base * haze;

    let band = Band::at(x, y);
    let density = band.density();
    let texture = (0.80 + 0.85 * fbm(41, 5.0 * x, 5.0 * y, 7)).max(0.05);
    // Old suns in the bulge are golden, young ones further out blue.
    let warmth = exp(-(band.along / 0.5) * (band.along / 0.5))
        * exp(-(band.across / 0.16) * (band.across / 0.16));
    let hue = DVec3::new(0.52, 0.70, 1.22).lerp(DVec3::new(1.28, 0.88, 0.52), warmth);
    light += hue * band.dust * (0.27 * density * texture);

    for nebula in NEBULAE {
        light += nebula.light(x, y) * (band.dust * 0.6 + 0.4) * 2.1;
    }
    light
}

/// A cloud of gas that glows or reflects.
struct Nebula {
    place: (f64, f64),
    radius: f64,
    color: DVec3,
    seed: u64,
}

impl Nebula {
    fn light(&self, x: f64, y: f64) -> DVec3 {
        let (dx, dy) = ((x - self.place.0) / self.radius, (y - self.place.1) / self.radius);
        let distance = dx * dx + dy * dy;
        if distance > 9.0 {
            return DVec3::ZERO;
        }
        let warp = fbm(self.seed, 1.4 * dx, 1.4 * dy, 4);
        let wisps = ridges(self.seed + 1, 1.2 * dx + 0.7 * warp, 1.2 * dy - 0.7 * warp, 6);
        let body = exp(-distance * 1.1) * (0.55 + 0.9 * warp).max(0.0);
        let core = exp(-distance * 9.0);
        self.color * (body * (0.25 + 1.3 * wisps * wisps) + 0.35 * core)
    }
}

/// Hydrogen's rose along the band, two blue clouds that reflect their stars, and a teal one.
const NEBULAE: [Nebula; 8] = [
    Nebula {
        place: (1.30, 0.70),
        radius: 0.095,
        color: DVec3::new(0.210, 0.038, 0.080),
        seed: 101,
    },
    Nebula {
        place: (0.74, 0.42),
        radius: 0.070,
        color: DVec3::new(0.190, 0.036, 0.062),
        seed: 111,
    },
    Nebula {
        place: (1.08, 0.50),
        radius: 0.055,
        color: DVec3::new(0.210, 0.060, 0.090),
        seed: 121,
    },
    Nebula {
        place: (1.62, 0.86),
        radius: 0.080,
        color: DVec3::new(0.140, 0.030, 0.085),
        seed: 131,
    },
    Nebula {
        place: (0.45, 0.80),
        radius: 0.130,
        color: DVec3::new(0.020, 0.045, 0.125),
        seed: 141,
    },
    Nebula {
        place: (1.56, 0.34),
        radius: 0.110,
        color: DVec3::new(0.024, 0.070, 0.095),
        seed: 151,
    },
    Nebula {
        place: (0.36, 0.22),
        radius: 0.075,
        color: DVec3::new(0.130, 0.026, 0.070),
        seed: 161,
    },
    Nebula {
        place: (1.38, 0.66),
        radius: 0.050,
        color: DVec3::new(0.040, 0.070, 0.170),
        seed: 171,
    },
];

/// Stars by the thousand: where the Milky Way is dense and free of dust there are more of them, mostly faint.
fn add_stars(film: &mut Film) {
    let mut random = Random::new(2019);
    // The faintest that can be told apart, only where the band is: they give it its grain.
    for _ in 0..90_000 {
        let (x, y) = (random.uniform(0.0, 2.0), random.unit());
        let (chance, faint, heat) = (random.unit(), random.unit(), temperature(&mut random));
        let band = Band::at(x, y);
        if chance < 1.2 * band.density() * band.dust.y {
            add_star(
                film,
                (x, y),
                0.02 + 0.10 * faint * faint * faint,
                star_color(heat) * (band.dust * 0.6 + 0.4),
            );
        }
    }
    let mut left = 38_000;
    while left > 0 {
        let (x, y) = (random.uniform(0.0, 2.0), random.unit());
        let band = Band::at(x, y);
        let chance = 0.13 + 1.0 * band.density() * band.dust.y;
        // Ten to the power of 0.45 for each magnitude: so counts of real stars rise (faintest first).
        let flux = (0.0052 * pow(1.0 - random.unit(), -0.4 / 0.45)).min(26.0);
        let heat = temperature(&mut random);
        // The brightest belong to our neighbourhood and stand everywhere alike.
        if random.unit() < chance.max(0.42 * smoothstep(0.3, 2.0, flux)) {
            let color = star_color(heat);
            let reddened = if flux < 0.3 { color * (band.dust * 0.7 + 0.3) } else { color };
            add_star(film, (x, y), flux, reddened);
            left -= 1;
        }
    }
}

/// A surface temperature in kelvin: many suns cooler than ours, a fifth of them hot and blue.
fn temperature(random: &mut Random) -> f64 {
    let (kind, u) = (random.unit(), random.unit());
    match kind {
        k if k < 0.30 => 3200.0 + 1500.0 * u,
        k if k < 0.62 => 4700.0 + 2000.0 * u,
        k if k < 0.82 => 6700.0 + 3300.0 * u,
        _ => 10_000.0 + 13_000.0 * u,
    }
}

/// The colour of a glowing body, its largest part 1: the Planckian locus by Kim et al., "Design of advanced color
/// temperature control system for HDTV applications", J. Korean Phys. Soc. 41, 2002, then linear Rec. 709.
fn star_color(kelvin: f64) -> DVec3 {
    let t = 1000.0 / kelvin.clamp(1667.0, 25_000.0);
    let x = if kelvin < 4000.0 {
        ((-0.266_123_9 * t - 0.234_358_9) * t + 0.877_695_6) * t + 0.179_910
    } else {
        ((-3.025_846_9 * t + 2.107_037_9) * t + 0.222_634_7) * t + 0.240_390
    };
    let y = if kelvin < 2222.0 {
        ((-1.106_381_4 * x - 1.348_110_20) * x + 2.185_558_32) * x - 0.202_196_83
    } else if kelvin < 4000.0 {
        ((-0.954_947_6 * x - 1.374_185_93) * x + 2.091_370_15) * x - 0.167_488_67
    } else {
        ((3.081_758_0 * x - 5.873_386_70) * x + 3.751_129_97) * x - 0.370_014_83
    };
    let (big_x, big_z) = (x / y, (1.0 - x - y) / y);
    let rgb = DVec3::new(
        3.240_97 * big_x - 1.537_38 - 0.498_61 * big_z,
        -0.969_24 * big_x + 1.875_97 + 0.041_56 * big_z,
        0.055_63 * big_x - 0.203_98 + 1.056_97 * big_z,
    )
    .max(DVec3::ZERO);
    rgb / rgb.max_element().max(1e-9)
}

/// Puts a star's light on the film: a small disc, for bright ones a halo, and for the brightest four thin rays.
fn add_star(film: &mut Film, (x, y): (f64, f64), flux: f64, color: DVec3) {
    let unit = f64::from(film.width) / 2048.0;
    let sigma = (0.80 * unit * (1.0 + 0.16 * flux.min(6.0))).max(0.5);
    let (px, py) = (x / 2.0 * f64::from(film.width), (1.0 - y) * f64::from(film.height));
    let reach = if flux > 0.5 {
        (46.0 * unit * (flux / 26.0).sqrt()).max(4.0 * sigma)
    } else {
        3.5 * sigma
    };
    // Small films have fewer pixels for the same light: the disc's light is what stays.
    let core =
        flux * (0.80 * unit * 0.80 * unit) / (sigma * sigma) * if flux > 1.0 { 1.5 } else { 1.0 };
    let halo_radius = 2.6 * unit * (1.0 + 0.35 * flux.sqrt());
    for row in (py - reach).floor() as i64..=(py + reach).ceil() as i64 {
        for column in (px - reach).floor() as i64..=(px + reach).ceil() as i64 {
            let (dx, dy) = (column as f64 + 0.5 - px, row as f64 + 0.5 - py);
            let r2 = dx * dx + dy * dy;
            let fade = 1.0 - smoothstep(0.55 * reach, reach, r2.sqrt());
            let mut light =
                color.lerp(DVec3::ONE, 0.25) * (core * exp(-r2 / (2.0 * sigma * sigma)));
            if flux > 0.5 {
                let falloff = 1.0 + r2 / (halo_radius * halo_radius);
                light += color * (0.045 * flux / (falloff * falloff) * fade);
            }
            if flux > 5.0 {
                let (long, thin) = (0.24 * reach, 0.75 * unit.max(0.6));
                let ray = |a: f64, b: f64| exp(-a.abs() / long - (b / thin) * (b / thin));
                light += color * (0.030 * flux * (ray(dx, dy) + ray(dy, dx)) * fade);
            }
            film.add(column, row, light);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hot_stars_are_blue_and_cool_ones_orange() {
        let [cool, sun, hot] = [3200.0, 6500.0, 20_000.0].map(star_color);
        assert!(cool.x == 1.0 && cool.y < 0.8 && cool.z < 0.5, "{cool}");
        assert!(sun.min_element() > 0.9, "{sun}");
        assert!(hot.z == 1.0 && hot.x < 0.7, "{hot}");
    }
}
