# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: a color, or an image of all directions."""

from dataclasses import dataclass

import numpy as np

from .nodes import Evaluator, Socket
from .value import Value, combine, sample

# The renderer's image has its middle toward -z, its right at +x and its top at +y; Blender's has them at +x, -y and +z.
_WORLD_FROM_IMAGE = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class Turn:
    """How an image of all directions is turned: world directions times the matrix are looked up in it."""

    matrix: tuple = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    wrap: str = "repeat"
    layer: str = ""

    def coordinates(self, height, width):
        longitude = (0.5 - (np.arange(width) + 0.5) / width) * 2 * np.pi
        latitude = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
        flat = np.cos(latitude)[:, None]
        directions = np.stack(
            np.broadcast_arrays(flat * np.cos(longitude), flat * np.sin(longitude), np.sin(latitude)[:, None]), axis=-1
        )
        x, y, z = np.moveaxis(directions @ np.array(self.matrix).T, -1, 0)
        return 0.5 - np.arctan2(y, x) / (2 * np.pi), 0.5 + np.arcsin(np.clip(z, -1, 1)) / np.pi


def environment_keys(world, report, visible):
    """The keys of the environment, black where there is no world."""
    black = {"radiance": 0.0, "visible": visible}
    if world is None:
        return black
    if world.node_tree is None or not getattr(world, "use_nodes", True):
        color = np.array(world.color[:])
        return _keys(np.maximum(color, 0), visible)
    where = f"world {world.name}"
    outputs = [node for node in world.node_tree.nodes if node.type == "OUTPUT_WORLD"]
    active = [node for node in outputs if node.is_active_output]
    output = (active or outputs or [None])[0]
    source = Socket(output.inputs["Surface"]).source()[0] if output else None
    if source is None:
        return black
    if Socket(output.inputs["Volume"]).is_linked:
        report.add(where, output.name, "Volume cannot be translated and is left out")
    # Cycles has the property since Blender 5.2.
    if not getattr(getattr(world, "cycles", None), "use_shadows", True):
        report.add(where, None, "a world without shadows cannot be rendered; it throws them")
    value = _radiance(Evaluator(report, where, _turn), source)
    if value is None:
        return black
    if value.placement is None:
        return _keys(np.maximum(value.color().constant, 0), visible)
    pixels = np.maximum(value.color().linear, 0)
    matrix = np.array(value.placement.matrix).T @ _WORLD_FROM_IMAGE
    return {"file": pixels, "matrix": [float(x) for x in matrix.ravel()], "visible": visible}


def _keys(radiance, visible):
    return {"radiance": [float(x) for x in radiance], "visible": visible}


def _radiance(evaluator, output):
    node = output.node
    if node.type in {"BACKGROUND", "EMISSION"}:
        color, strength = evaluator.value(output.input("Color")), evaluator.value(output.input("Strength"), 1.0)
        return _combine(np.multiply, color, strength)
    if node.type in {"MIX_SHADER", "ADD_SHADER"}:
        sources = [Socket(socket, output.groups).source()[0] for socket in node.inputs[-2:]]
        parts = [_radiance(evaluator, source) for source in sources if source is not None]
        parts = [part for part in parts if part is not None]
        if node.type == "ADD_SHADER" or len(parts) < 2:
            return _combine(lambda *all: sum(all), *parts) if parts else None
        factor = evaluator.value(output.input("Fac"), 0.5)
        return _combine(lambda t, a, b: a + np.clip(t, 0, 1) * (b - a), factor, *parts)
    evaluator.say(node, f"a {node.bl_label} node cannot be translated; this part of the world is black")
    return None


def _combine(function, *values):
    """As `combine`; images that are turned in different ways meet in one that is not."""
    turns = {value.placement for value in values if value.placement is not None}
    if len(turns) < 2:
        return combine(function, *values)
    height = max(value.pixels.shape[0] for value in values)
    plain = Turn()
    flat = [
        value if value.placement is None else Value(sample(value.linear, *value.placement.coordinates(height, 2 * height), "repeat"), plain)
        for value in values
    ]
    return combine(function, *flat)


def _turn(evaluator, socket, wrap):
    """How the image that takes these coordinates is turned."""
    output, _ = socket.source()
    if output is None:
        return Turn()
    node = output.node
    if node.type == "TEX_COORD" and output.socket.identifier in {"Generated", "Normal", "Object"}:
        return Turn()
    if node.type == "NEW_GEOMETRY":
        return Turn()
    if node.type == "MAPPING":
        before = np.array(_turn(evaluator, output.input("Vector"), wrap).matrix)
        location, angles, scale = (
            evaluator.value(output.input(name)).color().constant for name in ("Location", "Rotation", "Scale")
        )
        if not np.allclose(scale, scale[0]) or scale[0] <= 0 or (np.any(location) and node.vector_type != "VECTOR"):
            evaluator.say(node, "only rotations of the world can be translated; location and scale are left out")
        rotation = euler_matrix(angles)
        after = rotation.T if node.vector_type == "TEXTURE" else rotation
        return Turn(tuple(tuple(float(x) for x in row) for row in after @ before))
    evaluator.say(node, f"directions from a {node.bl_label} node cannot be translated; the world is not turned")
    return Turn()


def euler_matrix(angles):
    """The rotation about the fixed axes x, then y, then z."""
    matrix = np.eye(3)
    for axis, angle in enumerate(angles):
        cos, sin = np.cos(angle), np.sin(angle)
        turn = np.eye(3)
        j, k = (axis + 1) % 3, (axis + 2) % 3
        turn[j, j], turn[j, k], turn[k, j], turn[k, k] = cos, -sin, sin, cos
        matrix = turn @ matrix
    return matrix
