// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eric Haines' Neutral File Format, as his Standard Procedural Databases use it ("A Proposal for
//! Standard Graphics Environments", IEEE Computer Graphics and Applications 7(11), 1987).
//!
//! | line | becomes |
//! |---|---|
//! | `v`, `from`, `at`, `up`, `angle`, `hither`, `resolution` | `camera` with that vertical angle, `render(size)`; `hither` is left out |
//! | `b r g b` | `background` |
//! | `l x y z [r g b]` | `light` without falloff, of intensity 1 / sqrt(number of lights) where it has no colour |
//! | `f r g b Kd Ks shine T ior` | `phong` with diffuse Kd, highlight and mirror Ks; `clear` where T is above 0 |
//! | `c` base radius apex radius | an open `cylinder` or `cone` |
//! | `s` centre radius | `sphere` |
//! | `p n` corners, `pp n` corners with normals | `polygon`, `triangle`s with normals |
//!
//! Colours are raw numbers, no ambient light is added, transparent surfaces colour the light that
//! crosses them, and four bounces are followed, as the format's pictures were made; more where a
//! surface is transparent, since every polygon of a transparent body counts as one. Negative radii
//! (only the inside is seen) are taken as positive.

mod tokens;

use std::collections::HashMap;

use dioptric_math::DVec3;
use dioptric_scene::{Diagnostic, Loader, NodeId, Span, StackId, Value, Vocabulary};

use crate::build::Build;
use crate::call::{Call, Kind};
use crate::options::ReadOptions;
use crate::{ReadError, Reading, conclude};
use tokens::{Stop, Tokens, stop};

/// Reads a scene in NFF.
pub(crate) fn read(
    path: &str,
    text: String,
    _loader: &dyn Loader,
    vocabulary: &Vocabulary,
    options: &ReadOptions,
) -> Result<Reading, ReadError> {
    let mut build = Build::default();
    let file = build.description.sources.add(path, text.as_str());
    let mut reader = Reader {
        build,
        vocabulary,
        kinds: HashMap::new(),
        limit: options.limits.objects,
        lights: Vec::new(),
        fill: None,
        view: None,
        bounces: BOUNCES,
    };
    if let Err(Some(error)) = reader.entities(&mut Tokens::new(&text, file)) {
        reader.build.record(*error);
    }
    let mut build = reader.build;
    if reader.view.is_none() && !options.shapes_alone && build.diagnostics.is_empty() {
        build.diagnostics.push(
            Diagnostic::error("no-camera", format!("{path} has no viewpoint")).help(
                "add the lines: v, from 0 0 5, at 0 0 0, up 0 1 0, angle 45, hither 1, resolution 512 512",
            ),
        );
    }
    if let Some((name, _)) = options.set.first() {
        let message = format!("--set {name}: an NFF scene has no parameters");
        build.diagnostics.push(Diagnostic::error("unknown-parameter", message));
    }
    build.finish(options);
    conclude(build, Vec::new(), Vec::new())
}

struct Reader<'a> {
    build: Build,
    vocabulary: &'a Vocabulary,
    kinds: HashMap<&'static str, Kind>,
    limit: usize,
    lights: Vec<Light>,
    fill: Option<Fill>,
    view: Option<View>,
    bounces: f64,
}

/// Bounces that are followed among mirrors: POV-Ray's.
const BOUNCES: f64 = 4.0;
/// Bounces that are followed where a surface is transparent.
const BOUNCES_THROUGH: f64 = 32.0;

/// What is left of the viewpoint once the camera is made.
struct View {
    size: [f64; 2],
    span: Span,
}

struct Light {
    position: [f64; 3],
    color: Option<[f64; 3]>,
    span: Span,
}

/// What `f` says, and its material once a surface needs it.
struct Fill {
    numbers: [f64; 8],
    span: Span,
    material: Option<NodeId>,
}

