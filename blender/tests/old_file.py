# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a file of the Blender that runs, for the tests of a later one: a ball of the default scattering in a white world."""

import sys

import bpy
from harness import Nodes, add_camera, new_scene, radians, render_cycles, set_world

new_scene(48, 48, 256)
bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
bpy.ops.object.shade_smooth()
nodes = Nodes("wax")
material = nodes.surface(nodes.add("BsdfPrincipled", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=1.0, Subsurface_Scale=3.0))
bpy.context.object.data.materials.append(material)
add_camera((0, -4, 0), radians(90, 0, 0))
set_world((1, 1, 1))
bpy.context.scene["light_of_cycles"] = float(render_cycles(256)[..., :3].sum())
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
