# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes made in Python, rendered by Blender with one engine or the other, and read back as arrays."""

import importlib.util
import math
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import translucid

ADDON = Path(__file__).parents[1] / "translucid"


def load_addon():
    """The extension's modules under a name of their own: the module of the wheel has the same."""
    name = "translucid_extension"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, ADDON / "__init__.py", submodule_search_locations=[str(ADDON)])
        module = sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        module.register()
    return sys.modules[name]


addon = load_addon()


def new_scene(width=64, height=48, samples=64, transparent=False):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = transparent
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    scene.render.engine = "TRANSLUCID"
    scene.translucid.samples = samples
    return scene


def link(name, data):
    owner = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(owner)
    return owner


def add_camera(location, rotation=(0, 0, 0), **settings):
    camera = bpy.data.cameras.new("camera")
    for key, value in settings.items():
        setattr(camera, key, value)
    owner = link("camera", camera)
    owner.location, owner.rotation_euler = location, rotation
    bpy.context.scene.camera = owner
    return owner


def add_light(kind, location=(0, 0, 0), rotation=(0, 0, 0), **settings):
    light = bpy.data.lights.new("lamp", kind)
    for key, value in settings.items():
        setattr(light, key, value)
    owner = link("lamp", light)
    owner.location, owner.rotation_euler = location, rotation
    # The lamp's light is measured, not its picture.
    owner.visible_camera = False
    return owner


def add_mesh(name, vertices, faces, material=None, uv=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    if uv is not None:
        layer = mesh.uv_layers.new(name="UVMap")
        layer.uv.foreach_set("vector", np.array(uv, dtype=np.float32).ravel())
    if material is not None:
        mesh.materials.append(material)
    return link(name, mesh)


def add_plane(half=5.0, z=0.0, material=None):
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    return add_mesh("plane", corners, [(0, 1, 2, 3)], material, uv=[(0, 0), (1, 0), (1, 1), (0, 1)])


def set_world(color, strength=1.0):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    if not world.node_tree:
        world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1)
    background.inputs["Strength"].default_value = strength
    return world


class Nodes:
    """A material and its node tree, empty but for the output."""

    def __init__(self, name="material"):
        self.material = bpy.data.materials.new(name)
        if not self.material.node_tree:
            self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new("ShaderNodeOutputMaterial")

    def add(self, kind, **inputs):
        """A node whose inputs have these values, or are linked to these sockets; `_` stands for a space."""
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for key, value in inputs.items():
            socket = node.inputs[int(key[1:])] if key[0] == "i" and key[1:].isdigit() else node.inputs[key.replace("_", " ")]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = (*value, 1) if socket.type == "RGBA" and len(value) == 3 else value
        return node

    def surface(self, node):
        self.tree.links.new(node.outputs[0], self.output.inputs["Surface"])
        return self.material


def matte(color=(0.5, 0.5, 0.5), name="matte"):
    nodes = Nodes(name)
    return nodes.surface(nodes.add("BsdfDiffuse", Color=color))


# Methods of the Blender that runs, and the factor from a mean free path to a length of each walk that has one.
SUBSURFACE_METHODS = tuple(
    item.identifier for item in bpy.types.ShaderNodeSubsurfaceScattering.bl_rna.properties["falloff"].enum_items
)
# The walk of files before Blender 5.2, and its factor 4π.
HAS_LEGACY_WALK = "RANDOM_WALK_LEGACY" in SUBSURFACE_METHODS
LEGACY_WALK = "RANDOM_WALK_LEGACY" if HAS_LEGACY_WALK else "RANDOM_WALK"
LENGTH_PER_MFP = {"BURLEY": 4 * math.pi, "RANDOM_WALK": 1 if HAS_LEGACY_WALK else 4 * math.pi, "RANDOM_WALK_LEGACY": 4 * math.pi}


def messages():
    return list(addon.engine.last_messages)


def render(layers=("Combined",)):
    """The layers of a rendering by their names, the upper row first; `Combined` in RGBA."""
    with tempfile.TemporaryDirectory() as folder:
        return translucid.read_exr(write(Path(folder) / "picture.exr"))


def write(path):
    """Renders into a file of all layers, and returns its path."""
    scene = bpy.context.scene
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth, settings.exr_codec = "32", "ZIP"
    scene.render.filepath, scene.render.use_file_extension = str(path), False
    bpy.ops.render.render(write_still=True)
    return path


def compositor(make):
    """Has Blender's compositor make the picture from the socket that `make` returns for a new tree's nodes and links."""
    tree = bpy.data.node_groups.new("compositing", "CompositorNodeTree")
    bpy.context.scene.compositing_node_group = tree
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    tree.links.new(make(tree.nodes, tree.links), tree.nodes.new("NodeGroupOutput").inputs[0])


def combined():
    found = render()
    return next(value for name, value in found.items() if "Combined" in name)


def render_cycles(samples, seed=1, take=None):
    """What Cycles renders, unbiased: nothing clamped, nothing left out. `take` renders, or it is the picture alone."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", scene.render.filter_size
    cycles.max_bounces, cycles.diffuse_bounces = 12, 4
    cycles.caustics_reflective = cycles.caustics_refractive = scene.translucid.use_caustics
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0.0
    try:
        return (take or combined)()
    finally:
        scene.render.engine = "TRANSLUCID"


def regions(picture, across=4, down=4):
    """Means over a grid of regions, (down, across, channels)."""
    height, width, channels = picture.shape
    cut = picture[: height // down * down, : width // across * across]
    return cut.reshape(down, height // down, across, width // across, channels).mean(axis=(1, 3))


def radians(*degrees):
    return tuple(math.radians(x) for x in degrees)
