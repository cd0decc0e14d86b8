// SPDX-License-Identifier: MIT OR Apache-2.0
//! Points of matte surfaces, sixteen at a time: the same steps, to the same bits, as [`super::scatter`] takes with each
//! point by itself, in plain loops over arrays. Most points of most scenes are matte.

use std::f64::consts::FRAC_1_PI;

use dioptric_geometry::HitId;
use dioptric_geometry::world::{Bundle, Found, Hit, Leave, Sixteen};
use dioptric_math::wide::{Kernel, wide};
use dioptric_math::{DVec3, Spectrum, orthonormal_basis};

use super::arrive::{Arrivals, Arrive, Record, Skin};
use super::manifold::{Asking, Asks, Bends, NUMBERS, Over};
use super::weights::{MOST, SURE, WORTH, share};
use super::{Path, Paths, Round, Wave};
use crate::bsdf::{cosine_pdf, raised_disc};
use crate::film::FirstHit;
use crate::integrator::point::Point;
use crate::integrator::recorder::Recorder;
use crate::lanes::{LANES, Vectors, ZERO, bits, get, put};
use crate::sampling::Antialias;
use crate::sampling::stream::Streams;
use crate::scene::{Answer, Scene, Shading};
use crate::setting::render::LightSampling;
use crate::source::Looks;

/// Up to sixteen points, with the paths that came there.
pub(super) struct Matte {
    count: usize,
    /// The places of the paths that came there, and of their rays in the wave.
    slots: [u32; LANES],
    numbers: [u32; LANES],
    /// Those whose points are still to be found.
    arrivals: Arrivals,
    /// Whether some of them are inside of something.
    inside: bool,
    /// Rays towards sources. Those that go on start where they do.
    rays: Bundle,
    /// Has the shading normals, too.
    looks: Looks,
    geometric: Vectors,
    albedo: Vectors,
    throughput: Vectors,
    /// What refraction has squeezed radiance by, and whether chance may end the path: then it is not 0.
    squeezed: Sixteen,
    unsure: Sixteen,
    streams: Streams,
    /// What light does if nothing is between.
    value: Vectors,
    /// Where the paths go on, and the numbers that pick these directions.
    next: Vectors,
    density: Sixteen,
    lobe: [Sixteen; 2],
    chance: [Sixteen; 2],
    found: Found,
}

impl Matte {
    pub fn new() -> Self {
        Self {
            count: 0,
            slots: [0; LANES],
            numbers: [0; LANES],
            arrivals: Arrivals::EMPTY,
            inside: false,
            rays: Bundle::EMPTY,
            looks: Looks::EMPTY,
            geometric: ZERO,
            albedo: ZERO,
            throughput: ZERO,
            squeezed: [0.0; LANES],
            unsure: [0.0; LANES],
            streams: Streams::EMPTY,
            value: ZERO,
            next: ZERO,
            density: [0.0; LANES],
            lobe: [[0.0; LANES]; 2],
            chance: [[0.0; LANES]; 2],
            found: Found::NOTHING,
        }
    }

    /// Adds a point; whether there are sixteen now.
    #[inline(always)]
    pub(super) fn push<P>(&mut self, path: &Path<P>, throughput: Spectrum, point: &Point) -> bool {
        let lane = self.count % LANES;
        self.inside |= path.inside.is_some();
        self.arrivals.skip(lane);
        put(&mut self.rays.origin, lane, point.surface.point);
        (self.rays.error[lane], self.rays.time[lane]) = (point.surface.error, point.ray.time);
        self.rays.leaves[lane] = Leave::back(point.hit.id, point.outside, point.arrived);
        put(&mut self.looks.normal, lane, point.normal);
        put(&mut self.geometric, lane, point.geometric());
        put(&mut self.albedo, lane, point.finish.diffuse);
        self.add(lane, path, throughput)
    }

    /// Adds what a ray of a wave has met, if that is recorded; whether there are sixteen now.
    #[inline(always)]
    fn push_arrival<P>(
        &mut self,
        number: usize,
        path: &Path<P>,
        throughput: Spectrum,
        bundle: &Bundle,
        t: f64,
        (record, diffuse): (&Record, Spectrum),
    ) -> bool {
        let lane = self.count % LANES;
        self.numbers[lane] = number as u32;
        self.arrivals.set(lane, bundle, number, t, record);
        self.rays.error[lane] = record.error;
        self.rays.time[lane] = bundle.time[number % LANES];
        put(&mut self.albedo, lane, diffuse);
        self.add(lane, path, throughput)
    }

