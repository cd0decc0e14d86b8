// SPDX-License-Identifier: MIT OR Apache-2.0
//! Paths of light: the rendering equation without bias (Kajiya, "The Rendering Equation", SIGGRAPH 1986).
//!
//! A path starts at the camera and goes on from surface to surface, in a direction that the surface's
//! [`Bsdf`](crate::bsdf::Bsdf) picks. At each surface that is not sharp a source of light is picked too and, if nothing is
//! between, what it sends is added. Light that both ways can find counts by both, each weighted by how likely it
//! was to find it (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995:
//! the power heuristic). Paths that carry little end early, by chance, and the others count for them.
//!
//! As in Whitted's pictures, many paths are followed side by side, all a step at a time: cast the rays, [`vertex`]
//! shades what they meet, cast the rays to the sources, add. What a path brings depends on its own numbers alone.
//!
//! What differs from Whitted's meaning of a scene stands in the manual, `path.md`.

pub(crate) mod arrive;
mod manifold;
mod matte;
mod phase;
pub(crate) mod photons;
mod scatter;
mod sharp;
mod tell;
mod vertex;
mod volume;
mod weights;

use std::sync::atomic::{AtomicBool, Ordering};

use dioptric_geometry::world::{Bundle, Found, Query, Rays};
use dioptric_geometry::{Contacts, HitId, Ray};
use dioptric_math::{DVec3, Spectrum};

use super::media::{Inside, Media};
use super::recorder::{RayKind, Recorder, Silent};
use super::resolve::Spare;
use super::shadow::Start;
use crate::bsdf::Bsdf;
use crate::camera::Places;
use crate::film::{FirstHit, Radiance};
use crate::job::Shot;
use crate::picture::place;
use crate::sampling::stream::Stream;
use crate::scene::Scene;
use crate::setting::render::Shadows;
use crate::stats::RayCounts;
use manifold::{Anchor, Asks, Bends, Over};
use matte::Matte;
use sharp::Sharp;
use tell::{Told, Trail};

/// Paths that are followed side by side.
const TOGETHER: usize = 512;

/// One batch of paths.
pub struct Paths<'a, 'r, R: Recorder> {
    scene: &'a Scene,
    counts: &'r mut RayCounts,
    recorder: &'r mut R,
    /// Transparent objects that this batch's paths have been in.
    media: Media,
    /// By the sample's number.
    radiances: Vec<Radiance>,
    /// The same, in scenes with balls over which light is looked for.
    anchors: Vec<Anchor>,
    /// Whether matte points are taken sixteen at a time.
    in_lanes: bool,
    /// Where these paths are photons: those that have come.
    photons: Option<photons::Photons>,
}

/// A path that goes on: what is known of it but for its ray.
#[derive(Clone, Copy)]
struct Path<I> {
    sample: u32,
    /// Its place among the paths of the batch.
    slot: u32,
    id: I,
    /// What multiplies the radiance that its ray brings.
    throughput: Spectrum,
    /// The density with which the last surface picked its direction; infinite where that was sharp.
    density: f64,
    /// The shading normal that it left on this side; `None` from the camera, and from where no source was asked for.
    normal: Option<DVec3>,
    /// What the refractions so far have squeezed radiance by: no reason to end a path.
    squeezed: f64,
    inside: Inside,
    /// Bounces so far.
    depth: u32,
    /// How far its line has come, through borders that do nothing, before its ray begins; and through how many.
    walked: f64,
    borders: u32,
    /// In micrometres, once it has met what bends each wavelength by its own angle; before, 0 for all together.
    wavelength: f64,
    /// The wavelength that a guide expects where it has sent the path; 0 for none.
    hint: f64,
    stream: Stream,
    trail: Trail,
    over: Over,
}

