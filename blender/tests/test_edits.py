# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits at random, each followed as the rendered view follows it, without a display: no picture is stale, memory is steady."""

import os
import random

import bpy
import numpy as np
from harness import Nodes, add_light, add_plane, addon, matte, new_scene, set_world

from translucid_extension.live import Live, Target
from translucid_extension.viewport import Viewport

# Many take minutes: they are for `.ci/thorough`.
EDITS = 500 if "TRANSLUCID_THOROUGH" in os.environ else 60

CAMERA = {"position": [1, -9, 4], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40}
SIZE, SAMPLES = (24, 16), 2

# Of the mean: the greatest difference of pictures that show the same.
BOUND = 0.02


def wax(name, color):
    nodes = Nodes(name)
    node = nodes.add("SubsurfaceScattering", Color=color, Scale=0.2)
    node.falloff = random.choice(["BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN"])
    return nodes.surface(node)


def color():
    return tuple(random.random() for _ in range(3))


def place(reach=3.0):
    return [random.uniform(-reach, reach) for _ in range(3)]


def meshes():
    return [owner for owner in bpy.data.objects if owner.type == "MESH" and owner.name != "plane"]


def add():
    kind = random.choice(["cube_add", "uv_sphere_add", "torus_add", "monkey_add", "plane_add"])
    getattr(bpy.ops.mesh, f"primitive_{kind}")(location=place())
    bpy.context.object.data.materials.append(random.choice(bpy.data.materials[:]))


def duplicate():
    copy = random.choice(meshes()).copy()
    copy.location = place()
    bpy.context.scene.collection.objects.link(copy)


def delete():
    if len(meshes()) > 2:
        bpy.data.objects.remove(random.choice(meshes()))


def new_material():
    data = random.choice(meshes()).data
    data.materials.clear()
    for _ in range(random.choice([1, 2])):
        data.materials.append(wax("new", color()))
    for number, polygon in enumerate(data.polygons):
        polygon.material_index = number % len(data.materials)
    data.update()


def recolor():
    for node in random.choice(bpy.data.materials[:]).node_tree.nodes:
        if "Color" in node.inputs:
            node.inputs["Color"].default_value = (*color(), 1)


def subdivide():
    owner = random.choice(meshes())
    if owner.modifiers:
        owner.modifiers.clear()
    else:
        owner.modifiers.new("smooth", "SUBSURF").levels = 1


def push():
    """A vertex is moved."""
    data = random.choice(meshes()).data
    random.choice(data.vertices[:]).co.z += 0.5
    data.update()


def lamp():
    lamps = [owner for owner in bpy.data.objects if owner.type == "LIGHT"]
    if len(lamps) > 3:
        bpy.data.objects.remove(random.choice(lamps))
    elif random.random() < 0.5:
        add_light(random.choice(["POINT", "SUN", "SPOT", "AREA"]), place(), energy=random.uniform(1, 200))
    elif lamps:
        random.choice(lamps).data.energy *= random.uniform(0.5, 1.5)


def setting(name, *values):
    def change():
        setattr(bpy.context.scene.translucid, name, random.choice(values))

    change.__name__ = name
    return change


def of_a_mesh(name, values):
    def change():
        setattr(random.choice(meshes()), name, values())

    change.__name__ = name
    return change


def new_world():
    set_world(color())


def clear_film():
    bpy.context.scene.render.film_transparent = random.random() < 0.5


def override():
    bpy.context.view_layer.material_override = random.choice([None, None, bpy.data.materials[0]])


EDITS_AT_RANDOM = [
    *(add, duplicate, delete, new_material, recolor, subdivide, push, lamp, override),
    of_a_mesh("location", place),
    of_a_mesh("rotation_euler", place),
    of_a_mesh("scale", lambda: [random.choice([-1, 0, 0.5, 1, 2]) for _ in range(3)]),
    of_a_mesh("hide_viewport", lambda: random.random() < 0.3),
    new_world,
    clear_film,
    setting("model", "NODE", "NODE", "random-walk", "normalized-diffusion"),
    setting("method", "ray-traced", "ray-traced", "point-based"),
    setting("max_bounces", 0, 4, 12),
]


def picture(live, samples):
    live.look(CAMERA, SIZE)
    live.session.run(samples)
    return live.picture()


def difference(live, other):
    """Of their pictures, over their mean.

    Rounding differs where vertices were moved, and sends some samples another way, which matters little once there are
    many. A stale picture stays apart.
    """
    for samples in (SAMPLES, 32, 512):
        ours, theirs = picture(live, samples), picture(other, samples)
        found = np.abs(ours - theirs).mean() / max(np.abs(theirs).mean(), 1e-9)
        if found < BOUND:
            break
    return found


def followed(viewport):
    """Lets the tasks of a viewport end, and hands over its session."""
    while viewport._task is not None:
        viewport._task.wait(None)
        viewport._arrive()
    assert viewport._failure is None, viewport._failure
    return viewport._live


def made_anew(old):
    """The session of a scene of which nothing is known."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    model = addon.engine.settings.model_of(bpy.context.scene)
    live = Live()
    live.follow(Target(addon.engine.Exporter(depsgraph, addon.engine.Report(), model).describe(), old.film, old.integrator, old.threads))
    return live


def test_no_picture_is_stale_after_edits_at_random():
    random.seed(3)
    scene = new_scene(*SIZE, SAMPLES)
    scene.translucid.preview_samples = SAMPLES
    add_plane(6, z=-1.5, material=matte())
    add_light("AREA", (2, -3, 5), energy=500.0, size=2.0)
    set_world((0.1, 0.1, 0.12))
    wax("wax", (0.8, 0.5, 0.3))
    for _ in range(4):
        add()
    viewport = Viewport()

    def follow(_, depsgraph):
        viewport.update(depsgraph)

    bpy.app.handlers.depsgraph_update_post.append(follow)
    memory = []
    try:
        viewport.update(bpy.context.evaluated_depsgraph_get())
        for number in range(EDITS):
            edit = delete if len(meshes()) > 25 else random.choice(EDITS_AT_RANDOM)
            edit()
            bpy.context.view_layer.update()
            live, target = followed(viewport), viewport._target
            assert target.integrator["subsurface_method"] != "point-based"
            found = difference(live, made_anew(target))
            assert found < BOUND, f"edit {number}, {edit.__name__}: {found}"
            memory.append(addon.process.memory_in_use()[0])
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(follow)
        viewport.end()
    print(f"{EDITS} edits, memory {memory[EDITS // 5]:.0f} MiB after a fifth, {memory[-1]:.0f} MiB at the end")
    assert memory[-1] - memory[EDITS // 5] < 200
