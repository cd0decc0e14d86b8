// SPDX-License-Identifier: MIT OR Apache-2.0
//! The description of a group. It is no shape of its own: whoever builds a world goes through its
//! members, and CSG takes it as the union of them.

use dioptric_scene::{Category, Param, Schema, Type};

/// `group(shapes)`: several shapes as one, with a common transform and material.
pub static GROUP_SCHEMA: Schema = Schema {
    kind: "group",
    category: Category::Shape,
    summary: "several shapes as one",
    doc: "Places its members together: its transform is applied after theirs. Its material is for those members that\n\
          have none. A group that is used more than once is kept in memory once.\n\n\
          As part of a union, intersection or difference a group is the union of its members.",
    params: &[Param::required(
        "shapes",
        Type::List(&Type::Node(Category::Shape)),
        "The members; groups too.",
    )],
    example: "pair = group([sphere(center = (-1, 1, 0)), sphere(center = (1, 1, 0))], material = matte(\"teal\"))\n\
              group([pair], transform = rotate(z = 30))",
};
