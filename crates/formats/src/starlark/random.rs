// SPDX-License-Identifier: MIT OR Apache-2.0
//! `random(seed)`: a generator whose numbers depend on its seed and on how many were drawn before.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

use allocative::Allocative;
use dioptric_math::{cos, ln, random as keys};
use starlark::any::ProvidesStaticType;
use starlark::environment::{GlobalsBuilder, Methods, MethodsBuilder};
use starlark::values::float::UnpackFloat;
use starlark::values::{
    Heap, NoSerialize, StarlarkPagablePanic, StarlarkValue, Value, starlark_value,
};
use starlark::{starlark_module, starlark_simple_value};

use super::convert::items;
use super::errors::Raised;

/// A generator. The count is atomic only so that the evaluator may share the value; a scene is
/// evaluated on one thread.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct Generator {
    key: u64,
    #[allocative(skip)]
    drawn: AtomicU64,
}

starlark_simple_value!(Generator);

impl fmt::Display for Generator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("<random>")
    }
}

starlark::methods_static!(METHODS = generator_methods);

#[starlark_value(type = "random")]
impl<'v> StarlarkValue<'v> for Generator {
    fn get_methods() -> Option<&'static Methods> {
        Some(METHODS.methods())
    }
}

impl Generator {
    fn bits(&self) -> u64 {
        keys::join(self.key, self.drawn.fetch_add(1, Ordering::Relaxed))
    }

    /// A number in `[0, 1)`.
    fn unit(&self) -> f64 {
        keys::unit(self.bits())
    }

    /// A whole number in `[0, n)`, without bias: the high half of a product (Lemire, "Fast Random
    /// Integer Generation in an Interval", ACM TOMACS 29(1), 2019, section 4).
    fn below(&self, n: u64) -> u64 {
        let limit = n.wrapping_neg() % n.max(1);
        loop {
            let product = u128::from(self.bits()) * u128::from(n);
            if product as u64 >= limit {
                return (product >> 64) as u64;
            }
        }
    }
}

fn wrong(message: String) -> starlark::Error {
    Raised::error("wrong-value", message)
}

#[starlark_module]
fn generator_methods(builder: &mut MethodsBuilder) {
    /// A number from `a` up to, but not including, `b`.
    fn uniform(
        this: &Generator,
        #[starlark(default = UnpackFloat(0.0))] a: UnpackFloat,
        #[starlark(default = UnpackFloat(1.0))] b: UnpackFloat,
    ) -> starlark::Result<f64> {
        Ok(a.0 + (b.0 - a.0) * this.unit())
    }

    /// A whole number from `a` to `b`, both included.
    fn integer<'v>(
        this: &Generator,
        a: i32,
        b: i32,
        heap: Heap<'v>,
    ) -> starlark::Result<Value<'v>> {
        if a > b {
            return Err(wrong(format!("integer from {a} to {b}: nothing lies there")));
        }
        let (a, b) = (i64::from(a), i64::from(b));
        Ok(heap.alloc(a + this.below((b - a + 1) as u64) as i64))
    }

    /// One of the items of a list.
    fn choice<'v>(
        this: &Generator,
        #[starlark(require = pos)] list: Value<'v>,
    ) -> starlark::Result<Value<'v>> {
        match items(list) {
            None => Err(wrong("choice takes a list".into())),
            Some(list) => list
                .get(this.below(list.len() as u64) as usize)
                .copied()
                .ok_or_else(|| wrong("choice from an empty list".into())),
        }
    }

    /// A number of the normal distribution (Box and Muller, "A Note on the Generation of Random
    /// Normal Deviates", 1958, equation 1).
    fn normal(
        this: &Generator,
        #[starlark(default = UnpackFloat(0.0))] mean: UnpackFloat,
        #[starlark(default = UnpackFloat(1.0))] sd: UnpackFloat,
    ) -> starlark::Result<f64> {
        let radius = (-2.0 * ln(1.0 - this.unit())).sqrt();
        Ok(mean.0 + sd.0 * radius * cos(std::f64::consts::TAU * this.unit()))
    }
}

#[starlark_module]
fn random_function(builder: &mut GlobalsBuilder) {
    /// A generator of random numbers; the same seed gives the same numbers, always.
    fn random(#[starlark(default = 0)] seed: i32) -> starlark::Result<Generator> {
        Ok(Generator { key: keys::mix(i64::from(seed) as u64), drawn: AtomicU64::new(0) })
    }
}

pub(super) fn register(builder: &mut GlobalsBuilder) {
    random_function(builder);
}
