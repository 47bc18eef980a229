"""Measurements in photographs: the command's numbers, from files and from arrays, and what is refused."""

import numpy as np
import pytest

import translucid


def photographed(noise=0.004, seed=1):
    """An edge of light at 7 degrees in pixels of 0.1 mm that falls off by a sigmoid, with a white card of reflectance 0.9."""
    y, x = np.mgrid[0:90, 0:150] + 0.5
    across = 0.1 * ((x - 75) * np.cos(np.radians(7)) + (y - 45) * np.sin(np.radians(7)))
    light = 0.02 + 0.15 * (1 + np.tanh(across / np.array([0.5, 0.7, 1.0])[:, None, None]))
    photo = light.transpose(1, 2, 0) + np.random.default_rng(seed).normal(0, noise, (90, 150, 3))
    photo[:10, :20] = 0.45
    return photo.astype(np.float32)


@pytest.fixture
def edge(tmp_path):
    path = tmp_path / "edge.exr"
    translucid.write_exr(path, {"radiance": photographed()})
    return path


def assert_is(found, rows):
    """A measurement has the rows of the command's table."""
    assert rows
    channels = {"red": 0, "green": 1, "blue": 2, "all": ()}
    for row in rows:
        of, measured = channels[row["channel"]], found[row["quantity"]]
        assert measured.value[of] == row["value"] and measured.unit == row["unit"]
        assert measured.likely[of].tolist() == [row["from_68"], row["to_68"]]
        assert measured.sure[of].tolist() == [row["from_95"], row["to_95"]]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_edge_is_the_command(command, edge):
    words = ("--mm-per-pixel", 0.1, "--region", "21,0,150,90", "--white", "2,2,18,8", "--format", "csv")
    rows = command("measure", edge, *words)
    keys = {"mm_per_pixel": 0.1, "region": (21, 0, 150, 90), "white": (2, 2, 18, 8)}
    found = translucid.measure(edge, **keys)
    assert_is(found, rows)
    # Red falls off as sharply as the blur alone would: the command has no row for its length
    assert set(found) == {"mfp", "surface_albedo"} and len(rows) == 5
    assert found.is_seen.tolist() == [False, True, True] and found.blur >= 0 and found.misfit > 0
    # Pixels in memory are those of the file
    same = translucid.measure(photographed(), **keys)
    assert (same["mfp"].value == found["mfp"].value).all() and same.findings == found.findings
    # Options are called as the arguments are
    assert any("(card hidden" in finding or "(card visible" in finding for finding in found.findings)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_lengths_alone_are_the_command(command, edge):
    words = ("--ruler", "30,20,72,76,7", "--surface-albedo", "0.85,0.6,0.35", "--card", "hidden", "--g", 0.8)
    rows = command("measure", edge, *words, "--region", "21,0,150,90", "--format", "csv")
    found = translucid.measure(
        edge, ruler=[30, 20, 72, 76, 7], surface_albedo=[0.85, 0.6, 0.35], card="hidden", g=0.8, region=(21, 0, 150, 90)
    )
    assert_is(found, rows)
    assert set(found) == {"mfp"} and any("only lengths are measured" in note for note in found.notes)
    assert found.material["subsurface_color"] == [0.85, 0.6, 0.35]
    scene = translucid.Scene()
    scene.add_material("soap", **found.material)


def ball(color, mfp):
    scene = translucid.Scene(
        unit="mm", film={"size": [24, 18]}, integrator={"samples_per_pixel": 8}, environment={"radiance": 0.05}
    )
    scene.add_material(
        "wax", specular_weight=0, subsurface_weight=1, subsurface_color=color, subsurface_radius=1, subsurface_radius_scale=mfp
    )
    scene.add_object("ball", shape="sphere", material="wax")
    scene.add_light("rectangle", center=[-4, 4, 2], target=[0, 0, 0], size=[1, 1], radiance=30, visible=False)
    return scene


