// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces and statistics for the tests of lobes.

use std::f64::consts::PI;

use dioptric_math::random::Random;
use dioptric_math::{DVec3, Spectrum, cbrt, sin_cos};

use super::{Bsdf, BsdfSample, Sides};
use crate::material::{Conductor, Finish, Highlight, HighlightModel, Layers, Optics, Reflectance};

/// A surface and what it promises.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub name: String,
    pub finish: Finish,
    pub sides: Sides,
    /// The largest share of light that it may scatter, if any is promised.
    pub most: Option<f64>,
    /// Whether it scatters all light.
    pub lossless: bool,
    pub reciprocal: bool,
}

impl Case {
    pub fn bsdf(&self, wo: DVec3) -> Bsdf {
        Bsdf::new(&self.finish, &self.sides, wo)
    }

    /// As seen from a direction above it or, turned over, from below.
    pub fn seen_from(&self, w: DVec3) -> Bsdf {
        if w.z > 0.0 {
            return self.bsdf(w);
        }
        let Sides { eta, outside, solid } = self.sides;
        let sides = Sides { eta: 1.0 / eta, outside: outside != solid, solid };
        Bsdf::new(&self.finish, &sides, -w)
    }

    /// Whether radiance changes on its way through.
    pub fn squeezes(&self) -> bool {
        self.sides.solid && self.finish.optics.bends().is_some()
    }
}

/// Directions of a viewer, from straight above to grazing.
pub(super) fn directions() -> [DVec3; 5] {
    [(1.0, 0.0), (0.8, 1.0), (0.4, -2.0), (0.1, 3.0), (0.02, 0.3)].map(|(z, phi): (f64, f64)| {
        let (s, c) = sin_cos(phi);
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * c, r * s, z)
    })
}

const WIDTHS: [f64; 4] = [0.05, 0.2, 0.5, 1.0];
const AIR: Sides = Sides { eta: 1.0, outside: true, solid: true };

