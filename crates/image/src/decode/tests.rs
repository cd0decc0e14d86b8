// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files made by hand, byte by byte, and files spoilt in every way.

use super::*;
use crate::buffer::{LayerData, Layers};
use crate::encode::{Depth, EncodeOptions, FileFormat, encode};
use crate::transfer::Encoding;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const MAX: u64 = 1 << 20;
const CASES: u32 = 60;

fn bytes_of(image: &Image) -> Vec<[u8; 3]> {
    image
        .pixels()
        .iter()
        .map(|&[r, g, b, _]| [r, g, b].map(|c| (c * 255.0).round() as u8))
        .collect()
}

/// Two rows of three pixels, from the top, some of their bytes above 127.
const PIXELS: [[u8; 3]; 6] =
    [[255, 0, 10], [0, 200, 20], [1, 2, 3], [128, 129, 130], [250, 240, 230], [40, 50, 60]];

/// A BMP of [`PIXELS`] with an information header of `header` bytes and 24 bits a pixel.
fn bmp(header: usize, top_down: bool) -> Vec<u8> {
    let offset = 14 + header as u32;
    let mut out = b"BM".to_vec();
    out.extend((offset + 24).to_le_bytes());
    out.extend([0; 4]);
    out.extend(offset.to_le_bytes());
    out.extend((header as u32).to_le_bytes());
    if header == 12 {
        out.extend([3, 0, 2, 0, 1, 0, 24, 0]); // width, height, planes, bits
    } else {
        out.extend(3_i32.to_le_bytes());
        out.extend(if top_down { -2_i32 } else { 2 }.to_le_bytes());
        out.extend([1, 0, 24, 0]);
        out.resize(offset as usize, 0); // no compression; masks and colour space are of no use to 24 bits
    }
    let mut rows: Vec<&[[u8; 3]]> = PIXELS.chunks(3).collect();
    if !top_down {
        rows.reverse();
    }
    for row in rows {
        out.extend(row.iter().flat_map(|[r, g, b]| [*b, *g, *r]));
        out.extend([0xee; 3]); // padding to a multiple of four bytes
    }
    out
}

/// What the report's program did: pixels at byte 54, no padding, signed bytes, the lowest row first.
fn naive_bmp(bytes: &[u8]) -> Vec<[f32; 3]> {
    let data = &bytes[54.min(bytes.len())..];
    let mut rows: Vec<Vec<[f32; 3]>> = data
        .chunks_exact(9)
        .take(2)
        .map(|row| {
            row.chunks_exact(3)
                .map(|p| [p[2], p[1], p[0]].map(|v| f32::from(v.cast_signed()) / 255.0))
                .collect()
        })
        .collect();
    rows.reverse();
    rows.concat()
}

#[test]
fn bitmaps_of_every_header_are_read_and_the_naive_reading_is_wrong() {
    for (header, top_down) in [(40, false), (40, true), (12, false), (108, false), (124, false)] {
        let file = bmp(header, top_down);
        let image = decode(&file, "a.bmp", MAX).unwrap();
        assert_eq!((image.width(), image.height()), (3, 2));
        assert_eq!(bytes_of(&image), PIXELS, "header of {header}");
        assert_eq!((image.encoding, image.has_alpha), (Encoding::Srgb, false));
        let right: Vec<[f32; 3]> = image.pixels().iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        assert_ne!(naive_bmp(&file), right, "header of {header}");
    }
}

