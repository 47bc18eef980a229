# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees as materials: beside Cycles, and what is said of what cannot be translated."""

import bpy
import numpy as np
import pytest
from harness import HAS_LEGACY_WALK, LEGACY_WALK, Nodes, add_camera, add_light, add_plane, addon, combined, matte, messages, new_scene, radians, regions, render_cycles, set_world

# Modules of the extension, which is loaded under a name of its own.
material_of = addon.engine.Exporter.describe.__globals__["material_of"]
Report = addon.engine.Report


def translate(material, model=None):
    report = Report()
    return material_of(material, report, model).keys, report.messages


def of(kind, **inputs):
    nodes = Nodes()
    return nodes.surface(nodes.add(kind, **inputs))


def mixed(factor, a, b, kind="MixShader"):
    nodes = Nodes()
    first, second = (nodes.add(name, **inputs) for name, inputs in (a, b))
    sockets = {"i1": first.outputs[0], "i2": second.outputs[0], "i0": factor}
    if kind == "AddShader":
        sockets = {"i0": first.outputs[0], "i1": second.outputs[0]}
    return nodes.surface(nodes.add(kind, **sockets))


def scattering(kind, method, **inputs):
    nodes = Nodes()
    node = nodes.add(kind, **inputs)
    if kind == "BsdfPrincipled":
        node.subsurface_method = method
    else:
        node.falloff = method
    return nodes.surface(node)


DIFFUSE = ("BsdfDiffuse", dict(Color=(0.7, 0.3, 0.2)))
BLUE = ("BsdfDiffuse", dict(Color=(0.1, 0.3, 0.9)))
GLOSSY = ("BsdfAnisotropic", dict(Color=(0.9, 0.8, 0.4), Roughness=0.4))
EMISSION = ("Emission", dict(Color=(1, 0.5, 0.2), Strength=2.0))
CLEAR = ("BsdfTransparent", {})

