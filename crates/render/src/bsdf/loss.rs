// SPDX-License-Identifier: MIT OR Apache-2.0
//! What rough surfaces lose if light that meets a second facet is dropped, and what rough coats mirror: tables by
//! the index of refraction, the width of the facets' distribution and the cosine of a direction, worked out by
//! quadrature (the tests do it again, and say how near a table is between its entries).

use crate::integrator::optics::fresnel;

/// Indices of refraction in a table.
const INDICES: usize = 12;
/// Widths in a table.
const WIDTHS: usize = 12;
/// Cosines in a table.
const COSINES: usize = 16;
/// A row: one width, its cosines, and the mean over all of them.
const ROW: usize = COSINES + 1;
/// A table's sheets: of mirrors, of what enters a dielectric, of what leaves it, and of coats.
const MIRROR: usize = 0;
const ENTER: usize = 1;
const LEAVE: usize = ENTER + INDICES;
const COAT: usize = LEAVE + INDICES;
const SHEETS: usize = COAT + INDICES;
/// Numbers from -1 to 1 in 32767ths, little-endian: sheets by increasing index, rows by increasing width.
static TABLE: &[u8; 2 * SHEETS * WIDTHS * ROW] = include_bytes!("loss.bin");

/// The largest `(n - 1) / (n + 1)` in a table: an index of 10.
const LARGEST: f64 = 9.0 / 11.0;

/// A place in the tables for all but the direction.
#[derive(Clone, Copy, Debug)]
struct Place {
    alpha: f64,
    /// Where the first of its rows begins.
    start: usize,
    /// How far on it is to the next width and the next index.
    on: [f64; 2],
}

impl Place {
    /// `first`: the sheet of the smallest of indices; `n`: the index of refraction, at least 1, if it matters.
    fn new(first: usize, alpha: f64, n: Option<f64>) -> Self {
        // Square roots: narrow distributions and small indices differ most.
        let (row, on) = place(alpha.sqrt(), WIDTHS);
        let (sheet, further) = match n {
            Some(n) => place(((n - 1.0) / (n + 1.0) / LARGEST).max(0.0).sqrt(), INDICES),
            None => (0, 0.0),
        };
        Self { alpha, start: ((first + sheet) * WIDTHS + row) * ROW, on: [on, further] }
    }

    #[inline]
    fn at(&self, cos: f64) -> f64 {
        let (column, on) = place(spread(self.alpha, cos), COSINES);
        let near = self.between(column);
        near + (self.between(column + 1) - near) * on
    }

    fn mean(&self) -> f64 {
        self.between(COSINES)
    }

    #[inline]
    fn between(&self, column: usize) -> f64 {
        let start = self.start + column;
        let sheet = |start: usize| {
            let near = entry(start);
            near + (entry(start + ROW) - near) * self.on[0]
        };
        let near = sheet(start);
        if self.on[1] == 0.0 {
            return near;
        }
        near + (sheet(start + WIDTHS * ROW) - near) * self.on[1]
    }
}

/// Where in a row a cosine is, from 0 to 1. Where it and the width are small, entries are functions of their ratio.
#[inline]
fn spread(alpha: f64, cos: f64) -> f64 {
    let cos = cos.max(0.0);
    (2.0 * (cos * (1.0 + alpha) / (cos + alpha)).sqrt() + cos) / 3.0
}

/// The entry of `n` before a place from 0 to 1, and how far on it is to the next.
#[inline]
fn place(x: f64, n: usize) -> (usize, f64) {
    let x = x.clamp(0.0, 1.0) * (n - 1) as f64;
    let before = (x as usize).min(n - 2);
    (before, x - before as f64)
}

#[inline]
fn entry(i: usize) -> f64 {
    f64::from(i16::from_le_bytes([TABLE[2 * i], TABLE[2 * i + 1]])) * (1.0 / 32767.0)
}

/// What a rough surface that takes nothing loses, by direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loss(Place);

impl Loss {
    /// Of a mirror with facets of width `alpha`, 0 to 1.
    pub fn of_mirror(alpha: f64) -> Self {
        Self(Place::new(MIRROR, alpha, None))
    }

    /// Of a dielectric, for light (or a viewer) on the side with `eta` times the other's index of refraction.
    pub fn of_dielectric(alpha: f64, eta: f64) -> Self {
        let (first, n) = if eta < 1.0 { (ENTER, 1.0 / eta) } else { (LEAVE, eta) };
        Self(Place::new(first, alpha, Some(n)))
    }

    /// The share of light from a direction with this cosine that is lost.
    #[inline]
    pub fn at(&self, cos: f64) -> f64 {
        self.0.at(cos).max(0.0)
    }

    /// The share that is lost of light from everywhere; never 0.
    pub fn mean(&self) -> f64 {
        self.0.mean().max(1e-9)
    }
}

/// What a rough coat mirrors, by direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheen {
    place: Place,
    eta: f64,
}

impl Sheen {
    /// Of a coat with facets of width `alpha` and this index of refraction, at least 1.
    pub fn new(alpha: f64, ior: f64) -> Self {
        Self { place: Place::new(COAT, alpha, Some(ior)), eta: 1.0 / ior }
    }

    /// The share that is mirrored of light from a direction with this cosine.
    #[inline]
    pub fn at(&self, cos: f64) -> f64 {
        (fresnel(cos, self.eta) + self.place.at(cos)).clamp(0.0, 1.0)
    }

    /// The share that is mirrored of light from everywhere.
    pub fn mean(&self) -> f64 {
        self.place.mean()
    }
}

#[cfg(test)]
mod tests {
    use dioptric_math::{DVec3, pow};

    use super::super::ggx::{Facets, mirrored};
    use super::*;
    use crate::integrator::optics::refract;

