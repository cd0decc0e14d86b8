// SPDX-License-Identifier: MIT OR Apache-2.0
//! Radiance HDR: RGBE pixels (Ward, "Real Pixels", Graphics Gems II, 1991), in runs where the format allows it.

use crate::buffer::Image;

pub(super) fn encode(image: &Image) -> Vec<u8> {
    let image = image.clone().into_linear();
    let (width, height) = (image.width(), image.height());
    let mut out =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for row in image.rows() {
        let row: Vec<[u8; 4]> = row.iter().map(|&[r, g, b, _]| rgbe([r, g, b])).collect();
        match u16::try_from(width) {
            Ok(w @ 8..=0x7fff) => {
                out.extend([2, 2]);
                out.extend(w.to_be_bytes());
                for component in 0..4 {
                    let plane: Vec<u8> =
                        row.iter().filter_map(|p| p.get(component).copied()).collect();
                    write_runs(&plane, &mut out);
                }
            }
            _ => out.extend(row.into_iter().flatten()),
        }
    }
    out
}

/// Shared exponent and rounded mantissas; what is negative or NaN is 0, what is too bright is the brightest.
fn rgbe(color: [f32; 3]) -> [u8; 4] {
    // The largest value of the format: 255/256 * 2^127.
    let brightest = 255.0 * f64::from_bits((1023 + 119) << 52);
    let [r, g, b] = color.map(|c| f64::from(c).max(0.0).min(brightest));
    let largest = r.max(g).max(b);
    // The exponent e with 2^(e-1) <= largest < 2^e, read from the number's bits.
    let mut exponent = ((largest.to_bits() >> 52) & 0x7ff) as i64 - 1022;
    let mantissa = |c: f64, e: i64| (c * f64::from_bits(((1023 + 8 - e) as u64) << 52)).round();
    if exponent > -128 && mantissa(largest, exponent) >= 256.0 {
        exponent += 1;
    }
    // A stored exponent of 0 means black; light fainter than 2^-128 is.
    match u8::try_from(exponent + 128) {
        Ok(stored @ 1..) => {
            let [r, g, b] = [r, g, b].map(|c| mantissa(c, exponent) as u8);
            [r, g, b, stored]
        }
        _ => [0; 4],
    }
}

/// Runs of 3 to 127 equal bytes, and stretches of up to 128 others.
fn write_runs(plane: &[u8], out: &mut Vec<u8>) {
    let mut rest = plane;
    let mut others: &[u8] = &[];
    while let Some(first) = rest.first() {
        let run = rest.iter().take(127).take_while(|b| *b == first).count();
        let (head, tail) = rest.split_at(run);
        rest = tail;
        if run >= 3 {
            flush(others, out);
            others = &[];
            out.extend([128 + run as u8, *first]);
        } else {
            // `others` and `head` are neighbours in `plane`.
            let end = plane.len() - rest.len();
            let start = end - others.len() - head.len();
            others = plane.get(start..end).unwrap_or(head);
        }
    }
    flush(others, out);
}

fn flush(others: &[u8], out: &mut Vec<u8>) {
    for stretch in others.chunks(128) {
        out.push(stretch.len() as u8);
        out.extend(stretch);
    }
}