# Material, and how far the light of all of it may be from Cycles'.
BESIDE_CYCLES = {
    "none": (lambda: None, 0.01),
    "diffuse": (lambda: of(*DIFFUSE[:1], **DIFFUSE[1]), 0.01),
    "principled": (lambda: of("BsdfPrincipled", Base_Color=(0.6, 0.3, 0.1)), 0.01),
    "shiny": (lambda: of("BsdfPrincipled", Base_Color=(0.6, 0.3, 0.1), Roughness=0.2), 0.015),
    "metal": (lambda: of("BsdfPrincipled", Base_Color=(0.9, 0.6, 0.3), Metallic=1.0, Roughness=0.3), 0.015),
    "half metal": (lambda: of("BsdfPrincipled", Base_Color=(0.9, 0.6, 0.3), Metallic=0.5, Roughness=0.3), 0.015),
    "specular level": (lambda: of("BsdfPrincipled", Base_Color=(0.1,) * 3, Specular_IOR_Level=0.9, Roughness=0.3), 0.015),
    "coat": (lambda: of("BsdfPrincipled", Base_Color=(0.6, 0.3, 0.1), Coat_Weight=1.0), 0.01),
    "half transparent": (lambda: of("BsdfPrincipled", Base_Color=(0.6, 0.3, 0.1), Alpha=0.4), 0.01),
    "glowing": (lambda: of("BsdfPrincipled", Base_Color=(0.6, 0.3, 0.1), Emission_Color=(0.2, 0.5, 1), Emission_Strength=1.5), 0.01),
    "glossy": (lambda: of(*GLOSSY[:1], **GLOSSY[1]), 0.015),
    "dark glossy": (lambda: of("BsdfAnisotropic", Color=(0.4, 0.2, 0.1), Roughness=0.3), 0.015),
    "metallic": (lambda: of("BsdfMetallic", Base_Color=(0.6, 0.4, 0.2), Edge_Tint=(0.2, 0.5, 0.9), Roughness=0.3), 0.015),
    "diffuse and glossy added": (lambda: mixed(None, ("BsdfDiffuse", dict(Color=(0.6, 0.3, 0.1))), ("BsdfAnisotropic", dict(Color=(0.2, 0.2, 0.2), Roughness=0.3)), "AddShader"), 0.015),
    "two diffuse added": (lambda: mixed(None, ("BsdfDiffuse", dict(Color=(0.6, 0.3, 0.1))), ("BsdfDiffuse", dict(Color=(0.1, 0.2, 0.5))), "AddShader"), 0.01),
    "glass": (lambda: of("BsdfGlass", Color=(0.9, 0.9, 0.7), Roughness=0.0), 0.02),
    "diffuse and glossy": (lambda: mixed(0.3, DIFFUSE, GLOSSY), 0.015),
    "two diffuse": (lambda: mixed(0.3, DIFFUSE, BLUE), 0.01),
    "transparent and diffuse": (lambda: mixed(0.3, CLEAR, DIFFUSE), 0.01),
    "diffuse mixed with emission": (lambda: mixed(0.3, DIFFUSE, EMISSION), 0.01),
    "diffuse and emission added": (lambda: mixed(None, DIFFUSE, EMISSION, "AddShader"), 0.01),
    "Burley": (lambda: scattering("SubsurfaceScattering", "BURLEY", Color=(0.8, 0.5, 0.2), Scale=0.3, Radius=(1, 0.5, 0.25)), 0.02),
    "random walk": (lambda: scattering("SubsurfaceScattering", "RANDOM_WALK", Color=(0.8, 0.5, 0.2), Scale=0.3, Radius=(1, 0.5, 0.25)), 0.02),
    "skin": (lambda: scattering("SubsurfaceScattering", "RANDOM_WALK_SKIN", Color=(0.8, 0.5, 0.2), Scale=0.3, Radius=(1, 0.5, 0.25)), 0.02),
    "principled Burley": (lambda: scattering("BsdfPrincipled", "BURLEY", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=1.0, Subsurface_Scale=0.3), 0.02),
    "principled walk": (lambda: scattering("BsdfPrincipled", "RANDOM_WALK", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=1.0, Subsurface_Scale=0.3), 0.02),
    "principled skin": (lambda: scattering("BsdfPrincipled", "RANDOM_WALK_SKIN", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=1.0, Subsurface_Scale=0.3), 0.02),
    # Cycles goes on in the similar isotropic medium after ten flights.
    "principled walk forward": (lambda: scattering("BsdfPrincipled", "RANDOM_WALK", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=1.0, Subsurface_Scale=0.05, Subsurface_Anisotropy=0.7), 0.03),
    "half scattering": (lambda: scattering("BsdfPrincipled", "RANDOM_WALK", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=0.5, Subsurface_Scale=0.3), 0.02),
}
if HAS_LEGACY_WALK:
    BESIDE_CYCLES |= {
        "legacy walk": (lambda: scattering("SubsurfaceScattering", "RANDOM_WALK_LEGACY", Color=(0.8, 0.5, 0.2), Scale=0.3, Radius=(1, 0.5, 0.25)), 0.02),
        "principled legacy walk": (lambda: scattering("BsdfPrincipled", "RANDOM_WALK_LEGACY", Base_Color=(0.8, 0.5, 0.2), Subsurface_Weight=1.0, Subsurface_Scale=0.3), 0.02),
    }


