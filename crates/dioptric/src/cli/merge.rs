// SPDX-License-Identifier: MIT OR Apache-2.0
//! `merge`: parts of a picture put together.

use std::ops::Range;
use std::path::Path;

use dioptric::render::parts;

use super::encode::{FileOptions, Labels};
use super::failure::Failure;
use super::long::{Kept, Samples, replace, shown};
use super::output::Output;
use super::picture_options;
use super::terminal::note;

/// Puts parts of a picture together that render --checkpoint has made: the bytes of a render in one go.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    dioptric render scene.star --samples 64 --sample-range 1-32 --checkpoint a.part\n  \
    dioptric render scene.star --samples 64 --sample-range 33-64 --checkpoint b.part\n  \
    dioptric merge a.part b.part -o scene.png")]
pub struct MergeArgs {
    /// The parts.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<String>,
    /// The picture: .png, .jpg, .exr or .hdr; - for standard output.
    #[arg(short, long, value_name = "FILE", required_unless_present = "checkpoint")]
    output: Option<String>,
    /// Writes the parts as one, which may still lack samples.
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<String>,
    #[command(flatten)]
    file: FileOptions,
    /// Says nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Reads, merges and writes.
pub fn run(args: &MergeArgs) -> Result<(), Failure> {
    let output = match &args.output {
        Some(name) => Some((Output::new(name)?, args.file.format(name)?)),
        None => None,
    };
    let mut files = args.parts.iter();
    let Some(first) = files.next() else { return Ok(()) };
    let Kept { identity, part: mut merged } = Kept::read(first)?;
    let mut has: Vec<(&str, Vec<Range<u32>>)> = vec![(first, merged.ranges())];
    let mut stopped: Vec<&str> = Vec::new();
    stopped.extend(merged.is_begun().then_some(first.as_str()));
    for file in files {
        let Kept { identity: own, part } = Kept::read(file)?;
        identity.check(first, &own, file, Samples::MustAgree)?;
        if merged.region() != part.region() {
            let [a, b] = [merged.region(), part.region()].map(shown);
            return Err(apart(first, file, &format!("one is {a}, the other {b}")));
        }
        if merged.has_layers() != part.has_layers() {
            return Err(apart(first, file, "only one has layers"));
        }
        stopped.extend(part.is_begun().then_some(file.as_str()));
        let ranges = part.ranges();
        if let Err(both) = merged.merge(part) {
            let owner = has.iter().find(|(_, ranges)| {
                ranges.iter().any(|r| r.start < both.end && both.start < r.end)
            });
            let owner = owner.map_or(first.as_str(), |(name, _)| name);
            return Err(Failure::File {
                message: format!("{owner} and {file} overlap: both have samples {}", words(&both)),
                help: "take each sample from one part only".into(),
            });
        }
        has.push((file, ranges));
    }
    if let Some(file) = &args.checkpoint {
        let text = identity.0.to_string();
        replace(Path::new(file), |out| parts::write(&merged, None, &text, out))
            .map_err(|e| Failure::output(file, &e))?;
    }
    let denoiser = args.file.denoise.ready()?;
    let Some((output, format)) = output else { return Ok(()) };
    let labels = Labels::from_json(&identity.0["picture"]);
    let samples = identity.0["render"]["samples"].as_f64();
    let Some((labels, samples)) = labels.zip(samples.map(|n| n as u32)) else {
        return Err(Failure::File {
            message: format!("cannot use {first}: its text makes no sense"),
            help: "render it anew".into(),
        });
    };
    let wanted = 0..samples;
    let missing: Vec<String> = merged.missing(&wanted).iter().map(words).collect();
    if !missing.is_empty() {
        let help = match stopped.first() {
            Some(part) => format!("{part} was stopped: go on with it with render --resume"),
            None => format!("render them with --sample-range {}", missing[0].replace(" to ", "-")),
        };
        let message = format!(
            "samples {} of {samples} are missing in {}",
            missing.join(" and "),
            args.parts.join(", ")
        );
        return Err(Failure::File { message, help });
    }
    if args.file.needs_layers() && !merged.has_layers() {
        return Err(Failure::File {
            message: format!("{first} has no layers"),
            help: "render the parts with --layers, too".into(),
        });
    }
    let scene = |e| Failure::Scene(vec![e], Default::default());
    let film = merged.film(&wanted).map_err(scene)?;
    let pool = picture_options::pool(None)?;
    let cleaning = (denoiser.as_ref(), &pool);
    let name = output.to_string();
    output.write(&args.file.encode(&film, &labels, None, (format, false), cleaning, &name)?)?;
    if !args.quiet && !output.is_stdout() {
        note(&format!("{output}: {samples} samples from {} parts\n", args.parts.len()));
    }
    Ok(())
}

fn apart(a: &str, b: &str, why: &str) -> Failure {
    Failure::File {
        message: format!("{a} and {b} do not belong together: {why}"),
        help: "render all parts with the same --size, --crop and --layers".into(),
    }
}

/// Samples as people count them.
fn words(range: &Range<u32>) -> String {
    format!("{} to {}", range.start + 1, range.end)
}
