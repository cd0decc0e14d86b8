// SPDX-License-Identifier: MIT OR Apache-2.0
//! Glass against formulas that have known answers: slabs, chords, Snell's law, critical angles, media within
//! media. Every test goes the whole way from a scene's text to the tree of rays that `why` shows, and the
//! sums of every tree are checked on the way.

use crate::support::{assert_near, one_ray, transmitted};
use dioptric::render::integrator::recorder::Node;

/// Shows what goes through as red and what comes back as green.
const RED_BEHIND_GREEN_BEFORE: &str = r#"
camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 1)
rectangle(corner = (-99, -99, -9), edge_u = (198, 0, 0), edge_v = (0, 198, 0), material = glow((1, 0, 0)))
rectangle(corner = (-99, -99, 9), edge_u = (198, 0, 0), edge_v = (0, 198, 0), material = glow((0, 1, 0)))
"#;

/// Pairs of indices at the interfaces along the transmitted rays.
fn interfaces(ray: &Node) -> Vec<[f64; 2]> {
    transmitted(ray)
        .iter()
        .filter_map(|n| n.detail.get("fresnel"))
        .map(|f| ["ior_from", "ior_to"].map(|key| f[key].as_f64().unwrap()))
        .collect()
}

#[test]
fn a_slab_reflects_and_transmits_as_the_series_says() {
    let slab =
        "box(min = (-50, -50, -1), max = (50, 50, 0), material = glass(ior = 1.5, specular = 0))";
    let r: f64 = 0.04; // ((1.5 - 1) / (1.5 + 1))^2
    let t = 1.0 - r;
    for bounces in [0, 1, 2, 3, 4, 5, 6, 7, 40] {
        let got = one_ray(bounces, &format!("{RED_BEHIND_GREEN_BEFORE}\n{slab}"));
        // A path of n surfaces needs n bounces.
        let through: f64 = (0..)
            .map(|k| 2 * k)
            .take_while(|k| k + 2 <= bounces)
            .map(|k| t * t * r.powi(k as i32))
            .sum();
        let inner = (0..).map(|k| 2 * k + 1).take_while(|k| k + 2 <= bounces);
        let back: f64 = inner.map(|k| t * t * r.powi(k as i32)).sum();
        let back = if bounces > 0 { r + back } else { 0.0 };
        assert_near(got.value, [through, back, 0.0], 1e-12);
        if bounces == 40 {
            assert_near(got.value, [(1.0 - r) / (1.0 + r), 2.0 * r / (1.0 + r), 0.0], 1e-12);
        }
    }
}

#[test]
fn a_pane_without_thickness_is_a_thin_slab_from_both_sides() {
    let r: f64 = 0.04;
    let (through, back) = ((1.0 - r) / (1.0 + r), 2.0 * r / (1.0 + r));
    // The edges' order decides which side the normal is on; a pane has two outsides.
    for edges in
        ["edge_u = (9, 0, 0), edge_v = (0, 9, 0)", "edge_u = (0, 9, 0), edge_v = (9, 0, 0)"]
    {
        let glass = format!(
            "rectangle(corner = (-4, -4, 0), {edges}, material = glass((0.5, 1, 1), reflection = (1, 0.5, 1), specular = 0))"
        );
        let got = one_ray(5, &format!("{RED_BEHIND_GREEN_BEFORE}\n{glass}"));
        assert_near(got.value, [0.5 * through, 0.5 * back, 0.0], 1e-12);
        let clear = format!(
            "ambient(1)\nrectangle(corner = (-4, -4, 0), {edges}, \
             material = clear((0, 0, 1), own = 0.25, tint = (0.5, 1, 1), ior = 1.5, specular = 0))"
        );
        let got = one_ray(5, &format!("{RED_BEHIND_GREEN_BEFORE}\n{clear}"));
        assert_near(got.value, [0.75 * 0.5, 0.0, 0.25], 1e-12);
        assert_eq!(transmitted(&got)[1].direction, [0.0, 0.0, -1.0]);
    }
    // In water a pane of water is nothing at all.
    let water = "medium(ior = 1.33)\nrectangle(corner = (-4, -4, 0), edge_u = (9, 0, 0), edge_v = (0, 9, 0), \
                 material = glass(ior = 1.33, specular = 0))";
    assert_near(
        one_ray(5, &format!("{RED_BEHIND_GREEN_BEFORE}\n{water}")).value,
        [1.0, 0.0, 0.0],
        1e-12,
    );
}

