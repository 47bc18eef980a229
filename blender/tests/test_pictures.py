# SPDX-License-Identifier: GPL-3.0-or-later
"""`translucid.read_exr` finds in Blender's OpenEXR files, whatever their settings, what Blender holds."""

import itertools

import bpy
import numpy as np
import pytest
import translucid
from harness import add_camera, new_scene

HEIGHT, WIDTH = 18, 24
# Passes of every kind, their channels and the type that Blender knows them by.
PASSES = {
    "Depth": ("Z", "VALUE"),
    "Index": ("X", "VALUE"),
    "Normal": ("XYZ", "VECTOR"),
    "UV": ("UVA", "VECTOR"),
    "Vector": ("XYZW", "VECTOR"),
    "Ambient Occlusion": ("RGB", "COLOR"),
    "Straße": ("RGBA", "COLOR"),
    "CryptoObject00": ("rgba", "COLOR"),
}
LOSSLESS = ("NONE", "RLE", "ZIPS", "ZIP", "PIZ")
LOSSY = ("PXR24", "B44", "B44A", "DWAA", "DWAB")


def values(name, channels, view=""):
    """Values of a pass, the lower row first: of both signs, and beyond 1."""
    rng = np.random.default_rng([*name.encode(), *view.encode()])
    return rng.normal(scale=2, size=(HEIGHT, WIDTH, channels)).astype(np.float32)


class KnownPictures(bpy.types.RenderEngine):
    """An engine of known pictures."""

    bl_idname, bl_label = "KNOWN_PICTURES", "Known pictures"

    def update_render_passes(self, scene, view_layer):
        self.register_pass(scene, view_layer, "Combined", 4, "RGBA", "COLOR")
        for name, (components, kind) in PASSES.items():
            self.register_pass(scene, view_layer, name, len(components), components, kind)

    def render(self, depsgraph):
        for name, (components, _) in PASSES.items():
            self.add_pass(name, len(components), components)
        views = depsgraph.scene.render.views if depsgraph.scene.render.use_multiview else [None]
        for view in (each.name if each else "" for each in views):
            result = self.begin_result(0, 0, WIDTH, HEIGHT, view=view)
            for each in result.layers[0].passes:
                each.rect.foreach_set(values(each.name, each.channels, view).ravel())
            self.end_result(result)


@pytest.fixture
def scene():
    bpy.utils.register_class(KnownPictures)
    scene = new_scene(WIDTH, HEIGHT)
    scene.render.engine = "KNOWN_PICTURES"
    add_camera((0, 0, 5))
    yield scene
    scene.render.engine = "TRANSLUCID"
    bpy.utils.unregister_class(KnownPictures)


