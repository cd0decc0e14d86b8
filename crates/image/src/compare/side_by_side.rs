// SPDX-License-Identifier: MIT OR Apache-2.0
//! Two pictures and their difference in one figure, labelled, as a report needs it.

use super::{check_comparable, compare, difference};
use crate::buffer::Image;
use crate::error::ImageError;
use crate::font::{self, draw_text, text_width};
use crate::ramp::false_colour;
use crate::transfer::Encoding;

const PAPER: [f32; 4] = [0.11, 0.11, 0.13, 1.0];
const INK: [f32; 3] = [0.92, 0.92, 0.92];
const FAINT: [f32; 3] = [0.62, 0.64, 0.68];

/// Draws `a`, `b` and their difference beside each other, with `titles` above the first two, a scale beside the third
/// and the numbers of [`compare`] below. The difference of a pixel is that of its most different
/// channel times `amplify`, in false colours. Values are shown as stored, linear light in sRGB.
///
/// # Errors
/// As [`compare`], and where the figure does not fit into memory.
pub fn side_by_side(
    a: &Image,
    b: &Image,
    titles: [&str; 2],
    amplify: f64,
) -> Result<Image, ImageError> {
    check_comparable(a, b)?;
    let numbers = compare(a, b, 0.0)?;
    let (width, height) = (a.width(), a.height());
    let scale = (width / 250).clamp(1, 4);
    let (gap, line) = (8 * scale, (font::HEIGHT + 5) * scale);
    // Beside the difference: a bar and room for its largest number.
    let top_label = format!("{:.3}", 1.0 / amplify);
    let legend = gap + 4 * scale + text_width(&top_label, scale);

    let add = |parts: &[u32]| parts.iter().try_fold(0_u32, |sum, part| sum.checked_add(*part));
    let total_width = add(&[gap, width, gap, width, gap, width, gap, legend, gap]);
    let Some(total_width) = total_width else { return Err(too_large(width, height)) };
    let summary = [
        format!("RMSE {:.6}", numbers.rmse),
        format!("PSNR {:.2} dB", numbers.psnr),
        format!("largest {:.4} at {},{}", numbers.max_difference, numbers.worst.0, numbers.worst.1),
        format!("{:.2} % of the pixels differ", numbers.share_above * 100.0),
    ];
    let footer = wrap(&summary, total_width.saturating_sub(2 * gap), scale);
    let footer_height = line.saturating_mul(footer.len() as u32);
    let total_height =
        add(&[gap, line, height, gap, footer_height]).ok_or_else(|| too_large(width, height))?;
    let mut figure = Image::new(total_width, total_height, PAPER, Encoding::Srgb)?;

    let (top, step) = (gap + line, width + gap);
    paste(&mut figure, gap, top, a.pixels().iter().map(|p| shown(a, *p)), width);
    paste(&mut figure, gap + step, top, b.pixels().iter().map(|p| shown(b, *p)), width);
    let differences = a.pixels().iter().zip(b.pixels()).map(|(pa, pb)| {
        let largest = pa.iter().zip(pb).map(|(va, vb)| difference(*va, *vb)).fold(0.0, f64::max);
        let [r, g, b] = false_colour(largest * amplify);
        [r, g, b, 1.0]
    });
    paste(&mut figure, gap + 2 * step, top, differences, width);

    let amplified =
        if amplify == 1.0 { "difference".to_owned() } else { format!("difference x {amplify}") };
    for (i, title) in [titles[0], titles[1], &amplified].into_iter().enumerate() {
        // A title that is too long for its picture is cut, not written over its neighbour.
        let fits = ((width + scale) / (font::ADVANCE * scale)) as usize;
        let title: String = title.chars().take(fits).collect();
        let x = i64::from(gap) + i as i64 * i64::from(step);
        draw_text(&mut figure, x, gap.into(), scale, &title, INK);
    }
    draw_legend(&mut figure, gap + 3 * step, top, height, scale, &top_label);
    for (i, text) in (0..).zip(&footer) {
        draw_text(
            &mut figure,
            gap.into(),
            i64::from(top + height + gap + i * line),
            scale,
            text,
            FAINT,
        );
    }
    Ok(figure)
}