#[test]
fn light_fades_by_the_way_through() {
    let absorption = [0.5, 0.125, 0.0];
    // Along the chord of a ball at distance 0.6 from its middle: 1.6 long, in units of the file.
    for (x, chord) in [(0.0, 2.0), (0.6, 1.6)] {
        for (material, tint) in [
            ("glass((0.5, 1, 1), ior = 1, specular = 0, ABSORB)", 0.5),
            ("clear(own = 0, ior = 1, tint = (0.5, 1, 1), ABSORB)", 0.5),
        ] {
            for root in ["1", "1e-3", "1e6"] {
                let material = material.replace("ABSORB", "absorption = (0.5, 0.125, 0)");
                let got = one_ray(
                    5,
                    &format!(
                        "camera(eye = ({x}, 0, 5), look_at = ({x}, 0, 0), fov = 1)\nbackground(1)\n\
                         sphere(center = (0, 0, 0), radius = 1, material = {material})",
                    )
                    .replace("camera", &format!("k = {root}\ncamera")),
                );
                let left = absorption.map(|a: f64| (-a * chord).exp());
                assert_near(got.value, [tint * left[0], left[1], left[2]], 1e-9);
            }
        }
    }
    let scaled = crate::support::scene(
        "version(1)\nscene(colors = \"raw\", transform = scale(by = (1e3, 1e3, 1e3)))\n\
         render(size = (1, 1), antialias = \"none\")\nbackground(1)\n\
         camera(eye = (0.6, 0, 5), look_at = (0.6, 0, 0), fov = 1)\n\
         sphere(radius = 1, material = glass(ior = 1, specular = 0, absorption = (0.5, 0.125, 0)))",
    );
    let ray = crate::support::pixel(&scaled, 0, 0).samples[0].ray.clone().unwrap();
    assert_near(ray.value, absorption.map(|a: f64| (-a * 1.6).exp()), 1e-9);
}

#[test]
fn absorption_follows_inner_reflections_and_what_is_inside() {
    // A camera inside of an absorbing block sees a wall in it at distance 3, and the block's far end.
    let text = |wall: &str| {
        format!(
            "camera(eye = (0, 0, 0), look_at = (0, 0, -1), fov = 1)\nbackground(1)\n{wall}\n\
             box(min = (-50, -50, -10), max = (50, 50, 10), material = MATERIAL)"
        )
    };
    let wall = "rectangle(corner = (-1, -1, -3), edge_u = (2, 0, 0), edge_v = (0, 2, 0), material = glow(1))";
    for (material, surface) in [
        ("glass(ior = 1.5, specular = 0, absorption = 0.25)", 0.96),
        ("clear(own = 0.5, ior = 1.5, absorption = 0.25)", 1.0),
    ] {
        let with = |wall: &str| one_ray(1, &text(wall).replace("MATERIAL", material));
        assert_near(with(wall).value, [(-0.75_f64).exp(); 3], 1e-12);
        // Bounce 1 is the exit; what is reflected there is cut off.
        assert_near(with("").value, [surface * (-2.5_f64).exp(); 3], 1e-12);
        // Fog is outside only.
        let fog = "fog(color = 0, distance = 1)";
        assert_near(with(&format!("{wall}\n{fog}")).value, [(-0.75_f64).exp(); 3], 1e-12);
    }
}

