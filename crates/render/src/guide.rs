// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where light comes from that glass and mirrors have gathered: directions for paths that chance alone would seldom pick.
//!
//! Photons that came to dull surfaces by way of sharp ones (`integrator::path::photons`) are kept in a tree over places.
//! From a place, those near it say to where on the glass to look: each is a lobe about the direction to the point at which it
//! left the glass, as wide as the gaps between these points (after Jensen, "Importance Driven Path Tracing using the
//! Photon Map", EGWR 1995). Paths pick from these lobes or from their surface's own, each half of the times, and count by
//! the density of both: whatever the lobes are, the mean stays the same.

use std::f64::consts::PI;

use dioptric_math::{DVec3, exp, ln, normalize, orthonormal_basis, sin_cos};

/// Photons of a leaf, at most.
const LEAF: usize = 24;
/// How often the lobes are asked.
pub(crate) const SHARE: f64 = 0.5;
/// From wider to narrower: the exponents of lobes.
const KAPPA: (f64, f64) = (4.0, 1e7);

/// A photon that came to a dull surface.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Where.
    pub at: DVec3,
    /// Where it came from: its last sharp surface.
    pub from: DVec3,
    /// What it brought, in proportion.
    pub weight: f64,
    /// Its wavelength in micrometres, if it has one; else 0.
    pub wavelength: f64,
}

/// A photon as a lobe.
#[derive(Clone, Copy, Debug)]
struct Lobe {
    at: DVec3,
    from: DVec3,
    weight: f64,
    /// How far it is from `from` to others'.
    gap: f64,
    wavelength: f64,
}

#[derive(Clone, Copy, Debug)]
enum Node {
    /// Those below a coordinate come next, the others at this place.
    Split { axis: usize, at: f64, other: u32 },
    /// Lobes from here, so many, in a ball.
    Leaf { first: u32, count: u32, center: DVec3, radius: f64 },
}

/// All photons.
#[derive(Clone, Debug)]
pub struct Guide {
    nodes: Vec<Node>,
    lobes: Vec<Lobe>,
}

/// The lobes at one place.
#[derive(Clone, Copy, Debug)]
pub struct Aim<'a> {
    lobes: &'a [Lobe],
    shares: [f64; LEAF],
    point: DVec3,
}

impl Guide {
    /// Of these photons; nothing where there are too few to say anything.
    #[must_use]
    pub fn new(photons: &[Photon]) -> Option<Self> {
        let usable = |p: &&Photon| {
            p.weight > 0.0 && p.weight.is_finite() && p.at.is_finite() && p.from.is_finite()
        };
        let lobe = |p: &Photon| {
            let Photon { at, from, weight, wavelength } = *p;
            Lobe { at, from, weight, gap: 0.0, wavelength }
        };
        let lobes: Vec<Lobe> = photons.iter().filter(usable).map(lobe).collect();
        if lobes.len() < 4 {
            return None;
        }
        let mut guide = Self { nodes: Vec::new(), lobes };
        guide.build(0, guide.lobes.len());
        Some(guide)
    }

