// SPDX-License-Identifier: MIT OR Apache-2.0
//! What `render(...)` accepts and how it explains what it does not.

use super::*;
use dioptric_scene::args::make_node;

fn text(t: &str) -> Value {
    Value::Text(t.into())
}

fn with(replaced: &[(&str, Value)]) -> Result<RenderSettings, Diagnostic> {
    RenderSettings::from_scene(&Description::default(), replaced, MAX_PIXELS)
}

fn wrong(replaced: &[(&str, Value)]) -> String {
    let error = with(replaced).unwrap_err();
    match error.help {
        Some(help) => format!("{}; {help}", error.message),
        None => error.message,
    }
}

#[test]
fn the_schema_and_the_default_agree() {
    assert_eq!(with(&[]), Ok(RenderSettings::default()));
}

#[test]
fn words_and_choices_agree() {
    for name in Integrator::NAMES {
        assert_eq!(Integrator::from_name(name).map(Integrator::name), Some(*name));
    }
    for name in Shadows::NAMES {
        assert_eq!(Shadows::from_name(name).map(Shadows::name), Some(*name));
    }
    assert_eq!(Integrator::from_name("rays"), Some(Integrator::Rays));
    assert_eq!(Shadows::from_name("none"), Some(Shadows::None));
}

#[test]
fn what_is_not_written_follows_from_what_is() {
    let samples = |mode: &str| {
        let s = with(&[("antialias", text(mode))]).unwrap();
        (s.samples, s.max_samples)
    };
    assert_eq!(
        ["none", "grid", "report", "jitter", "sobol", "adaptive"].map(samples),
        [(1, 1), (4, 4), (4, 4), (16, 16), (16, 16), (4, 64)]
    );
    for (filter, radius) in [("gaussian", 1.5), ("mitchell", 2.0), ("box", 0.5)] {
        assert_eq!(with(&[("filter", text(filter))]).unwrap().filter_radius, radius);
    }
    let none = with(&[("antialias", text("none")), ("samples", Value::Number(9.0))]).unwrap();
    assert_eq!(none.samples, 1);
}

#[test]
fn wrong_settings_are_explained() {
    assert_eq!(
        wrong(&[("size", Value::Vec2([0.0, 600.0]))]),
        "size of render: expected two whole numbers of at least 1, got (0, 600); \
         write size = (width, height) in pixels, such as size = (800, 600)"
    );
    assert_eq!(
        wrong(&[("size", Value::Vec2([1e9, 1e9]))]),
        "size of render: 1000000000 x 1000000000 is more than the limit of 268435456 pixels; \
         make the picture smaller, or raise the limit with --max-pixels"
    );
    for size in [[1.5, 2.0], [-1.0, 5.0], [1e300, 1e300], [f64::NAN, 1.0], [1e9, 1.0]] {
        assert!(with(&[("size", Value::Vec2(size))]).is_err(), "{size:?}");
    }
    assert_eq!(
        wrong(&[("antialias", text("report")), ("samples", Value::Number(16.0))]),
        "samples of render: \"report\" takes 4 samples, got 16; \
         leave samples out, or write antialias = \"grid\""
    );
    assert_eq!(
        wrong(&[
            ("antialias", text("adaptive")),
            ("samples", Value::Number(16.0)),
            ("max_samples", Value::Number(8.0)),
        ]),
        "max_samples of render: expected at least samples, which is 16, got 8; \
         write max_samples = 64 or make samples smaller"
    );
    assert_eq!(
        wrong(&[("samples", Value::Number(0.0))]),
        "samples of render: expected a whole number from 1 to 65536, got 0"
    );
    assert_eq!(
        wrong(&[("antialias", text("sobel"))]),
        "antialias of render: expected one of \"none\", \"grid\", \"report\", \"jitter\", \"sobol\", \
         \"adaptive\", got \"sobel\"; did you mean \"sobol\"?"
    );
    assert_eq!(wrong(&[("bounce", Value::Number(1.0))]), "render has no parameter bounce");
}

#[test]
fn callers_win_over_the_scene_and_are_not_blamed_on_its_text() {
    let mut scene = Description::default();
    let source = "render(samples = 9, seed = 3)";
    let file = scene.sources.add("a.star", source);
    let args = [("samples", Value::Number(9.0)), ("seed", Value::Number(3.0))];
    let mut node = make_node(&SCHEMA, &args).unwrap();
    node.span = dioptric_scene::Span { file, start: 0, end: source.len() as u32 };
    let id = scene.push(node);
    scene.roots.push(id);
    let with =
        |replaced: &[(&str, Value)], limit| RenderSettings::from_scene(&scene, replaced, limit);
    let settings = with(&[("samples", Value::Number(25.0))], MAX_PIXELS).unwrap();
    assert_eq!((settings.samples, settings.seed), (25, 3));
    let callers = with(&[("samples", Value::Number(-1.0))], MAX_PIXELS).unwrap_err();
    assert!(callers.labels.is_empty());
    let scenes = with(&[("antialias", text("report"))], MAX_PIXELS).unwrap_err();
    let span = scenes.labels[0].span;
    assert_eq!(&source[span.start as usize..span.end as usize], "9");
    assert_eq!(with(&[], 1000).unwrap_err().code, "too-large");
}

#[test]
fn settings_survive_being_written_and_read() {
    let names: Vec<_> = SCHEMA.params.iter().map(|p| p.name).collect();
    for mode in Antialias::NAMES {
        let settings = RenderSettings {
            size: [31, 17],
            threshold: 0.25,
            filter: Filter::Mitchell,
            filter_radius: 1.75,
            integrator: Integrator::Cost,
            bounces: 3,
            min_contribution: 0.0,
            light_sampling: LightSampling::Surfaces,
            clamp: 2.5,
            caustics: 5000,
            shadows: Shadows::Tinted,
            seed: 1 << 52,
            ..with(&[("antialias", text(mode))]).unwrap()
        };
        let values = settings.to_values();
        assert_eq!(values.iter().map(|(name, _)| *name).collect::<Vec<_>>(), names);
        assert_eq!(with(&values), Ok(settings));
    }
}
