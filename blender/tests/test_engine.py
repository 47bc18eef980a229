# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender asks of an engine: passes, regions, layers, seeds, errors, the user's word."""

import re
import sys
import threading
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
import translucid
from harness import Nodes, add_camera, add_light, add_plane, addon, combined, compositor, link, matte, messages, new_scene, radians, render, set_world


def still_life(width=64, height=48, samples=8, **settings):
    scene = new_scene(width, height, samples, **settings)
    bpy.ops.mesh.primitive_monkey_add()
    nodes = Nodes("skin")
    bpy.context.object.data.materials.append(
        nodes.surface(nodes.add("BsdfPrincipled", Base_Color=(0.8, 0.5, 0.3), Subsurface_Weight=0.7, Subsurface_Scale=0.1))
    )
    add_plane(4, z=-1, material=matte())
    nodes = Nodes("glow")
    bpy.ops.mesh.primitive_cube_add(size=0.3, location=(1.2, -1, -0.8))
    bpy.context.object.data.materials.append(nodes.surface(nodes.add("Emission", Color=(0.2, 0.4, 1), Strength=2.0)))
    add_camera((0, -6, 1), radians(82, 0, 0))
    add_light("AREA", (2, -3, 4), radians(40, 0, 40), energy=300.0, size=1.0)
    set_world((0.1, 0.1, 0.12))
    return scene


def test_passes_add_up():
    still_life(samples=16)
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True
    for name in ("use_diffuse", "use_glossy", "use_subsurface", "use_emission", "use_albedo"):
        setattr(layer.translucid, name, True)
    found = {name.rsplit(".", 1)[-1]: value for name, value in render().items()}
    assert {"Combined", "Depth", "Normal", "Diffuse", "Glossy", "Subsurface", "Emission", "Albedo"} <= found.keys()
    parts = sum(found[name] for name in ("Diffuse", "Glossy", "Subsurface", "Emission"))
    assert np.allclose(parts, found["Combined"][..., :3], rtol=1e-4, atol=1e-5)
    assert all(found[name].max() > 0 for name in ("Diffuse", "Glossy", "Subsurface", "Emission", "Albedo"))
    # The floor, seen in the lowest rows.
    assert np.abs(found["Normal"][-3:, 2:20] - [0, 0, 1]).max() < 1e-3


@pytest.mark.parametrize("name", ["Depth", "Normal", "Subsurface"])
def test_the_compositor_has_the_passes(name):
    still_life(samples=2)
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True
    for each in ("use_diffuse", "use_glossy", "use_subsurface", "use_emission", "use_albedo"):
        setattr(layer.translucid, each, True)

    def make(nodes, links):
        outputs = nodes.new("CompositorNodeRLayers").outputs
        # As Cycles calls them, the last but for Emission ours.
        names = ["Image", "Alpha", "Depth", "Normal", "Diffuse", "Glossy", "Subsurface", "Emission", "Albedo"]
        assert [output.name for output in outputs if output.enabled] == names
        return outputs[name]

    compositor(make)
    found = render()
    made, expected = found["Composite.Combined"][..., :3], found[f"ViewLayer.{name}"]
    assert np.array_equal(made, np.broadcast_to(expected, made.shape))
    assert expected.max() > 0


def test_depth_is_along_the_view():
    new_scene(64, 48, 16)
    bpy.context.view_layer.use_pass_z = True
    add_plane(50.0, z=0, material=matte())
    add_camera((0, 0, 7.5), lens=20.0, shift_x=0.2)
    depth = next(value for name, value in render().items() if name.endswith("Depth"))
    assert np.abs(depth - 7.5).max() < 0.01
    bpy.context.scene.camera.rotation_euler = radians(180, 0, 0)
    depth = next(value for name, value in render().items() if name.endswith("Depth"))
    assert depth.min() == pytest.approx(1e10, rel=1e-6)


def test_regions_have_the_pixels_of_the_whole():
    scene = still_life(samples=4)
    whole = combined()
    render_settings = scene.render
    render_settings.use_border = True
    render_settings.border_min_x, render_settings.border_max_x = 0.25, 0.75
    render_settings.border_min_y, render_settings.border_max_y = 0.5, 1.0
    part = combined()
    assert np.array_equal(part[:24, 16:48], whole[:24, 16:48])
    assert part[24:].max() == 0 and part[:, :16].max() == 0
    render_settings.use_crop_to_border = True
    assert np.array_equal(combined(), whole[:24, 16:48])


