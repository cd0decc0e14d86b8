// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where rays arrive, sixteen at a time: points and normals of rectangles and balls whose materials are the same
//! everywhere. Which of them a ray has met is only known when it has been cast, so whoever asked shapes and materials one
//! after the other would have to guess all the time; here their numbers are copied into lanes, and worked with there.

use dioptric_geometry::world::{Bundle, Sixteen};
use dioptric_geometry::{HitId, Plain};
use dioptric_math::wide::Kernel;
use dioptric_math::{DVec3, Spectrum};

use crate::bsdf::is_smooth;
use crate::lanes::{LANES, Vectors, bits};
use crate::material::{Interior, Optics, Reflectance};
use crate::scene::{Scene, SceneMaterial};

/// Scenes with more objects than this spend their time elsewhere.
const MOST: usize = 4096;

/// The plain objects of a scene, by their numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plains(Vec<Option<Box<Record>>>);

/// A rectangle or a ball whose material is the same everywhere.
#[derive(Clone, Debug)]
pub(super) struct Record {
    /// What [`Plain`] has, in the order of its fields, but for the error.
    numbers: [f64; NUMBERS],
    pub error: f64,
    /// For layers.
    pub base: Spectrum,
    pub skin: Skin,
}

/// A material.
#[derive(Clone, Debug)]
pub(super) enum Skin {
    /// Matte, with this diffuse colour.
    Matte(Spectrum),
    /// A sharp mirror: what it reflects at right and at grazing angles.
    Mirror { normal: Spectrum, grazing: Spectrum },
    /// Smooth glass.
    Glass { ior: f64, reflect: Spectrum, transmit: Spectrum, absorption: Spectrum, priority: i32 },
}

impl Skin {
    fn of(scene: &Scene, material: &SceneMaterial, solid: bool) -> Option<Self> {
        let finish = material.uniform.as_ref()?;
        if material.matte {
            return Some(Self::Matte(finish.diffuse));
        }
        let glossy = finish.highlight.is_some_and(|h| !h.image);
        let bare = finish.emission == Spectrum::ZERO && !glossy && finish.present;
        if material.holes || material.by_lot || !bare || scene.insides.overlap {
            return None;
        }
        let dull = finish.diffuse.max_element() > 0.0;
        match finish.optics {
            Optics::Mirror {
                reflect: Reflectance::Curve { normal, grazing },
                roughness,
                covers,
            } if !dull && !covers && is_smooth(roughness) => Some(Self::Mirror { normal, grazing }),
            Optics::Dielectric { ior, reflect, transmit, absorption, roughness }
                if solid && is_smooth(roughness) && material.interior == Interior::PLAIN =>
            {
                let priority = material.interior.priority;
                Some(Self::Glass { ior, reflect, transmit, absorption, priority })
            }
            _ => None,
        }
    }
}

const NUMBERS: usize = 19;

impl Plains {
    /// Those of a scene.
    pub fn of(scene: &Scene) -> Self {
        let count = scene.world.object_count();
        Self((0..count.min(MOST) as u32).map(|object| Record::of(scene, object)).collect())
    }

    /// An object's record, if it has one.
    #[inline(always)]
    pub(super) fn get(&self, id: &HitId) -> Option<&Record> {
        if id.instance == HitId::NO_INSTANCE {
            self.0.get(id.object as usize)?.as_deref()
        } else {
            None
        }
    }
}

impl Record {
    fn of(scene: &Scene, object: u32) -> Option<Box<Self>> {
        let Plain { base, edges, duals, normal, radius, error } = scene.world.plain(object)?;
        let info = scene.objects.get(object as usize).filter(|info| !info.combined)?;
        let material = scene.materials.get(info.material as usize)?;
        let (finish, skin) = (material.uniform.as_ref()?, Skin::of(scene, material, radius > 0.0)?);
        let mut numbers = [0.0; NUMBERS];
        let vectors = [base, edges[0], edges[1], duals[0], duals[1], normal];
        for (to, v) in numbers.chunks_exact_mut(3).zip(vectors) {
            to.copy_from_slice(&v.to_array());
        }
        numbers[18] = radius;
        Some(Box::new(Self { numbers, error, base: finish.base, skin }))
    }
}

/// Sixteen rays that have arrived.
#[derive(Clone, Debug)]
pub(super) struct Arrivals {
    /// What was met.
    plain: [Sixteen; NUMBERS],
    /// The rays' ends, their directions, lengths, and the errors of their origins.
    end: Vectors,
    way: Vectors,
    pub length: Sixteen,
    error: Sixteen,
    /// Not 0 in lanes that hold such a ray.
    new: Sixteen,
}

