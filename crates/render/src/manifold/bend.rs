// SPDX-License-Identifier: MIT OR Apache-2.0
//! By how much light turns on its way over a ball: mirrored off it, or through it.
//!
//! A way over a ball lies in the plane of its two ends and the ball's middle, so that one angle is all that is not known: that
//! of incidence, `a`. Seen from the middle the way turns, from its first end to its last, by
//! `2 a - asin(k sin a) - asin(l sin a)`, and for each piece of it within the ball by half a turn and `- 2 asin(m sin a)` more; `k`
//! and `l` are the radius over the distances of the ends from the middle, `m` is one over the index of the ball.
//!
//! The derivative also says how much wider or narrower a cone of directions gets on the way: with all turned about the line from
//! the first end to the middle, `dω' / dω = (sin θ' dθ') / (sin θ dθ)`.

use dioptric_math::{DVec3, half_turn_angle};

/// A ball and the ends of a way, in the terms of the angle of incidence.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    /// The radius over the distance of the first end, and of the second; 0 for infinity.
    pub k: f64,
    pub l: f64,
    /// One over the index; 0 for a mirror.
    pub m: f64,
    /// The pieces within: 0 off a mirror, 1 through the ball, 2 with a reflection inside.
    pub pieces: f64,
}

/// What a way does at an angle of incidence.
#[derive(Clone, Copy, Debug)]
pub(super) struct At {
    pub sin: f64,
    pub cos: f64,
    /// By how much it turns, less half a turn for each piece within; and the derivative.
    pub turn: f64,
    pub slope: f64,
}

impl Turn {
    /// At an angle with this sine and cosine, from 0 to a quarter of a turn: the sum of the angles by their complex numbers.
    #[inline(always)]
    pub fn at(&self, sin: f64, cos: f64) -> At {
        let Self { k, l, m, pieces } = *self;
        let (sk, sl, sm) = (k * sin, l * sin, m * sin);
        let ck = (1.0 - sk * sk).max(0.0).sqrt();
        let cl = (1.0 - sl * sl).max(0.0).sqrt();
        let cm = (1.0 - sm * sm).max(0.0).sqrt();
        let (twice_cos, twice_sin) = (cos * cos - sin * sin, 2.0 * sin * cos);
        let (inner_cos, inner_sin) = (cm * cm - sm * sm, 2.0 * sm * cm);
        let (square_cos, square_sin) =
            (inner_cos * inner_cos - inner_sin * inner_sin, 2.0 * inner_sin * inner_cos);
        let inner_cos = if pieces > 1.0 { square_cos } else { inner_cos };
        let inner_sin = if pieces > 1.0 { square_sin } else { inner_sin };
        let (outer_cos, outer_sin) = (ck * cl - sk * sl, sk * cl + ck * sl);
        let (x, y) = (
            twice_cos * outer_cos + twice_sin * outer_sin,
            twice_sin * outer_cos - twice_cos * outer_sin,
        );
        let (x, y) = (x * inner_cos + y * inner_sin, y * inner_cos - x * inner_sin);
        let turn = half_turn_angle(x, y.abs());
        let turn = if y < 0.0 { -turn } else { turn };
        let slope = 2.0 - cos * (k / ck + l / cl + 2.0 * pieces * m / cm);
        At { sin, cos, turn, slope }
    }
}

/// A ball that bends light.
#[derive(Clone, Copy, Debug)]
pub struct Bender {
    /// Its middle.
    pub center: DVec3,
    /// Its radius.
    pub radius: f64,
    /// Its index over that of what is around it.
    pub index: f64,
    /// The pieces of the way that lie within: none where it mirrors, two where it mirrors inside; no more.
    pub pieces: u8,
}

impl Bender {
    /// One over the index, 0 where it mirrors.
    pub(super) fn m(&self) -> f64 {
        if self.pieces > 0 { 1.0 / self.index } else { 0.0 }
    }

    pub(super) fn turn(&self, from: f64, to: f64) -> Turn {
        let (k, l) = (self.radius / from, self.radius / to);
        Turn { k, l, m: self.m(), pieces: f64::from(self.pieces) }
    }

    /// By how much the directions in which the ball's middle sees the last ends of ways spread, over the
    /// directions in which these leave `from`, both in solid angles: for a way that leaves along the unit vector `direction`, and by
    /// `onward` comes to the point at `distance` from the middle in the direction `to`, onto a surface with this normal (on either
    /// side). 0 where it is not known.
    #[must_use]
    pub fn spread(
        &self,
        from: DVec3,
        direction: DVec3,
        (to, distance): (DVec3, f64),
        onward: DVec3,
        normal: DVec3,
    ) -> f64 {
        let way = self.center - from;
        let away = way.length();
        let turn = self.turn(away, distance);
        let sin = (way.cross(direction).length() / self.radius).min(1.0);
        let at = turn.at(sin, (1.0 - sin * sin).sqrt());
        let off = way.cross(to).length() / away;
        spread(&turn, &at, off, way.dot(direction) / away, tilt(to, onward, normal))
    }
}

/// [`Bender::spread`] from the sine of the angle between the last end and straight on, the cosine of the angle between the way's
/// beginning and the middle, and [`tilt`].
#[inline(always)]
pub(super) fn spread(turn: &Turn, at: &At, off: f64, cosine: f64, tilt: f64) -> f64 {
    let slope = at.slope.abs();
    let turned = if at.sin > 1e-7 { off / (turn.k * at.sin) } else { slope / turn.k };
    let spread = turned * slope * cosine / (turn.k * at.cos) * tilt;
    if (spread > 0.0) & (spread < f64::INFINITY) { spread } else { 0.0 }
}

/// From a ball about the middle to the surface of the last end; 0 where the middle sees its other side.
#[inline(always)]
pub(super) fn tilt(to: DVec3, onward: DVec3, normal: DVec3) -> f64 {
    let (seen, met) = (normal.dot(to), normal.dot(onward));
    let tilt = to.dot(onward) * (seen / met);
    if seen * met > 0.0 { tilt } else { 0.0 }
}
