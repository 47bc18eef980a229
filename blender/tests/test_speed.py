# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender costs on top of the renderer. Prints times; bounds are several times what an idle machine needs."""

import time

import bpy
import numpy as np
import pytest
import translucid
from harness import add_camera, add_light, addon, combined, matte, new_scene, radians

mesh_module = addon.engine.Exporter.describe.__globals__["arrays_of"].__globals__


def grid(across, down, material=None):
    """A wavy sheet of so many quadrilaterals."""
    x, y = np.meshgrid(np.linspace(-1, 1, across + 1), np.linspace(-1, 1, down + 1))
    vertices = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], axis=-1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(down)[:, None] * (across + 1) + np.arange(across)[None, :]).ravel()
    loops = np.stack([corner, corner + 1, corner + across + 2, corner + across + 1], axis=-1).astype(np.int32)
    mesh = bpy.data.meshes.new("grid")
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.ravel())
    mesh.loops.add(loops.size)
    mesh.loops.foreach_set("vertex_index", loops.ravel())
    mesh.polygons.add(len(loops))
    mesh.polygons.foreach_set("loop_start", np.arange(0, loops.size, 4, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    if material is not None:
        mesh.materials.append(material)
    owner = bpy.data.objects.new("grid", mesh)
    bpy.context.scene.collection.objects.link(owner)
    return owner, vertices, loops


def test_a_million_triangles_are_exported_fast():
    new_scene(16, 16, 1)
    owner, vertices, loops = grid(1000, 500, matte())
    # Vertices that no face uses, so that there are two million.
    mesh = owner.data
    mesh.vertices.add(2_000_000 - len(mesh.vertices))
    add_camera((0, 0, 3))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    times = []
    for _ in range(5):
        begun = time.perf_counter()
        description = addon.engine.Exporter(depsgraph, addon.engine.Report()).describe()
        times.append(time.perf_counter() - begun)
    part = description.bodies["grid"].parts[0][1]
    assert part.vertices.shape == (2_000_000, 3) and part.triangles.shape == (1_000_000, 3)
    assert np.array_equal(part.vertices[: len(vertices)], vertices)
    scene = translucid.Scene("m")
    begun = time.perf_counter()
    scene.add_mesh("grid", part.vertices, part.triangles, normals=part.normals)
    handed = time.perf_counter() - begun
    print(f"2 M vertices, 1 M triangles: {min(times):.3f} s out of Blender, {handed:.3f} s into the scene")
    assert min(times) < 0.3


def test_fast_and_slow_ways_out_of_blender_agree(monkeypatch):
    new_scene(16, 16, 1)
    owner, _, _ = grid(20, 10)
    mesh = owner.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    fast = mesh_module["arrays_of"](mesh, {}, {}, True)[0]
    monkeypatch.setitem(mesh_module, "_in_place", lambda *arguments: None)
    slow = mesh_module["arrays_of"](mesh, {}, {}, True)[0]
    assert np.array_equal(fast.triangles, slow.triangles) and np.array_equal(fast.vertices, slow.vertices)


def test_blender_adds_little_to_a_rendering():
    scene = new_scene(320, 180, 1)
    grid(300, 200, matte())
    add_camera((0, -2, 2), radians(45, 0, 0))
    add_light("POINT", (1, -1, 2), energy=50.0)
    combined()
    extra = []
    for _ in range(7):
        begun = time.perf_counter()
        bpy.ops.render.render()
        whole = time.perf_counter() - begun
        depsgraph = bpy.context.evaluated_depsgraph_get()
        description = addon.engine.Exporter(depsgraph, addon.engine.Report()).describe()
        begun = time.perf_counter()
        made = addon.engine.build(
            description,
            {"position": [0, -2, 2], "target": [0, 0, 0], "fov": 39.6},
            addon.engine.settings.film_keys(scene, 320, 180),
            addon.engine.settings.integrator_keys(scene, 1, addon.engine.settings.model_of(scene)),
        )
        translucid.render(made, spp=1, threads=2)
        extra.append(whole - (time.perf_counter() - begun))
    print(f"F12 takes {sorted(extra)[3]:.3f} s more than the module's own rendering (median of {len(extra)})")
    assert sorted(extra)[3] < 0.2


if __name__ == "__main__":
    pytest.main([__file__, "-s", "-q"])
