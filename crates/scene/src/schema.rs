// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a kind of node is called, takes and means. Every addition (shape, pattern, ...) exports one
//! [`Schema`]; readers, validation, `dioptric list` and the manual all work from it.

/// What a node is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Category {
    /// Something a ray can hit, a group included.
    Shape,
    /// A way to place shapes: `translate`, `rotate`, ...
    Transform,
    /// How a surface answers light.
    Material,
    /// A colour or number that varies over a surface.
    Pattern,
    /// Where light comes from.
    Light,
    /// Where the picture is taken from.
    Camera,
    /// A setting of the whole scene, given at most once: `background`, `fog`, `render`, ...
    Setting,
}

impl Category {
    /// All categories, in the manual's order.
    pub const ALL: [Self; 7] = [
        Self::Camera,
        Self::Light,
        Self::Shape,
        Self::Transform,
        Self::Material,
        Self::Pattern,
        Self::Setting,
    ];

    /// The name in messages and on the command line: `shape`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::Transform => "transform",
            Self::Material => "material",
            Self::Pattern => "pattern",
            Self::Light => "light",
            Self::Camera => "camera",
            Self::Setting => "setting",
        }
    }

    /// Whether a node of this category enters the scene when nothing consumes it.
    #[must_use]
    pub const fn enters_scene(self) -> bool {
        matches!(self, Self::Shape | Self::Light | Self::Camera | Self::Setting)
    }
}

/// The type of a parameter. Numbers must be finite everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Type {
    /// `True` or `False`.
    Bool,
    /// A whole number in `[min, max]`.
    Integer {
        /// Smallest valid value.
        min: i64,
        /// Largest valid value.
        max: i64,
    },
    /// A number in `[min, max]`.
    Number {
        /// Smallest valid value.
        min: f64,
        /// Largest valid value.
        max: f64,
    },
    /// A number above zero.
    Positive,
    /// Text.
    Text,
    /// The path of a file, relative to the scene's folder.
    File,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Two numbers.
    Vec2,
    /// Three numbers: a point or a free vector.
    Vec3,
    /// Three numbers that are not all zero.
    Direction,
    /// Three numbers, or one for all three.
    Scale,
    /// Sixteen (row by row), twelve or nine numbers, or rows of them.
    Matrix,
    /// A colour: three numbers, one number (grey), a name such as `"navy"`, or `"#rrggbb"`.
    Color,
    /// A colour or a pattern.
    ColorPattern,
    /// A number in `[min, max]` or a pattern that gives one.
    NumberPattern {
        /// Smallest valid value of a plain number.
        min: f64,
        /// Largest valid value of a plain number.
        max: f64,
    },
    /// A node of this category.
    Node(Category),
    /// A list of this type; a single value is a list of one.
    List(&'static Type),
    /// Two values in brackets, `(0.5, "red")`, such as a stop of a ramp.
    Pair(&'static Type, &'static Type),
}

impl Type {
    /// Any finite number.
    pub const NUMBER: Self = Self::Number { min: f64::NEG_INFINITY, max: f64::INFINITY };
    /// A number of at least 0.
    pub const NON_NEGATIVE: Self = Self::Number { min: 0.0, max: f64::INFINITY };
    /// A number from 0 to 1.
    pub const UNIT: Self = Self::Number { min: 0.0, max: 1.0 };
    /// A number from 0 to 1, or a pattern.
    pub const UNIT_PATTERN: Self = Self::NumberPattern { min: 0.0, max: 1.0 };

    /// What was expected, for messages and the manual: `a number from 0 to 1`.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::Bool => "True or False".into(),
            Self::Integer { min, max } => match (*min, *max) {
                (i64::MIN, i64::MAX) => "a whole number".into(),
                (low, i64::MAX) => format!("a whole number of at least {low}"),
                (low, high) => format!("a whole number from {low} to {high}"),
            },
            Self::Number { min, max } => describe_range(*min, *max),
            Self::Positive => "a number above 0".into(),
            Self::Text => "text".into(),
            Self::File => "the path of a file".into(),
            Self::Choice(words) => {
                let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
                format!("one of {}", quoted.join(", "))
            }
            Self::Vec2 => "two numbers (x, y)".into(),
            Self::Vec3 => "three numbers (x, y, z)".into(),
            Self::Direction => "three numbers (x, y, z), not all zero".into(),
            Self::Scale => "a number, or three numbers (x, y, z)".into(),
            Self::Matrix => "a matrix of 9, 12 or 16 numbers, row by row".into(),
            Self::Color => "a colour".into(),
            Self::ColorPattern => "a colour or a pattern".into(),
            Self::NumberPattern { min, max } => {
                format!("{}, or a pattern", describe_range(*min, *max))
            }
            Self::Node(category) => format!("a {}", category.name()),
            Self::List(item) => format!("a list, each item {}", item.describe()),
            Self::Pair(first, second) => {
                format!("a pair ({}, {})", first.describe(), second.describe())
            }
        }
    }
}

