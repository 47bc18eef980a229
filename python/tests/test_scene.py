"""Scenes of arrays and of files, and what is wrong with them."""

import os
import pickle
import signal

import numpy as np
import pytest

import translucid
from conftest import time_to_interrupt
from translucid import Scene, SceneError

TETRAHEDRON = np.array([[0.0, 9, 0], [6, 0, 0], [-3, 0, -5.2], [-3, 0, 5.2]])
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])


def wax(**keys):
    scene = Scene()
    scene.add_material("wax", subsurface_weight=1, subsurface_color=[0.9, 0.7, 0.4], **keys)
    return scene


def picture(scene, **arguments):
    return translucid.render(scene, **({"size": (24, 16), "spp": 2} | arguments))


def same(a, b):
    return all(np.array_equal(a[name].view(np.uint32), b[name].view(np.uint32)) for name in a)


def toml_scene(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return path


def test_scene_of_keywords_renders_as_the_file_with_the_same_keys(tmp_path):
    path = toml_scene(
        tmp_path,
        """
        unit = "cm"
        [camera]
        position = [0, 3, 8]
        target = [0, 0, 0]
        fov = 35
        [film]
        size = [24, 16]
        exposure = 0.5
        [integrator]
        seed = 11
        [environment]
        radiance = 0.4
        [[material]]
        name = "wax"
        subsurface_weight = 1
        subsurface_color = "#e0b080"
        subsurface_radius = 0.3
        subsurface_radius_scale = [1, 0.6, 0.3]
        specular_roughness = 0.25
        [[object]]
        name = "ball"
        shape = "sphere"
        material = "wax"
        scale = 1.5
        [[light]]
        type = "rectangle"
        center = [2, 5, 2]
        target = [0, 0, 0]
        size = [2, 2]
        radiance = [9, 8, 7]
        """,
    )
    scene = Scene(
        unit="cm",
        camera={"position": (0, 3, 8), "target": np.zeros(3), "fov": np.float32(35)},
        film={"size": (24, 16), "exposure": 0.5},
        integrator={"seed": 11},
        environment={"radiance": 0.4},
        lights=[{"type": "rectangle", "center": [2, 5, 2], "target": [0, 0, 0], "size": [2, 2], "radiance": [9, 8, 7]}],
    )
    scene.add_material(
        "wax",
        subsurface_weight=1,
        subsurface_color="#e0b080",
        subsurface_radius=0.3,
        subsurface_radius_scale=np.array([1, 0.6, 0.3]),
        specular_roughness=0.25,
    )
    scene.add_object("ball", shape="sphere", material="wax", scale=1.5)
    layers = ["radiance", "subsurface", "normal", "depth", "albedo"]
    made, loaded = (translucid.render(s, spp=3, layers=layers) for s in (scene, path))
    assert same(made, loaded)
    assert same(loaded, translucid.render(Scene.load(path), spp=3, layers=layers))
    assert made["radiance"].max() > 0.1


def test_mesh_of_arrays_is_that_of_its_file(tmp_path):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in TETRAHEDRON.tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in FACES.tolist()]
    (tmp_path / "pyramid.obj").write_text("\n".join(lines))
    of_file, of_arrays = wax(), wax()
    of_file.add_object("pyramid", file=tmp_path / "pyramid.obj", material="wax", rotate=[0, 20, 0])
    of_arrays.add_mesh("pyramid", TETRAHEDRON, FACES, material="wax", rotate=[0, 20, 0])
    # An OBJ without normals is smooth, arrays without are flat: the surface is the same
    layers = ["depth", "alpha"]
    assert same(picture(of_file, layers=layers), picture(of_arrays, layers=layers))
    assert of_arrays.objects == of_file.objects == ["pyramid"]


@pytest.mark.parametrize("dtype", ["int8", "uint16", "int32", "uint32", "int64", "uint64", ">i4"])
@pytest.mark.parametrize("vertices", ["float32", "float64", ">f8", "int64"])
def test_arrays_of_any_layout_make_the_same_mesh(dtype, vertices):
    whole = np.round(TETRAHEDRON)
    expected = wax()
    expected.add_mesh("p", whole, FACES, material="wax")
    scene = wax()
    strided = np.asfortranarray(np.repeat(whole, 2, axis=0))[::2].astype(vertices)
    triangles = FACES.astype(dtype)[:, ::-1][:, ::-1]
    triangles.setflags(write=False)
    scene.add_mesh("p", strided, triangles, material="wax")
    assert same(picture(scene, spp=1), picture(expected, spp=1))


