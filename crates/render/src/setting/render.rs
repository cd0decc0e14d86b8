// SPDX-License-Identifier: MIT OR Apache-2.0
//! `render(...)`: size, samples, filter, and how far light is followed.

use dioptric_scene::Default as Preset;
use dioptric_scene::{Args, Category, Description, Diagnostic, Param, Schema, Type, Value};

use super::overrides::Overridden;
use crate::filter::Filter;
use crate::sampling::Antialias;

/// Pixels that a picture may have unless its maker allows more: 16384 x 16384.
pub const MAX_PIXELS: u64 = 1 << 28;

/// Samples that a pixel may have.
pub const MAX_SAMPLES: u32 = 1 << 16;

/// Bounces that a path may have.
pub const MAX_BOUNCES: u32 = 10_000;

/// The schema of `render`.
pub static SCHEMA: Schema = Schema {
    kind: "render",
    category: Category::Setting,
    summary: "size, anti-aliasing, filter, and how far light is followed",
    doc: "Everything here can be given to the program too, which then wins over the scene.\n\n\
          `antialias`: \"none\" takes one sample at the pixel's centre; \"grid\" the centres of a grid of\n\
          `samples` cells (use 4, 9, 16, ...); \"report\" four at 0.2 and 0.8 of the pixel's width and height;\n\
          \"jitter\" one anywhere in each cell of the grid; \"sobol\" evenly spread ones (use powers of two);\n\
          \"adaptive\" takes `samples` like \"sobol\", and `max_samples` where the picture changes: see\n\
          [anti-aliasing](antialiasing.md).\n\n\
          `integrator`: \"whitted\" is crisp and quick: direct light, mirrors, glass. \"path\" follows light everywhere,\n\
          as nature does: see [paths of light](path.md). The others show something else of what the camera\n\
          sees: a quick preview (\"eyelight\"), `normals`, `depth`, `uv`, a colour for each `object` or `material`,\n\
          and where the time goes (`cost` of the search for hits, `rays` of each pixel).",
    params: &[
        Param::new(
            "size",
            Type::Vec2,
            Preset::Vec2([800.0, 600.0]),
            "Width and height of the picture in pixels.",
        ),
        Param::new(
            "samples",
            Type::Integer { min: 1, max: MAX_SAMPLES as i64 },
            Preset::Absent,
            "Samples of a pixel. Without: 4 for \"grid\", \"report\" and \"adaptive\", 16 for \"jitter\" and \
             \"sobol\". \"none\" always takes 1.",
        ),
        Param::new(
            "antialias",
            Type::Choice(Antialias::NAMES),
            Preset::Text("sobol"),
            "How the samples of a pixel are placed.",
        ),
        Param::new(
            "threshold",
            Type::UNIT,
            Preset::Number(0.05),
            "With \"adaptive\": the difference of neighbours from which on they get more samples, as a share \
             of the way from black to white on a display. At 1 colours do not matter, only objects and normals.",
        ),
        Param::new(
            "max_samples",
            Type::Integer { min: 1, max: MAX_SAMPLES as i64 },
            Preset::Absent,
            "With \"adaptive\": samples of a pixel where the picture changes. Without: 16 times `samples`.",
        ),
        Param::new(
            "filter",
            Type::Choice(Filter::NAMES),
            Preset::Text("box"),
            "How much a sample counts by its distance from the pixel's centre.",
        ),
        Param::new(
            "filter_radius",
            Type::Number { min: 0.01, max: 16.0 },
            Preset::Absent,
            "Half the filter's width in pixels. Without: box 0.5, tent 1, gaussian 1.5, mitchell and \
             blackman_harris 2.",
        ),
        Param::new(
            "integrator",
            Type::Choice(Integrator::NAMES),
            Preset::Text("whitted"),
            "What the picture shows.",
        ),
        Param::new(
            "bounces",
            Type::Integer { min: 0, max: MAX_BOUNCES as i64 },
            Preset::Absent,
            "At most so many reflections and passes through objects are followed, one after the other. Without: 10, \
             and 100 for \"path\".",
        ),
        Param::new(
            "min_contribution",
            Type::UNIT,
            Preset::Number(0.001),
            "Rays that can change a pixel by less than this share are not followed. 0 follows all.",
        ),
        Param::new(
            "light_sampling",
            Type::Choice(LightSampling::NAMES),
            Preset::Text("both"),
            "With \"path\": how light is found. A surface asks the \"lights\", or light is met by chance where the \
             \"surfaces\" send paths; \"both\" together, each weighted by how well it does, are never much worse than the \
             better one. All three show the same picture with other noise.",
        ),
        Param::new(
            "clamp",
            Type::Positive,
            Preset::Absent,
            "With \"path\": light that comes by more than one bounce is cut off at this radiance, which takes away bright \
             specks and makes the picture too dark where they belonged (biased). Without: nothing is.",
        ),
        Param::new(
            "caustics",
            Type::Integer { min: 0, max: 10_000_000 },
            Preset::Number(0.0),
            "With \"path\": how many photons are sent by way of glass and mirrors before the picture is made, to show paths \
             where these gather the light of lamps with a size, of glowing things and of the sky; 100000 are a good \
             number. The mean stays the same, bright specks get fewer. 0 for none.",
        ),
        Param::new(
            "shadows",
            Type::Choice(Shadows::NAMES),
            Preset::Text("opaque"),
            "What blocks light: everything (\"opaque\"), everything as far as it is not transparent \
             (\"tinted\"), or nothing (\"none\").",
        ),
        Param::new(
            "seed",
            Type::Integer { min: 0, max: 1 << 53 },
            Preset::Number(0.0),
            "Another number gives other random numbers.",
        ),
    ],
    example: "",
};

