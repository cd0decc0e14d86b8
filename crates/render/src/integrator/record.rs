// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a recorder is told of a hit.

use serde_json::json;

use super::media::Medium;
use super::point::Point;
use super::recorder::HitRecord;
use crate::scene::Scene;

/// What a recorder wants to know of a hit.
pub(super) fn record(
    scene: &Scene,
    point: &Point,
    depth: u32,
    medium: Option<&Medium>,
) -> HitRecord {
    let mut detail = serde_json::Map::new();
    let mut put = |key: &str, value| drop(detail.insert(key.into(), value));
    if let Some(part) = scene.part_label(point.hit.id) {
        put("part", json!(part));
    }
    if let Some((s, p)) = scene.surface_and_point(&point.ray, &point.hit) {
        put("point", json!(s.point.to_array()));
        put("point_in_file", json!(p.world.to_array()));
        put("point_in_object", json!(p.object.to_array()));
        put("normal", json!(s.normal.to_array()));
        put("shading_normal", json!(point.normal.to_array()));
        put("from_outside", json!(point.outside));
        put("uv", json!(s.uv.to_array()));
    }
    put("pattern", json!(point.finish.base.to_array()));
    put("bounce", json!(depth));
    if let Some(medium) = medium {
        let object = scene.object_label(medium.object);
        let absorption = medium.absorption.to_array();
        put("medium", json!({"object": object, "ior": medium.ior, "absorption": absorption}));
    }
    HitRecord {
        object: scene.object_label(point.hit.id),
        source: scene.object_source(point.hit.id),
        t: point.hit.t,
        detail,
    }
}