    /// Builds the tree over some of the lobes.
    fn build(&mut self, first: usize, end: usize) {
        let lobes = &mut self.lobes[first..end];
        let bounds = lobes.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), l| {
            (low.min(l.at), high.max(l.at))
        });
        let size = bounds.1 - bounds.0;
        if lobes.len() <= LEAF {
            for i in 0..lobes.len() {
                // The third nearest: two photons may have come the same way.
                let mut near = [f64::INFINITY; 3];
                for j in (0..lobes.len()).filter(|&j| j != i) {
                    let mut d = (lobes[j].from - lobes[i].from).length();
                    for n in &mut near {
                        if d < *n {
                            std::mem::swap(&mut d, n);
                        }
                    }
                }
                let known = near.into_iter().rev().find(|d| d.is_finite());
                lobes[i].gap = known.unwrap_or(0.0);
            }
            let count = lobes.len() as u32;
            let (center, radius) = ((bounds.0 + bounds.1) * 0.5, size.length() * 0.5);
            self.nodes.push(Node::Leaf { first: first as u32, count, center, radius });
            return;
        }
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let middle = lobes.len() / 2;
        lobes.select_nth_unstable_by(middle, |a, b| a.at[axis].total_cmp(&b.at[axis]));
        let at = lobes[middle].at[axis];
        let node = self.nodes.len();
        self.nodes.push(Node::Split { axis, at, other: 0 });
        self.build(first, first + middle);
        let other = self.nodes.len() as u32;
        self.nodes[node] = Node::Split { axis, at, other };
        self.build(first + middle, end);
    }

    /// The lobes for a place; nothing where no photon came near.
    #[must_use]
    pub fn aim(&self, point: DVec3) -> Option<Aim<'_>> {
        let mut node = 0;
        let (first, count, center, radius) = loop {
            match *self.nodes.get(node)? {
                Node::Split { axis, at, other } => {
                    node = if point[axis] < at { node + 1 } else { other as usize };
                }
                Node::Leaf { first, count, center, radius } => {
                    break (first as usize, count as usize, center, radius);
                }
            }
        };
        if !((point - center).length() <= 1.5 * radius) {
            return None;
        }
        let lobes = self.lobes.get(first..first + count)?;
        let mut shares = [0.0; LEAF];
        let near = (0.3 * radius) * (0.3 * radius);
        let mut sum = 0.0;
        for (share, lobe) in shares.iter_mut().zip(lobes) {
            // Photons that came nearer say more.
            *share = lobe.weight * near / ((lobe.at - point).length_squared() + near);
            sum += *share;
        }
        for share in &mut shares {
            *share /= sum;
        }
        (sum > 0.0 && sum.is_finite()).then_some(Aim { lobes, shares, point })
    }
}

impl Lobe {
    /// The direction from a place, and the exponent of von Mises and Fisher's distribution about it.
    fn seen(&self, point: DVec3) -> Option<(DVec3, f64)> {
        let way = self.from - point;
        let spread = self.gap * self.gap / way.length_squared();
        let kappa = (1.0 / spread).clamp(KAPPA.0, KAPPA.1);
        Some((normalize(way)?, kappa)).filter(|(_, k)| k.is_finite())
    }
}

/// Von Mises and Fisher's density for the cosine of the angle to the middle.
fn density_of(kappa: f64, cos: f64) -> f64 {
    kappa / (2.0 * PI * (1.0 - exp(-2.0 * kappa))) * exp(kappa * (cos - 1.0))
}

