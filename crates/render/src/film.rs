// SPDX-License-Identifier: MIT OR Apache-2.0
//! The film: what the samples of each pixel add up to, in linear light.
//!
//! A pixel keeps sums in `f64` and a count, filled in the order of its samples, so its bits depend on
//! no other pixel and on no thread. Its colour is sum(w L) / sum(w). Beside the colour it keeps what
//! the camera rays hit first: normals and albedo as the plain mean over the samples (those that hit
//! nothing count as zero); depth and object of the first sample, number 0, since a mean of two
//! distances or two names is neither.

use dioptric_image::{Encoding, Image, LayerData, Layers};
use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::Diagnostic;
use rayon::iter::IndexedParallelIterator;

use crate::region::Region;
use crate::stats::RayCounts;

/// What one camera sample brings home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// The light, as it adds up: where `alpha` is below 1 already multiplied by it.
    pub color: Spectrum,
    /// How much of the sample is covered: 0 where a transparent background is seen.
    pub alpha: f64,
    /// What the camera ray hit.
    pub first: FirstHit,
}

impl Radiance {
    /// Black, and seen through.
    pub const NOTHING: Self = Self { color: Spectrum::ZERO, alpha: 0.0, first: FirstHit::NONE };
}

/// What a camera ray hit first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Unique for each (instance, object); [`FirstHit::NOTHING`] where nothing was hit.
    pub object: u32,
    /// Distance along the ray, whose direction is a unit vector; infinite where nothing was hit.
    pub depth: f64,
    /// The shading normal in the space of rays; zero where nothing was hit.
    pub normal: DVec3,
    /// The surface's own colour; zero where nothing was hit.
    pub albedo: Spectrum,
}

impl FirstHit {
    /// The object where nothing was hit.
    pub const NOTHING: u32 = u32::MAX;

    /// Nothing was hit.
    pub const NONE: Self = Self {
        object: Self::NOTHING,
        depth: f64::INFINITY,
        normal: DVec3::ZERO,
        albedo: Spectrum::ZERO,
    };
}

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPixel {
    /// Sum of weight times colour.
    pub color: Spectrum,
    /// Sum of weight times alpha.
    pub alpha: f64,
    /// Sum of weights.
    pub weight: f64,
    /// Samples added; 0 in a pixel that has not been rendered.
    pub count: u32,
    /// Object of sample 0.
    pub object: u32,
    /// Distance of sample 0.
    pub depth: f32,
    /// Whether no more samples will come.
    pub finished: bool,
    normal: [f32; 3],
    albedo: [f32; 3],
}

impl Default for FilmPixel {
    fn default() -> Self {
        Self {
            color: Spectrum::ZERO,
            alpha: 0.0,
            weight: 0.0,
            count: 0,
            object: FirstHit::NOTHING,
            depth: f32::INFINITY,
            finished: false,
            normal: [0.0; 3],
            albedo: [0.0; 3],
        }
    }
}

impl FilmPixel {
    /// Adds the next sample.
    pub fn add(&mut self, weight: f64, radiance: &Radiance) {
        let first = &radiance.first;
        if self.count == 0 {
            self.object = first.object;
            self.depth = first.depth as f32;
        }
        self.color += radiance.color * weight;
        self.alpha += radiance.alpha * weight;
        self.weight += weight;
        self.count += 1;
        for (sum, part) in [(&mut self.normal, first.normal), (&mut self.albedo, first.albedo)] {
            for (sum, part) in sum.iter_mut().zip(part.to_array()) {
                *sum += part as f32;
            }
        }
    }

    /// The pixel's light; black where there are no samples.
    #[must_use]
    pub fn linear(&self) -> Spectrum {
        if self.count == 0 { Spectrum::ZERO } else { self.color / self.weight }
    }

    /// The pixel as it goes into files: light, and how much of it is covered, 0 to 1.
    #[must_use]
    pub fn rgba(&self) -> [f32; 4] {
        if self.count == 0 {
            return [0.0; 4];
        }
        let [r, g, b] = self.linear().to_array().map(|c| c as f32);
        [r, g, b, (self.alpha / self.weight).clamp(0.0, 1.0) as f32]
    }

    /// Mean normal over the samples.
    #[must_use]
    pub fn normal(&self) -> [f32; 3] {
        self.normal.map(|c| c / self.count.max(1) as f32)
    }

    /// Mean albedo over the samples.
    #[must_use]
    pub fn albedo(&self) -> [f32; 3] {
        self.albedo.map(|c| c / self.count.max(1) as f32)
    }
}

/// A rendered region of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    region: Region,
    pixels: Vec<FilmPixel>,
    /// The rays that were cast for it, those for neighbours of a crop included.
    pub rays: RayCounts,
}

