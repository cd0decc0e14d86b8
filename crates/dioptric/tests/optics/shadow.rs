// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light on its way to a surface: tinted shadows, lights with a size, and things that touch.

use crate::support::{assert_near, one_ray, render_setting, transmitted};
use dioptric::render::integrator::recorder::Node;
use serde_json::Value;

/// Looks down from the side at the origin of a white floor; a light stands straight above.
const FLOOR: &str = r#"
camera(eye = (0, 0.5, 5), look_at = (0, 0, 0), fov = 0.1)
plane(point = (0, 0, 0), normal = (0, 1, 0), material = matte(1), name = "floor")
"#;
const ABOVE: &str = "light(position = (0, 100, 0), intensity = 1)";

fn tinted(text: &str) -> Node {
    render_setting("bounces = 4, shadows = \"tinted\"", &format!("{FLOOR}\n{ABOVE}\n{text}"))
}

fn slab(low: f64, high: f64, material: &str) -> String {
    format!("box(min = (-3, {low}, -3), max = (3, {high}, 3), material = {material})\n")
}

fn blockers(node: &Node) -> Vec<Value> {
    let term = node.terms.iter().find(|t| t.name == "diffuse").expect("a diffuse term");
    term.detail["blockers"].as_array().unwrap().clone()
}

#[test]
fn tinted_shadows_are_products() {
    let jelly =
        slab(3.0, 4.5, "clear(own = 0.5, tint = (1, 0.5, 0.25), absorption = (0, 0.25, 0.5))");
    let glass = slab(6.0, 8.0, "glass((0.5, 1, 1), ior = 1.5, absorption = 0.125)");
    let expected_jelly = [0.5, 0.25 * (-0.375_f64).exp(), 0.125 * (-0.75_f64).exp()];
    let g = 0.96 * 0.96 * (-0.25_f64).exp();
    let expected_glass = [0.5 * g, g, g];
    let both = [0, 1, 2].map(|i| expected_jelly[i] * expected_glass[i]);
    for order in [format!("{jelly}{glass}"), format!("{glass}{jelly}")] {
        let node = tinted(&order);
        assert_near(node.value, both, 1e-12);
        // Each object is told once, nearest first, with all that it takes.
        let told = blockers(&node);
        assert_eq!(told.len(), 2);
        let passes = |i: usize| [0, 1, 2].map(|k| told[i]["passes"][k].as_f64().unwrap());
        assert_near(passes(0), expected_jelly, 1e-12);
        assert_near(passes(1), expected_glass, 1e-12);
        assert_eq!(told[0]["t"], 3.0);
    }
    let wall = slab(1.0, 2.0, "matte(1)");
    let node = tinted(&format!("{jelly}{wall}"));
    assert_near(node.value, [0.0; 3], 0.0);
    assert_eq!(blockers(&node).len(), 2, "what lies behind an opaque thing is told too");
    let opaque = one_ray(4, &format!("{FLOOR}\n{ABOVE}\n{jelly}"));
    assert_near(opaque.value, [0.0; 3], 0.0);
    let none =
        render_setting("bounces = 4, shadows = \"none\"", &format!("{FLOOR}\n{ABOVE}\n{wall}"));
    assert_near(none.value, [1.0; 3], 1e-12);
    assert!(blockers(&none).is_empty());
}

#[test]
fn a_shadow_ray_that_starts_inside_pays_for_the_rest_of_the_way() {
    // The floor is in the middle of a block of jelly, and the camera is in it too.
    let block = "box(min = (-9, -3, -9), max = (9, 2, 9), material = clear(own = 0.5, ior = 1, absorption = 0.25))";
    let expected = 0.5 * (-0.5_f64).exp();
    let node = tinted(block);
    assert_near(
        [blockers(&node)[0]["passes"][0].as_f64().unwrap(), 0.0, 0.0],
        [expected, 0.0, 0.0],
        1e-12,
    );
    let way = (25.25_f64).sqrt();
    assert_near(node.value, [expected * (-0.25 * way).exp(); 3], 1e-12);
}