@pytest.mark.parametrize("make, tolerance", BESIDE_CYCLES.values(), ids=BESIDE_CYCLES.keys())
def test_materials_are_as_bright_as_in_cycles(make, tolerance):
    scene = new_scene(40, 40, 200)
    scene.translucid.use_caustics = True
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    material = make()
    if material is not None:
        ball.data.materials.append(material)
    add_plane(8, z=-1, material=matte((0.6, 0.6, 0.6), "floor"))
    add_camera((0, -4, 1.2), radians(78, 0, 0), lens=45)
    add_light("AREA", (2, -2, 3), radians(40, 0, 45), energy=200.0, size=1.5)
    set_world((0.3, 0.35, 0.4))
    inner = (slice(9, 31), slice(9, 31), slice(0, 3))
    ours, theirs = combined()[inner], render_cycles(200)[inner]
    ratio = ours.mean(axis=(0, 1)) / theirs.mean(axis=(0, 1))
    parts = regions(ours, 3, 3) / regions(theirs, 3, 3)
    print(f"ratio {ratio.round(4)}, regions {parts.min():.4f} to {parts.max():.4f}")
    assert messages() == []
    # 484 pixels of 200 samples: the noise of the mean is below 0.3 %.
    assert np.abs(ratio - 1).max() < tolerance


HAS_THIN_WALL = "Thin Wall" in Nodes("probe").add("BsdfPrincipled").inputs
needs_thin_wall = pytest.mark.skipif(not HAS_THIN_WALL, reason="Principled BSDF has Thin Wall since Blender 5.2")


def thin(**inputs):
    return of("BsdfPrincipled", Base_Color=(0.8, 0.5, 0.3), Thin_Wall=True, **inputs)


LEAF = dict(Subsurface_Weight=1.0, Specular_IOR_Level=0.0)
PANE = dict(Transmission_Weight=1.0)

# A sheet, and the lights that are left out: under an interface Cycles' diffuse light from a direction is another than ours,
# from all directions the same; and no sun is seen in a mirror.
SHEETS = {
    "leaf": (LEAF, ()),
    "leaf forward": (LEAF | dict(Subsurface_Anisotropy=0.5), ()),
    "leaf backward": (LEAF | dict(Subsurface_Anisotropy=-0.5), ()),
    "half leaf": (LEAF | dict(Subsurface_Weight=0.5), ()),
    "shiny leaf": (dict(Subsurface_Weight=1.0), ("sun",)),
    "coated leaf": (dict(Subsurface_Weight=1.0, Coat_Weight=1.0), ("sun",)),
    "card": (dict(Specular_IOR_Level=0.0), ()),
    "metal": (dict(Metallic=1.0), ("sun",)),
    "half there": (LEAF | dict(Alpha=0.5), ()),
    "smooth pane": (PANE | dict(Roughness=0.0), ("sun",)),
    "rough pane": (PANE | dict(Roughness=0.3), ("sun",)),
    "pane and leaf": (LEAF | dict(Transmission_Weight=0.5, Roughness=0.0, Specular_IOR_Level=0.5), ("sun",)),
}


@needs_thin_wall
@pytest.mark.parametrize("side", [0, 180], ids=["in front", "behind"])
@pytest.mark.parametrize("inputs, left_out", SHEETS.values(), ids=SHEETS.keys())
def test_thin_sheets_are_as_bright_as_in_cycles(inputs, left_out, side):
    for light in {"sun", "sky"} - set(left_out):
        scene = new_scene(16, 16, 512)
        scene.translucid.use_caustics = True
        add_plane(50, material=thin(**inputs))
        add_camera((0, -5 * 3**0.5, 5), radians(60, 0, 0), type="ORTHO", ortho_scale=0.5)
        set_world((0, 0, 0))
        if light == "sun":
            add_light("SUN", rotation=radians(side + 20, 0, 0), energy=np.pi, angle=0.0)
        else:
            # A black plane hides the other half of the sky.
            set_world((1, 1, 1))
            add_plane(1e4, z=-20 if side == 0 else 20, material=matte((0, 0, 0), "black"))
        ours, theirs = combined()[..., :3].mean(axis=(0, 1)), render_cycles(512)[..., :3].mean(axis=(0, 1))
        print(f"{light}: {ours.round(4)}, Cycles {theirs.round(4)}")
        assert messages() == []
        # Between a coat and what reflects under it Cycles' light is a little more, with and without Thin Wall.
        assert ours == pytest.approx(theirs, rel=0.02 if "Coat_Weight" in inputs else 0.01, abs=0.002)


