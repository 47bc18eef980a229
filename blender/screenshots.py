# SPDX-License-Identifier: GPL-3.0-or-later
"""Remakes the screenshots of docs/guide/blender.md; run by Blender with a display.

    xvfb-run -s "-screen 0 1280x1080x24" blender --factory-startup --python blender/screenshots.py -- MODULES docs/images

The pictures in the repository are cut out of these and scaled.
MODULES is a folder with translucid and numpy for Blender's Python; `.ci/blender` leaves one in target/blender/debian.
"""

import importlib.util
import sys
import time
import traceback
from pathlib import Path

MODULES, IMAGES = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, MODULES)

import bpy  # noqa: E402
from mathutils import Vector  # noqa: E402

ADDON = Path(__file__).parent / "translucid"
spec = importlib.util.spec_from_file_location("translucid_extension", ADDON / "__init__.py", submodule_search_locations=[str(ADDON)])
addon = sys.modules["translucid_extension"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(addon)
addon.register()


def material(name, kind, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(kind)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def build():
    scene = bpy.context.scene
    scene.render.engine = "TRANSLUCID"
    scene.translucid.preview_samples = 64
    # A thing of ten centimeters.
    scene.unit_settings.scale_length = 0.05
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    jade = material("jade", "ShaderNodeSubsurfaceScattering", Color=(0.35, 0.75, 0.45, 1), Scale=1.2, Radius=(0.6, 1.0, 0.7))
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        bpy.ops.mesh.primitive_plane_add(size=30, location=(0, 0, -1))
        bpy.context.object.data.materials.append(material("table", "ShaderNodeBsdfDiffuse", Color=(0.5, 0.42, 0.36, 1)))
        bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 0.1), rotation=(-0.6, 0, 0.5))
        monkey = bpy.context.object
        bpy.ops.object.shade_smooth()
        monkey.modifiers.new("smooth", "SUBSURF").levels = 3
        monkey.data.materials.append(jade)
    light = bpy.data.objects["Light"]
    light.data.type, light.data.energy, light.data.size = "AREA", 900, 1.5
    light.location = (-2.5, 3.0, 3.5)
    light.rotation_euler = (Vector((0, 0, 0)) - light.location).to_track_quat("-Z", "Y").to_euler()
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.09, 0.1, 0.12, 1)
    return monkey


def area(kind):
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == kind)


def session():
    build()
    yield 0.5
    space = area("VIEW_3D").spaces.active
    space.shading.type = "RENDERED"
    space.overlay.show_overlays = False
    space.region_3d.view_distance = 6
    space.region_3d.view_rotation = Vector((0.35, -1, 0.5)).to_track_quat("Z", "Y")
    space.region_3d.view_location = (0, 0, 0)
    import translucid_extension.viewport as viewport

    for context, name in (("RENDER", "blender-viewport.png"), ("MATERIAL", "blender-material.png")):
        area("PROPERTIES").spaces.active.context = context
        yield 1.0
        begun = time.perf_counter()
        while not all(shown.is_finished for shown in viewport._shown) and time.perf_counter() - begun < 300:
            yield 0.2
        yield 0.5
        bpy.ops.screen.screenshot(filepath=str(Path(IMAGES).resolve() / name))


steps = session()


def step():
    try:
        return next(steps)
    except StopIteration:
        pass
    except Exception:
        traceback.print_exc()
    bpy.ops.wm.quit_blender()
    return None


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(step, first_interval=1.0)
