// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the eye sees of light by its wavelength, as lanes of a picture.

use dioptric_math::Spectrum;

/// The wavelengths of [`OBSERVER`], in nanometres.
pub(crate) const WAVELENGTHS: [f64; 16] = [
    400.0, 420.0, 440.0, 460.0, 480.0, 500.0, 520.0, 540.0, 560.0, 580.0, 600.0, 620.0, 640.0,
    660.0, 680.0, 700.0,
];

/// The CIE 1931 standard observer's colour-matching functions x, y and z from 400 to 700 nm in steps of
/// 20 (CIE 015:2018, table 6).
pub(crate) const OBSERVER: [[f64; 3]; 16] = [
    [0.01431, 0.000396, 0.06785],
    [0.13438, 0.004, 0.6456],
    [0.34828, 0.023, 1.74706],
    [0.2908, 0.06, 1.6692],
    [0.09564, 0.13902, 0.81295],
    [0.0049, 0.323, 0.272],
    [0.06327, 0.71, 0.07825],
    [0.2904, 0.954, 0.0203],
    [0.5945, 0.995, 0.0039],
    [0.9163, 0.87, 0.00165],
    [1.0622, 0.631, 0.0008],
    [0.85445, 0.381, 0.00019],
    [0.4479, 0.175, 2e-05],
    [0.1649, 0.061, 0.0],
    [0.04677, 0.017, 0.0],
    [0.011359, 0.004102, 0.0],
];

/// From XYZ to linear Rec. 709 (IEC 61966-2-1:1999).
const TO_RGB: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// Lanes of X, Y and Z.
pub(crate) fn to_rgb(xyz: [f64; 3]) -> Spectrum {
    Spectrum::from(TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]))
}
