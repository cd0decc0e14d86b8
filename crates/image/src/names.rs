// SPDX-License-Identifier: MIT OR Apache-2.0
//! Finding the name that somebody meant: the smallest edit distance wins.

use crate::error::ImageError;

/// The entry of `names` closest to `name`, if at most a third of its letters (but two at least) are wrong.
#[must_use]
pub fn nearest<'a>(name: &str, names: &[&'a str]) -> Option<&'a str> {
    // Longer words cannot be near any of ours: their distance is not worth the time.
    if name.len() > 40 {
        return None;
    }
    let lower = name.to_lowercase();
    names
        .iter()
        .map(|candidate| (edit_distance(&lower, &candidate.to_lowercase()), *candidate))
        .filter(|(distance, candidate)| *distance <= (candidate.len() / 3).max(2))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The error for a `name` that is none of `names`; `what` is the thing that it should have named.
pub(crate) fn unknown(what: &str, name: &str, names: &[&str]) -> ImageError {
    let list = names.join(", ");
    let shown: String = name.chars().take(40).collect();
    let help = match nearest(name, names) {
        Some(near) => format!("did you mean \"{near}\"? valid: {list}"),
        None => format!("valid: {list}"),
    };
    ImageError::invalid(format!("unknown {what} \"{shown}\""), help)
}

/// Levenshtein distance in characters (Wagner and Fischer, "The String-to-String Correction
/// Problem", JACM 21(1), 1974), one row at a time.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        if let Some(first) = row.first_mut() {
            *first = left;
        }
        for (cell, cb) in row.iter_mut().skip(1).zip(&b) {
            let change = diagonal + usize::from(ca != *cb);
            diagonal = *cell;
            left = change.min(*cell + 1).min(left + 1);
            *cell = left;
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_known_words() {
        for (a, b, d) in
            [("kitten", "sitting", 3), ("", "abc", 3), ("flaw", "lawn", 2), ("a", "a", 0)]
        {
            assert_eq!(edit_distance(a, b), d, "{a} {b}");
            assert_eq!(edit_distance(b, a), d, "{b} {a}");
        }
    }

    #[test]
    fn nearest_takes_slips_and_refuses_other_words() {
        let names = ["none", "reinhard", "filmic", "aces"];
        assert_eq!(nearest("Rheinhard", &names), Some("reinhard"));
        assert_eq!(nearest("filmc", &names), Some("filmic"));
        assert_eq!(nearest("photographic", &names), None);
        assert_eq!(nearest(&"x".repeat(1_000_000), &names), None);
    }
}
