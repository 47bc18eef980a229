# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as people make them, by Blender's own operators, beside Cycles."""

import bpy
import numpy as np
from harness import LEGACY_WALK, Nodes, add_camera, add_light, add_plane, combined, matte, messages, new_scene, radians, regions, render_cycles, set_world


def suzanne_with_instances():
    """Suzanne under a subdivision modifier, text, and a field of particles."""
    new_scene(96, 64, 128)
    bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 0.6), rotation=(-0.4, 0, 0.3))
    suzanne = bpy.context.object
    bpy.ops.object.shade_smooth()
    modifier = suzanne.modifiers.new("smooth", "SUBSURF")
    modifier.levels = modifier.render_levels = 2
    nodes = Nodes("wax")
    wax = nodes.add("BsdfPrincipled", Base_Color=(0.8, 0.55, 0.3), Subsurface_Weight=1.0, Subsurface_Scale=0.1, Roughness=0.4)
    # Cycles' walks end in the dark at shells inside others, such as Suzanne's eyes: the new method's would go twelve times as far.
    wax.subsurface_method = LEGACY_WALK
    suzanne.data.materials.append(nodes.surface(wax))
    floor = add_plane(4, z=-0.6, material=matte((0.4, 0.45, 0.5), "floor"))
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.5, location=(0, 0, -50))
    pebble = bpy.context.object
    pebble.data.materials.append(matte((0.6, 0.2, 0.1), "pebble"))
    system = floor.modifiers.new("pebbles", "PARTICLE_SYSTEM").particle_system.settings
    system.type, system.count, system.use_advanced_hair = "HAIR", 60, True
    system.render_type, system.instance_object, system.particle_size = "OBJECT", pebble, 0.2
    system.hair_length = 1.0
    bpy.ops.object.text_add(location=(-1.9, -1.2, -0.5), rotation=radians(75, 0, 0))
    text = bpy.context.object
    text.data.body, text.data.extrude = "wax", 0.05
    text.data.materials.append(matte((0.1, 0.3, 0.6), "ink"))
    add_camera((0, -6, 1.8), radians(78, 0, 0), lens=42)
    add_light("AREA", (3, -3, 4), radians(45, 0, 45), energy=400.0, size=1.5)
    set_world((0.2, 0.22, 0.25))


def cloth_over_a_ball():
    """A cloth that has fallen on a ball."""
    new_scene(96, 64, 128)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7, location=(0, 0, 0))
    ball = bpy.context.object
    ball.modifiers.new("collision", "COLLISION")
    nodes = Nodes("milk")
    ball.data.materials.append(nodes.surface(nodes.add("SubsurfaceScattering", Color=(0.9, 0.9, 0.85), Scale=0.1)))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=24, y_subdivisions=24, size=2.4, location=(0.15, 0, 0.9))
    cloth = bpy.context.object
    bpy.ops.object.shade_smooth()
    cloth.modifiers.new("cloth", "CLOTH").settings.quality = 3
    thick = cloth.modifiers.new("thick", "SOLIDIFY")
    thick.thickness = 0.02
    cloth.data.materials.append(matte((0.7, 0.2, 0.2), "cloth"))
    add_plane(6, z=-0.8, material=matte((0.5, 0.5, 0.5), "floor"))
    for frame in range(1, 16):
        bpy.context.scene.frame_set(frame)
    add_camera((0, -5, 2.2), radians(68, 0, 0), lens=45)
    add_light("SPOT", (2, -2, 4), radians(35, 0, 45), energy=900.0, spot_size=1.2, shadow_soft_size=0.2)
    set_world((0.3, 0.3, 0.35))


def beside_cycles():
    ours, theirs = combined()[..., :3], render_cycles(128)[..., :3]
    ratio = ours.mean(axis=(0, 1)) / theirs.mean(axis=(0, 1))
    parts = regions(ours) / regions(theirs)
    print(f"ratio {ratio.round(4)}, regions {parts.min():.4f} to {parts.max():.4f}")
    return ratio, parts


def test_suzanne_with_instances():
    suzanne_with_instances()
    ratio, parts = beside_cycles()
    assert messages() == []
    assert np.abs(ratio - 1).max() < 0.015
    assert np.abs(parts - 1).max() < 0.06


def test_cloth_over_a_ball():
    cloth_over_a_ball()
    ratio, parts = beside_cycles()
    assert messages() == []
    assert np.abs(ratio - 1).max() < 0.015
    assert np.abs(parts - 1).max() < 0.06