/// Each of the three faults alone spoils a picture that is free of the other two.
#[test]
fn each_fault_of_the_naive_bitmap_reader_shows_alone() {
    let read = |file: &[u8]| -> Vec<[f32; 3]> {
        let image = decode(file, "a.bmp", MAX).unwrap();
        image.pixels().iter().map(|&[r, g, b, _]| [r, g, b]).collect()
    };
    // 4 x 1 needs no padding: with a header of 40 and bytes below 128 the naive reading is right,
    let plain = |header: u32, value: u8| {
        let mut out =
            [&b"BM"[..], &(26 + header).to_le_bytes(), &[0; 4], &(14 + header).to_le_bytes()]
                .concat();
        out.extend(header.to_le_bytes());
        out.extend([4, 0, 0, 0, 1, 0, 0, 0, 1, 0, 24, 0]);
        out.resize(14 + header as usize, 0);
        out.extend([value, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
        out
    };
    let naive = |file: &[u8]| -> Vec<[f32; 3]> {
        let data: Vec<f32> =
            file[54..66].iter().map(|v| f32::from(v.cast_signed()) / 255.0).collect();
        data.as_chunks::<3>().0.iter().map(|&[b, g, r]| [r, g, b]).collect()
    };
    assert_eq!(naive(&plain(40, 127)), read(&plain(40, 127)));
    // and with a value of 128, or another header, it is wrong.
    assert_ne!(naive(&plain(40, 128)), read(&plain(40, 128)));
    assert_eq!(read(&plain(40, 128))[0][2], 128.0 / 255.0);
    assert_ne!(naive(&plain(124, 127)), read(&plain(124, 127)));
    // Padding alone: the second row of 3 x 2 dark pixels moves by three bytes.
    let mut dark = bmp(40, false);
    for value in &mut dark[54..] {
        *value &= 0x7f;
    }
    assert_ne!(naive_bmp(&dark), read(&dark));
    assert_eq!(
        naive_bmp(&dark)[3..],
        read(&dark)[3..],
        "the row that is stored first is still right"
    );
}

#[test]
fn bitmaps_with_a_palette_have_their_pixels_behind_it() {
    let mut file = b"BM".to_vec();
    file.extend((54_u32 + 8 + 8).to_le_bytes());
    file.extend([0; 4]);
    file.extend((54_u32 + 8).to_le_bytes());
    file.extend(40_u32.to_le_bytes());
    file.extend([3, 0, 0, 0, 2, 0, 0, 0, 1, 0, 8, 0]);
    file.extend([0; 16]);
    file.extend([2, 0, 0, 0, 0, 0, 0, 0]); // two colours
    file.extend([10, 20, 200, 0, 255, 130, 7, 0]); // blue, green, red, nothing
    file.extend([0, 1, 0, 0xee, 1, 1, 0, 0xee]);
    let image = decode(&file, "a.bmp", MAX).unwrap();
    let (a, b) = ([200, 20, 10], [7, 130, 255]);
    assert_eq!(bytes_of(&image), [b, b, a, a, b, a]);
}

fn png_of(
    color: ::png::ColorType,
    depth: ::png::BitDepth,
    palette: Option<(&[u8], &[u8])>,
    data: &[u8],
) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut out, 2, 1);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Some((colors, alphas)) = palette {
        encoder.set_palette(colors);
        encoder.set_trns(alphas);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    out
}

#[test]
fn png_of_every_kind_gives_stored_values() {
    use ::png::{BitDepth as D, ColorType as C};
    let s = |v: u16| f32::from(v) / 65535.0;
    let cases: [(Vec<u8>, [[f32; 4]; 2], bool); 6] = [
        (
            png_of(C::Rgb, D::Eight, None, &[255, 0, 51, 0, 255, 102]),
            [[1., 0., 0.2, 1.], [0., 1., 0.4, 1.]],
            false,
        ),
        (
            png_of(C::Rgba, D::Eight, None, &[255, 0, 51, 51, 0, 0, 0, 0]),
            [[1., 0., 0.2, 0.2], [0.; 4]],
            true,
        ),
        (png_of(C::Grayscale, D::One, None, &[0b0100_0000]), [[0., 0., 0., 1.], [1.; 4]], false),
        (
            png_of(C::GrayscaleAlpha, D::Eight, None, &[51, 255, 255, 0]),
            [[0.2, 0.2, 0.2, 1.], [1., 1., 1., 0.]],
            true,
        ),
        (
            png_of(C::Rgb, D::Sixteen, None, &[0x12, 0x34, 0, 1, 0xff, 0xff, 0, 0, 0, 0, 0, 0]),
            [[s(0x1234), s(1), 1., 1.], [0., 0., 0., 1.]],
            false,
        ),
        (
            png_of(C::Indexed, D::Eight, Some((&[255, 0, 0, 0, 0, 255], &[255, 51])), &[1, 0]),
            [[0., 0., 1., 0.2], [1., 0., 0., 1.]],
            true,
        ),
    ];
    for (i, (file, pixels, alpha)) in cases.iter().enumerate() {
        let image = decode(file, "a.png", MAX).unwrap();
        assert_eq!(image.pixels(), pixels, "case {i}");
        assert_eq!((image.has_alpha, image.encoding), (*alpha, Encoding::Srgb), "case {i}");
    }
}

/// A TGA header: kind, size 3 x 2, depth, descriptor (0x20: the top row first).
fn tga_header(kind: u8, depth: u8, descriptor: u8) -> Vec<u8> {
    vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 2, 0, depth, descriptor]
}

