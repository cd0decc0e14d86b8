// SPDX-License-Identifier: MIT OR Apache-2.0
//! Parameters that several lights have, and what is worked out from them.

use std::f64::consts::TAU;

use dioptric_math::{DVec3, Spectrum, normalize, orthonormal_basis};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use crate::build::Builder;
use crate::sampling::warp::concentric_disc;
use crate::setting::root::Root;

/// `intensity`.
pub(super) const INTENSITY: Param =
    Param::new("intensity", Type::NON_NEGATIVE, Default::Number(1.0), "Multiplies the colour.");

/// `color`.
pub(super) const COLOR: Param =
    Param::new("color", Type::Color, Default::Number(1.0), "Its colour.");

/// `falloff`.
pub(super) const FALLOFF: Param = Param::new(
    "falloff",
    Type::Choice(Falloff::NAMES),
    Default::Text("none"),
    "How it weakens with distance: \"none\", or \"square\" as in nature; then `intensity` is what arrives at \
     distance 1.",
);

/// `radius`.
pub(super) const RADIUS: Param = Param::new(
    "radius",
    Type::NON_NEGATIVE,
    Default::Number(0.0),
    "Radius of the ball that shines: above 0 shadows are soft.",
);

/// `samples`.
pub(super) const SAMPLES: Param = Param::new(
    "samples",
    Type::Integer { min: 1, max: 4096 },
    Default::Number(16.0),
    "Shadow rays that a Whitted picture casts for each point lit; more make soft shadows smoother.",
);

/// Colour times intensity.
pub(super) fn strength(args: &Args, builder: &Builder) -> Result<Spectrum, Diagnostic> {
    Ok(builder.constant_color(args, "color")? * args.number("intensity")?)
}

/// The value of [`SAMPLES`].
pub(super) fn samples(args: &Args) -> Result<u32, Diagnostic> {
    Ok(args.integer("samples")?.clamp(1, 4096) as u32)
}

/// How a light weakens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Falloff {
    /// Not at all.
    None,
    /// By the distance squared, in the file's units: 1 at distance 1.
    Square {
        /// Units of the file per unit of the space of rays.
        per_unit: f64,
    },
}

impl Falloff {
    /// The words of the `falloff` parameter.
    pub const NAMES: &'static [&'static str] = &["none", "square"];

    /// Keeps what arrives finite next to the light.
    const LARGEST: f64 = 1e100;

    /// The value of [`FALLOFF`].
    pub(super) fn from_args(args: &Args, root: &Root) -> Result<Self, Diagnostic> {
        Ok(match &*args.text("falloff")? {
            "square" => Self::Square { per_unit: 1.0 / root.scale() },
            _ => Self::None,
        })
    }

    /// Whether it weakens at all.
    #[must_use]
    pub const fn weakens(self) -> bool {
        matches!(self, Self::Square { .. })
    }

    /// The factor at a distance in the space of rays.
    #[must_use]
    pub fn at(self, distance: f64) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Square { per_unit } => {
                let d = distance * per_unit;
                (1.0 / (d * d)).min(Self::LARGEST)
            }
        }
    }
}

/// One direction out of a cone, uniform over its solid angle for uniform `u`. `spread` is
/// `1 - cos` of the angle between the axis and the cone's side: 0 a line, 1 a half space, 2 all round.
///
/// The height `1 - cos` of a cap is in proportion to its solid angle (Archimedes), so a disc is mapped
/// to a cap ring by ring; the disc comes from the square with little distortion, which keeps strata
/// compact.
pub(crate) fn direction_in_cone(axis: DVec3, spread: f64, u: [f64; 2]) -> DVec3 {
    normalize(way_in_cone(axis, spread, u)).unwrap_or(axis)
}

/// The same, of about unit length.
#[inline(always)]
pub(crate) fn way_in_cone(axis: DVec3, spread: f64, u: [f64; 2]) -> DVec3 {
    let [a, b] = concentric_disc(u);
    let height = (a * a + b * b) * spread;
    let across = (spread * (2.0 - height).max(0.0)).sqrt(); // sin / radius of the disc
    let (t, s) = orthonormal_basis(axis);
    axis * (1.0 - height) + (t * a + s * b) * across
}

/// `1 - cos` of an angle whose squared sine is given; without cancellation for small ones.
#[inline(always)]
pub(crate) fn spread_of_sin2(sin2: f64) -> f64 {
    sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt())
}

/// The density of [`direction_in_cone`] over solid angles.
#[inline(always)]
pub(crate) fn density_in_cone(spread: f64) -> f64 {
    1.0 / (TAU * spread)
}

