// SPDX-License-Identifier: MIT OR Apache-2.0
//! A file as lines or records that lie in one piece, read in large blocks.

use std::io::{ErrorKind, Read};

use crate::error::{MeshError, Place};

/// How much is read at once.
const BLOCK: usize = 1 << 18;

/// Reads blocks and gives out pieces of them; memory is one block and the longest piece.
pub struct Feed<'a> {
    reader: &'a mut dyn Read,
    block: Vec<u8>,
    /// What is in the block and not yet given out.
    start: usize,
    end: usize,
    /// Bytes of the file before the block.
    before: u64,
    line: u64,
    is_done: bool,
}

impl<'a> Feed<'a> {
    pub fn new(reader: &'a mut dyn Read) -> Self {
        Self { reader, block: Vec::new(), start: 0, end: 0, before: 0, line: 0, is_done: false }
    }

    /// The line that was given out last.
    pub fn line_place(&self) -> Place {
        Place::Line(self.line)
    }

    /// The byte that comes next.
    pub fn byte_place(&self) -> Place {
        Place::Byte(self.before + self.start as u64)
    }

    /// The next line without its end, `None` at the end of the file.
    pub fn line(&mut self) -> Result<Option<&[u8]>, MeshError> {
        let mut searched = 0;
        let length = loop {
            let rest = self.block.get(self.start + searched..self.end).unwrap_or_default();
            if let Some(at) = memchr::memchr(b'\n', rest) {
                break searched + at;
            }
            searched = self.end - self.start;
            if !self.fill()? {
                if searched == 0 {
                    return Ok(None);
                }
                break searched;
            }
        };
        self.line += 1;
        let line = self.start..self.start + length;
        self.start = (line.end + 1).min(self.end);
        let line = self.block.get(line).unwrap_or_default();
        Ok(Some(line.strip_suffix(b"\r").unwrap_or(line)))
    }

    /// At least the next `count` bytes, in one piece, without giving them out; `None` where the file ends
    /// before.
    pub fn peek(&mut self, count: usize) -> Result<Option<&[u8]>, MeshError> {
        while self.end - self.start < count {
            if !self.fill()? {
                return Ok(None);
            }
        }
        Ok(self.block.get(self.start..self.end))
    }

    /// Gives out what was peeked at.
    pub fn consume(&mut self, count: usize) {
        self.start = (self.start + count).min(self.end);
    }

    /// Bytes left before the end of the file, at its end.
    pub fn left(&self) -> usize {
        self.end - self.start
    }

    /// Reads more behind what is there; `false` at the end of the file.
    fn fill(&mut self) -> Result<bool, MeshError> {
        if self.is_done {
            return Ok(false);
        }
        if self.start > 0 {
            self.block.copy_within(self.start..self.end, 0);
            self.before += self.start as u64;
            self.end -= self.start;
            self.start = 0;
        }
        if self.block.len() - self.end < BLOCK / 2 {
            let size = (self.block.len() * 2).max(BLOCK);
            self.block.resize(size, 0);
        }
        loop {
            match self.reader.read(self.block.get_mut(self.end..).unwrap_or_default()) {
                Ok(0) => {
                    self.is_done = true;
                    return Ok(false);
                }
                Ok(count) => {
                    self.end = (self.end + count).min(self.block.len());
                    return Ok(true);
                }
                Err(why) if why.kind() == ErrorKind::Interrupted => {}
                Err(why) => {
                    let message = format!("cannot be read: {why}");
                    return Err(MeshError::new(self.byte_place(), message)
                        .help("see whether the disk or the connection is in order"));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives one to three bytes at a time.
    struct Drops<'a>(&'a [u8]);

    impl Read for Drops<'_> {
        fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
            let n = (self.0.len() % 3 + 1).min(self.0.len()).min(out.len());
            out[..n].copy_from_slice(&self.0[..n]);
            self.0 = &self.0[n..];
            Ok(n)
        }
    }

    #[test]
    fn lines_and_records_across_blocks() {
        let text = b"one\r\ntwo\n\nfour\n\x00\x01\x02\x03\x04tail";
        let mut drops = Drops(text);
        let mut feed = Feed::new(&mut drops);
        for line in ["one", "two", "", "four"] {
            assert_eq!(feed.line().unwrap(), Some(line.as_bytes()));
        }
        assert_eq!(feed.line_place(), Place::Line(4));
        assert_eq!(feed.byte_place(), Place::Byte(15));
        assert_eq!(&feed.peek(5).unwrap().unwrap()[..5], [0, 1, 2, 3, 4]);
        feed.consume(5);
        assert_eq!(feed.peek(5).unwrap(), None);
        assert_eq!(feed.left(), 4);
        assert_eq!(feed.line().unwrap(), Some(&b"tail"[..]));
        assert_eq!(feed.line().unwrap(), None);
    }

    #[test]
    fn a_failing_disk_is_told() {
        struct Broken;
        impl Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
                Err(ErrorKind::PermissionDenied.into())
            }
        }
        let error = Feed::new(&mut Broken).line().unwrap_err();
        assert!(error.message.starts_with("cannot be read: "), "{}", error.message);
    }
}
