// SPDX-License-Identifier: MIT OR Apache-2.0
//! Places along a line in a medium that get much light: near small lights, and within the cones of spots.
//!
//! What arrives from a point weakens with the square of the distance, and that can be sampled exactly along a line:
//! evenly in the angle at the light (Kulla and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating
//! Media", EGSR 2012, section 3). What a light sends to the whole of a line is its angle over its distance from
//! the line, which says how often to aim at which.

use dioptric_math::{DVec3, atan2, exp, sin_cos};

use super::emitter::{Emitter, Reach};
use crate::light::AnyLight;

/// The most that are aimed at: the strongest.
const MOST: usize = 16;
/// A line is near its end where so little is left of light.
const DEEP: f64 = 12.0;

/// A light with a place.
#[derive(Clone, Copy, Debug)]
struct Focus {
    center: DVec3,
    radius: f64,
    power: f64,
    /// The axis of a spot and the cosine of half its angle.
    cone: Option<(DVec3, f64)>,
}

/// The lights that can be aimed at.
#[derive(Clone, Debug, Default)]
pub struct Foci(Vec<Focus>);

/// A light as it is seen from a line: the angles between which the line lies.
#[derive(Clone, Copy, Debug, Default)]
struct Aim {
    /// Where the line is nearest to it, and how near.
    nearest: f64,
    away: f64,
    from: f64,
    to: f64,
    /// The piece of the line.
    piece: [f64; 2],
    share: f64,
}

/// The lights as they are seen from one line.
#[derive(Clone, Copy, Debug)]
pub struct Aims {
    aims: [Aim; MOST],
    count: usize,
}

impl Foci {
    /// Of all sources of a scene.
    pub(super) fn new<'a>(emitters: impl Iterator<Item = &'a Emitter>) -> Self {
        let focus = |emitter: &Emitter| {
            let Reach { center, radius, power, .. } = emitter.reach()?;
            let cone = match emitter {
                Emitter::Light(lamp) => match &lamp.light {
                    AnyLight::Spot(spot) => Some(spot.cone()),
                    _ => None,
                },
                _ => None,
            };
            (power > 0.0).then_some(Focus { center, radius, power, cone })
        };
        let mut all: Vec<Focus> = emitters.filter_map(focus).collect();
        all.sort_by(|a, b| b.power.total_cmp(&a.power));
        all.truncate(MOST);
        Self(all)
    }

    /// How the lights see the line from `origin` along the unit vector `direction`, up to `end`, through a medium that
    /// takes away `extinction` of light at least. Nothing where none sees it.
    #[must_use]
    pub fn aims(&self, origin: DVec3, direction: DVec3, end: f64, extinction: f64) -> Option<Aims> {
        let mut aims = Aims { aims: [Aim::default(); MOST], count: 0 };
        let end = if extinction > 0.0 { end.min(DEEP / extinction) } else { end };
        let mut sum = 0.0;
        for focus in &self.0 {
            let way = focus.center - origin;
            let nearest = way.dot(direction);
            // No nearer than about the light itself: a line through it sees it from all sides.
            let away = (way - direction * nearest).length().max(0.5 * focus.radius);
            let away = away.max(1e-9 * way.length());
            let Some(piece) = focus.lit(origin, direction, end) else { continue };
            let angle = |t: f64| if t < f64::INFINITY { atan2(t - nearest, away) } else { RIGHT };
            let (from, to) = (angle(piece[0]), angle(piece[1]));
            let share = focus.power * (to - from) / away * exp(-extinction * away);
            if share > 0.0 && share.is_finite() {
                aims.aims[aims.count] = Aim { nearest, away, from, to, piece, share };
                aims.count += 1;
                sum += share;
            }
        }
        for aim in &mut aims.aims[..aims.count] {
            aim.share /= sum;
        }
        (aims.count > 0 && sum.is_finite()).then_some(aims)
    }
}

const RIGHT: f64 = std::f64::consts::FRAC_PI_2;

impl Aims {
    /// A place on the line for a number in `[0, 1)`.
    #[must_use]
    pub fn sample(&self, u: f64) -> f64 {
        let (mut i, mut rest) = (0, u);
        while i + 1 < self.count && rest >= self.aims[i].share {
            rest -= self.aims[i].share;
            i += 1;
        }
        let aim = &self.aims[i];
        let at = (rest / aim.share).min(1.0);
        let (sin, cos) = sin_cos(aim.from + (aim.to - aim.from) * at);
        (aim.nearest + aim.away * (sin / cos)).clamp(aim.piece[0], aim.piece[1])
    }

