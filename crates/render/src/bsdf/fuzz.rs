// SPDX-License-Identifier: MIT OR Apache-2.0
//! Fuzz: fibres that stand up from a surface, as velvet's and a peach's do, and shine where light grazes them.
//!
//! `f = color D / (4 cos cos (1 + Lambda(wo) + Lambda(wi)))` with facets that stand upright,
//! `D = (2 + 1 / alpha) sin^(1 / alpha) / (2 pi)` (Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", SIGGRAPH
//! 2017 course, equations 2 to 4). In place of the softer terminator of their section 4, which is not the same both ways,
//! each way has the factor `1 / (1 + 0.6 (1 - cos)^8)`, so that nothing is sent back that has not come. How much that is
//! altogether is a table, by width and direction, worked out by quadrature: the tests do it again.

use std::f64::consts::PI;

use dioptric_math::{DVec3, Spectrum, exp, normalize, pow, sin_cos};

use super::BsdfSample;

/// Widths in the table, from the least to 1, and cosines.
const WIDTHS: usize = 16;
const COSINES: usize = 24;
/// A row: one width, its cosines, and the mean over all of them.
const ROW: usize = COSINES + 1;
/// Numbers from 0 to 1 in 32767ths, little-endian, rows by increasing width.
static TABLE: &[u8; 2 * WIDTHS * ROW] = include_bytes!("fuzz.bin");
/// The least square root of alpha: what stands more upright sends back more than it gets.
pub(crate) const LEAST: f64 = 0.25;

/// How much fuzz of one width sends back, by direction, if it is white.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FuzzShare {
    row: usize,
    on: f64,
}

impl FuzzShare {
    /// Of any width.
    pub(super) const NONE: Self = Self { row: 0, on: 0.0 };

    /// By the square root of alpha, at least [`LEAST`].
    pub fn new(roughness: f64) -> Self {
        let x = ((roughness - LEAST) / (1.0 - LEAST)).clamp(0.0, 1.0) * (WIDTHS - 1) as f64;
        let row = (x as usize).min(WIDTHS - 2);
        Self { row, on: x - row as f64 }
    }

    /// For light from a direction with this cosine.
    #[inline]
    pub fn at(&self, cos: f64) -> f64 {
        let x = cos.clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f64;
        let column = (x as usize).min(COSINES - 2);
        let near = self.entry(column);
        near + (self.entry(column + 1) - near) * (x - column as f64)
    }

    /// For light from everywhere.
    pub fn mean(&self) -> f64 {
        self.entry(COSINES)
    }

    fn entry(&self, column: usize) -> f64 {
        let near = entry(self.row * ROW + column);
        near + (entry((self.row + 1) * ROW + column) - near) * self.on
    }
}

fn entry(i: usize) -> f64 {
    f64::from(i16::from_le_bytes([TABLE[2 * i], TABLE[2 * i + 1]])) * (1.0 / 32767.0)
}

/// Fuzz.
#[derive(Clone, Copy, Debug)]
pub struct Fuzz {
    color: Spectrum,
    /// `1 / alpha`.
    power: f64,
    /// The five numbers of the fit to Lambda.
    fit: [f64; 5],
    /// Lambda on the viewer's side.
    hidden: f64,
}

/// The fit for alpha 0 and for alpha 1 (table 1).
const FITS: [[f64; 5]; 2] = [
    [25.3245, 3.324_35, 0.168_01, -1.273_93, -4.859_67],
    [21.5473, 3.829_87, 0.198_23, -1.977_60, -4.320_54],
];

impl Fuzz {
    /// By the square root of alpha, at least [`LEAST`].
    pub(super) fn new(color: Spectrum, roughness: f64, wo: DVec3) -> Self {
        let r = roughness.clamp(LEAST, 1.0);
        let near = (1.0 - r * r) * (1.0 - r * r);
        let fit = [0, 1, 2, 3, 4].map(|i| FITS[1][i] + (FITS[0][i] - FITS[1][i]) * near);
        let mut fuzz = Self { color, power: 1.0 / (r * r), fit, hidden: 0.0 };
        fuzz.hidden = fuzz.lambda(wo.z.max(0.0));
        fuzz
    }