impl<I> Path<I> {
    /// One that begins.
    fn new(sample: u32, id: I, inside: Inside, stream: Stream) -> Self {
        Self {
            sample,
            slot: 0,
            id,
            throughput: Spectrum::ONE,
            density: f64::INFINITY,
            normal: None,
            squeezed: 1.0,
            inside,
            depth: 0,
            walked: 0.0,
            borders: 0,
            wavelength: 0.0,
            hint: 0.0,
            stream,
            trail: Trail::default(),
            over: Over::No,
        }
    }
}

/// What a source adds to a sample if nothing is between.
struct Task<I> {
    sample: u32,
    id: I,
    value: Spectrum,
    /// Whether only this question can find the source.
    sharp: bool,
    /// What is around the point that asks.
    inside: Inside,
}

/// Rays that are cast next, and whose they are.
struct Wave {
    rays: Rays,
    /// The places of their paths.
    slots: Vec<u32>,
}

impl Default for Wave {
    fn default() -> Self {
        Self { rays: Rays::default(), slots: Vec::with_capacity(TOGETHER) }
    }
}

/// Memory that the rounds of a batch use again.
struct Round<I> {
    /// All paths of the batch, each at its place as long as it lives.
    paths: Vec<Path<I>>,
    now: Wave,
    /// Those that go on with the next step.
    next: Wave,
    found: Vec<Found>,
    matte: Matte,
    sharp: Sharp,
    shadows: Vec<Query>,
    tasks: Vec<Task<I>>,
    told: Vec<Told>,
    blockers: Vec<Option<HitId>>,
    asks: Asks<I>,
    bends: Bends<I>,
    spare: Spare,
    /// Paths that end with this step.
    ended: Vec<(u32, I)>,
}

impl<'a, 'r, R: Recorder> Paths<'a, 'r, R> {
    /// Ready for one batch.
    pub fn new(scene: &'a Scene, counts: &'r mut RayCounts, recorder: &'r mut R) -> Self {
        let media = Media::new(scene.surroundings.ior);
        let in_lanes = matte::in_lanes(scene) && !R::ENABLED;
        let (radiances, anchors) = (Vec::new(), Vec::new());
        Self { scene, counts, recorder, media, radiances, anchors, in_lanes, photons: None }
    }

    /// The radiance that each camera's ray brings, and what it met first; nothing if cancelled meanwhile.
    pub fn radiances(
        mut self,
        rays: impl ExactSizeIterator<Item = Option<(Ray, Stream)>>,
        cancel: &AtomicBool,
    ) -> Vec<Radiance> {
        self.radiances.resize(rays.len(), Radiance::NOTHING);
        if !self.scene.casters.is_empty() {
            self.anchors.resize(rays.len(), Anchor::NOTHING);
        }
        let mut round = Round::default();
        let mut rays = rays.zip(0..);
        let mut left = self.radiances.len();
        while left > 0 {
            let inside = self.start(&mut round);
            for (ray, sample) in rays.by_ref().take(TOGETHER) {
                left -= 1;
                if let Some((ray, stream)) = ray {
                    self.counts.camera += 1;
                    let id = self.recorder.begin(None, RayKind::Camera, &ray);
                    round.begin(Path::new(sample, id, inside, stream), ray);
                }
            }
            if !self.run(&mut round, cancel) {
                return Vec::new();
            }
        }
        self.tell_alphas(0);
        self.radiances
    }

    /// Ready for paths that begin at the camera; what is around them.
    fn start(&mut self, round: &mut Round<R::Id>) -> Inside {
        round.paths.clear();
        self.media = Media::new(self.scene.surroundings.ior);
        let around = self.scene.around_camera.iter();
        around.fold(None, |inside, &medium| self.media.enter(inside, medium))
    }

    /// Follows paths to their ends; false if cancelled meanwhile.
    fn run(&mut self, round: &mut Round<R::Id>, cancel: &AtomicBool) -> bool {
        while !round.now.slots.is_empty() {
            if cancel.load(Ordering::Relaxed) {
                return false;
            }
            self.step(round);
        }
        true
    }