def test_lists_are_arrays_too():
    scene = wax()
    scene.add_mesh("p", TETRAHEDRON.tolist(), FACES.tolist(), material="wax", subsurface_group="a")
    assert repr(scene) == "<translucid.Scene in mm: 1 object, 4 triangles, 1 material, 0 lights>"
    assert (scene.unit, scene.materials) == ("mm", ["wax"])


def test_attributes_of_vertices_reach_the_picture():
    square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    uv = (square[:, :2] + 1) / 2
    red = np.zeros((4, 3))
    red[:, 0] = 0.5
    normals = np.tile([0.0, 0.6, 0.8], (4, 1))
    checks = np.zeros((2, 2, 3), dtype=np.uint8)
    checks[0, 0] = checks[1, 1] = 255
    camera = {"position": [0, 0, 4], "target": [0, 0, 0]}

    def first_surface(color, layer, **attributes):
        scene = Scene(camera=camera, environment={"radiance": 1})
        scene.add_material("m", base_color=color, specular_weight=0)
        scene.add_mesh("square", square, faces, uv=uv, material="m", **attributes)
        return picture(scene, size=(8, 8), spp=64, layers=[layer])[layer]

    albedo = first_surface("vertex", "albedo", colors=red)
    assert np.allclose(albedo[4, 4], [0.5, 0, 0], atol=1e-6)
    assert np.allclose(first_surface(0.5, "normal", normals=normals)[4, 4], [0, 0.6, 0.8], atol=1e-5)
    for image in (checks, checks.astype(float) / 255, checks[:, :, 0], {"image": checks, "wrap": "clamp"}):
        albedo = first_surface(image, "albedo")[..., 0]
        assert albedo[2, 2] > 0.6 > 0.4 > albedo[2, 5]
    gray = np.full((1, 1), 188, dtype=np.uint8)
    assert np.allclose(first_surface(gray, "albedo")[4, 4], 0.5029, atol=1e-4)  # sRGB
    linear = {"image": gray, "color_space": "linear", "factor": 0.5}
    assert np.allclose(first_surface(linear, "albedo")[4, 4], 0.5 * 188 / 255, atol=1e-5)


def test_environment_may_be_an_array():
    image = np.zeros((4, 8, 3), dtype=np.float32)
    image[..., 1] = 2.5
    scene = Scene(environment={"file": image, "radiance": 2})
    scene.add_object(shape="sphere")
    radiance = picture(scene)["radiance"]
    assert np.allclose(radiance[0, 0], [0, 5, 0])


def test_repairs_are_told():
    scene = wax()
    with pytest.warns(UserWarning, match="mesh p: 1 triangle"):
        scene.add_mesh("p", TETRAHEDRON, np.vstack([FACES, [[0, 0, 1]]]), material="wax")
    assert scene.objects == ["p"]


def nan(at, value=np.nan):
    broken = TETRAHEDRON.copy()
    broken[at] = value
    return broken


def face(value):
    broken = FACES.copy()
    broken[2, 1] = value
    return broken


