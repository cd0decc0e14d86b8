// SPDX-License-Identifier: MIT OR Apache-2.0
//! Long renders through the real program: kept, killed, gone on with, split and merged, always the same bytes.

use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::run::{Folder, Ran, good, program, run};

/// Two balls under a lamp, by paths; the sphere's radius is a param.
const SCENE: &str = r#"
version(1)
render(size = (40, 30), samples = 24, integrator = "path")
camera(eye = (0, 1, 6), look_at = (0, 0.8, 0), fov = 40)
background("skyblue")
plane(point = (0, 0, 0), material = matte("wheat"))
sphere(center = (-0.9, 0.8, 0), radius = param("radius", 0.8), material = glass(ior = 1.5))
sphere(center = (0.9, 0.8, 0), radius = 0.8, material = metal("gold", roughness = 0.2))
sphere(center = (0, 4, 1), radius = 0.5, material = glow("white", strength = 12))
"#;

struct Place {
    folder: Folder,
    scene: String,
}

impl Place {
    fn new(name: &str) -> Self {
        let folder = Folder::new(name);
        let scene = folder.file("scene.star");
        std::fs::write(&scene, SCENE).unwrap();
        Self { folder, scene }
    }

    fn args<'a>(&'a self, more: &'a [&'a str]) -> Vec<&'a str> {
        [&["render", &self.scene, "--quiet"], more].concat()
    }

    /// Renders; names are those of files in the folder.
    fn render(&self, output: Option<&str>, part: &str, more: &[&str]) -> Ran {
        let (out, part) = (self.folder.file(output.unwrap_or_default()), self.folder.file(part));
        let mut args = vec!["--checkpoint", &part];
        args.extend(more);
        if output.is_some() {
            args.extend(["-o", &out]);
        }
        run(&self.args(&args))
    }

    fn whole(&self, more: &[&str]) -> Vec<u8> {
        let out = self.folder.file("whole.png");
        good(&self.args(&[&["-o", &out], more].concat()));
        self.folder.bytes("whole.png")
    }
}

#[test]
fn split_and_merged_pictures_have_the_bytes_of_the_whole() {
    let place = Place::new("merge");
    let file = |name: &str| place.folder.file(name);
    for (ranges, more) in [
        (&["1-8", "9-16", "17-24"][..], &[][..]),
        (&["14-24", "1-13"], &["--threads", "2", "--set", "radius=0.7"]),
        (&["1-1", "2-24"], &["--antialias", "jitter", "--crop", "5,6,20,11"]),
        (&["1-5", "6-24"], &["--filter", "mitchell"]),
    ] {
        let whole = place.whole(more);
        let mut args = vec!["merge".to_string(), "-o".into(), file("merged.png")];
        for (i, range) in ranges.iter().enumerate() {
            let part = format!("{i}.part");
            let _ = std::fs::remove_file(file(&part));
            let ran = place.render(None, &part, &[&["--sample-range", range], more].concat());
            assert_eq!((ran.status, ran.stderr.as_str()), (0, ""));
            args.push(file(&part));
        }
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        good(&args);
        assert!(place.folder.bytes("merged.png") == whole, "{ranges:?}");
    }
    assert!(!place.folder.names().contains(&"scene.png".to_string()));
}

#[test]
fn layers_are_kept_and_merged_too() {
    let place = Place::new("layers");
    let (whole, merged) = (place.folder.file("whole.exr"), place.folder.file("merged.exr"));
    good(&place.args(&["--layers", "-o", &whole]));
    let parts = [place.folder.file("a.part"), place.folder.file("b.part")];
    for (part, range) in parts.iter().zip(["1-10", "11-24"]) {
        good(&place.args(&[
            "--layers",
            "-o",
            &whole.replace("whole", "x"),
            "--checkpoint",
            part,
            "--sample-range",
            range,
        ]));
    }
    good(&["merge", &parts[1], &parts[0], "--layers", "-o", &merged, "-q"]);
    assert!(place.folder.bytes("merged.exr") == place.folder.bytes("whole.exr"));
}

