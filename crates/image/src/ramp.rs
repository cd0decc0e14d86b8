// SPDX-License-Identifier: MIT OR Apache-2.0
//! False colour: numbers shown as colours from dark blue through green to dark red.

/// The colour of a number in 0..1 as stored sRGB values; numbers outside take the ends, NaN is white.
///
/// The polynomial fit by Du to "Turbo, An Improved Rainbow Colormap for Visualization" (Mikhailov, Google AI Blog,
/// 2019): perceived lightness rises to the middle and falls again, and neighbours stay apart for most colour-blind eyes.
#[must_use]
pub fn false_colour(value: f64) -> [f32; 3] {
    if value.is_nan() {
        return [1.0; 3];
    }
    let x = value.clamp(0.0, 1.0);
    let polynomial =
        |c: [f64; 6]| c.iter().rev().fold(0.0, |sum, c| sum * x + c).clamp(0.0, 1.0) as f32;
    [
        polynomial([
            0.135_721_38,
            4.615_392_60,
            -42.660_322_58,
            132.131_082_34,
            -152.942_393_96,
            59.286_379_43,
        ]),
        polynomial([
            0.091_402_61,
            2.194_188_39,
            4.842_966_58,
            -14.185_033_33,
            4.277_298_57,
            2.829_566_04,
        ]),
        polynomial([
            0.106_673_30,
            12.641_946_08,
            -60.582_048_36,
            110.362_767_71,
            -89.903_109_12,
            27.348_249_73,
        ]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_goes_from_blue_through_green_to_red_without_jumps() {
        let [low, middle, high] = [0.1, 0.5, 0.95].map(false_colour);
        assert!(low[2] > low[0] && low[2] > low[1], "{low:?}");
        assert!(middle[1] > middle[0] && middle[1] > middle[2], "{middle:?}");
        assert!(high[0] > high[1] && high[0] > high[2], "{high:?}");
        for i in 0..1000 {
            let [a, b] = [i, i + 1].map(|i| false_colour(f64::from(i) / 1000.0));
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02), "{i}");
        }
        assert_eq!(false_colour(-1.0), false_colour(0.0));
        assert_eq!(false_colour(f64::NAN), [1.0; 3]);
    }
}
