// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a picture shall be like, above what the scene says: the options that `render` and `why` share.

use dioptric::render::compile::Options;
use dioptric::render::region::Region;
use dioptric::render::setting::{develop, render::RenderSettings};
use dioptric::scene::{Description, Diagnostic, Value};

use super::failure::Failure;

/// Settings of the picture; each wins over the scene's.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Picture (wins over the scene's render and develop)")]
pub struct PictureOptions {
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[f64; 2]>,
    /// Only a part of the picture: left column, top row, width, height.
    #[arg(long, value_name = "X,Y,W,H", value_parser = four)]
    crop: Option<[u32; 4]>,
    /// Samples of a pixel.
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// How they are placed: none, grid, report, jitter, sobol or adaptive.
    #[arg(long, value_name = "MODE")]
    antialias: Option<String>,
    /// With adaptive: the difference of neighbours that asks for more samples, 0 to 1.
    #[arg(long, value_name = "D")]
    threshold: Option<f64>,
    /// With adaptive, --noise and --budget: the most samples of a pixel.
    #[arg(long, value_name = "N")]
    pub max_samples: Option<u32>,
    /// How samples are weighed: box, tent, gaussian, mitchell or blackman_harris.
    #[arg(long, value_name = "NAME")]
    filter: Option<String>,
    /// Half the filter's width in pixels.
    #[arg(long, value_name = "R")]
    filter_radius: Option<f64>,
    /// What is shown: whitted, path, eyelight, normals, depth, uv, object, material, cost or rays.
    #[arg(long, value_name = "NAME")]
    integrator: Option<String>,
    /// At most so many reflections and passes, one after the other.
    #[arg(long, value_name = "N")]
    bounces: Option<u32>,
    /// Rays that can change a pixel by less are not followed.
    #[arg(long, value_name = "SHARE")]
    min_contribution: Option<f64>,
    /// With path: cuts indirect light off at this radiance (biased).
    #[arg(long, value_name = "RADIANCE")]
    clamp: Option<f64>,
    /// With path: photons that find where glass and mirrors gather light; 100000 are a good number.
    #[arg(long, value_name = "N")]
    caustics: Option<u32>,
    /// What blocks light: opaque, tinted or none.
    #[arg(long, value_name = "KIND")]
    shadows: Option<String>,
    /// Another number gives other random numbers.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Multiplies the light.
    #[arg(long, value_name = "E")]
    exposure: Option<f64>,
    /// The tone curve: none, reinhard, filmic, aces, agx or neutral.
    #[arg(long, value_name = "NAME")]
    tone: Option<String>,
    /// What the picture's numbers mean: srgb, raw or gamma.
    #[arg(long, value_name = "NAME")]
    encoding: Option<String>,
    /// Pixels that the picture may have.
    #[arg(long, value_name = "N", default_value_t = 1 << 28, help_heading = "Limits")]
    max_pixels: u64,
    /// Threads that work; the picture is the same for any number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = "Work")]
    threads: Option<u16>,
}

impl PictureOptions {
    /// What the scene is compiled with.
    ///
    /// # Errors
    /// An option has a value that no scene could have.
    pub fn compile_options(
        &self,
        camera: Option<&str>,
        max_objects: usize,
    ) -> Result<Options, Failure> {
        let (render, develop) = (self.render(), self.develop());
        let nothing = Description::default();
        RenderSettings::from_scene(&nothing, &render, self.max_pixels).map_err(wrong)?;
        develop::from_scene(&nothing, &develop).map_err(wrong)?;
        let owned = |args: Vec<(&str, Value)>| {
            args.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
        };
        Ok(Options {
            render: owned(render),
            develop: owned(develop),
            max_pixels: self.max_pixels,
            camera: camera.map(Into::into),
            max_objects,
            ..Options::default()
        })
    }

