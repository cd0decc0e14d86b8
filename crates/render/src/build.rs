// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the `from_args` of patterns, materials and lights are built with: colours decoded as the
//! scene says, patterns shared, pictures loaded once.

use std::collections::HashMap;
use std::sync::Arc;

use dioptric_image::{ErrorKind, ImageError};
use dioptric_math::Spectrum;
use dioptric_scene::{Args, Description, Diagnostic, Loader, NodeId, Value, color};

use crate::bulk::Built;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::AnyPattern;
use crate::texture::{MAX_TEXELS, Texture, load_ahead};

/// How colours in the scene's text and its pictures are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum ColorReading {
    /// As sRGB values, decoded to linear light.
    #[default]
    Srgb,
    /// As they are (`scene(colors = "raw")` and `"linear"`).
    Raw,
}

impl ColorReading {
    /// A written colour in linear light.
    #[must_use]
    pub fn decode(self, rgb: [f64; 3]) -> Spectrum {
        match self {
            Self::Srgb => Spectrum::from(rgb.map(srgb_to_linear)),
            Self::Raw => Spectrum::from(rgb),
        }
    }
}

/// The inverse of sRGB's transfer function (IEC 61966-2-1:1999); values above 1 go on with the curve.
#[must_use]
pub fn srgb_to_linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { dioptric_math::pow((v + 0.055) / 1.055, 2.4) }
}

/// The state of building one scene's values.
pub struct Builder<'a> {
    /// What is built from.
    pub description: &'a Description,
    /// How colours are read.
    pub reading: ColorReading,
    /// How many texels pictures may still have.
    pub texels_left: u64,
    /// How many bytes meshes of files may still take.
    pub mesh_bytes_left: u64,
    /// How often a pattern was asked for: what is built meanwhile without one is the same everywhere.
    pub patterns_used: u64,
    pub(crate) loader: &'a dyn Loader,
    pub(crate) bulk: Built,
    patterns: HashMap<(NodeId, ColorReading), Arc<AnyPattern>>,
    textures: HashMap<Arc<str>, Arc<Texture>>,
    /// Pictures that were read together when the first was asked for.
    ahead: Option<HashMap<Arc<str>, Texture>>,
}

impl<'a> Builder<'a> {
    /// A builder with nothing built yet; pictures come from `loader`.
    #[must_use]
    pub fn new(
        description: &'a Description,
        reading: ColorReading,
        loader: &'a dyn Loader,
    ) -> Self {
        Self {
            description,
            reading,
            texels_left: MAX_TEXELS,
            mesh_bytes_left: u64::MAX,
            patterns_used: 0,
            loader,
            bulk: Built::default(),
            patterns: HashMap::new(),
            textures: HashMap::new(),
            ahead: None,
        }
    }

    /// The pattern of a node, built once for colours and once for numbers, and shared.
    ///
    /// # Errors
    /// Its arguments are wrong.
    pub fn pattern(&mut self, id: NodeId) -> Result<Arc<AnyPattern>, Diagnostic> {
        self.patterns_used += 1;
        let key = (id, self.reading);
        if let Some(done) = self.patterns.get(&key) {
            return Ok(done.clone());
        }
        // Nodes refer only to earlier nodes, so this recursion ends; readers bound its depth.
        let built = Arc::new(AnyPattern::from_args(&Args::new(self.description, id), self)?);
        self.patterns.insert(key, built.clone());
        Ok(built)
    }

    /// The picture that a file argument names, read once and shared.
    ///
    /// # Errors
    /// The file cannot be read, is no picture, is damaged or too large.
    pub fn texture(&mut self, args: &Args, name: &str) -> Result<Arc<Texture>, Diagnostic> {
        let path = args.text(name)?;
        if let Some(done) = self.textures.get(&path) {
            return Ok(done.clone());
        }
        let place = args.description.argument_span(args.id, name);
        let (description, loader, left) = (self.description, self.loader, self.texels_left);
        let ahead = self.ahead.get_or_insert_with(|| load_ahead(description, loader, left));
        let texture = match ahead.remove(&path) {
            Some(texture) if texture.texels() <= left => texture,
            _ => {
                let bytes = loader.read(&path).map_err(|why| why.diagnostic().at(place, ""))?;
                Texture::from_bytes(&bytes, &path, left)
                    .map_err(|why| picture_error(&why).at(place, ""))?
            }
        };
        self.texels_left -= texture.texels().min(left);
        let texture = Arc::new(texture);
        self.textures.insert(path, texture.clone());
        Ok(texture)
    }

    /// A colour argument: constant or pattern.
    ///
    /// # Errors
    /// It is missing or wrong.
    pub fn color(&mut self, args: &Args, name: &str) -> Result<ColorInput, Diagnostic> {
        match args.value(name)? {
            Some(Value::Node(id)) => Ok(ColorInput::Pattern(self.pattern(id)?)),
            _ => args.color(name).map(|rgb| ColorInput::Constant(self.reading.decode(rgb))),
        }
    }

    /// A number argument: constant or pattern. Nothing in the pattern is decoded: its numbers are data.
    ///
    /// # Errors
    /// It is missing or wrong.
    pub fn number(&mut self, args: &Args, name: &str) -> Result<NumberInput, Diagnostic> {
        match args.value(name)? {
            Some(Value::Node(id)) => {
                let reading = std::mem::replace(&mut self.reading, ColorReading::Raw);
                let pattern = self.pattern(id);
                self.reading = reading;
                Ok(NumberInput::Pattern(pattern?))
            }
            _ => args.number(name).map(NumberInput::Constant),
        }
    }

    /// Three lanes of data: constant or pattern. Nothing is decoded.
    ///
    /// # Errors
    /// They are missing or wrong.
    pub fn data(&mut self, args: &Args, name: &str) -> Result<ColorInput, Diagnostic> {
        let reading = std::mem::replace(&mut self.reading, ColorReading::Raw);
        let data = self.color(args, name);
        self.reading = reading;
        data
    }

    /// A colour that cannot vary, in linear light.
    ///
    /// # Errors
    /// It is missing or wrong.
    pub fn constant_color(&self, args: &Args, name: &str) -> Result<Spectrum, Diagnostic> {
        args.color(name).map(|rgb| self.reading.decode(rgb))
    }

    /// A list item or other value that must be a colour or a pattern.
    ///
    /// # Errors
    /// It is neither.
    pub fn color_value(
        &mut self,
        args: &Args,
        name: &str,
        value: &Value,
    ) -> Result<ColorInput, Diagnostic> {
        match value {
            Value::Node(id) => Ok(ColorInput::Pattern(self.pattern(*id)?)),
            other => match color::from_value(other) {
                Ok(rgb) => Ok(ColorInput::Constant(self.reading.decode(rgb))),
                Err(why) => Err(args.error(name, "wrong-color", why.message).help(why.help)),
            },
        }
    }
}

/// What is wrong with a picture, as a message about the scene.
fn picture_error(why: &ImageError) -> Diagnostic {
    let code = match why.kind {
        ErrorKind::Corrupt => "picture-damaged",
        ErrorKind::TooLarge => "picture-too-large",
        _ => "picture-unknown",
    };
    Diagnostic::error(code, why.message.clone()).help(why.help.clone())
}