BROKEN_MESHES = {
    "NaN": ((nan((3, 1)), FACES), {}, r"mesh p: vertices\[3, 1\] is NaN, but must be finite"),
    "infinity": ((nan((0, 0), np.inf), FACES), {}, r"vertices\[0, 0\] is inf, but must be finite"),
    "huge number": ((nan((0, 2), 1e300), FACES), {}, r"vertices\[0, 2\] is 1.*, but must be finite and within"),
    "index too large": ((TETRAHEDRON, face(4)), {}, r"triangles\[2, 1\] is 4, but must be in \[0, 3\]: there are 4"),
    "index negative": ((TETRAHEDRON, face(-1)), {}, r"triangles\[2, 1\] is -1, but must be in"),
    "index beyond 64 bits": (
        (TETRAHEDRON, face(4).astype(np.uint64) * np.uint64(2**62)),
        {},
        r"triangles\[0, 1\] is 4611686018427387904, but",
    ),
    "flat vertices": ((TETRAHEDRON.ravel(), FACES), {}, r"vertices has the shape \[12\], but must have \[n, 3\]"),
    "two columns": ((TETRAHEDRON[:, :2], FACES), {}, r"vertices has the shape \[4, 2\]"),
    "four dimensions": ((TETRAHEDRON[None, None], FACES), {}, r"vertices has the shape \[1, 1, 4, 3\]"),
    "no vertices": ((np.zeros((0, 3)), FACES), {}, r"vertices has the shape \[0, 3\]"),
    "no triangles": ((TETRAHEDRON, np.zeros((0, 3), int)), {}, r"triangles has the shape \[0, 3\]"),
    "quads": ((TETRAHEDRON, np.zeros((2, 4), int)), {}, r"triangles has the shape \[2, 4\], but must have \[m, 3\]"),
    "a number": ((3.0, FACES), {}, r"vertices has the shape \[\]"),
    "only degenerate": ((TETRAHEDRON, np.zeros((2, 3), int)), {}, "none of the mesh's 2 triangles can be used"),
    "more than memory": (
        (np.broadcast_to(np.float32(0), (10**12, 3)), FACES),
        {},
        "vertices has 1000000000000 rows, but may have",
    ),
    "triangles beyond memory": (
        (TETRAHEDRON, np.broadcast_to(np.int32(0), (10**12, 3))),
        {},
        "triangles has 1000000000000 rows, but may have",
    ),
    "normals of others": (
        (TETRAHEDRON, FACES),
        {"normals": np.ones((5, 3))},
        r"normals has the shape \[5, 3\], but must have \[4, 3\]",
    ),
    "NaN normals": ((TETRAHEDRON, FACES), {"normals": nan((1, 1))}, r"normals\[1, 1\] is NaN"),
    "uv in space": ((TETRAHEDRON, FACES), {"uv": np.ones((4, 3))}, r"uv has the shape \[4, 3\], but must have \[4, 2\]"),
    "NaN uv": ((TETRAHEDRON, FACES), {"uv": np.full((4, 2), np.nan)}, r"uv\[0, 0\] is NaN"),
    "colors": ((TETRAHEDRON, FACES), {"colors": np.ones((4, 4))}, r"colors has the shape \[4, 4\]"),
    "unknown material": (
        (TETRAHEDRON, FACES),
        {"material": "vax"},
        r'material is "vax", but must be the name of a material of this scene \(did you mean "wax"\?\)',
    ),
    "unknown key": ((TETRAHEDRON, FACES), {"translat": [0, 0, 0]}, r"has no key translat \(did you mean translate\?"),
    "file and arrays": ((TETRAHEDRON, FACES), {"file": "a.obj"}, "mesh p: it has no key file"),
    "flat scale": ((TETRAHEDRON, FACES), {"scale": 0}, "scale is 0, but must be"),
    "far away": ((TETRAHEDRON, FACES), {"translate": [1e12, 0, 0]}, "translate.* is 1.*, but must be in"),
    "singular": ((TETRAHEDRON, FACES), {"matrix": np.diag([1, 1, 0, 1])}, "matrix is .*, but must be invertible"),
    "ragged": (([[0, 1, 2], [0]], FACES), {}, "vertices must be"),
}


@pytest.mark.parametrize("case", BROKEN_MESHES)
def test_broken_mesh_is_refused_with_its_place(case):
    arguments, keys, message = BROKEN_MESHES[case]
    scene = wax()
    with pytest.raises(SceneError, match=message) as error:
        scene.add_mesh("p", *arguments, **keys)
    assert error.value.part == "mesh p"
    assert isinstance(error.value, ValueError)
    assert scene.objects == []


@pytest.mark.parametrize(
    "vertices, triangles, message",
    [
        (TETRAHEDRON, FACES.astype(float), "mesh p: triangles must be integers, but is of dtype float64"),
        (TETRAHEDRON, FACES.astype(bool), "triangles must be integers, but is of dtype bool"),
        (TETRAHEDRON.astype(complex), FACES, "vertices must be real numbers, but is of dtype complex128"),
        (TETRAHEDRON.astype(object), FACES, "vertices must be real numbers, but is of dtype object"),
        (TETRAHEDRON.astype(str), FACES, "vertices must be real numbers"),
        (None, FACES, "vertices must be real numbers"),
        (TETRAHEDRON, None, None),
    ],
)
def test_mesh_of_wrong_types_is_a_type_error(vertices, triangles, message):
    with pytest.raises((TypeError, SceneError), match=message):
        wax().add_mesh("p", vertices, triangles)


