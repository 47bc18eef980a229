# SPDX-License-Identifier: GPL-3.0-or-later
"""Where things are in the picture, and which way they face."""

import math

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from harness import Nodes, add_camera, add_light, add_mesh, add_plane, combined, link, matte, messages, new_scene, radians, render, set_world
from mathutils import Matrix, Vector


def emission(color=(1, 1, 1), strength=1.0, name="emission"):
    nodes = Nodes(name)
    return nodes.surface(nodes.add("Emission", Color=color, Strength=strength))


def centroid(picture, channel=0):
    """The middle of what shines, in pixels from the lower left corner of the picture."""
    light = picture[..., channel]
    assert light.sum() > 0, "nothing is seen"
    height, width = light.shape
    x = (light.sum(axis=0) * (np.arange(width) + 0.5)).sum() / light.sum()
    y = (light.sum(axis=1) * (np.arange(height) + 0.5)).sum() / light.sum()
    return x, height - y


def add_marker(place, size=0.02, material=None):
    """A small ball that shines."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=size, location=place)
    owner = bpy.context.object
    owner.data.materials.append(material or emission())
    return owner


CAMERAS = {
    "wide": dict(lens=24.0),
    "tall sensor": dict(lens=50.0, sensor_fit="VERTICAL", sensor_height=20.0),
    "horizontal sensor": dict(lens=35.0, sensor_fit="HORIZONTAL", sensor_width=30.0),
    "shifted": dict(lens=35.0, shift_x=0.2, shift_y=-0.15),
    "orthographic": dict(type="ORTHO", ortho_scale=4.0),
    "orthographic, shifted": dict(type="ORTHO", ortho_scale=4.0, shift_x=-0.1, shift_y=0.2),
}


@pytest.mark.parametrize("size", [(96, 64), (56, 90)], ids=["wide", "tall"])
@pytest.mark.parametrize("settings", CAMERAS.values(), ids=CAMERAS.keys())
def test_points_are_where_blender_sees_them(settings, size):
    scene = new_scene(*size, samples=64)
    camera = add_camera((3.0, -5.0, 2.5), radians(68, 5, 31), **settings)
    marker = add_marker((0.1, 0.1, 0.2), 0.2)
    bpy.context.view_layer.update()
    for place in ((0.1, 0.1, 0.2), (-0.1, 0.1, -0.1)):
        marker.location = place
        bpy.context.view_layer.update()
        expected = world_to_camera_view(scene, camera, Vector(place))
        assert 0 < expected.x < 1 and 0 < expected.y < 1
        x, y = centroid(combined())
        # The outline of a ball of three pixels, which perspective makes an ellipse beside its middle.
        assert x == pytest.approx(expected.x * size[0], abs=0.1)
        assert y == pytest.approx(expected.y * size[1], abs=0.1)


def test_unit_scale_changes_lengths_in_millimeters_only():
    scene = new_scene(48, 48, 16)
    add_camera((0, -4, 0), radians(90, 0, 0))
    add_marker((0.3, 0, 0.2), 0.1)
    a = combined()
    scene.unit_settings.scale_length = 0.001
    assert np.array_equal(combined(), a)


def test_camera_scale_does_not_matter():
    new_scene(48, 48, 16)
    camera = add_camera((0, -4, 0), radians(90, 0, 0))
    add_marker((0.3, 0, 0.2), 0.1)
    a = combined()
    camera.scale = (3, 2, 5)
    assert np.allclose(combined(), a, atol=1e-5)


def test_depth_of_field_spreads_by_the_circle_of_confusion():
    new_scene(128, 128, 400)
    camera = add_camera((0, 0, 0), radians(90, 0, 0), lens=50.0)
    camera.data.dof.use_dof = True
    camera.data.dof.aperture_fstop, camera.data.dof.focus_distance = 0.05, 2.0
    add_marker((0, 8.0, 0), 0.01)
    light = combined()[..., 0]
    # Lens of radius 50 mm / (2 · 0.05) = 0.5 m: what is 8 m away, focused at 2 m, is a disc of radius
    # 0.5 · |8 − 2| / 8 on the plane in focus, which shows 2 m · 36/50 in 128 pixels.
    radius = 0.5 * 6 / 8 * 128 / (2 * 36 / 50)
    y, x = np.mgrid[:128, :128] + 0.5
    # The mean squared distance from the middle of a disc is half its radius squared.
    spread = (light * ((x - 64) ** 2 + (y - 64) ** 2)).sum() / light.sum()
    assert math.sqrt(2 * spread) == pytest.approx(radius, rel=0.05)


def uv_material(color_space="Non-Color"):
    """Red grows along u, green along v."""
    image = bpy.data.images.new("uv", 64, 64, float_buffer=True)
    image.colorspace_settings.name = color_space
    u, v = np.meshgrid((np.arange(64) + 0.5) / 64, (np.arange(64) + 0.5) / 64)
    image.pixels.foreach_set(np.stack([u, v, 0 * u, 0 * u + 1], axis=-1).astype(np.float32).ravel())
    nodes = Nodes("uv")
    texture = nodes.add("TexImage")
    texture.image = image
    return nodes, texture


def view_from_above(half=1.0):
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=2 * half)


def test_texture_has_its_origin_at_the_lower_left():
    new_scene(64, 64, 32)
    nodes, texture = uv_material()
    add_plane(1.0, material=nodes.surface(nodes.add("Emission", Color=texture.outputs[0])))
    view_from_above()
    picture = combined()
    u, v = np.meshgrid((np.arange(64) + 0.5) / 64, 1 - (np.arange(64) + 0.5) / 64)
    assert np.abs(picture[4:-4, 4:-4, 0] - u[4:-4, 4:-4]).max() < 0.02
    assert np.abs(picture[4:-4, 4:-4, 1] - v[4:-4, 4:-4]).max() < 0.02


@pytest.mark.parametrize("kind", ["POINT", "TEXTURE"])
def test_mapping_moves_turns_and_stretches_textures(kind):
    new_scene(64, 64, 64)
    nodes, texture = uv_material()
    # Within the unit square of the texture, so that nothing repeats.
    values = ((0.3, 0.2, 0), (0, 0, 0.5), (0.4, 0.3, 1)) if kind == "POINT" else ((-0.6, -0.7, 0), (0, 0, 0.2), (2.5, 2.5, 1))
    mapping = nodes.add("Mapping", Location=values[0], Rotation=values[1], Scale=values[2])
    mapping.vector_type = kind
    nodes.tree.links.new(nodes.add("UVMap").outputs[0], mapping.inputs[0])
    nodes.tree.links.new(mapping.outputs[0], texture.inputs[0])
    add_plane(1.0, material=nodes.surface(nodes.add("Emission", Color=texture.outputs[0])))
    view_from_above()
    picture = combined()
    u, v = np.meshgrid((np.arange(64) + 0.5) / 64, 1 - (np.arange(64) + 0.5) / 64)
    full = Matrix.LocRotScale(Vector(values[0]), Matrix.Rotation(values[1][2], 3, "Z"), Vector(values[2]))
    full = full.inverted() if kind == "TEXTURE" else full
    mapped = np.einsum("ij,jhw->ihw", np.array(full), np.stack([u, v, 0 * u, 0 * u + 1]))
    inside = (mapped[:2] > 0.06).all(axis=0) & (mapped[:2] < 0.94).all(axis=0)
    # At its edges the picture shows what is beside the plane.
    inside[:2] = inside[-2:] = inside[:, :2] = inside[:, -2:] = False
    assert inside.mean() > 0.6
    assert np.abs(picture[..., 0] - mapped[0])[inside].max() < 0.02
    assert np.abs(picture[..., 1] - mapped[1])[inside].max() < 0.02


def test_color_attributes_of_points_and_corners():
    for domain, kind in (("POINT", "FLOAT_COLOR"), ("CORNER", "BYTE_COLOR")):
        new_scene(32, 32, 16)
        nodes = Nodes()
        attribute = nodes.add("VertexColor")
        attribute.layer_name = "tint"
        plane = add_plane(1.0, material=nodes.surface(nodes.add("Emission", Color=attribute.outputs[0])))
        colors = plane.data.color_attributes.new("tint", kind, domain)
        # Vertices and corners of the plane have the same order: red on the left, green on the right.
        colors.data.foreach_set("color", np.array([(1, 0, 0, 1), (0, 1, 0, 1), (0, 1, 0, 1), (1, 0, 0, 1)], dtype=np.float32).ravel())
        view_from_above()
        picture = combined()
        across = (np.arange(32) + 0.5) / 32
        assert np.abs(picture[4:-4, :, 1] - across)[:, 2:-2].max() < 0.03
        assert np.abs(picture[4:-4, :, 0] - (1 - across))[:, 2:-2].max() < 0.03


def test_color_attributes_of_faces():
    new_scene(16, 16, 16)
    nodes = Nodes()
    attribute = nodes.add("Attribute")
    attribute.attribute_name = "tint"
    plane = add_plane(1.0, material=nodes.surface(nodes.add("Emission", Color=attribute.outputs[0])))
    plane.data.attributes.new("tint", "FLOAT_COLOR", "FACE").data[0].color = (0.8, 0.2, 0.1, 1)
    view_from_above()
    assert np.allclose(combined()[4:-4, 4:-4, :3], (0.8, 0.2, 0.1), atol=0.01)
    assert not any("color attribute" in message for message in messages())


def normals_of(layers):
    return next(value for name, value in layers.items() if name.endswith("Normal"))


def test_normals_smooth_flat_and_custom():
    new_scene(64, 64, 32, transparent=True)
    bpy.context.view_layer.use_pass_normal = True
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1)
    ball = bpy.context.object
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=2.2)
    x, y = np.meshgrid(((np.arange(64) + 0.5) / 64 - 0.5) * 2.2, (0.5 - (np.arange(64) + 0.5) / 64) * 2.2)
    inside = x**2 + y**2 < 0.8
    true = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)
    bpy.ops.object.shade_smooth()
    smooth = normals_of(render())
    assert np.abs(smooth - true)[inside].max() < 0.03
    bpy.ops.object.shade_flat()
    flat = normals_of(render())
    # A face of 11.25° is flat: its normals are off by up to half of that.
    assert 0.05 < np.abs(flat - true)[inside].max() < 0.15
    ball.data.normals_split_custom_set([(0.0, 0.6, 0.8)] * len(ball.data.loops))
    custom = normals_of(render())
    # Where the surface faces them: elsewhere they are turned to the side that is seen.
    facing = inside & (true @ np.array([0.0, 0.6, 0.8]) > 0.2)
    assert np.abs(custom - [0.0, 0.6, 0.8])[facing].max() < 0.02


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 1, 1), (1, 3, 0.5), (-2, 0.5, 1)])
def test_mirrored_and_stretched_objects_face_outward(scale):
    new_scene(48, 48, 32, transparent=True)
    bpy.context.view_layer.use_pass_normal = True
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.5)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    ball.scale, ball.rotation_euler = scale, (0, 0, 0.4)
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=4)
    picture = normals_of(render())
    x, y = np.meshgrid(((np.arange(48) + 0.5) / 48 - 0.5) * 4, (0.5 - (np.arange(48) + 0.5) / 48) * 4)
    turn = np.array(Matrix.Rotation(0.4, 3, "Z"))
    local = np.stack([x, y], axis=-1) @ turn[:2, :2] / np.array(scale[:2])
    height = np.sqrt(np.maximum(0.25 - (local**2).sum(axis=-1), 0))
    inside = (local**2).sum(axis=-1) < 0.15
    assert inside.sum() > 20
    # The gradient of the ellipsoid, in its own axes.
    normal = np.concatenate([local / np.array(scale[:2]), (height / abs(scale[2]))[..., None]], axis=-1)
    normal[..., :2] = normal[..., :2] @ turn[:2, :2].T
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    assert np.abs(picture - normal)[inside].max() < 0.12
    assert np.abs(picture - normal)[inside].mean() < 0.02


def test_instances_are_at_their_places():
    new_scene(96, 32, 64)
    source = add_marker((0, 0, 0), 0.05)
    collection = bpy.data.collections.new("balls")
    collection.objects.link(source)
    bpy.context.scene.collection.objects.unlink(source)
    colors = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    for x, color in zip((-1.0, 0.2, 1.3), colors, strict=True):
        empty = link("empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location, empty.scale = (x, 0, 0.1 * x), (1, 1, 2)
    add_camera((0, -5, 0), radians(90, 0, 0), type="ORTHO", ortho_scale=4)
    picture = combined()
    for x in (-1.0, 0.2, 1.3):
        middle = (x / 4 + 0.5) * 96
        left, right = int(middle) - 5, int(middle) + 6
        seen = centroid(picture[:, left:right])
        assert seen[0] + left == pytest.approx(middle, abs=0.1)
        assert seen[1] == pytest.approx(16 + 0.1 * x * 24, abs=0.1)


def test_linked_duplicates_with_their_own_materials():
    new_scene(64, 32, 16)
    a = add_marker((-0.5, 0, 0), 0.2, emission((1, 0, 0), name="red"))
    b = link("b", a.data)
    b.location = (0.5, 0, 0)
    b.material_slots[0].link = "OBJECT"
    b.material_slots[0].material = emission((0, 1, 0), name="green")
    add_camera((0, -5, 0), radians(90, 0, 0), type="ORTHO", ortho_scale=2)
    picture = combined()
    assert picture[16, 16, :3] == pytest.approx([1, 0, 0], abs=1e-3)
    assert picture[16, 48, :3] == pytest.approx([0, 1, 0], abs=1e-3)


def test_materials_by_face():
    new_scene(32, 32, 16)
    corners = [(-1, -1, 0), (0, -1, 0), (0, 1, 0), (-1, 1, 0), (1, -1, 0), (1, 1, 0)]
    plane = add_mesh("two", corners, [(0, 1, 2, 3), (1, 4, 5, 2)], emission((1, 0, 0), name="red"))
    plane.data.materials.append(emission((0, 1, 0), name="green"))
    plane.data.polygons[1].material_index = 1
    view_from_above()
    picture = combined()
    assert picture[16, 6, :3] == pytest.approx([1, 0, 0], abs=1e-3)
    assert picture[16, 26, :3] == pytest.approx([0, 1, 0], abs=1e-3)


def test_modifiers_shape_keys_and_other_surfaces():
    new_scene(64, 64, 32)
    marker = add_marker((0, 0, 0), 0.1)
    marker.shape_key_add(name="Basis")
    key = marker.shape_key_add(name="moved")
    for point in key.data:
        point.co.x += 1
    key.value = 0.5
    marker.modifiers.new("array", "ARRAY").relative_offset_displace = (0, 5, 0)
    bpy.ops.object.text_add(location=(-0.9, -0.8, 0))
    bpy.context.object.data.body = "I"
    bpy.context.object.data.materials.append(emission((0, 0, 1), name="blue"))
    view_from_above(1.5)
    picture = combined()
    right = picture[:, 32:]
    # Two balls of radius 0.1, the second five widths further along y.
    x, y = centroid(right)
    assert x + 32 == pytest.approx(32 + 0.5 * 64 / 3, abs=0.2)
    assert y == pytest.approx(32 + 0.5 * 64 / 3, abs=0.3)
    assert picture[:, :32, 2].sum() > 10, "the text is not seen"
    assert messages() == ["object Text: an open surface that glows shines from its front only"]


def test_what_is_hidden_is_not_rendered():
    new_scene(32, 32, 8)
    hidden = add_marker((0, 0, 0), 0.5)
    hidden.hide_render = True
    view_from_above()
    assert combined()[..., :3].max() == 0


def test_environment_images_face_the_same_way_as_in_cycles():
    new_scene(64, 32, 64)
    image = bpy.data.images.new("sky", 256, 128, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    # A spot of light in the direction of longitude 50° and latitude 20°.
    longitude = 180 - (np.arange(256) + 0.5) / 256 * 360
    latitude = (np.arange(128) + 0.5) / 128 * 180 - 90
    spot = (np.abs(longitude - 50) < 4)[None, :] & (np.abs(latitude - 20) < 4)[:, None]
    pixels = np.zeros((128, 256, 4), dtype=np.float32)
    pixels[spot] = 1
    image.pixels.foreach_set(pixels.ravel())
    world = set_world((0, 0, 0))
    tree = world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = radians(10, -5, 30)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], texture.inputs[0])
    tree.links.new(texture.outputs[0], next(n for n in tree.nodes if n.type == "BACKGROUND").inputs[0])
    bpy.context.scene.world = world
    rows, columns = np.nonzero(spot)
    angles = radians(longitude[columns].mean(), latitude[rows].mean())
    looked_up = Vector((math.cos(angles[0]) * math.cos(angles[1]), math.sin(angles[0]) * math.cos(angles[1]), math.sin(angles[1])))
    turn = Matrix.Rotation(radians(30)[0], 3, "Z") @ Matrix.Rotation(radians(-5)[0], 3, "Y") @ Matrix.Rotation(radians(10)[0], 3, "X")
    # What a direction times the matrix looks up is seen in the direction itself.
    seen = turn.inverted() @ looked_up
    camera = add_camera((0, 0, 0))
    camera.rotation_euler = (seen + Vector((0.1, 0.2, 0.05))).to_track_quat("-Z", "Y").to_euler()
    bpy.context.view_layer.update()
    expected = world_to_camera_view(bpy.context.scene, camera, seen)
    x, y = centroid(combined())
    assert x == pytest.approx(expected.x * 64, abs=0.3)
    assert y == pytest.approx(expected.y * 32, abs=0.3)


def test_objects_without_triangles_are_left_out():
    new_scene(16, 16, 4)
    add_mesh("edges", [(0, 0, 0), (1, 0, 0)], [], matte())
    add_mesh("nothing", [], [], matte())
    add_light("POINT", (0, 0, 2))
    view_from_above()
    assert combined()[..., :3].max() == 0
