// SPDX-License-Identifier: MIT OR Apache-2.0
//! Puts shapes in their places: groups are flattened, things used again become instances, and every
//! object gets its material.

use std::collections::HashMap;

use dioptric_geometry::world::{GroupId, PlacementError, World, WorldBuilder};
use dioptric_geometry::{AnyShape, GROUP_SCHEMA, placement};
use dioptric_math::{DAffine3, Spectrum};
use dioptric_scene::{Args, Category, Description, Diagnostic, NodeId};

use crate::build::Builder;
use crate::bulk;
use crate::material::matte::Matte;
use crate::material::{AnyMaterial, Dressed};
use crate::scene::{LEAF_SHIFT, ObjectInfo, SceneMaterial};

/// Groups in groups deeper than this are refused: the walk is recursive.
const MAX_DEPTH: usize = 200;
/// Solids in one combination; a ray tests them all.
const MAX_LEAVES: u32 = 1 << 16;
/// Errors after this many are not collected: they repeat.
const MAX_ERRORS: usize = 20;

/// The world and who is who in it.
pub(super) struct Placed {
    pub world: World,
    pub objects: Vec<ObjectInfo>,
    pub materials: Vec<SceneMaterial>,
    pub leaf_materials: Vec<u32>,
    pub instances: Vec<NodeId>,
}

/// The walk over the tree of shapes.
pub(super) struct Places<'a, 'b> {
    d: &'a Description,
    builder: &'b mut Builder<'a>,
    world: WorldBuilder,
    /// How often each shape node is used by groups: twice or more is worth an instance.
    uses: Vec<u32>,
    /// How many objects or leaves each shape node is, itself written out. Nodes can share members, so
    /// that sixty groups of two are 2^60 spheres: known before anything is built.
    expanded: Vec<u32>,
    materials: Vec<SceneMaterial>,
    material_of: HashMap<Option<NodeId>, u32>,
    groups: HashMap<(NodeId, u32), GroupId>,
    objects: Vec<ObjectInfo>,
    leaf_materials: Vec<u32>,
    instances: Vec<NodeId>,
    errors: Vec<Diagnostic>,
    max_objects: usize,
}

/// What a shape takes over from the groups around it.
#[derive(Clone, Copy)]
struct Context {
    placement: DAffine3,
    material: u32,
    depth: usize,
    /// Inside of an instanced group, where further instances are copied instead.
    in_instance: bool,
}

impl<'a, 'b> Places<'a, 'b> {
    pub fn new(d: &'a Description, builder: &'b mut Builder<'a>, max_objects: usize) -> Self {
        let mut uses = vec![0; d.nodes.len()];
        let mut expanded = vec![0_u32; d.nodes.len()];
        // Members come before the nodes that hold them. Nodes that are no shapes count as nothing.
        for (i, node) in d.nodes.iter().enumerate() {
            if node.schema.category != Category::Shape {
                continue;
            }
            let mut members = 0_u32;
            for (_, value) in &node.args {
                value.for_each_node(&mut |id| {
                    uses[id.0 as usize] += 1;
                    members = members.saturating_add(expanded[id.0 as usize]);
                });
            }
            expanded[i] = members.max(1);
        }
        let grey = AnyMaterial::Matte(Matte::new(Spectrum::splat(0.5)));
        let grey = SceneMaterial::new(grey.into(), true);
        Self {
            d,
            builder,
            world: WorldBuilder::new(),
            uses,
            expanded,
            materials: vec![grey],
            material_of: HashMap::from([(None, 0)]),
            groups: HashMap::new(),
            objects: Vec::new(),
            leaf_materials: Vec::new(),
            instances: Vec::new(),
            errors: Vec::new(),
            max_objects,
        }
    }

    /// Adds a shape that is in the scene by itself.
    pub fn add_root(&mut self, id: NodeId, root: DAffine3) {
        let context = Context { placement: root, material: 0, depth: 0, in_instance: false };
        self.keep_error(|this| this.shape(id, context));
    }

    /// The finished world; errors are appended.
    pub fn finish(mut self, errors: &mut Vec<Diagnostic>) -> Placed {
        errors.append(&mut self.errors);
        let world =
            if errors.is_empty() { self.world.build() } else { WorldBuilder::new().build() };
        Placed {
            world,
            objects: self.objects,
            materials: self.materials,
            leaf_materials: self.leaf_materials,
            instances: self.instances,
        }
    }

    fn keep_error(&mut self, f: impl FnOnce(&mut Self) -> Result<(), Diagnostic>) {
        if self.errors.len() < MAX_ERRORS
            && let Err(e) = f(self)
            && !self.errors.contains(&e)
        {
            self.errors.push(e);
        }
    }

