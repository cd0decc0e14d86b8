// SPDX-License-Identifier: MIT OR Apache-2.0
//! Roots of polynomials by isolation: between two neighbouring turning points there is at most one,
//! and it is there exactly if the signs at the two differ. No root is lost by subtracting large numbers
//! or by leaving a loop early, and roots come in pairs as long as the outermost signs are equal.

/// How far a turning point may be off: there the function changes by the square of it only.
const TURN: f64 = 1e-11;

/// A stretch that holds exactly one root.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub start: f64,
    /// Where it ends, and whether the function is below 0 there.
    pub end: (f64, bool),
    /// Whether the function is below 0 at the start.
    pub inside_at_start: bool,
}

/// A range cut at up to `N` points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pieces<const N: usize> {
    start: (f64, bool),
    cuts: [(f64, bool); N],
    count: usize,
    end: f64,
}

impl<const N: usize> Pieces<N> {
    /// Cuts `range` at `turns` (sorted; NaN and what is out of range is left out). `inside` tells the
    /// sign at a cut; at the start it is known, and the end is outside.
    pub fn new(
        range: (f64, f64),
        turns: [f64; N],
        inside: impl Fn(f64) -> bool,
        inside_at_start: bool,
    ) -> Self {
        let mut pieces = Self {
            start: (range.0, inside_at_start),
            cuts: [(range.0, false); N],
            count: 0,
            end: range.1,
        };
        for turn in turns {
            if turn > range.0
                && turn < range.1
                && let Some(cut) = pieces.cuts.get_mut(pieces.count)
            {
                *cut = (turn, inside(turn));
                pieces.count += 1;
            }
        }
        pieces
    }

    /// The pieces that hold a root, in order.
    pub fn changes(&self) -> impl Iterator<Item = Piece> + '_ {
        let mut last = self.start;
        let ends = self.cuts.iter().copied().take(self.count).chain([(self.end, false)]);
        ends.filter_map(move |end| {
            let start = std::mem::replace(&mut last, end);
            (start.1 != end.1).then_some(Piece { start: start.0, end, inside_at_start: start.1 })
        })
    }
}

/// The root in a piece, by Newton's steps held in the bracket (Press et al., "Numerical Recipes", 3rd
/// ed., section 9.4), to within `tolerance` or its last digits. `f` gives the value and the derivative.
pub(crate) fn find(f: &impl Fn(f64) -> (f64, f64), piece: Piece, tolerance: f64) -> f64 {
    let (mut a, mut b) = (piece.start, piece.end.0);
    let mut x = 0.5 * (a + b);
    let mut before = b - a;
    // Halving alone needs about 60 steps for all digits, and as many again for tiny numbers.
    for _ in 0..128 {
        let (value, slope) = f(x);
        let step = value / slope;
        // Newton's last step is far better than its own size, rounding aside.
        let enough = tolerance.max(2.0 * f64::EPSILON * x.abs());
        if value == 0.0 {
            return x;
        }
        if step.abs() <= enough {
            return (x - step).max(a).min(b);
        }
        if (value < 0.0) == piece.inside_at_start {
            a = x;
        } else {
            b = x;
        }
        let mut next = x - step;
        // Written so that NaN halves. A step that does not shrink is slower than halving.
        if !(next > a && next < b && step.abs() < 0.5 * before) {
            next = 0.5 * (a + b);
        }
        before = (next - x).abs();
        if before <= enough {
            return next;
        }
        x = next;
    }
    x
}

/// The turning points of `s^4 + p s^2 + q s + ...`, sorted; NaN where there are fewer than three.
pub(crate) fn quartic_turns(p: f64, q: f64) -> [f64; 3] {
    // Half the derivative: 2 s^3 + p s + q / 2.
    let half = |s: f64| ((2.0 * s * s + p) * s + 0.5 * q, 6.0 * s * s + p);
    // All its roots are within this (Cauchy's bound, sharpened by Fujiwara's).
    let reach = 2.0 * (0.5 * p.abs()).sqrt().max(dioptric_math::cbrt(0.25 * q.abs()));
    let mut turns = [f64::NAN; 3];
    if p >= 0.0 {
        turns[0] = monotone(&half, -reach, reach);
        return turns;
    }
    let e = (-p / 6.0).sqrt();
    let (high, low) = (half(-e).0, half(e).0);
    if high > 0.0 {
        turns[0] = monotone(&half, -reach, -e);
    }
    if high > 0.0 && low < 0.0 {
        turns[1] = monotone(&half, e, -e);
    }
    if low < 0.0 {
        turns[if high > 0.0 { 2 } else { 0 }] = monotone(&half, e, reach);
    }
    turns
}

/// The turning points of `s^3 + c3 s^2 + c2 s + ...`, sorted; NaN where there are none.
pub(crate) fn cubic_turns(c3: f64, c2: f64) -> [f64; 2] {
    let root = (c3 * c3 - 3.0 * c2).sqrt();
    // Without cancellation: the product of the two is c2 / 3.
    let q = -(c3 + root.copysign(c3));
    let (s, t) = (q / 3.0, c2 / q);
    if s < t { [s, t] } else { [t, s] }
}

/// The root of a function that is below 0 at `low` and above 0 at `high`, on either side of it.
fn monotone(f: &impl Fn(f64) -> (f64, f64), low: f64, high: f64) -> f64 {
    let (start, end) = (low.min(high), low.max(high));
    find(f, Piece { start, end: (end, low > high), inside_at_start: low <= high }, TURN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_points_are_roots_of_the_derivative() {
        // (s + 1) (s - 0.25) (s - 0.75) = s^3 - 0.8125 s + 0.1875, the derivative of s^4 / 4 - ...
        let turns = quartic_turns(-1.625, 0.75);
        for (turn, expected) in turns.into_iter().zip([-1.0, 0.25, 0.75]) {
            assert!((turn - expected).abs() < 1e-11, "{turns:?}");
        }
        let [only, none, _] = quartic_turns(2.0, -4.0);
        assert!((4.0 * only * only * only + 4.0 * only - 4.0).abs() < 1e-10 && none.is_nan());
        assert_eq!(quartic_turns(0.0, 0.0)[0], 0.0);
        assert_eq!(cubic_turns(-3.0, 0.0), [0.0, 2.0]);
        assert!(cubic_turns(0.0, 3.0)[0].is_nan());
    }

    #[test]
    fn a_bracketed_root_is_found_to_the_last_digits() {
        for exact in [1e-12, 0.3, 1.0, 7.5, 1e9] {
            let f = |s: f64| (s * s * s - exact * exact * exact, 3.0 * s * s);
            let piece = Piece { start: 0.0, end: (1e10, false), inside_at_start: true };
            let found = find(&f, piece, 0.0);
            assert!((found / exact - 1.0).abs() < 1e-14, "{exact}: {found}");
        }
    }
}
