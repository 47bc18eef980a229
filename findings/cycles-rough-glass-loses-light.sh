#!/usr/bin/env bash
# Clear rough glass in a white world loses light in Cycles by the limit of *glossy* bounces alone (bpy 5.2.3).
#
# Expectation: a white Glass BSDF of the distribution Multiscatter GGX, which keeps all energy, is as bright as the white
# world around it; of the bounces in a ball nearly all are transmissions, which have a limit of their own (12).
# Seen: at a roughness of 0.6 the ball is at 0.964 with the 4 glossy bounces of a new scene and at 0.989 with 12; at a
# roughness of 0 it is at 1.000 with either.
set -euo pipefail
version=5.2.3
# bpy is made for one version of Python each; a shim of pyenv may be there and not run.
for python in python3.13 "$HOME"/.pyenv/versions/3.13.*/bin/python; do
    if "$python" -c "import venv, ensurepip" 2>/dev/null; then break; fi
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "bpy==$version"
cat >"$folder/look.py" <<'PYTHON'
import math
import os
import sys

import bpy
import numpy as np

print("bpy", bpy.app.version_string)


def brightness(roughness, glossy_bounces):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = 24
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", 256, 1
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.blur_glossy = cycles.sample_clamp_indirect = 0.0
    cycles.glossy_bounces = glossy_bounces if glossy_bounces else cycles.glossy_bounces
    bpy.ops.mesh.primitive_uv_sphere_add(segments=160, ring_count=80, radius=1)
    bpy.ops.object.shade_smooth()
    material = bpy.data.materials.new("glass")
    tree = material.node_tree
    tree.nodes.clear()
    glass = tree.nodes.new("ShaderNodeBsdfGlass")
    glass.inputs["Color"].default_value = (1, 1, 1, 1)
    glass.inputs["Roughness"].default_value = roughness
    tree.links.new(glass.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    bpy.context.object.data.materials.append(material)
    scene.world = bpy.data.worlds.new("white")
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 1.2
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location, scene.camera.rotation_euler = (0, -6, 0), (math.pi / 2, 0, 0)
    scene.collection.objects.link(scene.camera)
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = os.path.join(os.path.dirname(__file__), "ball.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    found = float(np.array(image.pixels[:]).reshape(-1, 4)[:, :3].mean())
    print(f"{glass.distribution}, roughness {roughness}, {cycles.glossy_bounces} glossy bounces: {found:.4f}")
    return found


seen = {(0.0, None): 1.0, (0.6, None): 0.964, (0.6, 12): 0.989}
sys.exit(any(abs(brightness(*settings) - value) > 0.003 for settings, value in seen.items()))
PYTHON
"$folder/venv/bin/python" "$folder/look.py" | grep -v Saved