/// What the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Integrator {
    /// Whitted's recursive ray tracing.
    #[default]
    Whitted,
    /// Paths of light, without bias.
    Path,
    /// Colours lit from the camera: a quick preview.
    Eyelight,
    /// Shading normals, -1 to 1 shown as 0 to 1.
    Normals,
    /// Distance from the camera.
    Depth,
    /// Surface coordinates as red and green.
    Uv,
    /// A colour for each object.
    Object,
    /// A colour for each material.
    Material,
    /// Boxes and objects that the BVH tested.
    Cost,
    /// Rays behind each pixel.
    Rays,
}

impl Integrator {
    /// The words of the `integrator` parameter.
    pub const NAMES: &'static [&'static str] = &[
        "whitted", "path", "eyelight", "normals", "depth", "uv", "object", "material", "cost",
        "rays",
    ];

    const ALL: [Self; 10] = [
        Self::Whitted,
        Self::Path,
        Self::Eyelight,
        Self::Normals,
        Self::Depth,
        Self::Uv,
        Self::Object,
        Self::Material,
        Self::Cost,
        Self::Rays,
    ];

    /// The integrator of a word.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().zip(Self::ALL).find(|(word, _)| **word == name).map(|(_, i)| i)
    }

    /// How many bounces it follows unless told.
    #[must_use]
    pub const fn default_bounces(self) -> u32 {
        match self {
            Self::Path => 100,
            _ => 10,
        }
    }

    /// Its word.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.get(self as usize).copied().unwrap_or("whitted")
    }
}

/// How paths find light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LightSampling {
    /// Multiple importance sampling.
    #[default]
    Both,
    /// Surfaces ask the lights; only what no question finds is met by chance.
    Lights,
    /// Paths meet light by chance; only sharp lights, which nothing meets, are asked.
    Surfaces,
}

impl LightSampling {
    /// The words of the `light_sampling` parameter.
    pub const NAMES: &'static [&'static str] = &["both", "lights", "surfaces"];

    const ALL: [Self; 3] = [Self::Both, Self::Lights, Self::Surfaces];

    /// The way of a word.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().zip(Self::ALL).find(|(word, _)| **word == name).map(|(_, s)| s)
    }

    /// Its word.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.get(self as usize).copied().unwrap_or("both")
    }
}

