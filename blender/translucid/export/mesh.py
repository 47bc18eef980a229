# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of Blender as arrays.

Blender's own ways to its triangles go through a call for each of them. Where its memory can be read in place, it is:
after a look whether a few triangles there are what the slow way says, which stays the fallback.
"""

import ctypes
from dataclasses import dataclass

import numpy as np

# The renderer's coordinates are within this.
FARTHEST = 1e9

# Triangles that are compared before Blender's memory is trusted.
_PROBES = 64


@dataclass
class MeshArrays:
    """A part of a mesh that has one material, in coordinates of the object."""

    vertices: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None
    uv: np.ndarray | None = None
    colors: np.ndarray | None = None
    slot: int = 0


def arrays_of(mesh, uv_layers, color_attributes, is_one_material):
    """A mesh as a part for each material slot in use.

    Vertices with several normals, texture coordinates or colors become several; so does a mesh that is flat where it
    has textures. `uv_layers` and `color_attributes` map slots to names; the empty name is the mesh's active one.
    """
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == 0:
        return []
    corners = _triangle_corners(mesh, count)
    vertices = _vector_attribute(mesh, "position", len(mesh.vertices), mesh.vertices, "co")
    corner_vertices = _corner_vertices(mesh)
    domain = _normals_domain(mesh)
    slots = None if is_one_material else _triangle_slots(mesh, count)
    used = [0] if slots is None else [int(slot) for slot in np.unique(slots)]
    vertex_normals = corner_normals = None
    if domain == "POINT":
        vertex_normals = _vectors(mesh.vertex_normals, len(mesh.vertices), "vector")
    elif domain == "CORNER":
        corner_normals = _corner_normals(mesh)
    parts = []
    for slot in used:
        mine = corners if slots is None else corners[slots == slot]
        uv = _uv(mesh, uv_layers[slot]) if slot in uv_layers else None
        colors, per_corner = _colors(mesh, color_attributes[slot]) if slot in color_attributes else (None, False)
        part = MeshArrays(vertices, corner_vertices[mine], vertex_normals, slot=slot)
        if uv is not None or corner_normals is not None or per_corner:
            part = _by_corners(part, mine, corner_vertices, corner_normals, uv, colors if per_corner else None)
            if colors is not None and not per_corner:
                part.colors = colors[corner_vertices[_kept(mine)[0]]]
        else:
            part.colors = colors
            if slots is not None:
                part = _compact(part)
        parts.append(part)
    return parts


def mended(part, say):
    """A part without what are no numbers, which modifiers and scripts may leave; `say` is told what was."""
    if not np.abs(part.vertices).max() <= FARTHEST:
        is_number = (np.abs(part.vertices) <= FARTHEST).all(axis=1)
        kept = is_number[part.triangles].all(axis=1)
        say(f"triangles with corners that are no numbers, or beyond ±1e9, are left out: {np.count_nonzero(~kept)}")
        part.vertices, part.triangles = np.where(is_number[:, None], part.vertices, 0), part.triangles[kept]
    if part.normals is not None:
        # The renderer calculates those that have no direction.
        part.normals = _numbers(part.normals)
    for name, words in (("uv", "texture coordinates"), ("colors", "colors")):
        values = getattr(part, name)
        if values is not None and (mended := _numbers(values)) is not values:
            setattr(part, name, mended)
            say(f"{words} that are no numbers are 0")
    return part


def _numbers(values):
    return values if np.isfinite(values).all() else np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)


def has_area(vertices, triangles):
    """Whether there is a triangle that is more than a line or a point."""
    # Nearly always the first is.
    for some in (triangles[:1], triangles):
        a, b, c = np.moveaxis(vertices[some].astype(np.float64), 1, 0)
        if np.cross(b - a, c - a).any():
            return True
    return False


def is_open(parts):
    """Whether triangles of parts have edges without a neighbor; vertices at one point are one."""
    offsets = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    _, point = np.unique(np.concatenate([part.vertices for part in parts]), axis=0, return_inverse=True)
    triangles = point.ravel()[np.concatenate([part.triangles.astype(np.int64) + start for part, start in zip(parts, offsets, strict=True)])]
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends = ends[ends[:, 0] != ends[:, 1]]
    codes = ends @ np.array([point.max() + 1, 1])
    return not np.isin(codes, ends[:, ::-1] @ np.array([point.max() + 1, 1])).all()


def _kept(corners):
    """The corners in use, in order, and the place of each triangle's among them."""
    kept, places = np.unique(corners, return_inverse=True)
    return kept, places.reshape(corners.shape).astype(np.int32)


def _by_corners(part, corners, corner_vertices, corner_normals, uv, colors):
    """A part whose vertices are the corners of its faces."""
    if len(corners) * 3 >= len(corner_vertices) and corners.max() == len(corner_vertices) - 1:
        # Nearly all are in use: sorting them out costs more than it saves.
        kept, triangles = slice(None), corners
    else:
        kept, triangles = _kept(corners)
    from_vertices = corner_vertices[kept]
    normals = corner_normals[kept] if corner_normals is not None else None
    if normals is None and part.normals is not None:
        normals = part.normals[from_vertices]
    return MeshArrays(
        part.vertices[from_vertices],
        triangles,
        normals,
        uv[kept] if uv is not None else None,
        colors[kept] if colors is not None else None,
        part.slot,
    )


