// SPDX-License-Identifier: MIT OR Apache-2.0
//! From nested operations to a flat list of leaves and gates.

use dioptric_math::{DAffine3, bounds::gamma};
use dioptric_scene::{Args, Diagnostic, NodeId};

use super::tree::{Gate, Output, Rule};
use super::{Csg, Leaf};
use crate::bounds::Bounds;
use crate::group::GROUP_SCHEMA;
use crate::placement::placement;
use crate::shapes::AnyShape;
use crate::transform::Transform;

/// The most solids in one combination: they share the 32 bits of a part's number with their own parts.
const MAX_LEAVES: usize = 1 << 16;
const MAX_NESTING: usize = 200;

/// What is done with solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// What is in any.
    Union,
    /// What is in all.
    Intersection,
    /// What is in the first and in no other.
    Difference,
}

/// A part of a combination.
#[derive(Clone, Debug)]
pub struct Operand {
    /// A solid or an operation.
    pub content: Content,
    /// Where it is put.
    pub placement: DAffine3,
    /// The node that made it.
    pub node: Option<NodeId>,
}

/// What an [`Operand`] is.
#[derive(Clone, Debug)]
pub enum Content {
    /// A solid.
    Solid(AnyShape),
    /// An operation on parts.
    Combination(Operation, Vec<Operand>),
}

impl Operand {
    /// A solid where it is.
    #[must_use]
    pub const fn solid(shape: AnyShape) -> Self {
        Self { content: Content::Solid(shape), placement: DAffine3::IDENTITY, node: None }
    }

    /// An operation on parts.
    #[must_use]
    pub const fn combination(operation: Operation, parts: Vec<Self>) -> Self {
        Self {
            content: Content::Combination(operation, parts),
            placement: DAffine3::IDENTITY,
            node: None,
        }
    }

    /// The same, moved by a further transform.
    #[must_use]
    pub fn placed(self, placement: DAffine3) -> Self {
        Self { placement: placement * self.placement, ..self }
    }
}

/// Why parts cannot be combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CsgError {
    /// A shape that is not closed has no inside.
    NotSolid(&'static str),
    /// An operation without parts.
    Empty,
    /// More than 65,536 solids.
    TooMany,
    /// Operations inside operations, more than 200 levels deep.
    TooDeep,
    /// A transform without an inverse.
    NoInverse,
}

impl std::fmt::Display for CsgError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotSolid(kind) => {
                write!(f, "this {kind} is not closed: it has no inside that could be combined")
            }
            Self::Empty => f.write_str("there is no shape to combine"),
            Self::TooMany => write!(f, "more than {MAX_LEAVES} solids in one combination"),
            Self::TooDeep => write!(f, "combinations more than {MAX_NESTING} levels deep"),
            Self::NoInverse => f.write_str("the transform of a part has no inverse"),
        }
    }
}

impl std::error::Error for CsgError {}

impl CsgError {
    /// The remedy.
    #[must_use]
    pub const fn help(self) -> &'static str {
        match self {
            Self::NotSolid(_) => {
                "use a closed shape, such as box, sphere, cylinder or cone with its caps"
            }
            Self::Empty => "write at least one shape in the list",
            Self::TooMany => "use a group where inner walls do not matter",
            Self::TooDeep => "list the parts in one union instead of nesting unions",
            Self::NoInverse => "choose transforms that do not flatten space",
        }
    }
}

impl<const KIND: usize> Csg<KIND> {
    /// Combines solids. The operand's own placement counts.
    ///
    /// # Errors
    /// A part is not solid, an operation has no part, or there are too many.
    pub fn new(operand: Operand) -> Result<Self, CsgError> {
        let mut builder = Builder { leaves: Vec::new(), gates: Vec::new(), path: Vec::new() };
        // A gate of its own around the whole, so that a single solid is a combination too.
        let rest = Output { gate: None, negated: false };
        builder.gates.push(Gate { rule: Rule::Any, parts: 1, output: rest, at_rest: 0 });
        let output = Output { gate: Some(0), negated: false };
        let built = builder.add(operand, DAffine3::IDENTITY, output, false)?;
        if let Some(gate) = builder.gates.first_mut() {
            gate.at_rest = u32::from(built.at_rest);
        }
        let Builder { leaves, gates, .. } = builder;
        Ok(Self { leaves, gates, bounds: built.bounds, convex: built.convex })
    }
}

struct Builder {
    leaves: Vec<Leaf>,
    gates: Vec<Gate>,
    /// The nodes from the whole down to the present one.
    path: Vec<NodeId>,
}

/// What is known of a part that was added.
struct Added {
    bounds: Bounds,
    convex: bool,
    /// Its value where the line is in no solid.
    at_rest: bool,
}

impl Builder {
    fn add(
        &mut self,
        operand: Operand,
        around: DAffine3,
        output: Output,
        subtracted: bool,
    ) -> Result<Added, CsgError> {
        let place = around * operand.placement;
        self.path.extend(operand.node);
        let added = match operand.content {
            Content::Solid(shape) => self.leaf(shape, place, output, subtracted),
            Content::Combination(op, parts) => self.gate(op, parts, place, output, subtracted),
        };
        if operand.node.is_some() {
            self.path.pop();
        }
        added
    }

