// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights without a size, asked by sixteen points at once.

use dioptric_geometry::world::{Bundle, Sixteen};
use dioptric_math::wide::Kernel;
use dioptric_math::{DVec3, Spectrum};

use super::shared::Falloff;

/// A light without a size that shines alike in all directions.
#[derive(Clone, Copy, Debug)]
pub enum Sharp {
    /// A point.
    Point {
        /// Where it is.
        center: DVec3,
        /// How it weakens.
        falloff: Falloff,
        /// Its colour times its intensity.
        strength: Spectrum,
    },
    /// From one direction everywhere.
    Parallel {
        /// Unit vector towards the light.
        towards: DVec3,
        /// What arrives.
        arriving: Spectrum,
    },
}

/// Nearer and further points are asked one by one, since squares of these distances may be out of range.
const DISTANCES: (f64, f64) = (1e-99, 1e99);

/// Sends rays from sixteen points towards a light, the same bits as [`super::Light::sample`] gives for each; true if
/// any of the points must be asked alone.
pub(crate) struct Towards<'a> {
    pub light: Sharp,
    /// From `origin` to `direction` and `t_max`.
    pub rays: &'a mut Bundle,
    /// What arrives.
    pub arriving: &'a mut [Sixteen; 3],
}

impl Kernel for Towards<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let Bundle { origin, direction, t_max, .. } = self.rays;
        let ([x, y, z], [dx, dy, dz]) = (origin, direction);
        match self.light {
            Sharp::Point { center, falloff, strength } => {
                for i in 0..Bundle::LANES {
                    let (wx, wy, wz) = (center.x - x[i], center.y - y[i], center.z - z[i]);
                    let d = (wx * wx + wy * wy + wz * wz).sqrt();
                    t_max[i] = d;
                    dx[i] = wx / d;
                    dy[i] = wy / d;
                    dz[i] = wz / d;
                }
                let mut weight = [1.0; Bundle::LANES];
                if let Falloff::Square { .. } = falloff {
                    for i in 0..Bundle::LANES {
                        weight[i] = falloff.at(t_max[i]);
                    }
                }
                for (arriving, strength) in self.arriving.iter_mut().zip(strength.to_array()) {
                    for i in 0..Bundle::LANES {
                        arriving[i] = strength * weight[i];
                    }
                }
                let mut odd = false;
                for d in t_max {
                    odd |= !(*d >= DISTANCES.0) | !(*d <= DISTANCES.1);
                }
                odd
            }
            Sharp::Parallel { towards, arriving } => {
                let all = [(dx, towards.x), (dy, towards.y), (dz, towards.z)];
                for (lanes, value) in all {
                    *lanes = [value; Bundle::LANES];
                }
                *t_max = [f64::INFINITY; Bundle::LANES];
                for (lanes, value) in self.arriving.iter_mut().zip(arriving.to_array()) {
                    *lanes = [value; Bundle::LANES];
                }
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::testing::build;
    use crate::light::{Light, directional, point};
    use crate::setting::testing::scaled_root;
    use dioptric_math::random::Random;
    use dioptric_math::wide::wide;
    use dioptric_scene::Value;

    /// Compares sixteen at once with one by one.
    fn compare(light: &impl Light, points: [DVec3; 16]) {
        let Some(sharp) = light.sharp() else { panic!("it has no size") };
        let mut rays = Bundle::EMPTY;
        for (i, point) in points.iter().enumerate() {
            for (axis, x) in point.to_array().into_iter().enumerate() {
                rays.origin[axis][i] = x;
            }
        }
        let mut arriving = [[0.0; 16]; 3];
        let odd = wide(Towards { light: sharp, rays: &mut rays, arriving: &mut arriving });
        let same = points.iter().enumerate().all(|(i, point)| {
            light.sample(*point, [0.5; 2]).is_some_and(|s| {
                let lane = |v: &[Sixteen; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
                let bits = |v: DVec3| v.to_array().map(f64::to_bits);
                bits(s.direction) == bits(lane(&rays.direction))
                    && s.distance.to_bits() == rays.t_max[i].to_bits()
                    && bits(s.arriving) == bits(lane(&arriving))
            })
        });
        assert!(same || odd, "{points:?}");
        let far = points.iter().all(|p| p.length() < 1e-120);
        assert!(!odd || far, "{points:?}");
    }

    #[test]
    fn they_shine_as_one_by_one() {
        let mut random = Random::new(3);
        let text = |word: &str| Value::Text(word.into());
        for scale in [1e-3, 1.0, 1e3] {
            let root = scaled_root(scale);
            for falloff in ["none", "square"] {
                let arguments = [
                    ("position", Value::Vec3([0.0; 3])),
                    ("intensity", Value::Number(0.7)),
                    ("falloff", text(falloff)),
                ];
                let lamp = build::<point::Point>(&arguments, &root).unwrap();
                for size in [1.0, 1e5, 1e-150] {
                    let mut next = || random.uniform(-size, size);
                    compare(&lamp, [(); 16].map(|()| DVec3::new(next(), next(), next())));
                }
            }
            let sun = [("direction", Value::Vec3([1.0, -2.0, 0.3]))];
            let sun = build::<directional::Directional>(&sun, &root).unwrap();
            compare(&sun, [DVec3::ONE; 16]);
        }
    }

    #[test]
    fn what_has_a_size_is_not_sharp() {
        let ball = [("position", Value::Vec3([0.0; 3])), ("radius", Value::Number(1.0))];
        let ball = build::<point::Point>(&ball, &scaled_root(1.0)).unwrap();
        assert!(ball.sharp().is_none());
    }
}