TOML = """unit = "mm"
[film]
size = [24, 18]
[integrator]
samples_per_pixel = 8
[[material]]
name = "wax"
specular_weight = 0
subsurface_weight = 1
subsurface_color = [0.6, 0.6, 0.6]
subsurface_radius = 1
subsurface_radius_scale = [0.2, 0.2, 0.2]
[[object]]
name = "ball"
shape = "sphere"
material = "wax"
[[light]]
type = "rectangle"
center = [-4, 4, 2]
target = [0, 0, 0]
size = [1, 1]
radiance = [30, 30, 30]
visible = false
[environment]
radiance = [0.05, 0.05, 0.05]
"""


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_known_scene_is_the_command(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    picture = translucid.render(ball([0.8, 0.5, 0.3], [0.2, 0.2, 0.2]), spp=32, seed=7)["radiance"]
    translucid.write_exr("photo.exr", {"radiance": picture})
    (tmp_path / "start.toml").write_text(TOML)
    names = ["material.surface_albedo", "light.radiance"]
    words = ("--scene", "start.toml", "--fit", ",".join(names), "--spp", 8, "--seed", 3, "--format", "csv", "-q")
    rows = command("measure", "photo.exr", *words)
    calls = []
    found = translucid.measure(
        "photo.exr", scene="start.toml", fit=names, spp=8, seed=3, progress=lambda done, total: calls.append((done, total))
    )
    assert_is(found, rows)
    assert found.steps >= 1 and calls and calls[-1][0] > 0
    same = translucid.measure(picture, scene=ball([0.6] * 3, [0.2] * 3), fit=names, spp=8, seed=3)
    assert (same["surface_albedo"].value == found["surface_albedo"].value).all()


@pytest.mark.parametrize("keys, message", [
    ({}, "the scale is missing: mm_per_pixel, ruler or scene"),
    ({"mm_per_pixel": 0}, r"mm_per_pixel is 0 mm, but must be in \(0, 1e6\]"),
    ({"mm_per_pixel": 0.1, "ruler": [0, 0, 9, 9, 5]}, "ruler cannot be used with mm_per_pixel"),
    ({"ruler": [1, 1, 1, 1, 5]}, "ruler is 1,1,1,1,5, but must be two points"),
    ({"ruler": [1, 1, 5]}, "ruler has 3 numbers, but must have 5"),
    ({"mm_per_pixel": 0.1, "setup": "line"}, "setup is .line., but must be one of edge, spot, slab"),
    ({"mm_per_pixel": 0.1, "setup": "slab"}, "setup slab needs its thickness"),
    ({"mm_per_pixel": 0.1, "thickness": 3}, "thickness is for setup slab"),
    ({"mm_per_pixel": 0.1, "white": (0, 0, 9, 9), "white_reflectance": 1.2}, r"white_reflectance is 1.2, but must be in \(0, 1\]"),
    ({"mm_per_pixel": 0.1, "region": (9, 0, 9, 60)}, "X0 < X1"),
    ({"mm_per_pixel": 0.1, "region": (0, 0, 900, 60)}, "region ends at 900,60, but the photograph is 150×90"),
    ({"mm_per_pixel": 0.1, "eta": 5}, "eta: "),
    ({"mm_per_pixel": 0.1, "g": 1}, "g: "),
    ({"mm_per_pixel": 0.1, "incidence": 90}, r"incidence is 90 degrees, but must be in \(-90, 90\)"),
    ({"mm_per_pixel": 0.1, "incidence": 10, "configuration": "diffuse"}, "incidence cannot be used with configuration"),
    ({"mm_per_pixel": 0.1, "dark": np.zeros((5, 5, 3))}, "dark: is 5×5 pixels, but the photograph is 150×90"),
    ({"mm_per_pixel": 0.1, "white_photo": np.zeros((90, 150, 3))}, "white_photo: red is 0 there"),
    ({"mm_per_pixel": 0.1, "spp": 8}, "spp needs a scene"),
    ({"scene": ball([0.5] * 3, [0.2] * 3), "fit": "material.mfp", "eta": 1.3}, "eta cannot be used with scene"),
    ({"scene": ball([0.5] * 3, [0.2] * 3), "fit": "mfp"}, "the parameters are material.surface_albedo"),
    ({"scene": ball([0.5] * 3, [0.2] * 3), "fit": ["material.mfp"], "material": "soap"}, "the scene has 0 of that name"),
    ({"scene": ball([0.5] * 3, [0.2] * 3), "fit": ["material.mfp"]}, "photo: is 150×90 pixels, but the scene's film has 24×18"),
])
def test_wrong_arguments_are_refused(keys, message):
    with pytest.raises(ValueError, match=message):
        translucid.measure(photographed(), **keys)


def test_wrong_types_are_refused():
    with pytest.raises(TypeError, match="photo is missing"):
        translucid.measure(None, mm_per_pixel=0.1)
    with pytest.raises(ValueError, match="no edge of light"):
        translucid.measure(np.full((40, 40, 3), 0.5), mm_per_pixel=0.1)
    with pytest.raises(translucid.SceneError, match="cannot be read"):
        translucid.measure("nowhere.png", mm_per_pixel=0.1)
    with pytest.raises(TypeError, match="fit is missing"):
        translucid.measure(photographed(), scene=ball([0.5] * 3, [0.2] * 3))


def test_warnings_are_warned_of():
    photo = photographed()
    photo[:, 20:] *= 4
    with pytest.warns(UserWarning) as caught:
        found = translucid.measure(photo, mm_per_pixel=0.1, region=(21, 0, 150, 90), white=(2, 2, 18, 8))
    assert [str(warning.message) for warning in caught] == found.warnings
    assert any("or white_reflectance too high?" in warning for warning in found.warnings)
