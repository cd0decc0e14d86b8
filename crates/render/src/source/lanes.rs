// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sixteen points that look for light side by side: the same answers as [`Sources::sample`] gives to each.

use dioptric_geometry::world::{Bundle, Sixteen};
use dioptric_math::wide::{Kernel, wide};
use dioptric_math::{DVec3, Spectrum};

use super::ball::Ball;
use super::choice::{Choice, Picks};
use super::emitter::{Emitter, Flat, Glow, Reach};
use super::patch::{Found, Patch};
use super::rectangle::{Look, Rectangle, Spot};
use super::{SourceSample, Sources};
use crate::scene::Scene;

use crate::lanes::LANES;

/// What sixteen points look for, and what they find. Where they are and which way the light is stays with their rays.
#[derive(Clone, Debug)]
pub(crate) struct Looks {
    /// The shading normals on the sides from which light is wanted.
    pub normal: [Sixteen; 3],
    /// Uniform numbers in `[0, 1)`: for which source, and for where on it.
    pub pick: [Sixteen; 2],
    pub u: [Sixteen; 2],
    /// As in [`super::SourceSample`].
    pub value: [Sixteen; 3],
    pub pdf: Sixteen,
    picks: Picks,
    balls: Balls,
}

impl Looks {
    /// Takes over what a point has found by itself; whether it is something.
    fn keep(&mut self, rays: &mut Bundle, lane: usize, sample: Option<SourceSample>) -> bool {
        let Some(sample) = sample else { return false };
        for axis in 0..3 {
            rays.direction[axis][lane] = sample.direction[axis];
            self.value[axis][lane] = sample.value[axis];
        }
        (rays.t_max[lane], self.pdf[lane]) = (sample.distance, sample.pdf);
        true
    }

    pub const EMPTY: Self = Self {
        normal: [[0.0; LANES]; 3],
        pick: [[0.0; LANES]; 2],
        u: [[0.0; LANES]; 2],
        value: [[0.0; LANES]; 3],
        pdf: [0.0; LANES],
        picks: Picks::EMPTY,
        balls: Balls {
            center: [[0.0; LANES]; 3],
            radius: [0.0; LANES],
            radiance: [[0.0; LANES]; 3],
            rounding: [0.0; LANES],
        },
    };
}

/// A rectangle that shines evenly, where a scene has no other source.
#[derive(Clone, Debug)]
pub(super) struct Only {
    rectangle: Rectangle,
    radiance: Spectrum,
    reach: Reach,
    flat: Flat,
    rounding: f64,
}

impl Only {
    pub fn of(choice: &Choice) -> Option<Self> {
        let Some(Emitter::Glow(glow)) = choice.only() else { return None };
        let Patch::Faces(faces) = &glow.patch else { return None };
        let [face] = faces.faces() else { return None };
        let (rectangle, radiance) = (face.rectangle()?, glow.uniform?);
        let (reach, flat, rounding) = (glow.reach, glow.reach.flat()?, glow.rounding);
        Some(Self { rectangle, radiance, reach, flat, rounding })
    }
}

impl Sources {
    /// Looks for light from where rays start, as [`Self::sample`] does for each; sets the directions and lengths of
    /// those that find some, and returns them.
    pub(crate) fn sample_lanes(
        &self,
        scene: &Scene,
        rays: &mut Bundle,
        looks: &mut Looks,
        wanted: u16,
    ) -> u16 {
        if self.choice.is_flat() && self.choice.only().is_none() {
            return self.sample_few(scene, rays, looks, wanted);
        }
        let (mut found, mut left) = (0, wanted);
        if let Some(only) = &self.only {
            let [fit, odd] = wide(LookAtOnly { only, rays, looks, wanted });
            (found, left) = (wanted & fit & !odd, wanted & odd);
        }
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let at = |v: &[Sixteen; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
            let (pick, u) = (looks.pick[0][lane], [looks.u[0][lane], looks.u[1][lane]]);
            let normal = Some(at(&looks.normal));
            let sample = self.sample(scene, at(&rays.origin), normal, pick, u);
            found |= u16::from(looks.keep(rays, lane, sample)) << lane;
        }
        found
    }

