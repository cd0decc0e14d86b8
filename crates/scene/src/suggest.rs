// SPDX-License-Identifier: MIT OR Apache-2.0
//! "Did you mean": the nearest of the valid names.

/// Edits (insert, delete, replace, swap neighbours) from `a` to `b`: the restricted
/// Damerau-Levenshtein distance.
#[must_use]
pub fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let mut rows = vec![vec![0usize; b.len() + 1]; a.len() + 1];
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = i;
    }
    for (j, cell) in rows[0].iter_mut().enumerate() {
        *cell = j;
    }
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let replace = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

/// The valid name nearest to `written`, if one is near enough to be meant.
///
/// Case is ignored; ties go to the first. Long input is not compared: nobody meant it.
pub fn nearest<'a>(written: &str, valid: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if written.chars().count() > 64 {
        return None;
    }
    let lower = written.to_lowercase();
    let allowed = (lower.chars().count() / 3).max(1);
    valid
        .into_iter()
        .map(|name| {
            let d = distance(&lower, &name.to_lowercase());
            let prefix = lower.len() >= 3
                && (name.starts_with(&lower) || lower.starts_with(name) && name.len() >= 3);
            (if prefix { d.min(1) } else { d }, name)
        })
        .filter(|&(d, _)| d <= allowed)
        .min_by_key(|&(d, _)| d)
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_name_is_found_or_honestly_not() {
        let names = ["sphere", "plane", "cylinder", "radius"];
        assert_eq!(nearest("shpere", names), Some("sphere"));
        assert_eq!(nearest("Sphere", names), Some("sphere"));
        assert_eq!(nearest("cylnder", names), Some("cylinder"));
        assert_eq!(nearest("rad", names), Some("radius"));
        assert_eq!(nearest("banana", names), None);
        assert_eq!(nearest(&"x".repeat(100_000), names), None);
    }

    #[test]
    fn distance_counts_a_swap_once() {
        assert_eq!(distance("ab", "ba"), 1);
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
    }
}