    /// The path of a point that has just been added.
    #[inline(always)]
    fn add<P>(&mut self, lane: usize, path: &Path<P>, throughput: Spectrum) -> bool {
        self.slots[lane] = path.slot;
        put(&mut self.throughput, lane, throughput);
        self.squeezed[lane] = path.squeezed;
        self.unsure[lane] = if path.depth + 1 > SURE { 1.0 } else { 0.0 };
        self.streams.set(lane, &path.stream);
        self.count += 1;
        self.count == LANES
    }
}

/// Whether matte points of a scene are taken sixteen at a time: not where space between things does more than to dim
/// light.
pub(super) fn in_lanes(scene: &Scene) -> bool {
    let insides = &scene.insides;
    let clear = !insides.borders && !insides.scatter && scene.fog.is_none();
    let clear = clear && scene.guide.is_none();
    clear && scene.settings.antialias != Antialias::Jitter && !scene.sources.can_be_passed()
}

impl<R: Recorder> Paths<'_, '_, R> {
    /// Takes a point if it is a matte one: if nothing but the point itself adds to its path there.
    #[inline(always)]
    pub(super) fn meet_matte(
        &mut self,
        now: &Wave,
        number: usize,
        bundle: &Bundle,
        round: &mut Round<R::Id>,
    ) -> bool {
        let (scene, path) = (self.scene, &round.paths[now.slots[number] as usize]);
        let (found, lane) = (&round.found[number / LANES], number % LANES);
        if !self.in_lanes {
            return false;
        }
        if found.hit >> lane & 1 == 0 {
            let clear = path.inside.is_none() && scene.surroundings.is_clear();
            if clear {
                self.see_sky(path, &bundle.query(number));
            }
            return clear;
        }
        if path.depth > scene.settings.bounces {
            return false;
        }
        let t = found.t[lane];
        let dimmed = || path.throughput * scene.surroundings.transmittance(t);
        let full = if let Some(record) = scene.plains.get(&found.ids[lane]) {
            match record.skin {
                Skin::Matte(diffuse) if path.inside.is_none() => {
                    round.matte.push_arrival(number, path, dimmed(), bundle, t, (record, diffuse))
                }
                Skin::Matte(_) => return false,
                _ => return self.meet_sharp(now, number, bundle, record, round),
            }
        } else {
            if path.inside.is_some() {
                return false;
            }
            let hit = Hit { t, id: found.ids[lane] };
            let material = &scene.materials[scene.material_index(hit.id)];
            let (true, Some(finish)) = (material.matte, &material.uniform) else { return false };
            let ray = bundle.ray(number);
            let Some(surface) = scene.world.surface_point_inline(&ray, &hit) else { return false };
            let shading = Shading { surface, finish: Answer::Same(finish) };
            let departure = bundle.leaves[number % LANES].departure();
            let point = Point::new(&ray, hit, shading, departure.as_ref());
            if path.depth == 0 {
                self.radiances[path.sample as usize].first = point.first_hit(scene);
            }
            round.matte.push(path, dimmed(), &point)
        };
        if full {
            self.scatter_matte(now, round);
        }
        true
    }

    /// Finds the points of the rays that have arrived.
    fn arrive(
        &mut self,
        now: &Wave,
        found: &[Found],
        matte: &mut Matte,
        paths: &[Path<R::Id>],
        all: u16,
    ) {
        let scene = self.scene;
        let Matte { arrivals, rays, looks, geometric, .. } = matte;
        let Bundle { origin: point, error: bound, .. } = rays;
        let arrived = wide(Arrive { arrivals, point, bound, normal: &mut looks.normal, geometric });
        let mut new = arrived.new & all;
        while new != 0 {
            let lane = new.trailing_zeros() as usize % LANES;
            new &= new - 1;
            let number = matte.numbers[lane] as usize;
            let id = found[number / LANES].ids[number % LANES];
            let is = |mask: u16| mask >> lane & 1 != 0;
            matte.rays.leaves[lane] = Leave::back(id, is(arrived.outside), None);
            if is(arrived.touching | arrived.odd) {
                self.look_again(now, id, matte, lane);
            }
            let path = &paths[matte.slots[lane] as usize];
            if path.depth == 0 {
                self.radiances[path.sample as usize].first = FirstHit {
                    object: scene.layer_id(id),
                    depth: matte.arrivals.length[lane],
                    normal: get(&matte.looks.normal, lane),
                    albedo: scene.plains.get(&id).map_or(Spectrum::ZERO, |record| record.base),
                };
            }
        }
    }

