// SPDX-License-Identifier: MIT OR Apache-2.0
//! The film: what the samples of each pixel add up to, in linear light.
//!
//! A pixel keeps sums in `f64` and a count, filled by the numbers of its samples ([`pieces`]), so its bits
//! depend on no other pixel, on no thread and on no split of its samples. Its colour is sum(w L) / sum(w).
//! Where it is asked for, what the camera rays hit first is kept beside it: [`FirstSums`].

pub mod pieces;
mod pixel;
mod sum;

use dioptric_image::{Encoding, Image, LayerData, Layers};
use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::Diagnostic;
use rayon::iter::IndexedParallelIterator;

use crate::region::Region;
use crate::stats::RayCounts;

use pieces::Join;
pub use pixel::{FilmPixel, FirstSums};
pub use sum::PixelSum;

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

/// A rendered region of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    region: Region,
    pixels: Vec<FilmPixel>,
    /// Of each pixel, where it was asked for.
    firsts: Option<Vec<FirstSums>>,
    /// The rays that were cast for it, those for neighbours of a crop included.
    pub rays: RayCounts,
}

impl Film {
    /// A film without samples, of light alone or with `layers` of what was hit first.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(region: Region, layers: bool) -> Result<Self, Diagnostic> {
        let firsts = if layers { Some(filled(&region)?) } else { None };
        Ok(Self { region, pixels: filled(&region)?, firsts, rays: RayCounts::default() })
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

    /// What the camera rays of all pixels hit first, where it was asked for.
    #[must_use]
    pub fn firsts(&self) -> Option<&[FirstSums]> {
        self.firsts.as_deref()
    }

    /// What the camera rays of a pixel hit first, where it is kept.
    #[must_use]
    pub fn first(&self, x: u32, y: u32) -> Option<&FirstSums> {
        self.firsts.as_ref()?.get(self.region.index(x, y)?)
    }

    /// A pixel and what its camera rays hit first, where that is kept.
    pub(crate) fn slots(
        &mut self,
        x: u32,
        y: u32,
    ) -> Option<(&mut FilmPixel, Option<&mut FirstSums>)> {
        let index = self.region.index(x, y)?;
        let first = self.firsts.as_mut().and_then(|firsts| firsts.get_mut(index));
        Some((self.pixels.get_mut(index)?, first))
    }

    /// A row of `width` pixels from a place on, and what their camera rays hit first, where that is kept; `None` where the film does
    /// not have all of them.
    pub(crate) fn row_mut(
        &mut self,
        x: u32,
        y: u32,
        width: u32,
    ) -> Option<(&mut [FilmPixel], Option<&mut [FirstSums]>)> {
        let last = x.checked_add(width.checked_sub(1)?)?;
        let own = self.region.index(x, y)?..self.region.index(last, y)? + 1;
        let firsts = self.firsts.as_mut().and_then(|firsts| firsts.get_mut(own.clone()));
        Some((self.pixels.get_mut(own)?, firsts))
    }

    /// All of them.
    pub(crate) fn all_mut(&mut self) -> (&mut [FilmPixel], Option<&mut [FirstSums]>) {
        (&mut self.pixels, self.firsts.as_deref_mut())
    }

    /// A copy.
    ///
    /// # Errors
    /// There is not enough memory.
    pub(crate) fn try_clone(&self) -> Result<Self, Diagnostic> {
        self.cropped(self.region)
    }

    /// Adds the film of later samples of the same region.
    pub(crate) fn join(&mut self, later: &Self) {
        for (pixel, later) in self.pixels.iter_mut().zip(&later.pixels) {
            pixel.join(later);
        }
        let firsts = self.firsts.iter_mut().flatten();
        for (first, later) in firsts.zip(later.firsts.iter().flatten()) {
            first.join(later);
        }
        self.rays.add(&later.rays);
    }

    /// The part of it that lies in a smaller region.
    ///
    /// # Errors
    /// There is not enough memory.
    pub(crate) fn cropped(&self, region: Region) -> Result<Self, Diagnostic> {
        let mut part = Self::new(region, self.firsts.is_some())?;
        part.rays = self.rays;
        for [x, y] in region.pixels() {
            let Some(from) = self.region.index(x, y) else { continue };
            if let Some((pixel, first)) = part.slots(x, y) {
                *pixel = self.pixels[from];
                let kept = self.firsts.as_ref().and_then(|firsts| firsts.get(from));
                first.into_iter().zip(kept).for_each(|(first, kept)| *first = *kept);
            }
        }
        Ok(part)
    }