    /// The part of the picture that is wanted.
    ///
    /// # Errors
    /// It is not inside.
    pub fn region(&self, size: [u32; 2]) -> Result<Region, Failure> {
        match self.crop {
            None => Ok(Region::full(size)),
            Some(crop) => Region::crop(size, crop).map_err(wrong),
        }
    }

    /// The threads that the picture is made with.
    ///
    /// # Errors
    /// The system gives none.
    pub fn pool(&self) -> Result<rayon::ThreadPool, Failure> {
        pool(self.threads)
    }

    fn render(&self) -> Vec<(&'static str, Value)> {
        let number = |n: Option<f64>| n.map(Value::Number);
        let text = |t: &Option<String>| t.as_deref().map(|t| Value::Text(t.into()));
        let all = [
            ("size", self.size.map(Value::Vec2)),
            ("samples", number(self.samples.map(f64::from))),
            ("antialias", text(&self.antialias)),
            ("threshold", number(self.threshold)),
            ("max_samples", number(self.max_samples.map(f64::from))),
            ("filter", text(&self.filter)),
            ("filter_radius", number(self.filter_radius)),
            ("integrator", text(&self.integrator)),
            ("bounces", number(self.bounces.map(f64::from))),
            ("min_contribution", number(self.min_contribution)),
            ("clamp", number(self.clamp)),
            ("caustics", number(self.caustics.map(f64::from))),
            ("shadows", text(&self.shadows)),
            ("seed", number(self.seed.map(|n| n as f64))),
        ];
        all.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
    }

    fn develop(&self) -> Vec<(&'static str, Value)> {
        let text = |t: &Option<String>| t.as_deref().map(|t| Value::Text(t.into()));
        let all = [
            ("exposure", self.exposure.map(Value::Number)),
            ("tone", text(&self.tone)),
            ("encoding", text(&self.encoding)),
        ];
        all.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
    }
}

/// So many threads, as many as the machine has where nothing is said.
///
/// # Errors
/// The system gives none.
pub fn pool(threads: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    let threads = threads.map_or_else(
        || std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        usize::from,
    );
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Failure::File {
        message: format!("cannot start {threads} threads: {e}"),
        help: "ask for fewer with --threads".into(),
    })
}

/// What is wrong with an option is wrong usage, not the scene's fault.
fn wrong(error: Diagnostic) -> Failure {
    let message = error.message.replacen(" of render:", ":", 1).replacen(" of develop:", ":", 1);
    let help = error.help.unwrap_or_else(|| "see dioptric render --help".into());
    Failure::usage(format!("--{}", message.replace("the crop ", "crop: ")), help)
}

fn size(text: &str) -> Result<[f64; 2], String> {
    let side = |t: &str| t.parse::<u32>().ok().filter(|n| *n > 0).map(f64::from);
    text.split_once(['x', 'X'])
        .and_then(|(w, h)| Some([side(w)?, side(h)?]))
        .ok_or_else(|| "write WIDTHxHEIGHT in pixels, such as 800x600".into())
}

/// Four whole numbers with commas between.
pub fn four(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
    numbers
        .and_then(|n| n.try_into().ok())
        .ok_or_else(|| "write X,Y,WIDTH,HEIGHT in pixels, such as 100,50,64,64".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_crops_are_read_or_explained() {
        assert_eq!(size("800x600"), Ok([800.0, 600.0]));
        for wrong in ["0x5", "800", "800x", "-1x5", "99999999999x1", "8.5x2"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(four("1, 2,3,4"), Ok([1, 2, 3, 4]));
        for wrong in ["1,2,3", "1,2,3,4,5", "a,b,c,d", "-1,0,1,1"] {
            assert!(four(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn options_are_checked_by_the_settings_own_schema() {
        let options = PictureOptions {
            antialias: Some("sobal".into()),
            max_pixels: 100,
            ..PictureOptions::default()
        };
        let Err(Failure::Usage { message, .. }) = options.compile_options(None, 10) else {
            panic!("a misspelt mode is wrong usage");
        };
        assert!(message.starts_with("--antialias: expected one of"), "{message}");
    }
}