    /// The point of a ray that is a case of its own.
    #[cold]
    fn look_again(&self, now: &Wave, id: HitId, matte: &mut Matte, lane: usize) {
        let number = matte.numbers[lane] as usize;
        let bundle = &now.rays.bundles()[number / LANES];
        let (ray, leave) = (bundle.ray(number), &bundle.leaves[number % LANES]);
        let hit = Hit { t: matte.arrivals.length[lane], id };
        let Some(shading) = self.scene.shading(&ray, &hit) else { return };
        let point = Point::new(&ray, hit, shading, leave.departure().as_ref());
        put(&mut matte.rays.origin, lane, point.surface.point);
        matte.rays.leaves[lane] = Leave::back(point.hit.id, point.outside, point.arrived);
        put(&mut matte.looks.normal, lane, point.normal);
        put(&mut matte.geometric, lane, point.geometric());
    }

    /// Lights the matte points and sends their paths on.
    pub(super) fn scatter_matte(&mut self, now: &Wave, round: &mut Round<R::Id>) {
        let Round { matte, next, paths, asks, bends, found, .. } = round;
        let count = std::mem::take(&mut matte.count);
        if count == 0 {
            return;
        }
        let all = if count < LANES { (1 << count) - 1 } else { u16::MAX };
        let scene = self.scene;
        self.arrive(now, found, matte, paths, all);
        let asking = !scene.casters.is_empty();
        if asking {
            self.ask_over_lanes(paths, matte, count, (asks, bends));
        }
        wide(Numbers(matte));
        let lights = scene.sources.sample_lanes(scene, &mut matte.rays, &mut matte.looks, all);
        let how = scene.settings.light_sampling;
        let [bright, going] = wide(Scatter { matte, how });
        let mut lit = bright & lights;
        if !scene.surroundings.is_clear() || std::mem::take(&mut matte.inside) {
            lit = self.dim(paths, matte, lit, count);
        }
        self.shine(paths, matte, lit);
        let (mut left, mut gone) = (going & all, 0);
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            gone += 1;
            let slot = matte.slots[lane];
            let path = &mut paths[slot as usize];
            path.throughput = get(&matte.throughput, lane);
            path.density = matte.density[lane];
            path.normal = Some(get(&matte.looks.normal, lane));
            path.depth += 1;
            path.walked = 0.0;
            path.trail = path.trail.then(false);
            path.over = Over::No;
            path.stream = path.stream.ahead(match () {
                () if asking => NUMBERS,
                () if matte.unsure[lane] == 0.0 => 3,
                () => 4,
            });
            next.slots.push(slot);
            next.rays.push_lane(&matte.rays, lane, get(&matte.next, lane), f64::INFINITY);
        }
        self.counts.reflect += gone;
    }

    /// Asks for light over balls.
    fn ask_over_lanes(
        &self,
        paths: &[Path<R::Id>],
        matte: &Matte,
        count: usize,
        (asks, bends): (&mut Asks<R::Id>, &mut Bends<R::Id>),
    ) {
        for lane in 0..count {
            let path = &paths[matte.slots[lane] as usize];
            if path.inside.is_some() {
                continue;
            }
            let normal = get(&matte.looks.normal, lane);
            let geometric = get(&matte.geometric, lane);
            let asking = Asking { normal, geometric, query: matte.rays.query(lane) };
            let throughput = get(&matte.throughput, lane);
            let albedo = get(&matte.albedo, lane);
            self.ask_over_soon(&Path { throughput, ..*path }, albedo, &asking, asks, bends);
        }
    }

    /// What is between things dims light of sources; returns those of which some is left.
    #[cold]
    fn dim(&self, paths: &[Path<R::Id>], matte: &mut Matte, mut lit: u16, count: usize) -> u16 {
        for lane in 0..count {
            let inside = paths[matte.slots[lane] as usize].inside;
            let clear = self.transmittance(inside, matte.rays.t_max[lane]);
            let value = get(&matte.value, lane) * clear;
            put(&mut matte.value, lane, value);
            if !(value.max_element() > 0.0 && value.is_finite()) {
                lit &= !(1 << lane);
            }
        }
        lit
    }

    /// Adds what arrives from sources.
    fn shine(&mut self, paths: &[Path<R::Id>], matte: &mut Matte, mut lit: u16) {
        if lit == 0 {
            return;
        }
        self.counts.shadow += u64::from(lit.count_ones());
        self.scene.world.blockers_of(&matte.rays, lit, &mut matte.found);
        while lit != 0 {
            let lane = lit.trailing_zeros() as usize % LANES;
            lit &= lit - 1;
            let path = &paths[matte.slots[lane] as usize];
            let value = self.clamped(path.depth + 1, get(&matte.value, lane));
            let sharp = matte.looks.pdf[lane] == f64::INFINITY;
            let value = match matte.found.best(lane) {
                None => value,
                Some(_) if !sharp && !self.scene.has_holes => continue,
                Some(hit) => value * self.shadowed(&matte.rays.query(lane), &hit.id, sharp),
            };
            self.radiances[path.sample as usize].color += value;
        }
    }
}