fn too_large(width: u32, height: u32) -> ImageError {
    ImageError::invalid(
        format!("three pictures of {width} x {height} do not fit into one figure"),
        "compare smaller pictures",
    )
}

/// A pixel as shown: on black where it is transparent.
fn shown(image: &Image, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
    let [r, g, b] = if image.encoding == Encoding::Raw {
        [r, g, b].map(|c| Encoding::Srgb.encode(f64::from(c)) as f32)
    } else {
        [r, g, b].map(|c| c * a)
    };
    [r, g, b, 1.0]
}

fn paste(figure: &mut Image, x: u32, y: u32, pixels: impl Iterator<Item = [f32; 4]>, width: u32) {
    for (i, pixel) in (0_u64..).zip(pixels) {
        let (column, row) = (i % u64::from(width), i / u64::from(width));
        figure.set(x + column as u32, y + row as u32, pixel);
    }
}

/// The false colours from 0 below to the largest difference that they tell apart.
fn draw_legend(figure: &mut Image, x: u32, y: u32, height: u32, scale: u32, top_label: &str) {
    for row in 0..height {
        let [r, g, b] = false_colour(1.0 - f64::from(row) / f64::from(height.max(2) - 1));
        for column in 0..6 * scale {
            figure.set(x + column, y + row, [r, g, b, 1.0]);
        }
    }
    let left = i64::from(x + 8 * scale);
    draw_text(figure, left, y.into(), scale, top_label, FAINT);
    if height > 3 * font::HEIGHT * scale {
        draw_text(figure, left, i64::from(y + height - font::HEIGHT * scale), scale, "0", FAINT);
    }
}

/// Puts the parts into lines of at most `width` pixels, as many to a line as fit.
fn wrap(parts: &[String], width: u32, scale: u32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in parts {
        match lines.last_mut() {
            Some(last)
                if text_width(last, scale) + text_width("   ", scale) + text_width(part, scale)
                    < width =>
            {
                last.push_str("   ");
                last.push_str(part);
            }
            _ => lines.push(part.clone()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(width: u32, height: u32) -> [Image; 2] {
        let a = Image::new(width, height, [0.2, 0.4, 0.6, 1.0], Encoding::Srgb).unwrap();
        let mut b = a.clone();
        b.set(width / 2, height / 2, [0.2, 0.4, 0.7, 1.0]);
        [a, b]
    }

    #[test]
    fn the_figure_holds_both_pictures_and_their_difference() {
        let [a, b] = pair(80, 60);
        let figure = side_by_side(&a, &b, ["with", "without"], 5.0).unwrap();
        let (top, step) = (8 + 12, 88);
        assert_eq!(figure.get(8, top), a.get(0, 0));
        assert_eq!(figure.get(8 + step + 40, top + 30), b.get(40, 30));
        let [r, g, b, _] = figure.get(8 + 2 * step + 40, top + 30).unwrap();
        let expected = false_colour(0.5);
        assert!([r, g, b].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4));
        let [r, g, b, _] = figure.get(8 + 2 * step, top).unwrap();
        assert_eq!([r, g, b], false_colour(0.0));
    }

    #[test]
    fn figures_of_any_size_are_drawn_and_unlike_pictures_refused() {
        for (w, h) in [(1, 1), (3, 200), (900, 4)] {
            let [a, b] = pair(w, h);
            side_by_side(&a, &b, ["a title that is far too long for a narrow picture", "b"], 8.0)
                .unwrap();
        }
        assert!(side_by_side(&pair(2, 2)[0], &pair(3, 2)[0], ["a", "b"], 1.0).is_err());
    }
}