    /// The index of the material of a shape node: its own, else the one around it.
    fn material(&mut self, args: &Args, around: u32) -> Result<u32, Diagnostic> {
        let Some(id) = args.optional_node("material")? else { return Ok(around) };
        if let Some(&index) = self.material_of.get(&Some(id)) {
            return Ok(index);
        }
        let used = self.builder.patterns_used;
        let material = Dressed::from_args(&Args::new(self.d, id), self.builder)?;
        let uniform = self.builder.patterns_used == used;
        self.materials.push(SceneMaterial::new(material, uniform));
        let index = self.materials.len() as u32 - 1;
        self.material_of.insert(Some(id), index);
        Ok(index)
    }

    fn shape(&mut self, id: NodeId, around: Context) -> Result<(), Diagnostic> {
        let args = Args::new(self.d, id);
        let is_group = args.node().schema.kind == GROUP_SCHEMA.kind;
        if is_group && self.uses[id.0 as usize] > 1 && !around.in_instance {
            return self.instance(&args, around);
        }
        let material = self.material(&args, around.material)?;
        let context = Context {
            placement: compose(&args, around.placement)?,
            material,
            depth: around.depth + 1,
            in_instance: around.in_instance,
        };
        if is_group { self.members(&args, context) } else { self.object(&args, context) }
    }

    fn members(&mut self, args: &Args, context: Context) -> Result<(), Diagnostic> {
        if context.depth > MAX_DEPTH {
            return Err(args
                .error_here("too-deep", format!("groups are nested more than {MAX_DEPTH} deep"))
                .help("put the members into fewer groups"));
        }
        for member in args.nodes("shapes")? {
            self.keep_error(|this| this.shape(member, context));
        }
        Ok(())
    }

    /// A group that is used more than once: its insides are built once for each material around it.
    fn instance(&mut self, args: &Args, around: Context) -> Result<(), Diagnostic> {
        let material = self.material(args, around.material)?;
        let group = match self.groups.get(&(args.id, material)) {
            Some(&group) => group,
            None => {
                self.check_room(args, self.expanded[args.id.0 as usize])?;
                let group = self.world.begin_group();
                let inside = Context {
                    placement: DAffine3::IDENTITY,
                    material,
                    depth: around.depth + 1,
                    in_instance: true,
                };
                let done = self.members(args, inside);
                self.world.end_group();
                done?;
                self.groups.insert((args.id, material), group);
                group
            }
        };
        let place = compose(args, around.placement)?;
        self.world.instance(group, place).map_err(|e| placement_diagnostic(args, &e))?;
        self.instances.push(args.id);
        Ok(())
    }

    /// Whether `more` objects are still allowed.
    fn check_room(&self, args: &Args, more: u32) -> Result<(), Diagnostic> {
        if self.objects.len() as u64 + u64::from(more) <= self.max_objects as u64 {
            return Ok(());
        }
        Err(args
            .error_here(
                "too-many-objects",
                format!("the scene has more than {} objects", self.max_objects),
            )
            .help("raise the limit with --max-objects, or use fewer"))
    }

    fn object(&mut self, args: &Args, context: Context) -> Result<(), Diagnostic> {
        let leaves = self.expanded[args.id.0 as usize];
        if leaves > MAX_LEAVES {
            return Err(args
                .error_here(
                    "too-many-objects",
                    format!("{} combines more than {MAX_LEAVES} solids", args.node().schema.kind),
                )
                .help("combine fewer, or use a group where the solids need not be joined"));
        }
        self.check_room(args, 1)?;
        let shape = match bulk::shape(args, self.builder)? {
            Some(shape) => shape,
            None => AnyShape::from_args(args)?.ok_or_else(|| {
                let kind = args.node().schema.kind;
                args.error_here("internal", format!("{kind} is no shape"))
            })?,
        };
        let leaves = shape.csg_leaf_nodes().len();
        let material = if leaves == 0 {
            context.material
        } else {
            let first = self.leaf_materials.len() as u32;
            for leaf in 0..leaves as u32 {
                // The innermost node around the leaf that has a material decides.
                let path = shape.csg_path(leaf << LEAF_SHIFT);
                let own =
                    path.iter().map(|&id| Args::new(self.d, id)).find(|a| a.is_written("material"));
                let index = match own {
                    Some(args) => self.material(&args, context.material)?,
                    None => context.material,
                };
                self.leaf_materials.push(index);
            }
            first
        };
        self.world.object(shape, context.placement).map_err(|e| placement_diagnostic(args, &e))?;
        self.objects.push(ObjectInfo { node: args.id, material, combined: leaves > 0 });
        Ok(())
    }
}

/// A node's own transforms inside of a placement.
fn compose(args: &Args, around: DAffine3) -> Result<DAffine3, Diagnostic> {
    if args.is_written("transform") {
        Ok(around * placement(args, "transform")?)
    } else {
        Ok(around)
    }
}

fn placement_diagnostic(args: &Args, error: &PlacementError) -> Diagnostic {
    args.error(
        "transform",
        "bad-placement",
        format!("{} cannot be placed: {error}", args.node().schema.kind),
    )
    .help("check the transforms of the shape and of the groups around it")
}
