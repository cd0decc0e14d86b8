// SPDX-License-Identifier: MIT OR Apache-2.0
//! The value of a picture at any point of the plane: what is between the texels, and beyond the edge.
//!
//! Coordinates: u runs to the right and v upwards, the picture is the unit square. The texel in
//! column i and row j from the top, of w by h, has its middle at `u = (i + 1/2) / w`,
//! `v = 1 - (j + 1/2) / h`; it covers `i / w <= u < (i + 1) / w` and
//! `1 - (j + 1) / h <= v < 1 - j / h`.

use std::sync::Arc;

use super::Texture;

/// What is between the middles of the texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The value of the texel in which the point lies.
    Nearest,
    /// A mean of the four texels around, weighted by area; of decoded values.
    Bilinear,
}

impl Filter {
    /// The words of the `filter` parameter.
    pub const NAMES: &'static [&'static str] = &["bilinear", "nearest"];

    /// The filter with this name; any other name is the first.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        if name == "nearest" { Self::Nearest } else { Self::Bilinear }
    }
}

/// What is beyond the picture's edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture's mirror image, then the picture again.
    Mirror,
    /// The texel at the edge.
    Clamp,
    /// The border's colour.
    Border,
}

impl Wrap {
    /// The words of the `wrap` parameter.
    pub const NAMES: &'static [&'static str] = &["repeat", "mirror", "clamp", "border"];

    /// The way with this name; any other name is the first.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        match name {
            "mirror" => Self::Mirror,
            "clamp" => Self::Clamp,
            "border" => Self::Border,
            _ => Self::Repeat,
        }
    }

    /// The texel that stands for whole index `i` among `count`; `None` is the border.
    fn index(self, i: f64, count: usize) -> Option<usize> {
        let n = count as f64;
        // Nearly all are inside; the remainders below are slow.
        if i >= 0.0 && i < n {
            return Some(i as usize);
        }
        let inside = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => {
                let m = i.rem_euclid(2.0 * n);
                if m < n { m } else { 2.0 * n - 1.0 - m }
            }
            Self::Clamp => i.clamp(0.0, n - 1.0),
            Self::Border => return None,
        };
        Some(inside as usize)
    }
}

/// A picture and how it is looked up.
#[derive(Clone, Debug)]
pub struct Lookup {
    /// The picture.
    pub texture: Arc<Texture>,
    /// Between the texels.
    pub filter: Filter,
    /// Beyond the edge, in u and in v.
    pub wrap: [Wrap; 2],
    /// The colour for [`Wrap::Border`], in linear light.
    pub border: [f64; 3],
    /// Whether the values are colours (see [`Texture::texel`]).
    pub as_color: bool,
}

