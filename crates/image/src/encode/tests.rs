// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is written is read back, by our reader and by other crates; the bytes are pinned.

use super::*;
use crate::buffer::{Image, LayerData};
use crate::decode::{decode, decode_exr};
use crate::tone::Tone;
use crate::transfer::Encoding;

const MAX: u64 = 1 << 20;

fn picture() -> Layers {
    let image = Image::from_fn(20, 37, Encoding::Raw, |x, y| {
        [x as f32 / 19.0, (y as f32 / 9.0).min(3.0), ((x * 7 + y * 13) % 32) as f32 / 31.0]
    })
    .unwrap();
    let mut layers = Layers::from(image);
    let n = 20 * 37;
    layers.push("depth", LayerData::Scalar((0..n).map(|i| i as f32 * 0.1).collect())).unwrap();
    layers
        .push("normal", LayerData::Vector((0..n).map(|i| [i as f32, 0.5, -1.0]).collect()))
        .unwrap();
    layers
        .push("albedo", LayerData::Color((0..n).map(|i| [0.1, i as f32, 0.9]).collect()))
        .unwrap();
    layers.push("object", LayerData::Id((0..n).map(|i| i * 5_000_000).collect())).unwrap();
    layers.push("samples", LayerData::Scalar(vec![4.0; n as usize])).unwrap();
    layers.metadata.set("Software", "Dioptric 0.1.0");
    layers.metadata.set("dioptric.exposure", "1.5 (grün)");
    layers
}

fn options(depth: Depth) -> EncodeOptions {
    let develop = Develop { exposure: 1.5, tone: Tone::Filmic, encoding: Encoding::Srgb };
    EncodeOptions { develop, depth, quality: 95 }
}

#[test]
fn png_holds_exactly_the_developed_values() {
    let layers = picture();
    for depth in [Depth::Eight, Depth::Sixteen] {
        let options = options(depth);
        let back =
            decode(&encode(&layers, FileFormat::Png, &options).unwrap(), "a.png", MAX).unwrap();
        for (pixel, &[r, g, b, _]) in back.pixels().iter().zip(layers.picture.pixels()) {
            let expected = match depth {
                Depth::Eight => options.develop.to_u8([r, g, b]).map(|v| f32::from(v) / 255.0),
                Depth::Sixteen => options.develop.to_u16([r, g, b]).map(|v| f32::from(v) / 65535.0),
            };
            assert_eq!(pixel[..3], expected);
        }
        assert!(!back.has_alpha);
    }
}

#[test]
fn alpha_is_divided_out_for_png_and_multiplied_back() {
    let mut image = Image::new(2, 1, [0.25, 0.1, 0.0, 0.5], Encoding::Raw).unwrap().with_alpha();
    image.set(1, 0, [0.0; 4]);
    let develop = Develop { encoding: Encoding::Raw, ..Develop::default() };
    let options = EncodeOptions { develop, depth: Depth::Sixteen, quality: 90 };
    let layers = Layers::from(image);
    let back = decode(&encode(&layers, FileFormat::Png, &options).unwrap(), "a.png", MAX).unwrap();
    assert!(back.has_alpha);
    let expected = [0.5, 0.2, 0.0, 0.5];
    for (value, expected) in back.pixels()[0].iter().zip(expected) {
        assert!((value - expected).abs() < 1e-4, "{value} {expected}");
    }
    assert_eq!(back.pixels()[1], [0.0; 4]);
    let exr = decode(&encode(&layers, FileFormat::Exr, &options).unwrap(), "a.exr", MAX).unwrap();
    assert_eq!(exr, layers.picture);
}

#[test]
fn encoded_pictures_are_written_as_they_are() {
    let image = Image::from_fn(256, 1, Encoding::Srgb, |x, _| [x as f32 / 255.0; 3]).unwrap();
    let layers = Layers::from(image.clone());
    let file = encode(&layers, FileFormat::Png, &options(Depth::Eight)).unwrap();
    assert_eq!(decode(&file, "a.png", MAX).unwrap(), image);
    // Into a linear file they go decoded.
    let exr =
        decode(&encode(&layers, FileFormat::Exr, &options(Depth::Eight)).unwrap(), "a.exr", MAX)
            .unwrap();
    assert_eq!(exr, image.into_linear());
}

#[test]
fn text_of_png_is_read_by_its_own_crate_in_order() {
    let file = encode(&picture(), FileFormat::Png, &options(Depth::Eight)).unwrap();
    let reader = ::png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
    let texts: Vec<(String, String)> = reader
        .info()
        .utf8_text
        .iter()
        .map(|t| (t.keyword.clone(), t.get_text().unwrap()))
        .collect();
    assert_eq!(texts, picture().metadata.0);
    // Keys that the format forbids are changed, not refused.
    let mut odd = picture();
    odd.metadata.set(&" ä key ".repeat(30), "a\0b");
    odd.metadata.set("", "x");
    for format in [FileFormat::Png, FileFormat::Jpeg, FileFormat::Exr] {
        encode(&odd, format, &options(Depth::Eight)).unwrap();
    }
}