    pub(crate) fn pixel_mut(&mut self, x: u32, y: u32) -> Option<&mut FilmPixel> {
        let index = self.region.index(x, y)?;
        self.pixels.get_mut(index)
    }

    /// Whether all pixels have all their samples; false after a cancelled job, in which pixels
    /// without samples are black and transparent.
    #[must_use]
    pub fn finished(&self) -> bool {
        self.pixels.iter().all(FilmPixel::is_finished)
    }

    /// Samples of all pixels.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|p| u64::from(p.count())).sum()
    }

    /// The picture in linear light, with alpha where `has_alpha`, else opaque; and the layers `depth`, `normal`,
    /// `albedo`, `object` and `samples` where what was hit first is kept.
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
        let Some(firsts) = &self.firsts else { return Ok(layers) };
        let all = || firsts.iter().zip(&self.pixels).map(|(first, pixel)| (first, pixel.count()));
        let normals = all().map(|(first, count)| first.normal(count)).collect();
        let albedos = all().map(|(first, count)| first.albedo(count)).collect();
        layers.push("depth", LayerData::Scalar(firsts.iter().map(|p| p.depth).collect()))?;
        layers.push("normal", LayerData::Vector(normals))?;
        layers.push("albedo", LayerData::Color(albedos))?;
        layers.push("object", LayerData::Id(firsts.iter().map(|p| p.object).collect()))?;
        layers.push("samples", LayerData::Id(all().map(|(_, count)| count).collect()))?;
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

    fn sum(samples: &[(f64, Radiance)]) -> (FilmPixel, FirstSums) {
        let mut sum = PixelSum::new(true);
        sum.start(0, &FilmPixel::default(), None);
        samples.iter().for_each(|(weight, radiance)| sum.add(*weight, radiance));
        sum.finish()
    }

    #[test]
    fn a_pixel_is_the_weighted_mean_of_its_samples() {
        assert_eq!(FilmPixel::default().rgba(), [0.0; 4]);
        assert_eq!(FirstSums::default().normal(0), [0.0; 3]);
        let (pixel, first) = sum(&[(1.0, hit(0.5, 7)), (1.0, hit(0.25, 8)), (-1.0, hit(1.0, 9))]);
        assert_eq!(pixel.rgba(), [-0.25, -0.25, -0.25, 1.0]);
        assert_eq!((first.object, first.depth, pixel.count()), (7, 7.0, 3));
        assert_eq!(first.normal(3), [0.0, 0.0, 1.0]);
        assert!((first.albedo(3)[0] - 1.75 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn misses_are_transparent_and_infinitely_far() {
        let miss = Radiance { color: Spectrum::ZERO, alpha: 0.0, first: FirstHit::NONE };
        let (pixel, first) = sum(&[(1.0, miss), (1.0, hit(1.0, 3))]);
        assert_eq!(pixel.rgba(), [0.5; 4]);
        assert_eq!((first.object, first.depth), (FirstHit::NOTHING, f32::INFINITY));
        assert_eq!(first.normal(2), [0.0, 0.0, 0.5]);
    }

    #[test]
    fn films_are_found_by_the_full_pictures_coordinates() {
        let mut film = Film::new(Region { x: 10, y: 20, width: 3, height: 2 }, true).unwrap();
        let (pixel, first) = film.slots(12, 21).unwrap();
        (*pixel, *first.unwrap()) = sum(&[(1.0, hit(1.0, 5))]);
        assert_eq!(film.pixels()[5].count(), 1);
        assert!(film.pixel(9, 20).is_none() && film.pixel(13, 20).is_none());
        let layers = film.to_layers(true).unwrap();
        assert_eq!(layers.picture.get(2, 1), Some([1.0; 4]));
        assert_eq!(layers.get("samples"), Some(&LayerData::Id(vec![0, 0, 0, 0, 0, 1])));
        assert_eq!(film.to_layers(false).unwrap().picture.get(0, 0), Some([0.0, 0.0, 0.0, 1.0]));
    }

    #[test]
    fn too_large_films_are_refused_before_memory_is_taken() {
        let region = Region { x: 0, y: 0, width: u32::MAX, height: u32::MAX };
        assert_eq!(Film::new(region, false).unwrap_err().code, "out-of-memory");
    }
}
