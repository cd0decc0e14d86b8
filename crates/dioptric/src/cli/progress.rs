// SPDX-License-Identifier: MIT OR Apache-2.0
//! The bar on a terminal while a picture is made, and Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dioptric::render::job::Progress;
use dioptric::render::parts;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::stats::count;
use super::terminal::{Terminal, note};

/// A bar with rays a second and the time left; nothing where standard error is no terminal.
pub struct Bar {
    bar: ProgressBar,
    started: Instant,
}

impl Bar {
    /// A bar that is about to start.
    pub fn new(terminal: &Terminal, name: &str) -> Self {
        let target = if terminal.progress {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        let template = "{prefix} {bar:30} {percent:>3} %  {msg}  {eta} left";
        bar.set_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.set_prefix(name.to_string());
        Self { bar, started: Instant::now() }
    }

    /// Shows how far it is.
    pub fn update(&self, progress: &Progress) {
        if self.bar.length() != Some(progress.total) {
            // A new pass: the second one of adaptive pictures takes longer for each pixel.
            self.bar.set_length(progress.total);
            self.bar.reset_eta();
        }
        let rate = progress.rays.total() as f64 / self.started.elapsed().as_secs_f64().max(1e-3);
        let pass = if progress.passes > 1 {
            format!("pass {} of {}  ", progress.pass + 1, progress.passes)
        } else {
            String::new()
        };
        self.bar.set_message(format!("{pass}{} rays/s", count(rate)));
        self.bar.set_position(progress.done);
    }

    /// Shows how far a picture is that is made block by block.
    pub fn update_part(&self, progress: &parts::Progress) {
        let job = progress.job;
        let all = u64::from(progress.total.max(1)) * job.film.pixels().len() as u64;
        let block = progress.block.len() as u64;
        let done = u64::from(progress.before) * job.film.pixels().len() as u64
            + block * (job.film.pixels().len() as u64 - (job.total - job.done));
        if self.bar.length() != Some(all) {
            self.bar.set_length(all);
        }
        let samples: usize = progress.part.ranges().iter().map(ExactSizeIterator::len).sum();
        self.bar.set_message(format!("{samples} samples a pixel"));
        self.bar.set_position(done.min(all));
    }

    /// Removes it.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Ctrl-C: the first one stops the picture that is being made, which is then saved; the second one, or
/// one while nothing is being made, ends the program at once.
#[derive(Clone, Default)]
pub struct Interrupt {
    /// Set by Ctrl-C.
    pub flag: Arc<AtomicBool>,
    /// Whether there is a picture to be saved.
    busy: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens from now on.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let Self { flag, busy } = interrupt.clone();
        // Where no handler can be installed, Ctrl-C ends the program as it does without one.
        let _ = ctrlc::set_handler(move || {
            let again = flag.swap(true, Ordering::SeqCst);
            if again || !busy.load(Ordering::SeqCst) {
                std::process::exit(130);
            }
            note("\nstopping; press Ctrl-C again to end without saving\n");
        });
        interrupt
    }

    /// Says whether there is a picture to be saved from now on.
    pub fn busy(&self, busy: bool) {
        self.busy.store(busy, Ordering::SeqCst);
    }

    /// Whether Ctrl-C was pressed.
    pub fn is_set(&self) -> bool {
        self.flag.load(Ordering::SeqCst)
    }
}
