// SPDX-License-Identifier: MIT OR Apache-2.0
//! Casts a ray into a scene, and asks a pixel why it has its colour.
//!
//!     cargo run --example cast_a_ray

use dioptric::SceneBuilder;
use dioptric::geometry::Ray;
use dioptric::math::DVec3;
use dioptric::render::why;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = SceneBuilder::new();
    scene.add("render", &[("size", [64.0, 64.0].into()), ("antialias", "none".into())])?;
    scene.add("camera", &[("eye", [0.0, 0.0, 5.0].into())])?;
    scene.add("light", &[("position", [3.0, 4.0, 5.0].into()), ("name", "lamp".into())])?;
    scene.add("sphere", &[("radius", 1.0.into()), ("name", "ball".into())])?;
    let scene = scene.compile()?;

    // Distances are in units of the ray's direction.
    let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::new(0.0, 0.0, -1.0));
    let hit = scene.world.closest(&ray, f64::INFINITY, None).ok_or("the ray hits the ball")?;
    let surface = scene.world.surface(&ray, &hit).ok_or("and what is hit has a surface")?;
    println!("{} at t {}, normal {}", scene.object_label(hit.id), hit.t, surface.normal);
    assert_eq!((hit.t, surface.normal), (4.0, DVec3::Z));

    let pixel = why::explain(&scene, 32, 32).ok_or("the pixel is inside the picture")?;
    println!("pixel 32,32 is {:?}, because:", pixel.rgb8);
    for term in pixel.samples.iter().filter_map(|s| s.ray.as_ref()).flat_map(|ray| &ray.terms) {
        println!("  {} of {}: {:?}", term.name, term.light.as_deref().unwrap_or("all"), term.value);
    }
    Ok(())
}