@needs_thin_wall
def test_light_passes_thin_panes_on_its_way_as_in_cycles():
    scene = new_scene(16, 16, 256)
    add_plane(50, material=matte())
    add_plane(50, z=1, material=thin(Transmission_Weight=1.0, Roughness=0.0))
    add_camera((0, 0, 0.5), type="ORTHO", ortho_scale=0.5)
    add_light("SUN", rotation=radians(30, 0, 0), energy=np.pi, angle=0.0)
    for caustics in (True, False):
        scene.translucid.use_caustics = caustics
        ours, theirs = combined()[..., :3].mean(axis=(0, 1)), render_cycles(256)[..., :3].mean(axis=(0, 1))
        print(f"{ours.round(4)}, Cycles {theirs.round(4)}")
        assert ours == pytest.approx(theirs, rel=0.02)


@needs_thin_wall
def test_thin_walls_are_told_from_bodies():
    keys, said = translate(thin(Subsurface_Weight=1.0, Subsurface_Anisotropy=1.0))
    assert keys["geometry_thin_walled"] is True and "subsurface_radius" not in keys
    assert keys["subsurface_color"] == pytest.approx([0.8, 0.5, 0.3])
    assert keys["subsurface_scatter_anisotropy"] == pytest.approx(1, abs=1e-3) and said == []
    keys, said = translate(of("BsdfPrincipled", Subsurface_Weight=1.0))
    assert "geometry_thin_walled" not in keys and said == []
    leaf, glass = dict(Thin_Wall=True, Subsurface_Weight=1.0), dict(Transmission_Weight=1.0)
    keys, said = translate(mixed(0.5, ("BsdfPrincipled", leaf), ("BsdfPrincipled", glass)))
    assert keys["geometry_thin_walled"] is True and "thin-walled parts" in said[0]


@needs_thin_wall
def test_a_thin_wall_that_is_linked_has_its_value():
    nodes = Nodes()
    number = nodes.add("Value")
    number.outputs[0].default_value = 1.0
    keys, said = translate(nodes.surface(nodes.add("BsdfPrincipled", Thin_Wall=number.outputs[0], Subsurface_Weight=1.0)))
    assert keys["geometry_thin_walled"] is True and said == []
    image, _ = checker()
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image = image
    _, said = translate(nodes.surface(nodes.add("BsdfPrincipled", Thin_Wall=texture.outputs[0], Subsurface_Weight=1.0)))
    assert len(said) == 1 and "Thin Wall cannot change over a surface" in said[0]


def test_constant_nodes_become_numbers():
    nodes = Nodes()
    ramp = nodes.add("ValToRGB", Fac=0.25)
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0, 0, 0, 1), (1, 0.5, 0, 1)
    keys, said = translate(nodes.surface(nodes.add("BsdfDiffuse", Color=ramp.outputs[0])))
    assert keys["base_color"] == pytest.approx([0.25, 0.125, 0], abs=1e-4)
    nodes = Nodes()
    math = nodes.add("Math", i0=0.3, i1=0.5)
    math.operation = "MULTIPLY"
    keys, _ = translate(nodes.surface(nodes.add("BsdfPrincipled", Roughness=math.outputs[0])))
    assert keys["specular_roughness"] == pytest.approx(0.15)
    assert said == []


