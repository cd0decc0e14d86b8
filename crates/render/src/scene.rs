// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene ready to be rendered. It does not change while it is rendered (invariant 1).

use std::ops::Deref;
use std::sync::Arc;

use dioptric_geometry::pool::Pooled;
use dioptric_geometry::shapes::{cone::Cone, cylinder::Cylinder};
use dioptric_geometry::world::{Hit, Surface, World};
use dioptric_geometry::{AnyShape, HitId, Ray, SurfacePoint};
use dioptric_image::Develop;
use dioptric_math::Spectrum;
use dioptric_math::random::{join, unit};
use dioptric_scene::{Description, NodeId};

use crate::bump::perturbed_normal;
use crate::camera::AnyCamera;
use crate::guide::Guide;
use crate::integrator::media::Medium;
use crate::integrator::path::arrive::Plains;
use crate::integrator::recorder::SourcePlace;
use crate::light::AnyLight;
use crate::manifold::Casters;
use crate::material::{Dressed, Finish, Interior, Relief};
use crate::pattern::PatternPoint;
use crate::setting::background::Background;
use crate::setting::fog::Fog;
use crate::setting::medium::Surroundings;
use crate::setting::render::RenderSettings;
use crate::setting::root::Root;
use crate::source::Sources;

/// What the scene knows of one object of the world.
#[derive(Clone, Copy, Debug)]
pub struct ObjectInfo {
    /// The node that made it.
    pub node: NodeId,
    /// Its material's index, or where its leaves' materials begin in [`Scene::leaf_materials`].
    pub material: u32,
    /// Whether it is a combination of solids, whose leaves have a material each.
    pub combined: bool,
}

/// A material, and what is known of it before any ray is cast.
#[derive(Clone, Debug)]
pub struct SceneMaterial {
    /// The material.
    pub material: Dressed,
    /// Its answer, where that is the same at every point: no pattern, no bump map.
    pub uniform: Option<Finish>,
    /// Whether it lets no light pass anywhere.
    pub opaque: bool,
    /// Whether paths find the same matte surface everywhere, and nothing else.
    pub matte: bool,
    /// What its inside does to light, besides absorbing it.
    pub interior: Interior,
    /// Whether rays may pass it as if it were not there.
    pub holes: bool,
    /// Whether it draws lots: see [`PatternPoint::lot`].
    pub by_lot: bool,
}

impl SceneMaterial {
    /// `uniform` says that the material was built without any pattern.
    #[must_use]
    pub fn new(material: Dressed, uniform: bool) -> Self {
        let by_lot = material.is_by_lot();
        let answer = (uniform && !by_lot).then(|| material.finish(&PatternPoint::NOWHERE));
        let opaque = match &answer {
            Some(finish) => finish.shadow_pass == Spectrum::ZERO,
            None => material.is_opaque(),
        };
        let (interior, holes) = (material.interior(), material.has_holes());
        let is_matte = |finish: &Finish| finish.is_matte() && finish.emission == Spectrum::ZERO;
        let matte = answer.as_ref().is_some_and(is_matte) && !holes && !by_lot;
        Self { material, uniform: answer, opaque, matte, interior, holes, by_lot }
    }
}

/// A light and the node that made it.
#[derive(Clone, Debug)]
pub struct PlacedLight {
    /// The light.
    pub light: AnyLight,
    /// The node that made it.
    pub node: NodeId,
}

/// Everything that a picture is made from.
#[derive(Debug)]
pub struct Scene {
    /// What it was compiled from: names and places for messages and `why`.
    pub description: Arc<Description>,
    /// What rays can hit.
    pub world: World,
    /// By object id of the world.
    pub objects: Vec<ObjectInfo>,
    /// All materials.
    pub materials: Vec<SceneMaterial>,
    /// Whether any of them has holes.
    pub has_holes: bool,
    /// Whether none of them lets light pass anywhere.
    pub all_opaque: bool,
    /// Materials of the leaves of CSG objects, by [`ObjectInfo::material`] plus leaf.
    pub leaf_materials: Vec<u32>,
    /// By instance id: the node that was used again.
    pub instances: Vec<NodeId>,
    /// All lights, in the order of the file.
    pub lights: Vec<PlacedLight>,
    /// Where paths look for light; empty for other integrators.
    pub sources: Sources,
    /// Where glass and mirrors gather light, if paths are to know.
    pub guide: Option<Guide>,
    /// What paths meet without looking at shapes and materials; empty for other integrators.
    pub(crate) plains: Plains,
    /// Balls over which paths look for light.
    pub casters: Casters,
    /// Light that comes from everywhere.
    pub ambient: Spectrum,
    /// What is seen where nothing is hit.
    pub background: Background,
    /// Fog between everything.
    pub fog: Option<Fog>,
    /// What fills the space between things.
    pub surroundings: Surroundings,
    /// What insides of things do to paths of light; nothing for other integrators.
    pub insides: Insides,
    /// The camera.
    pub camera: AnyCamera,
    /// The transparent objects that the camera is inside of, the innermost last.
    pub around_camera: Vec<Medium>,
    /// From the file's space to the space of rays.
    pub root: Root,
    /// Size, samples, limits.
    pub settings: RenderSettings,
    /// From linear light to the picture's values.
    pub develop: Develop,
}

