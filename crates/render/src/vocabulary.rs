// SPDX-License-Identifier: MIT OR Apache-2.0
//! All kinds that a scene can use, gathered from the registries.

use dioptric_scene::Vocabulary;

/// The vocabulary of this version: every shape, transform, material, pattern, light, camera, setting.
#[must_use]
pub fn vocabulary() -> Vocabulary {
    let registries = [
        dioptric_geometry::shapes::SCHEMAS,
        crate::bulk::SCHEMAS,
        &[&dioptric_geometry::GROUP_SCHEMA],
        dioptric_geometry::TRANSFORM_SCHEMAS,
        crate::pattern::SCHEMAS,
        crate::material::SCHEMAS,
        crate::light::SCHEMAS,
        crate::camera::SCHEMAS,
        crate::setting::SCHEMAS,
    ];
    Vocabulary::new(registries.into_iter().flatten().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_scene::{Default, Type};

    #[test]
    fn kinds_and_parameters_are_unique_and_documented() {
        let all = vocabulary();
        for schema in all.iter() {
            assert_eq!(all.iter().filter(|s| s.kind == schema.kind).count(), 1, "{}", schema.kind);
            assert!(
                !schema.summary.is_empty() && !schema.summary.ends_with('.'),
                "{}",
                schema.kind
            );
            assert!(!schema.doc.is_empty(), "{}", schema.kind);
            for param in schema.all_params() {
                let place = format!("{}.{}", schema.kind, param.name);
                assert_eq!(
                    schema.all_params().filter(|p| p.name == param.name).count(),
                    1,
                    "{place}"
                );
                assert!(param.doc.ends_with('.'), "{place}: {}", param.doc);
                if let (Type::Choice(words), Default::Text(word)) = (param.ty, param.default) {
                    assert!(words.contains(&word), "{place}");
                }
            }
        }
    }
}
