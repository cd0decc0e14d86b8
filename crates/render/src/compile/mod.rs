// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a description to a scene. [`compile`] is the page to read: it goes through everything in order.

mod immersion;
mod place;
mod settings;

use std::sync::Arc;

use dioptric_scene::loader::Loader;
use dioptric_scene::{Args, Category, Description, Diagnostic, NodeId, Value};

use crate::build::Builder;
use crate::camera::AnyCamera;
use crate::integrator::path::arrive::Plains;
use crate::light::AnyLight;
use crate::light::directional::Directional;
use crate::manifold::Casters;
use crate::scene::{Insides, PlacedLight, Scene};
use crate::setting::background::Background;
use crate::setting::develop;
use crate::setting::medium::Surroundings;
use crate::setting::render::{Integrator, MAX_PIXELS, RenderSettings};
use crate::source::Sources;

/// What a program may ask of a scene beyond its text.
#[derive(Clone, Debug)]
pub struct Options {
    /// Arguments on top of those of the scene's `render(...)`.
    pub render: Vec<(String, Value)>,
    /// Arguments on top of those of the scene's `develop(...)`.
    pub develop: Vec<(String, Value)>,
    /// The most pixels that a picture may have.
    pub max_pixels: u64,
    /// Use the camera with this name instead of the first one.
    pub camera: Option<String>,
    /// The most objects that may be made, instances' insides counted once.
    pub max_objects: usize,
    /// The most bytes that the points and triangles of all mesh files may take: 4 GiB.
    pub max_mesh_bytes: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            render: Vec::new(),
            develop: Vec::new(),
            max_pixels: MAX_PIXELS,
            camera: None,
            max_objects: 50_000_000,
            max_mesh_bytes: 4 << 30,
        }
    }
}

/// Compiles a description; also returns warnings.
///
/// # Errors
/// Everything that is wrong with it, as far as one error does not hide another.
pub fn compile(
    description: &Arc<Description>,
    loader: &dyn Loader,
    options: &Options,
) -> Result<(Scene, Vec<Diagnostic>), Vec<Diagnostic>> {
    let d: &Description = description;
    let mut errors = Vec::new();
    let mut check = |problem: Diagnostic| errors.push(problem);

    // How the file is to be read comes first: every colour and position depends on it.
    let (reading, root) = settings::root(d).map_err(|e| vec![e])?;
    let mut builder = Builder::new(d, reading, loader);
    builder.mesh_bytes_left = options.max_mesh_bytes;
    let settings = RenderSettings::from_scene(d, &borrowed(&options.render), options.max_pixels)
        .map_err(|e| vec![e])?;
    let develop =
        develop::from_scene(d, &borrowed(&options.develop)).map_err(&mut check).unwrap_or_default();
    let ambient = settings::ambient(d, &mut builder).map_err(&mut check).unwrap_or_default();
    let background = settings::background(d, &mut builder, &root)
        .map_err(&mut check)
        .unwrap_or(Background::BLACK);

    let fog = settings::fog(d, &builder, &root).map_err(&mut check).unwrap_or_default();
    let surroundings =
        settings::surroundings(d, &root).map_err(&mut check).unwrap_or(Surroundings::EMPTY);
    let camera = camera(d, &root, &settings, options).map_err(&mut check).ok();
    let mut lights = Vec::new();
    for id in roots_of(d, Category::Light) {
        match AnyLight::from_args(&Args::new(d, id), &mut builder, &root) {
            Ok(light) => lights.push(PlacedLight { light, node: id }),
            Err(e) => check(e),
        }
    }
    // The sun of a sky comes last, so that the lights of the file keep their numbers.
    if let Some((towards, strength)) = background.sun()
        && let Some(node) = d.roots_of("background").last()
    {
        let light = AnyLight::Directional(Directional::sun(towards, strength));
        lights.push(PlacedLight { light, node });
    }
    let mut places = place::Places::new(d, &mut builder, options.max_objects);
    for id in roots_of(d, Category::Shape) {
        places.add_root(id, *root.transform().to_world());
    }
    let placed = places.finish(&mut errors);
    let (Some(camera), true) = (camera, errors.is_empty()) else {
        return Err(errors);
    };
    let mut scene = Scene {
        description: description.clone(),
        world: placed.world,
        objects: placed.objects,
        has_holes: placed.materials.iter().any(|m| m.holes),
        all_opaque: placed.materials.iter().all(|m| m.opaque && !m.holes),
        materials: placed.materials,
        leaf_materials: placed.leaf_materials,
        instances: placed.instances,
        lights,
        sources: Sources::default(),
        guide: None,
        plains: Plains::default(),
        casters: Casters::default(),
        ambient,
        background,
        fog,
        surroundings,
        insides: Insides::default(),
        camera,
        around_camera: Vec::new(),
        root,
        settings,
        develop,
    };
    if scene.settings.integrator == Integrator::Path {
        scene.insides = Insides::of(&scene.materials, &scene.surroundings);
        scene.surroundings = scene.surroundings.for_paths(&scene.root);
    }
    scene.around_camera = immersion::around_camera(&scene);
    if scene.settings.integrator == Integrator::Path {
        scene.sources = Sources::new(&scene);
        scene.plains = Plains::of(&scene);
        scene.casters = Casters::new(&scene);
        if scene.settings.caustics > 0 {
            scene.guide = crate::integrator::path::photons::guide(&scene, scene.settings.caustics);
        }
    }
    Ok((scene, Vec::new()))
}

fn borrowed(args: &[(String, Value)]) -> Vec<(&str, Value)> {
    args.iter().map(|(name, value)| (name.as_str(), value.clone())).collect()
}

fn roots_of(d: &Description, category: Category) -> impl Iterator<Item = NodeId> + '_ {
    d.roots.iter().copied().filter(move |&id| d.node(id).schema.category == category)
}

/// The camera that was asked for, else the first.
fn camera(
    d: &Description,
    root: &crate::setting::root::Root,
    settings: &RenderSettings,
    options: &Options,
) -> Result<AnyCamera, Diagnostic> {
    let cameras: Vec<NodeId> = roots_of(d, Category::Camera).collect();
    let chosen = match &options.camera {
        None => cameras.first().copied(),
        Some(name) => {
            let names: Vec<&str> =
                cameras.iter().filter_map(|&id| d.node(id).name.as_deref()).collect();
            let found =
                cameras.iter().copied().find(|&id| d.node(id).name.as_deref() == Some(name));
            if found.is_none() {
                let help = match dioptric_scene::suggest::nearest(name, names.iter().copied()) {
                    Some(near) => format!("did you mean \"{near}\"?"),
                    None if names.is_empty() => "no camera of this scene has a name".into(),
                    None => format!("its cameras are: {}", names.join(", ")),
                };
                return Err(Diagnostic::error(
                    "unknown-camera",
                    format!("there is no camera \"{name}\""),
                )
                .help(help));
            }
            found
        }
    };
    let Some(id) = chosen else {
        return Err(Diagnostic::error("no-camera", "the scene has no camera")
            .help("add a line such as camera(eye = (0, 1, 5), look_at = (0, 0, 0))"));
    };
    AnyCamera::from_args(&Args::new(d, id), root, settings.aspect())
}