    /// Where something was hit first nothing shines through.
    fn tell_alphas(&mut self, from: usize) {
        for radiance in &mut self.radiances[from..] {
            if radiance.first.object != FirstHit::NOTHING {
                radiance.alpha = 1.0;
            }
        }
    }

    /// Takes every path one surface further; those that go on are kept.
    fn step(&mut self, round: &mut Round<R::Id>) {
        let now = std::mem::take(&mut round.now);
        self.scene.world.closest_of_rays(&now.rays, &mut round.found);
        round.next.rays.clear();
        round.next.slots.clear();
        let mut bsdf = Bsdf::BLACK;
        for (i, &slot) in now.slots.iter().enumerate() {
            let bundle = &now.rays.bundles()[i / Bundle::LANES];
            if self.meet_matte(&now, i, bundle, round) {
                continue;
            }
            let hit = round.found[i / Bundle::LANES].best(i);
            let ended = R::ENABLED.then(|| {
                let path = &round.paths[slot as usize];
                (path.sample, path.id)
            });
            if !self.meet(&now, i, &bundle.query(i), hit, &mut bsdf, round) {
                round.ended.extend(ended);
            }
        }
        self.scatter_sharp(&now, round);
        self.scatter_matte(&now, round);
        self.cast_shadows(round);
        self.answer(&mut round.asks, &mut round.bends);
        self.cast_bends(round);
        for (sample, id) in round.ended.drain(..) {
            self.recorder.end(id, Spectrum::ONE, self.radiances[sample as usize].color);
        }
        round.now = std::mem::replace(&mut round.next, now);
    }

    /// Adds what arrives from the sources that were asked for.
    fn cast_shadows(&mut self, round: &mut Round<R::Id>) {
        let scene = self.scene;
        self.counts.shadow += round.shadows.len() as u64;
        scene.world.blocker_each(&round.shadows, &mut round.blockers);
        let asked = round.tasks.iter().zip(&round.shadows).zip(&round.blockers);
        for (i, ((task, query), blocker)) in asked.enumerate() {
            let visible = match blocker {
                _ if scene.insides.borders => self.through_borders(query, task.inside, task.sharp),
                None => Spectrum::ONE,
                Some(id) => self.shadowed(query, id, task.sharp),
            };
            let value = task.value * visible;
            if visible != Spectrum::ZERO {
                self.radiances[task.sample as usize].color += value;
            }
            if R::ENABLED {
                let told = &round.told[i];
                self.recorder
                    .term(task.id, told.name, value, || told.of_source(scene, visible, *blocker));
            }
        }
        round.shadows.clear();
        round.tasks.clear();
        round.told.clear();
    }

    /// What the scene lets through of a light that something hides: of sharp ones as it says, of others holes.
    fn shadowed(&self, query: &Query, blocker: &HitId, sharp: bool) -> Spectrum {
        let scene = self.scene;
        let tinted = match scene.settings.shadows {
            Shadows::None if sharp => return Spectrum::ONE,
            Shadows::Tinted => sharp,
            Shadows::None | Shadows::Opaque => false,
        };
        if scene.is_opaque(*blocker) || !(tinted || scene.has_holes) {
            return Spectrum::ZERO;
        }
        let (mut hits, departure) = (Vec::new(), query.departure());
        scene.world.hits(&query.ray, query.t_max, departure.as_ref(), &mut hits);
        scene.passes(&Start::of(query), query.t_max, tinted, hits.iter())
    }

    /// What is left of light over a distance, by what the path is in.
    fn transmittance(&self, inside: Inside, distance: f64) -> Spectrum {
        let scene = self.scene;
        let clear = self.media.transmittance(scene, inside, distance);
        match scene.fog.as_ref().filter(|_| inside.is_none()) {
            Some(fog) => clear * fog.transmittance(distance),
            None => clear,
        }
    }