MATERIALS = {
    "unknown key": ({"subsurface_colour": 0.5}, r"no key subsurface_colour \(did you mean subsurface_color\?"),
    "another system's": ({"albedo": 0.5}, "has no key albedo"),
    "out of range": ({"base_metalness": 1.5}, r"base_metalness is 1.5, but must be in \[0, 1\]"),
    "negative": ({"subsurface_radius": -1}, "subsurface_radius is -1, but must be in"),
    "NaN": ({"specular_ior": float("nan")}, "specular_ior is nan, but must be in"),
    "infinite": ({"emission_luminance": np.inf}, "emission_luminance is inf, but must be in"),
    "two numbers": ({"base_color": [0.1, 0.2]}, "base_color has 2 values, but must be an array of 3 numbers"),
    "NaN channel": ({"base_color": [0.1, np.nan, 0.2]}, r"base_color\[1\] is nan"),
    "a word": ({"base_color": "red"}, "base_color is .red., but must be"),
    "hexadecimal": ({"base_color": "#12345g"}, "must be .*hexadecimal digits"),
    "truth": ({"base_weight": True}, "base_weight is a truth value, but must be a number"),
    "unknown model": ({"subsurface_model": "better-dipol"}, r'subsurface_model is "better-dipol", but .*did you mean "better-dipole"'),
    "unknown preset": ({"preset": "marbel"}, "there is no preset"),
    "huge integer": ({"base_weight": 10**400}, "base_weight is 1"),
    "integer without end": ({"base_weight": 10**5000}, "base_weight is an integer that is too large"),
    "missing image": ({"base_color": {"file": "no.png"}}, "the file no.png does not exist"),
    "image without file": ({"base_color": {"factor": 1}}, "base_color needs the key file"),
    "key of an image": ({"base_color": {"image": np.ones((2, 2)), "wrp": 1}}, "base_color has no key wrp"),
    "image of five channels": ({"base_color": np.ones((4, 4, 5))}, r"base_color has the shape \[4, 4, 5\]"),
    "image without pixels": ({"base_color": np.ones((0, 4, 3))}, "is 4 pixels wide and 0 high"),
    "image too wide": ({"base_color": np.broadcast_to(np.uint8(0), (1, 40000, 3))}, "is 40000 pixels wide"),
    "image too large": ({"base_color": np.broadcast_to(np.uint8(0), (32768, 32768))}, "has 1073741824 pixels"),
    "NaN image": ({"base_color": np.full((2, 2), np.nan)}, r"base_color\[0, 0\] is NaN, but must be finite"),
    "long list": ({"base_color": list(range(100))}, "base_color has 100 values"),
    "no table": ({"subsurface_table": "no.csv"}, "the file no.csv does not exist"),
}


@pytest.mark.parametrize("case", MATERIALS)
def test_broken_material_is_refused_with_its_place(case):
    keys, message = MATERIALS[case]
    scene = Scene()
    with pytest.raises(SceneError, match=message) as error:
        scene.add_material("m", **keys)
    assert error.value.part == "material m"
    assert scene.materials == []


def nested():
    value = []
    value.append(value)
    return value


