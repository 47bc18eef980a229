# SPDX-License-Identifier: GPL-3.0-or-later
"""A session that follows descriptions shows what a new one shows. Needs no Blender, but the module translucid."""

import importlib.util
import sys
import types
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("translucid")
ADDON = Path(__file__).parents[1] / "translucid"


def load(name):
    """A module of the extension without the extension, which imports bpy."""
    package = "translucid_pure"
    if package not in sys.modules:
        root = sys.modules[package] = types.ModuleType(package)
        root.__path__ = [str(ADDON)]
    return importlib.import_module(f"{package}.{name}")


live = load("live")
scene = load("export.scene")
material = load("export.material")
mesh = load("export.mesh")
value = load("export.value")

CAMERA = {"position": [0.5, -6, 2], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40}
TETRAHEDRON = np.array([[0, 0, 1], [0.9, 0, -0.4], [-0.5, 0.8, -0.4], [-0.5, -0.8, -0.4]], dtype=np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], dtype=np.int32)


def wax(color=(0.8, 0.5, 0.2)):
    keys = {"subsurface_weight": 1.0, "subsurface_color": list(color), "subsurface_radius": 0.2, "specular_weight": 0.0}
    return material.Material({"subsurface_model": "random-walk-rough", **keys})


def at(x=0.0, scale=(1, 1, 1)):
    place = np.diag([*scale, 1.0])
    place[0, 3] = x
    return place


def body(name, of="wax", places=None, vertices=TETRAHEDRON):
    places = places or [at()]
    parts = [(of, mesh.MeshArrays(vertices, FACES))]
    return scene.Body(name, parts, places, [f"{name} {i}" for i in range(len(places))])


def target(bodies, materials=None, **parts):
    description = scene.Description(
        bodies={one.name: one for one in bodies},
        materials=materials or {"wax": wax(), "(no material)": material.default_material()},
        lights=parts.get("lights", [{"type": "distant", "direction": [1, -1, 2], "irradiance": 2.0}]),
        environment=parts.get("environment", {"radiance": 0.2, "visible": True}),
    )
    return live.Target(description, {"filter_radius": parts.get("filter", 1.5)}, {"samples_per_pixel": 4, "seed": 1}, 2)


def picture(session):
    session.look(CAMERA, (32, 24))
    session.session.run(4)
    return session.picture()


def test_edits_show_what_a_new_session_shows():
    a, b = body("a"), body("b", places=[at(1.5)])
    many = body("many", "(no material)", [at(-2), at(-2.5, (0.5, 0.5, 0.5))])
    red = {"wax": wax((0.9, 0.1, 0.1)), "(no material)": material.default_material()}
    moved = scene.Body("b", b.parts, [at(1.0, (-1, 2, 1))], b.owners)
    mirrored = scene.Body("a", a.parts, [at(0, (1, 1, 0))], a.owners)
    steps = [
        target([a, b, many]),
        target([a, moved, many]),
        target([a, moved]),
        target([a, moved, many], red),
        target([a, body("b", "steel")], {**red, "steel": material.Material({"base_metalness": 1.0})}),
        target([a, many], red, lights=[], environment={"radiance": 1.0, "visible": False}),
        target([mirrored, b], filter=0.7),
        target([]),
        target([a]),
    ]
    following = live.Live()
    for number, step in enumerate(steps):
        assert following.follow(step)
        assert not following.follow(step)
        new = live.Live()
        new.follow(step)
        difference = np.abs(picture(following) - picture(new))
        assert difference.mean() < 1e-3, f"step {number}"


def test_little_edits_are_little():
    a, b = body("a"), body("b", places=[at(1.5)])
    old = target([a, b])
    moved = scene.Body("b", b.parts, [at(1.0)], b.owners)
    new = target([a, moved], old.description.materials)
    assert [name for name, _ in live.edits_between(old, new)] == ["edit_object"]
    red = {**old.description.materials, "wax": wax((1, 0, 0))}
    assert [name for name, _ in live.edits_between(old, target([a, b], red))] == ["edit_material"]


def test_an_edit_takes_back_what_the_new_keys_do_not_name():
    old = target([body("a")], {"wax": material.Material({"base_metalness": 1.0, "specular_ior": 1.8, "coat_weight": 1.0})})
    new = target([body("a")], {"wax": material.Material({"base_color": [0.2, 0.4, 0.6]})})
    new.description.bodies = old.description.bodies
    following, fresh = live.Live(), live.Live()
    following.follow(old)
    following.follow(new)
    fresh.follow(new)
    assert np.array_equal(picture(following), picture(fresh))


def test_placements_are_spelled_as_the_renderer_takes_them():
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    placement = value.Placement().mapped(turn @ np.diag([2.0, 3.0]), np.array([0.25, 0.5]))
    keys, is_exact = placement.keys()
    assert is_exact
    assert keys["uv_scale"] == pytest.approx([2, 3]) and keys["uv_rotation"] == pytest.approx(90)
    assert keys["uv_offset"] == pytest.approx([0.25, 0.5])
    _, is_exact = value.Placement().mapped(np.array([[1.0, 0.5], [0.0, 1.0]]), np.zeros(2)).keys()
    assert not is_exact


def test_textures_of_different_placements_meet_in_the_unit_square():
    ramp = np.linspace(0, 1, 64, dtype=np.float32)[None, :, None].repeat(64, axis=0)
    plain = value.Value(ramp, value.Placement(wrap="clamp"))
    turned = value.Value(ramp, value.Placement(wrap="clamp").mapped(np.array([[0.0, 1.0], [1.0, 0.0]]), np.zeros(2)))
    product = value.combine(np.multiply, plain, turned)
    u = (np.arange(64) + 0.5) / 64
    expected = u[None, :] * (1 - u[:, None])
    assert np.abs(product.pixels[..., 0] - expected)[2:-2, 2:-2].max() < 0.02