def test_resolution_percentage():
    scene = still_life(samples=1)
    scene.render.resolution_percentage = 50
    assert combined().shape == (24, 32, 4)


def test_seed_and_frame_change_the_noise_only():
    scene = still_life(samples=4)
    first = combined()
    assert np.array_equal(first, combined())
    scene.frame_set(2)
    assert not np.array_equal(first, combined())
    scene.translucid.use_animated_seed = False
    second = combined()
    scene.frame_set(3)
    assert np.array_equal(second, combined())
    scene.translucid.seed = 5
    assert not np.array_equal(second, combined())


def test_threads_do_not_change_the_picture():
    scene = still_life(samples=2)
    first = combined()
    scene.render.threads = 1
    assert np.array_equal(first, combined())


def test_processor_renders_where_no_device_can():
    scene = still_life(samples=2)
    first = combined()
    scene.translucid.device = "auto"
    scene.translucid.method = "point-based"
    by_points = combined()
    said = [text for text in messages() if text.startswith("the processor traces: ")]
    assert len(said) == 1, messages()
    scene.translucid.device = "cpu"
    assert np.array_equal(by_points, combined())
    scene.translucid.method = "ray-traced"
    assert np.array_equal(first, combined())


def test_transparent_film():
    scene = still_life(samples=4)
    assert combined()[..., 3].min() == 1
    scene.render.film_transparent = True
    picture = combined()
    assert picture[0, 0, 3] == 0 and picture[0, 0, :3].max() == 0
    assert picture[-1, 30, 3] == 1


def test_view_layers_are_rendered_apart():
    scene = new_scene(32, 32, 4)
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=2)
    nodes = Nodes()
    plane = add_plane(1, material=nodes.surface(nodes.add("Emission", Color=(1, 0, 0))))
    collection = bpy.data.collections.new("hidden")
    scene.collection.children.link(collection)
    collection.objects.link(plane)
    scene.collection.objects.unlink(plane)
    other = scene.view_layers.new("without")
    other.layer_collection.children["hidden"].exclude = True
    found = render()
    with_plane = next(value for name, value in found.items() if name.startswith("ViewLayer."))
    without = next(value for name, value in found.items() if name.startswith("without."))
    assert with_plane[16, 16, 0] == pytest.approx(1, abs=1e-3)
    assert without[..., :3].max() == 0


def test_each_eye_sees_what_a_camera_in_its_place_sees(tmp_path):
    scene = still_life(samples=2)
    camera = scene.camera
    stereo = camera.data.stereo
    stereo.convergence_mode, stereo.pivot, stereo.interocular_distance = "PARALLEL", "CENTER", 0.5
    eyes = {}
    for name, side in (("left", -1), ("right", 1)):
        camera.location.x = 0.25 * side
        eyes[name] = combined()
    camera.location.x = 0
    scene.render.use_multiview = True
    scene.render.image_settings.views_format = "INDIVIDUAL"
    scene.render.filepath, scene.render.use_file_extension = str(tmp_path / "picture"), True
    bpy.ops.render.render(write_still=True)
    for name, suffix in (("left", "L"), ("right", "R")):
        found = translucid.read_exr(tmp_path / f"picture_{suffix}.exr")
        seen = next(value for layer, value in found.items() if "Combined" in layer)
        assert np.allclose(seen, eyes[name], atol=1e-4), name
    assert not np.allclose(eyes["left"], eyes["right"], atol=0.1)


def test_animation_moves_things():
    scene = new_scene(32, 32, 8)
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=4)
    nodes = Nodes()
    plane = add_plane(0.3, material=nodes.surface(nodes.add("Emission")))
    plane.location.x = -1
    plane.keyframe_insert("location", frame=1)
    plane.location.x = 1
    plane.keyframe_insert("location", frame=2)
    for frame, column in ((1, 8), (2, 24)):
        scene.frame_set(frame)
        picture = combined()
        assert picture[16, column, 0] > 0.9 and picture[16, 32 - column, 0] == 0