/// What any inside of a scene does to paths of light: what none does costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Insides {
    /// Scatters.
    pub scatter: bool,
    /// Has a surface that does nothing.
    pub borders: bool,
    /// Bends each wavelength by its own angle.
    pub disperse: bool,
    /// Counts more than others where they overlap.
    pub overlap: bool,
}

impl Insides {
    /// Of a scene with these materials and this between things.
    #[must_use]
    pub fn of(materials: &[SceneMaterial], surroundings: &Surroundings) -> Self {
        let any = |is: fn(&Interior) -> bool| materials.iter().any(|m| is(&m.interior));
        Self {
            scatter: surroundings.scattering.is_some() || any(|i| i.scattering.is_some()),
            borders: any(|i| i.border),
            disperse: any(|i| i.dispersion.is_some()),
            overlap: any(|i| i.priority != 0),
        }
    }
}

/// A point to shade: its surface, and what its material answers there.
pub struct Shading<'a> {
    /// The surface in the space of rays; its shading normal bumped, both normals as the shape has them.
    pub surface: SurfacePoint,
    /// The material's answer.
    pub finish: Answer<'a>,
}

/// A material's answer at a point: the one for all points, or one of its own.
#[derive(Clone, Debug)]
pub enum Answer<'a> {
    /// Of a uniform material.
    Same(&'a Finish),
    /// Of a material with patterns. (Boxed: answers are large, and carried about.)
    Here(Box<Finish>),
}

impl Deref for Answer<'_> {
    type Target = Finish;

    #[inline]
    fn deref(&self) -> &Finish {
        match self {
            Self::Same(finish) => finish,
            Self::Here(finish) => finish,
        }
    }
}

/// The number by which materials draw lots where a ray hits something: see [`PatternPoint::lot`].
fn lot(ray: &Ray, hit: &Hit) -> f64 {
    let Ray { origin, direction, .. } = ray;
    let numbers = [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, hit.t];
    let key = (u64::from(hit.id.object) << 32) ^ u64::from(hit.id.part);
    unit(
        numbers.iter().fold(join(u64::from(hit.id.instance), key), |key, x| join(key, x.to_bits())),
    )
}

/// Parts of CSG objects carry their leaf above these bits (see `dioptric_geometry::shapes::csg`).
pub(crate) const LEAF_SHIFT: u32 = 8;

impl Scene {
    /// The index of the material of a hit.
    #[must_use]
    pub fn material_index(&self, id: HitId) -> usize {
        let ObjectInfo { material, combined, .. } = self.objects[id.object as usize];
        let leaf = || self.leaf_materials[(material + (id.part >> LEAF_SHIFT)) as usize];
        if combined { leaf() as usize } else { material as usize }
    }

    /// What the material of a hit answers, where that is the same at every point.
    #[inline(always)]
    pub(crate) fn uniform(&self, id: HitId) -> Option<&Finish> {
        self.materials[self.material_index(id)].uniform.as_ref()
    }