/// All kinds of surfaces.
pub(super) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    let mut add = |name: String, finish: Finish, sides: Sides| {
        all.push(Case { name, finish, sides, most: Some(1.0), lossless: false, reciprocal: true });
        all.len() - 1
    };
    let white = Finish::matte(Spectrum::ONE);
    let black = Finish::matte(Spectrum::ZERO);
    let mut lossless = Vec::new();
    let mut recipes = Vec::new();
    let mut tinted = Vec::new();
    lossless.push(add("matte".into(), white, AIR));
    add("grey".into(), Finish::matte(Spectrum::new(0.2, 0.5, 0.8)), AIR);
    let mirror = |alpha: f64, low: f64, high: f64| Finish {
        optics: Optics::Mirror {
            reflect: Reflectance::Curve {
                normal: Spectrum::new(low, 0.7 * low, 0.1 * low),
                grazing: Spectrum::splat(high),
            },
            roughness: alpha,
            covers: false,
        },
        ..black
    };
    let conductor = |alpha: f64, [n, k]: [Spectrum; 2]| {
        let reflect = Reflectance::Metal(Conductor::new(n, k));
        Finish { optics: Optics::Mirror { reflect, roughness: alpha, covers: false }, ..black }
    };
    let gold = [Spectrum::new(0.14, 0.38, 1.4), Spectrum::new(3.9, 2.6, 1.9)];
    // Without a real part all is reflected.
    let perfect = [Spectrum::ZERO, Spectrum::splat(3.0)];
    let plastic = |alpha: f64, color: Spectrum, ior: f64| {
        let root = (ior - 1.0) / (ior + 1.0);
        Finish {
            optics: Optics::Mirror {
                reflect: Reflectance::Curve {
                    normal: Spectrum::splat(root * root),
                    grazing: Spectrum::ONE,
                },
                roughness: alpha,
                covers: true,
            },
            ..Finish::matte(color)
        }
    };
    let glass = |alpha: f64, tint: f64| Finish {
        optics: Optics::Dielectric {
            ior: 1.5,
            reflect: Spectrum::splat(tint),
            transmit: Spectrum::new(1.0, tint, tint * tint),
            absorption: Spectrum::ZERO,
            roughness: alpha,
        },
        ..black
    };
    let into = |eta: f64| Sides { eta, outside: eta < 1.0, solid: true };
    let pane = Sides { eta: 1.0 / 1.5, outside: true, solid: false };
    for alpha in [0.0, WIDTHS[0], WIDTHS[1], WIDTHS[2], WIDTHS[3]] {
        let name = |what: &str| format!("{what} {alpha}");
        if alpha > 0.0 {
            lossless.push(add(name("uneven"), Finish { unevenness: alpha, ..white }, AIR));
        }
        lossless.push(add(name("mirror"), mirror(alpha, 1.0, 1.0), AIR));
        add(name("metal"), mirror(alpha, 0.6, 1.0), AIR);
        add(name("conductor"), conductor(alpha, gold), AIR);
        lossless.push(add(name("no resistance"), conductor(alpha, perfect), AIR));
        lossless.push(add(name("plastic"), plastic(alpha, Spectrum::ONE, 1.5), AIR));
        add(name("blue plastic"), plastic(alpha, Spectrum::new(0.0, 0.2, 0.9), 1.33), AIR);
        for eta in [1.0 / 1.5, 1.0 / 2.4, 1.5, 1.0 / 1.1] {
            lossless.push(add(name(&format!("glass {eta:.2}")), glass(alpha, 1.0), into(eta)));
        }
        lossless.push(add(name("pane"), glass(alpha, 1.0), pane));
        // A tint is met on the way in only.
        tinted.push(add(name("tinted glass"), glass(alpha, 0.3), into(1.0 / 1.5)));
    }
    let layered =
        |base: Spectrum, layers: Layers| Finish { base, optics: Optics::Layered(layers), ..black };
    for alpha in [0.0, WIDTHS[0], WIDTHS[2], WIDTHS[3]] {
        let name = |what: &str| format!("{what} {alpha}");
        let rough = Layers {
            alpha,
            coat_alpha: 0.5 * alpha,
            sheen_roughness: 0.25 + 0.7 * alpha,
            ..Layers::PLAIN
        };
        let (white, gold) = (Spectrum::ONE, Spectrum::new(1.0, 0.7, 0.3));
        let fuzz = Spectrum::new(1.0, 0.5, 0.2);
        // All of these send back what comes.
        let bare = layered(white, rough);
        let coated = layered(white, Layers { coat: 1.0, ..rough });
        let fuzzy = layered(white, Layers { sheen: Spectrum::ONE, specular: 0.0, ..rough });
        lossless.push(add(name("layers: dull"), bare, AIR));
        lossless.push(add(name("layers: fuzz"), fuzzy, AIR));
        lossless.push(add(
            name("layers: metal"),
            layered(white, Layers { metallic: 1.0, ..rough }),
            AIR,
        ));
        let all = Layers { metallic: 0.3, coat: 0.6, sheen: fuzz, ..rough };
        if alpha == 0.0 {
            lossless.push(add(name("layers: coat"), coated, AIR));
        } else {
            add(name("layers: coat"), coated, AIR);
        }
        add(name("layers: all"), layered(gold, all), AIR);
        let some = Layers { transmission: 0.7, ..all };
        tinted.push(add(name("layers: clear"), layered(gold, some), into(1.0 / 1.5)));
        tinted.push(add(name("layers: out of clear"), layered(gold, some), into(1.5)));
        let clear = Layers { transmission: 1.0, ..rough };
        lossless.push(add(name("layers: glass"), layered(white, clear), into(1.0 / 1.5)));
        lossless.push(add(name("layers: out of glass"), layered(white, clear), into(1.5)));
    }
    for model in [HighlightModel::Phong, HighlightModel::Blinn] {
        for exponent in [0.0, 1.0, 30.0, 177.5] {
            let highlight = Highlight { model, color: Spectrum::ONE, exponent, image: false };
            let shiny = Finish { highlight: Some(highlight), ..black };
            recipes.push(add(format!("{model:?} {exponent}"), shiny, AIR));
            let reflect = Reflectance::constant(Spectrum::splat(0.3));
            let optics = Optics::Mirror { reflect, roughness: 0.0, covers: false };
            let lit = Finish { optics, diffuse: Spectrum::splat(0.4), ..shiny };
            recipes.push(add(format!("lit {model:?} {exponent}"), lit, AIR));
            let optics = Optics::Shares {
                own: 0.4,
                ior: 1.2,
                tint: Spectrum::ONE,
                absorption: Spectrum::ZERO,
            };
            recipes.push(add(format!("clear {model:?} {exponent}"), Finish { optics, ..lit }, AIR));
            let inside = Sides { outside: false, ..AIR };
            recipes.push(add(
                format!("in clear {model:?} {exponent}"),
                Finish { optics, ..lit },
                inside,
            ));
        }
    }
    for i in lossless {
        all[i].lossless = true;
    }
    for i in tinted {
        all[i].reciprocal = false;
    }
    for i in recipes {
        all[i].most = None;
        all[i].reciprocal = false;
    }
    all
}

