"""Conversion between systems, and presets."""

import numpy as np
import pytest

import translucid
from translucid import Profile, convert, presets


def test_widths_of_the_published_table():
    # d of Burley's profile for a length of 1 at A = 0.2, 0.5, 0.8
    for source, parameter, widths in [
        ("cycles-burley", "subsurface_radius", [0.080, 0.080, 0.080]),
        ("pbrt-v3-disney", "scatterdistance", [0.200, 0.200, 0.200]),
        ("appleseed", "mfp", [0.316, 0.650, 0.952]),
        ("hdrp", "scatteringDistance", [1.0, 1.0, 1.0]),
    ]:
        found = convert(source, surface_albedo=[0.2, 0.5, 0.8], to="translucid", **{parameter: 1.0})
        assert np.allclose(found["translucid"]["d"], widths, atol=6e-4)


def test_conversion_is_the_command(command):
    rows = command("convert", "--from", "renderman:dmfp=8", "--from", "renderman:dmfpColor=1,0.4,0.2",
                   "--surface-albedo", "0.8,0.5,0.4", "--unit", "cm", "--set", "unreal:MeanFreePathDistance=0.1")
    found = convert("renderman", dmfp=8, dmfpColor=[1, 0.4, 0.2], surface_albedo=[0.8, 0.5, 0.4], unit="cm",
                    settings={"unreal": {"MeanFreePathDistance": 0.1}})
    flat = [float(value) for row in found.rows for value in np.atleast_1d(row.value)]
    assert sorted(flat) == sorted(row["value"] for row in rows) and len(flat) > 50
    assert {row.system for row in found.rows} == {row["system"] for row in rows} == set(found)


def test_way_there_and_back():
    for system in convert.systems():
        if system["name"] == "rise" or "mfp" not in system["parameters"] and len(system["parameters"]) != 1:
            continue
        name = next(iter(system["parameters"]))
        if system["parameters"][name] is not None:
            continue
        try:
            there = convert("translucid", d=2.0, surface_albedo=0.5, to=system["name"])[system["name"]]
            back = convert(system["name"], surface_albedo=there.get("base_color", 0.5), to="translucid", **{name: there[name]})
        except ValueError as error:
            assert "surface_albedo follows" in str(error)
            continue
        assert back["translucid"]["d"] == pytest.approx(2.0, rel=1e-12)


def test_coefficients_determine_the_albedo():
    found = convert("pbrt", sigma_a=[0.0021, 0.0041, 0.0071], sigma_s=[2.19, 2.62, 3.00], to="openpbr")
    marble = presets["marble"]
    assert np.allclose(found["openpbr"]["subsurface_color"], marble.surface_albedo, rtol=1e-9)


def test_units():
    meters = convert("arnold", subsurface_radius=0.002, surface_albedo=0.5, unit="m", to_unit="cm", to="openpbr")
    assert meters["openpbr"]["subsurface_radius"] == pytest.approx(0.2)
    assert "<table>" in meters._repr_html_()


MATERIAL = {"mfp": [0.3, 0.2, 0.1], "surface_albedo": [0.8, 0.6, 0.3]}
WORDS = ["--from", "translucid:mfp=0.3,0.2,0.1", "--surface-albedo", "0.8,0.6,0.3"]


@pytest.mark.parametrize("options, words", [
    ({"color_space": "acescg"}, ["--color-space", "acescg"]),
    ({"thin": 0.2, "thin_g": 0.5, "thin_eta": 1.4}, ["--thin", "0.2", "--g", "0.5", "--eta", "1.4"]),
    ({"thin": 0.2, "color_space": "lin_rec2020"}, ["--thin", "0.2", "--color-space", "lin_rec2020"]),
])
def test_color_spaces_and_thin_walls_are_the_command(command, options, words):
    found = convert("translucid", **MATERIAL, **options)
    rows = command("convert", *WORDS, *words)
    flat = [float(value) for row in found.rows for value in np.atleast_1d(row.value)]
    assert flat == [row["value"] for row in rows]
    assert ("color space" in found) == ("color_space" in options) and ("slab" in found) == ("thin" in options)


def test_a_thin_wall_leads_back_to_its_slab():
    slab = convert.slab([0.8, 0.5, 0.3], 0.4, thin=0.2, g=0.3)["slab"]
    back = convert("translucid", mfp=slab["mfp"], surface_albedo=slab["surface_albedo"], thin=0.2, thin_g=0.3)["slab"]
    assert np.allclose(back["transmittance"], [0.32, 0.2, 0.12], atol=1e-4)
    assert np.allclose(back["reflectance"], [0.48, 0.3, 0.18], atol=1e-4)


@pytest.mark.parametrize("words, message", [
    ({"color": 0.5, "balance": -1.0}, r"^balance is -1, but must be in \(0, 1\]$"),
    ({"color": 0.9, "balance": 1.0, "eta": 1.5}, "^balance is 1, but must be less: no slab"),
    ({"color": [0.5, 0.5], "balance": 0.5}, "number of colors is 2, but must be 1 or 3"),
])
def test_mistakes_of_slabs_are_named(words, message):
    with pytest.raises(ValueError, match=message):
        convert.slab(**words)


