# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as nobody means them: they are rendered, or refused in words, and what is left out is said."""

import math

import bpy
import numpy as np
import pytest
from harness import Nodes, add_camera, add_light, add_mesh, add_plane, addon, combined, link, matte, messages, new_scene, radians, render, set_world

TRIANGLE = [(-1, 0, -0.5), (1, 0, -0.5), (0, 0, 1.5)]


def room(width=24, height=16, samples=4):
    """A floor under a lamp, in front of which a test puts something."""
    scene = new_scene(width, height, samples)
    add_plane(4, z=-1, material=matte((0.4, 0.5, 0.6), "floor"))
    add_camera((0, -6, 1), radians(82, 0, 0))
    add_light("AREA", (2, -3, 4), radians(40, 0, 40), energy=300.0, size=1.0)
    set_world((0.1, 0.1, 0.12))
    return scene


def wax(method="RANDOM_WALK", **inputs):
    nodes = Nodes("wax")
    node = nodes.add("SubsurfaceScattering", Color=(0.8, 0.5, 0.3), **{"Scale": 0.2, **inputs})
    node.falloff = method
    return nodes.surface(node)


def cube(material=None, **place):
    bpy.ops.mesh.primitive_cube_add(**place)
    owner = bpy.context.object
    if material is not None:
        owner.data.materials.append(material)
    return owner


def image_material(image):
    nodes = Nodes("textured")
    texture = nodes.add("TexImage")
    texture.image = image
    return nodes.surface(nodes.add("BsdfDiffuse", Color=texture.outputs[0]))


def scaled(*scale):
    bpy.ops.mesh.primitive_monkey_add()
    bpy.context.object.data.materials.append(wax())
    bpy.context.object.scale = scale


def broken(vertices, faces=((0, 1, 2),), **settings):
    return lambda: add_mesh("broken", vertices, list(faces), wax(), **settings)


def moved(**place):
    def make():
        owner = cube(wax())
        for key, value in place.items():
            setattr(owner, key, value)

    return make


def flat_plane():
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.scale = (1, 0, 1)


def volume():
    nodes = Nodes("fog")
    nodes.tree.links.new(nodes.add("VolumeScatter").outputs[0], nodes.output.inputs["Volume"])
    cube(nodes.material)


def empty_text():
    bpy.ops.object.text_add()
    bpy.context.object.data.body = ""


def hidden():
    cube().hide_render = True


# What cannot be seen, and what is said of it.
UNSEEN = {
    "no triangle has an area": (broken([(0, 0, 0), (1, 0, 0), (2, 0, 0)]), None),
    "edges alone": (broken([(0, 0, 0), (1, 0, 0)], ()), None),
    "nothing at all": (broken([], ()), None),
    "all corners are no numbers": (broken([(math.nan,) * 3] * 3), "object broken: triangles with corners that are no numbers"),
    "a scale of 0": (lambda: scaled(0, 0, 0), None),
    "a line": (lambda: scaled(1, 0, 0), None),
    "a plane, scaled to a line": (flat_plane, None),
    "a place that is no number": (moved(location=(math.nan, 0, 0)), "object Cube: its matrix is beyond all bounds"),
    "a scale beyond all bounds": (moved(scale=(1e38, 1, 1)), "object Cube: its matrix is beyond all bounds"),
    "a text without letters": (empty_text, None),
    "hidden": (hidden, None),
    "a lamp that is no number": (lambda: add_light("POINT", (0, 0, 2), energy=math.nan), "light lamp.001: its power is no number"),
    "a lamp that darkens": (lambda: add_light("POINT", (0, 0, 2), energy=-100.0), "light lamp.001: light that is negative"),
    "a lamp of no size": (lambda: setattr(add_light("AREA", (0, 0, 2), energy=100.0), "scale", (0, 0, 0)), None),
    "a volume": (lambda: bpy.ops.object.volume_add(), "object Volume: volumes cannot be rendered"),
}


@pytest.mark.parametrize("make, text", UNSEEN.values(), ids=UNSEEN.keys())
def test_what_cannot_be_seen_changes_nothing(make, text):
    room()
    plain = combined()
    make()
    assert np.array_equal(combined(), plain)
    assert len(messages()) == (text is not None), messages()
    assert text is None or messages()[0].startswith(text)


