// SPDX-License-Identifier: MIT OR Apache-2.0
//! Points that sixteen rays met, component by component: from what shapes say of them to what light and further rays
//! need.
//!
//! The numbers are those of [`Point`], one by one; it is made of them where a point is asked for by itself.

use dioptric_geometry::world::{Bundle, Found, Hit, Leave, Sixteen, Surfaces};
use dioptric_geometry::{Departure, SurfacePoint};
use dioptric_math::DVec3;
use dioptric_math::wide::{Kernel, wide};

use super::lit::{Block, dot, lanes};
use super::optics::facing;
use super::point::Point;
use crate::lanes::{LANES, Vectors, ZERO, get, put};
use crate::scene::Answer;

/// What sixteen rays met, beside what light wants to know of it ([`Block`]).
#[derive(Clone, Debug)]
pub(super) struct Front {
    /// The rays that met something.
    pub met: u16,
    /// Those that came from the side of the geometric normal.
    pub outside: u16,
    /// Those that go no further.
    pub ends: u16,
    /// Those that are mirrored at [`Block::normal`], and nothing else, to [`Self::mirrored`].
    pub mirrors: u16,
    /// Those whose [`Self::facet`] is not the surface's normal.
    pub rough: u16,
    /// Whose own colour is wanted.
    pub own: u16,
    /// Both normals as the shapes have them.
    normal: Vectors,
    shading: Vectors,
    /// The normals of the facets that mirrored rays meet.
    pub facet: Vectors,
    pub mirrored: Vectors,
}

impl Front {
    pub const EMPTY: Self = Self {
        met: 0,
        outside: 0,
        ends: 0,
        mirrors: 0,
        rough: 0,
        own: 0,
        normal: ZERO,
        shading: ZERO,
        facet: ZERO,
        mirrored: ZERO,
    };

    /// Nothing was met yet.
    pub const fn clear(&mut self) {
        (self.met, self.ends, self.mirrors, self.rough, self.own) = (0, 0, 0, 0, 0);
    }

    /// Puts a surface into a lane; its point goes to `starts`, where further rays begin.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, surface: &SurfacePoint, starts: &mut Bundle) {
        put(&mut self.normal, lane, surface.normal);
        put(&mut self.shading, lane, surface.shading_normal);
        put(&mut starts.origin, lane, surface.point);
        starts.error[lane % LANES] = surface.error;
        self.met |= 1 << lane;
    }

    /// Takes over all surfaces of some lanes. (What it puts into others comes before what is set there.)
    #[inline(always)]
    pub fn take(&mut self, known: u16, surfaces: &Surfaces, starts: &mut Bundle) {
        if known != 0 {
            self.normal = surfaces.normal;
            self.shading = surfaces.shading;
            starts.origin = surfaces.point;
            starts.error = surfaces.error;
            self.met |= known;
        }
    }

    /// Turns the normals towards the rays, and says what further rays leave.
    #[inline(always)]
    pub fn turn(&mut self, rays: &Bundle, found: &Found, starts: &mut Bundle, block: &mut Block) {
        let Turned { outside, bent, touching } =
            wide(Turn { rays, t: &found.t, front: self, block, starts });
        self.outside = outside;
        for lane in lanes(bent & self.met) {
            let direction = rays.ray(lane).direction;
            let normal = facing(direction, get(&self.normal, lane), get(&self.shading, lane));
            block.turn(lane, normal);
        }
        for lane in lanes(self.met) {
            let outward = outside & 1 << lane != 0;
            starts.leave_back(lane, &found.ids[lane], outward);
        }
        for lane in lanes(self.met & touching) {
            if let Some(Departure { from, .. }) = rays.leaves[lane].departure() {
                let outward = outside & 1 << lane != 0;
                starts.leaves[lane] = Leave::back(found.ids[lane], outward, Some(from));
            }
        }
    }

    /// Works out where the rays go that are mirrored. Those that need more care than that are taken out of them.
    #[inline(always)]
    pub fn mirror(&mut self, rays: &Bundle, block: &Block) {
        if self.mirrors != 0 {
            self.mirrors &= wide(Mirror { rays, block, out: &mut self.mirrored });
        }
    }

    /// A point by itself.
    pub fn point<'a>(
        &self,
        lane: usize,
        (rays, found): (&Bundle, &Found),
        (starts, block): (&Bundle, &Block),
        finish: Answer<'a>,
    ) -> Point<'a> {
        let lane = lane % LANES;
        Point {
            ray: rays.ray(lane),
            hit: Hit { t: found.t[lane], id: found.ids[lane] },
            surface: SurfacePoint {
                point: get(&starts.origin, lane),
                error: starts.error[lane],
                normal: get(&self.normal, lane),
                shading_normal: get(&self.shading, lane),
            },
            finish,
            normal: block.normal(lane),
            outside: self.outside & 1 << lane != 0,
            arrived: starts.leaves[lane].contacts().except,
        }
    }

    /// The normal of the facet that a mirrored ray meets.
    pub fn facet(&self, lane: usize, block: &Block) -> DVec3 {
        let own = self.rough & 1 << lane != 0;
        if own { get(&self.facet, lane) } else { block.normal(lane) }
    }
}

