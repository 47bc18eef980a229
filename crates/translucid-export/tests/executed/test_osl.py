"""OSL, by Cycles: a picture with a square for each point, whose emission is the result."""


import re

import numpy as np
import pytest
from points import CONFIGURATIONS, functions, text

import bpy
import _cycles  # noqa: E402 (comes with bpy)

SIDE = 320
MOST_ARGUMENTS = 12


@pytest.fixture(scope="module")
def squares():
    """A scene of SIDE × SIDE squares, each one pixel of the picture, with attributes for arguments."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    x, y = np.meshgrid(np.arange(SIDE + 1), np.arange(SIDE + 1))
    corners = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    first = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).ravel()
    faces = first[:, None] + np.array([0, 1, SIDE + 2, SIDE + 1])
    mesh = bpy.data.meshes.new("squares")
    mesh.from_pydata(corners.tolist(), [], faces.tolist())
    for i in range(MOST_ARGUMENTS):
        mesh.attributes.new(f"argument_{i}", "FLOAT", "FACE")
    scene.collection.objects.link(bpy.data.objects.new("squares", mesh))

    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", SIDE
    view = bpy.data.objects.new("camera", camera)
    view.location = (SIDE / 2, SIDE / 2, 10)
    scene.collection.objects.link(view)
    scene.camera = view

    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.render.filter_size = 0.01
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.device = "CPU"
    scene.cycles.shading_system = True
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.max_bounces = 0
    mesh.materials.append(bpy.data.materials.new("script"))
    return scene, mesh


def shader(configuration, function):
    """A shader whose emission is each result, its positive part in red and its negative one in green."""
    # Not by their own names: u is a variable of every shader
    inputs = ", ".join(f"float of_{name} = 0.0" for name in function.arguments)
    outputs = ", ".join(f"output closure color result_{i} = 0" for i in range(len(function.outputs)))
    results = []
    for i, output in enumerate(function.outputs):
        call = re.sub(rf"\b({'|'.join(function.arguments)})\b", r"of_\1", function.calls["osl"])
        if output:
            kind = {"oblique_sample": "ObliqueOffset", "probe_segment": "Segment"}[function.name]
            results.append(f"    {kind} all_{i} = {call};\n    float value_{i} = all_{i}.{output};\n")
        else:
            results.append(f"    float value_{i} = {call};\n")
        color = f"color(max(value_{i}, 0.0), max(-value_{i}, 0.0), 0.0)"
        results.append(f"    result_{i} = {color} * emission();\n")
    return f"{text(configuration, 'osl')}\nshader each({inputs}, {outputs}) {{\n{''.join(results)}}}\n"


def emission(tree, script, name):
    """The socket of a closure whose color has a script's number, its positive part in red and its negative one in green."""
    result = script.outputs.new("NodeSocketFloat", name)
    color, closure = tree.nodes.new("ShaderNodeCombineColor"), tree.nodes.new("ShaderNodeEmission")
    for channel, sign in [("Red", 1.0), ("Green", -1.0)]:
        signed, part = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
        signed.operation, part.operation = "MULTIPLY", "MAXIMUM"
        signed.inputs[1].default_value, part.inputs[1].default_value = sign, 0.0
        tree.links.new(result, signed.inputs[0])
        tree.links.new(signed.outputs[0], part.inputs[0])
        tree.links.new(part.outputs[0], color.inputs[channel])
    tree.links.new(color.outputs[0], closure.inputs["Color"])
    return closure.outputs[0]


def render(squares, source, function, directory, names, socket_of):
    """Results of a shader for all points: `names` are those of its inputs, `socket_of` gives that of each output."""
    scene, mesh = squares
    path, compiled = directory / "each.osl", directory / "each.oso"
    path.write_text(source)
    assert _cycles.osl_compile(str(path), str(compiled)), source
    tree = mesh.materials[0].node_tree
    tree.nodes.clear()
    script = tree.nodes.new("ShaderNodeScript")
    script.mode = "INTERNAL"
    script.bytecode = compiled.read_text()
    script.bytecode_hash = str(hash(script.bytecode))
    for i, name in enumerate(names):
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = f"argument_{i}"
        socket = script.inputs.new("NodeSocketFloat", name)
        tree.links.new(attribute.outputs["Fac"], socket)
    inputs = function.inputs
    padded = np.zeros((SIDE * SIDE, inputs.shape[1]), np.float32)
    padded[: len(inputs)] = inputs
    padded[len(inputs) :] = inputs[0]
    for i in range(inputs.shape[1]):
        mesh.attributes[f"argument_{i}"].data.foreach_set("value", padded[:, i].copy())
    mesh.update()
    material_output = tree.nodes.new("ShaderNodeOutputMaterial")
    sockets = [socket_of(tree, script, i) for i in range(len(function.outputs))]
    columns = []
    for socket in sockets:
        tree.links.new(socket, material_output.inputs["Surface"])
        scene.render.filepath = str(directory / "picture.exr")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        picture.colorspace_settings.name = "Non-Color"
        pixels = np.empty(4 * SIDE * SIDE, np.float32)
        picture.pixels.foreach_get(pixels)
        bpy.data.images.remove(picture)
        rgba = pixels.reshape(-1, 4)[: len(inputs)].astype(np.float64)
        columns.append(rgba[:, 0] - rgba[:, 1])
    return np.stack(columns, axis=1)


# What does not depend on the configuration runs once: a picture takes a second
DEPENDING = ("refined", "oblique", "inversion", "exponentials", "gaussians")


def to_run(configuration):
    """Functions that are to run in a configuration."""
    return [f for f in functions(configuration) if configuration == CONFIGURATIONS[0] or f.name.startswith(DEPENDING)]


@pytest.mark.parametrize("configuration", CONFIGURATIONS)
def test_osl_agrees_with_double_precision(squares, configuration, tmp_path):
    faults = []
    for function in to_run(configuration):
        names = [f"of_{name}" for name in function.arguments]
        closure = lambda tree, script, i: script.outputs.new("NodeSocketShader", f"result_{i}")
        results = render(squares, shader(configuration, function), function, tmp_path, names, closure)
        faults += function.fault(results, "OSL", "osl")
    assert not faults
