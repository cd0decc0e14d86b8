// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene that is turned, moved, scaled or mirrored as a whole gives the same picture.

use dioptric::render::job::Control;
use dioptric::render::picture::render;
use dioptric::render::region::Region;

use crate::support::scene;

const SIZE: u32 = 40;

/// All materials, a bump, combined solids, instances, a spot, tinted shadows, absorption, fog.
const SCENE: &str = r#"
camera(eye = (0.3, 2.1, 7), look_at = (0, 0.7, 0), fov = 40)
render(size = (40, 40), antialias = "none", bounces = 8, shadows = "tinted")
ambient(0.2)
background(gradient((0.2, 0.3, 0.5), (0.9, 0.9, 1), start = (0, -1, 0), end = (0.3, 1, 0.2)))
fog(distance = 60, color = (0.7, 0.6, 0.5))
medium(ior = 1.1, absorption = (0.01, 0.005, 0))
light(position = (3, 6, 5), intensity = 0.6)
spot(position = (-4, 5, 3), look_at = (0, 0.5, 0), intensity = 0.7, falloff = "none")
# Its height is in the middle of a layer of cells: at 0 rounding would tell them apart.
plane(point = (0, -0.1, 0), normal = (0, 1, 0), material = phong(checker((1, 1, 1), (0.2, 0.3, 0.4), size = 0.7, space = "world"), mirror = 0.2))
sphere(center = (-1.4, 1, 0), radius = 0.9, material = glass((0.9, 1, 0.9), ior = 1.5, absorption = (0.5, 0.1, 0.2)))
box(min = (0.2, 0.1, -0.4), max = (1.4, 1.3, 0.8), material = clear((0, 1, 0), own = 0.2, ior = 1.2), transform = rotate(y = 31))
torus(center = (0, 0.3, 2), axis = (0.2, 1, 0.1), major_radius = 0.6, minor_radius = 0.2, material = metal("gold"))
difference(box(min = (1.7, 0, -1.1), max = (3, 1.5, 0.2)), minus = [sphere(center = (1.7, 1.5, 0.2), radius = 0.6, material = mirror())],
    material = plastic("crimson"))
pair = group([
    sphere(center = (-2.6, 0.4, 1.3), radius = 0.4, material = matte(noise((1, 0, 0), (1, 1, 0), size = 0.3), bump = noise(size = 0.2), bump_height = 0.1)),
    cone(base = (-2.6, 0.8, 1.3), radius = 0.3, height = 0.5),
])
group([pair], transform = [shear(xy = 0.2), translate(by = (1.2, 0, 0.8))])
group([pair], transform = scale(by = (1, 1, -1)))
"#;

fn picture(root: &str) -> Vec<[f64; 3]> {
    let scene = scene(&format!("version(1)\nscene(transform = [{root}])\n{SCENE}"));
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let film = render(&scene, Region::full([SIZE; 2]), &threads, &Control::default());
    film.expect("there is memory").pixels().iter().map(|p| p.linear().to_array()).collect()
}

#[test]
fn a_turned_mirrored_or_scaled_root_changes_nothing() {
    let plain = picture("");
    assert!(plain.iter().flatten().all(|v| v.is_finite()));
    for root in [
        "rotate(x = 20, y = 130, z = 77)",
        "reflect(normal = (1, 0, 0))",
        "reflect(normal = (1, 2, -3)), translate(by = (5, -7, 3))",
        "rotate(z = 90), scale(by = -0.01)",
        "scale(by = 1e4), rotate(y = 200)",
    ] {
        let other = picture(root);
        let differ =
            |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-6);
        let off: Vec<usize> = (0..plain.len()).filter(|&i| differ(&plain[i], &other[i])).collect();
        println!("{root}: {} of {} pixels differ", off.len(), plain.len());
        // Rounding may put a sample on the other side of an edge.
        assert!(
            off.len() <= 2,
            "{root}: {} pixels, such as {:?}",
            off.len(),
            off.iter()
                .take(4)
                .map(|&i| (i % SIZE as usize, i / SIZE as usize, plain[i], other[i]))
                .collect::<Vec<_>>()
        );
    }
}
