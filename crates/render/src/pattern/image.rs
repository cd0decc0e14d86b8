// SPDX-License-Identifier: MIT OR Apache-2.0
//! A picture from a file, laid on surfaces.

use dioptric_math::{DVec2, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::mapping::{self, Mapping};
use super::place;
use super::{Pattern, PatternPoint};
use crate::build::{Builder, ColorReading};
use crate::texture::{Filter, Lookup, Wrap};

/// A mapped picture.
#[derive(Clone, Debug)]
pub struct Image {
    mapping: Mapping,
    lookup: Lookup,
    repeat: DVec2,
    offset: DVec2,
    /// One channel in all lanes, instead of the colour.
    channel: Option<usize>,
}

static SCHEMA: Schema = Schema {
    kind: "image",
    category: Category::Pattern,
    summary: "a picture from a file",
    doc: "Reads PNG, JPEG, BMP, TGA, Radiance HDR and OpenEXR. u runs to the right and v upwards, the picture\n\
          is the square from 0 to 1, its top row at v = 1; the texel in column i of row j from the top, of w\n\
          by h, has its middle at `u = (i + 1/2) / w`, `v = 1 - (j + 1/2) / h`.\n\n\
          | mapping | u | v |\n\
          |---|---|---|\n\
          | \"uv\" | the shape's u | the shape's v |\n\
          | \"planar\" | distance from `origin` along `right`, in its lengths | the same along `up` |\n\
          | \"lonlat\" | longitude around `up`, `atan2(x, z) / 2 pi + 1/2` | latitude, `asin(y) / pi + 1/2` |\n\
          | \"cylindrical\" | longitude around `up` | height along `up`, in its lengths |\n\
          | \"cube\" | the whole picture on each face of a box | upright on the four sides |\n\
          | \"asin\" | `asin(n.x) / pi + 1/2` of the unit normal n | `asin(n.y) / pi + 1/2` |\n\n\
          x, y and z are measured along `right`, `up` and the direction that makes them right-handed. With\n\
          its `origin` in the middle of a sphere \"lonlat\" equals the sphere's own uv. \"asin\" shows only a\n\
          diamond of the picture and mirrors it on the back; old programs use it.\n\n\
          8-bit and 16-bit pictures are decoded from sRGB to linear light where they are colours, as the\n\
          scene's `colors` says, and never where they are numbers; HDR and EXR hold linear light already.\n\
          Texels are mixed after decoding. Where \"lonlat\", \"cube\" and \"asin\" end at the picture's edge,\n\
          the texels there are not mixed with those of the opposite edge unless the picture is repeated.",
    params: &[
        Param::required("file", Type::File, "The picture."),
        mapping::MAPPING,
        Param::new(
            "filter",
            Type::Choice(Filter::NAMES),
            Default::Text("bilinear"),
            "Between the texels: smooth, or square texels.",
        ),
        Param::new(
            "wrap",
            Type::Choice(Wrap::NAMES),
            Default::Text("repeat"),
            "Beyond the edge: the picture again, mirrored, its edge drawn out, or `border`.",
        ),
        Param::new(
            "border",
            Type::Color,
            Default::Number(0.0),
            "The colour beyond the edge for wrap = \"border\".",
        ),
        mapping::ORIGIN,
        mapping::RIGHT,
        mapping::UP,
        mapping::BOX_SIZE,
        Param::new(
            "repeat",
            Type::Vec2,
            Default::Vec2([1.0, 1.0]),
            "How often the picture fits in u and v; negative numbers mirror it.",
        ),
        Param::new(
            "offset",
            Type::Vec2,
            Default::Vec2([0.0, 0.0]),
            "Moves the picture's lower left corner in u and v.",
        ),
        Param::new(
            "colors",
            Type::Choice(&["auto", "srgb", "raw"]),
            Default::Text("auto"),
            "Whether stored values are decoded: as the scene says, always, or never.",
        ),
        Param::new(
            "channel",
            Type::Choice(&["rgb", "red", "green", "blue", "alpha"]),
            Default::Text("rgb"),
            "The colour, or one channel alone as a grey.",
        ),
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(image(\"pictures/planet.png\")))",
};

impl Image {
    /// Its width and height in texels.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.lookup.texture.width(), self.lookup.texture.height()]
    }
}

impl Pattern for Image {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let mapping = Mapping::from_args(args)?;
        let repeat = DVec2::from(args.vec2("repeat")?);
        let offset = DVec2::from(args.vec2("offset")?);
        let mut wrap = [Wrap::from_name(&args.text("wrap")?); 2];
        if repeat == DVec2::ONE && offset == DVec2::ZERO {
            for (wrap, ends) in wrap.iter_mut().zip(mapping.ends()) {
                if ends {
                    *wrap = Wrap::Clamp;
                }
            }
        }
        let as_color = match &*args.text("colors")? {
            "srgb" => true,
            "raw" => false,
            _ => builder.reading == ColorReading::Srgb,
        };
        let lookup = Lookup {
            texture: builder.texture(args, "file")?,
            filter: Filter::from_name(&args.text("filter")?),
            wrap,
            border: builder.constant_color(args, "border")?.into(),
            as_color,
        };
        let channel = match &*args.text("channel")? {
            "red" => Some(0),
            "green" => Some(1),
            "blue" => Some(2),
            "alpha" => Some(3),
            _ => None,
        };
        Ok(Self { mapping, lookup, repeat, offset, channel })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let uv = (self.mapping.uv(point) - self.offset) * self.repeat;
        let value = self.lookup.eval(uv.x, uv.y);
        match self.channel {
            None => Spectrum::new(value[0], value[1], value[2]),
            Some(channel) => Spectrum::splat(value[channel]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::AnyPattern;
    use crate::pattern::testing::{Bench, at, grey, n, t, v};
    use dioptric_geometry::Shape;
    use dioptric_geometry::shapes::sphere::Sphere;
    use dioptric_image::{EncodeOptions, Encoding, FileFormat, Layers, encode};
    use dioptric_math::{DVec3, asin, random::Random};
    use dioptric_scene::Value;
    use std::f64::consts::PI;
    use std::sync::Arc;

    /// A PNG file whose pixels are `f(x, y)`, y from the top.
    fn png(w: u32, h: u32, f: impl FnMut(u32, u32) -> [f32; 3]) -> Vec<u8> {
        let image = dioptric_image::Image::from_fn(w, h, Encoding::Srgb, f).unwrap();
        encode(&Layers::from(image), FileFormat::Png, &EncodeOptions::default()).unwrap()
    }

    /// Columns and rows as bytes, 256 of each: `red = x / 255`, `green = (255 - y) / 255`.
    fn ruler() -> Vec<u8> {
        png(256, 256, |x, y| [x as f32 / 255.0, (255 - y) as f32 / 255.0, 0.0])
    }

    fn image(args: &[(&str, Value)]) -> AnyPattern {
        let mut bench = Bench::default();
        bench.files = bench.files.with("a.png", ruler());
        let all: Vec<_> = [("file", t("a.png"))].into_iter().chain(args.iter().cloned()).collect();
        let id = bench.node("image", &all);
        bench.build(id).unwrap_or_else(|e| panic!("{}", e.message))
    }

    /// The picture's point that a pattern of `ruler` shows, to half a texel.
    fn shown(pattern: &AnyPattern, point: &PatternPoint) -> DVec2 {
        let c = pattern.eval(point);
        DVec2::new(c.x * 255.0 + 0.5, c.y * 255.0 + 0.5) / 256.0
    }

    #[track_caller]
    fn assert_near(a: DVec2, b: DVec2) {
        assert!((a - b).abs().max_element() < 0.502 / 256.0, "{a} is not {b}");
    }

    #[test]
    fn the_reports_wall() {
        let wall = image(&[
            ("mapping", t("planar")),
            ("origin", v(-70.0, -20.0, -200.0)),
            ("right", v(140.0, 0.0, 0.0)),
            ("up", v(0.0, 70.0, 0.0)),
            ("filter", t("nearest")),
            ("space", t("world")),
        ]);
        let AnyPattern::Image(inner) = &wall else { panic!() };
        let mut r = Random::new(2);
        for _ in 0..2000 {
            let (x, y) = (r.uniform(-70.0, 70.0), r.uniform(-20.0, 50.0));
            let point = at(x, y, -200.0);
            let uv = DVec2::new((x + 70.0) / 140.0, (y + 20.0) / 70.0);
            assert_eq!(inner.mapping.uv(&point), uv);
            let texel = DVec2::new((uv.x * 256.0).floor(), (uv.y * 256.0).floor());
            assert_eq!(shown(&wall, &point) * 256.0, texel + 0.5);
        }
    }

    #[test]
    fn the_reports_football() {
        let ball = image(&[("mapping", t("asin"))]);
        let AnyPattern::Image(inner) = &ball else { panic!() };
        let mut r = Random::new(3);
        for _ in 0..500 {
            let d = DVec3::new(r.unit() - 0.5, r.unit() - 0.5, r.unit() - 0.5);
            let normal = dioptric_math::normalize(d).unwrap();
            let point = PatternPoint {
                object: DVec3::new(5.0, 7.0, -115.0) + normal * 3.0,
                object_normal: normal,
                ..at(0.0, 0.0, 0.0)
            };
            let uv = DVec2::new(asin(normal.x) / PI + 0.5, asin(normal.y) / PI + 0.5);
            assert_eq!(inner.mapping.uv(&point), uv);
            // Fault 9: the back shows the same, mirrored, and the corners are never seen.
            let back = PatternPoint { object_normal: normal * DVec3::new(1.0, 1.0, -1.0), ..point };
            assert_eq!(ball.eval(&point), ball.eval(&back));
            assert!((uv.x - 0.5).abs() + (uv.y - 0.5).abs() <= 0.5 + 1e-12);
        }
        // At the rim nothing of the opposite edge is mixed in.
        let rim = PatternPoint { object_normal: DVec3::X, ..at(0.0, 0.0, 0.0) };
        assert_eq!(ball.eval(&rim).x, 1.0);
    }

    #[test]
    fn lonlat_is_the_spheres_own_uv() {
        let center = DVec3::new(2.0, -1.0, 5.0);
        let sphere = Sphere::new(center, 3.0);
        let lonlat = image(&[("mapping", t("lonlat")), ("origin", v(2.0, -1.0, 5.0))]);
        let AnyPattern::Image(inner) = &lonlat else { panic!() };
        let mut r = Random::new(4);
        for _ in 0..500 {
            let p = center + DVec3::new(r.unit() - 0.5, r.unit() - 0.5, r.unit() - 0.5) * 6.0;
            let surface = sphere.surface(p, 0);
            let point = PatternPoint { object: surface.point, uv: surface.uv, ..at(0.0, 0.0, 0.0) };
            assert!((inner.mapping.uv(&point) - surface.uv).length() < 1e-12);
        }
        assert_near(shown(&lonlat, &at(2.0, -1.0, 9.0)), DVec2::new(0.5, 0.5));
        assert_near(shown(&lonlat, &at(9.0, -1.0, 5.0)), DVec2::new(0.75, 0.5));
        assert_eq!(lonlat.eval(&at(2.0, 2.0, 5.0)).y, 1.0, "the pole is the top row alone");
    }

    #[test]
    fn cylinder_and_cube() {
        let label = image(&[("mapping", t("cylindrical")), ("up", v(0.0, 10.0, 0.0))]);
        for (p, uv) in [
            (at(0.0, 5.0, 2.0), (0.5, 0.5)),
            (at(7.0, 2.5, 0.0), (0.75, 0.25)),
            (at(-0.1, 17.5, 0.0), (0.25, 0.75)),
        ] {
            assert_near(shown(&label, &p), uv.into());
        }
        let die = image(&[("mapping", t("cube")), ("size", v(2.0, 4.0, 6.0))]);
        // A point a quarter right of and an eighth above the middle of each face, as seen from outside.
        for p in [
            at(0.5, 0.5, 3.0),
            at(1.0, 0.5, -1.5),
            at(-0.5, 0.5, -3.0),
            at(-1.0, 0.5, 1.5),
            at(0.5, 2.0, -0.75),
            at(0.5, -2.0, 0.75),
        ] {
            assert_near(shown(&die, &p), DVec2::new(0.75, 0.625));
        }
    }

    #[test]
    fn slanted_edges_give_a_parallelogram() {
        let slanted = image(&[
            ("mapping", t("planar")),
            ("right", v(4.0, 0.0, 0.0)),
            ("up", v(2.0, 2.0, 0.0)),
            ("wrap", t("clamp")),
        ]);
        for (a, b) in [(0.1, 0.9), (0.5, 0.5), (0.8, 0.2)] {
            let p = at(4.0 * a + 2.0 * b, 2.0 * b, 3.0);
            assert_near(shown(&slanted, &p), DVec2::new(a, b));
        }
    }

    #[test]
    fn repeated_and_moved() {
        let tiles = image(&[
            ("repeat", Value::Vec2([2.0, 4.0])),
            ("offset", Value::Vec2([0.1, 0.0])),
            ("filter", t("nearest")),
        ]);
        for (u, v, x, y) in
            [(0.101, 0.0002, 0.0, 0.0), (0.351, 0.1252, 0.5, 0.5), (0.851, 0.8127, 0.5, 0.25)]
        {
            assert_near(shown(&tiles, &at(u, v, 0.0)), DVec2::new(x, y) + 0.5 / 256.0);
        }
    }

    #[test]
    fn colours_are_decoded_and_numbers_are_not() {
        let mut bench = Bench { reading: ColorReading::Srgb, ..Bench::default() };
        bench.files = bench.files.with("a.png", png(1, 1, |_, _| [0.2; 3]));
        let file = ("file", t("a.png"));
        let auto = bench.node("image", std::slice::from_ref(&file));
        let raw = bench.node("image", &[file.clone(), ("colors", t("raw"))]);
        let always = bench.node("image", &[file, ("colors", t("srgb"))]);
        let decoded = crate::build::srgb_to_linear(51.0 / 255.0);
        let mut builder = bench.builder();
        let mut value = |id| builder.pattern(id).unwrap().eval(&at(0.3, 0.3, 0.0)).x;
        assert_eq!(value(auto), decoded);
        assert_eq!(value(raw), 51.0 / 255.0);
        // As the amount of a mix the same picture is data.
        let as_number = |id| {
            let mut scene = Bench { reading: ColorReading::Srgb, ..Bench::default() };
            (scene.scene, scene.files) = (bench.scene.clone(), bench.files.clone());
            let mix =
                scene.node("mix", &[("a", n(0.0)), ("b", n(1.0)), ("amount", Value::Node(id))]);
            scene.build(mix).unwrap().eval(&at(0.3, 0.3, 0.0)).x
        };
        assert!((as_number(auto) - 51.0 / 255.0).abs() < 1e-15);
        assert!((as_number(always) - decoded).abs() < 1e-15);
    }

    #[test]
    fn a_picture_is_read_once_and_counts_against_the_budget() {
        let mut bench = Bench::default();
        bench.files = bench.files.with("a.png", ruler()).with("b.png", ruler());
        let a = bench.node("image", &[("file", t("a.png"))]);
        let again = bench.node("image", &[("file", t("a.png")), ("filter", t("nearest"))]);
        let b = bench.node("image", &[("file", t("b.png"))]);
        let mut builder = bench.builder();
        builder.texels_left = 100_000;
        let mut texture = |id| match &*builder.pattern(id)? {
            AnyPattern::Image(i) => Ok(i.lookup.texture.clone()),
            _ => panic!(),
        };
        assert!(Arc::ptr_eq(&texture(a).unwrap(), &texture(again).unwrap()));
        let error: Diagnostic = texture(b).unwrap_err();
        assert_eq!(error.code, "picture-too-large");
        assert_eq!(
            error.message,
            "b.png: the picture is 256 x 256, more than the limit of 34464 pixels"
        );
    }

    #[test]
    fn pictures_read_ahead_are_the_same_and_so_are_their_errors() {
        let mut bench = Bench::default();
        let half = ruler()[..ruler().len() / 2].to_vec();
        bench.files = bench.files.with("a.png", ruler()).with("b.png", png(2, 2, |_, _| [0.2; 3]));
        bench.files = bench.files.with("half.png", half);
        let names = ["a.png", "b.png", "half.png", "none.png", "a.png"];
        let nodes = names.map(|name| bench.node("image", &[("file", t(name))]));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        for texels in [1 << 20, 65_538, 65_536, 65_535, 3] {
            let all = || {
                let mut builder = bench.builder();
                builder.texels_left = texels;
                nodes.map(|id| match builder.pattern(id) {
                    Ok(pattern) => Ok(pattern.eval(&at(0.3, 0.6, 0.0))),
                    Err(error) => Err(error.message),
                })
            };
            let apart = all();
            assert_eq!(pool.install(all), apart);
            assert_eq!(apart[0].is_ok(), texels >= 65_536, "{apart:?}");
            assert!(apart[2].is_err() && apart[3].is_err());
        }
    }

    #[test]
    fn channels_and_borders() {
        let blue = image(&[("channel", t("blue"))]);
        assert_eq!(blue.eval(&at(0.9, 0.9, 0.0)), grey(0.0));
        let alpha =
            image(&[("channel", t("alpha")), ("wrap", t("border")), ("filter", t("nearest"))]);
        assert_eq!(alpha.eval(&at(0.9, 0.9, 0.0)), grey(1.0));
        assert_eq!(alpha.eval(&at(1.1, 0.9, 0.0)), grey(0.0));
        let border = image(&[("wrap", t("border")), ("border", n(0.25))]);
        assert_eq!(border.eval(&at(5.0, 0.5, 0.0)), grey(0.25));
    }

    #[test]
    fn files_that_are_no_picture_are_explained() {
        let error = |bytes: &[u8], args: &[(&str, Value)]| {
            let mut bench = Bench::default();
            bench.files = bench.files.with("a.png", bytes);
            let id = bench.node("image", args);
            let e = bench.build(id).unwrap_err();
            (e.code, e.message, e.help.unwrap_or_default())
        };
        let a = [("file", t("a.png"))];
        let (code, message, help) = error(b"", &[("file", t("b.png"))]);
        assert_eq!((code, &*message), ("file-not-found", "there is no file b.png"));
        assert_eq!(help, "did you mean a.png?");
        let whole = ruler();
        let (code, message, help) = error(&whole[..whole.len() / 2], &a);
        assert_eq!(code, "picture-damaged");
        assert!(message.starts_with("a.png: the PNG file is damaged"), "{message}");
        assert!(!help.is_empty());
        let (code, message, help) = error(b"hello", &a);
        assert_eq!(code, "picture-unknown");
        assert_eq!(message, "a.png: this is no picture of a known format");
        assert!(help.starts_with("valid: png"), "{help}");
        let skew = [("file", t("a.png")), ("right", v(0.0, 2.0, 0.0))];
        assert_eq!(error(&whole, &skew).1, "image: right and up point the same way");
    }
}
