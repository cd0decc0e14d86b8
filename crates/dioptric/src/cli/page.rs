// SPDX-License-Identifier: MIT OR Apache-2.0
//! One kind's manual page in pieces: what `list` prints and the reference manual is generated from.

use dioptric::scene::{Default, Param, Schema};

/// The default as it would be written in a scene; `None` where the parameter must be written, empty
/// where it stays absent.
pub fn default_text(param: &Param) -> Option<String> {
    let numbers = |v: &[f64]| {
        let items: Vec<String> = v.iter().map(f64::to_string).collect();
        format!("({})", items.join(", "))
    };
    Some(match param.default {
        Default::Required => return None,
        Default::Absent => String::new(),
        Default::Bool(true) => "True".into(),
        Default::Bool(false) => "False".into(),
        Default::Number(x) => x.to_string(),
        Default::Vec2(v) => numbers(&v),
        Default::Vec3(v) => numbers(&v),
        Default::Text(text) => format!("\"{text}\""),
    })
}

/// The call with all its own parameters: `sphere(center = (0, 0, 0), radius = 1)`.
pub fn signature(schema: &Schema) -> String {
    let params: Vec<String> = schema
        .params
        .iter()
        .map(|p| match default_text(p) {
            Some(text) if !text.is_empty() => format!("{} = {text}", p.name),
            _ => p.name.to_string(),
        })
        .collect();
    format!("{}({})", schema.kind, params.join(", "))
}

/// What the parameter takes and what it is when not written, in one phrase.
pub fn takes(param: &Param) -> String {
    let what = param.ty.describe();
    match default_text(param) {
        None => format!("{what}, required"),
        Some(text) if text.is_empty() => format!("{what}, optional"),
        Some(text) => format!("{what}, default {text}"),
    }
}

/// The page as text for a terminal.
pub fn text(schema: &Schema) -> String {
    let mut page = format!("{} ({}): {}\n\n", schema.kind, schema.category.name(), schema.summary);
    page.push_str(&format!("  {}\n\n", signature(schema)));
    for line in schema.doc.lines() {
        page.push_str(&format!("{line}\n"));
    }
    let mut params: Vec<&Param> = schema.all_params().collect();
    // The order of the schema is that of positional arguments; the common ones come last.
    page.push_str("\nParameters:\n");
    let width = params.iter().map(|p| p.name.len()).max().unwrap_or(0);
    for param in params.drain(..) {
        page.push_str(&format!("  {:width$}  {}\n", param.name, takes(param)));
        page.push_str(&format!("  {:width$}  {}\n", "", param.doc));
    }
    if !schema.example.is_empty() {
        page.push_str("\nExample:\n");
        for line in schema.example.lines() {
            page.push_str(&format!("  {line}\n"));
        }
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_shows_the_call_and_every_parameter() {
        let vocabulary = dioptric::render::vocabulary();
        let page = text(vocabulary.get("sphere").expect("spheres exist"));
        assert!(page.contains("  sphere(center = (0, 0, 0), radius = 1)\n"), "{page}");
        assert!(page.contains("radius     a number above 0, default 1\n"), "{page}");
        for param in vocabulary.get("sphere").unwrap().all_params() {
            assert!(page.contains(&format!("\n  {} ", param.name)), "{page}");
        }
    }
}
