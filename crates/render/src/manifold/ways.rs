// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ways of light over balls from one given point to another, sixteen side by side.
//!
//! Each term of the derivative of a [`Turn`] grows with the angle of incidence, so Newton's method, begun at the end of the
//! angles beyond a root, comes to it from one side and never leaves.

use std::f64::consts::{FRAC_PI_2, PI};

use dioptric_geometry::world::Sixteen;
use dioptric_math::wide::{Kernel, wide};
use dioptric_math::{DVec3, half_turn_angle, turn_sin_cos};

use super::bend::{At, Bender, Turn, spread, tilt};
use crate::lanes::{LANES, Vectors, ZERO, bits, flags, get, put};

/// Steps of Newton's method at most: near a caustic, where two ways become one, each only halves what is left.
const STEPS: usize = 16;
/// How small the last step is at most (it squares what is left), and how far off the turn may be then.
const CLOSE: f64 = 1e-5;
const OFF: f64 = 1e-8;

/// Which of the ways between two points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// The only one of mirrors: where the turn is the angle that is wanted.
    Far,
    /// Where it is that angle to the other side, away from the axis.
    Wide,
    /// The same, near the axis.
    Narrow,
}

impl Branch {
    /// All that there are.
    pub const ALL: [Self; 3] = [Self::Far, Self::Wide, Self::Narrow];
}

/// Ends of ways, and the ways that were found.
#[derive(Clone, Debug)]
pub struct Ways {
    /// The first ends.
    pub from: Vectors,
    center: Vectors,
    radius: Sixteen,
    /// One over the index; 0 for mirrors.
    m: Sixteen,
    pieces: Sixteen,
    /// The last ends: unit vectors from the middle, distances from there, and normals of surfaces on either side.
    pub to: Vectors,
    /// See [`Self::to`].
    pub distance: Sixteen,
    /// See [`Self::to`].
    pub normal: Vectors,
    /// Unit vectors by which the ways leave their first ends, and how far it is to the ball.
    pub direction: Vectors,
    /// See [`Self::direction`].
    pub length: Sixteen,
    /// Where they leave the ball, and unit vectors and distances from there to the last ends.
    pub exit: Vectors,
    /// See [`Self::exit`].
    pub onward: Vectors,
    /// See [`Self::exit`].
    pub reach: Sixteen,
    /// The cosines of the angles of incidence.
    pub cos: Sixteen,
    /// The lengths within the balls, all pieces together.
    pub chord: Sixteen,
    /// As by [`Bender::spread`].
    pub spread: Sixteen,
    // What is known of them before they are solved for.
    turns: Vectors,
    ahead: Vectors,
    side: Vectors,
    /// The sine of the angle by which the last end is off, and that angle.
    off: [Sixteen; 2],
    ats: [Sixteen; 4],
}

impl Ways {
    /// None yet.
    pub const EMPTY: Self = Self {
        from: ZERO,
        center: ZERO,
        radius: [1.0; LANES],
        m: [0.0; LANES],
        pieces: [0.0; LANES],
        to: ZERO,
        distance: [1.0; LANES],
        normal: ZERO,
        direction: ZERO,
        length: [0.0; LANES],
        exit: ZERO,
        onward: ZERO,
        reach: [0.0; LANES],
        cos: [0.0; LANES],
        chord: [0.0; LANES],
        spread: [0.0; LANES],
        turns: ZERO,
        ahead: ZERO,
        side: ZERO,
        off: [[0.0; LANES]; 2],
        ats: [[0.0; LANES]; 4],
    };

    /// Sets a way: its ball and its ends.
    #[inline]
    pub fn set(
        &mut self,
        lane: usize,
        bender: &Bender,
        from: DVec3,
        to: (DVec3, f64),
        normal: DVec3,
    ) {
        let lane = lane % LANES;
        put(&mut self.center, lane, bender.center);
        self.radius[lane] = bender.radius;
        (self.m[lane], self.pieces[lane]) = (bender.m(), f64::from(bender.pieces));
        put(&mut self.from, lane, from);
        put(&mut self.to, lane, to.0);
        self.distance[lane] = to.1;
        put(&mut self.normal, lane, normal);
    }

    /// Gets ready to solve for ways, in these lanes; those where there may be one.
    pub fn begin(&mut self, lanes: u16) -> u16 {
        wide(Begin(self, lanes))
    }

    /// Looks for the ways of a branch in these lanes: where there is one.
    pub fn solve(&mut self, branch: Branch, lanes: u16) -> u16 {
        let lanes = wide(Start(self, branch, lanes));
        if lanes == 0 { 0 } else { wide(Solve(self, branch, lanes)) }
    }
}

