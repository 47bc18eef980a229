# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels say of a material, and the presets."""

import bpy
import numpy as np
import pytest
import translucid
from harness import LENGTH_PER_MFP, SUBSURFACE_METHODS, Nodes, add_camera, addon, combined, messages, new_scene, radians, set_world


class Layout:
    """Stands in for Blender's layouts, and keeps the words."""

    def __init__(self):
        self.words = []

    def label(self, text="", **_):
        self.words.append(text)

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties, f"{owner} has no {name}"
        self.words.append(name)

    def operator(self, name, *_, **__):
        self.words.append(name)

    operator_menu_enum = operator

    def inner(self, *_, **__):
        return self

    column = row = grid_flow = inner


def drawn(panel):
    """The words of a panel, drawn for the active object's material."""
    layout = Layout()

    class Context:
        scene, view_layer, engine = bpy.context.scene, bpy.context.view_layer, "TRANSLUCID"
        material = bpy.context.object.active_material if bpy.context.object else None

    # Blender makes panels of its windows only.
    panel.draw(type("Panel", (), {"layout": layout, "column": panel.column})(), Context)
    return layout.words


def scattering(kind="SubsurfaceScattering", method="RANDOM_WALK", **inputs):
    nodes = Nodes("wax")
    node = nodes.add(kind, **inputs)
    setattr(node, "falloff" if kind == "SubsurfaceScattering" else "subsurface_method", method)
    return nodes.surface(node)


@pytest.mark.parametrize("method", LENGTH_PER_MFP.keys() & SUBSURFACE_METHODS)
def test_facts_are_albedo_and_mean_free_path_in_millimeters(method):
    new_scene()
    material = scattering(method=method, Color=(0.8, 0.5, 0.2), Radius=(1, 0.5, 0.25), Scale=0.3)
    found = addon.panels.facts_of(material, 0.01)
    assert found.surface_albedo == pytest.approx([0.8, 0.5, 0.2])
    # A unit is a centimeter here.
    path = 10 * 0.3 * np.array([1, 0.5, 0.25]) / LENGTH_PER_MFP[method]
    if method == "BURLEY":
        # Christensen & Burley 2015, equation 6
        path *= 1.9 - found.surface_albedo + 3.5 * (found.surface_albedo - 0.8) ** 2
    assert found.mean_free_path_mm == pytest.approx(path)


def test_every_panel_is_drawn():
    new_scene()
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.data.materials.append(scattering(Scale=0.3))
    for panel in addon.panels._CLASSES:
        assert drawn(panel), panel


def test_the_material_panel_shows_the_model_and_its_error():
    scene = new_scene()
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.data.materials.append(scattering(method="BURLEY", Color=(0.8, 0.5, 0.2), Scale=0.3))
    words = drawn(addon.panels.TRANSLUCID_PT_material)
    assert "Subsurface Scattering: normalized-diffusion" in words
    assert words[words.index("A") + 1 :][:3] == ["0.800", "0.500", "0.200"]
    errors = [float(word) for word in words[words.index("Error, %") + 1 :][:3]]
    scene.translucid.model = "normalized-diffusion-refined"
    refined = drawn(addon.panels.TRANSLUCID_PT_material)
    assert all(a < b for a, b in zip([float(w) for w in refined[refined.index("Error, %") + 1 :][:3]], errors, strict=True))
    scene.translucid.model = "random-walk"
    assert "Error, %" not in drawn(addon.panels.TRANSLUCID_PT_material)


def test_presets_give_a_material_its_color_and_lengths():
    scene = new_scene(16, 16, 16)
    scene.unit_settings.scale_length = 0.1
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1)
    nodes = Nodes("preset")
    bpy.context.object.data.materials.append(nodes.surface(nodes.add("BsdfPrincipled")))
    for name in translucid.presets:
        assert bpy.ops.translucid.preset(name=name) == {"FINISHED"}
        preset = translucid.presets[name]
        found = addon.panels.facts_of(bpy.context.object.active_material, 0.1)
        assert found.surface_albedo == pytest.approx(np.array(preset.surface_albedo), abs=1e-6)
        assert found.mean_free_path_mm == pytest.approx(np.broadcast_to(preset.mfp, 3), rel=1e-5)
    add_camera((0, -5, 0), radians(90, 0, 0))
    set_world((1, 1, 1))
    assert combined()[8, 8, :3].min() > 0.1
    assert messages() == []
