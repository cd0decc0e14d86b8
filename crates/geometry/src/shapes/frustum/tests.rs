// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the early test turns away, the whole one would have, too.

use dioptric_math::pow;
use dioptric_math::random::Random;

use super::*;

fn direction(r: &mut Random) -> DVec3 {
    let mut one = || r.uniform(-1.0, 1.0);
    normalize(DVec3::new(one(), one(), one())).unwrap_or(DVec3::X)
}

/// A line that touches a frustum, or passes it at a small or large distance, at any angle to the axis.
fn line(f: &Frustum, r: &mut Random) -> (DVec3, DVec3) {
    let size = f.height.max(f.radius).max(f.top_radius);
    let mut power = |low, high| pow(10.0, r.uniform(low, high));
    let (tiny, tilt, reach) = (power(-17.0, 0.0), power(-12.0, 0.0), power(-3.0, 6.0));
    let outward = normalize(direction(r).cross(f.axis)).unwrap_or(DVec3::X);
    let y = f.height * [0.0, 1.0, r.unit()][(r.bits() % 3) as usize];
    let rho = [f.radius, f.top_radius, f.radius.max(f.top_radius)][(r.bits() % 3) as usize];
    let sign = if r.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
    let touched = f.base + f.axis * y + outward * (rho + sign * tiny * size);
    let around = f.axis.cross(outward);
    let along = match r.bits() % 3 {
        0 => f.axis + around * tilt,
        1 => around + f.axis * tilt,
        _ => around + f.axis * r.uniform(-2.0, 2.0) + outward * (sign * tiny),
    };
    (touched - along * (size * reach * sign), along * [1.0, 1e-150, 1e150][(r.bits() % 3) as usize])
}

#[test]
fn what_passes_clearly_hits_nothing() {
    let mut r = Random::new(81);
    let (mut clear, mut met, mut rays) = (0, 0, 0);
    for _ in 0..1500 {
        let scale = [1e-6, 1.0, 1e6][(r.bits() % 3) as usize];
        let base = direction(&mut r) * (scale * [0.0, 1.0, 1e5][(r.bits() % 3) as usize]);
        let length = direction(&mut r) * (scale * pow(10.0, r.uniform(-3.0, 3.0)));
        let radius = scale * r.unit();
        let top = [radius, 0.0, scale * r.unit()][(r.bits() % 3) as usize];
        let Some(f) = Frustum::new(base, length, radius, top, true) else { continue };
        for _ in 0..300 {
            let (origin, direction) = line(&f, &mut r);
            let ray =
                LocalRay { origin, direction, error: 0.0, t_max: f64::INFINITY, leaving: None };
            let offset = ray.origin - f.base;
            let (y, dy) = (offset.dot(f.axis), ray.direction.dot(f.axis));
            let whole = f.line_along(&ray, offset, y, dy);
            let passes = f.passes_clearly(offset, direction, dy);
            assert!(!passes || whole.is_none(), "{f:?} {ray:?}");
            rays += 1;
            clear += usize::from(passes);
            met += usize::from(whole.is_some());
        }
    }
    println!("of {rays} lines {met} meet and {clear} clearly pass");
    assert!(rays > 400_000 && met * 10 > rays && clear * 20 > rays, "{rays} {met} {clear}");
}
