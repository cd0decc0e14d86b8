// SPDX-License-Identifier: MIT OR Apache-2.0
//! The kinds of transforms that scenes can write, and the matrix that a list of them makes.

use dioptric_math::{DAffine3, DMat3, DVec3, normalize, orthonormal_basis, sin_cos};
use dioptric_scene::args::matrix_numbers;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use crate::transform::Transform;

static TRANSLATE: Schema = Schema {
    kind: "translate",
    category: Category::Transform,
    summary: "moves",
    doc: "Adds `by` to every point.",
    params: &[Param::required("by", Type::Vec3, "How far along x, y and z.")],
    example: "box(min = (-0.5, 0, -0.5), max = (0.5, 1, 0.5))\n\
              box(min = (-0.5, 0, -0.5), max = (0.5, 1, 0.5), material = matte(\"gold\"), transform = translate((1.2, 0.5, -0.6)))",
};

static ROTATE: Schema = Schema {
    kind: "rotate",
    category: Category::Transform,
    summary: "turns about axes",
    doc: "Turns by `x` degrees about the x axis, then by `y` about the y axis, then by `z` about the z axis; or by\n\
          `angle` degrees about `axis`. Seen against the axis (its tip towards the eye) a positive angle turns\n\
          counter-clockwise. Multiples of 90 degrees are exact.\n\n\
          About an axis after Rodrigues: R = cos a I + (1 - cos a) n n^T + sin a [n]x.",
    params: &[
        Param::new("x", Type::NUMBER, Default::Number(0.0), "Degrees about the x axis, first."),
        Param::new("y", Type::NUMBER, Default::Number(0.0), "Degrees about the y axis, second."),
        Param::new("z", Type::NUMBER, Default::Number(0.0), "Degrees about the z axis, third."),
        Param::new(
            "axis",
            Type::Direction,
            Default::Absent,
            "The axis to turn about instead; needs `angle`.",
        ),
        Param::new("angle", Type::NUMBER, Default::Absent, "Degrees about `axis`."),
        CENTER,
    ],
    example: "box(min = (-1.6, 0, -0.5), max = (-0.6, 1, 0.5))\n\
              box(min = (-0.5, 0, -0.5), max = (0.5, 1, 0.5), material = matte(\"gold\"), transform = [rotate(y = 30), rotate(z = 20), translate((0.9, 0.2, 0))])",
};

static SCALE: Schema = Schema {
    kind: "scale",
    category: Category::Transform,
    summary: "stretches, shrinks",
    doc: "Multiplies by a number, or by one for each axis. Negative numbers turn a shape into its mirror image.",
    params: &[
        Param::required("by", Type::Scale, "The factor, or one for x, y and z; none may be 0."),
        CENTER,
    ],
    example: "box(min = (-1.6, 0, -0.5), max = (-0.6, 1, 0.5))\n\
              box(min = (-0.5, 0, -0.5), max = (0.5, 1, 0.5), material = matte(\"gold\"), transform = [scale((0.5, 1.8, 0.5)), translate((0.5, 0, 0))])",
};

static SHEAR: Schema = Schema {
    kind: "shear",
    category: Category::Transform,
    summary: "leans",
    doc: "`xy` adds `xy` times y to x, and so on: the first letter is the coordinate that changes, the second the one that\n\
          it changes with. The matrix is (1, xy, xz; yx, 1, yz; zx, zy, 1).",
    params: &[
        Param::new("xy", Type::NUMBER, Default::Number(0.0), "How much x grows with y."),
        Param::new("xz", Type::NUMBER, Default::Number(0.0), "How much x grows with z."),
        Param::new("yx", Type::NUMBER, Default::Number(0.0), "How much y grows with x."),
        Param::new("yz", Type::NUMBER, Default::Number(0.0), "How much y grows with z."),
        Param::new("zx", Type::NUMBER, Default::Number(0.0), "How much z grows with x."),
        Param::new("zy", Type::NUMBER, Default::Number(0.0), "How much z grows with y."),
    ],
    example: "box(min = (-1.6, 0, -0.5), max = (-0.6, 1, 0.5))\n\
              box(min = (-0.5, 0, -0.5), max = (0.5, 1, 0.5), material = matte(\"gold\"), transform = [shear(xy = 0.6), translate((0.4, 0, 0))])",
};

static REFLECT: Schema = Schema {
    kind: "reflect",
    category: Category::Transform,
    summary: "makes the mirror image",
    doc: "Reflects at the plane through `point` with this `normal`: I - 2 n n^T (Householder).",
    params: &[
        Param::required("normal", Type::Direction, "At right angles to the plane; of any length."),
        Param::new("point", Type::Vec3, Default::Vec3([0.0; 3]), "A point of the plane."),
    ],
    example: "cone(base = (0.9, 0, 0), radius = 0.7, height = 1.6)\n\
              cone(base = (0.9, 0, 0), radius = 0.7, height = 1.6, material = matte(\"gold\"),\n\
                   transform = [reflect(normal = (1, 0, 0)), reflect(normal = (0, 1, 0), point = (0, 0.8, 0))])",
};