impl Film {
    /// A film without samples.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(region: Region) -> Result<Self, Diagnostic> {
        Ok(Self { region, pixels: filled(&region)?, rays: RayCounts::default() })
    }

    /// The region of the full picture that this is.
    #[must_use]
    pub const fn region(&self) -> Region {
        self.region
    }

    /// A pixel by its column and row in the full picture.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<&FilmPixel> {
        self.pixels.get(self.region.index(x, y)?)
    }

    /// All pixels of the region, row by row from its top left.
    #[must_use]
    pub fn pixels(&self) -> &[FilmPixel] {
        &self.pixels
    }

    pub(crate) fn pixel_mut(&mut self, x: u32, y: u32) -> Option<&mut FilmPixel> {
        let index = self.region.index(x, y)?;
        self.pixels.get_mut(index)
    }

    /// Whether all pixels have all their samples; false after a cancelled job, in which pixels
    /// without samples are black and transparent.
    #[must_use]
    pub fn finished(&self) -> bool {
        self.pixels.iter().all(|p| p.finished)
    }

    /// Samples of all pixels.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|p| u64::from(p.count)).sum()
    }

    /// The picture in linear light with the layers `depth`, `normal`, `albedo`, `object` and
    /// `samples`; with alpha where `has_alpha`, else opaque.
    ///
    /// # Errors
    /// The region is empty.
    pub fn to_layers(&self, has_alpha: bool) -> Result<Layers, dioptric_image::ImageError> {
        let opaque = |[r, g, b, a]: [f32; 4]| [r, g, b, if has_alpha { a } else { 1.0 }];
        let colors = self.pixels.iter().map(|p| opaque(p.rgba())).collect();
        let mut picture =
            Image::from_pixels(self.region.width, self.region.height, colors, Encoding::Raw)?;
        picture.has_alpha = has_alpha;
        let mut layers = Layers::from(picture);
        let all = &self.pixels;
        layers.push("depth", LayerData::Scalar(all.iter().map(|p| p.depth).collect()))?;
        layers.push("normal", LayerData::Vector(all.iter().map(FilmPixel::normal).collect()))?;
        layers.push("albedo", LayerData::Color(all.iter().map(FilmPixel::albedo).collect()))?;
        layers.push("object", LayerData::Id(all.iter().map(|p| p.object).collect()))?;
        layers.push("samples", LayerData::Id(all.iter().map(|p| p.count).collect()))?;
        Ok(layers)
    }
}

/// From here on it takes as long as some rendering until the memory has been touched: by all threads, then.
const LARGE: usize = 1 << 16;

/// One default value for each pixel of a region.
///
/// # Errors
/// There is not enough memory.
pub(crate) fn filled<T: Clone + Default + Send>(region: &Region) -> Result<Vec<T>, Diagnostic> {
    let mut values = Vec::new();
    let count = usize::try_from(region.area()).unwrap_or(usize::MAX);
    values.try_reserve_exact(count).map_err(|_| {
        let (width, height) = (region.width, region.height);
        let message = format!("not enough memory for a picture of {width} x {height} pixels");
        Diagnostic::error("out-of-memory", message).help("make it smaller, or render it in crops")
    })?;
    dioptric_geometry::memory::advise(&values);
    // Outside a pool rayon would start the global one.
    if count >= LARGE && rayon::current_thread_index().is_some() {
        rayon::iter::repeat_n(T::default(), count).collect_into_vec(&mut values);
    } else {
        values.resize(count, T::default());
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(color: f64, object: u32) -> Radiance {
        let first = FirstHit {
            object,
            depth: f64::from(object),
            normal: DVec3::Z,
            albedo: Spectrum::splat(color),
        };
        Radiance { color: Spectrum::splat(color), alpha: 1.0, first }
    }

    #[test]
    fn a_pixel_is_the_weighted_mean_of_its_samples() {
        let mut pixel = FilmPixel::default();
        assert_eq!((pixel.rgba(), pixel.normal()), ([0.0; 4], [0.0; 3]));
        pixel.add(1.0, &hit(0.5, 7));
        pixel.add(1.0, &hit(0.25, 8));
        pixel.add(-1.0, &hit(1.0, 9));
        assert_eq!(pixel.rgba(), [-0.25, -0.25, -0.25, 1.0]);
        assert_eq!((pixel.object, pixel.depth, pixel.count), (7, 7.0, 3));
        assert_eq!(pixel.normal(), [0.0, 0.0, 1.0]);
        assert!((pixel.albedo()[0] - 1.75 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn misses_are_transparent_and_infinitely_far() {
        let mut pixel = FilmPixel::default();
        let miss = Radiance { color: Spectrum::ZERO, alpha: 0.0, first: FirstHit::NONE };
        pixel.add(1.0, &miss);
        pixel.add(1.0, &hit(1.0, 3));
        assert_eq!(pixel.rgba(), [0.5; 4]);
        assert_eq!((pixel.object, pixel.depth), (FirstHit::NOTHING, f32::INFINITY));
        assert_eq!(pixel.normal(), [0.0, 0.0, 0.5]);
    }

    #[test]
    fn films_are_found_by_the_full_pictures_coordinates() {
        let mut film = Film::new(Region { x: 10, y: 20, width: 3, height: 2 }).unwrap();
        film.pixel_mut(12, 21).unwrap().add(1.0, &hit(1.0, 5));
        assert_eq!(film.pixels()[5].count, 1);
        assert!(film.pixel(9, 20).is_none() && film.pixel(13, 20).is_none());
        let layers = film.to_layers(true).unwrap();
        assert_eq!(layers.picture.get(2, 1), Some([1.0; 4]));
        assert_eq!(layers.get("samples"), Some(&LayerData::Id(vec![0, 0, 0, 0, 0, 1])));
        assert_eq!(film.to_layers(false).unwrap().picture.get(0, 0), Some([0.0, 0.0, 0.0, 1.0]));
    }

    #[test]
    fn too_large_films_are_refused_before_memory_is_taken() {
        let region = Region { x: 0, y: 0, width: u32::MAX, height: u32::MAX };
        assert_eq!(Film::new(region).unwrap_err().code, "out-of-memory");
    }
}
