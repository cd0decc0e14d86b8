// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a film to the bytes of a picture's file: what `render` and `merge` share.

use std::path::Path;

use dioptric::formats::ParamInfo;
use dioptric::image::{
    Depth, Develop, EncodeOptions, FileFormat, ImageError, Layers, draw_grid, encode,
};
use dioptric::render::Film;
use dioptric::render::region::Region;
use dioptric::render::setting::develop;
use dioptric::scene::{Description, Value as SceneValue};
use rayon::ThreadPool;
use serde_json::{Value, json};

use super::denoise::{DenoiseOptions, Ready};
use super::failure::Failure;

/// How a picture is written.
#[derive(Clone, Debug, clap::Args)]
pub struct FileOptions {
    /// The format of a picture on standard output: png, jpg, exr or hdr.
    #[arg(long, value_name = "FORMAT", default_value = "png")]
    to: String,
    /// Bits of a channel in PNG: 8 or 16.
    #[arg(long, value_name = "N", default_value = "8", value_parser = ["8", "16"])]
    bits: String,
    /// Quality of JPEG.
    #[arg(long, value_name = "Q", default_value_t = 92, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Writes depth, normal, albedo, object and samples as further layers; needs .exr.
    #[arg(long)]
    pub layers: bool,
    #[command(flatten)]
    pub denoise: DenoiseOptions,
}

impl FileOptions {
    /// The format of a file of this name.
    ///
    /// # Errors
    /// There is none, or it cannot hold what was asked for.
    pub fn format(&self, output: &str) -> Result<FileFormat, Failure> {
        let stdout = format!("stdout.{}", self.to);
        let name = if output == "-" { &stdout } else { output };
        let format = FileFormat::from_path(Path::new(name))
            .map_err(|e| Failure::usage(e.message, e.help))?;
        if self.layers && format != FileFormat::Exr {
            return Err(Failure::usage("only .exr files have layers", "write -o FILE.exr"));
        }
        if self.bits == "16" && format != FileFormat::Png {
            return Err(Failure::usage(
                "only .png files have 16 bits",
                "write -o FILE.png, or .exr for floats",
            ));
        }
        Ok(format)
    }

    /// Whether what the camera rays hit first is needed.
    pub const fn needs_layers(&self) -> bool {
        self.layers || self.denoise.denoise.is_some()
    }

    /// The bytes of the picture's file, without its noise where there is a denoiser; with `grid` coordinates are drawn
    /// over it.
    ///
    /// # Errors
    /// The format cannot hold it; the denoiser fails.
    pub fn encode(
        &self,
        film: &Film,
        labels: &Labels,
        unfinished: Option<String>,
        (format, grid): (FileFormat, bool),
        (denoiser, pool): (Option<&Ready>, &ThreadPool),
        name: &str,
    ) -> Result<Vec<u8>, Failure> {
        let wrong = |e: ImageError| Failure::image(name, &e);
        // An unfinished picture is transparent where there is nothing yet, and has no noise to be judged.
        let mut layers = film.to_layers(unfinished.is_some()).map_err(wrong)?;
        if let Some(denoiser) = denoiser.filter(|_| unfinished.is_none()) {
            denoiser.apply(&mut layers, pool)?;
        }
        if !self.layers {
            let metadata = std::mem::take(&mut layers.metadata);
            layers = Layers::from(layers.picture);
            layers.metadata = metadata;
        }
        let Region { x, y, .. } = film.region();
        if grid {
            layers.picture = labels.develop.picture(&layers.picture);
            draw_grid(&mut layers.picture, x, y, 0);
        }
        let text = &mut layers.metadata;
        text.set("Software", format!("dioptric {}", dioptric::VERSION));
        text.set("Settings", labels.settings.to_string());
        let further = [
            ("Params", labels.params.clone()),
            ("Frame", labels.frame.map(|n| n.to_string())),
            ("Unfinished", unfinished.map(|how| format!("stopped at {how}"))),
        ];
        for (name, value) in further {
            if let Some(value) = value {
                text.set(name, value);
            }
        }
        let depth = if self.bits == "16" { Depth::Sixteen } else { Depth::Eight };
        let options = EncodeOptions { develop: labels.develop, depth, quality: self.quality };
        encode(&layers, format, &options).map_err(wrong)
    }
}

/// What a picture's file says beside the picture, and how the light is developed.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// The settings, as `--stats` writes them.
    pub settings: Value,
    /// From light to the picture's values.
    pub develop: Develop,
    /// The params that were set.
    pub params: Option<String>,
    /// The frame of an animation.
    pub frame: Option<i32>,
}

impl Labels {
    /// Of a picture.
    pub fn new(
        settings: Value,
        develop: Develop,
        params: &[ParamInfo],
        frame: Option<i32>,
    ) -> Self {
        let set: Vec<String> = params
            .iter()
            .filter(|p| p.value != p.default)
            .map(|p| format!("{} = {}", p.name, super::info::written(&p.value)))
            .collect();
        let params = (!set.is_empty()).then(|| set.join("; "));
        Self { settings, develop, params, frame }
    }

    /// As JSON, for parts.
    pub fn to_json(&self) -> Value {
        let develop = &self.develop;
        json!({
            "settings": self.settings,
            "develop": [develop.exposure, develop.tone.name(), develop.encoding.name()],
            "params": self.params,
            "frame": self.frame,
        })
    }

    /// From such JSON.
    pub fn from_json(json: &Value) -> Option<Self> {
        let text = |i: usize| Some(SceneValue::from(json["develop"][i].as_str()?));
        let values = [
            ("exposure", SceneValue::Number(json["develop"][0].as_f64()?)),
            ("tone", text(1)?),
            ("encoding", text(2)?),
        ];
        Some(Self {
            settings: json["settings"].clone(),
            develop: develop::from_scene(&Description::default(), &values).ok()?,
            params: json["params"].as_str().map(Into::into),
            frame: json["frame"].as_i64().and_then(|n| i32::try_from(n).ok()),
        })
    }
}
