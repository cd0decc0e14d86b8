// SPDX-License-Identifier: MIT OR Apache-2.0
//! How an integrator tells what it does (invariant 4: `why` is not a second renderer).
//!
//! Integrators are generic over a [`Recorder`]. [`Silent`] is empty and compiles to nothing;
//! [`TreeRecorder`] builds the tree of [`Node`]s that `why` shows. Whatever costs time to tell is in
//! closures, which the silent recorder never calls.

use dioptric_geometry::Ray;
use dioptric_math::Spectrum;
use serde::Serialize;
use serde_json::{Map, Value, json};

/// Why a ray was cast.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// Mirrored at a surface.
    Reflected,
    /// Gone through a surface, or through a whole transparent object.
    Transmitted,
}

/// One summand of a node's value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// `ambient`, `diffuse`, `highlight`, `emission`, `background`, `fog`.
    pub name: &'static str,
    /// The light that it comes from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// What it adds to the node's value.
    pub value: [f64; 3],
    /// The numbers that it was made of.
    #[serde(flatten)]
    pub detail: Map<String, Value>,
}

/// A further ray and what multiplies its value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Child {
    /// Multiplies the value of `ray`, lane by lane.
    pub weight: [f64; 3],
    /// Factors that are in the weight already: what weakens the ray that caused this one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scaled_by: Vec<Value>,
    /// The ray.
    pub ray: Node,
}

/// Where in a scene file something was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SourcePlace {
    /// The file's name.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
}

/// One ray, what it met and what it brought back: `value` is the sum of all terms and of each
/// child's weight times its value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Node {
    /// Why it was cast.
    pub kind: RayKind,
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes: a unit vector.
    pub direction: [f64; 3],
    /// What it hit; nothing for the background.
    pub object: Option<String>,
    /// The line that made the object.
    pub source: Option<SourcePlace>,
    /// The distance; nothing for the background.
    pub t: Option<f64>,
    /// Everything else: point, normal, uv, pattern value, medium, Fresnel, limits.
    #[serde(flatten)]
    pub detail: Map<String, Value>,
    /// The summands of its own.
    pub terms: Vec<Term>,
    /// The rays that it caused.
    pub children: Vec<Child>,
    /// What it brought back.
    pub value: [f64; 3],
}

/// What a ray hit, for a recorder.
pub struct HitRecord {
    /// The object's name.
    pub object: String,
    /// The line that made it.
    pub source: Option<SourcePlace>,
    /// The distance.
    pub t: f64,
    /// Point, normal, uv and so on.
    pub detail: Map<String, Value>,
}

/// Which of the two further rays that a ray can cause.
pub type Slot = u8;

/// Listens to an integrator. Rays are followed in no particular order; a ray begins before those that it
/// causes and ends after them.
pub trait Recorder {
    /// Whether anything is kept. Integrators skip work that only a recorder would see.
    const ENABLED: bool;

    /// A ray that has begun.
    type Id: Copy;