def choose(scene, multilayer, codec="ZIP", depth="32", mode="RGBA", interleave=False, preview=False):
    """Chooses the settings of a file; false if this Blender lacks them."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE" if multilayer else "IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER" if multilayer else "OPEN_EXR"
    settings.color_depth, settings.color_mode, settings.use_preview = depth, mode, preview
    if hasattr(settings, "use_exr_interleave"):
        settings.use_exr_interleave = interleave
    try:
        settings.exr_codec = codec
    except TypeError:
        return False
    return True


def saved(scene, path):
    bpy.data.images["Render Result"].save_render(str(path), scene=scene)
    return translucid.read_exr(path)


def half(values):
    return values.astype(np.float16).astype(np.float32)


def assert_same(found, expected):
    assert found.keys() == expected.keys()
    for name, array in expected.items():
        assert np.array_equal(found[name], array, equal_nan=True), name


def test_layers_are_blenders_passes(scene, tmp_path):
    bpy.ops.render.render()
    for depth, interleave, codec in itertools.product(("16", "32"), (False, True), LOSSLESS):
        assert choose(scene, True, codec, depth, interleave=interleave, preview=interleave)
        found = saved(scene, tmp_path / "picture.exr")
        expected = {"ViewLayer.Combined": values("Combined", 4)[::-1]}
        for name, (components, kind) in PASSES.items():
            expected[f"ViewLayer.{name}"] = values(name, len(components))[::-1]
        if depth == "16":
            # Data keeps 32 bits
            for name in ("Combined", "Ambient Occlusion", "Straße"):
                expected[f"ViewLayer.{name}"] = half(expected[f"ViewLayer.{name}"])
        assert_same(found, expected)


def test_views_are_called_alike_in_one_part_and_in_several(scene, tmp_path):
    scene.render.use_multiview = True
    scene.render.use_file_extension = False
    for multilayer, interleave in itertools.product((False, True), repeat=2):
        choose(scene, multilayer, interleave=interleave)
        scene.render.image_settings.views_format = "MULTIVIEW"
        scene.render.filepath = str(tmp_path / "views.exr")
        bpy.ops.render.render(write_still=True)
        names = ["Combined", *PASSES] if multilayer else ["Combined"]
        expected = {
            f"ViewLayer.{name}.{view}" if multilayer else view: values(name, len(PASSES.get(name, ["RGBA"])[0]), view)[::-1]
            for name, view in itertools.product(names, ("left", "right"))
        }
        assert_same(translucid.read_exr(scene.render.filepath), expected)


def test_pictures_of_every_mode_and_codec(scene, tmp_path):
    bpy.ops.render.render()
    pixels = values("Combined", 4)[::-1]
    for depth, mode, codec in itertools.product(("16", "32"), ("BW", "RGB", "RGBA"), LOSSLESS + LOSSY):
        if not choose(scene, False, codec, depth, mode):
            assert codec in ("B44", "B44A") and depth == "32"
            continue
        path = tmp_path / f"{codec}-{depth}-{mode}.exr"
        found = saved(scene, path)
        layers = {"BW": {"V": 1}, "RGB": {"radiance": 3}, "RGBA": {"radiance": 3, "alpha": 1}}[mode]
        assert {name: array.shape[2] for name, array in found.items()} == layers
        color = found["V" if mode == "BW" else "radiance"]
        read = bpy.data.images.load(str(path))
        read.colorspace_settings.is_data = True
        held = np.empty(pixels.size, dtype=np.float32)
        read.pixels.foreach_get(held)
        bpy.data.images.remove(read)
        held = held.reshape(pixels.shape)[::-1]
        assert np.array_equal(color, held[..., : color.shape[2]]), path
        assert mode != "RGBA" or np.array_equal(found["alpha"], held[..., 3:]), path
        if codec in LOSSLESS and mode != "BW":
            expected = pixels[..., :3]
            assert np.array_equal(color, half(expected) if depth == "16" else expected), path


def test_codecs_that_cannot_be_read_are_named_with_what_helps(scene, tmp_path):
    bpy.ops.render.render()
    if not choose(scene, True, "HTJ2K"):
        pytest.skip("this Blender has no HTJ2K")
    with pytest.raises(translucid.SceneError) as error:
        saved(scene, tmp_path / "picture.exr")
    for words in ("picture.exr", 'part 1 ("ViewLayer.Combined")', "HTJ2K", "set Codec in Output Properties to one such as ZIP or DWAA"):
        assert words in str(error.value), error.value


def test_all_passes_of_cycles_are_read_from_one_part_and_from_many(tmp_path):
    scene = new_scene(WIDTH, HEIGHT, transparent=True)
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 1, False
    bpy.ops.mesh.primitive_monkey_add()
    add_camera((0, 0, 5))
    layer = bpy.context.view_layer
    for each in (layer, layer.cycles):
        for name in [name for name in each.bl_rna.properties.keys() if name.startswith(("use_pass_", "pass_"))]:
            if isinstance(getattr(each, name), bool) and not each.is_property_readonly(name):
                setattr(each, name, True)
    bpy.ops.render.render()
    choose(scene, True, interleave=True)
    one = saved(scene, tmp_path / "one.exr")
    choose(scene, True, interleave=False)
    many = saved(scene, tmp_path / "many.exr")
    assert len(one) > 30 and sum(array.shape[2] for array in one.values()) > 90
    assert_same(many, one)
    # Ranks by pairs of identifier and coverage: the first covers the monkey wholly or in part, and nothing else
    crypto = many["ViewLayer.CryptoObject00"]
    covered = many["ViewLayer.Combined"][..., 3] > 0
    assert covered.any() and ((crypto[..., 1] > 0) >= covered).all() and crypto[..., 1].max() == 1