#[test]
fn a_finished_picture_is_gone_on_with_to_more_samples() {
    let place = Place::new("more");
    assert_eq!(place.render(Some("few.png"), "a.part", &["--samples", "8"]).status, 0);
    assert_eq!(place.render(Some("many.png"), "a.part", &["--resume"]).status, 0);
    assert!(place.folder.bytes("many.png") == place.whole(&[]));
    // Again, there is nothing to do.
    assert_eq!(place.render(Some("again.png"), "a.part", &["--resume"]).status, 0);
    assert!(place.folder.bytes("again.png") == place.whole(&[]));
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let place = Place::new("refused");
    let file = |name: &str| place.folder.file(name);
    let make = |part: &str, more: &[&str]| {
        let ran = place.render(None, part, more);
        assert_eq!(ran.status, 0, "{}", ran.stderr);
    };
    make("a.part", &["--sample-range", "1-8"]);
    make("b.part", &["--sample-range", "8-20"]);
    make("c.part", &["--sample-range", "17-24"]);
    make("seed.part", &["--sample-range", "9-24", "--seed", "3"]);
    make("scene.part", &["--sample-range", "9-24", "--set", "radius=0.5"]);
    make("crop.part", &["--sample-range", "9-24", "--crop", "0,0,5,5"]);
    make("count.part", &["--sample-range", "9-24", "--samples", "32"]);
    make("layers.part", &["--sample-range", "9-24", "--layers"]);
    for (other, says) in [
        ("b.part", "overlap: both have samples 8 to 8"),
        ("c.part", "samples 9 to 16 of 24 are missing in"),
        ("seed.part", "do not belong together: seed is 0.0 and 3.0"),
        ("scene.part", "do not belong together: another scene"),
        ("crop.part", "one is 40 x 30 pixels from 0,0, the other 5 x 5 pixels from 0,0"),
        ("count.part", "samples is 24.0 and 32.0"),
        ("layers.part", "only one has layers"),
        ("scene.star", "it is no part"),
        ("none.part", "no such file or folder"),
    ] {
        let (a, b) = (file("a.part"), file(other));
        let ran = run(&["merge", &a, &b, "-o", &file("out.png")]);
        assert_eq!(ran.status, 1, "{other}");
        assert!(ran.stderr.contains(says), "{other}: {}", ran.stderr);
        assert!(ran.stderr.contains(other), "{other}: {}", ran.stderr);
        assert!(ran.stderr.contains("help: "), "{other}: {}", ran.stderr);
    }
    for (more, status, says) in [
        (&[][..], 1, "a.part is there already"),
        (&["--resume", "--seed", "4"], 1, "do not belong together: seed is 0.0 and 4.0"),
        (&["--resume", "--size", "20x20"], 1, "do not belong together: size is"),
        (&["--resume", "--layers"], 1, "was made without layers"),
        (&["--sample-range", "20-25"], 2, "--sample-range ends at 25, but a pixel has 24 samples"),
        (&["--antialias", "adaptive"], 2, "adaptive pictures are made in one go"),
    ] {
        let output = if more.contains(&"--layers") { "out.exr" } else { "out.png" };
        let ran = place.render(Some(output), "a.part", more);
        assert_eq!(ran.status, status, "{more:?} {}", ran.stderr);
        assert!(ran.stderr.contains(says), "{more:?}: {}", ran.stderr);
    }
    assert!(!place.folder.names().iter().any(|name| name.starts_with("out")));
}

#[test]
fn damaged_checkpoints_are_refused() {
    let place = Place::new("damaged");
    assert_eq!(place.render(Some("a.png"), "a.part", &["--size", "8x6"]).status, 0);
    let bytes = place.folder.bytes("a.part");
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 4;
    let mut longer = bytes.clone();
    longer.push(0);
    for wrong in [&bytes[..0], &bytes[..30], &bytes[..bytes.len() - 1], &flipped, &longer] {
        std::fs::write(place.folder.file("a.part"), wrong).unwrap();
        let ran = place.render(Some("b.png"), "a.part", &["--size", "8x6", "--resume"]);
        assert_eq!(ran.status, 1, "{}", ran.stderr);
        assert!(ran.stderr.contains("a.part: it is"), "{}", ran.stderr);
    }
}

/// Starts the render `times` times, kills it each time a while later, and lets it end at last; the whole takes about
/// `whole`.
fn kill_and_resume(place: &Place, number: u64, times: u64, whole: Duration) -> Vec<u8> {
    let (part, out) = (format!("{number}.part"), format!("{number}.png"));
    let (part_file, out_file) = (place.folder.file(&part), place.folder.file(&out));
    let args =
        ["--checkpoint", &part_file, "--checkpoint-every", "0s", "--resume", "-o", &out_file];
    for time in 0..times {
        let mut child = program(&place.args(&args)).stderr(Stdio::null()).spawn().unwrap();
        // Other moments each time, spread over the whole.
        let share = (number * 7 + time * 3 + 1) * 61 % 97;
        sleep(whole * share as u32 / 97);
        let _ = child.kill();
        child.wait().unwrap();
    }
    good(&place.args(&args));
    place.folder.bytes(&out)
}

fn killed(count: u64) {
    let place = Place::new("killed");
    let whole = place.whole(&[]);
    let started = Instant::now();
    assert_eq!(
        place.render(Some("timed.png"), "timed.part", &["--checkpoint-every", "0s"]).status,
        0
    );
    let time = started.elapsed();
    for number in 0..count {
        let times = 1 + number % 3;
        assert!(kill_and_resume(&place, number, times, time) == whole, "render {number}");
    }
}

#[test]
fn killed_renders_are_gone_on_with_to_the_same_bytes() {
    killed(8);
}

#[test]
#[ignore = "slow: cargo test --release -p dioptric --test program fifty -- --ignored"]
fn fifty_killed_renders_are_gone_on_with_to_the_same_bytes() {
    killed(50);
}