    /// How much of the fuzz is hidden from a direction with this cosine (equation 4).
    #[inline]
    fn lambda(&self, cos: f64) -> f64 {
        let [a, b, c, d, e] = self.fit;
        let l = |x: f64| a / (1.0 + b * pow(x, c)) + d * x + e;
        if cos < 0.5 { exp(l(cos)) } else { exp(2.0 * l(0.5) - l(1.0 - cos)) }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let Some(h) = normalize(wo + wi).filter(|_| wi.z > 0.0) else {
            return (Spectrum::ZERO, 0.0);
        };
        let d = (2.0 + self.power) * pow((1.0 - h.z * h.z).max(0.0), 0.5 * self.power);
        let o = wo.z.max(1e-6);
        let shown = soft(o) * soft(wi.z) / (8.0 * PI * o * (1.0 + self.hidden + self.lambda(wi.z)));
        (self.color * (d * shown), 0.5 / PI)
    }

    /// All directions alike: `f |cos|` is bounded.
    #[inline]
    pub(super) fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        let z = 1.0 - u[0];
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (s, c) = sin_cos(2.0 * PI * u[1]);
        let wi = DVec3::new(r * c, r * s, z);
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// Keeps grazing ways from sending back more than comes.
#[inline]
fn soft(cos: f64) -> f64 {
    let m = (1.0 - cos) * (1.0 - cos);
    let m = m * m;
    1.0 / (1.0 + 0.6 * m * m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roughness(row: usize) -> f64 {
        LEAST + (1.0 - LEAST) * row as f64 / (WIDTHS - 1) as f64
    }

    /// By the midpoint rule over directions, finer at grazing ones.
    fn share(roughness: f64, cos: f64, n: u32) -> f64 {
        let wo = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let fuzz = Fuzz::new(Spectrum::ONE, roughness, wo);
        let mut sum = 0.0;
        for i in 0..n {
            let x = (f64::from(i) + 0.5) / f64::from(n);
            let (z, step) = (x * x, 2.0 * x / f64::from(n));
            let r = (1.0 - z * z).sqrt();
            for j in 0..n {
                let (s, c) = sin_cos(PI * (f64::from(j) + 0.5) / f64::from(n));
                let (f, _) = fuzz.eval_pdf(wo, DVec3::new(r * c, r * s, z));
                sum += f.x * step * 2.0 * PI / f64::from(n);
            }
        }
        sum
    }

    fn mean(roughness: f64, n: u32) -> f64 {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        // int 2 mu share dmu with mu = x^2.
        (0..n).map(|i| 4.0 * pow(at(i), 3.0) * share(roughness, at(i) * at(i), n)).sum::<f64>()
            / f64::from(n)
    }

    fn work_out(row: usize, column: usize, n: u32) -> f64 {
        let r = roughness(row);
        if column == COSINES {
            return mean(r, n / 2);
        }
        let x = column as f64 / (COSINES - 1) as f64;
        share(r, (x * x).max(1e-6), n)
    }

    #[test]
    fn the_table_is_what_quadrature_gives_and_nothing_gives_more_than_it_gets() {
        for i in 0..WIDTHS * ROW {
            assert!((0.0..0.999).contains(&entry(i)), "{i}: {}", entry(i));
            if i % 7 == 0 {
                let (known, value) = (entry(i), work_out(i / ROW, i % ROW, 96));
                assert!((known - value).abs() < 4e-3, "{i}: {known} {value}");
            }
        }
        for r in [0.28, 0.44, 0.71, 0.93] {
            for cos in [0.01, 0.07, 0.3, 0.62, 0.94] {
                let (known, value) = (FuzzShare::new(r).at(cos), share(r, cos, 128));
                assert!((known - value).abs() < 0.01, "{r} {cos}: {known} {value}");
            }
        }
    }

    /// Writes the table anew: for whoever changes how it is laid out.
    #[test]
    #[ignore = "writes the table"]
    fn write_the_table() {
        let mut bytes = Vec::new();
        for i in 0..WIDTHS * ROW {
            let value = work_out(i / ROW, i % ROW, 256);
            assert!((0.0..0.999).contains(&value), "{i}: {value}");
            bytes.extend(((value * 32767.0).round() as i16).to_le_bytes());
        }
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bsdf/fuzz.bin");
        std::fs::write(path, bytes).unwrap();
    }
}