#[test]
fn open_panes_count_each_time_from_either_side() {
    for edges in
        ["edge_u = (6, 0, 0), edge_v = (0, 0, 6)", "edge_u = (0, 0, 6), edge_v = (6, 0, 0)"]
    {
        let pane = |y: f64| {
            format!(
                "rectangle(corner = (-3, {y}, -3), {edges}, material = clear(own = 0.5, absorption = 9, tint = (1, 0.5, 0)))\n"
            )
        };
        assert_near(tinted(&pane(2.0)).value, [0.5, 0.25, 0.0], 1e-12);
        assert_near(tinted(&(pane(2.0) + &pane(3.0))).value, [0.25, 0.0625, 0.0], 1e-12);
    }
    // An open cylinder is crossed twice, from within out and from without in.
    let tube = "cylinder(base = (-3, 3, 0), top = (3, 3, 0), radius = 1, open = True, material = clear(own = 0.5))";
    assert_near(tinted(tube).value, [0.25; 3], 1e-12);
}

#[test]
fn lights_with_a_size_light_as_their_form_factors_say() {
    // A square panel of side 2, two above the floor. Configuration factor of a differential element to a
    // parallel rectangle over its corner (Howell, "A Catalog of Radiation Heat Transfer Configuration
    // Factors", B-3), four times.
    let panel = "area_light(corner = (-1, 2, -1), edge_u = (2, 0, 0), edge_v = (0, 0, 2), intensity = 1, \
                 falloff = \"square\", emits = \"front\", samples = 4096)";
    let (x, p): (f64, f64) = (0.5, 1.25_f64.sqrt());
    let factor = 4.0 * (2.0 * x / p * (x / p).atan()) / (2.0 * std::f64::consts::PI);
    let expected = std::f64::consts::PI * factor / 4.0;
    let node = one_ray(0, &format!("{FLOOR}\n{panel}"));
    assert_near(node.value, [expected; 3], 2e-3 * expected);
    // Something that hides exactly one half of it takes one half of its light.
    let half = "box(min = (0, 1.9, -5), max = (5, 1.99, 5))";
    let node = one_ray(0, &format!("{FLOOR}\n{panel}\n{half}"));
    assert_near(node.value, [0.5 * expected; 3], 3e-3 * expected);
    let term = node.terms.iter().find(|t| t.name == "diffuse").unwrap();
    let (told, rays) =
        (term.detail["visibility"][0].as_f64().unwrap(), &term.detail["blockers"][0]["rays"]);
    assert!((told - 0.5).abs() < 2e-3 && (rays.as_f64().unwrap() - 2048.0).abs() < 9.0, "{term:?}");
    assert_eq!(term.detail["blockers"].as_array().unwrap().len(), 1);
}

#[test]
fn a_small_ball_of_light_is_a_point() {
    let at = |radius: f64, falloff: &str| {
        one_ray(
            0,
            &format!(
                "{FLOOR}\nlight(position = (3, 4, 0), intensity = 2, radius = {radius}, falloff = \"{falloff}\", samples = 64)"
            ),
        )
        .value
    };
    for (falloff, strength) in [("none", 2.0), ("square", 2.0 / 25.0)] {
        assert_near(at(0.0, falloff), [0.8 * strength; 3], 1e-12);
        assert_near(at(1e-6, falloff), [0.8 * strength; 3], 1e-6);
        // Above the horizon a ball of any size gives the same (its vector irradiance is the point's).
        assert_near(at(1.0, falloff), [0.8 * strength; 3], 2e-3 * strength);
    }
}