impl Lookup {
    /// Red, green, blue and alpha at a point; where it is not finite, at (0, 0).
    #[must_use]
    pub fn eval(&self, u: f64, v: f64) -> [f64; 4] {
        // In texels, rows counted from the bottom.
        let (x, y) = (u * self.texture.width() as f64, v * self.texture.height() as f64);
        let (x, y) = if x.is_finite() && y.is_finite() { (x, y) } else { (0.0, 0.0) };
        let (w, h) = (self.texture.width(), self.texture.height());
        let (column, row) = (|i| self.wrap[0].index(i, w), |j| self.wrap[1].index(j, h));
        match self.filter {
            Filter::Nearest => self.texel(column(x.floor()), row(y.floor())),
            Filter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (i, j) = (x.floor(), y.floor());
                let (s, t) = (x - i, y - j);
                let (left, right) = (column(i), column(i + 1.0));
                let along = |row| {
                    let (a, b) = (self.texel(left, row), self.texel(right, row));
                    std::array::from_fn(|c| a[c] * (1.0 - s) + b[c] * s)
                };
                let (low, high): ([f64; 4], [f64; 4]) = (along(row(j)), along(row(j + 1.0)));
                std::array::from_fn(|c| low[c] * (1.0 - t) + high[c] * t)
            }
        }
    }

    /// The texel in a column and a row from the bottom, or the border's.
    fn texel(&self, column: Option<usize>, row: Option<usize>) -> [f64; 4] {
        match (column, row) {
            (Some(x), Some(up)) => {
                let y = (self.texture.height() - 1).saturating_sub(up);
                self.texture.texel(x, y, self.as_color)
            }
            _ => [self.border[0], self.border[1], self.border[2], 0.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_image::{Encoding, Image};

    /// Red counts columns, green counts rows from the top.
    fn grid(w: u32, h: u32) -> Arc<Texture> {
        let image = Image::from_fn(w, h, Encoding::Raw, |x, y| [x as f32, y as f32, 0.0]).unwrap();
        Arc::new(Texture::from_stored(image.into()))
    }

    fn lookup(filter: Filter, wrap: Wrap) -> Lookup {
        Lookup { texture: grid(4, 2), filter, wrap: [wrap; 2], border: [9.0; 3], as_color: true }
    }

    #[test]
    fn nearest_gives_the_texel_that_covers_the_point() {
        let l = lookup(Filter::Nearest, Wrap::Repeat);
        for (u, v, x, y) in [
            (0.0, 0.0, 0.0, 1.0),
            (0.0, 0.999, 0.0, 0.0),
            (0.249, 0.5, 0.0, 0.0),
            (0.25, 0.499, 1.0, 1.0),
            (0.999, 0.25, 3.0, 1.0),
            (1.0, 1.0, 0.0, 1.0),
            (-0.001, -0.001, 3.0, 0.0),
        ] {
            assert_eq!(l.eval(u, v)[..2], [x, y], "{u} {v}");
        }
    }

    #[test]
    fn bilinear_is_exact_at_middles_and_linear_between() {
        let l = lookup(Filter::Bilinear, Wrap::Clamp);
        for i in 0..4 {
            for j in 0..2 {
                let (u, v) = ((f64::from(i) + 0.5) / 4.0, 1.0 - (f64::from(j) + 0.5) / 2.0);
                assert_eq!(l.eval(u, v)[..2], [f64::from(i), f64::from(j)]);
            }
        }
        assert_eq!(l.eval(0.25, 0.5)[..2], [0.5, 0.5]);
        assert_eq!(l.eval(0.3125, 0.4375)[..2], [0.75, 0.625]);
        assert_eq!(l.eval(0.0, 1.0)[..2], [0.0, 0.0], "clamped");
        let around = lookup(Filter::Bilinear, Wrap::Repeat);
        assert_eq!(around.eval(0.0, 0.75)[0], 1.5, "half of the first and half of the last");
    }

    #[test]
    fn beyond_the_edge() {
        let columns = |wrap: Wrap| {
            [-1.1, -0.1, 1.1, 2.1].map(|u| lookup(Filter::Nearest, wrap).eval(u, 0.75)[0])
        };
        assert_eq!(columns(Wrap::Repeat), [3.0, 3.0, 0.0, 0.0]);
        assert_eq!(columns(Wrap::Mirror), [3.0, 0.0, 3.0, 0.0]);
        assert_eq!(columns(Wrap::Clamp), [0.0, 0.0, 3.0, 3.0]);
        assert_eq!(columns(Wrap::Border), [9.0; 4]);
        assert_eq!(lookup(Filter::Nearest, Wrap::Border).eval(0.5, 1.0)[3], 0.0);
        assert_eq!(lookup(Filter::Nearest, Wrap::Border).eval(0.5, 0.9)[3], 1.0);
    }

    #[test]
    fn huge_and_broken_coordinates_have_a_value() {
        let strange = [1e18, -1e18, 1e300, f64::MAX, -f64::MAX, f64::INFINITY, f64::NAN, -1e-300];
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Border] {
            for filter in [Filter::Nearest, Filter::Bilinear] {
                for u in strange {
                    for v in strange {
                        let value = lookup(filter, wrap).eval(u, v);
                        assert!(value.iter().all(|c| *c >= 0.0 && *c <= 9.0), "{u} {v} {value:?}");
                    }
                }
            }
        }
    }
}