/// A bit for each of sixteen points.
struct Turned {
    /// Its ray comes from the side of the geometric normal.
    outside: u16,
    /// Its shading normal would be seen from behind.
    bent: u16,
    /// It is where its ray begins, within the error bounds.
    touching: u16,
}

/// Turns normals towards rays.
struct Turn<'a> {
    rays: &'a Bundle,
    t: &'a Sixteen,
    front: &'a Front,
    block: &'a mut Block,
    starts: &'a mut Bundle,
}

impl Kernel for Turn<'_> {
    type Output = Turned;

    #[inline(always)]
    fn run(self) -> Turned {
        let Self { rays, t, front, block, starts } = self;
        let mut side = [0.0; LANES];
        dot(&rays.direction, &front.normal, &mut side);
        let Block { normal, geometric, viewer, facing, .. } = block;
        for axis in 0..3 {
            let (n, s, d) = (&front.normal[axis], &front.shading[axis], &rays.direction[axis]);
            let (normal, geometric) = (&mut normal[axis], &mut geometric[axis]);
            for i in 0..LANES {
                geometric[i] = if side[i] <= 0.0 { n[i] } else { -n[i] };
                normal[i] = if side[i] > 0.0 { -s[i] } else { s[i] };
                viewer[axis][i] = -d[i];
            }
        }
        let mut away = [0.0; LANES];
        dot(&rays.direction, normal, &mut away);
        dot(normal, viewer, facing);
        starts.time = rays.time;
        let mut turned = Turned { outside: 0, bent: 0, touching: 0 };
        for i in 0..LANES {
            let touches = t[i] * side[i].abs() <= starts.error[i] + rays.error[i];
            turned.outside |= u16::from(side[i] <= 0.0) << i;
            turned.bent |= u16::from(away[i] > 0.0) << i;
            turned.touching |= u16::from(touches) << i;
        }
        turned
    }
}

/// Mirrors rays; a bit for each for which that is all that it takes: see [`super::point::mirrored`].
struct Mirror<'a> {
    rays: &'a Bundle,
    block: &'a Block,
    out: &'a mut Vectors,
}

