// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tone curves: from light without an upper end to what a display can show.

use dioptric_math::{log2, pow};

use crate::error::ImageError;
use crate::names;

/// The curve that brings light without an upper end into 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// No curve: what is above 1 is cut.
    #[default]
    None,
    /// Every channel divided by 1 + luminance: Reinhard et al., "Photographic Tone Reproduction
    /// for Digital Images", SIGGRAPH 2002, equation 3, applied to the luminance.
    Reinhard,
    /// A film's toe and shoulder: Hable, "Filmic Tonemapping Operators", 2010 (the curve of the
    /// game Uncharted 2), with its constants, exposure bias 2 and white at 11.2.
    Filmic,
    /// Narkowicz, "ACES Filmic Tone Mapping Curve", 2016: a rational fit to the reference
    /// rendering of the Academy Color Encoding System, more contrast than `filmic`.
    Aces,
    /// Sobotka's AgX of 2022, in Wrensch's short form ("Minimal AgX Implementation", 2023): what is bright loses its colour
    /// as on film, so that no hue turns on its way to white. The curve is scaled to end at 1.
    Agx,
    /// The Khronos Group's "PBR Neutral" of 2024: colours up to 0.8 are shown as they are, but for the share that a glossy
    /// surface mirrors; only what is above is pressed together.
    Neutral,
}

impl Tone {
    /// All curves.
    pub const ALL: [Self; 6] =
        [Self::None, Self::Reinhard, Self::Filmic, Self::Aces, Self::Agx, Self::Neutral];

    /// The names that [`Tone::parse`] knows.
    pub const NAMES: [&'static str; 6] = ["none", "reinhard", "filmic", "aces", "agx", "neutral"];

    /// The tone curve of a name.
    ///
    /// # Errors
    /// Names that are not in [`Tone::NAMES`]; the error lists them.
    pub fn parse(name: &str) -> Result<Self, ImageError> {
        match name {
            "none" => Ok(Self::None),
            "reinhard" => Ok(Self::Reinhard),
            "filmic" => Ok(Self::Filmic),
            "aces" => Ok(Self::Aces),
            "agx" => Ok(Self::Agx),
            "neutral" => Ok(Self::Neutral),
            _ => Err(names::unknown("tone curve", name, &Self::NAMES)),
        }
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Reinhard => "reinhard",
            Self::Filmic => "filmic",
            Self::Aces => "aces",
            Self::Agx => "agx",
            Self::Neutral => "neutral",
        }
    }

    /// The curve's value for finite light, clamped to 0..1.
    #[must_use]
    pub fn apply(self, [r, g, b]: [f64; 3]) -> [f64; 3] {
        let mapped = match self {
            Self::None => [r, g, b],
            Self::Reinhard => {
                let luminance = dioptric_math::luminance([r, g, b].into()).max(0.0);
                [r, g, b].map(|c| c / (1.0 + luminance))
            }
            Self::Filmic => [r, g, b].map(|c| hable(2.0 * c.max(0.0)) / hable(11.2)),
            Self::Aces => [r, g, b].map(|c| narkowicz(c.max(0.0))),
            Self::Agx => agx([r, g, b].map(|c| c.max(0.0))),
            Self::Neutral => neutral([r, g, b].map(|c| c.max(0.0))),
        };
        mapped.map(|c| c.clamp(0.0, 1.0))
    }
}