@pytest.mark.parametrize("words, message", [
    ({"source": "gltf", "attenuationDistance": 1.0, "surface_albedo": 0.5}, "^source gltf:attenuationColor is missing"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "color_space": "srgb"},
     "^color_space is \"srgb\", but must be one of lin_rec709, .*did you mean lin_rec709"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "from_color_space": "acescg"}, "^from_color_space is given without color_space$"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "thin": 1.0, "thin_g": 1.0}, "^thin_g is 1, but must be"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "thin_g": 0.5}, "^thin_g is given without thin"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "thin": 1.0, "to": "hdrp"}, "^thin and to are given, but only one"),
    ({"source": "rendermann", "dmfp": 2.0, "surface_albedo": 0.5}, "did you mean renderman"),
    ({"source": "renderman", "dmf": 2.0, "surface_albedo": 0.5}, "did you mean dmfp"),
    ({"source": "renderman", "surface_albedo": 0.5}, "source is missing"),
    ({"source": "renderman", "dmfp": 2.0}, "surface_albedo is missing"),
    ({"source": "renderman", "dmfp": 2.0, "surface_albedo": [0.1, 0.2]}, "must have one or three"),
    ({"source": "renderman", "dmfp": 0.0, "surface_albedo": 0.5}, "Lambertian"),
    ({"source": "renderman", "dmfp": -1.0, "surface_albedo": 0.5}, "renderman:dmfp is -1"),
    ({"source": "renderman", "dmfp": float("nan"), "surface_albedo": 0.5}, "is NaN"),
    ({"source": "renderman", "dmfp": [1, 2, 3], "surface_albedo": 0.5}, "is one for all channels"),
    ({"source": "renderman", "dmfp": 1.0, "DMFP": 2.0, "surface_albedo": 0.5}, "twice"),
    ({"source": "pbrt", "sigma_a": 1.0, "sigma_s": 2.0, "surface_albedo": 0.5}, "follows from the coefficients"),
    ({"source": "pbrt", "sigma_a": 1.0}, "both coefficients"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "to": "unreel"}, "did you mean unreal"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.5, "to": "hdrp", "settings": {"renderman": {"unitLength": 1}}},
     "to leaves out"),
    ({"source": "translucid", "d": 1.0, "surface_albedo": 0.1, "to": "unreal-signed"}, "has no numbers"),
])
def test_mistakes_are_named(words, message):
    with pytest.raises(ValueError, match=message):
        convert(**words)


@pytest.mark.parametrize("words", [
    {"source": 3, "surface_albedo": 0.5}, {"source": "renderman", "dmfp": "x", "surface_albedo": 0.5},
    {"source": "renderman", "dmfp": 1.0, "surface_albedo": 0.5, "to": [1]},
    {"source": "renderman", "dmfp": 1.0, "surface_albedo": 0.5, "settings": 3},
    {"source": "renderman", "dmfp": None, "surface_albedo": 0.5},
])
def test_wrong_types_are_named(words):
    with pytest.raises((TypeError, ValueError)):
        convert(**words)


def test_cycles_materials_are_what_cycles_means():
    words = {"base_color": [0.8, 0.5, 0.2], "radius": [4, 2, 1], "scale": np.pi}
    burley = translucid.cycles_material("BURLEY", **words)
    lengths = burley["subsurface_radius"] * np.array(burley["subsurface_radius_scale"])
    there = convert("cycles-burley", subsurface_radius=[4, 2, 1], subsurface_scale=np.pi, surface_albedo=[0.8, 0.5, 0.2])
    assert np.allclose(lengths, there["translucid"]["mfp"]) and burley["subsurface_color"] == [0.8, 0.5, 0.2]

    # The brightness that Blender 5.0.1 was measured at, in the mean over all views
    walk = translucid.cycles_material("RANDOM_WALK_LEGACY", **words)
    assert np.allclose(walk["subsurface_color"], [0.807, 0.498, 0.197], atol=0.008)
    assert np.allclose(walk["subsurface_radius"] * np.array(walk["subsurface_radius_scale"]), [1, 0.5, 0.25])
    bright = translucid.cycles_material("RANDOM_WALK_LEGACY", base_color=[0.95, 1, 0.92], radius=1)
    # The albedo of the medium that Cycles clamps, 1 - (4/sqrt 3) sqrt(1 - alpha); its walks end early
    assert np.allclose(bright["subsurface_color"], 1 - 4 / np.sqrt(3 / 1e-6), atol=2e-4)
    assert bright["subsurface_flights"] == 256
    forward = translucid.cycles_material("RANDOM_WALK_LEGACY", **words, anisotropy=0.5)
    assert forward["subsurface_scatter_anisotropy"] == 0.5 and forward["subsurface_flights"] == 10 + 2 * 246
    assert np.isclose(forward["subsurface_radius"], 0.5)
    skin = translucid.cycles_material("RANDOM_WALK_SKIN", **words, alpha=0.1)
    there = convert("cycles-skin", subsurface_radius=[4, 2, 1], subsurface_scale=np.pi, surface_albedo=[0.8, 0.5, 0.2])
    lengths = skin["subsurface_radius"] * np.array(skin["subsurface_radius_scale"])
    assert np.allclose(lengths, there["translucid"]["mfp"]) and skin["subsurface_model"] == "random-walk-skin"
    lambertian = translucid.cycles_material("RANDOM_WALK", base_color=0.5, radius=[1, 0, 0])
    assert lambertian["subsurface_radius_scale"] == [1, 0, 0]


