// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames of an animation, and the names of their pictures.

/// The frames from a first to a last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// The first.
    pub first: i32,
    /// The last.
    pub last: i32,
}

impl Frames {
    /// Reads `A-B`, or `N` for one frame.
    ///
    /// # Errors
    /// It is neither, or runs backwards.
    pub fn parse(text: &str) -> Result<Self, String> {
        let number = |t: &str| t.trim().parse::<i32>().ok().filter(|n| *n >= 0);
        let frames = match text.split_once('-') {
            Some((first, last)) => number(first).zip(number(last)),
            None => number(text).map(|n| (n, n)),
        };
        frames
            .filter(|(first, last)| first <= last)
            .map(|(first, last)| Self { first, last })
            .ok_or_else(|| "write FIRST-LAST, such as 1-25".into())
    }

    /// All of them in order.
    pub fn iter(self) -> impl Iterator<Item = i32> {
        self.first..=self.last
    }
}

/// The name of one frame's picture: the last run of # becomes the frame's number, with zeros in
/// front; a name without any gets one before its extension.
pub fn frame_name(pattern: &str, frame: i32) -> String {
    if let Some(end) = pattern.rfind('#') {
        let start = pattern[..=end].trim_end_matches('#').len();
        let width = end + 1 - start;
        return format!("{}{frame:0width$}{}", &pattern[..start], &pattern[end + 1..]);
    }
    let file = pattern.rfind('/').map_or(0, |i| i + 1);
    match pattern[file..].rfind('.').filter(|i| *i > 0) {
        Some(dot) => format!("{}_{frame:04}{}", &pattern[..file + dot], &pattern[file + dot..]),
        None => format!("{pattern}_{frame:04}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_where_the_name_has_room_for_them() {
        assert_eq!(frame_name("out_####.png", 7), "out_0007.png");
        assert_eq!(frame_name("a#/b_##.png", 123), "a#/b_123.png");
        assert_eq!(frame_name("dir.d/out.png", 3), "dir.d/out_0003.png");
        assert_eq!(frame_name("dir.d/out", 3), "dir.d/out_0003");
    }

    #[test]
    fn ranges_run_forwards() {
        assert_eq!(Frames::parse("2-4").unwrap().iter().collect::<Vec<_>>(), [2, 3, 4]);
        assert_eq!(Frames::parse("5"), Ok(Frames { first: 5, last: 5 }));
        for wrong in ["4-2", "", "a-b", "-3", "1-2-3"] {
            assert!(Frames::parse(wrong).is_err(), "{wrong}");
        }
    }
}
