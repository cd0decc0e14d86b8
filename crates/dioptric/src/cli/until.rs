// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures that are sampled until they are good enough, or until the time is up.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use dioptric::render::job::{self, Control};
use dioptric::render::noise::{Goal, Reached};
use dioptric::render::parts::{self, Part, Wanted};
use dioptric::render::region::Region;
use dioptric::render::sampling::Antialias;
use dioptric::render::scene::Scene;
use dioptric::render::setting::render::MAX_SAMPLES;
use dioptric::render::{Film, picture};
use dioptric::scene::{Diagnostic, Sources};
use rayon::ThreadPool;

use super::failure::Failure;
use super::long::duration;
use super::progress::{Bar, Interrupt};

/// When a picture is done, other than after its number of samples.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Until")]
pub struct UntilOptions {
    /// Takes samples until the estimated error is below E, as a share of the way from black to white on a display, such as
    /// 0.01; a pixel gets at most --max-samples, else 65536.
    #[arg(long, value_name = "E", value_parser = error, conflicts_with = "samples")]
    noise: Option<f64>,
    /// Takes as many samples as TIME allows, such as 30s or 10m: the picture depends on the machine, and the number that
    /// was reached is printed; --samples with it makes the same picture.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "samples")]
    budget: Option<Duration>,
}

/// What was made, and how good it is.
pub struct Made {
    /// The picture.
    pub film: Film,
    /// Samples of every pixel, where all have as many.
    pub samples: Option<u32>,
    /// The error that was asked for and what was reached, where that is known.
    pub reached: Option<(f64, Reached)>,
}

/// What is made, and who watches.
pub struct Work<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The part of its picture.
    pub region: Region,
    /// The most samples of a pixel, where that is said.
    pub most: Option<u32>,
    /// Whether what is hit first is kept.
    pub layers: bool,
    /// The threads.
    pub pool: &'a ThreadPool,
    /// Shows how far it is.
    pub bar: &'a Bar,
    /// Stops it.
    pub interrupt: &'a Interrupt,
}

impl UntilOptions {
    /// Whether there is such a condition.
    pub const fn is_used(&self) -> bool {
        self.noise.is_some() || self.budget.is_some()
    }

    /// Says why there is none with a checkpoint.
    ///
    /// # Errors
    /// There is such a condition.
    pub fn without_checkpoint(&self) -> Result<(), Failure> {
        let (message, help) = if self.budget.is_some() {
            (
                "--budget ends by the clock, so what is resumed could never be the same picture: --checkpoint cannot keep \
                 it",
                "render with --samples N --checkpoint FILE, stop it by Ctrl-C or timeout, and go on with --resume",
            )
        } else if self.noise.is_some() {
            (
                "--noise compares the last pass with all before, which a checkpoint has already added up: --checkpoint \
                 cannot keep it",
                "leave out --checkpoint, or write --samples N with it; --resume with a larger N makes the picture better",
            )
        } else {
            return Ok(());
        };
        Err(Failure::usage(message, help))
    }

    /// Makes the picture.
    ///
    /// # Errors
    /// The picture is none of the kind; there is not enough memory.
    pub fn make(&self, work: &Work<'_>) -> Result<Made, Failure> {
        let settings = &work.scene.settings;
        if settings.antialias != Antialias::Sobol {
            return Err(Failure::usage(
                format!(
                    "--noise and --budget take ever more samples, which antialias \"{}\" cannot",
                    settings.antialias.name()
                ),
                "add --antialias sobol",
            ));
        }
        work.interrupt.busy(true);
        let clock = Clock { started: Instant::now(), budget: self.budget };
        let made = match self.noise {
            Some(error) => until_quiet(work, error, &clock),
            None => until_late(work, &clock),
        };
        made.map_err(|error| Failure::Scene(vec![error], Sources::default()))
    }
}

/// How much time there is.
struct Clock {
    started: Instant,
    budget: Option<Duration>,
}

