// SPDX-License-Identifier: MIT OR Apache-2.0
//! The header of a PLY file: which elements follow, with which properties.

use crate::error::{MeshError, Place};
use crate::feed::Feed;
use crate::number::{Words, shown};

/// How the data after the header is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    Little,
    Big,
}

/// The types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// How many bytes it takes.
    pub const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether it holds whole numbers.
    pub const fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// What 1 is stored as where numbers from 0 to 1 are.
    pub const fn one(self) -> f32 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32767.0,
            Self::U16 => 65535.0,
            _ => 1.0,
        }
    }
}

/// One number or list of each record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    pub name: String,
    /// The type of the number, or of the list's items.
    pub item: Scalar,
    /// The type of the list's length.
    pub count: Option<Scalar>,
}

/// A run of records of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// The property with this name, and its index.
    pub fn property(&self, name: &str) -> Option<(usize, &Property)> {
        self.properties.iter().enumerate().find(|(_, p)| p.name == name)
    }

    /// The fewest bytes that a record of binary data can take.
    pub fn least_bytes(&self) -> usize {
        self.properties.iter().map(|p| p.count.unwrap_or(p.item).size()).sum()
    }

    /// Whether all records are of [`Self::least_bytes`].
    pub fn is_fixed(&self) -> bool {
        self.properties.iter().all(|p| p.count.is_none())
    }
}

/// Properties of one element beyond which the header is no mesh's.
const MAX_PROPERTIES: usize = 4096;

/// Reads the header, up to the line `end_header`.
pub fn read(feed: &mut Feed) -> Result<(Encoding, Vec<Element>), MeshError> {
    let starts = feed.line()?.is_some_and(|line| Words(line).word() == Some(b"ply"));
    if !starts {
        return Err(MeshError::new(Place::Line(1), "expected ply, the first line of a PLY file")
            .help("the file is of another format: see whether its name ends as it should"));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let Some(line) = feed.line()? else {
            return Err(MeshError::new(feed.line_place(), "the header has no end_header"));
        };
        let line = Line::parse(line);
        let wrong = |message: &str| Err(MeshError::new(feed.line_place(), message));
        match line {
            Ok(Line::Nothing) => {}
            Ok(Line::Format(e)) => encoding = Some(e),
            Ok(Line::Element(e)) if elements.len() < MAX_PROPERTIES => elements.push(e),
            Ok(Line::Property(p)) => match elements.last_mut() {
                Some(e) if e.properties.len() < MAX_PROPERTIES => e.properties.push(p),
                Some(_) => return wrong("the header has too many properties"),
                None => return wrong("a property comes before the first element"),
            },
            Ok(Line::Element(_)) => return wrong("the header has too many elements"),
            Ok(Line::End) => break,
            Err(message) => return Err(MeshError::new(feed.line_place(), message)),
        }
    }
    let Some(encoding) = encoding else {
        return Err(MeshError::new(feed.line_place(), "the header has no line format")
            .help("add the line format ascii 1.0, or format binary_little_endian 1.0"));
    };
    Ok((encoding, elements))
}

/// One line of a header.
enum Line {
    Nothing,
    Format(Encoding),
    Element(Element),
    Property(Property),
    End,
}

impl Line {
    fn parse(line: &[u8]) -> Result<Self, String> {
        let mut words = Words(line);
        let Some(keyword) = words.word() else { return Ok(Self::Nothing) };
        match keyword {
            b"comment" | b"obj_info" => Ok(Self::Nothing),
            b"end_header" => Ok(Self::End),
            b"format" => Ok(Self::Format(match words.word() {
                Some(b"ascii") => Encoding::Ascii,
                Some(b"binary_little_endian") => Encoding::Little,
                Some(b"binary_big_endian") => Encoding::Big,
                other => {
                    let other = shown(other.unwrap_or_default());
                    return Err(format!(
                        "expected ascii, binary_little_endian or binary_big_endian after format, got {other}"
                    ));
                }
            })),
            b"element" => {
                let name = words.word().ok_or("expected a name and a number after element")?;
                let count = words.i64().and_then(Result::ok).and_then(|n| u64::try_from(n).ok());
                let name = String::from_utf8_lossy(name).into_owned();
                let Some(count) = count else {
                    return Err(format!("expected how many there are after element {name}"));
                };
                Ok(Self::Element(Element { name, count, properties: Vec::new() }))
            }
            b"property" => Self::property(words).map(Self::Property),
            other => Err(format!(
                "expected element, property, comment or end_header, got {}",
                shown(other)
            )),
        }
    }

    fn property(mut words: Words) -> Result<Property, String> {
        let scalar = |word: Option<&[u8]>| {
            let word = word.unwrap_or_default();
            Scalar::of_name(word).ok_or_else(|| {
                format!("expected a type such as float, int or uchar, got {}", shown(word))
            })
        };
        let (item, count) = match words.word() {
            Some(b"list") => {
                let count = scalar(words.word())?;
                (scalar(words.word())?, Some(count))
            }
            word => (scalar(word)?, None),
        };
        if count.is_some_and(|c| !c.is_whole()) {
            return Err("the length of a list is no whole number's type".into());
        }
        let name = words.word().ok_or("expected a name after the type of a property")?;
        Ok(Property { name: String::from_utf8_lossy(name).into_owned(), item, count })
    }
}