impl Aim<'_> {
    /// A direction, for numbers in `[0, 1)`, and the wavelength that came from there; 0 for all.
    #[must_use]
    pub fn sample(&self, pick: f64, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let (mut i, mut rest) = (0, pick);
        while i + 1 < self.lobes.len() && rest >= self.shares[i] {
            rest -= self.shares[i];
            i += 1;
        }
        let (middle, kappa) = self.lobes[i].seen(self.point)?;
        let down = ln(u[0] + (1.0 - u[0]) * exp(-2.0 * kappa)) / kappa;
        let cos = (1.0 + down).clamp(-1.0, 1.0);
        // Near the middle 1 - cos is what is known well.
        let sin = (-down * (2.0 + down)).max(0.0).sqrt();
        let (a, b) = sin_cos(2.0 * PI * u[1]);
        let (x, y) = orthonormal_basis(middle);
        let direction = normalize(middle * cos + x * (sin * b) + y * (sin * a))?;
        Some((direction, self.lobes[i].wavelength))
    }

    /// The density of [`Self::sample`] over solid angles.
    #[must_use]
    pub fn density(&self, direction: DVec3) -> f64 {
        let mut sum = 0.0;
        for (lobe, share) in self.lobes.iter().zip(self.shares) {
            let Some((middle, kappa)) = lobe.seen(self.point) else { continue };
            // 1 - cos without taking 1 from nearly 1.
            let below = 0.5 * (direction - middle).length_squared();
            if kappa * below < 40.0 {
                sum += share * density_of(kappa, 1.0 - below);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::{mix, unit};

    /// Photons on a floor that came from a lens above.
    fn photons(n: u64) -> Vec<Photon> {
        let number = |i: u64| unit(mix(i)) - 0.5;
        (0..n)
            .map(|i| {
                let at = DVec3::new(number(3 * i), 0.0, number(3 * i + 1));
                let from = at * 0.3 + DVec3::Y;
                Photon { at, from, weight: 1.0 + number(3 * i + 2), wavelength: 0.0 }
            })
            .collect()
    }

    #[test]
    fn lobes_have_the_density_that_is_said() {
        let guide = Guide::new(&photons(500)).unwrap();
        for point in [DVec3::ZERO, DVec3::new(0.31, 0.01, -0.2)] {
            let aim = guide.aim(point).unwrap();
            // The mean of (1 / density) over the directions found within a small disc, where most light comes from as
            // seen from here, is the disc's solid angle.
            let middle = point * 0.3 + DVec3::Y * (1.0 - 0.3 * point.y);
            let (n, radius) = (200_000, 0.04);
            let mut sum = 0.0;
            for i in 0..n {
                let u = [unit(mix(5 * i)), unit(mix(5 * i + 1))];
                let (d, _) = aim.sample(unit(mix(5 * i + 2)), u).unwrap();
                assert!((d.length() - 1.0).abs() < 1e-9);
                let met = point + d * ((1.0 - point.y) / d.y);
                if d.y > 0.0 && (met - middle).length() < radius {
                    sum += 1.0 / aim.density(d);
                }
            }
            let way = middle - point;
            let angle = PI * radius * radius * way.y / (way.length() * way.length_squared());
            let found = sum / n as f64;
            assert!((found / angle - 1.0).abs() < 0.03, "{found} {angle}");
        }
    }

    #[test]
    fn directions_are_found_as_often_as_their_lobes_say() {
        let guide = Guide::new(&photons(500)).unwrap();
        for (i, point) in [DVec3::ZERO, DVec3::new(0.31, 0.01, -0.2)].into_iter().enumerate() {
            let aim = guide.aim(point).unwrap();
            // By where a direction meets the lens, a square of side 0.4 about what is seen most.
            let (middle, side, height) = (point * 0.3, 0.4, 1.0 - point.y);
            let way = |[a, b]: [f64; 2]| {
                let off = DVec3::new(a - 0.5, 0.0, b - 0.5) * side;
                DVec3::new(middle.x - point.x, height, middle.z - point.z) + off
            };
            let verdict = crate::statistics::judge(
                [16, 16],
                [24, 24],
                |at| {
                    let way = way(at);
                    let per_angle = height * side * side / (way.length() * way.length_squared());
                    aim.density(way.normalize()) * per_angle
                },
                |r| {
                    let (d, _) = aim.sample(r.unit(), [r.unit(), r.unit()])?;
                    let met = point + d * (height / d.y) - middle;
                    let at = [met.x, met.z].map(|x| x / side + 0.5);
                    let there = d.y > 0.0 && at.iter().all(|x| (0.0..1.0).contains(x));
                    there.then_some(at)
                },
                60 + i as u64,
            );
            verdict.check(&format!("from {point}"), 2);
        }
    }

    #[test]
    fn where_no_photon_came_nothing_is_said() {
        let guide = Guide::new(&photons(300)).unwrap();
        assert!(guide.aim(DVec3::new(5.0, 0.0, 0.0)).is_none());
        assert!(guide.aim(DVec3::NAN).is_none());
        assert!(Guide::new(&photons(2)).is_none());
    }

    #[test]
    fn photons_at_one_place_do_no_harm() {
        let one = Photon { at: DVec3::ONE, from: DVec3::ONE, weight: 1.0, wavelength: 0.0 };
        let guide = Guide::new(&[one; 100]).unwrap();
        assert!(guide.aim(DVec3::ONE).is_none_or(|aim| aim.density(DVec3::X).is_finite()));
    }
}
