// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cutting the polygons of a file into triangles.
//!
//! A convex polygon becomes a fan from its first corner. Of any other one ear after the other is cut off: a
//! corner whose triangle holds no other corner (Meisters, "Polygons Have Ears", American Mathematical
//! Monthly 82(6), 1975), seen along the polygon's mean normal (Newell's method). Every polygon of n corners
//! gives n - 2 triangles with its orientation; what crosses itself, or has no area, has no right answer and
//! gives some triangles between its corners.

use dioptric_math::{DVec2, DVec3};

/// Tests of corners against ears, for each corner of a polygon, before the rest is cut without testing: bounds
/// the time for polygons of very many corners.
const TESTS: usize = 4096;

/// Cuts a polygon; `emit` gets three indices into `corners` for each triangle.
pub fn cut(corners: &[[f32; 3]], mut emit: impl FnMut([usize; 3])) {
    let n = corners.len();
    if n == 3 {
        return emit([0, 1, 2]);
    }
    if n < 3 {
        return;
    }
    let points = flatten(corners);
    let is_left = |[a, b, c]: [usize; 3]| turn(points[a], points[b], points[c]) >= 0.0;
    if (0..n).all(|i| is_left([(i + n - 1) % n, i, (i + 1) % n])) {
        (2..n).for_each(|i| emit([0, i - 1, i]));
    } else {
        Ears::new(&points).cut(&mut emit);
    }
}

/// The corners as seen along the polygon's normal, counterclockwise on the whole.
fn flatten(corners: &[[f32; 3]]) -> Vec<DVec2> {
    let at = |i: usize| DVec3::from(corners[i % corners.len()].map(f64::from));
    let normal: DVec3 = (1..corners.len()).map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0))).sum();
    let size = normal.abs();
    let flat = |i: usize| {
        let p = at(i) - at(0);
        if size.x >= size.y && size.x >= size.z {
            DVec2::new(p.y, p.z * normal.x.signum())
        } else if size.y >= size.z {
            DVec2::new(p.z, p.x * normal.y.signum())
        } else {
            DVec2::new(p.x, p.y * normal.z.signum())
        }
    };
    (0..corners.len()).map(flat).collect()
}

/// Twice the area of a triangle, positive where it turns left.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The ring of corners that are left.
struct Ears<'a> {
    points: &'a [DVec2],
    before: Vec<usize>,
    after: Vec<usize>,
    /// Corners that turned right when last looked at: only these can lie in an ear.
    right: Vec<usize>,
    is_right: Vec<bool>,
    tests: usize,
}

