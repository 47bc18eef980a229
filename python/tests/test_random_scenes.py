"""Scenes of random keys and values: each is refused in words, or renders to finite numbers."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import translucid
from translucid import Scene, SceneError

TETRAHEDRON = np.array([[0.0, 1, 0], [0.8, -0.5, 0], [-0.5, -0.5, -0.7], [-0.5, -0.5, 0.7]])
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
OF_VERTICES = {"normals": TETRAHEDRON, "uv": TETRAHEDRON[:, :2], "colors": np.abs(TETRAHEDRON)}

ODD = st.one_of(
    st.floats(width=32),
    st.integers(-3, 10**20),
    st.booleans(),
    st.text(max_size=5),
    st.lists(st.floats(width=32), max_size=4),
    st.sampled_from([None, b"x", 1j, object(), [[1]], {"a": 1}, {}, "#fff", np.zeros((0, 2)), np.float32(np.nan)]),
    st.sampled_from([np.ones((2, 2, 5)), np.full((2, 2), np.inf), np.array(["a"]), {"file": "no.png"}, {"image": 1}]),
)
UNIT = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0, 1, 0.5, 1e-30, 0.999999]))
AT_LEAST_0 = st.one_of(st.floats(0.0, 3.0), st.sampled_from([0.0, 1e-30, 1e-3, 1.0, 50.0, 1e6]))
SIZE = st.floats(1e-3, 9.0)
POINT = st.lists(st.floats(-4.0, 4.0), min_size=3, max_size=3)
BYTES = st.integers(0, 255).map(lambda x: np.full((2, 3, 3), x, dtype=np.uint8))
FLOATS = st.lists(UNIT, min_size=4, max_size=4).map(lambda x: np.array(x).reshape(2, 2))
IMAGE = st.one_of(BYTES, FLOATS, st.builds(lambda image, scale: {"image": image, "uv_scale": scale}, BYTES, SIZE))
COLOR = st.one_of(UNIT, st.lists(UNIT, min_size=3, max_size=3), st.sampled_from(["#ff8000", "vertex"]), IMAGE)
LIGHT = st.one_of(AT_LEAST_0, st.lists(AT_LEAST_0, min_size=3, max_size=3))

MATERIAL = {
    **dict.fromkeys(["base_weight", "coat_weight"], UNIT),
    **dict.fromkeys(["base_color", "specular_color", "subsurface_color", "coat_color", "transmission_color", "transmission_tint"], COLOR),
    **dict.fromkeys(["base_metalness", "specular_weight", "specular_roughness", "geometry_opacity"], st.one_of(UNIT, IMAGE)),
    **dict.fromkeys(["transmission_weight", "coat_roughness", "subsurface_weight"], UNIT),
    **dict.fromkeys(["subsurface_radius", "subsurface_radius_scale", "transmission_depth", "emission_luminance"], AT_LEAST_0),
    **dict.fromkeys(["specular_ior", "coat_ior"], st.floats(1.0, 3.0)),
    "emission_color": COLOR,
    "subsurface_eta": st.floats(0.5, 3.0),
    "subsurface_scatter_anisotropy": st.floats(-0.99, 0.99),
    "subsurface_model": st.sampled_from(
        [*translucid.models, "default", "random-walk", "random-walk-diffuse", "random-walk-rough", "random-walk-skin", "layers", "none"]
    ),
    "subsurface_parameter": st.sampled_from(["mfp", "dmfp"]),
    "subsurface_texture_at": st.sampled_from(["exit", "entry", "both"]),
    "subsurface_normalization": st.sampled_from(["none", "energy"]),
    "geometry_normal": BYTES,
    "preset": st.sampled_from(["wax", "marble", "skin1"]),
}
OBJECT = {
    "material": st.just("m"),
    "translate": POINT,
    "rotate": POINT,
    "scale": st.one_of(SIZE, POINT),
    "subsurface_group": st.sampled_from(["a", "b"]),
}
LAMP = {
    **dict.fromkeys(["center", "position", "origin", "direction", "target"], POINT),
    **dict.fromkeys(["radiance", "irradiance", "intensity", "power"], LIGHT),
    **dict.fromkeys(["radius", "outer_angle"], SIZE),
    "size": st.lists(SIZE, min_size=2, max_size=2),
}
CAMERA = {
    **dict.fromkeys(["position", "target", "up"], POINT),
    **dict.fromkeys(["lens_radius", "focus_distance"], SIZE),
    "fov": st.floats(0.1, 170.0),
}
FILM = {
    "filter": st.sampled_from(["box", "gaussian"]),
    "filter_radius": st.floats(0.5, 4.0),
    "exposure": st.floats(-20.0, 20.0),
    "tone_mapping": st.sampled_from(["neutral", "agx", "srgb"]),
}
ENVIRONMENT = {
    "radiance": LIGHT,
    "file": st.one_of(BYTES, FLOATS),
    "rotation": st.floats(-360.0, 360.0),
    "visible": st.booleans(),
}
INTEGRATOR = {
    "max_depth": st.integers(1, 12),
    "caustics": st.booleans(),
    "subsurface_tail": st.floats(1e-6, 0.1),
    "subsurface_sharing": st.booleans(),
    "seed": st.integers(0, 2**64 - 1),
}
NEEDED = {
    "rectangle": ["center", "target", "size", "radiance"],
    "sphere": ["center", "radius", "radiance"],
    "distant": ["direction", "irradiance"],
    "spot": ["position", "target", "intensity", "outer_angle"],
    "point": ["position", "intensity"],
    "beam": ["origin", "target", "radius", "power"],
}


@st.composite
def everything(draw):
    """The keywords of all parts of a scene; in half of them some are odd."""
    has_odd = draw(st.booleans())

    def keys(known, at_least=(), most=4):
        names = [*at_least, *draw(st.lists(st.sampled_from(sorted(known)), max_size=most, unique=True))]
        is_odd = {name: has_odd and draw(st.integers(0, 7)) == 7 for name in names}
        chosen = {name: draw(ODD if is_odd[name] else known[name]) for name in names}
        if has_odd and draw(st.integers(0, 7)) == 7:
            chosen[draw(st.one_of(st.text(max_size=6), st.sampled_from(sorted(known))))] = draw(ODD)
        return chosen

    def lamp():
        kind = draw(st.sampled_from(sorted(NEEDED)))
        return {"type": kind, **keys({name: LAMP[name] for name in NEEDED[kind]}, NEEDED[kind], most=0)}

    def mesh():
        vertices, triangles = TETRAHEDRON * draw(st.sampled_from([1.0, 1e-3, 1e4])), FACES.copy()
        if has_odd and draw(st.booleans()):
            vertices[draw(st.integers(0, 3)), draw(st.integers(0, 2))] = draw(st.floats(width=32))
            triangles[draw(st.integers(0, 3)), draw(st.integers(0, 2))] = draw(st.integers(-1, 4))
        names = draw(st.lists(st.sampled_from(sorted(OF_VERTICES)), unique=True))
        return vertices, triangles, {name: OF_VERTICES[name] for name in names}

    def maybe(known, at_least=()):
        return keys(known, at_least) if draw(st.booleans()) else None

    scene = {
        "unit": "km" if has_odd and draw(st.integers(0, 7)) == 7 else draw(st.sampled_from(["mm", "cm", "m"])),
        "camera": maybe(CAMERA, ["position", "target"]),
        "film": maybe(FILM),
        "integrator": maybe(INTEGRATOR),
        "environment": maybe(ENVIRONMENT, ["radiance"]),
        "lights": [lamp() for _ in range(draw(st.integers(0, 2)))],
    }
    return scene, keys(MATERIAL, ["subsurface_weight"], most=8), mesh(), keys(OBJECT)


SEEN = {"rendered": 0, "refused": 0}


@settings(deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, database=None, max_examples=400)
@given(everything(), st.booleans())
def refuse_or_render(parts, has_floor):
    keywords, material, (vertices, triangles, of_vertices), place = parts
    try:
        scene = Scene(**keywords)
        scene.add_material("m", **material)
        scene.add_mesh("tetrahedron", vertices, triangles, **{"material": "m", **of_vertices, **place})
        if has_floor:
            scene.add_object(shape="box", translate=[0, -2, 0])
        layers = translucid.render(scene, size=(8, 8), spp=1, threads=1, layers=translucid._translucid.LAYERS)
    except (SceneError, TypeError) as error:
        assert str(error)
        SEEN["refused"] += 1
        return
    for name, layer in layers.items():
        assert np.isfinite(layer).all(), name
    SEEN["rendered"] += 1


@pytest.mark.filterwarnings("ignore:mesh tetrahedron")
def test_random_scenes_are_refused_or_finite():
    refuse_or_render()
    # Both happen often enough to mean something
    assert SEEN["rendered"] > 100 and SEEN["refused"] > 100, SEEN