/// Rows and columns of bins: cosines and azimuths.
const BINS: [usize; 2] = [16, 24];

/// A direction by its cosine and azimuth.
fn direction(z: f64, phi: f64) -> DVec3 {
    let (s, c) = sin_cos(phi);
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * c, r * s, z)
}

/// The cosine of a place from 0 (below) to 1 (above), and its derivative; finer at grazing angles and the poles.
fn cosine(x: f64) -> (f64, f64) {
    let y = (2.0 * x - 1.0).abs();
    ((y * y * (3.0 - 2.0 * y)).copysign(2.0 * x - 1.0), 12.0 * y * (1.0 - y))
}

/// The integral over a box of places, split until halves agree.
fn over(f: &dyn Fn(f64, f64) -> f64, low: [f64; 2], high: [f64; 2], least: u32, known: f64) -> f64 {
    let mid = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let boxes = [
        (low, mid),
        ([mid[0], low[1]], [high[0], mid[1]]),
        ([low[0], mid[1]], [mid[0], high[1]]),
        (mid, high),
    ];
    let parts = boxes.map(|(a, b)| gauss(f, a, b));
    let sum: f64 = parts.iter().sum();
    if least == 0 && (sum - known).abs() <= 2e-7 + 1e-5 * sum.abs() || high[0] - low[0] < 1e-6 {
        return sum;
    }
    let least = least.saturating_sub(1);
    boxes.iter().zip(parts).map(|((a, b), part)| over(f, *a, *b, least, part)).sum()
}

/// Gauss and Legendre's rule with three points a side.
fn gauss(f: &dyn Fn(f64, f64) -> f64, low: [f64; 2], high: [f64; 2]) -> f64 {
    const NODES: [(f64, f64); 3] = [
        (0.112_701_665_379_258_3, 5.0 / 18.0),
        (0.5, 8.0 / 18.0),
        (0.887_298_334_620_741_7, 5.0 / 18.0),
    ];
    let size = [high[0] - low[0], high[1] - low[1]];
    let mut sum = 0.0;
    for (x, wx) in NODES {
        for (y, wy) in NODES {
            sum += wx * wy * f(low[0] + x * size[0], low[1] + y * size[1]);
        }
    }
    sum * size[0] * size[1]
}

/// Where bin `i` of `n` begins.
fn edge(i: usize, n: usize) -> f64 {
    i as f64 / n as f64
}