struct Begin<'a>(&'a mut Ways, u16);

impl Kernel for Begin<'_> {
    type Output = u16;

    #[inline(always)]
    fn run(self) -> u16 {
        let Self(ways, lanes) = self;
        let lanes = flags(lanes);
        let Ways { from, center, radius, to, distance, turns: [k, l, _], ahead, side, off, .. } =
            ways;
        let mut usable = [0.0; LANES];
        for i in 0..LANES {
            let way = get(center, i) - get(from, i);
            let away = way.length();
            let forward = way / away;
            (k[i], l[i]) = (radius[i] / away, radius[i] / distance[i]);
            let to = get(to, i);
            let cos = forward.dot(to);
            let across = to - forward * cos;
            let sin = across.length();
            let across = across / sin;
            put(ahead, i, forward);
            put(side, i, across);
            off[0][i] = sin;
            off[1][i] = half_turn_angle(cos, sin);
            let outside = (k[i] < 1.0) & (l[i] < 1.0);
            usable[i] = if outside & (sin > 1e-9) { lanes[i] } else { 0.0 };
        }
        bits(&usable)
    }
}

/// Finds out where there is a root, and begins there.
struct Start<'a>(&'a mut Ways, Branch, u16);

impl Kernel for Start<'_> {
    type Output = u16;

    #[inline(always)]
    fn run(self) -> u16 {
        let Self(ways, branch, lanes) = self;
        let lanes = flags(lanes);
        let Ways { m, pieces, turns, off: [_, off], ats, .. } = ways;
        let [k, l, wanted] = turns;
        let mut usable = [0.0; LANES];
        let far = branch == Branch::Far;
        let (sin, cos) = if branch == Branch::Narrow { (0.0, 1.0) } else { (1.0, 0.0) };
        for i in 0..LANES {
            let across = pieces[i] == 1.0;
            let off = if across { off[i] } else { PI - off[i] };
            let turn = if far { off } else { -off };
            wanted[i] = turn;
            let at = Turn { k: k[i], l: l[i], m: m[i], pieces: pieces[i] }.at(sin, cos);
            // At the axis the way through a ball turns by nothing.
            let known = if branch == Branch::Narrow { 0.0 } else { at.turn };
            (ats[0][i], ats[1][i], ats[2][i], ats[3][i]) = (sin, cos, known, at.slope);
            // Through the ball on the side of the last end only where it widens light near its axis.
            let nearby = 2.0 - k[i] - l[i] - 2.0 * pieces[i] * m[i] < 0.0;
            let exists = if far { true } else { (pieces[i] > 0.0) & nearby };
            let above = known >= turn;
            usable[i] = if exists & above { lanes[i] } else { 0.0 };
        }
        bits(&usable)
    }
}

/// Comes to the roots, and tells of the ways.
struct Solve<'a>(&'a mut Ways, Branch, u16);

impl Kernel for Solve<'_> {
    type Output = u16;

    #[inline(always)]
    fn run(self) -> u16 {
        let Self(ways, branch, lanes) = self;
        let Ways { m, pieces, turns, ats, .. } = &mut *ways;
        let [k, l, wanted] = &*turns;
        let [sin, cos, turn, slope] = ats;
        // 1 where a way is still looked for.
        let mut on = flags(lanes);
        let mut found: Sixteen = [0.0; LANES];
        let narrow = branch == Branch::Narrow;
        let mut angle = [if narrow { 0.0 } else { FRAC_PI_2 }; LANES];
        for _ in 0..STEPS {
            let mut left = 0.0;
            for i in 0..LANES {
                let step = (turn[i] - wanted[i]) / slope[i];
                let next = angle[i] - step;
                let towards = if narrow { slope[i] < 0.0 } else { slope[i] > 0.0 };
                // (A range's `contains` would branch.)
                #[allow(clippy::manual_range_contains)]
                let within = towards & (next >= 0.0) & (next <= FRAC_PI_2);
                let go = (on[i] != 0.0) & within;
                let next = if go { next } else { angle[i] };
                let (s, c) = turn_sin_cos(next);
                let at = Turn { k: k[i], l: l[i], m: m[i], pieces: pieces[i] }.at(s, c.max(0.0));
                angle[i] = next;
                sin[i] = if go { at.sin } else { sin[i] };
                cos[i] = if go { at.cos } else { cos[i] };
                turn[i] = if go { at.turn } else { turn[i] };
                slope[i] = if go { at.slope } else { slope[i] };
                let there = go & (step.abs() <= CLOSE);
                found[i] = if there { 1.0 } else { found[i] };
                on[i] = if go & !there { 1.0 } else { 0.0 };
                left += on[i];
            }
            if left == 0.0 {
                break;
            }
        }
        for i in 0..LANES {
            let close = (turn[i] - wanted[i]).abs() <= OFF;
            found[i] = if close { found[i].max(on[i]) } else { 0.0 };
        }
        tell(ways, branch, &mut found);
        bits(&found)
    }
}