#[test]
fn tga_raw_and_run_lengths_in_both_row_orders() {
    let bgr = |rows: [usize; 2]| -> Vec<u8> {
        rows.iter()
            .flat_map(|r| PIXELS.chunks(3).nth(*r).unwrap())
            .flat_map(|[r, g, b]| [*b, *g, *r])
            .collect()
    };
    let bottom_up = [tga_header(2, 24, 0), bgr([1, 0])].concat();
    let top_down = [tga_header(2, 24, 0x20), bgr([0, 1])].concat();
    // One packet of six single pixels.
    let packed = [tga_header(10, 24, 0x20), vec![5], bgr([0, 1])].concat();
    for file in [bottom_up, top_down, packed] {
        assert_eq!(bytes_of(&decode(&file, "A.TGA", MAX).unwrap()), PIXELS);
        assert!(decode(&file, "a.dat", MAX).is_err(), "TGA has no signature");
        let signed = [&file[..], &[0; 8], b"TRUEVISION-XFILE.\0"].concat();
        assert_eq!(bytes_of(&decode(&signed, "a.dat", MAX).unwrap()), PIXELS);
    }
    let run = [tga_header(10, 24, 0x20), vec![0x85, 200, 100, 50]].concat();
    assert_eq!(bytes_of(&decode(&run, "a.tga", MAX).unwrap()), [[50, 100, 200]; 6]);
    let grey = [tga_header(3, 8, 0x20), vec![0, 50, 100, 150, 200, 250]].concat();
    assert_eq!(bytes_of(&decode(&grey, "a.tga", MAX).unwrap())[5], [250; 3]);
}

#[test]
fn hdr_flat_and_both_run_lengths() {
    // 2^(129 - 136) * 128 = 1.
    let flat = |header: &str, data: &[u8]| [header.as_bytes(), data].concat();
    let head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n";
    let white = [128, 128, 128, 129];
    let half = [128, 64, 0, 128];
    let expected = [[1.0, 1.0, 1.0, 1.0], [0.5, 0.25, 0.0, 1.0], [0.5, 0.25, 0.0, 1.0]];
    let image = decode(&flat(head, &[white, half, half].concat()), "a.hdr", MAX).unwrap();
    assert_eq!(image.pixels(), expected);
    assert_eq!(image.encoding, Encoding::Raw);
    let runs = decode(&flat(head, &[white, half, [1, 1, 1, 1]].concat()), "a.hdr", MAX).unwrap();
    assert_eq!(runs.pixels(), expected);
    // EXPOSURE says what the light was multiplied by.
    let dim = head.replace("FORMAT", "EXPOSURE=2\nFORMAT");
    let image = decode(&flat(&dim, &[white, half, half].concat()), "a.hdr", MAX).unwrap();
    assert_eq!(image.pixels()[0], [0.5, 0.5, 0.5, 1.0]);
    // Rows from the bottom, 8 wide in planes: a run of eight, then eight single values.
    let planes = |v: u8| {
        [&[2, 2, 0, 8][..], &[136, v, 136, v, 8, v, v, v, v, v, v, v, v, 136, 129]].concat()
    };
    let up = flat("#?RGBE\n\n+Y 2 +X 8\n", &[planes(64), planes(128)].concat());
    let image = decode(&up, "a.hdr", MAX).unwrap();
    assert_eq!(image.get(0, 0), Some([1.0; 4]));
    assert_eq!(image.get(7, 1), Some([0.5, 0.5, 0.5, 1.0]));

    for wrong in [
        "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 3\n",
        "#?RADIANCE\n\n+X 1 -Y 3\n",
        "#?RADIANCE\n\n-Y 0 +X 3\n",
        "#?RADIANCE\n\n-Y -1 +X 3\n",
        "#?RADIANCE\nno end",
    ] {
        assert!(decode(wrong.as_bytes(), "a.hdr", MAX).is_err(), "{wrong}");
    }
}

#[test]
fn exr_of_other_programs_halves_grey_and_prefixed_names() {
    use ::exr::prelude::*;
    let write = |channels: Vec<AnyChannel<FlatSamples>>| -> Vec<u8> {
        let image = ::exr::image::Image::from_channels((2, 1), AnyChannels::sort(channels.into()));
        let mut out = std::io::Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut out).unwrap();
        out.into_inner()
    };
    let float = |name: &str, v: [f32; 2]| AnyChannel::new(name, FlatSamples::F32(v.to_vec()));
    let half = |name: &str, v: [f32; 2]| {
        AnyChannel::new(name, FlatSamples::F16(v.map(f16::from_f32).to_vec()))
    };
    let blender = write(vec![
        half("View.Combined.R", [1.0, 0.5]),
        half("View.Combined.G", [2.0, 0.25]),
        half("View.Combined.B", [3.0, 0.125]),
        half("View.Combined.A", [1.0, 0.5]),
        float("View.Depth.Z", [9.0, 10.0]),
        AnyChannel::new("Object", FlatSamples::U32(vec![7, u32::MAX])),
    ]);
    let layers = decode_exr(&blender, MAX).unwrap();
    assert_eq!(layers.picture.pixels(), [[1.0, 2.0, 3.0, 1.0], [0.5, 0.25, 0.125, 0.5]]);
    assert!(layers.picture.has_alpha);
    assert_eq!(layers.get("View_Depth_Z"), Some(&LayerData::Scalar(vec![9.0, 10.0])));
    assert_eq!(layers.get("Object"), Some(&LayerData::Id(vec![7, u32::MAX])));
    let grey = decode(&write(vec![float("Y", [0.5, 7.0])]), "a.exr", MAX).unwrap();
    assert_eq!(grey.pixels(), [[0.5, 0.5, 0.5, 1.0], [7.0, 7.0, 7.0, 1.0]]);
    let error =
        decode(&write(vec![float("U", [0.0; 2]), float("V", [0.0; 2])]), "a.exr", MAX).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.exr: the EXR file has no colour, its channels are: U, V (save the channels R, G and B, or Y)"
    );
}