@pytest.mark.parametrize(
    "value, error, message",
    [
        (object(), TypeError, "base_color is of type object"),
        ({1, 2}, TypeError, "base_color is of type set"),
        (1j, TypeError, "base_color is of type complex"),
        (b"red", TypeError, "base_color is of type bytes"),
        (nested(), SceneError, "too many lists"),
        ("\ud800", SceneError, "must be text of Unicode"),
        (np.ones((2, 2), dtype=np.int32), TypeError, "is an image of dtype int32, but must be one of uint8"),
        (np.array(["a"]), SceneError, "base_color"),
        ("a\n\"'\\\x00", SceneError, "base_color is"),
    ],
)
def test_odd_values_of_keys_are_refused(value, error, message):
    with pytest.raises(error, match=message):
        Scene().add_material("m", base_color=value)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: Scene("km"), 'unit is "km", but must be one of "mm", "cm", "m"'),
        (lambda: Scene(camera={"position": [0, 0, 0], "target": [0, 0, 0]}), "camera: target is .*, but must be a point"),
        (lambda: Scene(camera={"position": [0, 0, 0]}), "camera: it needs the key target"),
        (lambda: Scene(film={"size": [0, 4]}), "film: size.* is 0, but must be"),
        (lambda: Scene(film={"tone_mapping": "aces"}), "film: tone_mapping is .aces., but must be one of"),
        (lambda: Scene(integrator={"seed": -1}), "integrator: seed is -1, but must be"),
        (lambda: Scene(integrator={"samples": 4}), "integrator: it has no key samples"),
        (lambda: Scene(environment={}), "environment: it needs the key radiance"),
        (lambda: Scene(lights=[{"type": "sun"}]), "light 0: type is .sun., but must be one of"),
        (lambda: Scene(lights=[{}]), "light 0: it needs the key type"),
        (lambda: Scene().add_light("sphere", center=[0, 0, 0], radiance=1), "light 0: it needs the key radius"),
        (lambda: Scene(subsurface_grouping="all"), "subsurface_grouping is .all., but must be one of"),
        (lambda: Scene().add_object("a", shape="torus_"), 'shape is "torus_", but .*did you mean "torus"'),
        (lambda: Scene().add_object("a"), "object a: it needs the key file or shape"),
        (lambda: Scene().add_object(file="no.obj"), "the file no.obj does not exist"),
        (lambda: picture(Scene()), "the scene has no objects"),
        (lambda: Scene.load("a.fbx"), "a.fbx: a .fbx file is neither a scene nor a mesh"),
        (lambda: Scene.load(os.curdir), "neither a scene nor a mesh"),
    ],
)
def test_broken_scene_is_refused(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_names_are_given_once():
    scene = wax()
    with pytest.raises(SceneError, match='name is "wax", but must be a name that no other has'):
        scene.add_material("wax")
    scene.add_object("a", shape="sphere")
    with pytest.raises(SceneError, match='name is "a"'):
        scene.add_mesh("a", TETRAHEDRON, FACES)
    scene.add_object(shape="sphere")
    scene.add_object(shape="sphere")
    assert len(set(scene.objects)) == 3


@pytest.fixture(scope="module")
def large_mesh(tmp_path_factory):
    """A file of eight million triangles, which takes about a second to load."""
    path, side = tmp_path_factory.mktemp("mesh") / "large.ply", 2000
    grid = np.arange(side * side, dtype=np.int32).reshape(side, side)
    vertices = np.zeros((side, side, 3), dtype="<f4")
    vertices[..., 0], vertices[..., 2] = np.meshgrid(np.arange(side), np.arange(side))
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, :-1], grid[1:, 1:]
    corners = np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)]).reshape(-1, 3)
    faces = np.empty(len(corners), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, corners
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {side * side}\nproperty float x\nproperty float y\n"
    header += f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())
    return path


def test_interrupted_load_of_a_mesh_leaves_the_scene_as_it_was(large_mesh):
    scenes = []

    def load():
        # A scene of its own: one that has read a file has it at hand
        scenes.append(wax())
        scenes[-1].add_object("large", file=str(large_mesh))

    assert time_to_interrupt(load, delay=0.1) <= 0.2
    for scene in scenes:
        scene.add_object("ball", shape="sphere", material="wax")
        assert scene.objects == ["ball"]


def test_signal_handler_may_ask_a_scene_that_loads(large_mesh):
    scene, seen = wax(), []
    before = signal.signal(signal.SIGALRM, lambda *_: seen.append(scene.objects))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        scene.add_object("large", file=str(large_mesh))
    finally:
        signal.signal(signal.SIGALRM, before)
    assert scene.objects == ["large"]
    assert len(seen) == 1


def test_error_of_a_file_says_file_and_line(tmp_path):
    path = toml_scene(tmp_path, "unit = 'mm'\n[film]\nexposur = 1\n[[object]]\nshape = 'sphere'\n")
    with pytest.raises(SceneError) as error:
        Scene.load(path)
    assert (error.value.path, error.value.line) == (str(path), 3)
    assert error.value.message == "film has no key exposur"
    assert error.value.help.startswith("did you mean exposure?")


