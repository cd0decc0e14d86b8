// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pictures are the same every time and everywhere.

use super::*;

/// FNV-1a, enough to notice a changed byte.
fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn small_versions_have_the_same_bytes_every_time() {
    let hashes = PICTURES.map(|Picture { name, size: (width, height), make }| {
        let bytes = || png(make(width / 16, height / 16).unwrap(), name).unwrap();
        let first = bytes();
        assert_eq!(first, bytes(), "{name}");
        hash(&first)
    });
    assert_eq!(hashes, PINNED);
}

/// A change here means that the pictures in scenes/pictures have to be made anew.
const PINNED: [u64; 4] =
    [4341128116817871839, 7296856755931587777, 16871532393041849074, 3033013908163354817];