/// A small picture in every format that is written, and the hand-made ones of the formats that are not.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let image =
        Image::from_fn(9, 5, Encoding::Raw, |x, y| [x as f32 / 9.0, y as f32 / 5.0, 0.5]).unwrap();
    let mut layers = Layers::from(image);
    layers.push("depth", LayerData::Scalar((0..45).map(|i| i as f32 * 0.37).collect())).unwrap();
    layers.metadata.set("Software", "Dioptric");
    let make = |format, depth| {
        encode(&layers, format, &EncodeOptions { depth, ..Default::default() }).unwrap()
    };
    vec![
        ("a.png", make(FileFormat::Png, Depth::Eight)),
        ("b.png", make(FileFormat::Png, Depth::Sixteen)),
        ("a.jpg", make(FileFormat::Jpeg, Depth::Eight)),
        ("a.exr", make(FileFormat::Exr, Depth::Eight)),
        ("a.hdr", make(FileFormat::Hdr, Depth::Eight)),
        ("a.bmp", bmp(40, false)),
        ("b.bmp", bmp(124, true)),
        ("a.tga", [tga_header(2, 24, 0), vec![9; 18]].concat()),
        ("b.tga", [tga_header(10, 24, 0), vec![0x85, 1, 2, 3]].concat()),
    ]
}

#[test]
fn every_truncation_is_an_error() {
    for (name, file) in samples() {
        decode(&file, name, MAX).unwrap_or_else(|e| panic!("{e}"));
        // The last bytes of a BMP are padding, those of a JPEG its end marker.
        let needed = file.len() - if name.ends_with("bmp") { 3 } else { 0 };
        for length in 0..needed {
            assert!(
                decode(&file[..length], name, MAX).is_err(),
                "{name} cut to {length} of {}",
                file.len()
            );
        }
    }
}

#[test]
fn sizes_above_the_limit_are_refused_from_the_header() {
    for (name, file) in samples() {
        let error = decode(&file, name, 5).unwrap_err();
        assert_eq!(error.kind, ErrorKind::TooLarge, "{name}: {error}");
    }
    // Headers that announce gigabytes cost nothing.
    let mut huge = bmp(40, false);
    huge[18..26].copy_from_slice(&[0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0x0f]);
    assert!(decode(&huge, "a.bmp", MAX).is_err());
    let hdr = b"#?RADIANCE\n\n-Y 4000000000 +X 4000000000\n";
    assert_eq!(decode(hdr, "a.hdr", MAX).unwrap_err().kind, ErrorKind::TooLarge);
}

#[test]
fn foreign_bytes_are_explained() {
    assert_eq!(
        decode(b"GIF89a", "sky.gif", MAX).unwrap_err().to_string(),
        "sky.gif: this is no picture of a known format (valid: png, jpg, jpeg, bmp, tga, hdr, exr)"
    );
    assert!(decode(b"", "", MAX).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..ProptestConfig::default() })]

    /// Spoilt files give a picture or an error, never a panic, and never more pixels than allowed.
    #[test]
    fn spoilt_files_do_no_harm(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        truncate in any::<bool>(),
    ) {
        for (name, mut file) in samples() {
            for (place, value) in &changes {
                let place = place.index(file.len());
                file[place] = *value;
            }
            if truncate {
                file.truncate(cut.index(file.len()));
            }
            if let Ok(image) = decode(&file, name, 4096) {
                prop_assert!(image.pixels().len() <= 4096);
            }
        }
    }

    #[test]
    fn noise_behind_a_signature_does_no_harm(noise in prop::collection::vec(any::<u8>(), 0..200)) {
        for (name, file) in samples() {
            for keep in [2, 8, 20, 60] {
                let spoilt = [&file[..keep.min(file.len())], &noise].concat();
                let _ = decode(&spoilt, name, 4096);
            }
        }
    }
}