/// Hable's curve before the division by its value at white.
fn hable(x: f64) -> f64 {
    const A: f64 = 0.15; // shoulder strength
    const B: f64 = 0.50; // linear strength
    const C: f64 = 0.10; // linear angle
    const D: f64 = 0.20; // toe strength
    const E: f64 = 0.02; // toe numerator
    const F: f64 = 0.30; // toe denominator
    (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F
}

/// Narkowicz's fit.
fn narkowicz(x: f64) -> f64 {
    (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)
}

/// AgX: primaries moved inwards, a curve over the logarithm of the light, and back.
fn agx(light: [f64; 3]) -> [f64; 3] {
    const INSET: [[f64; 3]; 3] = [
        [0.842_479_062_253_094, 0.078_433_599_999_999_2, 0.079_223_745_147_764_3],
        [0.042_328_242_261_012_3, 0.878_468_636_469_772, 0.079_166_127_460_543_4],
        [0.042_375_654_905_705_1, 0.078_433_6, 0.879_142_973_793_104],
    ];
    const OUTSET: [[f64; 3]; 3] = [
        [1.196_879_005_120_17, -0.098_020_881_140_136_8, -0.099_029_744_079_720_5],
        [-0.052_896_851_757_456_2, 1.151_903_129_904_17, -0.098_961_176_844_843_3],
        [-0.052_971_635_514_443_8, -0.098_043_450_117_124_1, 1.151_073_672_641_16],
    ];
    // The stops that are shown, as powers of two.
    const DARKEST: f64 = -12.473_93;
    const BRIGHTEST: f64 = 4.026_069;
    let times = |m: [[f64; 3]; 3], v: [f64; 3]| m.map(|r| r[0] * v[0] + r[1] * v[1] + r[2] * v[2]);
    let [black, white] = [agx_contrast(0.0), agx_contrast(1.0)];
    let curved = times(INSET, light).map(|c| {
        let stops = if c > 0.0 { log2(c).clamp(DARKEST, BRIGHTEST) } else { DARKEST };
        (agx_contrast((stops - DARKEST) / (BRIGHTEST - DARKEST)) - black) / (white - black)
    });
    // Its values are made for a display of gamma 2.2.
    times(OUTSET, curved).map(|c| pow(c.clamp(0.0, 1.0), 2.2))
}

/// Wrensch's polynomial for the curve of AgX.
fn agx_contrast(x: f64) -> f64 {
    let x2 = x * x;
    let x4 = x2 * x2;
    15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
        - 0.002_32
}

/// Khronos PBR Neutral: the share of light that a surface of index 1.5 mirrors is taken off, and peaks above the
/// start are pressed together and lose colour.
fn neutral(light: [f64; 3]) -> [f64; 3] {
    const MIRRORED: f64 = 0.04;
    const START: f64 = 0.8 - MIRRORED;
    const DESATURATION: f64 = 0.15;
    let [r, g, b] = light;
    let least = r.min(g).min(b);
    let offset = if least < 2.0 * MIRRORED { least - 6.25 * least * least } else { MIRRORED };
    let color = light.map(|c| c - offset);
    let peak = color[0].max(color[1]).max(color[2]);
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let pressed = 1.0 - room * room / (peak + room - START);
    let gray = 1.0 - 1.0 / (DESATURATION * (peak - pressed) + 1.0);
    color.map(|c| {
        let c = c * (pressed / peak);
        c + (pressed - c) * gray
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_black_to_at_most_white() {
        for tone in Tone::ALL {
            assert_eq!(tone.apply([0.0; 3]).map(|c| c.abs() < 1e-12), [true; 3], "{tone:?}");
            let mut last = 0.0;
            for i in 1..2000 {
                let [v, _, _] = tone.apply([f64::from(i) * 0.01; 3]);
                // The channels of AgX reach its end one after the other.
                assert!(v >= last - 1e-5 && v <= 1.0, "{tone:?} at {i}");
                last = v;
            }
            assert!(last > 0.9, "{tone:?} reaches {last}");
        }
    }

    #[test]
    fn curves_have_their_published_values() {
        // Worked out by hand from the papers' formulas at light 1.
        assert_eq!(Tone::Reinhard.apply([1.0; 3])[0], 0.5);
        assert!((Tone::Filmic.apply([1.0; 3])[0] - 0.492_919).abs() < 1e-5);
        assert!((Tone::Filmic.apply([5.6; 3])[0] - 1.0).abs() < 1e-12);
        assert!((Tone::Aces.apply([1.0; 3])[0] - 2.54 / 3.16).abs() < 1e-12);
        // Neutral takes 0.04 off, presses above 0.76: 1 - 0.24^2 / (0.96 + 0.24 - 0.76).
        assert!((Tone::Neutral.apply([0.5; 3])[0] - 0.46).abs() < 1e-12);
        let pressed = 1.0 - 0.0576 / 0.44;
        assert!((Tone::Neutral.apply([1.0; 3])[0] - pressed).abs() < 1e-12);
        // AgX: 10.0 of 16.5 stops above the darkest, 0.4964 by the polynomial, scaled to its ends 0.4983.
        assert!((Tone::Agx.apply([0.18; 3])[0] - 0.216).abs() < 0.002);
    }

    #[test]
    fn bright_colours_fade_to_white() {
        for tone in [Tone::Agx, Tone::Neutral] {
            let [r, g, b] = tone.apply([1000.0, 100.0, 10.0]);
            assert!(r > 0.95 && g > 0.9 * r && b > 0.85 * r, "{tone:?} {r} {g} {b}");
            let [r, g, b] = tone.apply([0.5, 0.1, 0.1]);
            assert!(r > 2.0 * g && (g - b).abs() < 0.02, "{tone:?} {r} {g} {b}");
        }
    }

    #[test]
    fn reinhard_keeps_the_hue() {
        let [r, g, b] = Tone::Reinhard.apply([0.8, 0.4, 0.2]);
        assert!((r / g - 2.0).abs() < 1e-12 && (g / b - 2.0).abs() < 1e-12);
    }
}
