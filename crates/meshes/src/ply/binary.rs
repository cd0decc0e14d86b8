// SPDX-License-Identifier: MIT OR Apache-2.0
//! Records as binary data, of either byte order.

use super::collect::{Collector, Problem};
use super::header::{Element, Property, Scalar};
use super::{NUMBERS, Use, record_name};
use crate::error::{MeshError, Place};
use crate::feed::Feed;

/// Reads all records of an element.
pub fn read(
    feed: &mut Feed,
    element: &Element,
    is_big: bool,
    purpose: &Use,
    collector: &mut Collector,
) -> Result<(), MeshError> {
    let mut corners: Vec<u32> = Vec::new();
    match purpose {
        Use::Nothing => each(feed, element, is_big, collector, |_, _| Ok(())),
        Use::Vertices(layout) => {
            let parts: Vec<_> = layout
                .roles
                .iter()
                .filter_map(|&(p, role, one)| Some((p, role, one, element.properties.get(p)?.item)))
                .collect();
            collector.begin_vertices(layout);
            each(feed, element, is_big, collector, |record, collector| {
                let mut n = [0.0; NUMBERS];
                for &(property, role, one, item) in &parts {
                    let value = number(record.part(property), item, is_big) as f32;
                    if let Some(slot) = n.get_mut(role) {
                        *slot = value / one;
                    }
                }
                collector.vertex(layout, &n)
            })?;
            collector.end_vertices();
            Ok(())
        }
        Use::Corners { list, is_strip } => {
            let Some(&Property { item, count: Some(count), .. }) = element.properties.get(*list)
            else {
                return Ok(());
            };
            each(feed, element, is_big, collector, |record, collector| {
                let items = record.part(*list).get(count.size()..).unwrap_or_default();
                let mut items = items.chunks_exact(item.size()).map(|b| whole(b, item, is_big));
                if *is_strip {
                    return collector.strip(items);
                }
                if items.len() == 3
                    && let (Some(a), Some(b), Some(c)) = (items.next(), items.next(), items.next())
                {
                    let corners = [collector.index(a)?, collector.index(b)?, collector.index(c)?];
                    return collector.triangle(corners);
                }
                corners.clear();
                for index in items {
                    corners.push(collector.index(index)?);
                }
                collector.face(&corners)
            })
        }
    }
}

/// A record in one piece, and where its properties begin.
struct Record<'a> {
    bytes: &'a [u8],
    starts: &'a [usize],
}

impl Record<'_> {
    /// The bytes of a property.
    fn part(&self, property: usize) -> &[u8] {
        let start = self.starts.get(property).copied().unwrap_or_default();
        let end = self.starts.get(property + 1).copied().unwrap_or(self.bytes.len());
        self.bytes.get(start..end).unwrap_or_default()
    }
}

/// Calls `take` with every record.
fn each(
    feed: &mut Feed,
    element: &Element,
    is_big: bool,
    collector: &mut Collector,
    mut take: impl FnMut(&Record, &mut Collector) -> Result<(), Problem>,
) -> Result<(), MeshError> {
    let least = element.least_bytes();
    let is_fixed = element.is_fixed();
    let mut starts = Vec::with_capacity(element.properties.len());
    let mut fixed = 0;
    for property in element.properties.iter().filter(|_| is_fixed) {
        starts.push(fixed);
        fixed += property.item.size();
    }
    let mut wanted = least;
    let mut done = 0;
    while done < element.count {
        let place = feed.byte_place();
        let Some(bytes) = feed.peek(wanted)? else {
            let (left, name) = (feed.left(), record_name(element, done));
            let message = format!("the file ends in {name}, {left} bytes of {wanted} are there");
            return Err(MeshError::new(place, message));
        };
        let mut at = 0;
        while done < element.count {
            let rest = bytes.get(at..).unwrap_or_default();
            let size =
                if is_fixed { Ok(least) } else { measure(rest, element, is_big, &mut starts) };
            let (size, failure) = match size {
                Ok(size) => match rest.get(..size) {
                    Some(bytes) => {
                        (size, take(&Record { bytes, starts: &starts }, collector).err())
                    }
                    None => {
                        wanted = size;
                        break;
                    }
                },
                Err(why) => (0, Some(why)),
            };
            if let Some(why) = failure {
                let Place::Byte(first) = place else { break };
                let place = Place::Byte(first + at as u64);
                return Err(collector.error(why, place, &record_name(element, done)));
            }
            at += size;
            done += 1;
            wanted = least;
        }
        feed.consume(at);
    }
    Ok(())
}

/// The size of the record at the start of `bytes`, or where they end too soon the least that is needed to know
/// more. Notes where properties start.
fn measure(
    bytes: &[u8],
    element: &Element,
    is_big: bool,
    starts: &mut Vec<usize>,
) -> Result<usize, Problem> {
    starts.clear();
    let mut at = 0_usize;
    for property in &element.properties {
        starts.push(at);
        let Some(count) = property.count else {
            at += property.item.size();
            continue;
        };
        let items = at + count.size();
        let Some(length) = bytes.get(at..items) else { return Ok(items) };
        let length = whole(length, count, is_big);
        let size = usize::try_from(length).ok().and_then(|n| n.checked_mul(property.item.size()));
        at = size
            .and_then(|size| items.checked_add(size))
            .ok_or_else(|| Problem::Text(format!("{} has a length of {length}", property.name)))?;
    }
    Ok(at)
}

/// A whole number; one that does not fit its type's signedness cannot be.
fn whole(bytes: &[u8], ty: Scalar, is_big: bool) -> i64 {
    match ty {
        Scalar::I8 => i64::from(i8::from_ne_bytes([first(bytes)])),
        Scalar::U8 => i64::from(first(bytes)),
        Scalar::I16 => i64::from(word(bytes, is_big, i16::from_be_bytes, i16::from_le_bytes)),
        Scalar::U16 => i64::from(word(bytes, is_big, u16::from_be_bytes, u16::from_le_bytes)),
        Scalar::I32 => i64::from(word(bytes, is_big, i32::from_be_bytes, i32::from_le_bytes)),
        Scalar::U32 => i64::from(word(bytes, is_big, u32::from_be_bytes, u32::from_le_bytes)),
        Scalar::F32 | Scalar::F64 => number(bytes, ty, is_big) as i64,
    }
}

fn number(bytes: &[u8], ty: Scalar, is_big: bool) -> f64 {
    match ty {
        Scalar::F32 => f64::from(word(bytes, is_big, f32::from_be_bytes, f32::from_le_bytes)),
        Scalar::F64 => word(bytes, is_big, f64::from_be_bytes, f64::from_le_bytes),
        _ => whole(bytes, ty, is_big) as f64,
    }
}

fn first(bytes: &[u8]) -> u8 {
    bytes.first().copied().unwrap_or_default()
}

fn word<const N: usize, T>(
    bytes: &[u8],
    is_big: bool,
    big: impl Fn([u8; N]) -> T,
    little: impl Fn([u8; N]) -> T,
) -> T {
    let bytes = bytes.first_chunk().copied().unwrap_or([0; N]);
    if is_big { big(bytes) } else { little(bytes) }
}
