# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by Blender with a display: a user in the rendered view. Prints what it has seen as JSON.

    blender --factory-startup --python viewport_session.py -- FOLDER EDITS

FOLDER has the modules translucid and numpy for Blender's Python, where it lacks them, and takes the screenshots.
"""

import importlib.util
import json
import random
import sys
import time
import traceback
from pathlib import Path

FOLDER, EDITS = Path(sys.argv[sys.argv.index("--") + 1]), int(sys.argv[sys.argv.index("--") + 2])
sys.path.insert(0, str(FOLDER))

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from mathutils import Quaternion  # noqa: E402

ADDON = Path(__file__).parents[1] / "translucid"
spec = importlib.util.spec_from_file_location("translucid_extension", ADDON / "__init__.py", submodule_search_locations=[str(ADDON)])
addon = sys.modules["translucid_extension"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(addon)
addon.register()
import translucid_extension.viewport as viewport_module  # noqa: E402

seen = {"blender": bpy.app.version_string, "latency": [], "edits": 0, "compared": []}


def area_of_view():
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")


def override():
    area = area_of_view()
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region)


def shown():
    """The viewport that was drawn last: one that Blender has dropped may live on for a while."""
    found = [viewport for viewport in viewport_module._shown if viewport._view is not None or viewport._task is not None]
    return min(found, key=lambda viewport: viewport.calls, default=None)


def is_settled():
    """Whether the picture of the last edit is there.

    A function of its own, for a viewport that is remembered while Blender goes on outlives its engine, and is never finished.
    """
    viewport = shown()
    if viewport is not None and viewport._failure is not None:
        raise RuntimeError(viewport._failure)
    return viewport is not None and viewport.is_finished and viewport._target is viewport._followed


def wait_until_finished(limit=300.0):
    begun = time.perf_counter()
    yield 0.1
    while time.perf_counter() - begun < limit:
        if is_settled():
            return
        yield 0.05
    state = {key: value for key, value in vars(shown()).items() if key not in {"_target", "_followed"}} if shown() else None
    raise TimeoutError(f"the view is not finished after {limit} s: {state}, {time.process_time()} s of work, task done: {shown() and shown()._task and shown()._task.is_done}")


def scattering(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeSubsurfaceScattering")
    node.inputs["Color"].default_value = (*color, 1)
    node.inputs["Scale"].default_value = 0.2
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def screenshot(name):
    bpy.ops.screen.screenshot(filepath=str(FOLDER / name))


def session():
    scene = bpy.context.scene
    scene.render.engine = "TRANSLUCID"
    scene.translucid.preview_samples = 4
    bpy.data.objects["Cube"].data.materials.clear()
    bpy.data.objects["Cube"].data.materials.append(scattering("wax", (0.8, 0.5, 0.2)))
    with override():
        bpy.ops.mesh.primitive_monkey_add(location=(2.5, 0, 0.5))
        bpy.context.object.data.materials.append(scattering("jade", (0.2, 0.7, 0.4)))
        bpy.ops.object.shade_smooth()
        bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 0, -1))
    area_of_view().spaces.active.shading.type = "RENDERED"
    begun = time.perf_counter()
    yield from wait_until_finished()
    seen["first picture"] = time.perf_counter() - begun
    screenshot("viewport.png")
    yield from latency()
    yield from wait_until_finished()
    yield from edits_show(scene)
    yield from many_edits(scene)
    yield from reload()


def latency():
    view = area_of_view().spaces.active.region_3d
    for _ in range(30):
        before = shown().answered_at
        view.view_rotation = view.view_rotation @ Quaternion((0, 1, 0), 0.05)
        begun = time.perf_counter()
        for _ in range(200):
            yield 0.002
            if shown().answered_at != before:
                break
        seen["latency"].append(shown().answered_at - begun)
        yield 0.15


def picture():
    return shown()._live.picture()


def edits_show(scene):
    """A slider, a moved object and the world change the picture at once."""
    before = picture()
    bpy.data.materials["wax"].node_tree.nodes["Subsurface Scattering"].inputs["Color"].default_value = (0.1, 0.1, 0.9, 1)
    yield from wait_until_finished()
    after = picture()
    seen["blue"] = [float(x) for x in (after - before).mean(axis=(0, 1))[:3]]
    bpy.data.objects["Suzanne"].location.z += 3
    yield from wait_until_finished()
    seen["moved"] = float(np.abs(picture() - after).mean())
    yield from same_as_new()


def same_as_new():
    """The picture after edits is that of a scene made anew."""
    yield from wait_until_finished()
    viewport = shown()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    # A depsgraph of the view, whose objects are those of the viewport.
    report = viewport_module.Report()
    description = viewport_module.Exporter(depsgraph, report, None).describe()
    live = viewport_module.Live()
    old = viewport._target
    live.follow(viewport_module.Target(description, old.film, old.integrator, old.threads))
    live.look(*viewport._view)
    live.session.run(viewport._goal)
    a, b = viewport._live.picture(), live.picture()
    seen["compared"].append(float(np.abs(a - b).mean() / max(np.abs(b).mean(), 1e-9)))
    live.stop()


def many_edits(scene):
    random.seed(1)
    scene.translucid.preview_samples = 4
    view = area_of_view().spaces.active.region_3d
    made = []

    def meshes():
        return [o for o in bpy.data.objects if o.type == "MESH" and o.name != "Plane"]

    def move():
        random.choice(meshes()).location.x += random.uniform(-1, 1)

    def turn():
        random.choice(meshes()).rotation_euler.z += random.uniform(-1, 1)

    def stretch():
        random.choice(meshes()).scale = [random.choice([-1, 0.5, 1, 2]) for _ in range(3)]

    def recolor():
        material = random.choice(bpy.data.materials[:])
        for node in material.node_tree.nodes if material.node_tree else ():
            if "Color" in node.inputs:
                node.inputs["Color"].default_value = (*(random.random() for _ in range(3)), 1)

    def add():
        with override():
            kind = random.choice(["cube", "uv_sphere", "torus", "monkey"])
            place = [random.uniform(-3, 3) for _ in range(3)]
            getattr(bpy.ops.mesh, f"primitive_{kind}_add")(location=place)
            bpy.context.object.data.materials.append(random.choice(bpy.data.materials[:]))

    def duplicate():
        copy = random.choice(meshes()).copy()
        copy.location.y += random.uniform(-2, 2)
        scene.collection.objects.link(copy)

    def delete():
        if len(meshes()) > 2:
            bpy.data.objects.remove(random.choice(meshes()))

    def new_material():
        made.append(1)
        material = scattering(f"new {len(made)}", [random.random() for _ in range(3)])
        owner = random.choice(meshes())
        owner.data.materials.clear()
        owner.data.materials.append(material)

    def hide():
        owner = random.choice(meshes())
        owner.hide_viewport = not owner.hide_viewport

    def subdivide():
        owner = random.choice(meshes())
        if owner.modifiers:
            owner.modifiers.clear()
        else:
            owner.modifiers.new("smooth", "SUBSURF").levels = 1

    def lamp():
        lamps = [o for o in bpy.data.objects if o.type == "LIGHT"]
        if not lamps or random.random() < 0.3:
            kind = random.choice(["POINT", "SUN", "SPOT", "AREA"])
            owner = bpy.data.objects.new(kind, bpy.data.lights.new(kind, kind))
            owner.location = [random.uniform(-3, 3), random.uniform(-3, 3), 4]
            owner.data.energy = 3 if kind == "SUN" else 300
            scene.collection.objects.link(owner)
        elif random.random() < 0.3:
            bpy.data.objects.remove(random.choice(lamps))
        else:
            random.choice(lamps).data.energy *= random.uniform(0.5, 1.5)

    def world():
        scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = random.random()

    def look():
        view.view_rotation = view.view_rotation @ Quaternion((0, 1, 0), random.uniform(-0.5, 0.5))

    def perspective():
        view.view_perspective = random.choice(["PERSP", "ORTHO", "CAMERA"])

    def shading():
        area_of_view().spaces.active.shading.type = random.choice(["SOLID", "RENDERED", "RENDERED", "RENDERED"])

    def undo():
        with override():
            bpy.ops.ed.undo_push(message="edit")
            move()
            bpy.ops.ed.undo_push(message="moved")
            bpy.ops.ed.undo()

    def model():
        scene.translucid.model = random.choice(["NODE", "NODE", "random-walk", "normalized-diffusion"])

    edits = [move, turn, stretch, recolor, add, duplicate, delete, new_material, hide, subdivide, lamp, world, look, look]
    edits += [perspective, shading, undo, model]
    memory = []
    for number in range(EDITS):
        if len(bpy.data.objects) > 40:
            delete()
        edit = random.choice(edits)
        edit()
        scene = bpy.context.scene
        seen["edits"] += 1
        yield random.choice([0.001, 0.02, 0.06])
        if number % 100 == 99 or number == EDITS - 1:
            area_of_view().spaces.active.shading.type = "RENDERED"
            scene.translucid.model = "NODE"
            yield from same_as_new()
            memory.append(addon.process.memory_in_use()[0])
    seen["memory"] = memory
    screenshot("edited.png")


def reload():
    """Another file comes while the view is rendered."""
    bpy.context.scene.translucid.preview_samples = 4096
    yield 0.3
    path = str(FOLDER / "saved.blend")
    with override():
        bpy.ops.wm.save_as_mainfile(filepath=path)
    for _ in range(3):
        with override():
            bpy.ops.wm.open_mainfile(filepath=path)
        yield 1.0
    bpy.context.scene.translucid.preview_samples = 4
    area_of_view().spaces.active.shading.type = "RENDERED"
    yield from wait_until_finished()
    seen["reloaded"] = True


steps = session()


def step():
    try:
        return next(steps)
    except StopIteration:
        pass
    except Exception:
        seen["error"] = traceback.format_exc()
    print("SEEN " + json.dumps(seen), flush=True)
    bpy.ops.wm.quit_blender()
    return None


# Before the window is there.
bpy.context.preferences.view.show_splash = False
bpy.context.preferences.view.smooth_view = 0
# A timer ends when another file is loaded, unless it is persistent.
bpy.app.timers.register(step, first_interval=1.0, persistent=True)