impl Kernel for Mirror<'_> {
    type Output = u16;

    #[inline(always)]
    fn run(self) -> u16 {
        let Self { rays, block, out } = self;
        let (d, n) = (&rays.direction, &block.normal);
        let (mut along, mut square) = ([0.0; LANES], [0.0; LANES]);
        let (mut length, mut side) = ([0.0; LANES], [0.0; LANES]);
        dot(d, n, &mut along);
        for axis in 0..3 {
            for i in 0..LANES {
                out[axis][i] = d[axis][i] - n[axis][i] * (2.0 * along[i]);
            }
        }
        let [x, y, z] = &*out;
        for i in 0..LANES {
            square[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
            length[i] = square[i].sqrt();
        }
        for out in out.iter_mut() {
            for i in 0..LANES {
                out[i] /= length[i];
            }
        }
        dot(out, &block.geometric, &mut side);
        let mut plain = 0;
        for i in 0..LANES {
            // Squares out of this range are taken with care by `normalize`.
            let fits = (square[i] >= 1e-200) & (square[i] <= 1e200);
            plain |= u16::from(fits & (side[i] > 0.0)) << i;
        }
        plain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::point::{mirrored, touches};
    use crate::material::Finish;
    use crate::scene::Shading;
    use dioptric_geometry::world::Query;
    use dioptric_geometry::{Contacts, HitId, Ray};
    use dioptric_math::normalize;
    use dioptric_math::random::Random;

    /// What sixteen points are is to the last bit what each is by itself.
    #[test]
    fn sixteen_are_what_one_is() {
        let mut random = Random::new(5);
        let finish = Finish::matte(DVec3::ONE);
        let (mut bent, mut touched, mut through) = (0, 0, 0);
        for _ in 0..200 {
            let mut vector =
                |size: f64| DVec3::from_array([(); 3].map(|()| random.uniform(-size, size)));
            let (mut rays, mut found, mut front) = (Bundle::EMPTY, Found::NOTHING, Front::EMPTY);
            let (mut starts, mut block) = (Bundle::EMPTY, Block::EMPTY);
            let mut points = Vec::new();
            for lane in 0..LANES {
                let normal = normalize(vector(1.0)).unwrap();
                let shading_normal = normalize(normal + vector(0.4)).unwrap();
                let surface =
                    SurfacePoint { point: vector(9.0), error: 1e-9, normal, shading_normal };
                let direction = normalize(vector(1.0)).unwrap();
                let ray = Ray { error: 1e-9, time: 0.5, ..Ray::new(vector(9.0), direction) };
                let id = HitId { instance: HitId::NO_INSTANCE, object: lane as u32, part: 3 };
                let t = if lane % 4 == 0 { 1e-10 } else { vector(5.0).x.abs() };
                let departure = (lane % 3 != 0).then_some(Departure { from: id, outward: true });
                rays.set(lane, &Query::new(ray, 9.0, departure, Contacts::CROSSED));
                (found.ids[lane], found.t[lane]) = (id, t);
                front.set(lane, &surface, &mut starts);
                let hit = Hit { t, id };
                let shading = Shading { surface, finish: Answer::Same(&finish) };
                points.push(Point::new(&ray, hit, shading, departure.as_ref()));
                touched += u32::from(touches(&ray, &hit, &surface));
            }
            front.turn(&rays, &found, &mut starts, &mut block);
            front.mirrors = u16::MAX;
            front.mirror(&rays, &block);
            for (lane, point) in points.iter().enumerate() {
                let new =
                    front.point(lane, (&rays, &found), (&starts, &block), Answer::Same(&finish));
                let key = |p: &Point| (p.ray, p.hit, p.surface, p.normal, p.outside, p.arrived);
                assert_eq!(key(&new), key(point));
                assert_eq!(get(&block.geometric, lane), point.geometric());
                let raw = if point.outside {
                    point.surface.shading_normal
                } else {
                    -point.surface.shading_normal
                };
                bent += u32::from(raw != point.normal);
                let mirrored = mirrored(point.ray.direction, point.normal, point.geometric());
                let leg = point.back(mirrored);
                if front.mirrors & 1 << lane != 0 {
                    assert_eq!(get(&front.mirrored, lane), mirrored);
                    let (new, query) = (starts.query(lane), leg.query(starts.t_max[lane]));
                    let ray = Ray { direction: leg.ray.direction, ..new.ray };
                    assert_eq!(
                        query,
                        Query::new(ray, query.t_max, new.departure(), new.contacts())
                    );
                } else {
                    through += 1;
                }
            }
        }
        assert!(bent > 30 && touched > 300 && through > 0, "{bent} {touched} {through}");
    }
}
