// SPDX-License-Identifier: MIT OR Apache-2.0
//! A grid of pixel coordinates over a picture, so that the X,Y of a pixel can be read off.

use crate::buffer::Image;
use crate::font::{self, draw_text, text_width};

/// Draws a line at every column and row whose coordinate is a multiple of `step`, with its number at the border.
///
/// (`origin_x`, `origin_y`) is the coordinate of the picture's upper left pixel, for parts cut out of a larger picture.
/// A `step` of 0 chooses one of 1, 2 or 5 times a power of ten that leaves room for the numbers. The picture holds
/// stored values.
pub fn draw_grid(image: &mut Image, origin_x: u32, origin_y: u32, step: u32) {
    let scale = (image.width().min(image.height()) / 600).clamp(1, 4);
    let last = u64::from(origin_x.max(origin_y)) + u64::from(image.width().max(image.height()));
    let room = text_width(&last.to_string(), scale) + 6 * scale;
    let step = if step == 0 { round_step(room) } else { step };

    let columns = lines(origin_x, image.width(), step);
    let rows = lines(origin_y, image.height(), step);
    let width = image.width().max(1) as usize;
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (x, y) =
            ((i % width) as u64 + u64::from(origin_x), (i / width) as u64 + u64::from(origin_y));
        if x.is_multiple_of(step.into()) || y.is_multiple_of(step.into()) {
            shade(pixel);
        }
    }
    // Every number that has room; a dense grid numbers every few lines.
    let sparse = |step: u32, room: u32| room.div_ceil(step).max(1) as usize;
    for x in columns.step_by(sparse(step, room)) {
        label(image, i64::from(x) + 1, 0, scale, u64::from(x) + u64::from(origin_x));
    }
    for y in rows
        .step_by(sparse(step, (font::HEIGHT + 5) * scale))
        .filter(|y| *y >= (font::HEIGHT + 2) * scale)
    {
        label(image, 0, i64::from(y) + 1, scale, u64::from(y) + u64::from(origin_y));
    }
}

/// The smallest of 1, 2, 5, 10, 20, 50, ... that is at least `room`.
fn round_step(room: u32) -> u32 {
    (0..9)
        .flat_map(|power| [1, 2, 5].map(|digit| digit * 10_u32.pow(power)))
        .find(|step| *step >= room)
        .unwrap_or(1_000_000_000)
}

/// Places in 0..size whose coordinate is a multiple of `step`.
fn lines(origin: u32, size: u32, step: u32) -> impl Iterator<Item = u32> {
    let first = (step - origin % step) % step;
    (first..size).step_by(step as usize)
}

/// Draws the pixel towards white where it is dark and towards black where it is bright.
fn shade(pixel: &mut [f32; 4]) {
    let [r, g, b, a] = pixel;
    let lightness = 0.3 * *r + 0.6 * *g + 0.1 * *b;
    let target = if lightness < 0.5 { 1.0 } else { 0.0 };
    for c in [r, g, b] {
        *c = if c.is_nan() { target } else { c.clamp(0.0, 1.0) * 0.6 + target * 0.4 };
    }
    *a = 1.0;
}

/// A bright number on a dark box.
fn label(image: &mut Image, x: i64, y: i64, scale: u32, number: u64) {
    let text = number.to_string();
    let width = i64::from(text_width(&text, scale) + 2 * scale);
    let height = i64::from((font::HEIGHT + 2) * scale);
    for py in y..y + height {
        for px in x..x + width {
            if let (Ok(px), Ok(py)) = (u32::try_from(px), u32::try_from(py)) {
                image.set(px, py, [0.05, 0.05, 0.08, 1.0]);
            }
        }
    }
    draw_text(image, x + i64::from(scale), y + i64::from(scale), scale, &text, [1.0, 0.9, 0.4]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transfer::Encoding;

    fn grid(width: u32, height: u32, x: u32, y: u32, step: u32) -> Image {
        let mut image = Image::new(width, height, [0.2, 0.2, 0.2, 1.0], Encoding::Srgb).unwrap();
        draw_grid(&mut image, x, y, step);
        image
    }

    #[test]
    fn lines_lie_on_multiples_of_the_step_in_the_whole_picture() {
        let image = grid(200, 150, 37, 5, 50);
        let plain = [0.2, 0.2, 0.2, 1.0];
        for (x, y) in (100..200).flat_map(|x| (100..150).map(move |y| (x, y))) {
            let on_line = (x + 37) % 50 == 0 || (y + 5) % 50 == 0;
            assert_eq!(image.get(x, y) != Some(plain), on_line, "{x} {y}");
        }
    }

    #[test]
    fn any_step_and_size_is_drawn() {
        for (w, h) in [(1, 1), (7, 300), (1500, 20)] {
            for step in [0, 1, 3, 1_000_000, u32::MAX] {
                grid(w, h, 0, 0, step);
                grid(w, h, u32::MAX - 3, 17, step);
            }
        }
        assert_eq!([1, 2, 3, 30, 51].map(round_step), [1, 2, 5, 50, 100]);
    }
}
