// SPDX-License-Identifier: MIT OR Apache-2.0
//! Mirrors and smooth glass, sixteen points at a time: the same steps, to the same bits, as [`super::scatter`] takes with
//! each point by itself.

use dioptric_geometry::world::{Bundle, Leave, Sixteen};
use dioptric_geometry::{Contacts, Departure};
use dioptric_math::wide::{Kernel, wide};
use dioptric_math::{DVec3, Spectrum, orthonormal_basis};

use super::arrive::{Arrivals, Arrive, Record, Skin};
use super::manifold::{NUMBERS, Over};
use super::matte::finite;
use super::weights::{MOST, SURE, WORTH};
use super::{Paths, Round, Wave};
use crate::bsdf::{Bsdf, image};
use crate::film::FirstHit;
use crate::integrator::media::Medium;
use crate::integrator::recorder::Recorder;
use crate::lanes::{LANES, Vectors, ZERO, bits, get, put};
use crate::sampling::stream::Streams;

/// Up to sixteen rays that have met a mirror or glass.
pub(super) struct Sharp {
    count: usize,
    slots: [u32; LANES],
    /// Of the rays in the wave.
    numbers: [u32; LANES],
    arrivals: Arrivals,
    /// Those that go on, but for their directions.
    rays: Bundle,
    normal: Vectors,
    geometric: Vectors,
    throughput: Vectors,
    squeezed: Sixteen,
    /// Whether chance may end the path: then it is not 0.
    unsure: Sixteen,
    /// The near side's index over the far one's for glass; 0 for mirrors.
    eta: Sixteen,
    /// What glass reflects and lets through, or a mirror at right and grazing angles.
    colors: [Vectors; 2],
    streams: Streams,
    pick: [Sixteen; 2],
    chance: [Sixteen; 2],
    /// Where they go on.
    next: Vectors,
}

impl Sharp {
    pub const EMPTY: Self = Self {
        count: 0,
        slots: [0; LANES],
        numbers: [0; LANES],
        arrivals: Arrivals::EMPTY,
        rays: Bundle::EMPTY,
        normal: ZERO,
        geometric: ZERO,
        throughput: ZERO,
        squeezed: [0.0; LANES],
        unsure: [0.0; LANES],
        eta: [0.0; LANES],
        colors: [ZERO; 2],
        streams: Streams::EMPTY,
        pick: [[0.0; LANES]; 2],
        chance: [[0.0; LANES]; 2],
        next: ZERO,
    };
}

impl<R: Recorder> Paths<'_, '_, R> {
    /// Takes what a ray has met if it is a plain mirror or ball of glass, and not within something else.
    #[inline(always)]
    pub(super) fn meet_sharp(
        &mut self,
        now: &Wave,
        number: usize,
        bundle: &Bundle,
        record: &Record,
        round: &mut Round<R::Id>,
    ) -> bool {
        let path = &round.paths[now.slots[number] as usize];
        let (found, at) = (&round.found[number / LANES], number % LANES);
        let (eta, colors) = match &record.skin {
            Skin::Mirror { normal, grazing } if path.inside.is_none() => (0.0, [*normal, *grazing]),
            Skin::Glass { ior, reflect, transmit, .. } => match self.media.top(path.inside) {
                None => (self.media.ior(None) / ior, [*reflect, *transmit]),
                Some(around) if self.media.is_last(path.inside, &found.ids[at]) => {
                    (around.ior / self.media.ior(None), [Spectrum::ONE; 2])
                }
                Some(_) => return false,
            },
            _ => return false,
        };
        let throughput = path.throughput * self.transmittance(path.inside, found.t[at]);
        let sharp = &mut round.sharp;
        let lane = sharp.count % LANES;
        sharp.arrivals.set(lane, bundle, number, found.t[at], record);
        sharp.slots[lane] = path.slot;
        sharp.numbers[lane] = number as u32;
        (sharp.rays.error[lane], sharp.rays.time[lane]) =
            (record.error, bundle.time[number % LANES]);
        put(&mut sharp.throughput, lane, throughput);
        sharp.squeezed[lane] = path.squeezed;
        sharp.unsure[lane] = if path.depth + 1 > SURE { 1.0 } else { 0.0 };
        sharp.eta[lane] = eta;
        for (to, color) in sharp.colors.iter_mut().zip(colors) {
            put(to, lane, color);
        }
        sharp.streams.set(lane, &path.stream);
        sharp.count += 1;
        if sharp.count == LANES {
            self.scatter_sharp(now, round);
        }
        true
    }