    /// The same where each point has to choose among a few sources.
    fn sample_few(&self, scene: &Scene, rays: &mut Bundle, looks: &mut Looks, wanted: u16) -> u16 {
        let picks = &mut looks.picks;
        (picks.point, picks.normal, picks.pick) = (rays.origin, looks.normal, looks.pick[0]);
        self.choice.pick_lanes(picks);
        let (mut found, mut alone, mut balls) = (0, 0, 0);
        for lane in (0..LANES).filter(|lane| wanted & 1 << lane != 0) {
            if !(looks.picks.chance[lane] > 0.0) {
                continue;
            }
            match self.choice.emitter(looks.picks.emitter[lane]) {
                Some(Emitter::Glow(glow)) if looks.balls.take(lane, glow) => balls |= 1 << lane,
                _ => alone |= 1 << lane,
            }
        }
        if balls != 0 {
            let fit = wide(LookAtBalls { rays, looks });
            found = balls & fit;
            alone |= balls & !fit;
        }
        for lane in (0..LANES).filter(|lane| alone & 1 << lane != 0) {
            let at = |v: &[Sixteen; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
            let (emitter, chance) = (looks.picks.emitter[lane], looks.picks.chance[lane]);
            let (normal, u) = (Some(at(&looks.normal)), [looks.u[0][lane], looks.u[1][lane]]);
            let sample = self.sample_of(scene, emitter, chance, at(&rays.origin), normal, u);
            found |= u16::from(looks.keep(rays, lane, sample)) << lane;
        }
        found
    }
}

/// A ball of even light for each of sixteen points.
#[derive(Clone, Debug)]
struct Balls {
    center: [Sixteen; 3],
    radius: Sixteen,
    radiance: [Sixteen; 3],
    rounding: Sixteen,
}

impl Balls {
    /// Puts one into a lane; whether it is one.
    #[inline(always)]
    fn take(&mut self, lane: usize, glow: &Glow) -> bool {
        let (Patch::Ball(ball), Some(radiance)) = (&glow.patch, glow.uniform) else { return false };
        for axis in 0..3 {
            self.center[axis][lane] = ball.center[axis];
            self.radiance[axis][lane] = radiance[axis];
        }
        (self.radius[lane], self.rounding[lane]) = (ball.radius, glow.rounding);
        true
    }
}

/// Which lanes find light of their balls.
struct LookAtBalls<'a> {
    rays: &'a mut Bundle,
    looks: &'a mut Looks,
}

impl Kernel for LookAtBalls<'_> {
    type Output = u16;

    #[inline(always)]
    fn run(self) -> u16 {
        let Self { rays, looks } = self;
        let Looks { u: [u0, u1], value: [vr, vg, vb], pdf, picks, balls, .. } = looks;
        let Balls { center: [cx, cy, cz], radius, radiance: [lr, lg, lb], rounding } = &*balls;
        let ([px, py, pz], [dx, dy, dz]) = (&rays.origin, &mut rays.direction);
        let (length, chance) = (&mut rays.t_max, &picks.chance);
        let mut fit = [0.0; LANES];
        for i in 0..LANES {
            let point = DVec3::new(px[i], py[i], pz[i]);
            let center = DVec3::new(cx[i], cy[i], cz[i]);
            let radiance = Spectrum::new(lr[i], lg[i], lb[i]);
            let ball = Ball { center, radius: radius[i], part: 0 };
            let (look, fits) = ball.look(point, [u0[i], u1[i]]);
            let density = chance[i] * look.density;
            let value = radiance * (1.0 / density);
            let reach = Reach::around(center, radius[i]);
            let Found { direction, distance, normal, .. } = look;
            length[i] = reach.short_of(rounding[i], point, &direction, distance, normal);
            (dx[i], dy[i], dz[i]) = (direction.x, direction.y, direction.z);
            (vr[i], vg[i], vb[i]) = (value.x, value.y, value.z);
            pdf[i] = density;
            let largest = value.x.max(value.y).max(value.z);
            let sound = (largest > 0.0) & (largest < f64::INFINITY) & (distance < f64::INFINITY);
            fit[i] = if fits & sound { 1.0 } else { 0.0 };
        }
        let mut found = 0;
        for (i, flag) in fit.iter().enumerate() {
            found |= u16::from(*flag != 0.0) << i;
        }
        found
    }
}

