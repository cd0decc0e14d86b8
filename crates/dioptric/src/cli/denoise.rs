// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--denoise`: which denoiser, where it is, and the picture with its noise taken out.

use std::path::Path;

use clap::ValueEnum;
use dioptric::denoise::{Picture, oidn::Oidn, plain};
use dioptric::image::{LayerData, Layers};
use rayon::ThreadPool;

use super::failure::Failure;
use super::terminal::note;

/// The environment's variable that names the library.
const VARIABLE: &str = "DIOPTRIC_OIDN";

/// How noise is taken out.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct DenoiseOptions {
    /// Takes the noise out of the finished picture: by Intel Open Image Denoise (=oidn), by a plain filter (=plain), or by the
    /// first where it is installed, else the second (=auto, and without a word).
    #[arg(long, value_name = "BY", num_args = 0..=1, require_equals = true, default_missing_value = "auto")]
    pub denoise: Option<Denoiser>,
    /// The library of Open Image Denoise, or its folder; else DIOPTRIC_OIDN in the environment, else where the system
    /// looks.
    #[arg(long, value_name = "FILE", requires = "denoise")]
    oidn: Option<String>,
}

/// A way to take noise out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Denoiser {
    /// Intel Open Image Denoise, else the plain filter.
    Auto,
    /// Intel Open Image Denoise.
    Oidn,
    /// The plain filter.
    Plain,
}

/// A denoiser that can begin.
pub enum Ready {
    /// Intel Open Image Denoise.
    Oidn(Oidn),
    /// The plain filter.
    Plain,
}

impl DenoiseOptions {
    /// The denoiser that was asked for; found before the work begins.
    ///
    /// # Errors
    /// It is not installed.
    pub fn ready(&self) -> Result<Option<Ready>, Failure> {
        let Some(denoiser) = self.denoise else { return Ok(None) };
        if denoiser == Denoiser::Plain {
            return Ok(Some(Ready::Plain));
        }
        let variable = std::env::var(VARIABLE).ok().filter(|value| !value.is_empty());
        let place = self.oidn.clone().or(variable);
        match Oidn::load(place.as_deref().map(Path::new)) {
            Ok(library) => Ok(Some(Ready::Oidn(library))),
            // A place that was named and is wrong is not passed over.
            Err(_) if denoiser == Denoiser::Auto && place.is_none() => {
                note(
                    "note: Open Image Denoise is not installed: the plain filter takes the noise out\n",
                );
                Ok(Some(Ready::Plain))
            }
            Err(reason) => Err(Failure::File {
                message: format!("cannot load Open Image Denoise: {reason}"),
                help: format!(
                    "install it (your system's package, or pip install pyoidn) and name its library by --oidn FILE or \
                     {VARIABLE}; or write --denoise=plain"
                ),
            }),
        }
    }
}

impl Ready {
    /// Takes the noise out of a picture, and notes in its metadata that this was done.
    ///
    /// # Errors
    /// The layers are not there; the library says what is wrong.
    pub fn apply(&self, layers: &mut Layers, pool: &ThreadPool) -> Result<(), Failure> {
        let wrong = |reason: String| Failure::File {
            message: format!("cannot take the noise out: {reason}"),
            help: "write --denoise=plain, or leave --denoise out".into(),
        };
        let (
            Some(LayerData::Color(albedo)),
            Some(LayerData::Vector(normal)),
            Some(LayerData::Scalar(depth)),
        ) = (layers.get("albedo"), layers.get("normal"), layers.get("depth"))
        else {
            return Err(wrong("the picture has no layers".into()));
        };
        let color: Vec<[f32; 3]> =
            layers.picture.pixels().iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        let picture = Picture {
            width: layers.picture.width() as usize,
            height: layers.picture.height() as usize,
            color: &color,
            albedo,
            normal,
            depth,
        };
        let (clean, by) = match self {
            Self::Oidn(library) => {
                let clean = library.denoise(&picture, pool.current_num_threads()).map_err(wrong)?;
                (clean, "Intel Open Image Denoise")
            }
            Self::Plain => (pool.install(|| plain::denoise(&picture)), "the plain filter"),
        };
        for (pixel, [r, g, b]) in layers.picture.pixels_mut().iter_mut().zip(clean) {
            *pixel = [r, g, b, pixel[3]];
        }
        layers.metadata.set("Denoised", format!("by {by}"));
        Ok(())
    }
}