static ORIENT: Schema = Schema {
    kind: "orient",
    category: Category::Transform,
    summary: "turns one direction into another",
    doc: "The smallest turn that takes the direction `axis` into the direction `to`; for opposite directions one of the\n\
          half turns that do.",
    params: &[
        Param::required("to", Type::Direction, "The direction after."),
        Param::new(
            "axis",
            Type::Direction,
            Default::Vec3([0.0, 1.0, 0.0]),
            "The direction before: the y axis, along which shapes stand.",
        ),
    ],
    example: "cylinder(base = (-0.9, 0, 0), radius = 0.3, height = 1.6)\n\
              cylinder(radius = 0.3, height = 1.6, material = matte(\"gold\"),\n\
                       transform = [orient(to = (1, 1, 0)), translate((0.2, 0.2, 0))])",
};

static MATRIX: Schema = Schema {
    kind: "matrix",
    category: Category::Transform,
    summary: "any affine transform by its numbers",
    doc: "The matrix row by row, as it stands in books: points are columns to its right. Nine numbers are 3 x 3, twelve\n\
          are 3 x 4 with the translation in the last column, sixteen have a last row of 0, 0, 0, 1.",
    params: &[Param::required("values", Type::Matrix, "The numbers, in one list or in rows.")],
    example: "box(min = (-1.6, 0, -0.5), max = (-0.6, 1, 0.5))\n\
              box(min = (-0.5, 0, -0.5), max = (0.5, 1, 0.5), material = matte(\"gold\"), transform = [matrix([(1, 0.4, 0), (0, 1.2, 0), (0, 0, 1)]), translate((0.4, 0, 0))])",
};

const CENTER: Param =
    Param::new("center", Type::Vec3, Default::Vec3([0.0; 3]), "The point that stays where it is.");

/// Makes the matrix of one node.
type Maker = fn(&Args) -> Result<DAffine3, Diagnostic>;

static KINDS: [(&Schema, Maker); 7] = [
    (&TRANSLATE, translate),
    (&ROTATE, rotate),
    (&SCALE, scale),
    (&SHEAR, shear),
    (&REFLECT, reflect),
    (&ORIENT, orient),
    (&MATRIX, matrix),
];

/// The schemas of all transforms.
pub static TRANSFORM_SCHEMAS: &[&Schema] =
    &[&TRANSLATE, &ROTATE, &SCALE, &SHEAR, &REFLECT, &ORIENT, &MATRIX];

/// The product of the transforms in argument `name` of a node, applied in the order of the list;
/// the identity where it is absent.
///
/// # Errors
/// An item is no transform, has no inverse by itself, or the product has none.
pub fn placement(args: &Args, name: &str) -> Result<DAffine3, Diagnostic> {
    let mut product = DAffine3::IDENTITY;
    for id in args.nodes(name)? {
        let item = Args::new(args.description, id);
        let kind = item.node().schema.kind;
        let Some((_, make)) = KINDS.iter().find(|(schema, _)| schema.kind == kind) else {
            return Err(args.error(name, "wrong-type", format!("{kind} is no transform")));
        };
        let one = make(&item)?;
        if Transform::new(one).is_none() {
            return Err(item
                .error_here("singular-transform", format!("this {kind} has no inverse"))
                .help("choose numbers that neither flatten space nor stretch it without limit"));
        }
        product = one * product;
    }
    if Transform::new(product).is_none() {
        return Err(args
            .error(name, "singular-transform", format!("{name}: the product of the list has no inverse"))
            .help("choose transforms that together neither flatten space nor stretch it without limit"));
    }
    Ok(product)
}

fn translate(args: &Args) -> Result<DAffine3, Diagnostic> {
    Ok(DAffine3::from_translation(args.vec3("by")?.into()))
}

fn rotate(args: &Args) -> Result<DAffine3, Diagnostic> {
    let degrees = [args.number("x")?, args.number("y")?, args.number("z")?];
    let angle = args.optional_number("angle")?;
    let axis = if args.value("axis")?.is_some() { Some(args.vec3("axis")?) } else { None };
    let turn = match (axis, angle) {
        (None, None) => {
            let [x, y, z] = degrees;
            about(DVec3::Z, z) * about(DVec3::Y, y) * about(DVec3::X, x)
        }
        (Some(axis), Some(angle)) => {
            if let Some(name) = ["x", "y", "z"].into_iter().find(|name| args.is_written(name)) {
                return Err(args
                    .error(
                        name,
                        "conflicting-arguments",
                        format!("rotate takes either {name} or axis"),
                    )
                    .help("write two rotate(...) in a list to turn twice"));
            }
            about(unit(args, "axis", axis)?, angle)
        }
        (Some(_), None) => {
            return Err(args
                .error("axis", "missing-argument", "rotate about an axis needs angle")
                .help("write angle = ... in degrees"));
        }
        (None, Some(_)) => {
            return Err(args
                .error("angle", "missing-argument", "rotate by an angle needs axis")
                .help("write axis = (x, y, z), or x, y or z = ... for the angle"));
        }
    };
    Ok(around(args.vec3("center")?.into(), turn))
}