    /// Adds light that a path found to its sample.
    fn add(&mut self, path: &Path<R::Id>, value: Spectrum, told: impl FnOnce() -> Told) {
        let value = self.clamped(path.depth, value);
        self.radiances[path.sample as usize].color += value;
        if R::ENABLED {
            let told = told();
            let scene = self.scene;
            self.recorder.term(path.id, told.name, value, || told.of_path(scene));
        }
    }

    /// Indirect light, cut off where the user wants that. Direct light is what arrives by at most one bounce.
    fn clamped(&self, depth: u32, value: Spectrum) -> Spectrum {
        let most = self.scene.settings.clamp;
        let brightest = value.max_element();
        if depth < 2 || brightest <= most { value } else { value * (most / brightest) }
    }
}

impl Paths<'_, '_, Silent> {
    /// [`Self::radiances`] of a job's samples, whose rays the camera makes sixteen at a time.
    pub fn shoot(mut self, shots: &[Shot], cancel: &AtomicBool, out: &mut Vec<Radiance>) {
        let (scene, before) = (self.scene, out.len());
        self.radiances = std::mem::take(out);
        self.radiances.resize(before + shots.len(), Radiance::NOTHING);
        if !self.scene.casters.is_empty() {
            self.anchors.resize(self.radiances.len(), Anchor::NOTHING);
        }
        let (mut round, mut places) = (Round::default(), Places::CORNER);
        let mut sample = before as u32;
        for shots in shots.chunks(TOGETHER) {
            let inside = self.start(&mut round);
            round.now.rays.clear();
            for shots in shots.chunks(Bundle::LANES) {
                let mut streams = [shots[0].stream; Bundle::LANES];
                for (lane, (shot, stream)) in shots.iter().zip(&mut streams).enumerate() {
                    *stream = shot.stream;
                    let at = place(scene, &shot.sample, stream);
                    (places.x[lane], places.y[lane], places.lens[lane]) = at;
                }
                let rays = &mut round.now.rays;
                let seen = rays.append(shots.len(), |rays| scene.camera.rays(&places, rays));
                for (lane, stream) in streams.into_iter().enumerate().take(shots.len()) {
                    if seen >> lane & 1 != 0 {
                        self.counts.camera += 1;
                        round.begin_with_ray(Path::new(sample, (), inside, stream));
                    }
                    sample += 1;
                }
            }
            if !self.run(&mut round, cancel) {
                self.radiances.truncate(before);
                break;
            }
        }
        self.tell_alphas(before);
        *out = self.radiances;
    }
}

impl<I> Round<I> {
    /// Begins a path with its first ray.
    fn begin(&mut self, path: Path<I>, ray: Ray) {
        self.begin_with_ray(path);
        self.now.rays.push(&Query::new(ray, f64::INFINITY, None, Contacts::CROSSED));
    }

    /// Begins a path whose ray waits already.
    #[inline(always)]
    fn begin_with_ray(&mut self, path: Path<I>) {
        let slot = self.paths.len() as u32;
        self.paths.push(Path { slot, ..path });
        self.now.slots.push(slot);
    }

    /// Keeps a path that goes on for the next step; whether there is one.
    #[inline(always)]
    fn go_on(&mut self, next: Option<(Path<I>, Query)>) -> bool {
        let Some((path, query)) = next else { return false };
        let slot = path.slot;
        self.next.slots.push(slot);
        self.paths[slot as usize] = path;
        self.next.rays.push(&query);
        true
    }
}

impl<I> Default for Round<I> {
    fn default() -> Self {
        Self {
            paths: Vec::with_capacity(TOGETHER),
            now: Wave::default(),
            next: Wave::default(),
            found: Vec::with_capacity(TOGETHER / Bundle::LANES),
            matte: Matte::new(),
            sharp: Sharp::EMPTY,
            shadows: Vec::with_capacity(TOGETHER),
            tasks: Vec::with_capacity(TOGETHER),
            told: Vec::new(),
            blockers: Vec::with_capacity(TOGETHER),
            asks: Asks::new(),
            bends: Bends::new(),
            spare: Spare::default(),
            ended: Vec::new(),
        }
    }
}