def checker(size=8):
    image = bpy.data.images.new("checker", size, size, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    x, y = np.meshgrid(np.arange(size), np.arange(size))
    pixels = np.stack([(x + y) % 2, x / size, y / size, np.ones_like(x)], axis=-1)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    return image, pixels[::-1, :, :3]


def test_textures_through_ramps_and_mixes_are_baked():
    image, pixels = checker()
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image = image
    mix = nodes.add("MixRGB", i0=0.25, i1=texture.outputs[0], i2=(1, 1, 1))
    keys, said = translate(nodes.surface(nodes.add("BsdfDiffuse", Color=mix.outputs[0])))
    assert np.allclose(keys["base_color"]["image"], pixels * 0.75 + 0.25, atol=1e-6)
    assert said == []
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image = image
    ramp = nodes.add("ValToRGB", Fac=texture.outputs[0])
    keys, _ = translate(nodes.surface(nodes.add("BsdfPrincipled", Roughness=ramp.outputs[0])))
    gray = pixels @ np.array([0.2126, 0.7152, 0.0722])
    assert np.allclose(keys["specular_roughness"]["image"], gray, atol=1e-3)


def test_byte_images_keep_their_codes():
    image = bpy.data.images.new("bytes", 4, 4)
    image.pixels.foreach_set(np.tile(np.array([128 / 255, 64 / 255, 1, 1], dtype=np.float32), 16))
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image = image
    keys, said = translate(nodes.surface(nodes.add("BsdfDiffuse", Color=texture.outputs[0])))
    table = keys["base_color"]
    assert table["image"].dtype == np.uint8 and table["image"][0, 0].tolist() == [128, 64, 255]
    assert table["color_space"] == "srgb" and said == []


def test_groups_reroutes_and_muted_nodes_are_seen_through():
    tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
    tree.interface.new_socket("Color", in_out="INPUT", socket_type="NodeSocketColor")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    begin, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    inner = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(begin.outputs[0], inner.inputs["Color"])
    tree.links.new(inner.outputs[0], end.inputs[0])
    nodes = Nodes()
    group = nodes.add("Group")
    group.node_tree = tree
    invert = nodes.add("Invert", Color=(0.2, 0.4, 0.6))
    invert.mute = True
    reroute = nodes.tree.nodes.new("NodeReroute")
    nodes.tree.links.new(invert.outputs[0], reroute.inputs[0])
    nodes.tree.links.new(reroute.outputs[0], group.inputs[0])
    keys, said = translate(nodes.surface(group))
    assert keys["base_color"] == pytest.approx([0.2, 0.4, 0.6])
    assert said == []


def test_models_are_a_menu_away():
    material = scattering("SubsurfaceScattering", LEGACY_WALK, Color=(0.8, 0.5, 0.2), Scale=0.3)
    as_node, _ = translate(material)
    exact, _ = translate(material, "random-walk")
    assert as_node["subsurface_model"] == "random-walk-rough" and exact["subsurface_model"] == "random-walk"
    assert exact["subsurface_radius_scale"] == as_node["subsurface_radius_scale"]
    # Of Cycles' walks the color is not quite the albedo.
    assert exact["subsurface_color"] == pytest.approx([0.8, 0.5, 0.2]) and as_node["subsurface_color"][0] > 0.81


def with_property(node, **properties):
    for name, value in properties.items():
        setattr(node, name, value)
    return node


SAID = {
    "noise": (lambda n: n.add("BsdfDiffuse", Color=n.add("TexNoise").outputs[1]), "Noise Texture: a Noise Texture node"),
    "bump": (lambda n: n.add("BsdfDiffuse", Normal=n.add("Bump").outputs[0]), "Bump: normals from a Bump node"),
    "toon": (lambda n: n.add("BsdfToon"), "Toon BSDF: a Toon BSDF node cannot be translated; it is diffuse"),
    "sheen": (lambda n: n.add("BsdfPrincipled", Sheen_Weight=0.3), "Principled BSDF: sheen"),
    "coat's tint": (lambda n: n.add("BsdfPrincipled", Coat_Weight=1.0, Coat_Tint=(0.9, 0.8, 0.7)), "Principled BSDF: the tint of a coat"),
    "specular tint": (lambda n: n.add("BsdfPrincipled", Specular_Tint=(0.9, 0.8, 0.7)), "Principled BSDF: the specular tint"),
    "thin film": (lambda n: n.add("BsdfGlass", Thin_Film_Thickness=300.0), "Glass BSDF: a thin film"),
    "distribution": (lambda n: with_property(n.add("BsdfAnisotropic"), distribution="GGX"), "Glossy BSDF: the distribution GGX"),
    "conductor": (lambda n: with_property(n.add("BsdfMetallic"), fresnel_type="PHYSICAL_CONDUCTOR"), "Metallic BSDF: physical conductors"),
    "bright": (lambda n: n.add("BsdfDiffuse", Color=n.add("Math", i0=1.0, i1=1.0).outputs[0]), "Diffuse BSDF: Color above 1"),
    "environment": (lambda n: n.add("BsdfDiffuse", Color=with_property(n.add("TexEnvironment"), image=checker()[0]).outputs[0]), "Environment Texture: an environment"),
    "no image": (lambda n: n.add("BsdfDiffuse", Color=n.add("TexImage").outputs[0]), "Image Texture: it has no image"),
}


@pytest.mark.parametrize("make, text", SAID.values(), ids=SAID.keys())
def test_what_cannot_be_translated_is_said_and_seen(make, text):
    new_scene(16, 16, 8)
    nodes = Nodes("odd")
    add_plane(2, material=nodes.surface(make(nodes)))
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=2)
    set_world((1, 1, 1))
    picture = combined()
    assert len(messages()) == 1
    assert messages()[0].startswith(f"material odd: {text}")
    assert picture[..., :3].max() > 0.1, "it is black"


