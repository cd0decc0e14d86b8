// SPDX-License-Identifier: MIT OR Apache-2.0
//! Parts as files. Numbers are little-endian; floats are kept bit for bit.
//!
//! ```text
//! 16 bytes  "dioptric part 1\n"
//!  4        length of the text that follows
//!  n        a text of the writer's: what the part belongs to
//! 16        region: x, y, width, height
//!  4        1 if what was hit first is kept, else 0
//!  4        number of blocks
//! per block:
//!  12       first sample, last sample + 1, 1 if it is complete, else 0
//!  40       rays: camera, shadow, reflect, refract, inside
//!  40 each  pixels: light times weight (3 f64), alpha times weight (f64), weight (i32), samples (u32, top bit: finished)
//!  32 each  where it is kept: sums of normal and albedo (6 f32), depth (f32), object (u32)
//!  8        check sum of all before
//! ```

use std::io::{self, Read, Write};
use std::ops::Range;

use dioptric_math::{DVec3, random};
use dioptric_scene::Diagnostic;

use super::Part;
use crate::film::{Film, FilmPixel, FirstSums, pieces::blocks_of};
use crate::region::Region;
use crate::stats::RayCounts;

const MAGIC: &[u8; 16] = b"dioptric part 1\n";

/// The longest text that a part may begin with.
const MAX_TEXT: u32 = 1 << 24;

/// What stands before the numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// The writer's text.
    pub text: String,
    /// The region of the full picture.
    pub region: Region,
    /// Whether what was hit first is kept.
    pub layers: bool,
    blocks: u32,
}

/// Writes a part, with the block that is being made as far as it is.
///
/// # Errors
/// Writing fails.
pub fn write(
    part: &Part,
    begun: Option<(&Range<u32>, &Film)>,
    text: &str,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut out = Checked { inner: out, sum: 0 };
    out.put(MAGIC)?;
    out.put(&(text.len() as u32).to_le_bytes())?;
    out.put(text.as_bytes())?;
    let Region { x, y, width, height } = part.region;
    let begun = begun.or(part.begun.as_ref().map(|(range, film)| (range, film)));
    let blocks: Vec<_> = part
        .blocks
        .iter()
        .map(|(range, film)| (range, film, 1))
        .chain(begun.map(|(r, f)| (r, f, 0)))
        .collect();
    out.words(&[x, y, width, height, u32::from(part.layers), blocks.len() as u32])?;
    let mut row = Vec::new();
    for (range, film, complete) in blocks {
        out.words(&[range.start, range.end, complete])?;
        let RayCounts { camera, shadow, reflect, refract, inside } = film.rays;
        for count in [camera, shadow, reflect, refract, inside] {
            out.put(&count.to_le_bytes())?;
        }
        for pixels in film.pixels().chunks(width.max(1) as usize) {
            row.clear();
            pixels.iter().for_each(|pixel| put_pixel(pixel, &mut row));
            out.put(&row)?;
        }
        for firsts in film.firsts().unwrap_or_default().chunks(width.max(1) as usize) {
            row.clear();
            firsts
                .iter()
                .for_each(|f| f.to_bits().iter().for_each(|w| row.extend(w.to_le_bytes())));
            out.put(&row)?;
        }
    }
    let sum = out.sum;
    out.inner.write_all(&sum.to_le_bytes())?;
    out.inner.flush()
}

/// Reads what stands before a part's numbers.
///
/// # Errors
/// It is no part, or damaged.
pub fn read_head(from: &mut dyn Read) -> Result<Head, Diagnostic> {
    head(&mut Checked { inner: from, sum: 0 })
}

/// Reads a part from a file of so many bytes, with what stands before it.
///
/// # Errors
/// It is no part, or damaged; there is not enough memory.
pub fn read(from: &mut dyn Read, bytes: u64) -> Result<(Head, Part), Diagnostic> {
    let mut from = Checked { inner: from, sum: 0 };
    let head = head(&mut from)?;
    let width = head.region.width;
    // Before memory is taken for what a damaged file says.
    let pixel = 40 + if head.layers { 32 } else { 0 };
    let block = u128::from(head.region.area()) * pixel + 12 + 40;
    let size = 16 + 4 + head.text.len() as u128 + 24 + block * u128::from(head.blocks) + 8;
    if size != u128::from(bytes) {
        return Err(damaged(&format!("it has {bytes} bytes where {size} are expected")));
    }
    let mut part = Part::new(head.region, head.layers);
    for _ in 0..head.blocks {
        let [start, end, complete] = from.words()?;
        let rays: [u64; 5] = from.numbers()?;
        let range = start..end;
        if range.is_empty() || blocks_of(range.clone(), 1 << 31).len() != 1 {
            return Err(damaged("a block of its samples is none"));
        }
        let mut film = Film::new(head.region, head.layers)?;
        let [camera, shadow, reflect, refract, inside] = rays;
        film.rays = RayCounts { camera, shadow, reflect, refract, inside };
        let (pixels, firsts) = film.all_mut();
        let mut row = vec![0; width as usize * 40];
        for pixels in pixels.chunks_mut(width.max(1) as usize) {
            from.fill(&mut row)?;
            pixels
                .iter_mut()
                .zip(row.chunks_exact(40))
                .for_each(|(p, bytes)| *p = get_pixel(bytes));
        }
        row.truncate(width as usize * 32);
        for firsts in firsts.into_iter().flat_map(|f| f.chunks_mut(width.max(1) as usize)) {
            from.fill(&mut row)?;
            firsts.iter_mut().zip(row.chunks_exact(32)).for_each(|(first, bytes)| {
                *first = FirstSums::from_bits(std::array::from_fn(|i| word(bytes, i)));
            });
        }
        match complete {
            1 if part.missing(&range) == [range.clone()] => part.insert(range, film),
            0 if part.begun.is_none() => part.begun = Some((range, film)),
            _ => return Err(damaged("its blocks of samples overlap")),
        }
    }
    let expected = from.sum;
    let mut sum = [0; 8];
    from.inner.read_exact(&mut sum).map_err(|e| damaged(&short(&e)))?;
    if u64::from_le_bytes(sum) != expected {
        return Err(damaged("its check sum is wrong"));
    }
    Ok((head, part))
}