def _compact(part):
    """A part without the vertices that it does not use."""
    kept, triangles = _kept(part.triangles)
    if len(kept) == len(part.vertices):
        return part
    of = lambda array: array[kept] if array is not None else None
    return MeshArrays(part.vertices[kept], triangles, of(part.normals), of(part.uv), of(part.colors), part.slot)


# --- reading


def _triangle_corners(mesh, count):
    """The corners of the triangles, (m, 3)."""
    fast = _in_place(mesh.loop_triangles[0].as_pointer(), count)
    if fast is not None:
        probes = np.unique(np.linspace(0, count - 1, min(count, _PROBES)).astype(int))
        if all(tuple(fast[i]) == tuple(mesh.loop_triangles[i].loops) for i in probes.tolist()):
            return fast
    return _vectors(mesh.loop_triangles, count, "loops", np.int32)


def _in_place(address, count):
    """Blender's own array of three indices for each triangle, if it is one: in 4.1 and later."""
    import bpy

    if bpy.app.version < (4, 1, 0) or address == 0:
        return None
    memory = (ctypes.c_int32 * (3 * count)).from_address(address)
    return np.ctypeslib.as_array(memory).reshape(count, 3).copy()


def _vectors(collection, count, name, dtype=np.float32, width=3):
    values = np.empty(count * width, dtype=dtype)
    collection.foreach_get(name, values)
    return values.reshape(count, width)


def _vector_attribute(mesh, attribute, count, fallback, name):
    """An attribute, whose values Blender copies at once, or where it has none what holds the same one by one."""
    found = mesh.attributes.get(attribute)
    if found is not None and found.data_type == "FLOAT_VECTOR" and len(found.data) == count:
        return _vectors(found.data, count, "vector")
    return _vectors(fallback, count, name)


def _corner_vertices(mesh):
    found = mesh.attributes.get(".corner_vert")
    values = np.empty(len(mesh.loops), dtype=np.int32)
    if found is not None and len(found.data) == len(values):
        found.data.foreach_get("value", values)
    else:
        mesh.loops.foreach_get("vertex_index", values)
    return values


def _normals_domain(mesh):
    """Where the shading normals are: FACE where it is flat, POINT where it is smooth all over, else CORNER."""
    if hasattr(mesh, "normals_domain"):
        return mesh.normals_domain
    smooth = np.empty(len(mesh.polygons), dtype=bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    if not smooth.any():
        return "FACE"
    return "POINT" if smooth.all() and not mesh.use_auto_smooth else "CORNER"


def _corner_normals(mesh):
    count = len(mesh.loops)
    if hasattr(mesh, "corner_normals"):
        return _vectors(mesh.corner_normals, count, "vector")
    mesh.calc_normals_split()
    return _vectors(mesh.loops, count, "normal")


def _triangle_slots(mesh, count):
    """The material slot of each triangle."""
    found = mesh.attributes.get("material_index")
    slots = np.zeros(len(mesh.polygons), dtype=np.int32)
    if found is not None:
        found.data.foreach_get("value", slots)
    else:
        mesh.polygons.foreach_get("material_index", slots)
    polygons = np.empty(count, dtype=np.int32)
    if hasattr(mesh, "loop_triangle_polygons"):
        mesh.loop_triangle_polygons.foreach_get("value", polygons)
    else:
        mesh.loop_triangles.foreach_get("polygon_index", polygons)
    return slots[polygons]


def _uv(mesh, name):
    """Texture coordinates of the corners."""
    layers = mesh.uv_layers
    layer = layers.get(name) if name else next((layer for layer in layers if layer.active_render), layers.active)
    if layer is None:
        return None
    if hasattr(layer, "uv"):
        return _vectors(layer.uv, len(mesh.loops), "vector", width=2)
    return _vectors(layer.data, len(mesh.loops), "uv", width=2)


def _colors(mesh, name):
    """Colors, and whether they are those of corners rather than of vertices; None where the mesh has none."""
    attributes = mesh.color_attributes
    attribute = attributes.get(name) if name else attributes.active_color
    if attribute is None and name:
        # Blender's list of colors has those of vertices and corners only
        of_faces = mesh.attributes.get(name)
        is_color = of_faces is not None and of_faces.domain == "FACE" and of_faces.data_type in {"FLOAT_COLOR", "BYTE_COLOR"}
        attribute = of_faces if is_color else None
    if attribute is None or attribute.domain not in {"POINT", "CORNER", "FACE"}:
        return None, False
    # What Blender keeps as codes it hands out linear.
    values = _vectors(attribute.data, len(attribute.data), "color", width=4)
    values = np.ascontiguousarray(values[:, :3])
    if attribute.domain == "FACE":
        corners = np.empty(len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("loop_total", corners)
        values = np.repeat(values, corners, axis=0)
    return values, attribute.domain != "POINT"
