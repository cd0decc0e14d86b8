#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Renders this folder's scenes with Cycles, for run.py: a process of its own, since Blender's module likes no company.

Needs Python 3.11 with `pip install bpy`. Reads requests from its standard input, one JSON object a line:

    {"scene": {...}}                                     builds a scene out of what `plain` in run.py makes of it
    {"size": 512, "samples": 64, "seed": 1, "threads": 2, "output": "x.exr"}       renders it

and answers each with a line that begins with "cycles" and has the seconds. Nothing is cut off, guessed or denoised:
no clamping, no adaptive sampling, no blur of glossy caustics, a box for a filter; lights are picked by the light tree.
"""

import json
import sys
import time

import bpy
from mathutils import Matrix, Vector


def node(tree, kind, **values):
    made = tree.nodes.new(kind)
    for name, value in values.items():
        made.inputs[name].default_value = value
    return made


def texture(tree, rows):
    """A picture of single colours, its first row at v = 0, as Mitsuba takes it."""
    height, width = len(rows), len(rows[0])
    image = bpy.data.images.new("texture", width, height, float_buffer=True, is_data=True)
    image.pixels = [c for row in rows for color in row for c in (*color, 1.0)]
    made = node(tree, "ShaderNodeTexImage")
    made.image, made.interpolation = image, "Closest"
    return made.outputs["Color"]


def material(told):
    """A material of what `plain` tells of it: its kind, colour, and more."""
    made = bpy.data.materials.new(told["type"])
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    color = (*told.get("color", (1, 1, 1)), 1.0)
    if "radiance" in told:
        shader = node(tree, "ShaderNodeEmission", Color=(*told["radiance"], 1.0), Strength=1.0)
    elif told["type"] == "diffuse":
        shader = node(tree, "ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0)
        if "texture" in told:
            tree.links.new(texture(tree, told["texture"]), shader.inputs["Color"])
    elif told["type"] == "conductor":
        shader = node(tree, "ShaderNodeBsdfAnisotropic", Color=color, Roughness=told["alpha"] ** 0.5)
        shader.distribution = "GGX"
    else:
        shader = node(tree, "ShaderNodeBsdfGlass", Color=color, Roughness=told["alpha"] ** 0.5, IOR=told["ior"])
        shader.distribution = "GGX"
    tree.links.new(shader.outputs[0], node(tree, "ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def enter(told):
    """Enters a parallelogram or a ball. Cycles knows no exact balls: these have 81,920 triangles, shaded smooth."""
    if told["shape"] == "quad":
        corner, u, v = (Vector(told[k]) for k in ("corner", "u", "v"))
        mesh = bpy.data.meshes.new("quad")
        mesh.from_pydata([corner, corner + u, corner + u + v, corner + v], [], [(0, 1, 2, 3)])
        layer = mesh.uv_layers.new()
        for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
            loop.uv = uv
        thing = bpy.data.objects.new("quad", mesh)
        bpy.context.collection.objects.link(thing)
    else:
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=7, radius=told["radius"], location=told["center"])
        thing = bpy.context.object
        bpy.ops.object.shade_smooth()
    thing.data.materials.append(material(told["material"]))


def sky(below, above):
    """A gradient over the height, y."""
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    place = node(tree, "ShaderNodeTexCoord")
    apart = node(tree, "ShaderNodeSeparateXYZ")
    tree.links.new(place.outputs["Generated"], apart.inputs[0])
    mix = node(tree, "ShaderNodeMix")
    mix.data_type, mix.clamp_factor = "RGBA", True
    colors = [s for s in mix.inputs if s.type == "RGBA"]
    colors[0].default_value, colors[1].default_value = (*below, 1.0), (*above, 1.0)
    tree.links.new(apart.outputs["Y"], mix.inputs[0])
    light = node(tree, "ShaderNodeBackground", Strength=1.0)
    tree.links.new([s for s in mix.outputs if s.type == "RGBA"][0], light.inputs["Color"])
    tree.links.new(light.outputs[0], node(tree, "ShaderNodeOutputWorld").inputs["Surface"])


def camera(told):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "VERTICAL", told["fov"] * 3.141592653589793 / 180
    thing = bpy.data.objects.new("camera", data)
    eye, ahead, up = (Vector(told[k]) for k in ("eye", "ahead", "up"))
    right = ahead.cross(up).normalized()
    up = right.cross(ahead).normalized()
    thing.matrix_world = Matrix((right, up, -ahead.normalized())).transposed().to_4x4()
    thing.matrix_world.translation = eye
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def build(told):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.threads_mode = "FIXED"
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.use_auto_tile = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    bounces = told["bounces"]
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.transmission_bounces = cycles.transparent_max_bounces = bounces
    for thing in told["things"]:
        enter(thing)
    camera(told["camera"])
    if "sky" in told:
        sky(*told["sky"])


def render(told):
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = told["size"]
    scene.render.threads = told["threads"]
    scene.render.filepath = told["output"]
    scene.cycles.samples, scene.cycles.seed = told["samples"], told["seed"]
    bpy.ops.render.render(write_still=True)


for line in sys.stdin:
    request = json.loads(line)
    start = time.perf_counter()
    build(request["scene"]) if "scene" in request else render(request)
    print("cycles", time.perf_counter() - start, flush=True)
