// SPDX-License-Identifier: MIT OR Apache-2.0
//! Parts of made-up pictures: split, stopped, kept and merged in every way, they have the bits of the whole.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::*;
use crate::film::{FirstHit, Radiance};
use crate::job::{self, Control, Shoot};
use crate::sampling::{Antialias, PixelSample, Stream};
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;
use dioptric_math::{DVec3, Spectrum};

fn noise(sample: &PixelSample, stream: &mut Stream, rays: &mut RayCounts) -> Radiance {
    rays.camera += 1;
    let color = Spectrum::new(stream.next_1d(), sample.x * stream.next_1d(), 1.0 / 3.0);
    let first = FirstHit { object: 3, depth: sample.y, normal: DVec3::Z, albedo: color };
    Radiance { color, alpha: stream.next_1d(), first }
}

fn settings(samples: u32) -> RenderSettings {
    RenderSettings {
        size: [21, 18],
        samples,
        max_samples: samples,
        antialias: Antialias::Sobol,
        ..RenderSettings::default()
    }
}

fn pool() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap()
}

fn whole(s: &RenderSettings) -> Film {
    let control = Control { layers: true, ..Control::default() };
    job::render(s, Region::full(s.size), &pool(), &noise, &control).unwrap()
}

fn make(s: &RenderSettings, wanted: Range<u32>, part: &mut Part, shoot: &dyn Shoot, c: &Control) {
    let wanted = Wanted { samples: wanted, most: 4 };
    render(s, &wanted, part, &pool(), shoot, c, &|_| ()).unwrap();
}

#[test]
fn splits_merge_to_the_bits_of_the_whole() {
    for samples in [1, 7, 16, 21] {
        let s = settings(samples);
        let expected = whole(&s);
        for cuts in
            [vec![0, samples], vec![0, 1, samples], vec![0, samples / 3, samples / 2, samples]]
        {
            let mut parts: Vec<Part> = cuts
                .windows(2)
                .map(|cut| {
                    let mut part = Part::new(Region::full(s.size), true);
                    make(&s, cut[0]..cut[1], &mut part, &noise, &Control::default());
                    part
                })
                .collect();
            let mut merged = parts.pop().unwrap();
            parts.into_iter().for_each(|part| merged.merge(part).unwrap());
            assert_eq!((merged.ranges().len(), merged.missing(&(0..samples))), (1, vec![]));
            assert_eq!(merged.film(&(0..samples)).unwrap(), expected, "{samples} cut at {cuts:?}");
        }
    }
}

#[test]
fn stopped_kept_and_gone_on_with_parts_lose_nothing() {
    let s = settings(13);
    let expected = whole(&s);
    for stop in [1, 100, 377, 378 * 4 + 50, 378 * 9, 378 * 13 - 40] {
        let (cancel, shots) = (Arc::new(AtomicBool::new(false)), AtomicU64::new(0));
        let shoot = |sample: &PixelSample, stream: &mut Stream, rays: &mut RayCounts| {
            if shots.fetch_add(1, Ordering::Relaxed) == stop {
                cancel.store(true, Ordering::Relaxed);
            }
            noise(sample, stream, rays)
        };
        let control = Control { cancel: cancel.clone(), ..Control::default() };
        let mut part = Part::new(Region::full(s.size), true);
        make(&s, 0..13, &mut part, &shoot, &control);
        assert!(!part.missing(&(0..13)).is_empty() && !part.film(&(0..13)).unwrap().finished());
        let mut bytes = Vec::new();
        write(&part, None, "text", &mut bytes).unwrap();
        let (head, mut again) = read(&mut bytes.as_slice(), bytes.len() as u64).unwrap();
        assert_eq!((head.text.as_str(), &again), ("text", &part));
        make(&s, 0..13, &mut again, &noise, &Control::default());
        let film = again.film(&(0..13)).unwrap();
        assert!(film.finished());
        // Rays of pixels that were cut off are cast again, and counted.
        assert_eq!(
            (film.pixels(), film.firsts()),
            (expected.pixels(), expected.firsts()),
            "{stop}"
        );
    }
}

#[test]
fn overlaps_and_gaps_are_found() {
    let s = settings(8);
    let part = |range: Range<u32>| {
        let mut part = Part::new(Region::full(s.size), false);
        make(&s, range, &mut part, &noise, &Control::default());
        part
    };
    let mut merged = part(0..3);
    assert_eq!(merged.merge(part(2..5)), Err(2..3));
    merged.merge(part(6..8)).unwrap();
    assert_eq!(merged.ranges(), [0..3, 6..8]);
    assert_eq!(merged.missing(&(0..10)), [3..6, 8..10]);
    assert!(!merged.film(&(0..8)).unwrap().finished());
}

#[test]
fn damaged_files_are_refused_and_never_panic() {
    let mut part = Part::new(Region { x: 2, y: 1, width: 3, height: 2 }, true);
    make(&settings(3), 0..3, &mut part, &noise, &Control::default());
    let mut bytes = Vec::new();
    write(&part, None, "{}", &mut bytes).unwrap();
    assert_eq!(read(&mut bytes.as_slice(), bytes.len() as u64).unwrap().1, part);
    for end in 0..bytes.len() {
        assert!(read(&mut &bytes[..end], end as u64).is_err(), "cut at {end}");
    }
    for i in 0..bytes.len() {
        for bit in [1, 0x80] {
            let mut wrong = bytes.clone();
            wrong[i] ^= bit;
            assert!(read(&mut wrong.as_slice(), wrong.len() as u64).is_err(), "byte {i}");
        }
    }
}