    /// What is mirrored by facets that mirror all, what is mirrored by a dielectric's, and what goes through them,
    /// by quadrature over the facets seen: at the one end there are few, but with much effect.
    fn albedos(alpha: f64, cos: f64, eta: f64, n: u32) -> [f64; 3] {
        let wo = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let facets = Facets::new(alpha, wo);
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let mut sums = [0.0; 3];
        for i in 0..n * n {
            let rest = 1.0 - at(i / n);
            let m = facets.visible_normal(wo, [0.5 * at(i % n), 1.0 - rest * rest]);
            let weight = 2.0 * rest / f64::from(n * n);
            let f = fresnel(wo.dot(m), eta);
            let wi = mirrored(wo, m);
            if let Some(glint) = facets.glint(wo, wi).filter(|glint| glint.f > 0.0) {
                let left = weight * glint.f / glint.visible_pdf;
                sums[0] += left;
                sums[1] += left * f;
            }
            if let Some(wi) = refract(-wo, m, eta).filter(|wi| wi.z < 0.0) {
                sums[2] += weight * (1.0 - f) * facets.shown(wi);
            }
        }
        sums
    }

    /// What belongs into a sheet.
    fn value(sheet: usize, alpha: f64, cos: f64, n: u32) -> f64 {
        let [mirror, back, on] = albedos(alpha, cos, eta(sheet), n);
        match sheet {
            MIRROR => 1.0 - mirror,
            ENTER..COAT => 1.0 - back - on,
            _ => back - fresnel(cos, eta(sheet)),
        }
    }

    /// The index of refraction of a sheet: the viewer's side over the other.
    fn eta(sheet: usize) -> f64 {
        let root = ((sheet + INDICES - 1) % INDICES) as f64 / (INDICES - 1) as f64;
        let r = (LARGEST * root * root).max(1e-4);
        let n = (1.0 + r) / (1.0 - r);
        if (LEAVE..COAT).contains(&sheet) { n } else { 1.0 / n }
    }

    fn width(row: usize) -> f64 {
        pow(row as f64 / (WIDTHS - 1) as f64, 2.0).max(1e-4)
    }

    /// The cosine of a column, by bisection.
    fn cosine(alpha: f64, column: usize) -> f64 {
        let x = column as f64 / (COSINES - 1) as f64;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let mid = 0.5 * (low + high);
            if spread(alpha, mid) < x { low = mid } else { high = mid }
        }
        (0.5_f64 * (low + high)).max(1e-7)
    }

    /// The mean by Simpson's rule over the square root of the cosine: `4 int value(s^2) s^3 ds`. Of coats that of
    /// all that they mirror.
    fn mean(sheet: usize, alpha: f64, n: u32) -> f64 {
        let steps = 64;
        let at = |s: f64| {
            let cos = (s * s).max(1e-7);
            let base = if sheet < COAT { 0.0 } else { fresnel(cos, eta(sheet)) };
            4.0 * s * s * s * (base + value(sheet, alpha, cos, n))
        };
        let weight = |i: i32| if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        let sum: f64 = (0..=steps).map(|i| weight(i) * at(f64::from(i) / f64::from(steps))).sum();
        sum / f64::from(3 * steps)
    }

    fn work_out(sheet: usize, row: usize, column: usize, n: u32) -> f64 {
        let alpha = width(row);
        if column < COSINES {
            value(sheet, alpha, cosine(alpha, column), n)
        } else {
            mean(sheet, alpha, n / 2)
        }
    }

    #[test]
    fn the_table_is_what_quadrature_gives() {
        for i in (0..SHEETS * WIDTHS * ROW).step_by(67) {
            let (sheet, row, column) = (i / (WIDTHS * ROW), i / ROW % WIDTHS, i % ROW);
            let (known, value) = (entry(i), work_out(sheet, row, column, 48));
            assert!((known - value).abs() < 3e-3, "{sheet} {row} {column}: {known} {value}");
        }
    }

    /// Writes the table anew: for whoever changes how it is laid out.
    #[test]
    #[ignore = "writes the table"]
    fn write_the_table() {
        let mut bytes = Vec::new();
        for i in 0..SHEETS * WIDTHS * ROW {
            let value = work_out(i / (WIDTHS * ROW), i / ROW % WIDTHS, i % ROW, 128);
            bytes.extend(((value.clamp(-1.0, 1.0) * 32767.0).round() as i16).to_le_bytes());
        }
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bsdf/loss.bin");
        std::fs::write(path, bytes).unwrap();
    }

    #[test]
    fn between_its_entries_it_is_nearly_right() {
        for alpha in [0.03, 0.1, 0.27, 0.5, 0.83, 1.0] {
            for n in [1.15, 1.33, 1.5, 2.0, 2.6] {
                let (mirror, sheen) = (Loss::of_mirror(alpha), Sheen::new(alpha, n));
                let [enter, leave] = [1.0 / n, n].map(|eta| Loss::of_dielectric(alpha, eta));
                for cos in [0.003, 0.02, 0.1, 0.3, 0.55, 0.8, 0.97, 1.0] {
                    let [all, back, on] = albedos(alpha, cos, 1.0 / n, 40);
                    let [_, inner, out] = albedos(alpha, cos, n, 40);
                    for (what, known, value) in [
                        ("mirror", mirror.at(cos), 1.0 - all),
                        ("enter", enter.at(cos), 1.0 - back - on),
                        ("leave", leave.at(cos), 1.0 - inner - out),
                        ("coat", sheen.at(cos), back),
                    ] {
                        let message = format!("{what} {alpha} {n} {cos}: {known} {value}");
                        assert!((known - value).abs() < 0.011, "{message}");
                    }
                }
            }
        }
    }
}