def test_what_cannot_be_seen_may_be_all_there_is():
    new_scene(8, 8, 1)
    add_camera((0, -6, 0), radians(90, 0, 0))
    set_world((0.2, 0.4, 0.6))
    scaled(0, 0, 0)
    assert combined()[4, 4] == pytest.approx([0.2, 0.4, 0.6, 1], abs=1e-5)


def test_triangles_with_corners_that_are_no_numbers_leave_the_others():
    room()
    good = add_mesh("good", TRIANGLE, [(0, 1, 2)], wax())
    whole = combined()
    bpy.data.objects.remove(good)
    add_mesh("broken", [*TRIANGLE, (math.nan, 0, 0), (0, math.inf, 0)], [(0, 1, 2), (0, 3, 1), (2, 4, 3)], wax())
    assert np.array_equal(combined(), whole)
    assert messages() == ["object broken: triangles with corners that are no numbers, or beyond ±1e9, are left out: 2"]


def test_texture_coordinates_that_are_no_numbers_are_said():
    room()
    uv = [(math.nan, 0), (1, 0), (0, 1)]
    add_mesh("broken", TRIANGLE, [(0, 1, 2)], image_material(bpy.data.images.new("image", 4, 4)), uv=uv)
    assert np.isfinite(combined()).all()
    assert messages() == ["object broken: texture coordinates that are no numbers are 0"]


def test_a_volume_alone_is_clear():
    room(samples=64)
    plain = combined()
    volume()
    assert combined().mean() == pytest.approx(plain.mean(), rel=0.05)
    assert messages() == ["material fog: Material Output: Volume cannot be translated and is left out"]


def missing_image():
    image = bpy.data.images.new("gone", 4, 4)
    image.source, image.filepath = "FILE", "//nowhere/gone.png"
    cube(image_material(image))


def looping(kind, first, second):
    """Two nodes that feed each other, before a diffuse surface."""

    def make():
        nodes = Nodes("loop")
        a, b = nodes.add(kind), nodes.add(kind)
        nodes.tree.links.new(a.outputs[0], b.inputs[first])
        nodes.tree.links.new(b.outputs[0], a.inputs[first])
        cube(nodes.surface(b if second is None else nodes.add("BsdfDiffuse", **{second: b.outputs[0]})))

    return make


def nested_groups():
    inner = None
    for _ in range(20):
        tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
        tree.interface.new_socket("Color", in_out="INPUT", socket_type="NodeSocketColor")
        tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        begin, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
        node = tree.nodes.new("ShaderNodeBsdfDiffuse" if inner is None else "ShaderNodeGroup")
        if inner is not None:
            node.node_tree = inner
        tree.links.new(begin.outputs[0], node.inputs[0])
        tree.links.new(node.outputs[0], end.inputs[0])
        inner = tree
    nodes = Nodes("deep")
    group = nodes.add("Group")
    group.node_tree = inner
    group.inputs[0].default_value = (1, 0, 0, 1)
    cube(nodes.surface(group))


def empty_group():
    tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    nodes = Nodes("hollow")
    group = nodes.add("Group")
    group.node_tree = tree
    cube(nodes.surface(group))


def slots_without_materials():
    owner = cube()
    for material in (None, wax(), None):
        owner.data.materials.append(material)
    for i, polygon in enumerate(owner.data.polygons):
        polygon.material_index = i


def fins():
    """Three sheets that share an edge."""
    add_mesh("fins", [(0, 0, 0), (1, 0, 0), (0, 0, 1), (1, 1, 0), (1, -1, 1)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)], wax("BURLEY"))
    bpy.ops.mesh.primitive_grid_add(size=2, rotation=(1, 0, 0))
    bpy.context.object.data.materials.append(wax())


def enlarged(factor):
    for owner in bpy.data.objects:
        owner.location *= factor
        owner.scale *= factor
    bpy.data.lights[0].energy *= factor**2
    bpy.ops.mesh.primitive_monkey_add(size=2 * factor)
    bpy.context.object.data.materials.append(wax(Scale=0.2 * factor))


