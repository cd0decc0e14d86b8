// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a pixel's samples brought by paths of light, added up by where the light came from and how it travelled.

use serde::Serialize;

use super::Sample;

/// Samples that are told in full.
const BRIGHTEST: usize = 3;

/// The samples of a pixel together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Paths {
    /// The light by source and path class, the strongest first. Their values add up to the pixel's linear value.
    pub groups: Vec<Group>,
    /// The standard error of the pixel's linear value: how far the mean of so many samples is from the truth, about.
    pub standard_error: [f64; 3],
    /// The samples that add the most, the strongest first, counted from 0.
    pub brightest: Vec<usize>,
}

/// All light that came from one source by one class of paths.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// The class in Heckbert's notation: `LDSE` was scattered first, then mirrored or let through to the eye.
    pub class: String,
    /// Where it came from.
    pub light: Option<String>,
    /// What it adds to the pixel.
    pub value: [f64; 3],
    /// The standard error of that.
    pub standard_error: [f64; 3],
    /// How many samples found such light.
    pub samples: usize,
}

/// Weighted sums of a quantity over samples, of which those not told brought nothing.
#[derive(Default)]
struct Sums {
    /// Sum of weight times value.
    mean: [f64; 3],
    /// Sum of (weight times value) squared, and of weight squared times value.
    squares: [f64; 3],
    crossed: [f64; 3],
    samples: usize,
}

impl Sums {
    fn add(&mut self, weight: f64, value: [f64; 3]) {
        self.samples += 1;
        for (lane, x) in value.iter().enumerate() {
            let x = weight * x;
            self.mean[lane] += x;
            self.squares[lane] += x * x;
            self.crossed[lane] += weight * x;
        }
    }

    /// The standard error of the weighted mean: the root of `n / (n - 1) sum w^2 (x - mean)^2`; 0 of a single sample.
    fn error(&self, weights: &[f64]) -> [f64; 3] {
        let n = weights.len() as f64;
        if weights.len() < 2 {
            return [0.0; 3];
        }
        let all: f64 = weights.iter().map(|w| w * w).sum();
        [0, 1, 2].map(|lane| {
            let mean = self.mean[lane];
            let sum = self.squares[lane] - 2.0 * mean * self.crossed[lane] + mean * mean * all;
            (n / (n - 1.0) * sum.max(0.0)).sqrt()
        })
    }
}

/// Adds up the samples.
pub(super) fn add_up(samples: &[Sample]) -> Paths {
    let weights: Vec<f64> = samples.iter().map(|s| s.weight).collect();
    let mut whole = Sums::default();
    let mut groups: Vec<(String, Option<String>, Sums)> = Vec::new();
    for sample in samples {
        let Some(ray) = &sample.ray else { continue };
        whole.add(sample.weight, ray.value);
        // A sample may find light of one group more than once.
        let mut own: Vec<(usize, [f64; 3])> = Vec::new();
        for term in ray.terms.iter().filter(|term| term.value != [0.0; 3]) {
            let class = term.detail.get("class").and_then(|c| c.as_str()).unwrap_or_default();
            let light = match term.name {
                // The sky has one name whether a path met it or asked for it.
                "background" | "fog" => Some(term.name.to_owned()),
                _ => term.light.clone(),
            };
            let known = groups.iter().position(|(c, l, _)| c == class && *l == light);
            let group = known.unwrap_or_else(|| {
                groups.push((class.to_owned(), light, Sums::default()));
                groups.len() - 1
            });
            match own.iter_mut().find(|(g, _)| *g == group) {
                Some((_, sum)) => {
                    sum.iter_mut().zip(term.value).for_each(|(sum, x)| *sum += x);
                }
                None => own.push((group, term.value)),
            }
        }
        for (group, value) in own {
            groups[group].2.add(sample.weight, value);
        }
    }
    let mut groups: Vec<Group> = groups
        .into_iter()
        .map(|(class, light, sums)| Group {
            class,
            light,
            value: sums.mean,
            standard_error: sums.error(&weights),
            samples: sums.samples,
        })
        .collect();
    let strength = |value: &[f64; 3]| value.iter().map(|x| x.abs()).sum::<f64>();
    groups.sort_by(|a, b| strength(&b.value).total_cmp(&strength(&a.value)));
    let mut brightest: Vec<usize> = (0..samples.len()).collect();
    let share = |i: usize| {
        samples[i].ray.as_ref().map_or(0.0, |ray| samples[i].weight.abs() * strength(&ray.value))
    };
    brightest.sort_by(|&a, &b| share(b).total_cmp(&share(a)));
    brightest.truncate(BRIGHTEST);
    Paths { groups, standard_error: whole.error(&weights), brightest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::recorder::{Node, RayKind, Term};
    use serde_json::{Map, json};

    fn sample(weight: f64, terms: &[(&str, &str, f64)]) -> Sample {
        let terms: Vec<Term> = terms
            .iter()
            .map(|&(class, light, x)| Term {
                name: "light",
                light: Some(light.into()),
                value: [x, 0.0, 2.0 * x],
                detail: Map::from_iter([("class".into(), json!(class))]),
            })
            .collect();
        let value = terms.iter().fold([0.0; 3], |sum, t| [0, 1, 2].map(|i| sum[i] + t.value[i]));
        let node = Node {
            kind: RayKind::Camera,
            origin: [0.0; 3],
            direction: [0.0; 3],
            object: None,
            source: None,
            t: None,
            detail: Map::new(),
            terms,
            children: Vec::new(),
            value,
        };
        Sample { weight, position: [0.5; 2], ray: Some(node) }
    }

    #[test]
    fn light_is_grouped_and_its_error_is_that_of_a_mean() {
        let samples = [
            sample(0.25, &[("LDE", "lamp", 1.0), ("LDDE", "lamp", 0.5), ("LDDE", "lamp", 0.5)]),
            sample(0.25, &[("LDE", "lamp", 3.0)]),
            sample(0.25, &[]),
            sample(0.25, &[("LSE", "sky", 8.0)]),
        ];
        let paths = add_up(&samples);
        let named: Vec<_> =
            paths.groups.iter().map(|g| (&*g.class, g.value[0], g.samples)).collect();
        assert_eq!(named, [("LSE", 2.0, 1), ("LDE", 1.0, 2), ("LDDE", 0.25, 1)]);
        // 1, 3, 0, 0: mean 1, variance (0 + 4 + 1 + 1) / 3 = 2, of the mean of four 0.5.
        assert!((paths.groups[1].standard_error[0] - 0.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(paths.groups[1].standard_error[1], 0.0);
        // 2, 3, 0, 8: mean 3.25, variance 34.75 / 3.
        assert!((paths.standard_error[0] - (34.75_f64 / 12.0).sqrt()).abs() < 1e-12);
        assert_eq!(paths.brightest, [3, 1, 0]);
    }

    #[test]
    fn one_sample_says_nothing_of_its_error() {
        assert_eq!(add_up(&[sample(1.0, &[("LE", "lamp", 5.0)])]).standard_error, [0.0; 3]);
        assert!(add_up(&[]).groups.is_empty());
    }
}