/// Which lanes find light, and which must look for it alone.
struct LookAtOnly<'a> {
    only: &'a Only,
    rays: &'a mut Bundle,
    looks: &'a mut Looks,
    wanted: u16,
}

impl Kernel for LookAtOnly<'_> {
    type Output = [u16; 2];

    #[inline(always)]
    fn run(self) -> [u16; 2] {
        let Self { only, rays, looks, wanted } = self;
        let Only { rectangle, radiance, reach, flat, rounding } = only.clone();
        let ([px, py, pz], [nx, ny, nz], [u0, u1]) = (&rays.origin, &looks.normal, &looks.u);
        let ([dx, dy, dz], length) = (&mut rays.direction, &mut rays.t_max);
        let ([vx, vy, vz], pdf) = (&mut looks.value, &mut looks.pdf);
        let (mut fit, mut odd) = ([0.0; LANES], [0.0; LANES]);
        let mut near = 0;
        for i in 0..LANES {
            let point = DVec3::new(px[i], py[i], pz[i]);
            near |= u16::from(!rectangle.is_far(point)) << i;
        }
        for i in 0..LANES {
            let point = DVec3::new(px[i], py[i], pz[i]);
            let normal = DVec3::new(nx[i], ny[i], nz[i]);
            let spot = rectangle.spot(point, [u0[i], u1[i]]);
            let value = radiance * (1.0 / spot.density);
            let Spot { direction, distance, .. } = spot;
            let short = reach.short_of(rounding, point, &direction, distance, rectangle.normal);
            (dx[i], dy[i], dz[i]) = (direction.x, direction.y, direction.z);
            (vx[i], vy[i], vz[i]) = (value.x, value.y, value.z);
            (length[i], pdf[i]) = (short, spot.density);
            let seen = reach.reaches(flat, point, normal) & !spot.within;
            fit[i] = if seen & sound(value, spot.density, distance) { 1.0 } else { 0.0 };
        }
        if near & wanted != 0 {
            for i in 0..LANES {
                let point = DVec3::new(px[i], py[i], pz[i]);
                let normal = DVec3::new(nx[i], ny[i], nz[i]);
                let view = rectangle.view(point);
                let look = rectangle.look(&view, [u0[i], u1[i]]);
                let density = 1.0 / view.solid_angle;
                let value = radiance * (1.0 / density);
                let Look { direction, distance, .. } = look;
                let short = reach.short_of(rounding, point, &direction, distance, rectangle.normal);
                let far = rectangle.is_far(point);
                let keep = |old: &mut f64, new: f64| *old = if far { *old } else { new };
                keep(&mut dx[i], direction.x);
                keep(&mut dy[i], direction.y);
                keep(&mut dz[i], direction.z);
                keep(&mut vx[i], value.x);
                keep(&mut vy[i], value.y);
                keep(&mut vz[i], value.z);
                keep(&mut length[i], short);
                keep(&mut pdf[i], density);
                let seen = reach.reaches(flat, point, normal) & !view.within;
                let bent = !far & seen & (view.odd | !look.fits);
                odd[i] = if bent { 1.0 } else { 0.0 };
                keep(&mut fit[i], if seen & sound(value, density, distance) { 1.0 } else { 0.0 });
            }
        }
        let (mut found, mut alone) = (0, 0);
        for i in 0..LANES {
            found |= u16::from(fit[i] != 0.0) << i;
            alone |= u16::from(odd[i] != 0.0) << i;
        }
        [found, alone]
    }
}

/// Whether light was found that is worth something, ahead.
#[inline(always)]
fn sound(value: Spectrum, density: f64, distance: f64) -> bool {
    let largest = value.x.max(value.y).max(value.z);
    let bright = (largest > 0.0) & (largest < f64::INFINITY);
    let dense = (density > 0.0) & (density < f64::INFINITY);
    bright & dense & (distance > 0.0) & (distance < f64::INFINITY)
}
