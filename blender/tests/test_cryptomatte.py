# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomattes: channels, notes and coverage are those of Cycles, and Blender's compositor finds the names."""

import json
import re
import struct
import time

import bpy
import numpy as np
import pytest
import translucid
from harness import Nodes, add_camera, add_light, add_plane, addon, compositor, link, matte, new_scene, radians, render_cycles, set_world, write

KINDS = ("Object", "Material", "Asset")
# Its hash is that of no number, of which the exponent changes.
ODD_NAME = "sheet 348"
QUOTED = '5" pipe\\'


def attributes(path):
    """The text attributes of an OpenEXR file."""
    data, at, found = path.read_bytes(), 8, {}
    while data[at]:
        name, kind, rest = data[at : at + 512].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<I", data, at)
        if kind == b"string":
            found[name.decode()] = data[at + 4 : at + 4 + size].decode()
        at += 4 + size
    return found


def channels(path):
    """Names of the channels of Cryptomattes."""
    return sorted(set(re.findall(rb"ViewLayer\.Crypto\w+\d\d\.\w", path.read_bytes()[:8192])))


def notes_of(path):
    """What the file says of Cryptomattes, by their names."""
    found = {}
    for name, text in attributes(path).items():
        if name.startswith("cryptomatte/"):
            _, key, what = name.split("/")
            found.setdefault(key, {})[what] = text
    return {notes.pop("name"): {"key": key, **notes} for key, notes in found.items()}


def pairs_of(layers, kind):
    """Ids and shares, (height, width, levels, 2)."""
    names = sorted(name for name in layers if f"Crypto{kind}" in name)
    values = np.concatenate([layers[name] for name in names], axis=2)
    return values.reshape(*values.shape[:2], -1, 2)


def coverage(pairs, name):
    return np.where(pairs[..., 0] == np.float32(translucid.cryptomatte_id(name)), pairs[..., 1], 0).sum(axis=2)