impl Reader<'_> {
    fn entities(&mut self, tokens: &mut Tokens) -> Result<(), Stop> {
        while let Some((word, span)) = tokens.next() {
            let result = self.entity(word, span, tokens);
            if let Err(error) = result {
                let Some(error) = error else { return Err(None) };
                if !self.build.record(*error) {
                    return Err(None);
                }
                tokens.skip_numbers();
            }
        }
        let share = 1.0 / (self.lights.len().max(1) as f64).sqrt();
        for light in std::mem::take(&mut self.lights) {
            let mut args = vec![("position", Value::Vec3(light.position))];
            match light.color {
                Some(color) => args.push(("color", Value::Vec3(color))),
                None => args.push(("intensity", Value::Number(share))),
            }
            self.add("light", light.span, args)?;
        }
        if let Some(View { size, span }) = self.view {
            let render = vec![
                ("size", Value::Vec2(size)),
                ("bounces", Value::Number(self.bounces)),
                ("shadows", Value::Text("tinted".into())),
            ];
            self.add("render", span, render)?;
            // The format's numbers are those of the screen.
            self.add("scene", span, vec![("colors", Value::Text("raw".into()))])?;
            self.add("develop", span, vec![("encoding", Value::Text("raw".into()))])?;
        }
        Ok(())
    }

    fn entity(&mut self, word: &str, span: Span, tokens: &mut Tokens) -> Result<(), Stop> {
        match word {
            "v" => self.viewpoint(span, tokens),
            "b" => {
                let color = tokens.numbers("b takes 3 numbers, the colour")?;
                let span = tokens.since(span);
                self.add("background", span, vec![("color", Value::Vec3(color))]).map(drop)
            }
            "l" => {
                let position =
                    tokens.numbers("l takes 3 numbers, the place, and 3 more for a colour")?;
                let color = if tokens.number_follows() {
                    Some(tokens.numbers("the colour of l takes 3 numbers")?)
                } else {
                    None
                };
                self.lights.push(Light { position, color, span: tokens.since(span) });
                Ok(())
            }
            "f" => {
                self.fill = None;
                let numbers =
                    tokens.numbers("f takes 8 numbers: red, green, blue, Kd, Ks, shine, T, ior")?;
                self.fill = Some(Fill { numbers, span: tokens.since(span), material: None });
                Ok(())
            }
            "s" => {
                let [x, y, z, radius] = tokens.numbers("s takes 4 numbers: centre and radius")?;
                let args = vec![
                    ("center", Value::Vec3([x, y, z])),
                    ("radius", Value::Number(radius.abs())),
                ];
                self.surface("sphere", tokens.since(span), args)
            }
            "c" => self.cone(span, tokens),
            "p" => {
                let count = tokens.count("p needs the number of its corners")?;
                let mut corners = Vec::new();
                for _ in 0..count {
                    corners.push(Value::Vec3(tokens.numbers("a corner takes 3 numbers")?));
                }
                let args = vec![("points", Value::from_items(corners))];
                self.surface("polygon", tokens.since(span), args)
            }
            "pp" => self.patch(span, tokens),
            _ => {
                let error =
                    Diagnostic::error("syntax", format!("unknown word {word}")).at(span, "");
                Err(stop(error.help("the words of NFF are v, b, l, f, c, s, p and pp")))
            }
        }
    }

    fn viewpoint(&mut self, span: Span, tokens: &mut Tokens) -> Result<(), Stop> {
        let mut from = None;
        let mut at = None;
        let mut up = None;
        let mut angle = None;
        let mut size = None;
        while let Some(word) =
            tokens.take_one_of(&["from", "at", "up", "angle", "hither", "resolution"])
        {
            match word {
                "from" => from = Some(tokens.numbers("from takes 3 numbers")?),
                "at" => at = Some(tokens.numbers("at takes 3 numbers")?),
                "up" => up = Some(tokens.numbers("up takes 3 numbers")?),
                "angle" => angle = Some(tokens.numbers("angle takes a number")?),
                "resolution" => size = Some(tokens.numbers("resolution takes 2 numbers")?),
                _ => {
                    let [_near] = tokens.numbers("hither takes a number")?;
                }
            }
        }
        let span = tokens.since(span);
        let (Some(from), Some(at), Some(up), Some([angle]), Some(size)) =
            (from, at, up, angle, size)
        else {
            return Err(stop(
                Diagnostic::error("missing-argument", "the viewpoint is not complete")
                    .at(span, "")
                    .help("v needs from, at, up, angle and resolution after it"),
            ));
        };
        if let Some(View { span: first, .. }) = self.view {
            return Err(stop(
                Diagnostic::error("second-camera", "the file has a second viewpoint")
                    .at(span, "")
                    .at(first, "the first"),
            ));
        }
        self.view = Some(View { size, span });
        let camera = vec![
            ("eye", Value::Vec3(from)),
            ("look_at", Value::Vec3(at)),
            ("up", Value::Vec3(up)),
            ("fov", Value::Number(angle)),
        ];
        self.add("camera", span, camera).map(drop)
    }

    fn cone(&mut self, span: Span, tokens: &mut Tokens) -> Result<(), Stop> {
        let [x, y, z, base_radius, a, b, c, apex_radius] =
            tokens.numbers("c takes 8 numbers: base and radius, apex and radius")?;
        let (base_radius, apex_radius) = (base_radius.abs(), apex_radius.abs());
        let mut args = vec![
            ("base", Value::Vec3([x, y, z])),
            ("radius", Value::Number(base_radius)),
            ("top", Value::Vec3([a, b, c])),
            ("open", Value::Bool(true)),
        ];
        let kind = if base_radius == apex_radius {
            "cylinder"
        } else {
            args.push(("top_radius", Value::Number(apex_radius)));
            "cone"
        };
        self.surface(kind, tokens.since(span), args)
    }

    /// A flat or bent patch with a normal at each corner, as a fan of triangles.
    fn patch(&mut self, span: Span, tokens: &mut Tokens) -> Result<(), Stop> {
        let count = tokens.count("pp needs the number of its corners")?;
        let mut corners: Vec<([f64; 3], [f64; 3])> = Vec::new();
        for _ in 0..count {
            let [x, y, z, a, b, c] =
                tokens.numbers("a corner of pp takes 6 numbers: place and normal")?;
            corners.push(([x, y, z], [a, b, c]));
        }
        let span = tokens.since(span);
        let Some((first, rest)) = corners.split_first() else { return Ok(()) };
        for pair in rest.windows(2) {
            let triangle = [first, &pair[0], &pair[1]];
            // Patches that shrink to a point at one end have triangles without area: nothing to see.
            let [a, b, c] = triangle.map(|(place, _)| DVec3::from(*place));
            if (b - a).cross(c - a) == DVec3::ZERO {
                continue;
            }
            let normals = triangle.map(|(_, normal)| Value::Vec3(*normal)).to_vec();
            let mut args: Vec<(&str, Value)> = ["a", "b", "c"]
                .into_iter()
                .zip(triangle)
                .map(|(name, (place, _))| (name, Value::Vec3(*place)))
                .collect();
            args.push(("normals", Value::from_items(normals)));
            self.surface("triangle", span, args)?;
        }
        Ok(())
    }

    /// Adds a shape of the present fill.
    fn surface(
        &mut self,
        kind: &'static str,
        span: Span,
        args: Vec<(&str, Value)>,
    ) -> Result<(), Stop> {
        let mut args = args;
        if let Some(material) = self.material()? {
            args.push(("material", Value::Node(material)));
        }
        self.add(kind, span, args).map(drop)
    }

    /// The material of the present fill, made when the first surface needs it.
    fn material(&mut self) -> Result<Option<NodeId>, Stop> {
        let Some(fill) = &self.fill else { return Ok(None) };
        if fill.material.is_some() {
            return Ok(fill.material);
        }
        let ([r, g, b, diffuse, specular, shine, through, ior], span) = (fill.numbers, fill.span);
        let color = Value::Vec3([r, g, b]);
        let shines = specular > 0.0 && shine > 0.0;
        let mut args = vec![
            ("color", color.clone()),
            ("diffuse", Value::Number(diffuse)),
            ("ambient", Value::Number(0.0)),
            ("specular", Value::Number(if shines { specular } else { 0.0 })),
        ];
        if shines {
            args.push(("exponent", Value::Number(shine)));
        }
        let kind = if through > 0.0 {
            self.bounces = BOUNCES_THROUGH;
            args.push(("own", Value::Number(1.0 - through)));
            args.push(("tint", color));
            // An index of 0 is how the format says that there is none.
            args.push(("ior", Value::Number(if ior > 0.0 { ior } else { 1.0 })));
            "clear"
        } else {
            args.push(("mirror", Value::Number(specular)));
            "phong"
        };
        let id = self.add(kind, span, args)?;
        if let Some(fill) = &mut self.fill {
            fill.material = Some(id);
        }
        Ok(Some(id))
    }

    fn add(
        &mut self,
        kind: &'static str,
        span: Span,
        args: Vec<(&str, Value)>,
    ) -> Result<NodeId, Stop> {
        if self.build.description.nodes.len() >= self.limit {
            let message = format!("the file has more than {} objects", self.limit);
            let error = Diagnostic::error("too-many-objects", message).at(span, "");
            return Err(stop(error.help("--max-objects raises the limit")));
        }
        if !self.kinds.contains_key(kind) {
            let Some(schema) = self.vocabulary.get(kind) else {
                let message = format!("the vocabulary has no {kind}, which NFF needs");
                return Err(stop(Diagnostic::error("internal", message).at(span, "")));
            };
            self.kinds.insert(kind, Kind::new(schema));
        }
        let Some(kind) = self.kinds.get(kind) else { return Err(None) };
        let mut call = Call::default();
        for (name, value) in args {
            kind.bind_named(&mut call, name, Ok(value));
        }
        let (id, go_on) = kind.finish(call, &mut self.build, span, StackId::TOP);
        if go_on { Ok(id) } else { Err(None) }
    }
}