def test_loaded_scene_takes_more(tmp_path):
    path = toml_scene(tmp_path, "unit = 'mm'\n[[object]]\nshape = 'sphere'\nname = 'ball'\n")
    scene = Scene.load(path, size=(20, 10))
    scene.add_material("wax", preset="wax")
    scene.add_object("box", shape="box", material="wax", translate=[3, 0, 0])
    assert scene.objects == ["ball", "box"]
    assert scene.size == (20, 10)
    assert picture(scene)["radiance"].shape == (16, 24, 3)


def test_meshes_are_seen_as_the_command_sees_them(tmp_path, command):
    path = tmp_path / "body.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in TETRAHEDRON] + ["f " + " ".join(str(i + 1) for i in face) for face in FACES]
    path.write_text("\n".join(lines) + "\n")
    scene = Scene.load(path, preset="wax", size=(24, 16), up="z", view="30,20", floor="shadow")
    options = ("--up", "z", "--view", "30,20", "--floor", "shadow", "--preset", "wax", "--size", "24x16", "--spp", 2)
    command("render", path, *options, "-o", tmp_path / "picture.exr")
    layers = translucid.read_exr(tmp_path / "picture.exr")
    assert np.array_equal(translucid.render(scene, spp=2)["radiance"], layers["radiance"])
    for word in ("up", "view", "floor"):
        with pytest.raises(ValueError, match=f'{word} is "sideways", but must be one of'):
            Scene.load(path, **{word: "sideways"})
    with pytest.raises(SceneError, match="sideways"):
        Scene.load(path, camera="sideways")


def test_scenes_are_the_same_wherever_they_are():
    def moved(by, **words):
        scene = Scene(camera={"position": by + [0, 5, 30], "target": by + [0, 3, 0]}, **words)
        scene.add_material("wax", preset="wax")
        scene.add_mesh("body", TETRAHEDRON, FACES, material="wax", translate=by)
        scene.add_light("sphere", center=by + [20, 20, 20], radius=3, radiance=30)
        return picture(scene, spp=64)["radiance"].mean(axis=(0, 1))

    near, far = np.zeros(3), np.array([3e8, -1e8, 2e8])
    assert np.allclose(moved(far, origin=far + 0.5), moved(near), rtol=0.05)
    with pytest.raises(ValueError, match="origin has 2 numbers"):
        Scene(origin=[1, 2])


def test_scenes_say_that_they_cannot_be_pickled():
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(Scene())


def test_transforms_are_tables_or_matrices():
    matrices = np.tile(np.eye(4), (80, 1, 1))
    matrices[:, 0, 3] = np.arange(80) * 20
    tables = [{"translate": [20 * i, 0, 0]} for i in range(80)]
    pictures = []
    for transforms in (matrices, tables):
        scene = wax()
        scene.add_mesh("body", TETRAHEDRON, FACES, material="wax", transforms=transforms)
        assert scene.objects == [f"body[{i}]" for i in range(80)]
        pictures.append(picture(scene))
    assert same(*pictures)
    scene = wax()
    scene.add_object("ball", shape="sphere", material="wax", transforms=np.float32(matrices))
    assert len(scene.objects) == 80


def test_transforms_that_are_none_are_refused():
    for transforms, words in [
        (np.eye(4), r"transforms has the shape \[4, 4\], but an array of places must have \(n, 4, 4\)"),
        (np.zeros((2, 4, 4)), r"last row is 0, 0, 0, 1"),
        (np.full((1, 4, 4), np.nan), r"transforms\[0\].matrix\[0\] is nan"),
        ([], r"transforms is empty, but must have at least one table"),
        ([{"moved": 1}], r"transforms\[0\] has no key moved"),
        (3, r"must be an array of tables"),
    ]:
        with pytest.raises(SceneError, match=words):
            wax().add_object("ball", shape="sphere", transforms=transforms)


def test_triangles_of_packed_records_are_read():
    """Faces of PLY files, say: a count of one byte, then three indices that no machine reads in their place."""
    for kind in ("<i4", "<u4", "<u8", "<i8"):
        faces = np.zeros(2, dtype=[("count", "u1"), ("corners", kind, 3)])
        faces["corners"] = [[0, 1, 2], [0, 2, 3]]
        assert not faces["corners"].flags.aligned
        scene = translucid.Scene()
        scene.add_mesh("square", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], faces["corners"])
        assert "2 triangles" in repr(scene)