/// The largest cosine, at least 0, that directions can have which lie around one of cosine `cos` by an angle
/// of the sine `sine`; 1 for all round.
pub(crate) fn cosine_within(cos: f64, sine: f64) -> f64 {
    let side = (1.0 - sine * sine).max(0.0).sqrt();
    if sine >= 1.0 || cos >= side {
        return 1.0;
    }
    (cos * side + (1.0 - cos * cos).max(0.0).sqrt() * sine).max(0.0)
}

/// What a surface receives that faces the middle of a cone of light, over what it would receive if
/// all of that came from the middle: the mean cosine is `1 - spread / 2`. Lights with a size divide by
/// it, so that only the shadows tell them from a point.
pub(super) fn facing_weight(spread: f64) -> f64 {
    1.0 / (1.0 - 0.5 * spread)
}

/// A ball that shines, or a point where its radius is 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    /// Its middle, in the space of rays.
    pub center: DVec3,
    /// Its radius, in the space of rays.
    pub radius: f64,
    /// How it weakens with distance.
    pub falloff: Falloff,
}

/// A direction of light, the distance to its source, and what multiplies its strength.
pub(super) struct BallSample {
    pub direction: DVec3,
    pub distance: f64,
    pub weight: f64,
}

impl Ball {
    /// Reads `position`, [`RADIUS`] and [`FALLOFF`].
    pub(super) fn from_args(args: &Args, root: &Root) -> Result<Self, Diagnostic> {
        Ok(Self {
            center: root.point(args.vec3("position")?.into()),
            radius: args.number("radius")? * root.scale(),
            falloff: Falloff::from_args(args, root)?,
        })
    }

    /// Light from the part of the ball that `u` picks, uniform over the directions in which the ball
    /// is seen (Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations",
    /// ACM TOG 15(1), 1996, section 3.2.1).
    ///
    /// Weighted so that a surface that faces the ball receives what the point light would give it. For
    /// `falloff = "square"` that is also what a ball of uniform radiance gives. Inside the ball light
    /// comes from all round, as bright as on its surface.
    pub(super) fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<BallSample> {
        let way = self.center - point;
        let d = way.length();
        if self.radius == 0.0 {
            let direction = normalize(way)?;
            return Some(BallSample { direction, distance: d, weight: self.falloff.at(d) });
        }
        if !d.is_finite() {
            return None;
        }
        let (r, axis) = (self.radius, normalize(way).unwrap_or(DVec3::Z));
        if d < r {
            let direction = direction_in_cone(axis, 2.0, u);
            let along = d * axis.dot(direction);
            let distance = along + (r * r - d * d + along * along).max(0.0).sqrt();
            return Some(BallSample { direction, distance, weight: 4.0 * self.falloff.at(r) });
        }
        let spread = spread_of_sin2((r / d) * (r / d));
        let direction = direction_in_cone(axis, spread, u);
        let along = d * axis.dot(direction);
        let off = axis.cross(direction).length() * d;
        let distance = (along - (r * r - off * off).max(0.0).sqrt()).max(0.0);
        let weight = self.falloff.at(d) * facing_weight(spread);
        Some(BallSample { direction, distance, weight })
    }

    /// Where a ray passes it, and the density with which [`Self::sample`] goes that way.
    pub(super) fn pass(&self, origin: DVec3, direction: DVec3) -> Option<(BallSample, f64)> {
        let way = self.center - origin;
        let (d, r) = (way.length(), self.radius);
        if !(r > 0.0 && d.is_finite()) {
            return None;
        }
        let along = way.dot(direction);
        if d < r {
            let distance = along + (r * r - d * d + along * along).max(0.0).sqrt();
            let weight = 4.0 * self.falloff.at(r);
            return Some((BallSample { direction, distance, weight }, density_in_cone(2.0)));
        }
        let off = way.cross(direction).length();
        if !(along > 0.0 && off <= r) {
            return None;
        }
        let spread = spread_of_sin2((r / d) * (r / d));
        let distance = (along - (r * r - off * off).max(0.0).sqrt()).max(0.0);
        let weight = self.falloff.at(d) * facing_weight(spread);
        Some((BallSample { direction, distance, weight }, density_in_cone(spread)))
    }