    /// The density of [`Self::sample`] at a place.
    #[must_use]
    pub fn density(&self, t: f64) -> f64 {
        let one = |aim: &Aim| {
            if !(t >= aim.piece[0] && t <= aim.piece[1]) {
                return 0.0;
            }
            let along = t - aim.nearest;
            aim.share * aim.away / ((aim.away * aim.away + along * along) * (aim.to - aim.from))
        };
        self.aims[..self.count].iter().map(one).sum()
    }
}

impl Focus {
    /// The piece of a line that the light can reach.
    fn lit(&self, origin: DVec3, direction: DVec3, end: f64) -> Option<[f64; 2]> {
        let Some((axis, cos)) = self.cone.filter(|&(_, cos)| cos >= 0.0) else {
            return Some([0.0, end]);
        };
        // Where (p - c).axis = cos |p - c|, squared, is a quadratic in t; both signs of the left side solve it.
        let m = origin - self.center;
        let (da, ma, c2) = (direction.dot(axis), m.dot(axis), cos * cos);
        let (a, b) = (da * da - c2, da * ma - c2 * m.dot(direction));
        let c = ma * ma - c2 * m.length_squared();
        let root = (b * b - a * c).max(0.0).sqrt();
        let q = -(b + b.signum() * root);
        let mut cuts = [0.0, q / a, c / q, end];
        for t in &mut cuts {
            *t = if t.is_nan() { 0.0 } else { t.clamp(0.0, end) };
        }
        cuts[1..3].sort_by(f64::total_cmp);
        let inside = |t: f64| {
            let p = m + direction * t;
            p.dot(axis) > cos * p.length()
        };
        cuts.windows(2).find_map(|piece| {
            let [from, to] = [piece[0], piece[1]];
            let middle =
                if to < f64::INFINITY { 0.5 * (from + to) } else { from + 1.0 + from.abs() };
            (from < to && inside(middle)).then_some([from, to])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn foci(cones: &[Option<(DVec3, f64)>]) -> Foci {
        let focus = |(i, cone): (usize, &Option<(DVec3, f64)>)| Focus {
            center: DVec3::new(i as f64, 2.0, 0.0),
            radius: 0.1,
            power: 1.0 + i as f64,
            cone: *cone,
        };
        Foci(cones.iter().enumerate().map(focus).collect())
    }

    #[test]
    fn places_have_the_density_that_is_said() {
        let cone = Some((-DVec3::Y, 0.9));
        for end in [0.7, 5.0, f64::INFINITY] {
            for foci in [foci(&[None]), foci(&[cone]), foci(&[None, cone, None])] {
                let direction = DVec3::new(0.8, 0.6, 0.0);
                let Some(aims) = foci.aims(DVec3::new(-1.0, -0.5, 0.3), direction, end, 0.1) else {
                    assert_eq!(end, 0.7);
                    continue;
                };
                // The mean of 1 / density over places is the length that they cover; of bounded functions over the
                // density, their integrals.
                let n = 100_000;
                let (mut sum, mut exact) = (0.0, 0.0);
                for i in 0..n {
                    let t = aims.sample((f64::from(i) + 0.5) / f64::from(n));
                    assert!(t >= 0.0 && t <= end.min(120.0));
                    sum += exp(-t) / aims.density(t) / f64::from(n);
                }
                let steps = 200_000;
                let far = end.min(40.0);
                for i in 0..steps {
                    let t = (f64::from(i) + 0.5) / f64::from(steps) * far;
                    if aims.density(t) > 0.0 {
                        exact += exp(-t) * far / f64::from(steps);
                    }
                }
                assert!((sum / exact - 1.0).abs() < 2e-3, "{end}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn a_spot_lights_the_piece_of_a_line_in_its_cone() {
        // 45 degrees to all sides, downwards from (0, 2, 0): two units to each side at the floor.
        let spot = foci(&[Some((-DVec3::Y, 0.5_f64.sqrt()))]);
        let lit = |from: DVec3, to: DVec3| spot.0[0].lit(from, to, f64::INFINITY);
        let across = lit(DVec3::new(-5.0, 0.0, 0.0), DVec3::X).unwrap();
        assert!((across[0] - 3.0).abs() < 1e-12 && (across[1] - 7.0).abs() < 1e-12);
        assert_eq!(lit(DVec3::new(-5.0, 3.0, 0.0), DVec3::X), None);
        let out = lit(DVec3::new(0.5, 0.0, 0.0), DVec3::X).unwrap();
        assert!(out[0] == 0.0 && (out[1] - 1.5).abs() < 1e-12);
        let down = lit(DVec3::new(0.0, 5.0, 0.0), -DVec3::Y).unwrap();
        assert!((down[0] - 3.0).abs() < 1e-9 && down[1] == f64::INFINITY);
    }
}
