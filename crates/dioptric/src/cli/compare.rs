// SPDX-License-Identifier: MIT OR Apache-2.0
//! `compare`: how far apart two pictures are, in numbers and as one figure.

use dioptric::image::compare::{Comparison, compare, flip, side_by_side};
use dioptric::image::{EncodeOptions, FileFormat, Image, Layers, decode, encode};

use super::failure::Failure;
use super::output::Output;
use super::terminal;

/// Compares two pictures: exit status 0 if they are alike, 1 if they differ beyond the tolerance.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  dioptric compare a.png b.png --tolerance 1/255\n  \
                        dioptric compare with.png without.png -o figure.png")]
pub struct CompareArgs {
    /// The first picture: PNG, JPEG, BMP, TGA, HDR or EXR.
    a: String,
    /// The second picture, of the same size.
    b: String,
    /// Writes both pictures and their difference side by side.
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// The difference of a channel that counts as none, 0 to 1; fractions such as 1/255 too.
    #[arg(long, value_name = "T", default_value = "0", value_parser = fraction)]
    tolerance: f64,
    /// The share of the pixels that may differ by more, 0 to 1.
    #[arg(long, value_name = "S", default_value = "0", value_parser = fraction)]
    share: f64,
    /// How much the figure amplifies the difference.
    #[arg(long, value_name = "N", default_value = "1", value_parser = positive)]
    amplify: f64,
    /// Prints the numbers as JSON.
    #[arg(long)]
    json: bool,
}

/// A number of at least 0: `0.01` or `1/255`.
fn fraction(text: &str) -> Result<f64, String> {
    let number = |t: &str| t.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((over, under)) => number(over).zip(number(under)).map(|(a, b)| a / b),
        None => number(text),
    };
    value
        .filter(|v| v.is_finite() && *v >= 0.0)
        .ok_or_else(|| "write a number of at least 0, such as 0.01 or 1/255".into())
}

fn positive(text: &str) -> Result<f64, String> {
    fraction(text).ok().filter(|v| *v > 0.0).ok_or_else(|| "write a number above 0".into())
}

/// Compares, prints and writes.
pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    let figure = args.output.as_deref().map(figure_output).transpose()?;
    let (a, b) = (read_picture(&args.a)?, read_picture(&args.b)?);
    let wrong = |e| Failure::image(&format!("{} and {}", args.a, args.b), &e);
    let numbers = compare(&a, &b, args.tolerance).map_err(wrong)?;
    let perceived = flip(&a, &b, flip::PIXELS_PER_DEGREE).map_err(wrong)?;
    let same = numbers.share_above <= args.share;
    if let Some((output, format)) = &figure {
        let drawn = side_by_side(&a, &b, [&args.a, &args.b], args.amplify).map_err(wrong)?;
        let bytes = encode(&Layers::from(drawn), *format, &EncodeOptions::default())
            .map_err(|e| Failure::image(&output.to_string(), &e))?;
        output.write(&bytes)?;
    }
    // A figure on standard output leaves no room for words there.
    if !figure.is_some_and(|(output, _)| output.is_stdout()) {
        let text = if args.json {
            json(&numbers, perceived.mean, same)
        } else {
            words(&numbers, perceived.mean, args.tolerance)
        };
        terminal::print(text.as_bytes())?;
    }
    if same { Ok(()) } else { Err(Failure::Negative) }
}

fn figure_output(path: &str) -> Result<(Output, FileFormat), Failure> {
    let format =
        if path == "-" { Ok(FileFormat::Png) } else { FileFormat::from_path(path.as_ref()) };
    let format = format.map_err(|e| Failure::usage(e.message, e.help))?;
    Ok((Output::new(path)?, format))
}

/// Pixels of a picture that is read: 2^28, as many as one that is rendered may have.
const MAX_PIXELS: u64 = 1 << 28;

/// Reads a picture file.
pub fn read_picture(path: &str) -> Result<Image, Failure> {
    let bytes = if path == "-" { terminal::read_stdin() } else { std::fs::read(path) };
    let bytes = bytes.map_err(|e| Failure::input(path, &e))?;
    decode(&bytes, path, MAX_PIXELS).map_err(|e| Failure::image(path, &e))
}

fn words(c: &Comparison, perceived: f64, tolerance: f64) -> String {
    if c.max_difference == 0.0 {
        return "identical\n".into();
    }
    format!(
        "RMSE {:.6}, PSNR {:.2} dB, FLIP {perceived:.4}\n\
         largest difference {:.6} at {},{}\n\
         {:.4} % of the pixels differ by more than {tolerance}\n",
        c.rmse,
        c.psnr,
        c.max_difference,
        c.worst.0,
        c.worst.1,
        c.share_above * 100.0,
    )
}

fn json(c: &Comparison, perceived: f64, same: bool) -> String {
    // JSON has no infinity: the PSNR of identical pictures is null.
    let value = serde_json::json!({
        "same": same,
        "rmse": c.rmse,
        "psnr": c.psnr.is_finite().then_some(c.psnr),
        "flip": perceived,
        "max_difference": c.max_difference,
        "worst": [c.worst.0, c.worst.1],
        "share_above": c.share_above,
    });
    format!("{value}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_numbers_or_fractions() {
        assert_eq!(fraction("1/255"), Ok(1.0 / 255.0));
        assert_eq!(fraction("0.5"), Ok(0.5));
        for wrong in ["", "x", "-1", "1/0", "nan", "1/x", "inf"] {
            assert!(fraction(wrong).is_err(), "{wrong}");
        }
        assert!(positive("0").is_err());
    }
}