    /// Direction, sine and weight of a [`super::LightView`].
    pub(super) fn view(&self, point: DVec3) -> Option<(DVec3, f64, f64)> {
        let way = self.center - point;
        let (d, r) = (way.length(), self.radius);
        if !d.is_finite() || (r == 0.0 && d == 0.0) {
            return None;
        }
        let axis = normalize(way).unwrap_or(DVec3::Z);
        Some(if d < r {
            (axis, 1.0, 4.0 * self.falloff.at(r))
        } else {
            (axis, r / d, self.falloff.at(d))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::testing::grid;

    #[test]
    fn cones_are_covered_evenly() {
        let axis = DVec3::new(0.48, -0.6, 0.64);
        for spread in [1e-12, 0.01, 0.5, 1.0, 2.0] {
            let (mut mean, mut inner) = (DVec3::ZERO, 0);
            for u in grid(128) {
                let d = direction_in_cone(axis, spread, u);
                assert!((d.length() - 1.0).abs() < 1e-12);
                let height = 0.5 * (d - axis).length_squared(); // 1 - cos
                assert!(height <= spread * (1.0 + 1e-6), "{spread} {height}");
                inner += i32::from(height < 0.25 * spread);
                mean += d / (128.0 * 128.0);
            }
            assert!(
                (mean - axis * (1.0 - 0.5 * spread)).length() < 1e-4 * spread + 1e-12,
                "{spread} {mean}"
            );
            assert!((f64::from(inner) / (128.0 * 128.0) - 0.25).abs() < 5e-3, "{spread}");
        }
    }

    #[test]
    fn a_facing_surface_cannot_tell_a_ball_from_a_point() {
        for falloff in [Falloff::None, Falloff::Square { per_unit: 2.0 }] {
            for radius in [1e-9, 0.5, 1.0, 2.0, 2.9999] {
                let ball = Ball { center: DVec3::new(0.0, 3.0, 0.0), radius, falloff };
                let mean: f64 = grid(256)
                    .filter_map(|u| ball.sample(DVec3::ZERO, u))
                    .map(|s| s.direction.y.max(0.0) * s.weight / (256.0 * 256.0))
                    .sum();
                assert!((mean / falloff.at(3.0) - 1.0).abs() < 1e-4, "{radius} {mean}");
            }
            // Inside it is as bright as on the surface.
            let ball = Ball { center: DVec3::ZERO, radius: 2.0, falloff };
            let mean: f64 = grid(256)
                .filter_map(|u| ball.sample(DVec3::new(0.3, 0.2, -0.9), u))
                .map(|s| s.direction.y.max(0.0) * s.weight / (256.0 * 256.0))
                .sum();
            assert!((mean / falloff.at(2.0) - 1.0).abs() < 1e-3, "{mean}");
        }
    }

    /// Independent check of "square": the irradiance from a ball of uniform radiance, by quadrature
    /// over its area, on a surface that does not face it.
    #[test]
    fn a_tilted_surface_receives_what_the_ball_s_area_sends() {
        let (center, radius, normal) = (DVec3::new(0.5, 2.0, -0.3), 0.8, DVec3::Y);
        let ball = Ball { center, radius, falloff: Falloff::Square { per_unit: 1.0 } };
        let sampled: f64 = grid(256)
            .filter_map(|u| ball.sample(DVec3::ZERO, u))
            .map(|s| s.direction.dot(normal).max(0.0) * s.weight / (256.0 * 256.0))
            .sum();
        // Intensity 1 in all directions: radiance 1 / (pi r^2).
        let radiance = 1.0 / (std::f64::consts::PI * radius * radius);
        let n = 600;
        let area = 4.0 * std::f64::consts::PI * radius * radius / f64::from(n * n);
        let sent: f64 = grid(n)
            .map(|u| {
                let outward = direction_in_cone(DVec3::Z, 2.0, u);
                let p = center + outward * radius;
                let (d2, w) = (p.length_squared(), p.normalize());
                radiance * normal.dot(w).max(0.0) * (-outward.dot(w)).max(0.0) / d2 * area
            })
            .sum();
        assert!((sampled / sent - 1.0).abs() < 1e-3, "{sampled} {sent}");
    }

    #[test]
    fn samples_lie_on_the_ball() {
        let ball = Ball { center: DVec3::new(1.0, 2.0, 3.0), radius: 1.5, falloff: Falloff::None };
        for point in [DVec3::ZERO, DVec3::new(1.0, 2.2, 3.0), DVec3::new(1.0, 2.0, 3.0)] {
            for u in grid(8) {
                let s = ball.sample(point, u).unwrap();
                let p = point + s.direction * s.distance;
                assert!(((p - ball.center).length() - 1.5).abs() < 1e-6, "{point} {u:?}");
            }
        }
    }
}