    /// Sends the paths on that have met mirrors and glass.
    pub(super) fn scatter_sharp(&mut self, now: &Wave, round: &mut Round<R::Id>) {
        let scene = self.scene;
        let Round { sharp, next, paths, found, .. } = round;
        let count = std::mem::take(&mut sharp.count);
        if count == 0 {
            return;
        }
        let all = if count < LANES { (1 << count) - 1 } else { u16::MAX };
        let Sharp { arrivals, rays, normal, geometric, .. } = sharp;
        let Bundle { origin: point, error: bound, .. } = rays;
        let arrived = wide(Arrive { arrivals, point, bound, normal, geometric });
        let scattered = wide(Scatter(sharp));
        let asking = !scene.casters.is_empty();
        let mut alone = arrived.touching | arrived.odd | scattered.odd;
        for lane in (0..LANES).filter(|lane| all >> lane & 1 != 0) {
            let slot = sharp.slots[lane];
            let path = &mut paths[slot as usize];
            let number = sharp.numbers[lane] as usize;
            let id = found[number / LANES].ids[number % LANES];
            let is = |mask: u16| mask >> lane & 1 != 0;
            let entered = path.inside.is_none();
            // From within glass whose outside was met, or the other way round.
            if is(alone) || (sharp.eta[lane] != 0.0 && entered != is(arrived.outside)) {
                alone |= 1 << lane;
                continue;
            }
            if path.depth == 0 {
                self.radiances[path.sample as usize].first = FirstHit {
                    object: scene.layer_id(id),
                    depth: sharp.arrivals.length[lane],
                    normal: get(&sharp.normal, lane),
                    albedo: scene.plains.get(&id).map_or(Spectrum::ZERO, |record| record.base),
                };
            }
            if !is(scattered.going) {
                continue;
            }
            let (through, direction) = (is(scattered.through), get(&sharp.next, lane));
            path.over = if asking {
                let number = sharp.numbers[lane] as usize;
                let ray = now.rays.bundles()[number / LANES].ray(number);
                self.over(path, &ray, &id, is(arrived.outside), through)
            } else {
                Over::No
            };
            let outward = direction.dot(get(&sharp.geometric, lane)) > 0.0;
            let outward = outward == is(arrived.outside);
            let departure = Some(Departure { from: id, outward });
            let contacts = Contacts { crossed: through, except: None };
            sharp.rays.leaves[lane] = Leave::new(departure, contacts);
            if through {
                self.counts.refract += 1;
                path.inside = match scene.plains.get(&id).map(|record| &record.skin) {
                    Some(&Skin::Glass { ior, absorption, priority, .. }) if entered => {
                        self.media.enter(None, Medium { object: id, ior, absorption, priority })
                    }
                    _ => None,
                };
            } else {
                self.counts.reflect += 1;
            }
            path.throughput = get(&sharp.throughput, lane);
            path.squeezed = sharp.squeezed[lane];
            path.density = f64::INFINITY;
            path.normal = Some(get(&sharp.normal, lane));
            path.depth += 1;
            path.walked = 0.0;
            path.trail = path.trail.then(true);
            path.stream = path.stream.ahead(match () {
                () if asking => NUMBERS,
                () if sharp.unsure[lane] == 0.0 => 3,
                () => 4,
            });
            next.slots.push(slot);
            next.rays.push_lane(&sharp.rays, lane, direction, f64::INFINITY);
        }
        if alone & all != 0 {
            self.scatter_alone(now, alone & all, round);
        }
    }

    /// Those that are cases of their own.
    #[cold]
    fn scatter_alone(&mut self, now: &Wave, alone: u16, round: &mut Round<R::Id>) {
        let mut bsdf = Bsdf::BLACK;
        for lane in (0..LANES).filter(|lane| alone >> lane & 1 != 0) {
            let number = round.sharp.numbers[lane] as usize;
            let query = now.rays.bundles()[number / LANES].query(number);
            let hit = round.found[number / LANES].best(number);
            self.meet(now, number, &query, hit, &mut bsdf, round);
        }
    }
}

/// What becomes of sixteen paths, a bit each.
struct Scattered {
    going: u16,
    through: u16,
    /// Lanes that did not work out.
    odd: u16,
}

/// Mirrors and bends.
struct Scatter<'a>(&'a mut Sharp);

