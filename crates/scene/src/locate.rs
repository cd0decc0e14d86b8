// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where an argument is in the text of the call that it belongs to.

use crate::schema::Schema;

/// Bytes `[start, end)` of a text.
type Run = (usize, usize);

/// One argument in the text of a call.
pub(crate) struct Part {
    /// Its name, where it is written.
    pub key: Option<Run>,
    /// Its value.
    pub value: Run,
}

/// Finds the arguments in the text of a call, `sphere(center = (0, 0, 0), radius = 1)`, or of the
/// JSON `{"kind": "sphere", "radius": 1}`. A lexical scan that knows strings, comments and brackets,
/// nothing more; empty where the text is no call.
pub(crate) fn find_parts(text: &str) -> Vec<Part> {
    let Some(open) = text.find(['(', '{']) else { return Vec::new() };
    let mut pieces: Vec<Run> = Vec::new();
    let (mut depth, mut start) = (0usize, open + 1);
    let bytes = text.as_bytes();
    let mut i = open;
    while i < bytes.len() {
        match bytes[i] {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    pieces.push((start, i));
                    break;
                }
            }
            b',' if depth == 1 => {
                pieces.push((start, i));
                start = i + 1;
            }
            quote @ (b'"' | b'\'') => {
                i += 1;
                while i < bytes.len() && bytes[i] != quote {
                    i += if bytes[i] == b'\\' { 2 } else { 1 };
                }
            }
            b'#' if bytes[open] == b'(' => {
                while i < bytes.len() && bytes[i] != b'\n' {
                    i += 1;
                }
            }
            _ => {}
        }
        i += 1;
    }
    if depth != 0 {
        return Vec::new();
    }
    let mut parts = Vec::new();
    for (start, end) in pieces.into_iter().map(|piece| trim(bytes, piece)) {
        let Some(piece) = text.get(start..end).filter(|piece| !piece.is_empty()) else { continue };
        parts.push(match split_key(piece) {
            Some((key, value)) => Part {
                key: Some((start + key.0, start + key.1)),
                value: trim(bytes, (start + value, end)),
            },
            None => Part { key: None, value: (start, end) },
        });
    }
    parts
}

/// Leaves out white space and comments at both ends.
fn trim(bytes: &[u8], (mut start, mut end): Run) -> Run {
    while start < end && (bytes[start].is_ascii_whitespace() || bytes[start] == b'#') {
        if bytes[start] == b'#' {
            while start < end && bytes[start] != b'\n' {
                start += 1;
            }
        } else {
            start += 1;
        }
    }
    while start < end && bytes[end - 1].is_ascii_whitespace() {
        end -= 1;
    }
    (start, end)
}

/// The value of one argument in the text of a call; positional arguments count in the schema's order.
pub(crate) fn find_argument(text: &str, name: &str, schema: &Schema) -> Option<Run> {
    let (position, _) = schema.param(name)?;
    let parts = find_parts(text);
    let named = parts.iter().find(|p| p.key.is_some_and(|(s, e)| &text[s..e] == name));
    let value = match named {
        Some(part) => part.value,
        None => parts.iter().filter(|p| p.key.is_none()).nth(position)?.value,
    };
    Some(value)
}

/// `radius = 1` or `"radius": 1`: where the key is and where the value begins.
fn split_key(piece: &str) -> Option<(Run, usize)> {
    let quoted = piece.starts_with('"');
    let start = usize::from(quoted);
    let rest = &piece[start..];
    let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'))?;
    let after = &rest[length..];
    let after = if quoted { after.strip_prefix('"')? } else { after };
    let value = after.trim_start().strip_prefix(if quoted { ':' } else { '=' })?;
    (length > 0 && !value.starts_with('='))
        .then_some(((start, start + length), piece.len() - value.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{Category, Default, Param, Type};

    static BALL: Schema = Schema {
        kind: "ball",
        category: Category::Shape,
        summary: "",
        doc: "",
        params: &[
            Param::required("center", Type::Vec3, ""),
            Param::new("radius", Type::Positive, Default::Number(1.0), ""),
        ],
        example: "",
    };

    fn found<'a>(text: &'a str, name: &str) -> Option<&'a str> {
        find_argument(text, name, &BALL).map(|(s, e)| &text[s..e])
    }

    #[test]
    fn arguments_are_found_in_the_text_of_a_call() {
        assert_eq!(found("ball((1, 2, 3), radius = 0.5)", "center"), Some("(1, 2, 3)"));
        assert_eq!(found("ball((1, 2, 3), radius = 0.5)", "radius"), Some("0.5"));
        assert_eq!(found("ball((1, 2, 3), 7 )", "radius"), Some("7"));
        assert_eq!(found("ball(name = \"a, radius = 3\", radius=-1)", "radius"), Some("-1"));
        assert_eq!(found("ball( # radius = 1,\n radius = 2)", "radius"), Some("2"));
        assert_eq!(found(r#"{"kind": "ball", "radius": [1]}"#, "radius"), Some("[1]"));
        assert_eq!(found("ball(", "radius"), None);
        assert_eq!(found("ball(center = f(radius = 1))", "radius"), None);
        assert_eq!(found("ball(1 == 1, x = 2)", "center"), Some("1 == 1"));
        let text = "ball(1, raduis = 2)";
        let keys: Vec<_> =
            find_parts(text).iter().map(|p| p.key.map(|(s, e)| &text[s..e])).collect();
        assert_eq!(keys, [None, Some("raduis")]);
    }
}