#[test]
fn a_poster_on_a_wall_is_not_in_the_walls_shadow() {
    for wall in [
        "box(min = (-9, -9, -1), max = (9, 9, 0), material = matte(0.5))",
        "plane(point = (0, 0, 0), normal = (0, 0, 1), material = matte(0.5))",
        "plane(point = (0, 0, 0), normal = (0, 0, -1), material = matte(0.5))",
    ] {
        for (poster, expected) in
            [("matte((1, 0, 0))", [0.8, 0.0, 0.0]), ("mirror(1)", [0.0, 0.0, 1.0])]
        {
            let node = one_ray(
                2,
                &format!(
                    "camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 1)\nlight(position = (3, 0, 4))\n\
                     background((0, 0, 1))\n\
                     disc(center = (0, 0, 0), normal = (0, 0, 1), radius = 1, material = {poster}, name = \"poster\")\n{wall}"
                ),
            );
            assert_eq!(node.object.as_deref(), Some("poster"));
            assert_near(node.value, expected, 1e-12);
        }
    }
}

#[test]
fn total_reflection_in_glass_on_a_table_does_not_see_the_table() {
    for table in [
        "box(min = (-90, -9, -90), max = (90, 0, 90), material = glow((1, 0, 0)))",
        "plane(point = (0, 0, 0), normal = (0, 1, 0), material = glow((1, 0, 0)))",
        // A room: its floor is the inner side of a box.
        "box(min = (-90, 0, -90), max = (90, 90, 90), material = glow((1, 0, 0)))",
    ] {
        for material in ["glass(ior = 1.5, specular = 0)", "clear(own = 0, ior = 1.5)"] {
            // In through the left face at 45 degrees, down to the bottom at 62 degrees: beyond the critical angle.
            let node = one_ray(
                9,
                &format!(
                    "camera(eye = (-2, 3.2, 0), look_at = (-1, 2.2, 0), fov = 0.1)\n\
                     box(min = (-1, 0, -9), max = (30, 9, 9), material = {material})\n{table}"
                ),
            );
            let inner: Vec<String> = if material.starts_with("glass") {
                let corner = transmitted(&node)[1];
                assert_eq!(corner.detail["fresnel"]["total_internal_reflection"], true);
                vec![corner.children[0].ray.object.clone().unwrap_or_default()]
            } else {
                let corners = node.detail["passage"]["corners"].as_array().unwrap();
                assert_eq!(corners[0]["event"], "total internal reflection");
                assert!(corners.len() > 1, "{table}: {corners:?}");
                vec![]
            };
            assert!(inner.iter().all(|o| o.starts_with("box")), "{table} {inner:?}");
            // And straight down it is seen: through the bottom, at no distance.
            let node = one_ray(
                9,
                &format!(
                    "camera(eye = (3, 20, 0), look_at = (3, 0, 0), up = (0, 0, 1), fov = 0.1)\n\
                     box(min = (-1, 0, -9), max = (30, 9, 9), material = {material})\n{table}"
                ),
            );
            assert!(
                transmitted(&node).last().unwrap().value == [1.0, 0.0, 0.0],
                "{table} {material}"
            );
        }
    }
}

#[test]
fn what_is_in_the_second_of_two_blocks_that_touch_is_seen() {
    for material in ["glass(ior = 1.5, specular = 0)", "clear(own = 0, ior = 1.2)"] {
        for (first, second) in [(-1.0, 0.1), (0.1, -1.0)] {
            let block = |x: f64| {
                let (low, high) = if x < 0.0 { (-3.0, 0.1) } else { (0.1, 4.0) };
                format!("box(min = ({low}, -2, -2), max = ({high}, 2, 2), material = {material})\n")
            };
            let node = one_ray(
                9,
                &format!(
                    "camera(eye = (-9, 0.3, 0.2), look_at = (0, 0.3, 0.2), fov = 0.1)\n{}{}\
                     sphere(center = (2, 0.3, 0.2), radius = 0.5, material = glow((0, 1, 0)), name = \"ball\")",
                    block(first),
                    block(second),
                ),
            );
            let last = *transmitted(&node).last().unwrap();
            assert_eq!(last.object.as_deref(), Some("ball"), "{material}");
        }
    }
}