impl<'a> Ears<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let n = points.len();
        let mut ears = Self {
            points,
            before: (0..n).map(|i| (i + n - 1) % n).collect(),
            after: (0..n).map(|i| (i + 1) % n).collect(),
            right: Vec::new(),
            is_right: vec![false; n],
            tests: n * n.min(TESTS),
        };
        for i in 0..n {
            if !(ears.turn_at(i) > 0.0) {
                ears.is_right[i] = true;
                ears.right.push(i);
            }
        }
        ears
    }

    fn turn_at(&self, i: usize) -> f64 {
        turn(self.points[self.before[i]], self.points[i], self.points[self.after[i]])
    }

    fn is_ear(&mut self, i: usize) -> bool {
        if self.tests == 0 {
            return true;
        }
        if self.is_right[i] {
            return false;
        }
        let (before, after) = (self.before[i], self.after[i]);
        let [a, b, c] = [before, i, after].map(|k| self.points[k]);
        let is_right = &self.is_right;
        self.right.retain(|&k| is_right[k]);
        self.tests = self.tests.saturating_sub(self.right.len());
        !self.right.iter().any(|&k| {
            let p = self.points[k];
            k != before
                && k != after
                // Where the outline meets itself at a corner, as it does where a hole is joined to it, the
                // corner of the same place is in no one's way.
                && p != a
                && p != b
                && p != c
                && turn(a, b, p) >= 0.0
                && turn(b, c, p) >= 0.0
                && turn(c, a, p) >= 0.0
        })
    }

    fn cut(mut self, emit: &mut impl FnMut([usize; 3])) {
        let mut left = self.points.len();
        let mut at = 0;
        let mut refused = 0;
        while left > 3 {
            // Without any ear the polygon crosses itself.
            if refused < left && !self.is_ear(at) {
                refused += 1;
                at = self.after[at];
                continue;
            }
            refused = 0;
            let (before, after) = (self.before[at], self.after[at]);
            emit([before, at, after]);
            self.after[before] = after;
            self.before[after] = before;
            self.is_right[at] = false;
            for k in [before, after] {
                self.is_right[k] &= !(self.turn_at(k) > 0.0);
            }
            left -= 1;
            // Going on beyond the next corner makes fewer slivers than cutting around one corner.
            at = self.after[after];
        }
        emit([self.before[at], at, self.after[at]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::Random;

    fn triangles(corners: &[[f32; 3]]) -> Vec<[usize; 3]> {
        let mut all = Vec::new();
        cut(corners, |t| all.push(t));
        all
    }

    fn area(corners: &[[f32; 3]], [a, b, c]: [usize; 3]) -> DVec3 {
        let [a, b, c] = [a, b, c].map(|i| DVec3::from(corners[i].map(f64::from)));
        (b - a).cross(c - a) / 2.0
    }

    /// The triangles have the polygon's orientation, and together its area.
    fn check(corners: &[[f32; 3]]) {
        let all = triangles(corners);
        assert_eq!(all.len(), corners.len() - 2);
        let whole: DVec3 = (2..corners.len()).map(|i| area(corners, [0, i - 1, i])).sum();
        let normal = whole.normalize();
        let mut sum = 0.0;
        for t in all {
            let a = area(corners, t).dot(normal);
            assert!(a >= -1e-6 * whole.length(), "{t:?} is turned over: {corners:?}");
            sum += a.abs();
        }
        assert!((sum - whole.length()).abs() <= 1e-5 * whole.length(), "{corners:?}");
    }

    #[test]
    fn convex_ones_are_fans() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(triangles(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(&square[..3]), [[0, 1, 2]]);
        assert_eq!(triangles(&square[..2]), [[0; 3]; 0]);
    }

    #[test]
    fn arrows_are_cut_at_the_right_corner() {
        let arrow = [[0.0, 0.0, 2.0], [2.0, -1.0, 2.0], [0.5, 0.0, 2.0], [2.0, 1.0, 2.0]];
        for first in 0..4 {
            let mut turned = arrow;
            turned.rotate_left(first);
            check(&turned);
            turned.reverse();
            check(&turned);
        }
    }

    #[test]
    fn stars_combs_and_spirals_in_every_plane() {
        let mut random = Random::new(3);
        for n in [5_usize, 8, 20, 101] {
            for _ in 0..20 {
                let star: Vec<[f32; 3]> = (0..n)
                    .map(|i| {
                        let angle = i as f64 / n as f64 * std::f64::consts::TAU;
                        let r = random.uniform(0.1, 1.0);
                        let (s, c) = (dioptric_math::sin(angle) * r, dioptric_math::cos(angle) * r);
                        [c, s, 0.3 * c - 0.2 * s].map(|x| x as f32)
                    })
                    .collect();
                for turn in 0..3 {
                    let turned: Vec<[f32; 3]> = star
                        .iter()
                        .map(|p| [p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]])
                        .collect();
                    check(&turned);
                }
            }
        }
        let mut comb = vec![[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]];
        for i in (0..100).rev() {
            comb.push([i as f32 + 0.5, 10.0, 0.0]);
            comb.push([i as f32, 0.1, 0.0]);
        }
        comb.pop();
        check(&comb);
    }

    #[test]
    fn a_hole_joined_to_the_outline() {
        let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];
        let all: Vec<[f32; 3]> = outer.iter().chain(&hole).map(|p| [p[0], 0.0, p[1]]).collect();
        check(&all);
    }

    #[test]
    fn nonsense_ends_soon() {
        let mut random = Random::new(5);
        for n in [4_usize, 7, 3000] {
            let tangle: Vec<[f32; 3]> = (0..n)
                .map(|_| [random.unit() as f32, random.unit() as f32, random.unit() as f32])
                .collect();
            assert_eq!(triangles(&tangle).len(), n - 2);
            assert_eq!(triangles(&vec![[f32::NAN; 3]; n]).len(), n - 2);
            assert_eq!(triangles(&vec![[1.0; 3]; n]).len(), n - 2);
        }
    }
}