    fn leaf(
        &mut self,
        shape: AnyShape,
        place: DAffine3,
        output: Output,
        subtracted: bool,
    ) -> Result<Added, CsgError> {
        if !shape.is_solid() {
            return Err(CsgError::NotSolid(shape.kind()));
        }
        if self.leaves.len() >= MAX_LEAVES {
            return Err(CsgError::TooMany);
        }
        let transform = if place == DAffine3::IDENTITY {
            None
        } else {
            Some(Transform::new(place).ok_or(CsgError::NoInverse)?)
        };
        let mut bounds = shape.bounds();
        if let Some(t) = &transform {
            // Hits are found in the leaf's space; what rounding does there comes back stretched.
            let (stretch, shrink) = t.norms();
            let placed = t.bounds_to_world(bounds);
            let extent = placed.min.abs().max(placed.max.abs()).max_element();
            let pad = gamma(256) * stretch * shrink * extent;
            bounds = if pad.is_finite() {
                Bounds { min: placed.min - pad, max: placed.max + pad }
            } else {
                placed
            };
        }
        let convex = shape.is_convex();
        let extent = bounds.min.abs().max(bounds.max.abs()).max_element();
        let path = self.path.iter().rev().copied().collect();
        self.leaves.push(Leaf { shape, transform, bounds, extent, output, subtracted, path });
        Ok(Added { bounds, convex, at_rest: false })
    }

    fn gate(
        &mut self,
        operation: Operation,
        parts: Vec<Operand>,
        place: DAffine3,
        output: Output,
        subtracted: bool,
    ) -> Result<Added, CsgError> {
        if parts.is_empty() {
            return Err(CsgError::Empty);
        }
        let rule = if operation == Operation::Union { Rule::Any } else { Rule::All };
        let index = self.gates.len();
        let count = parts.len() as u32;
        self.gates.push(Gate { rule, parts: count, output, at_rest: 0 });
        let single = parts.len() == 1;
        let mut sum = match rule {
            Rule::Any => Added { bounds: Bounds::EMPTY, convex: single, at_rest: false },
            Rule::All => Added { bounds: Bounds::EVERYTHING, convex: true, at_rest: false },
        };
        let mut at_rest = 0;
        for (i, part) in parts.into_iter().enumerate() {
            let negated = operation == Operation::Difference && i > 0;
            let part_output = Output { gate: Some(index as u32), negated };
            let added = self.add(part, place, part_output, subtracted != negated)?;
            at_rest += u32::from(added.at_rest != negated);
            sum.convex &= added.convex && !negated;
            sum.bounds = match rule {
                Rule::Any => sum.bounds.union(added.bounds),
                Rule::All if negated => sum.bounds,
                Rule::All => sum.bounds.intersection(added.bounds),
            };
        }
        if let Some(gate) = self.gates.get_mut(index) {
            gate.at_rest = at_rest;
            sum.at_rest = gate.value_at_rest();
        }
        Ok(sum)
    }
}

/// The operand that a node describes, without the node's own transform: whoever places the shape
/// applies that.
pub(super) fn read(args: &Args) -> Result<Operand, Diagnostic> {
    read_node(args, 0, &mut 0)
}

fn read_node(args: &Args, depth: usize, count: &mut usize) -> Result<Operand, Diagnostic> {
    let error = |e: CsgError| args.error_here("wrong-value", e.to_string()).help(e.help());
    if depth > MAX_NESTING {
        return Err(error(CsgError::TooDeep));
    }
    let kind = args.node().schema.kind;
    let (operation, parts) = match kind {
        "union" => (Operation::Union, args.nodes("shapes")?),
        "intersection" => (Operation::Intersection, args.nodes("shapes")?),
        "difference" => {
            let first = args.optional_node("shape")?;
            (Operation::Difference, first.into_iter().chain(args.nodes("minus")?).collect())
        }
        _ if kind == GROUP_SCHEMA.kind => (Operation::Union, args.nodes("shapes")?),
        _ => {
            *count += 1;
            if *count > MAX_LEAVES {
                return Err(error(CsgError::TooMany));
            }
            let Some(shape) = AnyShape::from_args(args)? else {
                return Err(args
                    .error_here("wrong-value", format!("{kind} cannot be part of a combination"))
                    .help("put it into a group beside the combination, or combine exact shapes"));
            };
            if !shape.is_solid() {
                return Err(error(CsgError::NotSolid(kind)));
            }
            return Ok(Operand { node: Some(args.id), ..Operand::solid(shape) });
        }
    };
    if parts.is_empty() {
        return Err(error(CsgError::Empty));
    }
    let mut operands = Vec::with_capacity(parts.len());
    for id in parts {
        let part = Args::new(args.description, id);
        let mut operand = read_node(&part, depth + 1, count)?;
        operand.placement = placement(&part, "transform")?;
        operands.push(operand);
    }
    Ok(Operand { node: Some(args.id), ..Operand::combination(operation, operands) })
}
