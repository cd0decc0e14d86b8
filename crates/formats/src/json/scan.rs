// SPDX-License-Identifier: MIT OR Apache-2.0
//! JSON (RFC 8259) with the place of every value: what `serde_json` does not keep.
//!
//! What a number or an escaped string is, `serde_json` decides; this file finds where they are.

use dioptric_scene::{Diagnostic, FileId, Span};

/// Most brackets that may be open: a description nests to
/// [`dioptric_scene::validate::MAX_NESTING`], with a list and an object for each level.
const MAX_DEPTH: usize = 256;

/// A value and its place.
#[derive(Debug, PartialEq)]
pub(crate) struct Json {
    pub span: Span,
    pub value: JsonValue,
}

/// A value.
#[derive(Debug, PartialEq)]
pub(crate) enum JsonValue {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Json>),
    /// The members in order; keys may repeat.
    Object(Vec<Member>),
}

/// One member of an object.
#[derive(Debug, PartialEq)]
pub(crate) struct Member {
    pub key: String,
    pub key_span: Span,
    pub value: Json,
}

impl JsonValue {
    /// The word for messages.
    pub(crate) const fn describe(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a truth value",
            Self::Number(_) => "a number",
            Self::Text(_) => "text",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        }
    }
}

/// A reader of one text.
pub(crate) struct Scanner<'a> {
    text: &'a str,
    file: FileId,
    at: usize,
    depth: usize,
}

type Result<T> = std::result::Result<T, Diagnostic>;

impl<'a> Scanner<'a> {
    pub(crate) const fn new(text: &'a str, file: FileId) -> Self {
        Self { text, file, at: 0, depth: 0 }
    }

