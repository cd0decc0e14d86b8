// SPDX-License-Identifier: MIT OR Apache-2.0
//! A window, a softbox: a flat light with four corners.

use dioptric_math::DVec3;
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::panel::{EMITS, Panel};
use super::shared::{COLOR, FALLOFF, INTENSITY, SAMPLES};
use super::{Light, LightPass, LightPlace, LightSample, LightView};
use crate::build::Builder;
use crate::setting::root::Root;

/// A parallelogram that shines.
#[derive(Clone, Debug)]
pub struct Area {
    panel: Panel,
}

static SCHEMA: Schema = Schema {
    kind: "area_light",
    category: Category::Light,
    summary: "a flat light with four corners, such as a window: soft shadows",
    doc: "Each point lit takes `samples` points of the parallelogram, uniform over its area; `intensity` is shared\n\
          among them, so that a small one does what `light` does, and a large one is not brighter. Its front is\n\
          where `edge_u` turns to `edge_v` anticlockwise. The parallelogram itself is not seen and casts no\n\
          shadow: put a `rectangle` with a `glow` behind it. (Cook, Porter and Carpenter, \"Distributed Ray\n\
          Tracing\", SIGGRAPH 1984.)",
    params: &[
        Param::required("corner", Type::Vec3, "One of its corners."),
        Param::required("edge_u", Type::Direction, "From that corner to the next."),
        Param::required("edge_v", Type::Direction, "From that corner to the one before."),
        INTENSITY,
        COLOR,
        FALLOFF,
        EMITS,
        SAMPLES,
    ],
    example: "area_light(corner = (-3, 4, 0), edge_u = (2, 0, 0), edge_v = (0, 0, 2), intensity = 0.9)",
};

impl Area {
    /// Its corner and edges in the space of rays, if it shines by the cosine, as a surface does.
    #[must_use]
    pub fn surface(&self) -> Option<(DVec3, [DVec3; 2])> {
        self.panel.surface()
    }
}

impl Light for Area {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        let corner = args.vec3("corner")?.into();
        let edges = [args.vec3("edge_u")?.into(), args.vec3("edge_v")?.into()];
        let panel = Panel::from_args(args, builder, root, corner, edges)?.ok_or_else(|| {
            args.error("edge_v", "degenerate-light", "edge_v of area_light: it points along edge_u")
                .help("write two edges that span an area")
        })?;
        Ok(Self { panel })
    }

    fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample> {
        self.panel.sample(point, u)
    }

    fn samples(&self) -> u32 {
        self.panel.samples
    }

    fn is_sharp(&self) -> bool {
        false
    }

    fn pass(&self, origin: DVec3, direction: DVec3) -> Option<LightPass> {
        self.panel.pass(origin, direction, 1.0, |p| p.iter().all(|x| (0.0..=1.0).contains(x)))
    }

    fn view(&self, point: DVec3) -> Option<LightView> {
        self.panel.view(point, 0.5, 0.5)
    }

    fn place(&self) -> Option<LightPlace> {
        self.panel.place(0.5, 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::point::Point;
    use crate::light::testing::{build, grid};
    use crate::setting::testing::{plain_root, scaled_root};
    use dioptric_math::DAffine3;
    use dioptric_scene::Value;

    fn window(size: f64, more: &[(&'static str, Value)], root: &Root) -> Area {
        let h = 0.5 * size;
        let mut arguments = vec![
            ("corner", Value::Vec3([-h, 4.0, -h])),
            ("edge_u", Value::Vec3([size, 0.0, 0.0])),
            ("edge_v", Value::Vec3([0.0, 0.0, size])),
        ];
        arguments.extend_from_slice(more);
        build::<Area>(&arguments, root).unwrap()
    }

    #[test]
    fn a_small_window_is_a_point() {
        for word in ["none", "square"] {
            let falloff = ("falloff", Value::Text(word.into()));
            let small = window(1e-9, std::slice::from_ref(&falloff), &plain_root());
            let point = build::<Point>(
                &[("position", Value::Vec3([0.0, 4.0, 0.0])), falloff],
                &plain_root(),
            );
            let lit = DVec3::new(1.0, 0.5, -2.0);
            let (a, b) = (
                small.sample(lit, [0.2, 0.9]).unwrap(),
                point.unwrap().sample(lit, [0.5; 2]).unwrap(),
            );
            assert!((a.direction - b.direction).length() < 1e-8);
            assert!((a.arriving - b.arriving).length() < 1e-8, "{word}");
        }
    }

    /// The irradiance below the middle of a square panel of radiance 1 that faces the surface is known:
    /// pi times the form factor of four rectangles (Howell, "A Catalog of Radiation Heat Transfer
    /// Configuration Factors", B-3).
    #[test]
    fn a_panel_lights_as_its_form_factor_says() {
        // edge_u x edge_v = x cross z = -y: the front faces down.
        let more =
            [("emits", Value::Text("front".into())), ("falloff", Value::Text("square".into()))];
        let panel = window(2.0, &more, &plain_root());
        let n = 128;
        let mean: f64 = grid(n)
            .filter_map(|u| panel.sample(DVec3::ZERO, u))
            .map(|s| s.direction.y * s.arriving.x / f64::from(n * n))
            .sum();
        // The intensity is 1 and the area 4, so the radiance is 1/4.
        let (x, y): (f64, f64) = (1.0 / 4.0, 1.0 / 4.0);
        let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        let quarter = (x / p * dioptric_math::atan(y / p) + y / q * dioptric_math::atan(x / q))
            / (2.0 * std::f64::consts::PI);
        let expected = 0.25 * std::f64::consts::PI * 4.0 * quarter;
        assert!((mean / expected - 1.0).abs() < 1e-4, "{mean} {expected}");
    }

    #[test]
    fn sides_are_those_of_the_file_in_mirrored_roots_too() {
        let mirrored =
            Root::new(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)), DVec3::Y).unwrap();
        for root in [plain_root(), scaled_root(1e6), mirrored] {
            let front = window(2.0, &[("emits", Value::Text("front".into()))], &root);
            let both = window(2.0, &[("emits", Value::Text("both".into()))], &root);
            let (below, above) = (root.point(DVec3::ZERO), root.point(DVec3::new(0.0, 9.0, 0.0)));
            assert!(front.sample(below, [0.5; 2]).is_some());
            assert!(front.sample(above, [0.5; 2]).is_none());
            assert!(both.sample(above, [0.5; 2]).is_some());
        }
    }

    #[test]
    fn a_line_is_no_window() {
        let error = build::<Area>(
            &[
                ("corner", Value::Vec3([0.0; 3])),
                ("edge_u", Value::Vec3([1e-9, 0.0, 0.0])),
                ("edge_v", Value::Vec3([-2.0, 0.0, 0.0])),
            ],
            &plain_root(),
        );
        assert_eq!(error.unwrap_err().message, "edge_v of area_light: it points along edge_u");
    }
}