/// What has come of it, a bit for each lane.
pub(super) struct Arrived {
    /// Lanes that held a ray.
    pub new: u16,
    /// Which came from the side of the normal.
    pub outside: u16,
    /// Which began where they ended, within rounding.
    pub touching: u16,
    /// For which the point is not known.
    pub odd: u16,
}

impl Arrivals {
    pub const EMPTY: Self = Self {
        plain: [[0.0; LANES]; NUMBERS],
        end: [[0.0; LANES]; 3],
        way: [[0.0; LANES]; 3],
        length: [0.0; LANES],
        error: [0.0; LANES],
        new: [0.0; LANES],
    };

    /// Puts a ray into a lane that has met what is recorded.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, bundle: &Bundle, from: usize, t: f64, record: &Record) {
        let (lane, from) = (lane % LANES, from % LANES);
        for (column, number) in self.plain.iter_mut().zip(&record.numbers) {
            column[lane] = *number;
        }
        for axis in 0..3 {
            let way = bundle.direction[axis][from];
            self.way[axis][lane] = way;
            self.end[axis][lane] = bundle.origin[axis][from] + way * t;
        }
        (self.length[lane], self.error[lane], self.new[lane]) = (t, bundle.error[from], 1.0);
    }

    /// The directions of the rays.
    #[inline(always)]
    pub const fn way(&self) -> &Vectors {
        &self.way
    }

    /// Leaves a lane to others.
    #[inline(always)]
    pub fn skip(&mut self, lane: usize) {
        self.new[lane % LANES] = 0.0;
    }
}

/// Finds the points where rays have arrived; lanes without a ray stay as they are.
pub(super) struct Arrive<'a> {
    pub arrivals: &'a Arrivals,
    pub point: &'a mut Vectors,
    /// Bounds on the errors of the points.
    pub bound: &'a Sixteen,
    /// The normals on the side from which each ray came: these surfaces have no others.
    pub normal: &'a mut Vectors,
    pub geometric: &'a mut Vectors,
}

impl Kernel for Arrive<'_> {
    type Output = Arrived;

    #[inline(always)]
    fn run(self) -> Arrived {
        let Self { arrivals, point: [px, py, pz], bound, normal, geometric } = self;
        let Arrivals { plain, end: [ex, ey, ez], way: [wx, wy, wz], length, error, new, .. } =
            arrivals;
        let [bx, by, bz, ux, uy, uz, vx, vy, vz, ax, ay, az, cx, cy, cz, mx, my, mz, radius] =
            plain;
        let ([nx, ny, nz], [gx, gy, gz]) = (normal, geometric);
        let (mut outside, mut touching, mut odd) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let surface = Plain {
                base: DVec3::new(bx[i], by[i], bz[i]),
                edges: [DVec3::new(ux[i], uy[i], uz[i]), DVec3::new(vx[i], vy[i], vz[i])],
                duals: [DVec3::new(ax[i], ay[i], az[i]), DVec3::new(cx[i], cy[i], cz[i])],
                normal: DVec3::new(mx[i], my[i], mz[i]),
                radius: radius[i],
                error: bound[i],
            };
            let (point, normal, fits) = surface.nearest(DVec3::new(ex[i], ey[i], ez[i]));
            let rising = DVec3::new(wx[i], wy[i], wz[i]).dot(normal);
            let out = rising <= 0.0;
            let near = length[i] * rising.abs() <= bound[i] + error[i];
            let held = new[i] != 0.0;
            outside[i] = if out { 1.0 } else { 0.0 };
            touching[i] = if near { 1.0 } else { 0.0 };
            odd[i] = if fits { 0.0 } else { 1.0 };
            let side = |n: f64| if out { n } else { -n };
            let keep = |new: f64, old: &mut f64| *old = if held { new } else { *old };
            keep(point.x, &mut px[i]);
            keep(point.y, &mut py[i]);
            keep(point.z, &mut pz[i]);
            keep(side(normal.x), &mut nx[i]);
            keep(side(normal.y), &mut ny[i]);
            keep(side(normal.z), &mut nz[i]);
            keep(side(normal.x), &mut gx[i]);
            keep(side(normal.y), &mut gy[i]);
            keep(side(normal.z), &mut gz[i]);
        }
        let new = bits(new);
        Arrived {
            new,
            outside: bits(&outside) & new,
            touching: bits(&touching) & new,
            odd: bits(&odd) & new,
        }
    }
}