def odd_scene(samples=64):
    """Objects with a parent, two materials, none, half clear, instanced; one mesh at two places."""
    scene = new_scene(64, 48, samples)
    if hasattr(scene.render.image_settings, "use_exr_interleave"):
        # One part, whose header has all channels and notes.
        scene.render.image_settings.use_exr_interleave = True
    for kind in KINDS:
        setattr(bpy.context.view_layer, f"use_pass_cryptomatte_{kind.lower()}", True)
    bpy.ops.mesh.primitive_cube_add(location=(-1.5, 0, 0), rotation=(0.3, 0.4, 0.2))
    cube = bpy.context.object
    cube.name = "Würfel"
    for name in ("mat é", "other"):
        cube.data.materials.append(matte(name=name))
    for polygon in cube.data.polygons[:3]:
        polygon.material_index = 1
    ball = link("ball", cube.data)
    ball.parent, ball.location, ball.scale = cube, (3.2, 1, 0), (0.5, 0.5, 0.5)
    nodes = Nodes("half")
    mixed = nodes.add("MixShader", i0=0.25)
    nodes.tree.links.new(nodes.add("BsdfTransparent").outputs[0], mixed.inputs[1])
    nodes.tree.links.new(nodes.add("BsdfDiffuse").outputs[0], mixed.inputs[2])
    sheet = add_plane(1.2, z=1.5, material=nodes.surface(mixed))
    sheet.name = ODD_NAME
    sheet.rotation_euler = (0, 0, 0.3)
    triangle = bpy.data.meshes.new("mesh")
    triangle.from_pydata([(0, 0, 0), (1.5, 0, 0), (0, 1.2, 0)], [], [(0, 1, 2)])
    collection = bpy.data.collections.new("collection")
    collection.objects.link(bpy.data.objects.new("tri", triangle))
    for place in (-1, 1):
        empty = link("instancer", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location = (1.5, 1.3 * place, -0.5)
    add_camera((0, 0, 9), lens=45.0)
    add_light("POINT", (1, 1, 5), energy=100.0)
    set_world((0.2, 0.2, 0.2))
    return scene


@pytest.mark.parametrize("depth", [6, 3])
def test_channels_notes_and_mattes_are_those_of_cycles(depth, tmp_path):
    odd_scene()
    bpy.context.view_layer.pass_cryptomatte_depth = depth
    ours = write(tmp_path / "ours.exr")
    theirs = render_cycles(256, take=lambda: write(tmp_path / "theirs.exr"))
    notes, expected = notes_of(ours), notes_of(theirs)
    assert notes.keys() == expected.keys() == {f"ViewLayer.Crypto{kind}" for kind in KINDS}
    layers, cycles = translucid.read_exr(ours), translucid.read_exr(theirs)
    assert channels(ours) == channels(theirs)
    for kind in KINDS:
        found, wanted = notes[f"ViewLayer.Crypto{kind}"], expected[f"ViewLayer.Crypto{kind}"]
        manifest, of_cycles = json.loads(found.pop("manifest")), json.loads(wanted.pop("manifest"))
        assert found == wanted
        # Cycles has the hash there, and not the id that is in the pixels.
        assert {name for name in manifest if manifest[name] != of_cycles[name]} == ({ODD_NAME} & manifest.keys())
        for name in manifest:
            mine, reference = (coverage(pairs_of(found, kind), name) for found in (layers, cycles))
            difference = np.abs(mine - reference)
            print(f"{kind} {name}: at most {difference.max():.3f}, on average {difference.mean():.5f}")
            # Where it covers half of a pixel, the standard deviation is √(1/4/64 + 1/4/256) = 0.07 at most.
            assert difference.max() < 0.25 and difference.mean() < 0.003
            assert mine.max() > 0.2


def test_mattes_add_up_to_alpha(tmp_path):
    odd_scene().render.film_transparent = True
    layers = translucid.read_exr(write(tmp_path / "picture.exr"))
    alpha = layers["ViewLayer.Combined"][..., 3]
    assert 0 < alpha.mean() < 1
    for kind in KINDS:
        assert np.abs(pairs_of(layers, kind)[..., 1].sum(axis=2) - alpha).max() < 1e-5, kind


@pytest.mark.parametrize("kind, name", [("Object", "ball"), ("Object", ODD_NAME), ("Object", QUOTED), ("Material", "mat é"), ("Asset", "Würfel")])
def test_the_compositor_finds_the_names(kind, name, tmp_path):
    odd_scene(8)
    bpy.data.objects["tri"].name = QUOTED

    def make(nodes, links):
        node = nodes.new("CompositorNodeCryptomatteV2")
        node.layer_name = f"ViewLayer.Crypto{kind}"
        node.matte_id = name
        return node.outputs["Matte"]

    compositor(make)
    layers = translucid.read_exr(write(tmp_path / "picture.exr"))
    expected = coverage(pairs_of(layers, kind), name)
    assert expected.max() > 0.2
    assert np.allclose(layers["Composite.Combined"][..., 0], expected, atol=1e-6)


def test_no_pass_where_none_is_asked_for(tmp_path):
    odd_scene(1)
    for kind in KINDS:
        setattr(bpy.context.view_layer, f"use_pass_cryptomatte_{kind.lower()}", kind == "Material")
    path = write(tmp_path / "picture.exr")
    assert {name.split(".")[1][:-2] for name in translucid.read_exr(path) if "Crypto" in name} == {"CryptoMaterial"}
    assert notes_of(path).keys() == {"ViewLayer.CryptoMaterial"}


def test_cancelling_does_not_wait_for_it(monkeypatch):
    odd_scene(1)
    asked = []
    monkeypatch.setattr(addon.mattes.Matte, "values", lambda *_: time.sleep(3) or [])
    monkeypatch.setattr(addon.engine.TranslucidRenderEngine, "is_cancelled", lambda engine: bool(asked))
    monkeypatch.setattr(addon.engine.TranslucidRenderEngine, "_state", lambda engine, words: words == "Cryptomatte" and asked.append(time.perf_counter()))
    bpy.ops.render.render()
    assert len(asked) == 1 and time.perf_counter() - asked[0] < 0.3