/// What blocks light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shadows {
    /// Every object, glass too.
    #[default]
    Opaque,
    /// Transparent objects let light through as far as they are transparent, in their colour.
    Tinted,
    /// Nothing.
    None,
}

impl Shadows {
    /// The words of the `shadows` parameter.
    pub const NAMES: &'static [&'static str] = &["opaque", "tinted", "none"];

    const ALL: [Self; 3] = [Self::Opaque, Self::Tinted, Self::None];

    /// The kind of shadows of a word.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().zip(Self::ALL).find(|(word, _)| **word == name).map(|(_, s)| s)
    }

    /// Its word.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.get(self as usize).copied().unwrap_or("opaque")
    }
}

/// The settings of a picture, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Width and height in pixels, at least 1 each.
    pub size: [u32; 2],
    /// Samples of every pixel; with [`Antialias::Adaptive`] before the decision.
    pub samples: u32,
    /// How samples are placed.
    pub antialias: Antialias,
    /// See the parameter.
    pub threshold: f64,
    /// Samples of a refined pixel; equal to `samples` unless adaptive.
    pub max_samples: u32,
    /// The reconstruction filter.
    pub filter: Filter,
    /// Its radius in pixels.
    pub filter_radius: f64,
    /// What the picture shows.
    pub integrator: Integrator,
    /// At most so many bounces.
    pub bounces: u32,
    /// Smallest share of a pixel worth a ray.
    pub min_contribution: f64,
    /// How paths find light.
    pub light_sampling: LightSampling,
    /// The most radiance that indirect light may bring to a path; infinite for no bias.
    pub clamp: f64,
    /// Photons that look for gathered light.
    pub caustics: u32,
    /// What blocks light.
    pub shadows: Shadows,
    /// Fixes all random numbers.
    pub seed: u64,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            size: [800, 600],
            samples: 16,
            antialias: Antialias::Sobol,
            threshold: 0.05,
            max_samples: 16,
            filter: Filter::Box,
            filter_radius: 0.5,
            integrator: Integrator::Whitted,
            bounces: 10,
            min_contribution: 0.001,
            light_sampling: LightSampling::Both,
            clamp: f64::INFINITY,
            caustics: 0,
            shadows: Shadows::Opaque,
            seed: 0,
        }
    }
}

impl RenderSettings {
    /// The settings that a `render` node describes; pictures of more than `max_pixels` are refused.
    ///
    /// # Errors
    /// An argument is wrong, or two do not go together.
    pub fn from_args(args: &Args, max_pixels: u64) -> Result<Self, Diagnostic> {
        let antialias = word(args, "antialias", Antialias::from_name)?;
        let filter = word(args, "filter", Filter::from_name)?;
        let (samples, max_samples) = samples(args, antialias)?;
        let integrator = word(args, "integrator", Integrator::from_name)?;
        let bounces = args.optional_number("bounces")?.map(|n| n as u32);
        Ok(Self {
            size: size(args, max_pixels)?,
            samples,
            antialias,
            threshold: args.number("threshold")?,
            max_samples,
            filter,
            filter_radius: args
                .optional_number("filter_radius")?
                .unwrap_or(filter.default_radius()),
            integrator,
            bounces: bounces.unwrap_or(integrator.default_bounces()),
            min_contribution: args.number("min_contribution")?,
            light_sampling: word(args, "light_sampling", LightSampling::from_name)?,
            clamp: args.optional_number("clamp")?.unwrap_or(f64::INFINITY),
            caustics: args.integer("caustics")? as u32,
            shadows: word(args, "shadows", Shadows::from_name)?,
            seed: args.integer("seed")? as u64,
        })
    }

    /// The scene's settings, else the default ones, with the arguments in `replaced` on top.
    ///
    /// # Errors
    /// As [`Self::from_args`]; a replaced argument that `render` does not have.
    pub fn from_scene(
        scene: &Description,
        replaced: &[(&str, Value)],
        max_pixels: u64,
    ) -> Result<Self, Diagnostic> {
        let setting = Overridden::new(scene, &SCHEMA, replaced)?;
        Self::from_args(&setting.args(), max_pixels).map_err(|error| setting.explain(error))
    }