    /// Works out what shading needs of a hit; `None` only for a hit that is not of this world.
    #[must_use]
    pub fn shading(&self, ray: &Ray, hit: &Hit) -> Option<Shading<'_>> {
        self.shading_in(ray, hit, Box::new)
    }

    /// The same with a box for the answer, if one is needed, from `put`.
    pub(crate) fn shading_in(
        &self,
        ray: &Ray,
        hit: &Hit,
        put: impl FnOnce(Finish) -> Box<Finish>,
    ) -> Option<Shading<'_>> {
        let SceneMaterial { material, uniform, .. } = &self.materials[self.material_index(hit.id)];
        if let Some(finish) = uniform {
            let surface = self.world.surface_point(ray, hit)?;
            return Some(Shading { surface, finish: Answer::Same(finish) });
        }
        let (surface, point) = self.surface_and_point(ray, hit)?;
        Some(Shading {
            surface: surface.into(),
            finish: Answer::Here(put(material.finish(&point))),
        })
    }

    /// Everything about the surface at a hit, its shading normal bumped, and where its patterns are asked.
    #[must_use]
    pub fn surface_and_point(&self, ray: &Ray, hit: &Hit) -> Option<(Surface, PatternPoint)> {
        let mut surface = self.world.surface(ray, hit)?;
        let material = &self.materials[self.material_index(hit.id)];
        let root = self.root.transform();
        let mut point = PatternPoint {
            object: surface.local_point,
            world: surface.point,
            uv: surface.uv,
            object_normal: surface.local_normal,
            world_normal: surface.shading_normal,
            lot: if material.by_lot { lot(ray, hit) } else { PatternPoint::NOWHERE.lot },
        };
        if !self.root.is_identity() {
            point.world = root.to_local().transform_point3(surface.point);
            // A normal goes back by the transpose of the way there.
            let back = root.to_world().matrix3.transpose() * surface.shading_normal;
            point.world_normal = dioptric_math::normalize(back).unwrap_or(surface.shading_normal);
        }
        let mut relief = Relief::default();
        material.material.relief(&point, &mut relief);
        if !relief.is_flat() {
            let to_ray = self.world.object_to_ray(hit.id)?.matrix3;
            let to_file = root.to_local().matrix3 * to_ray;
            let shape = self.world.shape(hit.id.object)?;
            let bumped = perturbed_normal(shape, hit.id.part, &to_file, &point, &relief);
            surface.shading_normal =
                dioptric_math::normalize(to_ray.inverse().transpose() * bumped)
                    .unwrap_or(surface.shading_normal);
        }
        Some((surface, point))
    }

    /// What its inside does to light, besides absorbing it.
    #[must_use]
    pub fn interior(&self, id: HitId) -> &Interior {
        &self.materials[self.material_index(id)].interior
    }

    /// What light loses on its way through an object that absorbs so much: where things scatter, that too.
    #[must_use]
    pub fn extinction(&self, id: HitId, absorption: Spectrum) -> Spectrum {
        if !self.insides.scatter {
            return absorption;
        }
        absorption + self.interior(id).scattering.map_or(Spectrum::ZERO, |s| s.coefficient)
    }

    /// Whether a hit's material lets no light pass anywhere.
    #[must_use]
    pub fn is_opaque(&self, id: HitId) -> bool {
        self.materials[self.material_index(id)].opaque
    }

    /// A number that tells objects apart in layers and adaptive sampling: unique for each pair of
    /// instance and object among the first 2^32.
    #[must_use]
    pub fn layer_id(&self, id: HitId) -> u32 {
        if id.instance == HitId::NO_INSTANCE {
            id.object
        } else {
            // Groups' objects are counted once for each instance, after all plain ones.
            let base = (self.objects.len() as u32).wrapping_mul(id.instance.wrapping_add(1));
            base.wrapping_add(id.object)
        }
    }

    /// The name of a hit's object.
    #[must_use]
    pub fn object_label(&self, id: HitId) -> String {
        let object = self.description.label(self.leaf_node(id));
        match self.instances.get(id.instance as usize) {
            Some(&instance) => format!("{} / {object}", self.description.label(instance)),
            None => object,
        }
    }

    /// Which of the many things that are one object was hit: `triangle 12`, `sphere 3`, counted from 0; nothing
    /// for other objects.
    #[must_use]
    pub fn part_label(&self, id: HitId) -> Option<String> {
        let part = id.part;
        match self.world.shape(id.object)? {
            AnyShape::Mesh(_) => Some(format!("triangle {part}")),
            AnyShape::Spheres(_) => Some(format!("sphere {part}")),
            AnyShape::Cylinders(_) => Some(format!("cylinder {}", part >> Cylinder::PART_BITS)),
            AnyShape::Cones(_) => Some(format!("cone {}", part >> Cone::PART_BITS)),
            _ => None,
        }
    }

    /// The line that made a hit's object.
    #[must_use]
    pub fn object_source(&self, id: HitId) -> Option<SourcePlace> {
        self.source(self.leaf_node(id))
    }

    /// The node of a hit: the leaf's in a CSG tree.
    fn leaf_node(&self, id: HitId) -> NodeId {
        let own = self.objects[id.object as usize].node;
        self.world
            .shape(id.object)
            .and_then(|s| s.csg_path(id.part).first().copied())
            .unwrap_or(own)
    }

    /// The line that made a node.
    #[must_use]
    pub fn source(&self, node: NodeId) -> Option<SourcePlace> {
        let place = self.description.sources.locate(self.description.node(node).span)?;
        Some(SourcePlace { file: place.file.to_string(), line: place.line })
    }
}