#[test]
fn a_plate_displaces_a_ray_as_snell_says() {
    let inside = (0.5_f64.sqrt() / 1.5).asin();
    for material in ["glass(ior = 1.5, specular = 0)", "clear(own = 0.2, ior = 1.5)"] {
        let got = one_ray(
            4,
            &format!(
                "camera(eye = (5, 0, 5), look_at = (0, 0, 0), fov = 1)\n\
                 box(min = (-50, -50, -1), max = (50, 50, 0), material = {material})\n\
                 plane(point = (0, 0, -3), normal = (0, 0, 1), name = \"wall\", \
                 material = glow(stripes((1, 0, 0), (0, 1, 0), size = 0.5)))"
            ),
        );
        let wall = *transmitted(&got).last().unwrap();
        assert_eq!(wall.object.as_deref(), Some("wall"));
        let point: Vec<f64> =
            wall.detail["point"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let x = -inside.tan() - 2.0;
        assert_near([point[0], point[1], point[2]], [x, 0.0, -3.0], 1e-12);
        assert_near(wall.direction, [-(0.5_f64.sqrt()), 0.0, -(0.5_f64.sqrt())], 1e-12);
        let stripe = if (x / 0.5).floor().rem_euclid(2.0) == 0.0 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        assert_near(wall.value, stripe, 0.0);
    }
}

/// A ray that leaves towards the face z = 0 at an angle in degrees, from z = -2.
fn at_angle(degrees: f64, from: f64) -> String {
    let (s, c) = degrees.to_radians().sin_cos();
    format!(
        "camera(eye = (0, 0, {from}), look_at = ({s}, 0, {}), fov = 1)\nbackground(1)\n",
        from + c
    )
}

#[test]
fn the_critical_angle_from_within_and_from_without() {
    let critical = (1.0_f64 / 1.5).asin().to_degrees();
    let block =
        "box(min = (-50, -50, -9), max = (50, 50, 0), material = glass(ior = 1.5, specular = 0))";
    let gap = "medium(ior = 1.5)\nbox(min = (-50, -50, 0), max = (50, 50, 9), material = glass(ior = 1, specular = 0))";
    for text in [block, gap] {
        for (off, total) in [(-1e-6, false), (1e-6, true)] {
            let got = one_ray(1, &format!("{}{text}", at_angle(critical + off, -2.0)));
            let fresnel = &got.detail["fresnel"];
            assert_eq!(fresnel["ior_from"], 1.5, "{text}");
            assert_eq!(fresnel["total_internal_reflection"], total, "{text} {off}");
            let reflected = fresnel["reflected"].as_f64().unwrap();
            assert!(if total { reflected == 1.0 } else { reflected > 0.99 && reflected < 1.0 });
        }
    }
    // By shares: from inside it is followed to the next face, from outside it is mirrored.
    let critical = 0.8_f64.asin().to_degrees();
    for (off, total) in [(-1e-6, false), (1e-6, true)] {
        let thin =
            "box(min = (-50, -50, 0), max = (50, 50, 9), material = clear(own = 0, ior = 0.8))";
        let got = one_ray(1, &format!("{}{thin}", at_angle(critical + off, -2.0)));
        assert_eq!(got.detail.contains_key("total_external_reflection"), total);
        let z = transmitted(&got)[1].direction[2];
        assert!(if total { z < 0.0 } else { z > 0.0 });
        assert_near(got.value, [1.0; 3], 1e-12);
    }
}

#[test]
fn media_within_media() {
    let ray = |text: &str| {
        let text =
            format!("camera(eye = (0, 0, 9), look_at = (0, 0, 0), fov = 1)\nbackground(1)\n{text}");
        interfaces(&one_ray(8, &text))
    };
    let ball = "sphere(radius = 1, material = glass(ior = 1.5))";
    let water = "box(min = (-3, -3, -3), max = (3, 3, 3), material = glass(ior = 1.33))";
    let bubble = "box(min = (-3, -3, -3), max = (3, 3, 3), material = glass(ior = 1.5))\n\
                  sphere(radius = 1, material = glass(ior = 1))";
    assert_eq!(ray(ball), [[1.0, 1.5], [1.5, 1.0]]);
    assert_eq!(ray(&format!("medium(ior = 1.33)\n{ball}")), [[1.33, 1.5], [1.5, 1.33]]);
    let nested = [[1.0, 1.33], [1.33, 1.5], [1.5, 1.33], [1.33, 1.0]];
    assert_eq!(ray(&format!("{water}\n{ball}")), nested);
    assert_eq!(ray(&format!("{ball}\n{water}")), nested);
    assert_eq!(ray(bubble), [[1.0, 1.5], [1.5, 1.0], [1.0, 1.5], [1.5, 1.0]]);
    // What overlaps is what was entered last; what is left then is no interface.
    let overlap = "box(min = (-3, -3, -2), max = (3, 3, 0), material = glass(ior = 1.5))\n\
                   box(min = (-3, -3, -3), max = (3, 3, -1), material = glass(ior = 1.33))";
    assert_eq!(ray(overlap), [[1.0, 1.5], [1.5, 1.33], [1.33, 1.33], [1.33, 1.0]]);
    // A glass ball in something clear of relative index 1.2 in water.
    let in_clear = format!(
        "medium(ior = 1.5)\nbox(min = (-3, -3, -3), max = (3, 3, 3), material = clear(own = 0, ior = 1.2))\n{ball}"
    );
    assert_eq!(ray(&in_clear), [[1.5 * 1.2, 1.5], [1.5, 1.5 * 1.2]]);
}

#[test]
fn the_camera_may_be_in_water_with_a_ball() {
    let text = "camera(eye = (0, 0, 2), look_at = (0, 0, 0), fov = 1)\nbackground(1)\n\
                sphere(radius = 1, material = glass(ior = 1.5, specular = 0))\n\
                box(min = (-3, -3, -3), max = (3, 3, 3), material = glass(ior = 1.33, specular = 0, absorption = 0.5))";
    let ray = one_ray(8, text);
    assert_eq!(interfaces(&ray), [[1.33, 1.5], [1.5, 1.33], [1.33, 1.0]]);
    assert_eq!(ray.detail["medium"]["ior"], 1.33);
    // One unit of water before the ball and two behind it.
    let through = transmitted(&ray);
    let left =
        |n: &Node| n.detail.get("absorption").map(|a| a["transmittance"][0].as_f64().unwrap());
    assert_near([left(through[0]).unwrap(), 0.0, 0.0], [(-0.5_f64).exp(), 0.0, 0.0], 1e-12);
    assert_eq!(left(through[1]), None);
    assert_near([left(through[2]).unwrap(), 0.0, 0.0], [(-1.0_f64).exp(), 0.0, 0.0], 1e-12);
}

#[test]
fn mirror_images_of_glass_are_glass() {
    let at = |transform: &str| {
        one_ray(
            8,
            &format!(
                "camera(eye = (0.5, 0.3, 9), look_at = (0.5, 0.3, 0), fov = 1)\n\
                 background(gradient((1, 0, 0), (0, 1, 0), start = (-1, -1, -1), end = (1, 1, 1)))\n\
                 difference(sphere(radius = 1), minus = [sphere(center = (0, 0, 1), radius = 0.7)], \
                 material = glass(ior = 1.5){transform})"
            ),
        )
        .value
    };
    let plain = at("");
    for same in [
        "scale(by = (-1, 1, 1))",
        "scale(by = (1, -1, 1))",
        "reflect(normal = (1, 0, 0))",
        "rotate(z = 77)",
    ] {
        assert_near(at(&format!(", transform = {same}")), plain, 1e-9);
    }
}
