// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sixteen points that look for light side by side: the same answers as [`Sources::sample`] gives to each.

use dioptric_geometry::world::{Bundle, Sixteen};
use dioptric_math::wide::{Kernel, wide};
use dioptric_math::{DVec3, Spectrum};

use super::Sources;
use super::choice::Choice;
use super::emitter::{Emitter, Flat, Reach};
use super::patch::Patch;
use super::rectangle::Rectangle;
use crate::scene::Scene;

const LANES: usize = Bundle::LANES;

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
}

impl Looks {
    pub const EMPTY: Self = Self {
        normal: [[0.0; LANES]; 3],
        pick: [[0.0; LANES]; 2],
        u: [[0.0; LANES]; 2],
        value: [[0.0; LANES]; 3],
        pdf: [0.0; LANES],
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
        let (mut found, mut left) = (0, wanted);
        if let Some(only) = &self.only {
            let [fit, odd] = wide(Look { only, rays, looks });
            (found, left) = (wanted & fit & !odd, wanted & odd);
        }
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let at = |v: &[Sixteen; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
            let (pick, u) = (looks.pick[0][lane], [looks.u[0][lane], looks.u[1][lane]]);
            let normal = Some(at(&looks.normal));
            let Some(sample) = self.sample(scene, at(&rays.origin), normal, pick, u) else {
                continue;
            };
            found |= 1 << lane;
            for axis in 0..3 {
                rays.direction[axis][lane] = sample.direction[axis];
                looks.value[axis][lane] = sample.value[axis];
            }
            (rays.t_max[lane], looks.pdf[lane]) = (sample.distance, sample.pdf);
        }
        found
    }
}

/// Which lanes find light, and which must look for it alone.
struct Look<'a> {
    only: &'a Only,
    rays: &'a mut Bundle,
    looks: &'a mut Looks,
}

impl Kernel for Look<'_> {
    type Output = [u16; 2];

    #[inline(always)]
    fn run(self) -> [u16; 2] {
        let Self { only, rays, looks } = self;
        let Only { rectangle, radiance, reach, flat, rounding } = only.clone();
        let ([px, py, pz], [nx, ny, nz], [u0, u1]) = (&rays.origin, &looks.normal, &looks.u);
        let ([dx, dy, dz], length) = (&mut rays.direction, &mut rays.t_max);
        let ([vx, vy, vz], pdf) = (&mut looks.value, &mut looks.pdf);
        let (mut fit, mut odd) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let point = DVec3::new(px[i], py[i], pz[i]);
            let normal = DVec3::new(nx[i], ny[i], nz[i]);
            let view = rectangle.view(point);
            let look = rectangle.look(&view, [u0[i], u1[i]]);
            let density = 1.0 / view.solid_angle;
            let value = radiance * (1.0 / density);
            let short =
                reach.short_of(rounding, point, &look.direction, look.distance, rectangle.normal);
            (dx[i], dy[i], dz[i]) = (look.direction.x, look.direction.y, look.direction.z);
            (vx[i], vy[i], vz[i]) = (value.x, value.y, value.z);
            (length[i], pdf[i]) = (short, density);
            let seen = reach.reaches(flat, point, normal) & !view.within;
            odd[i] = if seen & (view.odd | !look.fits) { 1.0 } else { 0.0 };
            let largest = value.x.max(value.y).max(value.z);
            let sound = (largest > 0.0) & (largest < f64::INFINITY) & (density > 0.0);
            let ahead = (look.distance > 0.0) & (look.distance < f64::INFINITY);
            fit[i] = if seen & sound & ahead { 1.0 } else { 0.0 };
        }
        let (mut found, mut alone) = (0, 0);
        for i in 0..LANES {
            found |= u16::from(fit[i] != 0.0) << i;
            alone |= u16::from(odd[i] != 0.0) << i;
        }
        [found, alone]
    }
}
