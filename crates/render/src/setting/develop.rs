// SPDX-License-Identifier: MIT OR Apache-2.0
//! `develop(...)`: from linear light to the picture that is shown.

use dioptric_image::{Develop, Encoding, Tone};
use dioptric_scene::{
    Args, Category, Default, Description, Diagnostic, Param, Schema, Type, Value,
};

use super::overrides::Overridden;

/// The schema of `develop`.
pub static SCHEMA: Schema = Schema {
    kind: "develop",
    category: Category::Setting,
    summary: "how linear light becomes a picture: exposure, tone curve, encoding",
    doc: "The last step, and the only one that leaves linear light: light times `exposure`, through the\n\
          `tone` curve into 0 to 1, encoded for the display, rounded to 8 or 16 bits. EXR and HDR files\n\
          hold the light before this step.\n\n\
          Tone curves: \"none\" cuts off what is above 1; \"reinhard\" divides by 1 + luminance; \"filmic\"\n\
          has a film's toe and shoulder; \"aces\" has more contrast than \"filmic\"; \"agx\" lets bright colours\n\
          fade to white as film does, without turning their hue; \"neutral\" leaves colours below 0.8 nearly as\n\
          they are, for goods whose colour matters. Encodings: \"srgb\" for displays, \"raw\" shows\n\
          the numbers as they are, as old programs do, \"gamma\" is the plain power 2.2.",
    params: &[
        Param::new(
            "exposure",
            Type::NON_NEGATIVE,
            Default::Number(1.0),
            "Multiplies the light; 2 is one stop brighter.",
        ),
        Param::new(
            "tone",
            Type::Choice(&Tone::NAMES),
            Default::Text("none"),
            "The curve from light without an upper end to 0 to 1.",
        ),
        Param::new(
            "encoding",
            Type::Choice(&Encoding::NAMES),
            Default::Text("srgb"),
            "What the stored numbers mean.",
        ),
    ],
    example: "",
};

/// The development that a `develop` node describes.
///
/// # Errors
/// Its arguments are wrong.
pub fn from_args(args: &Args) -> Result<Develop, Diagnostic> {
    let tone = Tone::parse(&args.text("tone")?);
    let encoding = Encoding::parse(&args.text("encoding")?);
    Ok(Develop {
        exposure: args.number("exposure")?,
        tone: tone.map_err(|e| args.error("tone", "wrong-value", e.to_string()))?,
        encoding: encoding.map_err(|e| args.error("encoding", "wrong-value", e.to_string()))?,
    })
}

/// The scene's development, else the default one, with the arguments in `replaced` on top.
///
/// # Errors
/// An argument is wrong, or none of `develop`'s.
pub fn from_scene(scene: &Description, replaced: &[(&str, Value)]) -> Result<Develop, Diagnostic> {
    let setting = Overridden::new(scene, &SCHEMA, replaced)?;
    from_args(&setting.args()).map_err(|error| setting.explain(error))
}

/// Every parameter with its value, in the schema's order: read again, they give the same
/// development. For metadata and statistics.
#[must_use]
pub fn to_values(develop: &Develop) -> Vec<(&'static str, Value)> {
    vec![
        ("exposure", Value::Number(develop.exposure)),
        ("tone", Value::Text(develop.tone.name().into())),
        ("encoding", Value::Text(develop.encoding.name().into())),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_scene::args::make_node;

    fn text(t: &str) -> Value {
        Value::Text(t.into())
    }

    #[test]
    fn the_schema_and_the_defaults_of_the_image_crate_agree() {
        assert_eq!(from_scene(&Description::default(), &[]), Ok(Develop::default()));
    }

    #[test]
    fn callers_replace_arguments_of_the_scene() {
        let mut scene = Description::default();
        let args = [("exposure", Value::Number(0.8)), ("encoding", text("raw"))];
        let id = scene.push(make_node(&SCHEMA, &args).unwrap());
        scene.roots.push(id);
        let got = from_scene(&scene, &[("exposure", Value::Number(2.0)), ("tone", text("aces"))]);
        let expected = Develop { exposure: 2.0, tone: Tone::Aces, encoding: Encoding::Raw };
        assert_eq!(got, Ok(expected));
        assert_eq!(from_scene(&scene, &to_values(&expected)), got);
    }

    #[test]
    fn wrong_values_are_explained() {
        let wrong = |name: &str, value| {
            from_scene(&Description::default(), &[(name, value)]).unwrap_err().message
        };
        assert_eq!(
            wrong("exposure", Value::Number(-1.0)),
            "exposure of develop: expected a number of at least 0, got -1"
        );
        assert_eq!(
            wrong("tone", text("film")),
            "tone of develop: expected one of \"none\", \"reinhard\", \"filmic\", \"aces\", \"agx\", \"neutral\", got \"film\""
        );
        assert_eq!(wrong("gain", Value::Number(1.0)), "develop has no parameter gain");
    }
}