def test_an_open_surface_that_glows_is_said():
    new_scene(16, 16, 8)
    add_plane(2, material=of(*EMISSION[:1], **EMISSION[1]))
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=2)
    combined()
    assert messages() == ["object plane: an open surface that glows shines from its front only"]
    bpy.data.objects.remove(bpy.data.objects["plane"])
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1)
    bpy.context.object.data.materials.append(of(*EMISSION[:1], **EMISSION[1]))
    combined()
    assert messages() == []


def test_a_texture_where_one_number_is_wanted_is_said():
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image, _ = checker()
    keys, said = translate(nodes.surface(nodes.add("BsdfPrincipled", IOR=texture.outputs[0])))
    assert len(said) == 1 and said[0].endswith("Principled BSDF: a texture of IOR cannot be translated; its mean is used")


def test_a_hidden_color_counts():
    nodes = Nodes()
    gamma = nodes.add("Gamma", Color=(0.25, 0.5, 0.75), Gamma=2.0)
    keys, said = translate(nodes.surface(nodes.add("BsdfDiffuse", Color=gamma.outputs[0])))
    assert keys["base_color"] == pytest.approx([0.0625, 0.25, 0.5625]) and said == []


def value_of(kind, properties, inputs):
    """The color of a surface by the enabled output of a node."""
    nodes = Nodes()
    node = with_property(nodes.add(kind), **properties)
    for socket, value in zip([socket for socket in node.inputs if socket.enabled], inputs, strict=False):
        socket.default_value = (*value, 1) if socket.type == "RGBA" else value
    output = next(output for output in node.outputs if output.enabled)
    keys, said = translate(nodes.surface(nodes.add("BsdfDiffuse", Color=output)))
    assert said == []
    return keys["base_color"]


A, B, C = (0.3, 0.6, 0.9), (0.5, 0.2, 0.4), (0.1, 0.7, 0.2)