    /// Every parameter that has a value, in the schema's order: read again, they give the same settings.
    /// For metadata and statistics.
    #[must_use]
    pub fn to_values(&self) -> Vec<(&'static str, Value)> {
        let number = |n: u32| Value::Number(f64::from(n));
        let clamp = self.clamp.is_finite().then_some(("clamp", Value::Number(self.clamp)));
        let mut values = vec![
            ("size", Value::Vec2(self.size.map(f64::from))),
            ("samples", number(self.samples)),
            ("antialias", Value::Text(self.antialias.name().into())),
            ("threshold", Value::Number(self.threshold)),
            ("max_samples", number(self.max_samples)),
            ("filter", Value::Text(self.filter.name().into())),
            ("filter_radius", Value::Number(self.filter_radius)),
            ("integrator", Value::Text(self.integrator.name().into())),
            ("bounces", number(self.bounces)),
            ("min_contribution", Value::Number(self.min_contribution)),
            ("light_sampling", Value::Text(self.light_sampling.name().into())),
        ];
        values.extend(clamp);
        values.extend([
            ("caustics", number(self.caustics)),
            ("shadows", Value::Text(self.shadows.name().into())),
            ("seed", Value::Number(self.seed as f64)),
        ]);
        values
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }
}

/// The choice that a word means.
fn word<T>(args: &Args, name: &str, parse: fn(&str) -> Option<T>) -> Result<T, Diagnostic> {
    let text = args.text(name)?;
    parse(&text).ok_or_else(|| {
        args.error(name, "wrong-value", format!("{name} of render: unknown word \"{text}\""))
    })
}

fn size(args: &Args, max_pixels: u64) -> Result<[u32; 2], Diagnostic> {
    let [width, height] = args.vec2("size")?;
    let whole = |x: f64| x >= 1.0 && x.trunc() == x;
    if !(whole(width) && whole(height)) {
        let message = format!(
            "size of render: expected two whole numbers of at least 1, got ({width}, {height})"
        );
        return Err(args
            .error("size", "wrong-value", message)
            .help("write size = (width, height) in pixels, such as size = (800, 600)"));
    }
    // Compared as f64: sides of 1e300 do not fit into integers.
    if width * height > max_pixels as f64 || width.max(height) > f64::from(u32::MAX) {
        let message = format!(
            "size of render: {width} x {height} is more than the limit of {max_pixels} pixels"
        );
        return Err(args
            .error("size", "too-large", message)
            .help("make the picture smaller, or raise the limit with --max-pixels"));
    }
    Ok([width as u32, height as u32])
}

fn samples(args: &Args, antialias: Antialias) -> Result<(u32, u32), Diagnostic> {
    let whole = |name| Ok(args.optional_number(name)?.map(|n| n as u32));
    let (samples, max) = (whole("samples")?, whole("max_samples")?);
    let samples = match (antialias, samples) {
        (Antialias::None, _) | (_, None) => antialias.default_samples(),
        (Antialias::Report, Some(n)) if n != 4 => {
            let message = format!("samples of render: \"report\" takes 4 samples, got {n}");
            return Err(args
                .error("samples", "wrong-value", message)
                .help("leave samples out, or write antialias = \"grid\""));
        }
        (_, Some(n)) => n,
    };
    if antialias != Antialias::Adaptive {
        return Ok((samples, samples));
    }
    let max = max.unwrap_or(samples.saturating_mul(16).min(MAX_SAMPLES));
    if max < samples {
        let message = format!(
            "max_samples of render: expected at least samples, which is {samples}, got {max}"
        );
        return Err(args
            .error("max_samples", "wrong-value", message)
            .help(format!("write max_samples = {} or make samples smaller", samples * 4)));
    }
    Ok((samples, max))
}

#[cfg(test)]
#[path = "render_tests.rs"]
mod tests;