/// Fills in what there is to know of ways at their angles.
#[inline(always)]
fn tell(ways: &mut Ways, branch: Branch, found: &mut Sixteen) {
    let Ways { from, center, radius, m, pieces, to, distance, normal, .. } = ways;
    let Ways { direction, length, exit, onward, reach, cos, chord, spread: spreads, .. } = ways;
    let Ways {
        turns: [k, l, _], ahead, side, off: [off, _], ats: [sin, cosines, turn, slope], ..
    } = ways;
    for i in 0..LANES {
        let (center, r) = (get(center, i), radius[i]);
        let at = At { sin: sin[i], cos: cosines[i], turn: turn[i], slope: slope[i] };
        let across = pieces[i] == 1.0;
        let side = get(side, i);
        let side = if across == (branch != Branch::Far) { side } else { -side };
        let ahead = get(ahead, i);
        // The angle at the first end, and where the way meets the ball, as seen from the middle.
        let sine = k[i] * at.sin;
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        let sin_met = at.sin * cosine - at.cos * sine;
        let cos_met = at.cos * cosine + at.sin * sine;
        let met = center + (side * sin_met - ahead * cos_met) * r;
        // Where it leaves the ball, one or two chords on.
        let s = m[i] * at.sin;
        let c = (1.0 - s * s).max(0.0).sqrt();
        let (s2, c2) = (2.0 * s * c, c * c - s * s);
        let (sin_one, cos_one) = (sin_met * c2 - cos_met * s2, cos_met * c2 + sin_met * s2);
        let (sin_two, cos_two) = (sin_one * c2 - cos_one * s2, cos_one * c2 + sin_one * s2);
        let sin_out = if across { -sin_one } else { sin_two };
        let cos_out = if across { -cos_one } else { cos_two };
        let out = center + (side * sin_out - ahead * cos_out) * r;
        let out = if pieces[i] == 0.0 { met } else { out };
        let to = get(to, i);
        let rest = center + to * distance[i] - out;
        let far = rest.length();
        let on = rest / far;
        let first = ahead * cosine + side * sine;
        put(direction, i, first);
        put(exit, i, out);
        put(onward, i, on);
        length[i] = (met - get(from, i)).length();
        reach[i] = far;
        cos[i] = at.cos;
        chord[i] = 2.0 * r * c * pieces[i];
        let turn = Turn { k: k[i], l: l[i], m: m[i], pieces: pieces[i] };
        let wider = spread(&turn, &at, off[i], cosine, tilt(to, on, get(normal, i)));
        spreads[i] = wider;
        let sound = (wider > 0.0) & (length[i] < f64::INFINITY) & (far < f64::INFINITY);
        found[i] = if sound { found[i] } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::optics::{reflect, refract};
    use dioptric_math::random::Random;

    fn ball((index, pieces): (f64, u8)) -> Bender {
        Bender { center: DVec3::new(0.3, -0.2, 0.5), radius: 0.7, index, pieces }
    }

    const KINDS: [(f64, u8); 7] =
        [(1.0, 0), (1.2, 1), (1.5, 1), (2.4, 1), (1.2, 2), (1.5, 2), (2.4, 2)];

    /// Follows a ray over the ball by Snell's law: where it leaves it, and its direction.
    fn followed(ball: &Bender, from: DVec3, direction: DVec3) -> Option<(DVec3, DVec3)> {
        let meet = |from: DVec3, direction: DVec3, last: bool| {
            let way = from - ball.center;
            let b = way.dot(direction);
            let root = (b * b - way.length_squared() + ball.radius * ball.radius).sqrt();
            let t = if last { -b + root } else { -b - root };
            (t > 0.0).then(|| from + direction * t)
        };
        let met = meet(from, direction, false)?;
        let normal = (met - ball.center) / ball.radius;
        let n = ball.index;
        if ball.pieces == 0 {
            return Some((met, reflect(direction, normal)));
        }
        let mut within = refract(direction, normal, 1.0 / n)?;
        let mut out = meet(met, within, true)?;
        if ball.pieces == 2 {
            within = reflect(within, (out - ball.center) / ball.radius);
            out = meet(out, within, true)?;
        }
        Some((out, refract(within, -(out - ball.center) / ball.radius, n)?))
    }

    fn point(random: &mut Random, ball: &Bender) -> DVec3 {
        loop {
            let p = DVec3::from([(); 3].map(|()| random.uniform(-3.0, 3.0)));
            if (p - ball.center).length() > 1.02 * ball.radius {
                return p;
            }
        }
    }

    /// All ways between two points: the direction, the place where the ball is left, the direction from there, the distance, and
    /// [`Ways::spread`].
    fn all(
        ball: &Bender,
        from: DVec3,
        to: DVec3,
        normal: DVec3,
    ) -> Vec<(DVec3, DVec3, DVec3, f64, f64)> {
        let mut ways = Ways::EMPTY;
        let way = to - ball.center;
        ways.set(7, ball, from, (way.normalize(), way.length()), normal);
        let usable = ways.begin(1 << 7);
        let mut found = Vec::new();
        for branch in Branch::ALL {
            if ways.solve(branch, usable) != 0 {
                let [direction, exit, onward] =
                    [&ways.direction, &ways.exit, &ways.onward].map(|v| get(v, 7));
                found.push((direction, exit, onward, ways.reach[7], ways.spread[7]));
            }
        }
        found
    }

    #[test]
    fn every_way_that_snells_law_finds_is_one_of_ours_and_no_other_is() {
        let mut random = Random::new(5);
        for index in KINDS {
            let ball = ball(index);
            let mut count = [0; 3];
            for _ in 0..20_000 {
                let from = point(&mut random, &ball);
                let aim =
                    ball.center + point(&mut random, &ball).normalize() * (0.69 * random.unit());
                let direction = (aim - from).normalize();
                let Some((exit, onward)) = followed(&ball, from, direction) else { continue };
                let to = exit + onward * (3.0 * random.unit());
                let way = to - ball.center;
                if way.length() < 1.02 * ball.radius {
                    continue;
                }
                let normal = (exit - to).normalize();
                let found = all(&ball, from, to, normal);
                let same = found.iter().find(|w| (w.0 - direction).length() < 1e-6);
                let seen = (way.normalize(), way.length());
                let spread = ball.spread(from, direction, seen, onward, normal);
                // Where two ways become one, neither may be found.
                assert!(
                    same.is_some() || spread < 1e-3,
                    "{index:?} {from} {direction} {to} {spread}"
                );
                count[found.len().max(1) - 1] += 1;
                for &(direction, exit, onward, reach, spread) in &found {
                    let (out, on) = followed(&ball, from, direction).unwrap();
                    assert!((out - exit).length() < 1e-7, "{out} {exit}");
                    assert!((on - onward).length() < 1e-6, "{on} {onward}");
                    assert!((exit + onward * reach - to).length() < 1e-9);
                    let own = ball.spread(from, direction, seen, onward, normal);
                    assert!((spread - own).abs() < 1e-4 * own.max(1.0), "{spread} {own}");
                }
            }
            assert!(
                count[0] > 500 && (index.1 == 0 || count[1] + count[2] > 50),
                "{index:?} {count:?}"
            );
        }
    }

    #[test]
    fn spread_is_that_of_neighbouring_ways() {
        let mut random = Random::new(6);
        let mut count = 0;
        for index in KINDS {
            let ball = ball(index);
            for _ in 0..2000 {
                let from = point(&mut random, &ball);
                let aim =
                    ball.center + point(&mut random, &ball).normalize() * (0.65 * random.unit());
                let direction = (aim - from).normalize();
                let normal = point(&mut random, &ball).normalize();
                let Some((exit, onward)) = followed(&ball, from, direction) else { continue };
                let to = exit + onward * (0.5 + 3.0 * random.unit());
                // The plane of the last surface.
                let seen = |direction: DVec3| {
                    let (exit, onward) = followed(&ball, from, direction)?;
                    let t = (to - exit).dot(normal) / onward.dot(normal);
                    Some((exit + onward * t - ball.center).normalize())
                };
                let (x, y) = dioptric_math::orthonormal_basis(direction);
                let h = 1e-6;
                let step = |v: DVec3| {
                    Some(
                        (seen((direction + v * h).normalize())?
                            - seen((direction - v * h).normalize())?)
                            / (2.0 * h),
                    )
                };
                let (Some(dx), Some(dy)) = (step(x), step(y)) else { continue };
                let way = to - ball.center;
                let spread =
                    ball.spread(from, direction, (way.normalize(), way.length()), onward, normal);
                let expected = dx.cross(dy).length();
                if spread == 0.0 || expected > 1e3 || normal.dot(onward).abs() < 0.05 {
                    continue;
                }
                assert!(
                    (spread / expected - 1.0).abs() < 1e-3 || (spread - expected).abs() < 1e-4,
                    "{spread} {expected}"
                );
                count += 1;
            }
        }
        assert!(count > 2000, "{count}");
    }
}