def test_the_picture_is_that_of_the_module():
    """What the extension hands over is what the renderer makes of the same scene, put together by hand."""
    new_scene(32, 24, 8)
    add_plane(1, material=matte((0.7, 0.4, 0.2)))
    add_camera((0, 0, 5), lens=50.0)
    add_light("POINT", (1, 1, 2), energy=50.0, shadow_soft_size=0.0)
    scene = translucid.Scene(
        "m",
        camera={"position": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 2 * np.degrees(np.arctan(18 / 50))},
        film={"size": [32, 24], "filter_radius": 1.5},
        integrator={"samples_per_pixel": 64},
        environment={"radiance": 0.0},
    )
    scene.add_material("matte", base_color=[0.7, 0.4, 0.2], specular_weight=0.0)
    scene.add_mesh("plane", [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], material="matte")
    scene.add_light("point", position=[1, 1, 2], intensity=50 / (4 * np.pi))
    by_hand = translucid.render(scene, spp=64)["radiance"]
    bpy.context.scene.translucid.samples = 64
    # Other random numbers, and edges fall into other pixels by chance.
    assert np.abs(combined()[..., :3] - by_hand)[2:-2, 8:-8].max() < 0.02 * by_hand.max()


def test_no_camera_is_an_error_not_a_black_picture():
    scene = new_scene(16, 16, 1)
    add_plane(1, material=matte())
    scene.camera = None
    with pytest.raises(RuntimeError, match="camera"):
        combined()


def test_a_broken_export_is_an_error_not_a_black_picture(monkeypatch):
    still_life(samples=1)

    def broken(*arguments):
        raise KeyError("a defect")

    monkeypatch.setattr(addon.engine.Exporter, "describe", broken)
    with pytest.raises(RuntimeError, match="a defect"):
        combined()


def test_an_empty_scene_shows_its_world():
    new_scene(16, 16, 4)
    add_camera((0, 0, 5))
    set_world((0.2, 0.4, 0.6))
    assert combined()[8, 8] == pytest.approx([0.2, 0.4, 0.6, 1], abs=1e-5)


def test_time_limit_ends_a_rendering():
    scene = still_life(128, 96, samples=1 << 20)
    scene.translucid.time_limit = 0.5
    begun = time.perf_counter()
    assert combined().max() > 0
    assert time.perf_counter() - begun < 2


@pytest.mark.parametrize("stage", ["preparing", "rendering"])
def test_cancel_ends_within_a_third_of_a_second(stage, monkeypatch):
    scene = still_life(256, 192, samples=1 << 20)
    if stage == "preparing":
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=900, y_subdivisions=900, size=2)
    wanted = threading.Event()

    # In the background there is nobody whose word Blender could bring.
    monkeypatch.setattr(addon.engine.TranslucidRenderEngine, "is_cancelled", lambda engine: wanted.is_set())
    asked = []

    def ask():
        asked.append(time.perf_counter())
        wanted.set()

    timer = threading.Timer(0.25 if stage == "preparing" else 1.5, ask)
    timer.start()
    bpy.ops.render.render()
    ended = time.perf_counter()
    timer.join()
    assert asked, "it ended before it was asked to"
    print(f"ended {ended - asked[0]:.3f} s after")
    assert ended - asked[0] < 0.3
    assert scene.translucid.samples == 1 << 20


def test_messages_are_said_once_with_material_and_node():
    new_scene(16, 16, 1)
    nodes = Nodes("rust")
    noise = nodes.add("TexNoise")
    material = nodes.surface(nodes.add("BsdfPrincipled", Base_Color=noise.outputs["Color"], Roughness=noise.outputs[0], Sheen_Weight=0.5))
    for place in range(3):
        add_plane(1, z=place, material=material)
    link("none", None)
    add_camera((0, 0, 5))
    bpy.context.scene.render.use_motion_blur = True
    combined()
    found = messages()
    found.remove("scene: motion blur cannot be rendered; all is as at the frame")
    assert sum("Noise Texture" in message for message in found) == 1
    assert all(message.startswith("material rust: ") for message in found)
    assert len(found) == 2 == len(set(found)), found


def test_memory_stays_over_many_renderings():
    still_life(32, 24, samples=1)
    for _ in range(5):
        combined()
    before = addon.process.memory_in_use()[0]
    for _ in range(40):
        combined()
    assert addon.process.memory_in_use()[0] - before < 40