/// What a density says for each bin. Where samples were found it is looked at closely from the start.
fn expected(pdf: impl Fn(DVec3) -> f64, counts: &[f64]) -> Vec<f64> {
    let n: f64 = counts.iter().sum();
    let f = |x: f64, y: f64| {
        let (z, change) = cosine(x);
        pdf(direction(z, 2.0 * PI * y)) * change * 2.0 * PI
    };
    let mut all = Vec::new();
    for row in 0..BINS[0] {
        for column in 0..BINS[1] {
            let low = [edge(row, BINS[0]), edge(column, BINS[1])];
            let high = [edge(row + 1, BINS[0]), edge(column + 1, BINS[1])];
            let least = match counts[all.len()] / n {
                share if share > 0.02 => 4,
                share if share > 1e-3 => 3,
                share if share > 0.0 => 2,
                _ => 0,
            };
            all.push(over(&f, low, high, least, gauss(&f, low, high)));
        }
    }
    all
}

/// How many samples are in each bin; the last one is for those that are lost or sharp.
fn counted(samples: impl Iterator<Item = Option<BsdfSample>>) -> Vec<f64> {
    let mut counts = vec![0.0; BINS[0] * BINS[1] + 1];
    for sample in samples {
        let bin = sample.filter(|s| !s.is_sharp()).map_or(BINS[0] * BINS[1], |s| {
            let row = (1..BINS[0]).filter(|i| s.wi.z >= cosine(edge(*i, BINS[0])).0).count();
            let phi = dioptric_math::atan2(s.wi.y, s.wi.x) / (2.0 * PI);
            let turn = if phi < 0.0 { phi + 1.0 } else { phi };
            row * BINS[1] + ((turn * BINS[1] as f64) as usize).min(BINS[1] - 1)
        });
        counts[bin] += 1.0;
    }
    counts
}

/// What samples say of their density.
pub(super) struct Verdict {
    /// See [`judge`].
    pub deviations: f64,
    /// The integral of the density.
    pub integral: f64,
    /// The share of samples that are neither lost nor sharp.
    pub found: f64,
}

/// Pearson's statistic of samples against their density, in standard deviations of the normal distribution
/// (Wilson and Hilferty, "The Distribution of Chi-Square", 1931). Bins that expect few are pooled. Samples that are
/// lost or sharp do not take part: where densities jump, the integral is not as sure as their number.
pub(super) fn judge(bsdf: &Bsdf, wo: DVec3, n: u32, random: &mut Random) -> Verdict {
    let counts = counted((0..n).map(|_| {
        let (pick, u) = (random.unit(), [random.unit(), random.unit()]);
        bsdf.sample(wo, pick, u)
    }));
    let expect = expected(|w| bsdf.pdf(wo, w), &counts);
    let integral = expect.iter().sum::<f64>();
    let found = 1.0 - counts[expect.len()] / f64::from(n);
    let (mut chi, mut bins, mut pool) = (0.0, 0.0, (0.0, 0.0));
    let mut order: Vec<usize> = (0..expect.len()).collect();
    order.sort_by(|a, b| expect[*a].total_cmp(&expect[*b]));
    for i in order {
        pool = (pool.0 + expect[i] * f64::from(n), pool.1 + counts[i]);
        if pool.0 >= 10.0 {
            chi += (pool.1 - pool.0) * (pool.1 - pool.0) / pool.0;
            bins += 1.0;
            pool = (0.0, 0.0);
        }
    }
    // What is left of the pool is expected (almost) nowhere.
    assert!(pool.1 <= pool.0 + 6.0 * (pool.0 + 1.0).sqrt(), "{pool:?}");
    let k = f64::max(bins, 1.0);
    let v = 2.0 / (9.0 * k);
    Verdict { deviations: (cbrt(chi / k) - (1.0 - v)) / v.sqrt(), integral, found }
}

#[test]
fn densities_are_integrated() {
    let counts = counted(std::iter::once(None));
    let sum = expected(|w| w.z.max(0.0) / PI, &counts).iter().sum::<f64>();
    assert!((sum - 1.0).abs() < 1e-6);
}