def test_random_walk_is_that_of_the_version():
    words = {"base_color": [0.8, 0.5, 0.2], "radius": [4, 2, 1], "scale": 0.5, "anisotropy": 0.5}
    walk = translucid.cycles_material("RANDOM_WALK", **words)
    assert isinstance(walk["subsurface_flights"], int)
    assert walk == translucid.cycles_material("RANDOM_WALK", **words, version=(5, 2, 3))
    # Since 5.2 the radius is the mean free path, and the anisotropy changes the color alone
    assert np.isclose(walk["subsurface_radius"], 2.0)
    # The medium's albedo that van de Hulst's approximation is an inverse of, good to 0.003 without anisotropy
    isotropic = translucid.cycles_material("RANDOM_WALK", **words | {"anisotropy": 0})
    assert np.allclose(isotropic["subsurface_color"], words["base_color"], atol=0.003)
    legacy = translucid.cycles_material("RANDOM_WALK_LEGACY", **words)
    for version in [(4, 0), (4, 2, 0), (5, 0, 1), (5, 1, 2)]:
        assert translucid.cycles_material("RANDOM_WALK", **words, version=version) == legacy != walk
    skin = translucid.cycles_material("RANDOM_WALK_SKIN", **words)
    assert translucid.cycles_material("RANDOM_WALK", **words, version=(3, 6)) == skin
    assert translucid.cycles_material("RANDOM_WALK_FIXED_RADIUS", **words, version=(3, 6)) == legacy


@pytest.mark.parametrize("method", ["BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN", "RANDOM_WALK_LEGACY"])
def test_cycles_materials_of_images_are_those_of_their_pixels(method):
    image = np.random.default_rng(3).random((50, 40, 3))
    keys = translucid.cycles_material(method, base_color=image, radius=[1, 0.5, 0.2], anisotropy=0.3)
    for place in [(0, 0), (31, 17), (49, 39)]:
        pixel = translucid.cycles_material(method, base_color=image[place], radius=[1, 0.5, 0.2], anisotropy=0.3)
        for key in ("subsurface_color", "subsurface_radius_scale"):
            of_image = np.asarray(keys[key])
            of_image = of_image[place] if of_image.ndim == 3 else of_image
            factor = 1 if key == "subsurface_color" else keys["subsurface_radius"] / pixel["subsurface_radius"]
            # The skin mode has steps: Cycles bisects twelve times
            atol = 2e-3 if key == "subsurface_radius_scale" and method == "RANDOM_WALK_SKIN" else 2e-4
            assert np.allclose(of_image * factor, pixel[key], atol=atol), (key, place)


@pytest.mark.parametrize("words, message", [
    ({"method": "CUBIC", "base_color": 1, "radius": 1}, "method is 'CUBIC'"),
    ({"method": "RANDOM_WALK_LEGACY", "base_color": 1, "radius": 1, "version": (5, 1)}, "must be one of BURLEY, RANDOM_WALK,"),
    ({"method": "BURLEY", "base_color": 1, "radius": 1, "version": (2, 93)}, "must be \\(3, 0\\) or later"),
    ({"method": "BURLEY", "base_color": -1, "radius": 1}, "base_color has numbers"),
    ({"method": "BURLEY", "base_color": 1, "radius": [1, 2]}, "must end in 3"),
    ({"method": "BURLEY", "base_color": 1, "radius": 1, "scale": float("nan")}, "scale is nan"),
])
def test_mistakes_of_cycles_materials_are_named(words, message):
    with pytest.raises(ValueError, match=message):
        translucid.cycles_material(**words)


def test_presets_are_materials():
    assert len(presets) == 70 and "skin1" in presets and "nothing" not in presets and 3 not in presets
    skin = presets["Skin 1"]
    assert np.allclose(skin.mfp, [1.2953, 0.9524, 0.6711], atol=1e-4) and skin.eta == 1.3
    assert list(presets)[0] == "alabaster" and presets["apple"].roughness == 0.25
    assert "Jensen" in skin.source and skin.group == "skin" and skin.coat == 0
    assert (presets["porcelain"].coat, presets["porcelain"].coat_roughness) == (1.0, 0.03)
    for preset in presets.values():
        profile = Profile(surface_albedo=preset.surface_albedo, mfp=preset.mfp)
        assert np.isfinite(profile.eval(1.0)).all() and profile.shape == (3,)
    for error in (KeyError, ValueError):
        with pytest.raises(error, match='did you mean "skin1"'):
            presets["skinn1"]
    with pytest.raises(TypeError):
        presets[1]
    assert translucid.presets is presets and "apple" in repr(presets)