def test_panels_of_other_engines_stay_theirs():
    """A panel's set of engines may be that of a base class, and then of many panels."""
    for name in dir(bpy.types):
        if name.startswith("CYCLES_"):
            assert "TRANSLUCID" not in getattr(getattr(bpy.types, name), "COMPAT_ENGINES", ()), name
    assert "TRANSLUCID" in bpy.types.EEVEE_MATERIAL_PT_surface.COMPAT_ENGINES
    assert "TRANSLUCID" in bpy.types.RENDER_PT_output.COMPAT_ENGINES


def test_registering_again():
    addon.unregister()
    assert "TRANSLUCID" not in {getattr(cls, "bl_idname", None) for cls in bpy.types.RenderEngine.__subclasses__() if cls.is_registered}
    addon.register()
    still_life(16, 16, samples=1)
    assert combined().max() > 0


def errors_of_denoising(samples, reference):
    """Mean square errors of a picture without and with denoising, and the pictures: the reference, noisy, denoised."""
    scene = bpy.context.scene
    scene.translucid.samples = reference
    clean = combined()
    scene.translucid.samples = samples
    noisy = combined()
    scene.translucid.use_denoising = True
    denoised = combined()
    assert messages() == []
    error = lambda picture: np.square(picture - clean)[..., :3].mean()
    return error(noisy), error(denoised), (clean, noisy, denoised)


def test_only_pictures_that_are_not_denoised_share():
    still_life(16, 16, samples=1)
    scene = bpy.context.scene
    shares = lambda **of: addon.engine.settings.integrator_keys(scene, 1, None, **of)["subsurface_sharing"]
    assert shares() and not shares(is_denoised=True)
    scene.translucid.use_sharing = False
    assert not shares()


def test_denoising_is_by_blenders_own_library():
    still_life(64, 48)
    noisy, denoised, pictures = errors_of_denoising(8, 256)
    print(f"mean square error {noisy:.3g} becomes {denoised:.3g}")
    assert denoised < 0.5 * noisy
    assert pictures[2][..., 3].min() == 1
    if sys.platform == "linux":
        loaded = {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines() if "OpenImageDenoise" in line}
        assert loaded and all(Path(bpy.__file__).parents[4] in Path(path).parents for path in loaded), loaded


def test_denoising_keeps_textures_that_noise_hides():
    """It is given the albedo, by which it knows texels of 2 pixels from noise of a greater variance."""
    new_scene(64, 48)
    texels = np.random.default_rng(1).choice([0.4, 0.6], (24, 32)).astype(np.float32)
    image = bpy.data.images.new("texels", 32, 24, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.dstack([texels, texels, texels, np.ones_like(texels)]).ravel())
    nodes = Nodes("texels")
    texture = nodes.add("TexImage")
    texture.image = image
    plane = add_plane(1, material=nodes.surface(nodes.add("BsdfDiffuse", Color=texture.outputs[0])))
    plane.scale = (2, 1.5, 1)
    add_camera((0, 0, 5), type="ORTHO", ortho_scale=4)
    add_light("AREA", (3, 0, 0.7), radians(0, 80, 0), energy=100.0, size=2.0)
    noisy, denoised, pictures = errors_of_denoising(1, 1024)
    is_bright = np.kron(texels, np.ones((2, 2)))[::-1] > 0.5
    contrast, _, kept = (picture[is_bright, 0].mean() / picture[~is_bright, 0].mean() - 1 for picture in pictures)
    print(f"mean square error {noisy:.3g} becomes {denoised:.3g}, contrast {contrast:.3f} becomes {kept:.3f}")
    assert denoised < 0.1 * noisy
    assert kept > 0.75 * contrast


def test_time_memory_and_samples_are_in_the_status_line(monkeypatch):
    lines = []
    monkeypatch.setattr(addon.engine.TranslucidRenderEngine, "_state", lambda engine, line: lines.append(line))
    still_life(128, 96, samples=256)
    combined()
    assert lines[:2] == ["Exporting", "Preparing"]
    words = [re.fullmatch(r"Time (\d+\.\d) s \| Memory (\d+) M \| Sample (\d+)/256", line) for line in lines[2:]]
    assert words and all(words), lines
    assert all(int(word[2]) > 0 for word in words)
    samples, times = [int(word[3]) for word in words], [float(word[1]) for word in words]
    assert samples == sorted(samples) and times == sorted(times)
