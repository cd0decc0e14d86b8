// SPDX-License-Identifier: MIT OR Apache-2.0
//! A round flat light.

use std::f64::consts::PI;

use dioptric_math::{DVec3, normalize, orthonormal_basis};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::panel::{EMITS, Panel};
use super::shared::{COLOR, FALLOFF, INTENSITY, SAMPLES};
use super::{Light, LightPass, LightPlace, LightSample, LightView};
use crate::build::Builder;
use crate::sampling::warp::concentric_disc;
use crate::setting::root::Root;

/// A disc that shines.
#[derive(Clone, Debug)]
pub struct Disc {
    panel: Panel,
}

static SCHEMA: Schema = Schema {
    kind: "disc_light",
    category: Category::Light,
    summary: "a round flat light: soft shadows",
    doc: "Each point lit takes `samples` points of the disc, uniform over its area (Shirley and Chiu, \"A Low\n\
          Distortion Map Between Disk and Square\", Journal of Graphics Tools 2(3), 1997); `intensity` is shared\n\
          among them, so that a small disc does what `light` does. The disc itself is not seen and casts no\n\
          shadow.",
    params: &[
        Param::required("center", Type::Vec3, "Its middle."),
        Param::required("normal", Type::Direction, "Direction in which its front looks."),
        Param::new("radius", Type::Positive, Default::Number(1.0), "Its radius."),
        INTENSITY,
        COLOR,
        FALLOFF,
        EMITS,
        SAMPLES,
    ],
    example: "disc_light(center = (-2, 4, 2), normal = (0.5, -1, -0.5), radius = 0.8, intensity = 0.9)",
};

impl Light for Disc {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        let wrong = || {
            args.error(
                "normal",
                "degenerate-light",
                "disc_light: its normal and radius make no disc",
            )
            .help("write a direction such as normal = (0, -1, 0)")
        };
        let normal = normalize(args.vec3("normal")?.into()).ok_or_else(wrong)?;
        let radius = args.number("radius")?;
        let (t, b) = orthonormal_basis(normal);
        let center = args.vec3("center")?.into();
        let edges = [t * radius, b * radius];
        let panel = Panel::from_args(args, builder, root, center, edges)?.ok_or_else(wrong)?;
        Ok(Self { panel })
    }

    fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample> {
        self.panel.sample(point, concentric_disc(u))
    }

    fn samples(&self) -> u32 {
        self.panel.samples
    }

    fn is_sharp(&self) -> bool {
        false
    }

    fn pass(&self, origin: DVec3, direction: DVec3) -> Option<LightPass> {
        self.panel.pass(origin, direction, PI, |[x, y]| x * x + y * y <= 1.0)
    }

    fn view(&self, point: DVec3) -> Option<LightView> {
        self.panel.view(point, 0.0, 1.0)
    }

    fn place(&self) -> Option<LightPlace> {
        self.panel.place(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::testing::{build, grid};
    use crate::setting::testing::plain_root;
    use dioptric_scene::Value;

    /// On its axis a disc of radiance L gives the irradiance pi L r^2 / (r^2 + h^2).
    #[test]
    fn a_disc_lights_its_axis_as_the_closed_form_says() {
        let (r, h) = (1.5, 2.0);
        let disc = build::<Disc>(
            &[
                ("center", Value::Vec3([0.0, h, 0.0])),
                ("normal", Value::Vec3([0.0, -3.0, 0.0])),
                ("radius", Value::Number(r)),
                ("emits", Value::Text("front".into())),
                ("falloff", Value::Text("square".into())),
            ],
            &plain_root(),
        )
        .unwrap();
        assert_eq!(disc.samples(), 16);
        let n = 128;
        let mean: f64 = grid(n)
            .filter_map(|u| disc.sample(DVec3::ZERO, u))
            .map(|s| s.direction.y * s.arriving.x / f64::from(n * n))
            .sum();
        let expected = 1.0 / (r * r + h * h); // L = intensity / area = 1 / (pi r^2)
        assert!((mean / expected - 1.0).abs() < 1e-4, "{mean} {expected}");
        assert!(disc.sample(DVec3::new(0.0, 5.0, 0.0), [0.3; 2]).is_none());
    }
}
