// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views that show what the renderer knows instead of light: normals, depth, uv, objects, materials,
//! the cost of the hierarchy, rays per sample, and a quick preview lit from the eye.

use std::sync::atomic::AtomicBool;

use dioptric_geometry::bvh::Count;
use dioptric_geometry::world::Query;
use dioptric_geometry::{Contacts, Ray};
use dioptric_math::Spectrum;
use dioptric_math::random::{mix, unit};
use serde_json::json;

use super::point::Point;
use super::record::record;
use super::recorder::{RayKind, Recorder, Silent};
use super::whitted::Whitted;
use crate::film::{FirstHit, Radiance};
use crate::sampling::stream::Stream;
use crate::scene::Scene;
use crate::setting::render::Integrator;
use crate::stats::RayCounts;

/// Box tests that the cost view shows as white.
const COSTLY_VISITS: f64 = 200.0;
/// Rays of one sample that the rays view shows as white.
const MANY_RAYS: f64 = 100.0;

/// The value of one camera ray in a view.
pub fn radiance<R: Recorder>(
    kind: Integrator,
    scene: &Scene,
    ray: &Ray,
    stream: Stream,
    counts: &mut RayCounts,
    recorder: &mut R,
) -> Radiance {
    if kind == Integrator::Rays {
        return rays_view(scene, ray, stream, counts, recorder);
    }
    counts.camera += 1;
    let id = recorder.begin(None, RayKind::Camera, ray);
    let mut visits = Count::default();
    let found = scene.world.closest_counted(ray, f64::INFINITY, None, &mut visits);
    let found = found.and_then(|hit| {
        let shading = scene.shading(ray, &hit)?;
        let query = || Query::new(*ray, f64::INFINITY, None, Contacts::CROSSED);
        let (hit, shading) = if shading.finish.present {
            (hit, shading)
        } else {
            scene.behind_hole(&query(), &hit)?
        };
        Some(Point::new(ray, hit, shading, None))
    });
    let mut first = FirstHit::NONE;
    let mut color = Spectrum::ZERO;
    if let Some(point) = &found {
        first = point.first_hit(scene);
        recorder.hit(id, || record(scene, point, 0, None));
        color = surface_view(kind, scene, point);
    }
    if kind == Integrator::Cost {
        color = Spectrum::splat(visits.boxes as f64 / COSTLY_VISITS);
    }
    recorder.term(id, kind.name(), color, || (None, json!({})));
    recorder.end(id, Spectrum::ONE, color);
    Radiance { color, alpha: if found.is_some() { 1.0 } else { 0.0 }, first }
}

fn surface_view(kind: Integrator, scene: &Scene, point: &Point) -> Spectrum {
    let (hit, surface) = (&point.hit, &point.surface);
    match kind {
        Integrator::Normals => surface.shading_normal * 0.5 + 0.5,
        // In units of the file; the develop settings bring it into view.
        Integrator::Depth => Spectrum::splat(hit.t / scene.root.scale()),
        Integrator::Uv => scene
            .world
            .surface(&point.ray, hit)
            .map_or(Spectrum::ZERO, |s| Spectrum::new(fraction(s.uv.x), fraction(s.uv.y), 0.0)),
        Integrator::Object => label_color(u64::from(scene.layer_id(hit.id))),
        Integrator::Material => label_color(scene.material_index(hit.id) as u64 ^ 0x5eed),
        // Bright where the surface faces the eye, with a floor so that edges stay readable.
        Integrator::Eyelight => {
            let cos = -point.normal.dot(point.ray.direction);
            point.finish.base * (0.1 + 0.9 * cos)
        }
        Integrator::Cost | Integrator::Rays | Integrator::Whitted | Integrator::Path => {
            Spectrum::ZERO
        }
    }
}

/// How many rays the Whitted integrator casts for this sample.
fn rays_view<R: Recorder>(
    scene: &Scene,
    ray: &Ray,
    stream: Stream,
    counts: &mut RayCounts,
    recorder: &mut R,
) -> Radiance {
    let mut own = RayCounts::default();
    let mut silent = Silent;
    let whitted = Whitted::new(scene, &mut own, &mut silent);
    let light = whitted.radiances(std::iter::once(Some((*ray, stream))), &AtomicBool::new(false));
    counts.add(&own);
    let color = Spectrum::splat(own.total() as f64 / MANY_RAYS);
    let id = recorder.begin(None, RayKind::Camera, ray);
    recorder.term(id, Integrator::Rays.name(), color, || (None, json!({"rays": own.total()})));
    recorder.end(id, Spectrum::ONE, color);
    light.first().map_or(Radiance::NOTHING, |light| Radiance { color, ..*light })
}

fn fraction(x: f64) -> f64 {
    if (0.0..=1.0).contains(&x) { x } else { x - x.floor() }
}

/// A clear colour for a number: neighbours look different.
fn label_color(key: u64) -> Spectrum {
    let bits = mix(key);
    let lane = |salt| 0.15 + 0.85 * unit(mix(bits ^ salt));
    Spectrum::new(lane(1), lane(2), lane(3))
}