impl Kernel for Scatter<'_> {
    type Output = Scattered;

    #[inline(always)]
    fn run(self) -> Scattered {
        let Sharp { arrivals, normal, geometric, throughput, squeezed, unsure, .. } = self.0;
        let Sharp { eta, colors, streams, pick, chance, next, .. } = self.0;
        streams.ahead(0, pick);
        streams.ahead(3, chance);
        let [wx, wy, wz] = arrivals.way();
        let ([nx, ny, nz], [gx, gy, gz]) = (&*normal, &*geometric);
        let ([[ar, ag, ab], [br, bg, bb]], [tr, tg, tb]) = (&*colors, throughput);
        let ([_, pick], [chance, _], [ox, oy, oz]) = (&*pick, &*chance, next);
        let (mut going, mut through, mut odd) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let n = DVec3::new(nx[i], ny[i], nz[i]);
            let geometric = DVec3::new(gx[i], gy[i], gz[i]);
            let (x, y) = orthonormal_basis(n);
            let to_viewer = -DVec3::new(wx[i], wy[i], wz[i]);
            let wo = DVec3::new(to_viewer.dot(x), to_viewer.dot(y), to_viewer.dot(n));
            let a = Spectrum::new(ar[i], ag[i], ab[i]);
            let b = Spectrum::new(br[i], bg[i], bb[i]);
            let mirror = eta[i] == 0.0;
            // As `fresnel`, `Interface::chance` and `refract` do it.
            let (cos, eta2) = (wo.z.clamp(0.0, 1.0), eta[i] * eta[i]);
            let sin2 = eta2 * (1.0 - cos * cos);
            let cos_t = (1.0 - sin2).sqrt();
            let s = (eta[i] * cos - cos_t) / (eta[i] * cos + cos_t);
            let p = (eta[i] * cos_t - cos) / (eta[i] * cos_t + cos);
            let partly = 0.5 * (s * s + p * p);
            let share = if sin2 >= 1.0 { 1.0 } else { partly };
            let share = if eta[i] == 1.0 { 0.0 } else { share };
            let back = share * most(a);
            let on = (1.0 - share) * most(b);
            let chosen = back / (back + on);
            let chosen = if back > 0.0 { chosen } else { 0.0 };
            let reflects = mirror | (pick[i] < chosen);
            let bent2 = eta2 * (1.0 - wo.z * wo.z).max(0.0);
            let steep = eta[i] * wo.z - (1.0 - bent2).sqrt();
            let bent = -wo * eta[i] + DVec3::Z * steep;
            let length2 = bent.length_squared();
            let bent = bent / length2.sqrt();
            let straight = image(wo);
            let m = (1.0 - wo.z).clamp(0.0, 1.0);
            let curve = a + (b - a) * (m * m * m * m * m);
            let reflected = a * (share / chosen);
            let refracted = b * ((1.0 - share) / (1.0 - chosen) * eta2);
            let weight = pick3(mirror, curve, pick3(reflects, reflected, refracted));
            let wi = pick3(reflects, straight, bent);
            let direction = x * wi.x + y * wi.y + n * wi.z;
            let below = wi.z < 0.0;
            let height = direction.dot(geometric);
            let turned = direction - geometric * (2.0 * height);
            let direction = pick3((height < 0.0) == below, direction, turned);
            let carried = Spectrum::new(tr[i], tg[i], tb[i]) * weight;
            let largest = most(carried);
            let sound = (height != 0.0) & (largest > 0.0) & finite(carried);
            let total = !reflects & (bent2 > 1.0);
            let squeeze = squeezed[i] * if below { eta2 } else { 1.0 };
            let goes_on = (largest / squeeze * WORTH).min(MOST);
            let unsure = unsure[i] != 0.0;
            let survives = !unsure | (chance[i] < goes_on);
            let carried = carried / if unsure { goes_on } else { 1.0 };
            (tr[i], tg[i], tb[i]) = (carried.x, carried.y, carried.z);
            (ox[i], oy[i], oz[i]) = (direction.x, direction.y, direction.z);
            squeezed[i] = squeeze;
            going[i] = if sound & survives & !total { 1.0 } else { 0.0 };
            through[i] = if below { 1.0 } else { 0.0 };
            let known = reflects | total | ((1e-200..=1e200).contains(&length2));
            odd[i] = if known { 0.0 } else { 1.0 };
        }
        Scattered { going: bits(&going), through: bits(&through), odd: bits(&odd) }
    }
}

#[inline(always)]
fn most(v: DVec3) -> f64 {
    v.x.max(v.y).max(v.z)
}

#[inline(always)]
fn pick3(first: bool, a: DVec3, b: DVec3) -> DVec3 {
    let pick = |a: f64, b: f64| if first { a } else { b };
    DVec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z))
}