/// Draws the numbers of all points.
struct Numbers<'a>(&'a mut Matte);

impl Kernel for Numbers<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Matte { streams, looks, lobe, chance, .. } = self.0;
        streams.ahead(0, &mut looks.pick);
        streams.ahead(1, &mut looks.u);
        streams.ahead(2, lobe);
        streams.ahead(3, chance);
    }
}

/// Works out what light makes of the surfaces if it arrives, and where the paths go on: a bit for each of which
/// something is left, and for each that goes on.
struct Scatter<'a> {
    matte: &'a mut Matte,
    how: LightSampling,
}

impl Kernel for Scatter<'_> {
    type Output = [u16; 2];

    #[inline(always)]
    fn run(self) -> [u16; 2] {
        let Self { matte, how } = self;
        let Matte { rays, looks, geometric, albedo, throughput, value, next, density, .. } = matte;
        let Matte { squeezed, unsure, lobe: [lu, lv], chance: [chance, _], .. } = matte;
        let (lights, surfaces) = (how == LightSampling::Lights, how == LightSampling::Surfaces);
        let [dx, dy, dz] = &rays.direction;
        let ([nx, ny, nz], [gx, gy, gz]) = (&looks.normal, &*geometric);
        let ([ar, ag, ab], [tr, tg, tb]) = (&*albedo, throughput);
        let ([sr, sg, sb], pdf) = (&looks.value, &looks.pdf);
        let [vr, vg, vb] = value;
        let [ox, oy, oz] = next;
        let (mut bright, mut going) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let direction = DVec3::new(dx[i], dy[i], dz[i]);
            let normal = DVec3::new(nx[i], ny[i], nz[i]);
            let geometric = DVec3::new(gx[i], gy[i], gz[i]);
            let albedo = Spectrum::new(ar[i], ag[i], ab[i]);
            let throughput = Spectrum::new(tr[i], tg[i], tb[i]);
            let source = Spectrum::new(sr[i], sg[i], sb[i]);
            let cosine = direction.dot(normal);
            let found = cosine_pdf(cosine);
            let both = share(pdf[i], found);
            let weight = if (pdf[i] == f64::INFINITY) | lights {
                1.0
            } else if surfaces {
                0.0
            } else {
                both
            };
            let value = throughput * (albedo * found) * source * weight;
            (vr[i], vg[i], vb[i]) = (value.x, value.y, value.z);
            let ahead = (geometric.dot(direction) > 0.0) & (cosine > 0.0);
            let most = value.x.max(value.y).max(value.z);
            bright[i] = if ahead & (most > 0.0) & finite(value) { 1.0 } else { 0.0 };
        }
        for i in 0..LANES {
            let normal = DVec3::new(nx[i], ny[i], nz[i]);
            let geometric = DVec3::new(gx[i], gy[i], gz[i]);
            let albedo = Spectrum::new(ar[i], ag[i], ab[i]);
            let throughput = Spectrum::new(tr[i], tg[i], tb[i]);
            let wi = raised_disc([lu[i], lv[i]]);
            let (x, y) = orthonormal_basis(normal);
            let out = x * wi.x + y * wi.y + normal * wi.z;
            let throughput = throughput * albedo;
            let most = throughput.x.max(throughput.y).max(throughput.z);
            let goes_on = (most / squeezed[i] * WORTH).min(MOST);
            let unsure = unsure[i] != 0.0;
            let survives = !unsure | (chance[i] < goes_on);
            let divisor = if unsure { goes_on } else { 1.0 };
            let above = (wi.z > 0.0) & (out.dot(geometric) > 0.0);
            let on = above & (most > 0.0) & finite(throughput) & survives;
            let throughput = throughput / divisor;
            (tr[i], tg[i], tb[i]) = (throughput.x, throughput.y, throughput.z);
            (ox[i], oy[i], oz[i]) = (out.x, out.y, out.z);
            density[i] = wi.z * FRAC_1_PI;
            going[i] = if on { 1.0 } else { 0.0 };
        }
        [bits(&bright), bits(&going)]
    }
}

#[inline(always)]
pub(super) fn finite(v: DVec3) -> bool {
    (v.x.abs() < f64::INFINITY) & (v.y.abs() < f64::INFINITY) & (v.z.abs() < f64::INFINITY)
}