def named_like_others():
    for name in ("a", "a/0", "a 0", "b[0]", "b(0)", "x\ny", "(nothing)"):
        owner = cube(wax(), size=0.3)
        owner.name = name
        owner.data.materials.append(matte(name="(no material)"))
        owner.data.polygons[0].material_index = 1
        copy = owner.copy()
        copy.location.z += 0.5
        bpy.context.scene.collection.objects.link(copy)


def camera_inside():
    bpy.ops.mesh.primitive_monkey_add(location=(0, -6, 1))
    bpy.context.object.data.materials.append(wax())


def orthographic_with_lens(camera):
    camera.type = "ORTHO"
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 6.0, 2.0


def without_f_number(camera):
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 0.0, 0.0


def of_the_camera(change):
    return lambda: change(bpy.context.scene.camera.data)


SEEN = {
    "an image that is missing": (missing_image, "material textured: Image Texture: image gone cannot be read and is magenta"),
    "numbers in a circle": (looping("Math", 0, "Color"), "material loop: Diffuse BSDF: Color above 1"),
    "shaders in a circle": (looping("MixShader", 1, None), None),
    "groups in groups": (nested_groups, None),
    "a group of nothing": (empty_group, "material hollow: Group: a Group node cannot be translated; it is diffuse"),
    "no material": (cube, None),
    "slots without materials": (slots_without_materials, None),
    "a mesh that is no body": (fins, None),
    "mirrored": (lambda: scaled(-1, 1, 1), None),
    "flattened": (lambda: scaled(1, 0, 1), None),
    "a million times as large": (lambda: enlarged(1e6), None),
    "ten thousand times as small": (lambda: enlarged(1e-4), None),
    "no lengths": (lambda: cube(wax(Radius=(0, 0, 0))), None),
    "endless lengths": (lambda: cube(wax(Radius=(1e6, 1e6, 1e6))), None),
    "names like those of others": (named_like_others, None),
    "the camera in a body": (camera_inside, "material wax: the camera may see nothing, because it is inside the body of object Suzanne"),
    "an orthographic lens": (of_the_camera(orthographic_with_lens), None),
    "an f-number of 0": (of_the_camera(without_f_number), "camera camera: a lens above 255 times the distance in focus"),
    "a panorama": (
        of_the_camera(lambda camera: setattr(camera, "type", "PANO")),
        "camera camera: a camera of type Pano cannot be translated; it is perspective",
    ),
    "a world without a surface": (lambda: bpy.context.scene.world.node_tree.nodes.clear(), None),
    "no world": (lambda: setattr(bpy.context.scene, "world", None), None),
    "a lamp without shadows": (lambda: setattr(bpy.data.lights[0], "use_shadow", False), "light lamp: a lamp without shadows"),
    "a lamp for some": (lambda: setattr(bpy.data.objects["lamp"], "visible_diffuse", False), "light lamp: visibility by kind of ray"),
    "light linking": (
        lambda: setattr(bpy.data.objects["lamp"].light_linking, "receiver_collection", bpy.data.collections.new("linked")),
        "light lamp: light linking cannot be rendered",
    ),
}


@pytest.mark.parametrize("make, text", SEEN.values(), ids=SEEN.keys())
def test_odd_scenes_are_rendered_and_said(make, text):
    room()
    plain = combined()
    make()
    picture = combined()
    assert np.isfinite(picture).all() and picture[..., :3].max() > 0
    assert len(messages()) == (text is not None), messages()
    assert text is None or messages()[0].startswith(text)
    assert text is not None or not np.array_equal(picture, plain)


def test_a_color_in_place_of_a_shader_glows_as_in_cycles():
    new_scene(8, 8, 1)
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=1)
    nodes = Nodes("glow")
    color = nodes.add("RGB")
    color.outputs[0].default_value = (0.3, 0.2, 0.1, 1)
    add_plane(2, material=nodes.surface(color))
    assert combined()[4, 4, :3] == pytest.approx([0.3, 0.2, 0.1], abs=1e-5)
    assert messages() == ["object plane: an open surface that glows shines from its front only"]