    fn rest(&self) -> &'a [u8] {
        self.text.as_bytes().get(self.at..).unwrap_or_default()
    }

    pub(crate) fn span(&self, start: usize, end: usize) -> Span {
        Span { file: self.file, start: start as u32, end: end as u32 }
    }

    fn error(&self, message: impl Into<String>) -> Diagnostic {
        let end = if self.at < self.text.len() { self.at + 1 } else { self.at };
        Diagnostic::error("syntax", message).at(self.span(self.at, end), "")
    }

    fn expected(&self, what: &str) -> Diagnostic {
        let got = match self.text.get(self.at..).and_then(|rest| rest.chars().next()) {
            None => "the end of the file".into(),
            Some(c) if c.is_control() => "a control character".into(),
            Some(c) => format!("'{c}'"),
        };
        self.error(format!("expected {what}, got {got}"))
    }

    fn skip_space(&mut self) {
        self.at +=
            self.rest().iter().take_while(|b| matches!(b, b' ' | b'\t' | b'\n' | b'\r')).count();
    }

    /// Whether the next byte, after white space, is `byte`; it is taken then.
    pub(crate) fn take(&mut self, byte: u8) -> bool {
        self.skip_space();
        let found = self.rest().first() == Some(&byte);
        self.at += usize::from(found);
        found
    }

    /// Takes `byte`.
    pub(crate) fn want(&mut self, byte: u8) -> Result<()> {
        if self.take(byte) { Ok(()) } else { Err(self.expected(&format!("'{}'", byte as char))) }
    }

    /// The end of the text.
    pub(crate) fn end(&mut self) -> Result<()> {
        self.skip_space();
        if self.rest().is_empty() { Ok(()) } else { Err(self.expected("the end of the file")) }
    }

    /// Goes on to the next item of a list or object that is open: false at its end.
    pub(crate) fn next_item(&mut self, first: &mut bool, close: u8) -> Result<bool> {
        if self.take(close) {
            return Ok(false);
        }
        if !std::mem::replace(first, false) {
            if !self.take(b',') {
                return Err(self.expected(&format!("',' or '{}'", close as char)));
            }
            self.skip_space();
            if self.rest().first() == Some(&close) {
                return Err(self.error("a comma before the end of the list"));
            }
        }
        Ok(true)
    }

    /// A key and its colon.
    pub(crate) fn key(&mut self) -> Result<(String, Span)> {
        self.skip_space();
        let start = self.at;
        if self.rest().first() != Some(&b'"') {
            return Err(self.expected("a key in double quotes"));
        }
        let key = self.string()?;
        let span = self.span(start, self.at);
        self.want(b':')?;
        Ok((key, span))
    }

    /// Any value.
    pub(crate) fn value(&mut self) -> Result<Json> {
        self.skip_space();
        let start = self.at;
        let value = match self.rest().first() {
            Some(b'{') => self.nested(Self::object)?,
            Some(b'[') => self.nested(Self::list)?,
            Some(b'"') => JsonValue::Text(self.string()?),
            Some(b'-' | b'0'..=b'9') => JsonValue::Number(self.number()?),
            _ => self.word()?,
        };
        Ok(Json { span: self.span(start, self.at), value })
    }

    fn nested(&mut self, inner: fn(&mut Self) -> Result<JsonValue>) -> Result<JsonValue> {
        if self.depth == MAX_DEPTH {
            return Err(Diagnostic {
                code: "too-nested",
                ..self.error("too many brackets within one another")
            });
        }
        self.depth += 1;
        self.at += 1;
        let value = inner(self);
        self.depth -= 1;
        value
    }

    fn list(&mut self) -> Result<JsonValue> {
        let (mut items, mut first) = (Vec::new(), true);
        while self.next_item(&mut first, b']')? {
            items.push(self.value()?);
        }
        Ok(JsonValue::List(items))
    }

    fn object(&mut self) -> Result<JsonValue> {
        let (mut members, mut first) = (Vec::new(), true);
        while self.next_item(&mut first, b'}')? {
            let (key, key_span) = self.key()?;
            members.push(Member { key, key_span, value: self.value()? });
        }
        Ok(JsonValue::Object(members))
    }

    fn string(&mut self) -> Result<String> {
        let start = self.at;
        let mut escaped = false;
        let length = self.rest().iter().skip(1).position(|&b| {
            let end = b == b'"' && !escaped || b == b'\n';
            escaped = b == b'\\' && !escaped;
            end
        });
        let raw = length.and_then(|length| self.text.get(start..start + length + 2));
        match raw.filter(|raw| raw.ends_with('"')) {
            None => Err(self.error("the text is not closed with \" on its line")),
            Some(raw) => {
                let text = serde_json::from_str(raw)
                    .map_err(|_| self.error("the text has a wrong escape or control character"))?;
                self.at += raw.len();
                Ok(text)
            }
        }
    }

    fn number(&mut self) -> Result<f64> {
        let in_number = |b: &&u8| matches!(b, b'+' | b'-' | b'.' | b'0'..=b'9' | b'e' | b'E');
        let length = self.rest().iter().take_while(in_number).count();
        let raw = self.text.get(self.at..self.at + length).unwrap_or_default();
        let number =
            serde_json::from_str(raw).map_err(|_| self.error(format!("{raw} is no number")))?;
        self.at += length;
        Ok(number)
    }

    fn word(&mut self) -> Result<JsonValue> {
        let length = self.rest().iter().take_while(|b| b.is_ascii_alphanumeric()).count();
        let value = match &self.rest()[..length] {
            b"true" => JsonValue::Bool(true),
            b"false" => JsonValue::Bool(false),
            b"null" => JsonValue::Null,
            _ => return Err(self.expected("a value")),
        };
        self.at += length;
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn equal(ours: &Json, theirs: &serde_json::Value) -> bool {
        use serde_json::Value;
        match (&ours.value, theirs) {
            (JsonValue::Null, Value::Null) => true,
            (JsonValue::Bool(a), Value::Bool(b)) => a == b,
            (JsonValue::Number(a), Value::Number(b)) => Some(*a) == b.as_f64(),
            (JsonValue::Text(a), Value::String(b)) => a == b,
            (JsonValue::List(a), Value::Array(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| equal(a, b))
            }
            (JsonValue::Object(a), Value::Object(b)) => {
                a.len() == b.len()
                    && a.iter().all(|m| b.get(&m.key).is_some_and(|b| equal(&m.value, b)))
            }
            _ => false,
        }
    }

    #[test]
    fn it_accepts_what_serde_json_accepts_and_nothing_else() {
        for text in [
            "null",
            " [1.5, -2e3, 0.0] ",
            r#"{"a": "b\"\u00e9\\", "c": {}, "d": [[], [true]]}"#,
            "[]",
            "[1,]",
            "{,}",
            "[1 2]",
            "{\"a\" 1}",
            "{a: 1}",
            "\"\\x\"",
            "\"",
            "\"\n\"",
            "01",
            "1.",
            "-",
            "+1",
            ".5",
            "1e",
            "NaN",
            "nul",
            "[",
            "{\"a\":",
            "1 2",
            "",
            "\"\u{1}\"",
            "é",
            "[1,,2]",
            "\"\\ud800\"",
            "0.1",
            "1e-400",
            "123456789012345678901234567890",
        ] {
            let mut scanner = Scanner::new(text, FileId(0));
            let ours = scanner.value().and_then(|value| scanner.end().map(|()| value));
            match (ours, serde_json::from_str(text)) {
                (Ok(ours), Ok(theirs)) => assert!(equal(&ours, &theirs), "{text}"),
                (Err(_), Err(_)) => {}
                (ours, theirs) => panic!("{text}: {ours:?} but {theirs:?}"),
            }
        }
        assert!(Scanner::new("1e999", FileId(0)).value().is_err());
    }

    #[test]
    fn places_are_kept_and_depth_is_bounded() {
        let text = "{\"é\": [1, \"x\"]}";
        let JsonValue::Object(members) = Scanner::new(text, FileId(0)).value().unwrap().value
        else {
            panic!()
        };
        let at = |span: Span| &text[span.start as usize..span.end as usize];
        assert_eq!((at(members[0].key_span), at(members[0].value.span)), ("\"é\"", "[1, \"x\"]"));
        let deep = "[".repeat(100_000);
        assert_eq!(Scanner::new(&deep, FileId(0)).value().unwrap_err().code, "too-nested");
    }
}
