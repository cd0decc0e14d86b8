// SPDX-License-Identifier: MIT OR Apache-2.0
//! How long the parts of a sample take that are no search: texels, numbers drawn by lot, and a picture's way to its
//! file: `cargo bench -p dioptric-render`.
#![allow(missing_docs)] // of what criterion's macros make

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use dioptric_image::{
    EncodeOptions, Encoding, FileFormat, Image, Layers, Stored, Values, decode_stored, encode,
};
use dioptric_math::random::Random;
use dioptric_render::RenderSettings;
use dioptric_render::sampling::{Antialias, pixel_sample};
use dioptric_render::texture::{Filter, Lookup, Texture, Wrap};

/// Texels along the sides of the picture that is looked up, the size of a planet's map.
const SIZE: [u32; 2] = [2048, 1024];

/// Points of a picture that lie as a camera's rays do (in rows) or anywhere.
fn points(in_rows: bool) -> Vec<[f64; 2]> {
    let mut random = Random::new(1);
    (0..1_u32 << 16)
        .map(|i| {
            let row = [f64::from(i % 256) / 256.0, f64::from(i / 256) / 256.0];
            if in_rows { row } else { row.map(|_| random.unit()) }
        })
        .collect()
}

fn textures(c: &mut Criterion) {
    let mut random = Random::new(2);
    let count = SIZE[0] * SIZE[1] * 3;
    let values = Values::Bytes((0..count).map(|_| (random.unit() * 255.0) as u8).collect());
    let Ok(picture) = Stored::new(SIZE[0], SIZE[1], 3, values, Encoding::Srgb) else { return };
    let texture = Arc::new(Texture::from_stored(picture));
    let mut group = c.benchmark_group("texture");
    group.throughput(Throughput::Elements(1 << 16));
    for (name, filter) in [("nearest", Filter::Nearest), ("bilinear", Filter::Bilinear)] {
        let lookup = Lookup {
            texture: texture.clone(),
            filter,
            wrap: [Wrap::Repeat; 2],
            border: [0.0; 3],
            as_color: true,
        };
        for (order, points) in [("in rows", points(true)), ("anywhere", points(false))] {
            group.bench_function(format!("{name}, {order}"), |b| {
                b.iter(|| points.iter().map(|p| lookup.eval(p[0], p[1])[0]).sum::<f64>());
            });
        }
    }
}

fn sampling(c: &mut Criterion) {
    let mut group = c.benchmark_group("sample");
    group.throughput(Throughput::Elements(64 * 16));
    for antialias in [Antialias::Report, Antialias::Jitter, Antialias::Sobol] {
        let settings = RenderSettings { antialias, samples: 16, ..RenderSettings::default() };
        // The place in the pixel, on the lens, and on one light.
        group.bench_function(antialias.name(), |b| {
            b.iter(|| {
                for x in 0..64 {
                    for index in 0..16 {
                        let (sample, mut stream) = pixel_sample(&settings, [x, 7], index);
                        black_box((sample, stream.next_2d()));
                    }
                }
            });
        });
    }
}

fn pictures(c: &mut Criterion) {
    let mut random = Random::new(3);
    let light = Image::from_fn(256, 256, Encoding::Raw, |x, y| {
        [x as f32 / 256.0, y as f32 / 256.0, random.uniform(0.4, 0.5) as f32]
    });
    let Ok(light) = light else { return };
    let layers = Layers::from(light);
    let write = || encode(black_box(&layers), FileFormat::Png, &EncodeOptions::default());
    let Ok(png) = write() else { return };
    let mut group = c.benchmark_group("png 256 x 256");
    group.throughput(Throughput::Elements(256 * 256));
    group.bench_function("develop and encode", |b| b.iter(write));
    group.bench_function("decode", |b| b.iter(|| decode_stored(black_box(&png), "a.png", 1 << 20)));
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(600));
    targets = textures, sampling, pictures
}
criterion_main!(benches);