    /// A ray is cast, caused by another one or by the camera.
    fn begin(&mut self, above: Option<(Self::Id, Slot)>, kind: RayKind, ray: &Ray) -> Self::Id;
    /// The ray hit something.
    fn hit(&mut self, id: Self::Id, record: impl FnOnce() -> HitRecord);
    /// A fact about the ray.
    fn note(&mut self, id: Self::Id, name: &'static str, value: impl FnOnce() -> Value);
    /// A fact about the ray that there can be several of: they become a list.
    fn also(&mut self, id: Self::Id, name: &'static str, value: impl FnOnce() -> Value);
    /// A summand of the ray's value.
    fn term(
        &mut self,
        id: Self::Id,
        name: &'static str,
        value: Spectrum,
        detail: impl FnOnce() -> (Option<String>, Value),
    );
    /// Everything that the ray has so far is multiplied, by what `name` says.
    fn scale(&mut self, id: Self::Id, name: &'static str, factor: Spectrum);
    /// The ray is done and brings `value`; who caused it counts it with `weight`.
    fn end(&mut self, id: Self::Id, weight: Spectrum, value: Spectrum);
}

/// The recorder that keeps nothing.
pub struct Silent;

impl Recorder for Silent {
    const ENABLED: bool = false;
    type Id = ();

    fn begin(&mut self, _: Option<((), Slot)>, _: RayKind, _: &Ray) {}
    fn hit(&mut self, (): (), _: impl FnOnce() -> HitRecord) {}
    fn note(&mut self, (): (), _: &'static str, _: impl FnOnce() -> Value) {}
    fn also(&mut self, (): (), _: &'static str, _: impl FnOnce() -> Value) {}
    fn term(
        &mut self,
        (): (),
        _: &'static str,
        _: Spectrum,
        _: impl FnOnce() -> (Option<String>, Value),
    ) {
    }
    fn scale(&mut self, (): (), _: &'static str, _: Spectrum) {}
    fn end(&mut self, (): (), _: Spectrum, _: Spectrum) {}
}

/// A ray that has begun and not ended.
struct Open {
    node: Node,
    above: Option<(usize, Slot)>,
    /// Where the rays that it caused stand among its children.
    slots: Vec<Slot>,
}

/// The recorder that keeps everything of one camera ray.
#[derive(Default)]
pub struct TreeRecorder {
    /// By id; taken out where ended.
    rays: Vec<Option<Open>>,
    root: Option<Node>,
}

impl TreeRecorder {
    /// The tree of the ray that was recorded; `None` where none was finished.
    #[must_use]
    pub fn into_root(self) -> Option<Node> {
        self.root
    }

    fn node(&mut self, id: usize) -> Option<&mut Node> {
        self.rays.get_mut(id)?.as_mut().map(|open| &mut open.node)
    }
}

impl Recorder for TreeRecorder {
    const ENABLED: bool = true;
    type Id = usize;

    fn begin(&mut self, above: Option<(usize, Slot)>, kind: RayKind, ray: &Ray) -> usize {
        let node = Node {
            kind,
            origin: ray.origin.into(),
            direction: ray.direction.into(),
            object: None,
            source: None,
            t: None,
            detail: Map::new(),
            terms: Vec::new(),
            children: Vec::new(),
            value: [0.0; 3],
        };
        self.rays.push(Some(Open { node, above, slots: Vec::new() }));
        self.rays.len() - 1
    }

    fn hit(&mut self, id: usize, record: impl FnOnce() -> HitRecord) {
        if let Some(node) = self.node(id) {
            let record = record();
            node.object = Some(record.object);
            node.source = record.source;
            node.t = Some(record.t);
            node.detail.extend(record.detail);
        }
    }

    fn note(&mut self, id: usize, name: &'static str, value: impl FnOnce() -> Value) {
        if let Some(node) = self.node(id) {
            node.detail.insert(name.into(), value());
        }
    }

    fn also(&mut self, id: usize, name: &'static str, value: impl FnOnce() -> Value) {
        if let Some(node) = self.node(id) {
            append(&mut node.detail, name, value());
        }
    }

    fn term(
        &mut self,
        id: usize,
        name: &'static str,
        value: Spectrum,
        detail: impl FnOnce() -> (Option<String>, Value),
    ) {
        if let Some(node) = self.node(id) {
            let (light, detail) = detail();
            let detail = if let Value::Object(map) = detail { map } else { Map::new() };
            node.terms.push(Term { name, light, value: value.into(), detail });
        }
    }

    fn scale(&mut self, id: usize, name: &'static str, factor: Spectrum) {
        let Some(node) = self.node(id) else { return };
        let told = json!({"by": name, "factor": factor.to_array()});
        for term in &mut node.terms {
            term.value = (Spectrum::from(term.value) * factor).into();
            append(&mut term.detail, "scaled_by", told.clone());
        }
        for child in &mut node.children {
            child.weight = (Spectrum::from(child.weight) * factor).into();
            child.scaled_by.push(told.clone());
        }
    }

    fn end(&mut self, id: usize, weight: Spectrum, value: Spectrum) {
        let Some(mut ended) = self.rays.get_mut(id).and_then(Option::take) else { return };
        ended.node.value = value.into();
        let Some((above, slot)) = ended.above else {
            self.root = Some(ended.node);
            return;
        };
        if let Some(Some(parent)) = self.rays.get_mut(above) {
            // In the order of their slots, whichever ended first.
            let place = parent.slots.partition_point(|&s| s < slot);
            let child = Child { weight: weight.into(), scaled_by: Vec::new(), ray: ended.node };
            parent.slots.insert(place, slot);
            parent.node.children.insert(place, child);
        }
    }
}

/// Adds to a list that may not be there yet.
fn append(map: &mut Map<String, Value>, key: &str, value: Value) {
    if let Value::Array(list) = map.entry(key).or_insert_with(|| json!([])) {
        list.push(value);
    }
}