# Kind, properties, inputs; the color worked out by hand.
WORKED_OUT = [
    ("Math", dict(operation="WRAP"), (0.9, 0.5, 0.2), [0.3] * 3),
    ("Math", dict(operation="PINGPONG"), (0.7, 0.5), [0.3] * 3),
    ("Math", dict(operation="SNAP"), (0.7, 0.25), [0.5] * 3),
    ("Math", dict(operation="SMOOTH_MIN"), (0.5, 0.5, 0.3), [0.45] * 3),
    ("Math", dict(operation="SMOOTH_MAX"), (0.5, 0.5, 0.3), [0.55] * 3),
    ("Math", dict(operation="POWER"), (-0.5, 2.0), [0.25] * 3),
    ("Math", dict(operation="LOGARITHM"), (0.5, 1.0), [0.0] * 3),
    ("VectorMath", dict(operation="MULTIPLY"), (A, B), [0.15, 0.12, 0.36]),
    ("VectorMath", dict(operation="CROSS_PRODUCT"), (B, A), [0, 0, 0.24]),
    ("VectorMath", dict(operation="DOT_PRODUCT"), (A, B), [0.63] * 3),
    ("VectorMath", dict(operation="FACEFORWARD"), (A, B, (-1, 0, 0)), list(A)),
    ("VectorMath", dict(operation="REFLECT"), (A, (0, 0, 1)), [0.3, 0.6, 0]),
    ("MapRange", dict(interpolation_type="STEPPED"), (0.6, 0.0, 1.0, 0.0, 1.0, 4.0), [0.75] * 3),
    ("MapRange", dict(interpolation_type="SMOOTHERSTEP"), (0.5, 0.0, 1.0, 0.2, 0.6), [0.4] * 3),
    ("VectorRotate", dict(rotation_type="Z_AXIS"), ((0, 0, 0.5), (0, 0, 0), np.pi / 2), [0, 0, 0]),
    ("CombineColor", dict(mode="HSL"), (0.0, 1.0, 0.25), [0.5, 0, 0]),
    ("MixRGB", dict(blend_type="HUE"), (1.0, (0.6, 0.3, 0.3), (0, 0, 0.4)), [0.3, 0.3, 0.6]),
    ("MixRGB", dict(blend_type="VALUE"), (0.5, (0.6, 0.3, 0.3), (0, 0, 0.4)), [0.5, 0.25, 0.25]),
    ("MixRGB", dict(blend_type="DODGE"), (0.5, (0.3, 0.3, 0.3), (0.8, 0.8, 0.8)), [0.5] * 3),
    ("MixRGB", dict(blend_type="BURN"), (0.5, (0.7, 0.7, 0.7), (0.2, 0.2, 0.2)), [0.5] * 3),
]


@pytest.mark.parametrize("kind, properties, inputs, color", WORKED_OUT, ids=["-".join([row[0], *row[1].values()]) for row in WORKED_OUT])
def test_operations_are_cycles_own(kind, properties, inputs, color):
    assert value_of(kind, properties, inputs) == pytest.approx(color, abs=1e-5)


def test_a_material_without_a_surface_is_said_and_seen():
    new_scene(16, 16, 8)
    add_plane(2, material=Nodes("bare").material)
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=2)
    set_world((1, 1, 1))
    assert combined()[8, 8, 0] == pytest.approx(0.8, abs=0.02)
    assert "there is no surface" in messages()[0]


@pytest.mark.parametrize("convention", ["OPENGL", "DIRECTX"])
def test_green_of_a_normal_map_points_where_its_convention_says(convention):
    new_scene(16, 16, 32)
    image = bpy.data.images.new("normals", 2, 2, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    # Tilted toward +v by atan(3/4), or away from it.
    image.pixels.foreach_set(np.tile(np.array([0.5, 0.8, 0.9, 1], dtype=np.float32), 4))
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image = image
    normal = nodes.add("NormalMap", Color=texture.outputs[0])
    if not hasattr(normal, "convention"):
        pytest.skip("Normal Map has no convention before Blender 5.1")
    normal.convention = convention
    add_plane(2, material=nodes.surface(nodes.add("BsdfDiffuse", Color=(0.5,) * 3, Normal=normal.outputs[0])))
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=1)
    add_light("SUN", rotation=radians(20, 0, 0), energy=1.0, angle=0.0)
    ours, theirs = combined()[8, 8, 0], render_cycles(32)[8, 8, 0]
    # The sun is 20° from the zenith toward -y.
    sign = 1 if convention == "OPENGL" else -1
    assert ours == pytest.approx(0.5 / np.pi * np.cos(np.radians(36.87 + sign * 20)), rel=0.01)
    assert theirs == pytest.approx(ours, rel=0.01)


