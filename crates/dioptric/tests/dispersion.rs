// SPDX-License-Identifier: MIT OR Apache-2.0
//! Glass that bends each wavelength by its own angle, against Snell, Fresnel and the colour matching functions by themselves.

#![allow(clippy::disallowed_methods)] // the standard library's functions are the other opinion

mod support;

use support::{assert_near, mean};

const SETTINGS: &str = "version(1)\nscene(colors = \"raw\")\n\
    render(size = (8, 8), integrator = \"path\", samples = 1024, bounces = 1000)\n";

/// What each lane has of a wavelength in nanometres: Wyman, Sloan and Shirley 2013, as linear sRGB without what is negative.
fn lanes(nm: f64) -> [f64; 3] {
    let lobe = |a: f64, m: f64, l: f64, r: f64| {
        a * (-0.5 * ((nm - m) / if nm < m { l } else { r }).powi(2)).exp()
    };
    let x = lobe(1.056, 599.8, 37.9, 31.0)
        + lobe(0.362, 442.0, 16.0, 26.7)
        + lobe(-0.065, 501.1, 20.4, 26.2);
    let y = lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1);
    let z = lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8);
    [
        3.2409699 * x - 1.5373832 * y - 0.4986108 * z,
        -0.9692436 * x + 1.8759675 * y + 0.0415551 * z,
        0.0556301 * x - 0.2039770 * y + 1.0569715 * z,
    ]
    .map(|c| c.max(0.0))
}

/// A ray that enters glass at 60 degrees, and what it sees one unit below: light beyond a border that long waves reach, and
/// short ones do not.
#[test]
fn each_wavelength_goes_where_snell_sends_it() {
    let (ior, abbe) = (1.6, 12.0);
    let inverse = |um: f64| 1.0 / (um * um);
    let b = (ior - 1.0) / abbe / (inverse(0.4861327) - inverse(0.6562725));
    let index = |nm: f64| ior - b * inverse(0.5875618) + b * inverse(nm / 1000.0);
    let (sin, cos) = (60_f64.to_radians().sin(), 0.5);
    let below = |n: f64| {
        let s = sin / n;
        s / (1.0 - s * s).sqrt()
    };
    for border in [470.0, 550.0, 610.0] {
        let x0 = below(index(border));
        let text = format!(
            "{SETTINGS}orthographic(eye = (-1.7320508075688772, 1, 0), look_at = (0, 0, 0), height = 1e-6)\n\
             box(min = (-50, -3, -50), max = (50, 0, 50), material = glass(ior = {ior}, dispersion = {abbe}))\n\
             rectangle(corner = ({x0}, -1, -9), edge_u = (9, 0, 0), edge_v = (0, 0, 18), material = glow(1))\n\
             rectangle(corner = ({x0}, -1, -9), edge_u = (-9, 0, 0), edge_v = (0, 0, 18), material = matte(0))"
        );
        let (mut sum, mut whole) = ([0.0; 3], [0.0; 3]);
        for i in 0..32_000 {
            let nm = 390.0 + (f64::from(i) + 0.5) * 0.01;
            let n = index(nm);
            let inner = (1.0 - (sin / n).powi(2)).sqrt();
            let s = ((cos - n * inner) / (cos + n * inner)).powi(2);
            let p = ((n * cos - inner) / (n * cos + inner)).powi(2);
            let seen = if below(n) > x0 { (1.0 - 0.5 * (s + p)) / (n * n) } else { 0.0 };
            for (lane, w) in lanes(nm).iter().enumerate() {
                sum[lane] += w * seen;
                whole[lane] += w;
            }
        }
        let expected = [0, 1, 2].map(|i| sum[i] / whole[i]);
        let got = mean(&text).0;
        assert_near(got, expected, 0.004);
        assert!(got[0] > got[2] || border > 600.0, "{got:?}");
    }
}

/// Glass adds and takes nothing, whichever way its colours go; and what does not matter for colours has none.
#[test]
fn dispersion_is_not_seen_in_a_white_space() {
    for glass in ["glass(kind = \"diamond\")", "glass(kind = \"sf11\", roughness = 0.2)"] {
        for camera in ["camera(eye = (0, 0, 5), fov = 20)", "camera(eye = (0.2, 0, 0.1), fov = 60)"]
        {
            let text = format!(
                "{SETTINGS}{camera}\nbackground(1)\nsphere(center = (0, 0, 0), radius = 1, material = {glass})"
            );
            // From within, light comes in greater by the square of the index: by about 6, or by 3.
            let got = mean(&text).0;
            if camera.contains("0.2") {
                assert!(got.iter().all(|&x| x > 2.9), "{got:?}");
                let squares = if glass.contains("diamond") { 2.4175_f64 } else { 1.78472 };
                assert!((got[1] / squares.powi(2) - 1.0).abs() < 0.02, "{got:?}");
                assert!(got[2] > got[1] && got[1] > got[0], "{got:?}");
            } else {
                assert_near(got, [1.0; 3], 0.025);
            }
        }
    }
}

/// One and the same wavelength all the way: a plate moves all colours but spreads none at infinity.
#[test]
fn plates_show_the_sky_behind_them_unchanged() {
    let sky = "background(gradient((1, 0, 0), (0, 0, 1), end = (0, 0.5, 0)))";
    let text = |thing: &str| {
        format!("{SETTINGS}camera(eye = (0, 0, 5), look_at = (0, 1, 0), fov = 1)\n{sky}\n{thing}")
    };
    let plain = mean(&text("sphere(center = (0, -99, 0), radius = 1)")).0;
    let plate = |more: &str| {
        mean(&text(&format!(
            "box(min = (-9, -9, -1), max = (9, 9, 1), material = glass(ior = 1.5{more}))"
        )))
        .0
    };
    let (grey, colourful) = (plate(""), plate(", dispersion = 20"));
    assert!(plain[0] > 0.0);
    assert_near(grey, colourful, 0.004);
}
