// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lists of points, pairs of points and radii in arguments.

use dioptric_math::DVec3;
use dioptric_scene::{Args, Diagnostic, Value};

/// The points of a list.
pub fn points(args: &Args, name: &str) -> Result<Vec<DVec3>, Diagnostic> {
    let point = |v: &Value| if let Value::Vec3(p) = v { Some(DVec3::from(*p)) } else { None };
    Ok(args.list(name)?.iter().filter_map(point).collect())
}

/// The pairs of points of a list.
pub fn ends(args: &Args, name: &str) -> Result<Vec<[DVec3; 2]>, Diagnostic> {
    let pair = |v: &Value| match v {
        Value::List(items) => match **items {
            [Value::Vec3(a), Value::Vec3(b)] => Some([DVec3::from(a), DVec3::from(b)]),
            _ => None,
        },
        _ => None,
    };
    Ok(args.list(name)?.iter().filter_map(pair).collect())
}

/// A radius for each of `count` things: those of the list `many`, else the number `one` for all.
pub fn radii(args: &Args, one: &str, many: &str, count: usize) -> Result<Vec<f64>, Diagnostic> {
    if !args.is_written(many) {
        return Ok(vec![args.number(one)?; count]);
    }
    if args.is_written(one) {
        let message = format!("{} has both {one} and {many}", args.node().schema.kind);
        let help = format!("write {one} = ... where all have the same, else {many} = [...]");
        return Err(args.error(one, "wrong-value", message).help(help));
    }
    let number = |v: &Value| if let Value::Number(x) = v { Some(*x) } else { None };
    let list: Vec<f64> = args.list(many)?.iter().filter_map(number).collect();
    if list.len() != count {
        let kind = args.node().schema.kind;
        let message = format!("{many} has {} numbers for {count} {kind}", list.len());
        let help = format!("give one number for each of the {kind}, or {one} = ... for all");
        return Err(args.error(many, "wrong-value", message).help(help));
    }
    Ok(list)
}

/// Says that there are more things than can be told apart.
pub fn too_many(args: &Args) -> Diagnostic {
    let kind = args.node().schema.kind;
    args.error_here("too-many-objects", format!("there are too many {kind} in one list"))
        .help("write them as several lists")
}

/// Says that one thing of a list has no length or no radius.
pub fn no_extent(args: &Args, index: usize, thing: &str, what: &str) -> Diagnostic {
    let message = format!("{thing} {} of the list has {what}", index + 1);
    args.error("ends", "no-size", message).help("leave it out, or move its ends apart")
}
