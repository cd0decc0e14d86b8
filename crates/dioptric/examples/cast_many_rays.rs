// SPDX-License-Identifier: MIT OR Apache-2.0
//! Casts a batch of rays into a mesh, over the threads of a pool of the program's own.
//!
//!     cargo run --release --example cast_many_rays

use std::sync::Arc;

use dioptric::geometry::mesh::Mesh;
use dioptric::geometry::{AnyShape, Ray, WorldBuilder};
use dioptric::math::{DAffine3, DVec3};
use dioptric::meshes::{Limits, read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A tetrahedron; a file would be opened with std::fs::File.
    let file = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    let model = read("tetrahedron.obj", &mut file.as_bytes(), &Limits::default())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;

    // Trees are built, and rays are cast, by the pool in which that happens.
    let world = pool.install(|| {
        let mut world = WorldBuilder::new();
        world.object(AnyShape::Mesh(Arc::new(Mesh::new(model.mesh))), DAffine3::IDENTITY)?;
        Ok::<_, dioptric::geometry::PlacementError>(world.build())
    })?;

    // A grid of rays straight down. Directions may have any length; t is in units of it.
    let grid = |i: i32| f64::from(i) / 50.0;
    let rays: Vec<Ray> = (-60..=60)
        .flat_map(|x| (-60..=60).map(move |z| DVec3::new(grid(x), 5.0, grid(z))))
        .map(|origin| Ray::new(origin, DVec3::NEG_Y))
        .collect();
    let hits = pool.install(|| world.cast(&rays));
    let found = hits.iter().flatten().count();
    let nearest = hits.iter().flatten().map(|hit| hit.t).fold(f64::INFINITY, f64::min);
    println!("{found} of {} rays hit, the nearest at {nearest}", rays.len());
    assert_eq!((found, nearest), (101 * 101, 4.0));

    // What is hit is worked out for those hits that matter. The part is the triangle.
    let (ray, hit) = rays.iter().zip(&hits).find_map(|(r, h)| Some((r, (*h)?))).ok_or("no hit")?;
    let surface = world.surface(ray, &hit).ok_or("the hit is of this world")?;
    println!("triangle {}, normal {}, uv {}", hit.id.part, surface.normal, surface.uv);

    // Whether there is a hit at all is a cheaper question.
    assert!(pool.install(|| world.cast_any(&rays)).iter().filter(|&&any| any).count() == found);
    Ok(())
}
