// SPDX-License-Identifier: MIT OR Apache-2.0
//! Operations that can ask for unbounded memory in one step, and are therefore checked before:
//! long ranges, and text or lists that are repeated.
//!
//! The evaluator looks at its memory only every thousand steps; `"x" * 2000000000` is one step.

use std::fmt;
use std::num::NonZeroI32;

use allocative::Allocative;
use dioptric_scene::Diagnostic;
use starlark::any::ProvidesStaticType;
use starlark::environment::GlobalsBuilder;
use starlark::eval::{Arguments, Evaluator};
use starlark::syntax::AstModule;
use starlark::values::range::Range;
use starlark::values::{NoSerialize, StarlarkPagablePanic, StarlarkValue, Value, starlark_value};
use starlark::{starlark_module, starlark_simple_value};

use super::convert::{items, number};
use super::errors::{Raised, out_of_memory};
use super::state::State;

/// A name that no scene can write, for the checked operator.
const MULTIPLY: &str = "*";

/// Makes the file call the checked operator instead of the plain one.
pub(super) fn rewrite(ast: &mut AstModule) {
    ast.replace_binary_operators(&[(MULTIPLY.into(), MULTIPLY.into())].into());
}

pub(super) fn register(builder: &mut GlobalsBuilder) {
    builder.set(MULTIPLY, Multiply);
    range_function(builder);
}

/// `a * b`, which repeats text and lists.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
struct Multiply;

starlark_simple_value!(Multiply);

impl fmt::Display for Multiply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(MULTIPLY)
    }
}

#[starlark_value(type = "operator")]
impl<'v> StarlarkValue<'v> for Multiply {
    fn invoke(
        &self,
        _me: Value<'v>,
        arguments: &Arguments<'v, '_>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let heap = eval.heap();
        let [a, b] = arguments.positional(heap)?;
        if number(a).is_none() || number(b).is_none() {
            let limit = State::of(eval)?.limits().memory;
            let times = |n: Value| n.unpack_i32().map_or(0, |n| n.max(0) as usize);
            let bytes = size(a).saturating_mul(times(b)).max(size(b).saturating_mul(times(a)));
            if bytes > limit {
                return Err(Raised::with(out_of_memory(limit)));
            }
        }
        a.mul(b, heap)
    }
}

/// Bytes that a text or list occupies; 0 for anything else.
fn size(value: Value) -> usize {
    match value.unpack_str() {
        Some(text) => text.len(),
        None => items(value).map_or(0, <[Value]>::len) * size_of::<Value>(),
    }
}

#[starlark_module]
fn range_function(builder: &mut GlobalsBuilder) {
    /// The whole numbers from `start` up to, but not including, `stop`, in steps of `step`.
    fn range(
        #[starlark(require = pos)] start: i32,
        #[starlark(require = pos)] stop: Option<i32>,
        #[starlark(require = pos, default = 1)] step: i32,
        eval: &mut Evaluator,
    ) -> starlark::Result<Range> {
        let (start, stop) = stop.map_or((0, start), |stop| (start, stop));
        let Some(nonzero) = NonZeroI32::new(step) else {
            return Err(Raised::error("wrong-value", "the step of range is 0"));
        };
        let length = (i64::from(stop) - i64::from(start)) / i64::from(step);
        let limit = State::of(eval)?.limits().steps;
        if length > 0 && length as u64 > limit {
            return Err(Raised::with(
                Diagnostic::error(
                    "too-many-steps",
                    format!(
                        "a range of {length} numbers is longer than the limit of {limit} steps"
                    ),
                )
                .help("--max-steps raises the limit"),
            ));
        }
        Ok(Range::new(start, stop, nonzero))
    }
}
