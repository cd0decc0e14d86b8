// SPDX-License-Identifier: MIT OR Apache-2.0
//! Operations that can ask for unbounded memory in one step, and are therefore checked before:
//! long ranges, and text or lists that are repeated or joined.
//!
//! The evaluator looks at its memory only every thousand steps; `"x" * 2000000000` is one step.

use std::fmt;
use std::num::NonZeroI32;

use allocative::Allocative;
use dioptric_scene::Diagnostic;
use starlark::any::ProvidesStaticType;
use starlark::codemap::FileSpanRef;
use starlark::environment::GlobalsBuilder;
use starlark::eval::{Arguments, BeforeStmtFunc, BeforeStmtFuncDyn, Evaluator};
use starlark::syntax::AstModule;
use starlark::values::range::Range;
use starlark::values::{NoSerialize, StarlarkPagablePanic, StarlarkValue, Value, starlark_value};
use starlark::{starlark_module, starlark_simple_value};

use super::convert::{items, number};
use super::errors::{Raised, out_of_memory};
use super::state::State;

/// Names that no scene can write, for the checked operators.
const OPERATORS: [(&str, Operator); 2] = [("*", Operator::Multiply), ("+", Operator::Add)];

/// Makes the file call the checked operators instead of the plain ones.
pub(super) fn rewrite(ast: &mut AstModule) {
    let names = OPERATORS.iter().map(|(name, _)| (name.to_string(), name.to_string()));
    ast.replace_binary_operators(&names.collect());
}

pub(super) fn register(builder: &mut GlobalsBuilder) {
    for (name, operator) in OPERATORS {
        builder.set(name, operator);
    }
    range_function(builder);
}

/// `a * b`, which repeats text and lists, and `a + b`, which joins them.
#[derive(Clone, Copy, Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
enum Operator {
    Multiply,
    Add,
}

starlark_simple_value!(Operator);

impl fmt::Display for Operator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Multiply => "*",
            Self::Add => "+",
        })
    }
}

#[starlark_value(type = "operator")]
impl<'v> StarlarkValue<'v> for Operator {
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
            let bytes = match self {
                Self::Multiply => {
                    size(a).saturating_mul(times(b)).max(size(b).saturating_mul(times(a)))
                }
                Self::Add => size(a).saturating_add(size(b)),
            };
            if bytes > limit {
                return Err(Raised::with(out_of_memory(limit)));
            }
        }
        match self {
            Self::Multiply => a.mul(b, heap),
            Self::Add => a.add(b, heap),
        }
    }
}

/// Bytes that a text or list occupies; 0 for anything else.
fn size(value: Value) -> usize {
    match value.unpack_str() {
        Some(text) => text.len(),
        None => items(value).map_or(0, <[Value]>::len) * size_of::<Value>(),
    }
}

/// Watches the memory before every `x += y`, which cannot be replaced by a call: a text that doubles
/// in each turn of a loop is too large after forty.
pub(super) fn watch(eval: &mut Evaluator, text: &str) {
    if text.contains("+=") {
        eval.before_stmt_for_dap(BeforeStmtFunc::from_dyn(Box::new(Watch)));
    }
}

struct Watch;

/// How much of a statement's text is searched for its operator.
const HEAD: usize = 200;

impl<'e> BeforeStmtFuncDyn<'e> for Watch {
    fn call<'v>(
        &mut self,
        place: FileSpanRef,
        _continued: bool,
        eval: &mut Evaluator<'v, '_, 'e>,
    ) -> starlark::Result<()> {
        let text = place.file.source_span(place.span).as_bytes();
        if text[..text.len().min(HEAD)].windows(2).any(|pair| pair == b"+=")
            && State::of(eval)?.is_memory_full(eval.heap().allocated_bytes())
        {
            return Err(Raised::enough());
        }
        Ok(())
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
