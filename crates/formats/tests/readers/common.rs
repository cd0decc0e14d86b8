// SPDX-License-Identifier: MIT OR Apache-2.0
//! A small vocabulary for tests: the readers must work with any.

use dioptric_formats::{ReadError, ReadOptions, Reading, read, report};
use dioptric_scene::{Category, Default, MemoryLoader, Param, Schema, Type, Vocabulary};

const fn schema(kind: &'static str, category: Category, params: &'static [Param]) -> Schema {
    Schema { kind, category, summary: "", doc: "", params, example: "" }
}

const fn optional(name: &'static str, ty: Type) -> Param {
    Param::new(name, ty, Default::Absent, "")
}

static SPHERE: Schema = schema(
    "sphere",
    Category::Shape,
    &[
        Param::required("center", Type::Vec3, ""),
        Param::new("radius", Type::Positive, Default::Number(1.0), ""),
    ],
);
static POLYGON: Schema =
    schema("polygon", Category::Shape, &[Param::required("points", Type::List(&Type::Vec3), "")]);
static GROUP: Schema = schema(
    "group",
    Category::Shape,
    &[Param::required("shapes", Type::List(&Type::Node(Category::Shape)), "")],
);
static MATTE: Schema =
    schema("matte", Category::Material, &[optional("color", Type::ColorPattern)]);
static CHECKER: Schema = schema(
    "checker",
    Category::Pattern,
    &[
        Param::required("a", Type::ColorPattern, ""),
        Param::required("b", Type::ColorPattern, ""),
        Param::new("size", Type::Positive, Default::Number(1.0), ""),
    ],
);
static TRANSLATE: Schema =
    schema("translate", Category::Transform, &[Param::required("by", Type::Vec3, "")]);
static LIGHT: Schema = schema(
    "light",
    Category::Light,
    &[
        Param::required("position", Type::Vec3, ""),
        Param::new(
            "intensity",
            Type::Number { min: 0.0, max: f64::INFINITY },
            Default::Number(1.0),
            "",
        ),
        Param::new("falloff", Type::Choice(&["none", "square"]), Default::Text("none"), ""),
    ],
);
static CAMERA: Schema = schema(
    "camera",
    Category::Camera,
    &[
        optional("eye", Type::Vec3),
        optional("look_at", Type::Vec3),
        optional("up", Type::Vec3),
        optional("fov", Type::Number { min: 1e-3, max: 179.0 }),
    ],
);
static BACKGROUND: Schema =
    schema("background", Category::Setting, &[optional("color", Type::Color)]);

static RENDER: Schema = schema(
    "render",
    Category::Setting,
    &[
        optional("size", Type::Vec2),
        optional("bounces", Type::Integer { min: 0, max: 64 }),
        optional("shadows", Type::Text),
    ],
);
static SCENE: Schema = schema("scene", Category::Setting, &[optional("colors", Type::Text)]);
static DEVELOP: Schema = schema("develop", Category::Setting, &[optional("encoding", Type::Text)]);
static PHONG: Schema = schema(
    "phong",
    Category::Material,
    &[
        optional("color", Type::Color),
        optional("diffuse", Type::UNIT),
        optional("ambient", Type::UNIT),
        optional("specular", Type::UNIT),
        optional("exponent", Type::Positive),
        optional("mirror", Type::UNIT),
    ],
);

/// The kinds that the tests use.
#[must_use]
pub fn vocabulary() -> Vocabulary {
    Vocabulary::new([
        &SPHERE,
        &POLYGON,
        &GROUP,
        &MATTE,
        &CHECKER,
        &TRANSLATE,
        &LIGHT,
        &CAMERA,
        &BACKGROUND,
        &RENDER,
        &SCENE,
        &DEVELOP,
        &PHONG,
    ])
}

/// What every scene needs, on one line, so that only what a test is about is reported.
pub const STAGE: &str = "camera(); light((1, 2, 3))\n";

/// Reads `scene.star`.
pub fn read_star(text: &str) -> Result<Reading, ReadError> {
    read_with(text, &[], &ReadOptions::default())
}

/// Reads `scene.star` with other files beside it.
pub fn read_with(
    text: &str,
    files: &[(&str, &str)],
    options: &ReadOptions,
) -> Result<Reading, ReadError> {
    let mut loader = MemoryLoader::new().with("scene.star", text);
    for (name, text) in files {
        loader = loader.with(*name, *text);
    }
    read("scene.star", &loader, &vocabulary(), options)
}

/// The messages of a scene that cannot be read.
#[track_caller]
pub fn errors_of(result: Result<Reading, ReadError>) -> String {
    match result {
        Ok(reading) => panic!("the scene was read: {:?}", reading.description.roots),
        Err(error) => report::render(&error.diagnostics, &error.sources, false),
    }
}
