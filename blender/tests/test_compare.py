# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare leaves the pictures of two models, and their difference."""

import bpy
import numpy as np
import pytest
from harness import Nodes, add_camera, add_light, add_mesh, combined, new_scene, radians, set_world

SAMPLES = 16


def thin_wax():
    """A plate lit from behind, through which Cycles' disks let more light than areas do."""
    scene = new_scene(48, 32, SAMPLES)
    nodes = Nodes("wax")
    node = nodes.add("SubsurfaceScattering", Color=(0.8, 0.6, 0.4), Radius=(1, 0.5, 0.3), Scale=1.0)
    node.falloff = "BURLEY"
    bpy.ops.mesh.primitive_cube_add(size=2, scale=(1, 0.05, 1), rotation=radians(0, 0, 20))
    bpy.context.object.data.materials.append(nodes.surface(node))
    add_mesh("shelf", [(-2, -2, -1), (2, -2, -1), (2, 2, -1), (-2, 2, -1)], [(0, 1, 2, 3)])
    add_camera((0, -5, 0), radians(90, 0, 0))
    add_light("AREA", (0, 4, 1), radians(-90, 0, 0), energy=300.0, size=1.0)
    set_world((0.05, 0.05, 0.05))
    scene.translucid.compare_samples = SAMPLES
    return scene


def image(name):
    """Pixels of one of Blender's images, the upper row first."""
    found = bpy.data.images[f"translucid: {name}"]
    return np.array(found.pixels[:]).reshape(found.size[1], found.size[0], 4)[::-1]


def rendered_with(model):
    bpy.context.scene.translucid.model = model
    picture = combined()[..., :3]
    bpy.context.scene.translucid.model = "NODE"
    return picture


@pytest.mark.parametrize("other", ["random-walk", "normalized-diffusion", "none"])
def test_compare_shows_what_renderings_with_each_model_show(other):
    scene = thin_wax()
    scene.translucid.compare_model = other
    assert bpy.ops.translucid.compare() == {"FINISHED"}
    own, beside = rendered_with("NODE"), rendered_with(other)
    assert np.abs(own - beside).mean() > 0.01 * own.mean()
    assert np.allclose(image("As the nodes say")[..., :3], own, rtol=1e-5, atol=1e-6)
    assert np.allclose(image(other)[..., :3], beside, rtol=1e-5, atol=1e-6)
    # Rec. 709
    change = (beside - own) @ [0.2126, 0.7152, 0.0722] / (own @ [0.2126, 0.7152, 0.0722]).mean()
    difference = image("difference")
    assert np.allclose(difference[..., 0] - difference[..., 2], change, atol=1e-3)
    assert (difference[..., 0] * difference[..., 2]).max() == 0 and difference[..., 1].max() == 0


def test_compare_renders_the_region():
    scene = thin_wax()
    assert bpy.ops.translucid.compare() == {"FINISHED"}
    whole = image("As the nodes say")
    scene.render.use_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.25, 0.75
    scene.render.border_min_y, scene.render.border_max_y = 0.5, 1.0
    assert bpy.ops.translucid.compare() == {"FINISHED"}
    assert np.allclose(image("As the nodes say"), whole[:16, 12:36], rtol=1e-5, atol=1e-6)


def test_compare_of_a_model_with_itself_is_black():
    scene = thin_wax()
    scene.translucid.compare_model = "NODE"
    assert bpy.ops.translucid.compare() == {"FINISHED"}
    assert image("difference")[..., :3].max() == 0
    assert np.array_equal(image("As the nodes say"), image("As the nodes say again"))