fn head(from: &mut Checked<&mut dyn Read>) -> Result<Head, Diagnostic> {
    let mut magic = [0; 16];
    let got = from.fill(&mut magic);
    if got.is_err() || &magic != MAGIC {
        let other = magic.starts_with(b"dioptric part");
        let what = if other { "it was written by another version" } else { "it is no part" };
        return Err(Diagnostic::error("not-a-part", what)
            .help("name a file that render --checkpoint has written"));
    }
    let [length] = from.words()?;
    if length > MAX_TEXT {
        return Err(damaged("its text is too long"));
    }
    let mut text = vec![0; length as usize];
    from.fill(&mut text)?;
    let text = String::from_utf8(text).map_err(|_| damaged("its text is none"))?;
    let [x, y, width, height, layers, blocks] = from.words()?;
    if width == 0 || height == 0 || layers > 1 || blocks > 128 {
        return Err(damaged("its head makes no sense"));
    }
    Ok(Head { text, region: Region { x, y, width, height }, layers: layers == 1, blocks })
}

fn damaged(why: &str) -> Diagnostic {
    Diagnostic::error("damaged-part", format!("it is damaged: {why}"))
        .help("remove it, or take a copy of it from elsewhere")
}

fn short(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "it ends too early".into(),
        _ => error.to_string(),
    }
}

fn put_pixel(pixel: &FilmPixel, row: &mut Vec<u8>) {
    for number in pixel.color.to_array() {
        row.extend(number.to_le_bytes());
    }
    row.extend(pixel.alpha.to_le_bytes());
    row.extend(pixel.weight.to_le_bytes());
    let finished = u32::from(pixel.is_finished()) << 31;
    row.extend((pixel.count() | finished).to_le_bytes());
}

fn get_pixel(bytes: &[u8]) -> FilmPixel {
    let wide = |i: usize| {
        f64::from_bits(u64::from(word(bytes, 2 * i)) | u64::from(word(bytes, 2 * i + 1)) << 32)
    };
    let state = word(bytes, 9);
    let color = DVec3::new(wide(0), wide(1), wide(2));
    let mut pixel = FilmPixel::from_parts(color, wide(3), word(bytes, 8) as i32, state);
    pixel.set_finished(state >> 31 == 1);
    pixel
}

/// Word `i` of some bytes.
fn word(bytes: &[u8], i: usize) -> u32 {
    bytes.get(4 * i..4 * i + 4).and_then(|b| b.try_into().ok()).map_or(0, u32::from_le_bytes)
}

/// Adds up what goes through.
struct Checked<T> {
    inner: T,
    sum: u64,
}

impl<T> Checked<T> {
    fn note(&mut self, bytes: &[u8]) {
        let mut chunks = bytes.chunks_exact(8);
        for chunk in &mut chunks {
            let word = u64::from(word(chunk, 0)) | u64::from(word(chunk, 1)) << 32;
            self.sum = random::join(self.sum, word);
        }
        for byte in chunks.remainder() {
            self.sum = random::join(self.sum, u64::from(*byte));
        }
    }
}

impl Checked<&mut dyn Write> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.note(bytes);
        self.inner.write_all(bytes)
    }

    fn words(&mut self, words: &[u32]) -> io::Result<()> {
        let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        self.put(&bytes)
    }
}

impl Checked<&mut dyn Read> {
    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), Diagnostic> {
        self.inner.read_exact(bytes).map_err(|e| damaged(&short(&e)))?;
        self.note(bytes);
        Ok(())
    }

    fn words<const N: usize>(&mut self) -> Result<[u32; N], Diagnostic> {
        let mut bytes = vec![0; 4 * N];
        self.fill(&mut bytes)?;
        Ok(std::array::from_fn(|i| word(&bytes, i)))
    }

    fn numbers<const N: usize>(&mut self) -> Result<[u64; N], Diagnostic> {
        let mut numbers = [0; N];
        for number in &mut numbers {
            let mut bytes = [0; 8];
            self.fill(&mut bytes)?;
            *number = u64::from_le_bytes(bytes);
        }
        Ok(numbers)
    }
}
