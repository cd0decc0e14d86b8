// SPDX-License-Identifier: MIT OR Apache-2.0
//! Builds a scene in code and renders it to memory: no file is read or written.
//!
//!     cargo run --example render_to_memory

use dioptric::SceneBuilder;
use dioptric::render::job::Control;
use dioptric::render::picture;
use dioptric::render::region::Region;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Kinds and arguments are the words of the scene language; a mistake is an error with a remedy.
    let mut scene = SceneBuilder::new();
    scene.add("render", &[("size", [160.0, 120.0].into()), ("samples", 4.0.into())])?;
    scene.add("camera", &[("eye", [0.0, 2.0, 8.0].into()), ("look_at", [0.0, 1.0, 0.0].into())])?;
    scene.add("light", &[("position", [5.0, 8.0, 5.0].into())])?;
    scene.add("ambient", &[("intensity", 0.1.into())])?;
    scene.add("background", &[("color", "skyblue".into())])?;
    let squares = scene.make("checker", &[("even", "white".into()), ("odd", "navy".into())])?;
    let floor = scene.make("matte", &[("color", squares.into())])?;
    scene.add("plane", &[("point", [0.0; 3].into()), ("material", floor.into())])?;
    let gold = scene.make("metal", &[("metal", "gold".into())])?;
    for i in 0..5 {
        let center = [1.5 * f64::from(i) - 3.0, 0.7, 0.0];
        let args = [("center", center.into()), ("radius", 0.7.into()), ("material", gold.into())];
        scene.add("sphere", &args)?;
    }
    let scene = scene.compile()?;

    // The threads are the caller's; the picture is the same for any number of them.
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let film =
        picture::render(&scene, Region::full(scene.settings.size), &pool, &Control::default())
            .map_err(|e| e.message)?;

    let middle = film.pixel(80, 60).ok_or("the picture has a middle")?;
    println!("{} rays; light in the middle: {:?}", film.rays.total(), middle.linear().to_array());
    println!("shown as {:?}", scene.develop.to_u8(middle.linear().to_array().map(|c| c as f32)));
    assert!(film.finished());
    Ok(())
}
