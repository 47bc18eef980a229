"""A scene of the extension as files of the command: scene.toml, meshes as PLY, images as OpenEXR."""

import json
from types import SimpleNamespace

import bpy
import numpy as np
import png
import translucid
from harness import addon


def write(folder):
    """Writes the scene at hand, as the extension hands it to the renderer; returns what could not be translated."""
    folder.mkdir(parents=True, exist_ok=True)
    scene, depsgraph, engine = bpy.context.scene, bpy.context.evaluated_depsgraph_get(), addon.engine
    report = engine.Report()
    description = engine.Exporter(depsgraph, report, engine.settings.model_of(scene)).describe()
    size = scene.render.resolution_x, scene.render.resolution_y
    camera = engine.scene_camera(scene.camera.evaluated_get(depsgraph), depsgraph, *size, report)
    integrator = engine.settings.integrator_keys(scene, scene.translucid.samples, engine.settings.model_of(scene))
    # The module's scene is not written; the same calls to this one are
    build = engine.build.__globals__
    module, build["translucid"] = build["translucid"], SimpleNamespace(Scene=lambda *args, **keys: _Scene(folder, *args, **keys))
    try:
        engine.build(description, camera, engine.settings.film_keys(scene, *size), integrator).finish()
    finally:
        build["translucid"] = module
    return report.messages


class _Scene:
    """What `translucid.Scene` is told, in a file."""

    def __init__(self, folder, unit, origin=None, **tables):
        self._folder, self._files, self._lines = folder, 0, [f"unit = {json.dumps(unit)}"]
        for name, keys in tables.items():
            self._add(f"[{name}]", keys)

    def add_material(self, name, **keys):
        self._add("[[material]]", {"name": name, **keys})

    def add_light(self, kind=None, **keys):
        self._add("[[light]]", ({"type": kind} if kind else {}) | keys)

    def add_mesh(self, name, vertices, triangles, normals=None, uv=None, colors=None, transforms=None, movable=False, **keys):
        places = {} if transforms is None else {"transforms": [{"matrix": place.ravel().tolist()} for place in transforms]}
        columns = [(vertices, "xyz"), (normals, ("nx", "ny", "nz")), (uv, "st"), (colors, ("red", "green", "blue"))]
        given = [(values, names) for values, names in columns if values is not None]
        table = np.concatenate([np.asarray(values, dtype="<f4")[:, : len(names)] for values, names in given], axis=1)
        faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, triangles
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table)}"]
        header += [f"property float {column}" for _, names in given for column in names]
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
        path = self._path("ply")
        path.write_bytes("\n".join(header).encode() + table.tobytes() + faces.tobytes())
        self._add("[[object]]", {"name": name, "file": path.name, **keys, **places})

    def finish(self):
        (self._folder / "scene.toml").write_text("\n".join(self._lines) + "\n")

    def _path(self, ending):
        self._files += 1
        return self._folder / f"{self._files}.{ending}"

    def _add(self, head, keys):
        self._lines += ["", head, *(f"{key} = {self._word(key, value)}" for key, value in keys.items() if value is not None)]

    def _word(self, key, value):
        if isinstance(value, np.ndarray) and value.ndim >= 2:
            return json.dumps(self._image(value))
        if isinstance(value, dict):
            items = {("file" if name == "image" else name): item for name, item in value.items()}
            return "{ " + ", ".join(f"{name} = {self._word(name, item)}" for name, item in items.items()) + " }"
        if isinstance(value, (list, tuple, np.ndarray)):
            return "[" + ", ".join(self._word(key, item) for item in value) + "]"
        return json.dumps(value.item() if isinstance(value, np.generic) else value)

    def _image(self, pixels):
        if pixels.dtype == np.uint8:
            path = self._path("png")
            png.write(path, pixels[..., :3])
        else:
            path = self._path("exr")
            translucid.write_exr(path, np.repeat(pixels[..., None], 3, axis=2) if pixels.ndim == 2 else pixels[..., :3])
        return path.name
