// SPDX-License-Identifier: MIT OR Apache-2.0
//! Records as text, one a line.

use super::collect::{Collector, Problem};
use super::header::Element;
use super::{NUMBERS, Role, Use, record_name};
use crate::error::MeshError;
use crate::feed::Feed;
use crate::number::{Words, shown};

/// Reads all records of an element.
pub fn read(
    feed: &mut Feed,
    element: &Element,
    purpose: &Use,
    collector: &mut Collector,
) -> Result<(), MeshError> {
    let mut indices: Vec<i64> = Vec::new();
    let mut corners: Vec<u32> = Vec::new();
    // What each property of a vertex is for, and how many of them a line must have.
    let mut roles: Vec<Option<(Role, f32)>> = vec![None; element.properties.len()];
    if let Use::Vertices(layout) = purpose {
        for &(property, role, one) in &layout.roles {
            if let Some(slot) = roles.get_mut(property) {
                *slot = Some((role, one));
            }
        }
        collector.begin_vertices(layout);
    }
    for record in 0..element.count {
        let line = loop {
            match feed.line()? {
                Some(line) if !Words(line).more() => {}
                Some(line) => break line,
                None => {
                    let message = format!("the file ends before {}", record_name(element, record));
                    return Err(MeshError::new(feed.line_place(), message));
                }
            }
        };
        let done = match purpose {
            Use::Nothing => Ok(()),
            Use::Vertices(layout) => {
                numbers(line, element, &roles).and_then(|n| collector.vertex(layout, &n))
            }
            Use::Corners { list, is_strip } => list_of(line, element, *list, &mut indices)
                .and_then(|()| {
                    if *is_strip {
                        return collector.strip(indices.iter().copied());
                    }
                    corners.clear();
                    for &index in &indices {
                        corners.push(collector.index(index)?);
                    }
                    collector.face(&corners)
                }),
        };
        if let Err(why) = done {
            let place = feed.line_place();
            return Err(collector.error(why, place, &record_name(element, record)));
        }
    }
    if let Use::Vertices(_) = purpose {
        collector.end_vertices();
    }
    Ok(())
}

/// The numbers of a vertex.
fn numbers(
    line: &[u8],
    element: &Element,
    roles: &[Option<(Role, f32)>],
) -> Result<[f32; NUMBERS], Problem> {
    let mut words = Words(line);
    let mut n = [0.0; NUMBERS];
    for (property, role) in element.properties.iter().zip(roles) {
        if property.count.is_some() {
            skip_list(&mut words, &property.name)?;
            continue;
        }
        let value = words.f32().ok_or_else(|| missing(&property.name))?;
        if let Some((role, one)) = *role {
            let value = value.map_err(|word| {
                Problem::Text(format!("{} is {}, which is no number", property.name, shown(word)))
            })?;
            if let Some(slot) = n.get_mut(role) {
                *slot = value / one;
            }
        }
    }
    Ok(n)
}

/// The items of the list at this property.
fn list_of(
    line: &[u8],
    element: &Element,
    list: usize,
    items: &mut Vec<i64>,
) -> Result<(), Problem> {
    items.clear();
    let mut words = Words(line);
    for property in element.properties.iter().take(list) {
        match property.count {
            Some(_) => skip_list(&mut words, &property.name)?,
            None => drop(words.word().ok_or_else(|| missing(&property.name))?),
        }
    }
    let name = element.properties.get(list).map_or("", |p| &p.name);
    let count = length(&mut words, name)?;
    for i in 0..count {
        match words.i64() {
            Some(Ok(index)) => items.push(index),
            Some(Err(word)) => {
                return Err(Problem::Text(format!(
                    "{name} holds {}, which is no whole number",
                    shown(word)
                )));
            }
            None => {
                return Err(Problem::Text(format!(
                    "{name} has {i} of the {count} items it announces"
                )));
            }
        }
    }
    Ok(())
}

fn skip_list(words: &mut Words, name: &str) -> Result<(), Problem> {
    for _ in 0..length(words, name)? {
        words.word().ok_or_else(|| missing(name))?;
    }
    Ok(())
}

/// The length of a list.
fn length(words: &mut Words, name: &str) -> Result<u64, Problem> {
    match words.i64().ok_or_else(|| missing(name))? {
        Ok(count) if count >= 0 => Ok(count as u64),
        Ok(count) => Err(Problem::Text(format!("{name} has a length of {count}"))),
        Err(word) => {
            Err(Problem::Text(format!("the length of {name} is {}, no whole number", shown(word))))
        }
    }
}

fn missing(name: &str) -> Problem {
    Problem::Text(format!("the line ends before {name}"))
}
