// SPDX-License-Identifier: MIT OR Apache-2.0
//! How long a picture took and what it cost, for `--stats` and the line at the end; and its settings,
//! which also go into the picture.

use dioptric::image::Develop;
use dioptric::render::region::Region;
use dioptric::render::{RayCounts, RenderSettings};
use serde_json::{Value, json};

/// What one picture took.
#[derive(Clone, Debug, Default)]
pub struct Stats {
    /// Seconds of reading, compiling and rendering.
    pub read: f64,
    /// See `read`.
    pub compile: f64,
    /// See `read`.
    pub render: f64,
    /// Rays by kind.
    pub rays: RayCounts,
    /// Samples of all pixels.
    pub samples: u64,
    /// Threads that worked.
    pub threads: usize,
    /// What the picture was made with.
    pub settings: Value,
    /// Whether it is complete.
    pub finished: bool,
}

impl Stats {
    /// The contents of the file that `--stats` writes.
    pub fn json(&self) -> Value {
        let rays = &self.rays;
        json!({
            "version": dioptric::VERSION,
            "finished": self.finished,
            "seconds": {"read": self.read, "compile": self.compile, "render": self.render},
            "rays": {
                "camera": rays.camera,
                "shadow": rays.shadow,
                "reflect": rays.reflect,
                "refract": rays.refract,
                "inside": rays.inside,
                "total": rays.total(),
            },
            "samples": self.samples,
            "peak_bytes": peak_bytes(),
            "threads": self.threads,
            "settings": self.settings,
        })
    }

    /// The same in one line.
    pub fn line(&self) -> String {
        let total = self.rays.total();
        let memory = peak_bytes().map_or(String::new(), |b| format!(", {} MB", b >> 20));
        format!(
            "{} ({} read, {} compile, {} render), {} rays, {} rays/s, {} thread{}{memory}",
            seconds(self.read + self.compile + self.render),
            seconds(self.read),
            seconds(self.compile),
            seconds(self.render),
            count(total as f64),
            count(total as f64 / self.render.max(1e-9)),
            self.threads,
            if self.threads == 1 { "" } else { "s" },
        )
    }
}

/// What a picture depends on besides its scene.
pub fn settings(settings: &RenderSettings, develop: &Develop, region: Region) -> Value {
    let mut all = json!({
        "size": settings.size,
        "antialias": settings.antialias.name(),
        "samples": settings.samples,
        "filter": settings.filter.name(),
        "filter_radius": settings.filter_radius,
        "integrator": settings.integrator.name(),
        "bounces": settings.bounces,
        "min_contribution": settings.min_contribution,
        "shadows": settings.shadows.name(),
        "seed": settings.seed,
        "exposure": develop.exposure,
        "tone": develop.tone.name(),
        "encoding": develop.encoding.name(),
    });
    if settings.max_samples != settings.samples {
        all["max_samples"] = json!(settings.max_samples);
        all["threshold"] = json!(settings.threshold);
    }
    if region != Region::full(settings.size) {
        all["crop"] = json!([region.x, region.y, region.width, region.height]);
    }
    all
}

/// The most memory that this process has had, where the system says so.
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

/// Seconds as people read them: `0.42 s`, `3 min 7 s`.
fn seconds(s: f64) -> String {
    if s < 100.0 {
        format!("{s:.2} s")
    } else {
        let whole = s.round() as u64;
        format!("{} min {} s", whole / 60, whole % 60)
    }
}

/// A large number with a unit: `12.3 M`.
pub fn count(n: f64) -> String {
    match n {
        n if n >= 1e9 => format!("{:.2} G", n / 1e9),
        n if n >= 1e6 => format!("{:.2} M", n / 1e6),
        n if n >= 1e3 => format!("{:.1} k", n / 1e3),
        n => format!("{n:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(count(12_345_678.0), "12.35 M");
        assert_eq!(count(999.0), "999");
        assert_eq!(seconds(187.2), "3 min 7 s");
        assert_eq!(seconds(0.421), "0.42 s");
    }
}