fn describe_range(min: f64, max: f64) -> String {
    match (min == f64::NEG_INFINITY, max == f64::INFINITY) {
        (true, true) => "a number".into(),
        (false, true) => format!("a number of at least {min}"),
        (true, false) => format!("a number of at most {max}"),
        (false, false) => format!("a number from {min} to {max}"),
    }
}

/// What a parameter is when it is not written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// It must be written.
    Required,
    /// It stays absent; the documentation says what that means.
    Absent,
    /// A truth value.
    Bool(bool),
    /// A number.
    Number(f64),
    /// Two numbers.
    Vec2([f64; 2]),
    /// Three numbers: a vector or a colour.
    Vec3([f64; 3]),
    /// A word, name of a colour, or text.
    Text(&'static str),
}

/// One parameter of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Param {
    /// The word in every format and in Rust.
    pub name: &'static str,
    /// What it takes.
    pub ty: Type,
    /// What it is when not written.
    pub default: Default,
    /// One or two sentences, with the unit where there is one.
    pub doc: &'static str,
}

impl Param {
    /// A parameter that must be written.
    #[must_use]
    pub const fn required(name: &'static str, ty: Type, doc: &'static str) -> Self {
        Self { name, ty, default: Default::Required, doc }
    }

    /// A parameter with a default.
    #[must_use]
    pub const fn new(name: &'static str, ty: Type, default: Default, doc: &'static str) -> Self {
        Self { name, ty, default, doc }
    }
}

/// A kind of node: its manual page, and the table from which its arguments are checked.
#[derive(Debug, PartialEq)]
pub struct Schema {
    /// The word that makes it: `sphere`.
    pub kind: &'static str,
    /// What it is good for.
    pub category: Category,
    /// One sentence for lists.
    pub summary: &'static str,
    /// The manual's text (Markdown): meaning, conventions, uv, formula and its source.
    pub doc: &'static str,
    /// Its own parameters; their order is the order of positional arguments.
    pub params: &'static [Param],
    /// A few lines in the scene language, without camera and lights, which the manual renders and a
    /// test reads. Empty where a picture would say nothing.
    pub example: &'static str,
}

/// Parameters that every node has.
pub const COMMON: &[Param] = &[Param::new(
    "name",
    Type::Text,
    Default::Absent,
    "A name for messages, `why` and the object layer.",
)];

/// Parameters that every shape has besides its own.
pub const SHAPE_COMMON: &[Param] = &[
    Param::new(
        "material",
        Type::Node(Category::Material),
        Default::Absent,
        "What the surface is made of. Without one: the group's, else matte grey.",
    ),
    Param::new(
        "transform",
        Type::List(&Type::Node(Category::Transform)),
        Default::Absent,
        "One transform or a list of them, applied in the order of the list.",
    ),
];

/// Parameters that every material has besides its own.
pub const MATERIAL_COMMON: &[Param] = &[
    Param::new(
        "emission",
        Type::ColorPattern,
        Default::Number(0.0),
        "Light of its own, besides what it reflects.",
    ),
    Param::new(
        "emission_strength",
        Type::NON_NEGATIVE,
        Default::Number(1.0),
        "Multiplies `emission`.",
    ),
    Param::new(
        "opacity",
        Type::UNIT_PATTERN,
        Default::Number(1.0),
        "How much of the surface is there: 0 is a hole that rays and shadows pass; between, each ray meets it by this chance.",
    ),
    Param::new(
        "bump",
        Type::NumberPattern { min: f64::NEG_INFINITY, max: f64::INFINITY },
        Default::Absent,
        "A pattern of heights that makes the surface look uneven; only the shading changes.",
    ),
    Param::new(
        "bump_height",
        Type::NUMBER,
        Default::Number(0.1),
        "Height that the value 1 of `bump` stands for, in units of the object; negative for dents.",
    ),
    Param::new(
        "normal_map",
        Type::ColorPattern,
        Default::Absent,
        "A pattern, mostly a picture, of directions: red, green and blue from 0 to 1 are -1 to 1 along u, v and the normal.",
    ),
    Param::new(
        "normal_strength",
        Type::NUMBER,
        Default::Number(1.0),
        "How strongly `normal_map` bends: multiplies what red and green stand for.",
    ),
];

impl Schema {
    /// All parameters: its own, then those of its category, then those of every node.
    pub fn all_params(&self) -> impl Iterator<Item = &'static Param> {
        let category = match self.category {
            Category::Shape => SHAPE_COMMON,
            Category::Material => MATERIAL_COMMON,
            _ => &[],
        };
        self.params.iter().chain(category).chain(COMMON)
    }

    /// The parameter with this name and its index in [`Self::all_params`].
    #[must_use]
    pub fn param(&self, name: &str) -> Option<(usize, &'static Param)> {
        self.all_params().enumerate().find(|(_, p)| p.name == name)
    }
}
