"""Blender Cycles as a worker: reads one JSON command a line, answers one JSON line.

    {"do": "render", "scene": "head.toml", "mesh": "head.ply", "method": "BURLEY", "size": 512, "spp": 16, "seed": 1,
     "out": "a.npy"}        renders and answers {"cpu": seconds of CPU of the render call}
    {"do": "edge", "albedo": [r, g, b], "mfp": [r, g, b], "spp": 256, "out": "a.npy"}
                            half of a plane is lit from the front: rows across the edge, for the profile's width

Images are float32 arrays of rows from the top, RGBA. Needs the package bpy.
The file must not be called cycles.py: bpy would take it for its own module of that name.
"""

import json
import math
import os
import struct
import sys
import tempfile
import tomllib

# Blender prints to stdout: keep that free for answers.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402


def read_ply(path):
    """Positions, normals and triangles of a binary PLY mesh with three-cornered faces."""
    with open(path, "rb") as file:
        header = b""
        while not header.endswith(b"end_header\n"):
            header += file.readline()
        counts, properties, element = {}, [], None
        for line in header.decode().splitlines():
            words = line.split()
            if words[0] == "element":
                element = words[1]
                counts[element] = int(words[2])
            elif words[0] == "property" and element == "vertex":
                properties.append((words[2], {"float": "<f4", "uchar": "u1", "double": "<f8"}[words[1]]))
        vertices = np.frombuffer(file.read(counts["vertex"] * np.dtype(properties).itemsize), dtype=properties)
        faces = np.frombuffer(file.read(), dtype=[("n", "u1"), ("v", "<i4", 3)], count=counts["face"])
    assert (faces["n"] == 3).all()
    stack = lambda names: np.stack([vertices[name] for name in names], axis=1).astype(np.float32)
    normals = stack(["nx", "ny", "nz"]) if "nx" in vertices.dtype.names else None
    return stack(["x", "y", "z"]), normals, faces["v"]


def add_mesh(name, positions, normals, triangles, material):
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    if normals is not None:
        mesh.normals_split_custom_set_from_vertices([tuple(normal) for normal in normals])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def shader(name, kind):
    """A material whose surface is one node of this kind; returns both."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(kind)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material, node


def scaling_diffuse(albedo):
    """Burley's s for diffuse transmission and the mean free path (Christensen & Burley 2015)."""
    return 1.9 - albedo + 3.5 * (albedo - 0.8) ** 2


def subsurface(name, albedo, mfp, method):
    material, node = shader(name, "ShaderNodeSubsurfaceScattering")
    is_walk_of_52 = method == "RANDOM_WALK" and bpy.app.version >= (5, 2)
    node.falloff = "RANDOM_WALK_LEGACY" if is_walk_of_52 else method
    node.inputs["Color"].default_value = (*albedo, 1.0)
    node.inputs["Scale"].default_value = 1.0
    # Cycles' profile has the width radius / 4π, whatever the albedo.
    widths = [4.0 * math.pi * l / scaling_diffuse(a) for a, l in zip(albedo, mfp)]
    # Its walk before Blender 5.2, Legacy since, has the mean free path radius / 4π; so small an index refracts nothing.
    node.inputs["Radius"].default_value = widths if method == "BURLEY" else [4.0 * math.pi * l for l in mfp]
    if method != "BURLEY":
        node.inputs["IOR"].default_value, node.inputs["Roughness"].default_value = 1.01, 1.0
    return material


def looking(origin, target, up):
    """World matrix of a camera or light that looks from origin to target along its −z."""
    origin, target = Vector(origin), Vector(target)
    back = (origin - target).normalized()
    right = Vector(up).cross(back).normalized()
    above = back.cross(right)
    matrix = Matrix((right, above, back)).transposed().to_4x4()
    matrix.translation = origin
    return matrix


