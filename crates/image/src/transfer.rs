// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer curves: between linear light and the values that are stored for a display.

use crate::error::ImageError;
use crate::names;
use dioptric_math::pow;

/// What stored colour values mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// The sRGB curve of IEC 61966-2-1:1999.
    #[default]
    Srgb,
    /// The values are the light itself: nothing is encoded or decoded.
    Raw,
    /// A power curve with exponent 2.2, that of old display tubes.
    Gamma,
}

impl Encoding {
    /// The names that [`Encoding::parse`] knows.
    pub const NAMES: [&'static str; 3] = ["srgb", "raw", "gamma"];

    /// The encoding of a name.
    ///
    /// # Errors
    /// Names that are not in [`Encoding::NAMES`]; the error lists them.
    pub fn parse(name: &str) -> Result<Self, ImageError> {
        match name {
            "srgb" => Ok(Self::Srgb),
            "raw" => Ok(Self::Raw),
            "gamma" => Ok(Self::Gamma),
            _ => Err(names::unknown("encoding", name, &Self::NAMES)),
        }
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb",
            Self::Raw => "raw",
            Self::Gamma => "gamma",
        }
    }

    /// The stored value of linear light; defined below 0 by symmetry, above 1 by going on.
    #[must_use]
    pub fn encode(self, linear: f64) -> f64 {
        match self {
            Self::Srgb => srgb_from_linear(linear),
            Self::Raw => linear,
            Self::Gamma => pow(linear.abs(), 1.0 / 2.2).copysign(linear),
        }
    }

    /// The linear light of a stored value, the inverse of [`Encoding::encode`].
    #[must_use]
    pub fn decode(self, stored: f64) -> f64 {
        match self {
            Self::Srgb => linear_from_srgb(stored),
            Self::Raw => stored,
            Self::Gamma => pow(stored.abs(), 2.2).copysign(stored),
        }
    }
}

/// sRGB value of linear light (IEC 61966-2-1:1999, section 5.2), odd around 0.
#[must_use]
pub fn srgb_from_linear(linear: f64) -> f64 {
    let c = linear.abs();
    let v = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * pow(c, 1.0 / 2.4) - 0.055 };
    v.copysign(linear)
}

/// Linear light of an sRGB value (IEC 61966-2-1:1999, section 5.2), odd around 0.
#[must_use]
pub fn linear_from_srgb(value: f64) -> f64 {
    let v = value.abs();
    let c = if v <= 0.040_45 { v / 12.92 } else { pow((v + 0.055) / 1.055, 2.4) };
    c.copysign(value)
}

/// The linear light of all 256 values of 8-bit sRGB, each [`linear_from_srgb`] of `i / 255`.
#[must_use]
pub fn srgb_table() -> [f32; 256] {
    std::array::from_fn(|i| linear_from_srgb(i as f64 / 255.0) as f32)
}

/// The 8-bit value of a number in 0..1: `floor(255 v + 0.5)` after clamping; NaN gives 0.
#[must_use]
pub fn quantize_8(v: f64) -> u8 {
    // NaN passes through the clamp and becomes 0 in the conversion.
    (255.0 * v.clamp(0.0, 1.0) + 0.5).floor() as u8
}

/// The 16-bit value of a number in 0..1: `floor(65535 v + 0.5)` after clamping; NaN gives 0.
#[must_use]
pub fn quantize_16(v: f64) -> u16 {
    (65535.0 * v.clamp(0.0, 1.0) + 0.5).floor() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_8_and_16_bit_value_survives_the_round_trip() {
        let table = srgb_table();
        for encoding in [Encoding::Srgb, Encoding::Raw, Encoding::Gamma] {
            for i in 0..=255_u8 {
                let linear = encoding.decode(f64::from(i) / 255.0) as f32;
                assert_eq!(quantize_8(encoding.encode(f64::from(linear))), i, "{encoding:?}");
                if encoding == Encoding::Srgb {
                    assert_eq!(table[i as usize], linear);
                }
            }
            for i in (0..=65535_u16).step_by(7) {
                let stored = f64::from(i) / 65535.0;
                assert_eq!(quantize_16(encoding.encode(encoding.decode(stored))), i);
            }
        }
    }

    #[test]
    fn srgb_goes_through_published_points() {
        // Middle grey: 18 % light is 46.1 % sRGB; half the value is 21.4 % of the light.
        assert!((srgb_from_linear(0.18) - 0.461_356).abs() < 1e-6);
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6);
        assert_eq!(srgb_from_linear(0.0), 0.0);
        assert!((srgb_from_linear(1.0) - 1.0).abs() < 1e-15);
        assert_eq!(srgb_from_linear(-0.5), -srgb_from_linear(0.5));
    }

    #[test]
    fn quantizing_clamps_and_rounds_half_up() {
        for (v, expected) in [
            (f64::NAN, 0),
            (f64::INFINITY, 255),
            (f64::NEG_INFINITY, 0),
            (0.5, 128),
            (0.499 / 255.0, 0),
            (0.5 / 255.0, 1),
            (2.0, 255),
        ] {
            assert_eq!(quantize_8(v), expected, "{v}");
        }
        assert_eq!(quantize_16(0.5), 32768);
        assert_eq!(quantize_16(f64::NAN), 0);
    }

    #[test]
    fn names_round_trip_and_unknown_ones_are_explained() {
        for name in Encoding::NAMES {
            assert_eq!(Encoding::parse(name).unwrap().name(), name);
        }
        let error = Encoding::parse("sRBG").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown encoding \"sRBG\" (did you mean \"srgb\"? valid: srgb, raw, gamma)"
        );
    }
}
