// SPDX-License-Identifier: MIT OR Apache-2.0
//! A quick look at a scene's text that refuses what would nest too deeply, before a parser that
//! calls itself for every level could exhaust the stack.
//!
//! It bounds the depth of the syntax tree from above by counting, for every place, the open
//! brackets, the operators since the last comma, the indentation and the `elif`s. It need not
//! understand the language: a scene written by a person stays far below the bounds.

/// Most brackets that may be open.
const BRACKETS: usize = 100;
/// Most operators in a row, over all open brackets.
const OPERATORS: usize = 2000;
/// Deepest indentation, in blocks.
const BLOCKS: usize = 100;
/// Longest chain of `elif`.
const ELIFS: usize = 500;

/// What nests too deeply, and the byte where it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooDeep {
    pub at: usize,
    pub what: &'static str,
}

/// Checks a text in the scene language.
pub(crate) fn check(text: &str) -> Result<(), TooDeep> {
    let bytes = text.as_bytes();
    let mut open: Vec<usize> = vec![0]; // operators seen in each open bracket
    let mut operators = 0; // their sum
    let mut blocks: Vec<(usize, usize)> = Vec::new(); // indentation and elifs of each open block
    let mut line_start = true;
    let mut i = 0;
    while i < bytes.len() {
        if line_start && open.len() == 1 {
            let indent = bytes[i..].iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
            i += indent;
            operators = 0;
            open[0] = 0;
            if !matches!(bytes.get(i), None | Some(b'\n' | b'\r' | b'#')) {
                enter_line(&mut blocks, indent, word_at(bytes, i), i)?;
            }
        }
        line_start = false;
        let Some(&byte) = bytes.get(i) else { break };
        match byte {
            b'\n' => line_start = true,
            b'#' => {
                i += bytes[i..].iter().take_while(|&&b| b != b'\n').count();
                continue;
            }
            b'"' | b'\'' => {
                i = string_end(bytes, i);
                continue;
            }
            b',' | b';' => {
                operators -= open.last().copied().unwrap_or(0);
                if let Some(top) = open.last_mut() {
                    *top = 0;
                }
            }
            b'(' | b'[' | b'{' => {
                count(&mut open, &mut operators, i)?;
                open.push(0);
                if open.len() > BRACKETS {
                    return Err(TooDeep { at: i, what: "brackets" });
                }
            }
            b')' | b']' | b'}' if open.len() > 1 => {
                operators -= open.pop().unwrap_or(0);
            }
            b'\\' => i += 1,
            _ if byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80 => {
                let word = word_at(bytes, i);
                if matches!(
                    word,
                    b"not" | b"and" | b"or" | b"in" | b"if" | b"else" | b"lambda" | b"for"
                ) {
                    count(&mut open, &mut operators, i)?;
                }
                i += word.len();
                continue;
            }
            b'+' | b'-' | b'*' | b'/' | b'%' | b'|' | b'&' | b'^' | b'~' | b'<' | b'>' | b'='
            | b'!' | b'.' => count(&mut open, &mut operators, i)?,
            _ => {}
        }
        i += 1;
    }
    Ok(())
}

fn count(open: &mut [usize], operators: &mut usize, at: usize) -> Result<(), TooDeep> {
    if let Some(top) = open.last_mut() {
        *top += 1;
    }
    *operators += 1;
    if *operators > OPERATORS { Err(TooDeep { at, what: "operators" }) } else { Ok(()) }
}

/// Notes the first word of a line that begins a statement.
fn enter_line(
    blocks: &mut Vec<(usize, usize)>,
    indent: usize,
    word: &[u8],
    at: usize,
) -> Result<(), TooDeep> {
    while blocks.last().is_some_and(|&(outer, _)| outer > indent) {
        blocks.pop();
    }
    match blocks.last_mut() {
        Some((level, elifs)) if *level == indent => match word {
            b"elif" => *elifs += 1,
            b"else" => {}
            _ => *elifs = 0,
        },
        _ => blocks.push((indent, 0)),
    }
    if blocks.len() > BLOCKS {
        return Err(TooDeep { at, what: "blocks" });
    }
    if blocks.iter().map(|(_, elifs)| elifs).sum::<usize>() > ELIFS {
        return Err(TooDeep { at, what: "elifs" });
    }
    Ok(())
}

fn word_at(bytes: &[u8], i: usize) -> &[u8] {
    let length = bytes[i..]
        .iter()
        .take_while(|b| b.is_ascii_alphanumeric() || **b == b'_' || **b >= 0x80)
        .count();
    &bytes[i..i + length]
}

/// The byte after a string that starts at `i`; the end of the line or text where it is not closed.
fn string_end(bytes: &[u8], i: usize) -> usize {
    let quote = bytes[i];
    let triple = bytes[i..].starts_with(&[quote; 3]);
    let mut i = i + if triple { 3 } else { 1 };
    while i < bytes.len() {
        match bytes[i] {
            b'\\' => i += 1,
            b'\n' if !triple => return i,
            b if b == quote && !triple => return i + 1,
            b if b == quote && bytes[i..].starts_with(&[quote; 3]) => return i + 3,
            _ => {}
        }
        i += 1;
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_people_write_passes() {
        let points = "(1.5, -2.5, 3), ".repeat(100_000);
        let lines =
            "sphere((0, 0, 0), 1) # (((((\nx = \"(((\" + '''[[[\n(((''' \\\n + y\n".repeat(1000);
        let chain =
            "if a:\n  b()\n".to_string() + &"elif c:\n  d()\n".repeat(300) + "else:\n  e()\n";
        for text in [&format!("mesh(points = [{points}])"), &lines, &chain, "", ")))", "\"", "\\"] {
            assert_eq!(check(text), Ok(()), "{:.40}", text);
        }
    }

    #[test]
    fn depth_without_end_is_refused() {
        let blocks: String = (0..200).map(|i| format!("{}if a:\n", " ".repeat(i))).collect();
        for (text, what) in [
            ("(".repeat(100_000), "brackets"),
            ("[".repeat(100_000), "brackets"),
            (format!("x = {}1", "-".repeat(100_000)), "operators"),
            (format!("x = {}1", "1 + ".repeat(100_000)), "operators"),
            (format!("x = {}1", "not ".repeat(100_000)), "operators"),
            (format!("x = {}1", "lambda: ".repeat(100_000)), "operators"),
            (format!("x = a{}", ".b".repeat(100_000)), "operators"),
            (format!("x = a{}", "()".repeat(100_000)), "operators"),
            (format!("x = {}", "1 if a else ".repeat(100_000)), "operators"),
            (blocks, "blocks"),
            (format!("if a:\n  b()\n{}", "elif c:\n  d()\n".repeat(1000)), "elifs"),
        ] {
            assert_eq!(check(&text).unwrap_err().what, what, "{:.40}", text);
        }
    }
}