def test_light_that_is_negative_is_said():
    room()
    nodes = Nodes("dark")
    cube(nodes.surface(nodes.add("Emission", Strength=-1.0)))
    combined()
    assert messages() == ["material dark: Emission: light that is negative cannot be rendered; it is 0"]


@pytest.mark.parametrize("make", [lambda: link("nobody", None), lambda: bpy.data.objects["lamp"]], ids=["an empty", "a lamp"])
def test_a_camera_that_is_none_is_an_error(make):
    scene = room()
    scene.camera = make()
    with pytest.raises(RuntimeError, match="is no camera"):
        combined()


def test_one_percent_of_a_picture():
    room(320, 200).render.resolution_percentage = 1
    assert combined().shape == (2, 3, 4)


def test_regions_without_pixels_are_refused():
    settings = room().render
    settings.use_border = True
    settings.border_min_x = settings.border_max_x = settings.border_min_y = settings.border_max_y = 1.0
    with pytest.raises(RuntimeError, match="small"):
        combined()


def test_objects_of_libraries_are_rendered(tmp_path):
    room()
    owner = cube(wax(), location=(1, 0, 0))
    owner.name = "Shared"
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {owner})
    bpy.data.objects.remove(owner)
    plain = combined()
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, chosen):
        chosen.objects = ["Shared"]
    bpy.context.scene.collection.objects.link(chosen.objects[0])
    linked = combined()
    assert not np.array_equal(linked, plain)
    # Its namesake of this file is another object.
    cube(wax(), location=(-1, 0, 0)).name = "Shared"
    assert not np.array_equal(combined(), linked)
    assert messages() == []


def test_ten_thousand_instances():
    room()
    owner = cube(wax(), size=0.05)
    random = np.random.default_rng(1)
    for place in random.uniform(-2, 2, (10000, 3)):
        copy = owner.copy()
        copy.location = place
        bpy.context.scene.collection.objects.link(copy)
    assert np.isfinite(combined()).all()
    assert messages() == []


def test_overrides_of_a_view_layer():
    scene = room()
    plain, layer = combined(), bpy.context.view_layer
    nodes = Nodes("glow")
    layer.material_override = nodes.surface(nodes.add("Emission", Color=(1, 0, 0)))
    assert combined()[12, 12, :3] == pytest.approx([1, 0, 0], abs=1e-3)
    layer.material_override = None
    layer.use_solid = False
    assert np.ptp(combined()[..., :3], axis=(0, 1)).max() < 1e-6
    layer.use_solid = True
    layer.use_sky = False
    assert combined()[0, 0, :3].max() == 0
    layer.use_sky = True
    layer.samples = 2
    fewer = combined()
    layer.samples, scene.translucid.samples = 0, 2
    assert np.array_equal(combined(), fewer) and not np.array_equal(fewer, plain)


def test_excluded_from_a_view_layer_by_half():
    scene = room()
    collection = bpy.data.collections.new("half")
    scene.collection.children.link(collection)
    owner = cube(wax())
    scene.collection.objects.unlink(owner)
    collection.objects.link(owner)
    half = bpy.context.view_layer.layer_collection.children["half"]
    half.holdout = True
    combined()
    assert messages() == ["object Cube: a holdout cannot be rendered; it is seen"]
    half.holdout, half.indirect_only = False, True
    combined()
    assert messages() == ["object Cube: what is seen indirectly only cannot be rendered; it is seen"]


def test_layers_of_one_picture_say_what_they_have_to_say_once(monkeypatch):
    scene = room()
    nodes = Nodes("rust")
    cube(nodes.surface(nodes.add("BsdfDiffuse", Color=nodes.add("TexNoise").outputs[1])))
    scene.view_layers.new("other")
    unsaid, said = addon.engine.Report.unsaid, []
    monkeypatch.setattr(addon.engine.Report, "unsaid", lambda report: said.append(unsaid(report)) or said[-1])
    render()
    assert [len(new) for new in said] == [1, 0] and said[0] == messages()
    render()
    assert [len(new) for new in said] == [1, 0, 1, 0]
