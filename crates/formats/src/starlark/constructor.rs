// SPDX-License-Identifier: MIT OR Apache-2.0
//! `sphere(...)`: a function for every kind of the vocabulary, and the value that it returns.

use std::fmt;

use allocative::Allocative;
use dioptric_scene::{Diagnostic, NodeId, Schema};
use starlark::any::ProvidesStaticType;
use starlark::collections::StarlarkHasher;
use starlark::eval::{Arguments, Evaluator};
use starlark::starlark_simple_value;
use starlark::values::{
    self, NoSerialize, StarlarkPagablePanic, StarlarkValue, ValueLike, starlark_value,
};

use super::convert::convert;
use super::errors::Raised;
use super::state::State;
use crate::call::{Call, Kind};

/// The function that makes nodes of one kind.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct Constructor {
    #[allocative(skip)]
    kind: Kind,
}

starlark_simple_value!(Constructor);

impl Constructor {
    pub(crate) fn new(schema: &'static Schema) -> Self {
        Self { kind: Kind::new(schema) }
    }
}

impl fmt::Display for Constructor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind.schema.kind)
    }
}

#[starlark_value(type = "constructor")]
impl<'v> StarlarkValue<'v> for Constructor {
    fn invoke(
        &self,
        _me: values::Value<'v>,
        arguments: &Arguments<'v, '_>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<values::Value<'v>> {
        let state = State::of(eval)?;
        let (span, stack) = state.place(eval);
        let mut call = Call::default();
        // None is as if nothing had been written, so that functions can pass options on.
        for (i, value) in arguments.positions(eval.heap())?.enumerate() {
            if i >= self.kind.positional {
                call.extra_positional += 1;
            } else if !value.is_none() {
                self.kind.bind(&mut call, i, convert(value));
            }
        }
        for (key, value) in arguments.names_map()? {
            if !value.is_none() {
                self.kind.bind_named(&mut call, key.as_str(), convert(value));
            }
        }
        let mut build = state.build();
        let limit = state.limits().objects;
        if build.description.nodes.len() >= limit {
            let message = format!("the scene makes more than {limit} objects");
            return Err(Raised::with(
                Diagnostic::error("too-many-objects", message)
                    .help("--max-objects raises the limit"),
            ));
        }
        let (id, go_on) = self.kind.finish(call, &mut build, span, stack);
        drop(build);
        if !go_on {
            return Err(Raised::enough());
        }
        Ok(eval.heap().alloc_simple(Handle { id, schema: self.kind.schema }))
    }
}

/// What a constructor returns: an immutable name for its node.
#[derive(Clone, Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct Handle {
    #[allocative(skip)]
    pub id: NodeId,
    #[allocative(skip)]
    pub schema: &'static Schema,
}

starlark_simple_value!(Handle);

impl fmt::Display for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "<{}>", self.schema.kind)
    }
}

#[starlark_value(type = "node")]
impl<'v> StarlarkValue<'v> for Handle {
    fn equals(&self, other: values::Value<'v>) -> starlark::Result<bool> {
        Ok(other.downcast_ref::<Self>().is_some_and(|other| other.id == self.id))
    }

    fn write_hash(&self, hasher: &mut StarlarkHasher) -> starlark::Result<()> {
        std::hash::Hash::hash(&self.id, hasher);
        Ok(())
    }
}