fn scale(args: &Args) -> Result<DAffine3, Diagnostic> {
    let by = DVec3::from(args.vec3("by")?);
    let axes = ["x", "y", "z"].into_iter().zip(by.to_array());
    if let Some((axis, _)) = axes.into_iter().find(|(_, factor)| *factor == 0.0) {
        return Err(args
            .error(
                "by",
                "singular-transform",
                format!("scale by 0 along {axis} flattens the shape"),
            )
            .help("use a factor other than 0, such as 0.001 for something thin"));
    }
    Ok(around(args.vec3("center")?.into(), DMat3::from_diagonal(by)))
}

fn shear(args: &Args) -> Result<DAffine3, Diagnostic> {
    let n = |name: &str| args.number(name);
    Ok(DAffine3::from_mat3(DMat3::from_cols(
        DVec3::new(1.0, n("yx")?, n("zx")?),
        DVec3::new(n("xy")?, 1.0, n("zy")?),
        DVec3::new(n("xz")?, n("yz")?, 1.0),
    )))
}

fn reflect(args: &Args) -> Result<DAffine3, Diagnostic> {
    let n = unit(args, "normal", args.vec3("normal")?)?;
    Ok(around(args.vec3("point")?.into(), reflection(n)))
}

/// Rodrigues' formula with the sine and cosine from products; near the half turn, where it loses its
/// digits, two reflections (Möller and Hughes, "Efficiently Building a Matrix to Rotate One Vector to
/// Another", Journal of Graphics Tools 4(4), 1999).
fn orient(args: &Args) -> Result<DAffine3, Diagnostic> {
    let from = unit(args, "axis", args.vec3("axis")?)?;
    let to = unit(args, "to", args.vec3("to")?)?;
    let (axis, cosine) = (from.cross(to), from.dot(to));
    let turn = if cosine > -1.0 + 1e-6 {
        skew(axis) + DMat3::from_diagonal(DVec3::splat(cosine)) + outer(axis, axis / (1.0 + cosine))
    } else {
        let between = orthonormal_basis(from).0;
        let planes = [between - from, between - to].map(normalize);
        match planes {
            [Some(first), Some(second)] => reflection(second) * reflection(first),
            _ => DMat3::IDENTITY,
        }
    };
    Ok(DAffine3::from_mat3(turn))
}

fn matrix(args: &Args) -> Result<DAffine3, Diagnostic> {
    let numbers =
        args.value("values")?.and_then(|value| matrix_numbers(&value)).unwrap_or_default();
    let rows: Vec<&[f64]> = numbers.chunks(if numbers.len() == 9 { 3 } else { 4 }).collect();
    if let [_, _, _, last] = rows.as_slice()
        && *last != [0.0, 0.0, 0.0, 1.0]
    {
        return Err(args
            .error("values", "wrong-value", "the last row of a 4 x 4 matrix must be 0, 0, 0, 1")
            .help("write the rows as in books, with the translation in the last column"));
    }
    let at = |row: usize, column: usize| {
        rows.get(row).and_then(|r| r.get(column)).copied().unwrap_or(0.0)
    };
    let column = |c: usize| DVec3::new(at(0, c), at(1, c), at(2, c));
    Ok(DAffine3::from_cols(column(0), column(1), column(2), column(3)))
}

/// A unit vector from an argument that is a direction.
fn unit(args: &Args, name: &str, v: [f64; 3]) -> Result<DVec3, Diagnostic> {
    normalize(v.into()).ok_or_else(|| {
        args.error(name, "wrong-value", format!("{name} has no direction"))
            .help("write three numbers, not all zero")
    })
}

/// A linear map with `center` in the place of the origin.
fn around(center: DVec3, linear: DMat3) -> DAffine3 {
    if center == DVec3::ZERO {
        return DAffine3::from_mat3(linear);
    }
    DAffine3::from_mat3_translation(linear, center - linear * center)
}

/// The turn by `degrees` about a unit vector.
fn about(axis: DVec3, degrees: f64) -> DMat3 {
    let (sine, cosine) = sin_cos_degrees(degrees);
    DMat3::from_diagonal(DVec3::splat(cosine))
        + outer(axis, axis * (1.0 - cosine))
        + skew(axis * sine)
}

/// Exact for multiples of 90; the reduction is exact for all angles.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let angle = degrees % 360.0;
    let quarters = (angle / 90.0).round();
    let (s, c) = sin_cos((angle - 90.0 * quarters).to_radians());
    match (quarters as i32).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// The reflection at the plane through the origin with this unit normal.
fn reflection(n: DVec3) -> DMat3 {
    DMat3::IDENTITY - outer(n, n * 2.0)
}

/// `a b^T`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The matrix of `v x`.
fn skew(v: DVec3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.0, v.z, -v.y),
        DVec3::new(-v.z, 0.0, v.x),
        DVec3::new(v.y, -v.x, 0.0),
    )
}
