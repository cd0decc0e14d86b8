// SPDX-License-Identifier: MIT OR Apache-2.0
//! Clear things by name: their measured indices of refraction and Abbe numbers.

/// Names, indices at the line d (587.56 nm) and Abbe numbers: Schott's catalogue of optical glass for BK7, F2, SF10, SF11
/// and fused silica (Malitson 1965), acrylic by its makers, water at 20 degrees by Daimon and Masumura 2007, sapphire (its
/// ordinary ray) by Malitson 1962, diamond by Peter 1923.
pub(super) const GLASSES: [(&str, f64, f64); 9] = [
    ("water", 1.333, 55.7),
    ("bk7", 1.5168, 64.17),
    ("f2", 1.62004, 36.37),
    ("sf10", 1.72825, 28.41),
    ("sf11", 1.78472, 25.76),
    ("fused_silica", 1.45846, 67.82),
    ("acrylic", 1.4917, 57.4),
    ("sapphire", 1.7682, 72.2),
    ("diamond", 2.4175, 55.3),
];

/// The names, and none.
pub(super) const NAMES: &[&str] = &[
    "plain",
    "water",
    "bk7",
    "f2",
    "sf10",
    "sf11",
    "fused_silica",
    "acrylic",
    "sapphire",
    "diamond",
];

/// Index and Abbe number of a named one.
pub(super) fn named(name: &str) -> Option<(f64, f64)> {
    GLASSES.iter().find(|(known, ..)| *known == name).map(|&(_, ior, abbe)| (ior, abbe))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_known() {
        assert_eq!(named(NAMES[0]), None);
        assert_eq!(NAMES.len(), GLASSES.len() + 1);
        assert!(NAMES[1..].iter().all(|name| named(name).is_some()));
    }
}