impl Clock {
    fn elapsed(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Seconds that are left.
    fn left(&self) -> f64 {
        self.budget.map_or(f64::INFINITY, |budget| budget.as_secs_f64() - self.elapsed())
    }
}

/// The first passes are made in any case, later ones if they will be done in time.
fn until_quiet(work: &Work<'_>, error: f64, clock: &Clock) -> Result<Made, Diagnostic> {
    let goal = Goal {
        error,
        exposure: work.scene.develop.exposure,
        most: work.most.unwrap_or(MAX_SAMPLES),
    };
    let made = AtomicU64::new(work.region.area() * 16);
    let go_on = |samples: u64| {
        let before = made.fetch_add(samples, Ordering::Relaxed);
        clock.elapsed() / before as f64 * samples as f64 <= clock.left()
    };
    let show = |progress: &job::Progress<'_>| work.bar.update(progress);
    let control = Control {
        layers: work.layers,
        cancel: work.interrupt.flag.clone(),
        on_progress: Some(&show),
    };
    let (film, reached) =
        picture::render_until(work.scene, &goal, work.region, work.pool, &control, &go_on)?;
    Ok(Made { film, samples: None, reached: Some((error, reached)) })
}

fn until_late(work: &Work<'_>, clock: &Clock) -> Result<Made, Diagnostic> {
    let most = work.most.unwrap_or(MAX_SAMPLES);
    let mut part = Part::new(work.region, work.layers);
    let mut samples = 0;
    while samples < most && !work.interrupt.is_set() {
        let next = match samples {
            0 => 1,
            n => next_block(n, most - n, clock.left() / (clock.elapsed() / f64::from(n))),
        };
        if next == 0 {
            break;
        }
        let cancel = Arc::new(AtomicBool::new(false));
        let watch = |progress: &parts::Progress<'_>| {
            work.bar.update_part(progress);
            // What was begun and will not be done in time is left out; the first sample is not.
            if work.interrupt.is_set() || samples > 0 && clock.left() < 0.0 {
                cancel.store(true, Ordering::Relaxed);
            }
        };
        let control = Control { cancel: cancel.clone(), ..Control::default() };
        let wanted = Wanted { samples: 0..samples + next, most: next };
        if !picture::render_part(work.scene, &wanted, &mut part, work.pool, &control, &watch)? {
            break;
        }
        samples += next;
    }
    if samples > 0 {
        part.forget_begun();
    }
    let samples = samples.max(1);
    Ok(Made { film: part.film(&(0..samples))?, samples: Some(samples), reached: None })
}

/// How many samples the next block has, of a power of two that goes into those that are there: as many, or as the time
/// allows, but not so few that they make no difference.
fn next_block(samples: u32, most: u32, allowed: f64) -> u32 {
    let mut block = 1 << samples.trailing_zeros();
    // A little less than what seems possible: times vary.
    while block > 0 && (f64::from(block) > 0.97 * allowed || block > most) {
        block /= 2;
    }
    if block >= samples / 32 { block } else { 0 }
}

/// What was reached, in words.
pub fn words(goal: f64, reached: &Reached) -> String {
    let Reached { error, bound, worst, worst_at: [x, y], samples, met } = reached;
    let not = if *met { "" } else { "not " };
    format!(
        "estimated error {error:.5} (with 95 % confidence below {bound:.5}; the worst block of pixels, at {x},{y}, has \
         {worst:.5}): {goal} is {not}reached with up to {samples} samples a pixel"
    )
}

fn error(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|e: &f64| *e > 0.0 && *e <= 1.0)
        .ok_or_else(|| "write a number above 0, at most 1, such as 0.01".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_fit_the_time_and_each_other() {
        assert_eq!(next_block(16, 1000, 100.0), 16);
        assert_eq!(next_block(16, 1000, 10.0), 8);
        assert_eq!(next_block(24, 1000, 100.0), 8);
        assert_eq!(next_block(24, 1000, 0.5), 0);
        assert_eq!(next_block(16, 3, 100.0), 2);
        // 1 of 64 is not worth it.
        assert_eq!(next_block(64, 1000, 1.5), 0);
        assert_eq!(next_block(64, 1000, -3.0), 0);
    }
}