def test_normal_maps_turn_normals():
    new_scene(16, 16, 32)
    image = bpy.data.images.new("normals", 2, 2, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    # Tilted toward +u by atan(3/4).
    image.pixels.foreach_set(np.tile(np.array([0.8, 0.5, 0.9, 1], dtype=np.float32), 4))
    nodes = Nodes()
    texture = nodes.add("TexImage")
    texture.image = image
    normal = nodes.add("NormalMap", Color=texture.outputs[0])
    add_plane(2, material=nodes.surface(nodes.add("BsdfDiffuse", Color=(0.5,) * 3, Normal=normal.outputs[0])))
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=1)
    bpy.context.view_layer.use_pass_normal = True
    add_light("SUN", rotation=radians(0, 20, 0), energy=1.0, angle=0.0)
    ours, theirs = combined()[8, 8, 0], render_cycles(32)[8, 8, 0]
    # The sun is 20° from the zenith toward +x, the normal 36.9°.
    expected = 0.5 / np.pi * np.cos(np.radians(36.87 - 20))
    assert ours == pytest.approx(expected, rel=0.01)
    assert theirs == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("extension", ("exr", "png"))
@pytest.mark.parametrize("use", ("color", "cut-out", "data", "world"))
def test_alpha_of_pictures_is_associated_as_in_cycles(tmp_path, extension, use):
    path = str(tmp_path / f"half.{extension}")
    image = bpy.data.images.new("half", 4, 4, alpha=True, float_buffer=extension == "exr")
    space = "Linear Rec.709" if extension == "exr" else "sRGB"
    image.colorspace_settings.name = space
    image.pixels.foreach_set(np.tile(np.array([0.2, 0.1, 0.05, 0.5], dtype=np.float32), 16))
    image.file_format, image.filepath_raw = {"exr": "OPEN_EXR", "png": "PNG"}[extension], path
    image.save()
    new_scene(16, 16, 64)
    add_camera((0, 0, 10), (0, 0, 0))
    set_world((1, 1, 1))
    nodes = Nodes()
    texture = nodes.add("TexEnvironment" if use == "world" else "TexImage")
    texture.image = bpy.data.images.load(path)
    texture.image.colorspace_settings.name = "Non-Color" if use == "data" else space
    if use == "world":
        world = bpy.context.scene.world
        world.use_nodes = True
        tree = world.node_tree
        background = next(node for node in tree.nodes if node.type == "BACKGROUND")
        sky = tree.nodes.new("ShaderNodeTexEnvironment")
        sky.image = texture.image
        tree.links.new(sky.outputs[0], background.inputs["Color"])
        add_plane(5, 0, of("BsdfDiffuse", Color=(0.8, 0.8, 0.8)))
    elif use == "cut-out":
        principled = nodes.add("BsdfPrincipled", Base_Color=texture.outputs[0], Alpha=texture.outputs[1], Specular_IOR_Level=0.0)
        add_plane(5, 0, nodes.surface(principled))
    else:
        add_plane(5, 0, nodes.surface(nodes.add("BsdfDiffuse", Color=texture.outputs[0])))
    ours, cycles = (picture[4:12, 4:12, :3].mean(axis=(0, 1)) for picture in (combined(), render_cycles(64)))
    assert np.allclose(ours, cycles, rtol=0.03, atol=0.003), (ours, cycles)