#[test]
fn exr_holds_all_layers_and_text_bit_for_bit() {
    let layers = picture();
    let file = encode(&layers, FileFormat::Exr, &options(Depth::Eight)).unwrap();
    let back = decode_exr(&file, MAX).unwrap();
    assert_eq!(back.picture, layers.picture);
    assert_eq!(back.extra().len(), 5);
    for layer in layers.extra() {
        assert_eq!(back.get(&layer.name), Some(&layer.data), "{}", layer.name);
    }
    for (key, value) in &layers.metadata.0 {
        assert_eq!(back.metadata.get(key), Some(value.as_str()));
    }
    let header =
        ::exr::meta::MetaData::read_from_buffered(std::io::Cursor::new(&file), true).unwrap();
    let names: Vec<String> =
        header.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(
        names,
        [
            "B", "G", "R", "Z", "albedo.B", "albedo.G", "albedo.R", "normal.X", "normal.Y",
            "normal.Z", "object", "samples"
        ]
    );
}

#[test]
fn exr_keeps_infinity_nan_and_noise() {
    let mut random = dioptric_math::random::Random::new(1);
    let image = Image::from_fn(33, 17, Encoding::Raw, |x, _| match x {
        0 => [f32::INFINITY, -0.0, f32::MIN_POSITIVE],
        _ => [(); 3].map(|()| f32::from_bits(random.bits() as u32 & 0x7f7f_ffff)),
    })
    .unwrap();
    let layers = Layers::from(image);
    let file = encode(&layers, FileFormat::Exr, &options(Depth::Eight)).unwrap();
    assert_eq!(decode_exr(&file, MAX).unwrap().picture, layers.picture);
}

#[test]
fn jpeg_is_near_and_carries_its_comment() {
    let image =
        Image::from_fn(64, 48, Encoding::Srgb, |x, y| [x as f32 / 64.0, y as f32 / 48.0, 0.4])
            .unwrap();
    let mut layers = Layers::from(image.clone());
    layers.metadata.set("Software", "Dioptric");
    layers.metadata.set("long", "x".repeat(70_000));
    let file = encode(&layers, FileFormat::Jpeg, &options(Depth::Eight)).unwrap();
    let back = decode(&file, "a.jpg", MAX).unwrap();
    for (a, b) in back.pixels().iter().zip(image.pixels()) {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 0.03, "{a} {b}");
        }
    }
    let comment = b"Software: Dioptric\nlong: xxx";
    assert!(file.windows(comment.len()).any(|w| w == comment));
    let low =
        encode(&layers, FileFormat::Jpeg, &EncodeOptions { quality: 10, ..options(Depth::Eight) })
            .unwrap();
    assert!(low.len() < file.len());
    let wide = Layers::from(Image::new(65536, 1, [0.0; 4], Encoding::Raw).unwrap());
    assert!(encode(&wide, FileFormat::Jpeg, &options(Depth::Eight)).is_err());
}

#[test]
fn hdr_keeps_light_within_its_eight_bits() {
    let values = [
        0.0,
        1e-40,
        1e-30,
        0.001,
        0.5,
        1.0,
        255.0,
        0.998_9,
        1e10,
        1e38,
        f32::INFINITY,
        -3.0,
        f32::NAN,
    ];
    for width in [7, 13, 300] {
        let image = Image::from_fn(width, 2, Encoding::Raw, |x, y| {
            let v = values[(x as usize / (1 + y as usize * 20)) % values.len()];
            [v, v * 0.5, if y == 0 { 0.0 } else { v }]
        })
        .unwrap();
        let file =
            encode(&Layers::from(image.clone()), FileFormat::Hdr, &options(Depth::Eight)).unwrap();
        let back = decode(&file, "a.hdr", MAX).unwrap();
        for (a, b) in back.pixels().iter().zip(image.pixels()) {
            let b = b.map(|v| if v.is_nan() { 0.0 } else { v.clamp(0.0, 1.694e38) });
            let largest = b[0].max(b[1]).max(b[2]);
            for (a, b) in a.iter().take(3).zip(b) {
                assert!((a - b).abs() <= largest / 255.0 + 3e-39, "{a} {b} {largest}");
            }
        }
    }
}

#[test]
fn formats_are_told_by_extension() {
    for (name, format) in [
        ("a.png", FileFormat::Png),
        ("b/c.JPG", FileFormat::Jpeg),
        ("x.jpeg", FileFormat::Jpeg),
        ("x.y.Exr", FileFormat::Exr),
    ] {
        assert_eq!(FileFormat::from_path(Path::new(name)).unwrap(), format);
    }
    assert_eq!(
        FileFormat::from_path(Path::new("a.pgn")).unwrap_err().to_string(),
        "unknown picture format \"pgn\" (did you mean \"png\"? valid: png, jpg, jpeg, exr, hdr)"
    );
    assert_eq!(
        FileFormat::from_path(Path::new("picture")).unwrap_err().to_string(),
        "the picture's name \"picture\" has no extension (end it with one of: png, jpg, jpeg, exr, hdr)"
    );
}

/// FNV-1a, enough to notice a changed byte.
fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3))
}

/// A change here means that a compressor or a format changed, which is worth a line in the changelog.
const PINNED: [u64; 5] = [
    11106467857725305073,
    10861962619220872327,
    17021161940235197815,
    11907794992240809412,
    8447362651336143783,
];

#[test]
fn bytes_do_not_change() {
    let formats = [
        (FileFormat::Png, Depth::Eight),
        (FileFormat::Png, Depth::Sixteen),
        (FileFormat::Jpeg, Depth::Eight),
        (FileFormat::Exr, Depth::Eight),
        (FileFormat::Hdr, Depth::Eight),
    ];
    let hashes = formats.map(|(format, depth)| {
        let bytes = encode(&picture(), format, &options(depth)).unwrap();
        assert_eq!(bytes, encode(&picture(), format, &options(depth)).unwrap());
        hash(&bytes)
    });
    assert_eq!(hashes, PINNED);
}