def build(description, mesh, method):
    """The scene file of a mesh, of one light, and of a square floor in y = 0 or none."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    body = description["material"][0]
    material = subsurface(body["name"], body["subsurface_color"], body["subsurface_radius_scale"], method)
    add_mesh(body["name"], *read_ply(mesh), material)
    for floor in description["object"][1:]:
        half = floor["width"] / 2
        corners = [[-half, 0, half], [half, 0, half], [half, 0, -half], [-half, 0, -half]]
        material, node = shader("floor", "ShaderNodeBsdfDiffuse")
        node.inputs["Color"].default_value = (*description["material"][1]["base_color"], 1.0)
        triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
        add_mesh("floor", np.array(corners, dtype=np.float32), None, triangles, material)
    for number, area in enumerate(description["light"]):
        light = bpy.data.lights.new(f"area{number}", "AREA")
        light.shape = "RECTANGLE"
        light.size, light.size_y = area["size"]
        # Blender states the power; a Lambertian emitter of radiance L has L π A.
        power = max(area["radiance"]) * math.pi * area["size"][0] * area["size"][1]
        light.energy = power
        light.color = [value / max(area["radiance"]) for value in area["radiance"]]
        owner = bpy.data.objects.new(light.name, light)
        owner.matrix_world = looking(area["center"], area["target"], [0, 1, 0])
        owner.visible_camera = False
        scene.collection.objects.link(owner)
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*description["environment"]["radiance"], 1.0)
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "HORIZONTAL"
    camera.angle = math.radians(description["camera"]["fov"])
    camera.clip_start, camera.clip_end = 1.0, 1e5
    owner = bpy.data.objects.new("camera", camera)
    owner.matrix_world = looking(*(description["camera"][key] for key in ("position", "target", "up")))
    scene.collection.objects.link(owner)
    scene.camera = owner
    configure(scene)


def configure(scene):
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = True
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    scene.render.use_persistent_data = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.image_settings.exr_codec = "ZIP"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.max_bounces = 12
    cycles.diffuse_bounces = 4
    cycles.caustics_reflective = cycles.caustics_refractive = False
    # Unbiased: nothing clamped, no light left out.
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0


def pixels_of(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    values = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(height, width, 4)[::-1]


def write_image(out):
    """Renders the scene at hand to an array file; seconds of CPU."""
    scene = bpy.context.scene
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "image.exr")
        before = os.times()
        bpy.ops.render.render(write_still=True)
        after = os.times()
        np.save(out, pixels_of(scene.render.filepath))
    return after.user + after.system - before.user - before.system


class Worker:
    """Keeps the last scene, so that only rendering is timed."""

    def __init__(self):
        self.built = None

    def render(self, command):
        key = (command["scene"], command["method"])
        if self.built != key:
            with open(command["scene"], "rb") as file:
                build(tomllib.load(file), command["mesh"], command["method"])
            self.built = key
        scene = bpy.context.scene
        scene.render.resolution_x = scene.render.resolution_y = command["size"]
        scene.render.resolution_percentage = 100
        scene.cycles.samples = command["spp"]
        scene.cycles.seed = command["seed"]
        return {"cpu": write_image(command["out"])}

    def edge(self, command):
        self.built = None
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
        triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
        material = subsurface("plane", command["albedo"], command["mfp"], "BURLEY")
        add_mesh("plane", square * 200, None, triangles, material)
        black, node = shader("black", "ShaderNodeBsdfDiffuse")
        node.inputs["Color"].default_value = (0, 0, 0, 1)
        add_mesh("blind", square * 200 + np.array([-200, 0, 50], dtype=np.float32), None, triangles, black)
        bpy.data.objects["blind"].visible_camera = False
        sun = bpy.data.lights.new("sun", "SUN")
        sun.energy, sun.angle = math.pi, 0.0
        scene.collection.objects.link(bpy.data.objects.new("sun", sun))
        camera = bpy.data.cameras.new("camera")
        camera.type, camera.ortho_scale = "ORTHO", command["width"]
        owner = bpy.data.objects.new("camera", camera)
        owner.location = (0, 0, 100)
        scene.collection.objects.link(owner)
        scene.camera = owner
        configure(scene)
        scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 1
        scene.render.resolution_x, scene.render.resolution_y = command["columns"], 16
        scene.render.resolution_percentage = 100
        scene.cycles.samples = command["spp"]
        return {"cpu": write_image(command["out"])}


def main():
    worker = Worker()
    print(json.dumps({"version": bpy.app.version_string}), file=answers, flush=True)
    for line in sys.stdin:
        command = json.loads(line)
        answer = {"render": worker.render, "edge": worker.edge}[command["do"]](command)
        print(json.dumps(answer), file=answers, flush=True)


main()
